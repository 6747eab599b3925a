//! windfall: what is known beforehand or wanted, as people write it. In: words. Out: what they say.

use crate::{Cutoff, Error, Result};
use windfall_discover::Tie;
use windfall_pid::Held;
use windfall_pid::output_error::Prior;
use windfall_pid::plan::{Target, Wanted};
use windfall_pid::structure::Criterion;

fn split(word: &str) -> Option<(String, &str)> {
    word.split_once('=').map(|(name, rest)| (name.trim().to_owned(), rest.trim())).filter(|(n, r)| !n.is_empty() && !r.is_empty())
}

fn number(word: &str) -> Option<f64> {
    word.trim().parse().ok().filter(|v: &f64| v.is_finite())
}

fn said<T>(parts: Option<T>, word: &str, what: &str) -> Result<T> {
    parts.ok_or_else(|| Error::Request(format!("{word}: {what}")))
}

/// A parameter held at a value, `NAME=VALUE`.
///
/// # Errors
/// Other words.
pub fn hold(word: &str) -> Result<Held> {
    let parts = split(word).and_then(|(name, rest)| Some(Held { name, value: number(rest)? }));
    said(parts, word, "write NAME=VALUE with a finite number, as in Cl_0=0.0125")
}

/// A parameter tied to another, `NAME=NAME`.
///
/// # Errors
/// Other words.
pub fn tie(word: &str) -> Result<Tie> {
    let parts = split(word).map(|(name, to)| Tie { name, to: to.to_owned() }).filter(|t| t.name != t.to);
    said(parts, word, "write NAME=OTHER with two different parameters, as in Cn_1=Cm_1")
}

/// A parameter's mean and standard deviation, `NAME=MEAN±STD` or `NAME=MEAN:STD`.
///
/// ```
/// let known = windfall::prior("Cl_p = -5.7 ± 0.3")?;
/// assert_eq!((known.mean, known.std), (-5.7, 0.3));
/// # Ok::<(), windfall::Error>(())
/// ```
///
/// # Errors
/// Other words.
pub fn prior(word: &str) -> Result<Prior> {
    let parts = split(word).and_then(|(name, rest)| {
        let (mean, std) = ["±", "+-", ":"].iter().find_map(|mark| rest.split_once(mark))?;
        Some(Prior { name, mean: number(mean)?, std: number(std).filter(|s| *s > 0.0)? })
    });
    said(parts, word, "write NAME=MEAN±STD or NAME=MEAN:STD, STD above 0, as in Cl_p=-5.7±0.3")
}

/// A cut-off frequency, Hz, of all channels or of one: `3` or `Rx=2.5`.
///
/// ```
/// let roll = windfall::cutoff("Rx = 2.5")?;
/// assert_eq!((roll.channel.as_str(), roll.hz), ("Rx", 2.5));
/// assert_eq!(windfall::cutoff("3")?.channel, "all");
/// # Ok::<(), windfall::Error>(())
/// ```
///
/// # Errors
/// Other words.
pub fn cutoff(word: &str) -> Result<Cutoff> {
    let positive = |text: &str| number(text).filter(|hz| *hz > 0.0);
    let parts = match positive(word) {
        Some(hz) => Some(Cutoff { channel: "all".to_owned(), hz }),
        None => split(word).and_then(|(channel, rest)| Some(Cutoff { channel, hz: positive(rest)? })),
    };
    said(parts, word, "write a frequency in Hz above 0 for all channels, as in 3, or CHANNEL=HZ, as in Rx=2.5")
}

/// A wanted standard error, `NAME=5%` of the estimate or `NAME=0.1` in the parameter's unit.
///
/// # Errors
/// Other words.
pub fn target(word: &str) -> Result<Target> {
    let positive = |text: &str| number(text).filter(|v| *v > 0.0);
    let parts = word.split_once('=').and_then(|(name, error)| {
        let error = match error.strip_suffix('%') {
            Some(percent) => Wanted::Percent(positive(percent)?),
            None => Wanted::Absolute(positive(error)?),
        };
        Some(Target { parameter: name.trim().to_owned(), error })
    });
    said(parts, word, "write PARAMETER=ERROR with a positive error, as in Cm_2=5% or Cm_2=10")
}

/// A time of zero or more seconds.
///
/// # Errors
/// Other words.
pub fn seconds(word: &str) -> Result<f64> {
    said(number(word).filter(|s| *s >= 0.0), word, "a number of seconds, 0 or more")
}

/// A criterion by name.
///
/// # Errors
/// Other words.
pub fn criterion(word: &str) -> Result<Criterion> {
    let known = || Criterion::ALL.map(Criterion::name).join(", ");
    said(Criterion::ALL.into_iter().find(|c| c.name() == word), word, &format!("one of {}", known()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused<T: std::fmt::Debug>(got: Result<T>, by: &str) -> bool {
        got.is_err_and(|e| e.to_string().contains(by))
    }

    #[test]
    fn law_knowledge_as_typed() {
        assert_eq!(hold("Cl_0 = 0.5").ok(), Some(Held { name: "Cl_0".to_owned(), value: 0.5 }));
        assert_eq!(tie("Cn_1=Cm_1").ok(), Some(Tie { name: "Cn_1".to_owned(), to: "Cm_1".to_owned() }));
        let known = Prior { name: "Cl_p".to_owned(), mean: -5.7, std: 0.3 };
        for word in ["Cl_p=-5.7±0.3", "Cl_p=-5.7:0.3", "Cl_p = -5.7 +- 0.3"] {
            assert_eq!(prior(word).ok(), Some(known.clone()), "{word}");
        }
        for bad in ["", "Cl_0", "Cl_0=", "=1", "Cl_0=nan", "Cl_0=inf", "Cl_0=a"] {
            assert!(refused(hold(bad), "NAME=VALUE"), "{bad}");
        }
        for bad in ["Cn_1", "Cn_1=", "Cn_1=Cn_1"] {
            assert!(refused(tie(bad), "NAME=OTHER"), "{bad}");
        }
        for bad in ["", "X", "X=", "0", "-1", "nan", "inf", "X=0", "X=a"] {
            assert!(refused(cutoff(bad), "CHANNEL=HZ"), "{bad}");
        }
        for bad in ["Cl_p=1", "Cl_p=1±0", "Cl_p=1:-1", "Cl_p=1±nan", "Cl_p=±1"] {
            assert!(refused(prior(bad), "MEAN"), "{bad}");
        }
    }

    #[test]
    fn law_targets_as_typed() {
        let percent = Target { parameter: "Cm_2".to_owned(), error: Wanted::Percent(5.0) };
        assert_eq!(target("Cm_2=5%").ok(), Some(percent));
        assert_eq!(target("Cm_2 = 10").ok().map(|t| t.error), Some(Wanted::Absolute(10.0)));
        for bad in ["Cm_2", "Cm_2=", "Cm_2=-1", "Cm_2=nan", "Cm_2=0%", "Cm_2=inf"] {
            assert!(refused(target(bad), "PARAMETER=ERROR"), "{bad}");
        }
        assert!(seconds("-1").is_err() && seconds("0").is_ok());
    }

    #[test]
    fn law_criteria_as_typed() {
        for c in Criterion::ALL {
            assert_eq!(criterion(c.name()).ok(), Some(c));
        }
        assert!(refused(criterion("aic"), "likelihood"));
    }
}
