//! study: what many campaigns say together. In: a row each. Out: counts, and every parameter pooled over the campaigns that have it.

use super::outcome::CampaignOutcome;
use super::pool::{Pooled, pool};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// How many campaigns have something.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tally {
    /// What.
    pub name: String,
    /// How many.
    pub count: usize,
}

/// One parameter over campaigns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PooledParameter {
    /// Coefficient of a declared parameter; family of an effect.
    pub of: String,
    /// Name.
    pub name: String,
    /// Unit, `-` for none.
    pub unit: String,
    /// Whether it is an effect's: then it is pooled over the campaigns in which that effect was found, and says nothing of the others.
    pub effect: bool,
    /// Mean, spread, heterogeneity.
    #[serde(flatten)]
    pub pooled: Pooled,
}

/// The content of `many.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ManySummary {
    /// Version of the program.
    pub windfall: String,
    /// What was done to each campaign: the verb with its request.
    pub each: Value,
    /// Number of campaigns.
    pub campaigns: usize,
    /// How many have a result.
    pub ok: usize,
    /// How many have none.
    pub failed: usize,
    /// Verdicts of closings.
    pub verdicts: Vec<Tally>,
    /// Families named, most often first.
    pub families: Vec<Tally>,
    /// Parameters of two campaigns or more that have a result, nothing unexplained and a standard error.
    pub pooled: Vec<PooledParameter>,
    /// Name of the table of all campaigns.
    pub table: String,
    /// FNV-1a hash of its bytes.
    pub table_hash: String,
    /// What each campaign gave, in the order of their paths.
    pub outcomes: Vec<CampaignOutcome>,
}

impl ManySummary {
    /// Counts and pools. `table`: name and hash of the table of the same campaigns.
    #[must_use]
    pub fn new(windfall: &str, each: Value, [table, table_hash]: [String; 2], outcomes: Vec<CampaignOutcome>) -> Self {
        let ok = outcomes.iter().filter(|o| o.status == super::Status::Ok).count();
        let mut families = tallies(outcomes.iter().flat_map(|o| o.families.iter().map(String::as_str)));
        families.sort_by(|a, b| b.count.cmp(&a.count).then_with(|| a.name.cmp(&b.name)));
        let verdict = |o: &CampaignOutcome| Some(o.verdict?.name());
        Self {
            windfall: windfall.to_owned(),
            each,
            campaigns: outcomes.len(),
            ok,
            failed: outcomes.len() - ok,
            verdicts: tallies(outcomes.iter().filter_map(verdict)),
            families,
            pooled: pooled(&outcomes),
            table,
            table_hash,
            outcomes,
        }
    }
    /// What a parameter was pooled of: path, estimate and standard error of each campaign.
    #[must_use]
    pub fn estimates<'s>(&'s self, p: &PooledParameter) -> Vec<(&'s str, f64, f64)> {
        of_key(&self.outcomes, (&p.of, &p.name, &p.unit, p.effect))
    }
}

/// Counts in the order of the names.
fn tallies<'a>(names: impl Iterator<Item = &'a str>) -> Vec<Tally> {
    let mut counts = std::collections::BTreeMap::<&str, usize>::new();
    names.for_each(|n| *counts.entry(n).or_default() += 1);
    counts.into_iter().map(|(name, count)| Tally { name: name.to_owned(), count }).collect()
}

/// What makes parameters of two campaigns the same: coefficient or family, name, unit, whether of an effect.
type Key<'a> = (&'a str, &'a str, &'a str, bool);

fn of_key<'o>(outcomes: &'o [CampaignOutcome], key: Key<'_>) -> Vec<(&'o str, f64, f64)> {
    let one = |o: &'o CampaignOutcome| {
        let p = o.parameters.iter().find(|p| (p.of.as_str(), p.name.as_str(), p.unit.as_str(), p.effect) == key)?;
        let error = p.std_error.filter(|s| s.is_finite() && *s > 0.0 && p.estimate.is_finite())?;
        Some((o.path.as_str(), p.estimate, error))
    };
    outcomes.iter().filter(|o| o.is_pooled()).filter_map(one).collect()
}

