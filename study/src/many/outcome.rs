//! study: what one campaign of many gave. In: its closing or identification, or why it has none. Out: one row.

use serde::{Deserialize, Serialize};
use windfall_discover::Identified;
use windfall_discover::close::{Closing, ParameterLine, SOMETHING_ELSE, Verdict};
use windfall_pid::Estimate;

/// Whether a campaign has a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// It has.
    Ok,
    /// It was refused or failed; the reason says why.
    Failed,
}

impl Status {
    /// As in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Failed => "failed",
        }
    }
}

/// One estimated number of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutcomeParameter {
    /// Coefficient of a declared parameter; family of an effect that was found.
    pub of: String,
    /// Name.
    pub name: String,
    /// Estimate.
    pub estimate: f64,
    /// Standard error; none where the data give none.
    pub std_error: Option<f64>,
    /// Unit, `-` for none.
    pub unit: String,
    /// Whether it is an effect's, which only campaigns have in which that was found.
    pub effect: bool,
}

impl OutcomeParameter {
    fn of_line(of: &str, effect: bool, l: &ParameterLine) -> Self {
        let (of, name, unit) = (of.to_owned(), l.name.clone(), l.unit.clone());
        Self { of, name, estimate: l.estimate, std_error: l.std_error, unit, effect }
    }
    fn of_estimate(e: &Estimate) -> Self {
        let (of, name) = (e.coefficient.clone(), e.name.clone());
        let std_error = Some(e.std_error).filter(|s| s.is_finite());
        Self { of, name, estimate: e.estimate, std_error, unit: "-".to_owned(), effect: false }
    }
    /// Name in one word: `CA.CA_T0`, `effects.center-of-mass.z_m`.
    #[must_use]
    pub fn stem(&self) -> String {
        if self.effect { format!("effects.{}.{}", self.of, self.name) } else { format!("{}.{}", self.of, self.name) }
    }
}

/// What one campaign gave: a row of `campaigns.parquet`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CampaignOutcome {
    /// Campaign file, relative to the folder searched, with `/`.
    pub path: String,
    /// Name as the campaign declares it; empty where it could not be read.
    pub name: String,
    /// Whether there is a result.
    pub status: Status,
    /// What the verb alone exits with: 0, 1 (unexplained), 2 (bad input), 3 (the numbers failed).
    pub exit_code: u8,
    /// Why there is no result; empty where there is one.
    pub reason: String,
    /// Method of identification; empty for a closing.
    pub method: String,
    /// Verdict of a closing.
    pub verdict: Option<Verdict>,
    /// Families named, in the order added.
    pub families: Vec<String>,
    /// Probability of that set of families.
    pub probability: Option<f64>,
    /// Channel, or coefficient of an identification, whose residual is least like noise under the declared model.
    pub worst_channel: String,
    /// Its p-value.
    pub p_value: Option<f64>,
    /// Declared parameters, with the effects added; then the effects' own.
    pub parameters: Vec<OutcomeParameter>,
    /// Its own page, relative to the folder of the results; none where it was not written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub page: Option<String>,
}

impl CampaignOutcome {
    /// A campaign without a result.
    #[must_use]
    pub fn failed(path: &str, name: &str, exit_code: u8, reason: String) -> Self {
        Self {
            path: path.to_owned(),
            name: name.to_owned(),
            status: Status::Failed,
            exit_code,
            reason,
            method: String::new(),
            verdict: None,
            families: Vec::new(),
            probability: None,
            worst_channel: String::new(),
            p_value: None,
            parameters: Vec::new(),
            page: None,
        }
    }
    fn done(path: &str, name: &str) -> Self {
        Self { status: Status::Ok, ..Self::failed(path, name, 0, String::new()) }
    }
    /// Of a closing.
    #[must_use]
    pub fn of_closing(path: &str, c: &Closing) -> Self {
        let families: Vec<String> = c.effects.iter().map(|e| e.family.clone()).collect();
        let sorted = |f: &[String]| {
            let mut f = f.to_vec();
            f.sort_unstable();
            f
        };
        // Where something is unexplained, something else is in every set.
        let mut acting = families.clone();
        acting.extend((c.verdict == Verdict::Unexplained).then(|| SOMETHING_ELSE.to_owned()));
        let set = [&acting, &families].into_iter().find_map(|all| c.sets.iter().find(|s| sorted(&s.families) == sorted(all)));
        let channels = c.residual.per_channel.iter().map(|r| (r.channel.as_str(), r.p_value));
        let (worst_channel, p_value) = worst(channels);
        let declared = c.after.parameters.iter().map(|l| OutcomeParameter::of_line(&l.coefficient, false, l));
        let of_effect = |e: &'_ windfall_discover::close::EffectLine| {
            let family = e.family.clone();
            e.parameters.iter().map(move |l| OutcomeParameter::of_line(&family, true, l)).collect::<Vec<_>>()
        };
        Self {
            exit_code: u8::from(c.verdict == Verdict::Unexplained),
            verdict: Some(c.verdict),
            probability: set.map(|s| s.probability),
            families,
            worst_channel,
            p_value,
            parameters: declared.chain(c.effects.iter().flat_map(of_effect)).collect(),
            ..Self::done(path, &c.campaign)
        }
    }
    /// Of an identification: all runs together.
    #[must_use]
    pub fn of_identified(path: &str, name: &str, identified: &Identified) -> Self {
        let set = identified.found.combined();
        let fits = set.into_iter().flat_map(|d| d.fits.iter().map(|f| (f.coefficient.as_str(), f.residual_whiteness_p)));
        let (worst_channel, p_value) = worst(fits);
        Self {
            method: identified.found.method.clone(),
            worst_channel,
            p_value,
            parameters: set.into_iter().flat_map(|d| d.parameters.iter().map(OutcomeParameter::of_estimate)).collect(),
            ..Self::done(path, name)
        }
    }
    /// Whether its standard errors can be believed, as far as its own residual says: it has a result, and nothing beyond noise is left
    /// without explanation.
    #[must_use]
    pub fn is_pooled(&self) -> bool {
        self.status == Status::Ok && self.verdict != Some(Verdict::Unexplained)
    }
}

/// The channel of the least p-value.
fn worst<'a>(channels: impl Iterator<Item = (&'a str, f64)>) -> (String, Option<f64>) {
    let least = channels.filter(|(_, p)| p.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1));
    least.map_or_else(Default::default, |(channel, p)| (channel.to_owned(), Some(p)))
}
