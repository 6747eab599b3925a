//! cli: what is known beforehand: `--hold`, `--tie`, `--prior`. In: words. Out: what they say.

use windfall_pid::Held;
use windfall_pid::output_error::Prior;
use windfall_verify::Tie;

fn split(word: &str) -> Option<(String, &str)> {
    word.split_once('=').map(|(name, rest)| (name.trim().to_owned(), rest.trim())).filter(|(n, r)| !n.is_empty() && !r.is_empty())
}

fn number(word: &str) -> Option<f64> {
    word.trim().parse().ok().filter(|v: &f64| v.is_finite())
}

/// `NAME=VALUE`.
pub(crate) fn hold(word: &str) -> Result<Held, String> {
    let parts = split(word).and_then(|(name, rest)| Some(Held { name, value: number(rest)? }));
    parts.ok_or_else(|| format!("{word}: write NAME=VALUE with a finite number, as in Cl_0=0.0125"))
}

/// `NAME=NAME`.
pub(crate) fn tie(word: &str) -> Result<Tie, String> {
    let parts = split(word).map(|(name, to)| Tie { name, to: to.to_owned() }).filter(|t| t.name != t.to);
    parts.ok_or_else(|| format!("{word}: write NAME=OTHER with two different parameters, as in Cn_1=Cm_1"))
}

/// `NAME=MEAN±STD` or `NAME=MEAN:STD`.
pub(crate) fn prior(word: &str) -> Result<Prior, String> {
    let parts = split(word).and_then(|(name, rest)| {
        let (mean, std) = ["±", "+-", ":"].iter().find_map(|mark| rest.split_once(mark))?;
        Some(Prior { name, mean: number(mean)?, std: number(std).filter(|s| *s > 0.0)? })
    });
    parts.ok_or_else(|| format!("{word}: write NAME=MEAN±STD or NAME=MEAN:STD, STD above 0, as in Cl_p=-5.7±0.3"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_knowledge_as_typed() {
        assert_eq!(hold("Cl_0 = 0.5"), Ok(Held { name: "Cl_0".to_owned(), value: 0.5 }));
        assert_eq!(tie("Cn_1=Cm_1"), Ok(Tie { name: "Cn_1".to_owned(), to: "Cm_1".to_owned() }));
        let known = Prior { name: "Cl_p".to_owned(), mean: -5.7, std: 0.3 };
        for word in ["Cl_p=-5.7±0.3", "Cl_p=-5.7:0.3", "Cl_p = -5.7 +- 0.3"] {
            assert_eq!(prior(word), Ok(known.clone()), "{word}");
        }
        for bad in ["", "Cl_0", "Cl_0=", "=1", "Cl_0=nan", "Cl_0=inf", "Cl_0=a"] {
            assert!(hold(bad).is_err_and(|e| e.contains("NAME=VALUE")), "{bad}");
        }
        for bad in ["Cn_1", "Cn_1=", "Cn_1=Cn_1"] {
            assert!(tie(bad).is_err(), "{bad}");
        }
        for bad in ["Cl_p=1", "Cl_p=1±0", "Cl_p=1:-1", "Cl_p=1±nan", "Cl_p=±1"] {
            assert!(prior(bad).is_err_and(|e| e.contains("MEAN")), "{bad}");
        }
    }
}