fn pooled(outcomes: &[CampaignOutcome]) -> Vec<PooledParameter> {
    let mut keys: Vec<Key<'_>> = Vec::new();
    for p in outcomes.iter().filter(|o| o.is_pooled()).flat_map(|o| &o.parameters) {
        let key = (p.of.as_str(), p.name.as_str(), p.unit.as_str(), p.effect);
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    keys.sort_by_key(|k| k.3);
    let one = |(of, name, unit, effect): Key<'_>| {
        let estimates: Vec<(f64, f64)> = of_key(outcomes, (of, name, unit, effect)).into_iter().map(|(_, y, s)| (y, s)).collect();
        let pooled = pool(&estimates)?;
        Some(PooledParameter { of: of.to_owned(), name: name.to_owned(), unit: unit.to_owned(), effect, pooled })
    };
    keys.into_iter().filter_map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{OutcomeParameter, Status, campaign_table};
    use super::*;
    use windfall_discover::close::Verdict;
    use windfall_model::study::Cell;

    fn outcome(path: &str, verdict: Verdict, families: &[&str], values: &[(&str, f64, Option<f64>)]) -> CampaignOutcome {
        let one = |(name, estimate, std_error): &(&str, f64, Option<f64>)| OutcomeParameter {
            of: "CA".to_owned(),
            name: (*name).to_owned(),
            estimate: *estimate,
            std_error: *std_error,
            unit: "-".to_owned(),
            effect: false,
        };
        CampaignOutcome {
            status: Status::Ok,
            exit_code: 0,
            verdict: Some(verdict),
            families: families.iter().map(|f| (*f).to_owned()).collect(),
            parameters: values.iter().map(one).collect(),
            ..CampaignOutcome::failed(path, path, 0, String::new())
        }
    }

    /// Only what can be pooled is: results without anything unexplained, estimates with an error, the same name.
    #[test]
    fn law_what_is_pooled_and_counted() {
        let all = vec![
            outcome("a", Verdict::Consistent, &[], &[("x", 1.0, Some(0.1)), ("y", 5.0, None)]),
            outcome("b", Verdict::Effect, &["swirl"], &[("x", 3.0, Some(0.1)), ("y", 5.0, Some(0.1))]),
            outcome("c", Verdict::Unexplained, &["swirl", "contact"], &[("x", 99.0, Some(0.1)), ("z", 1.0, Some(1.0))]),
            CampaignOutcome::failed("d", "", 2, "no run".to_owned()),
        ];
        let (columns, rows) = campaign_table(&all);
        let names: Vec<&str> = columns.iter().map(|c| c.name.as_str()).skip(11).collect();
        assert_eq!(names, ["x", "y", "z"].map(|p| [format!("CA.{p}.estimate"), format!("CA.{p}.std_error")]).concat());
        assert!(rows.iter().all(|r| r.cells.len() == columns.len()));
        assert_eq!(rows[2].cells[11..14], [Cell::Number(Some(99.0)), Cell::Number(Some(0.1)), Cell::Number(None)]);
        let s = ManySummary::new("0", Value::Null, ["t".to_owned(), "h".to_owned()], all);
        assert_eq!((s.campaigns, s.ok, s.failed), (4, 3, 1));
        let of = |t: &[Tally]| t.iter().map(|t| format!("{} {}", t.name, t.count)).collect::<Vec<_>>();
        assert_eq!(of(&s.verdicts), ["consistent 1", "effect 1", "unexplained 1"]);
        assert_eq!(of(&s.families), ["swirl 2", "contact 1"]);
        let [x] = &s.pooled[..] else { panic!("x alone has two estimates with errors: {:?}", s.pooled) };
        assert!(x.name == "x" && x.pooled.n == 2 && (x.pooled.mean - 2.0).abs() < 1e-12, "{x:?}");
        assert_eq!(s.estimates(x), [("a", 1.0, 0.1), ("b", 3.0, 0.1)]);
    }
}
