//! windfall: what is asked of each verb. Out: plain structs, which are JSON, and flags of the command line with the feature `cli`.
//!
//! A field is a flag: its name, its type, and the comment above it, which is its help.

use crate::{Error, Result};
use serde::{Deserialize, Serialize};
use windfall_discover::Tie;
use windfall_model::{CHANNEL_NAMES, PerChannel};
use windfall_pid::output_error::Prior;
use windfall_pid::plan::Target;
use windfall_pid::smooth::{Smoother, TABLE_3_1_HZ};
use windfall_pid::structure::Criterion;
use windfall_pid::{Held, Method};
use windfall_scenarios::{Opening, Shard};

/// Threads at most: more than any one machine has processors for, and few enough to start.
pub const MOST_THREADS: u16 = 512;

/// Copies, seeds or draws at most: each is a campaign flown again, and their scatter is known to 1 % by then.
pub const MOST_COPIES: u16 = 10_000;

/// How to fly a scenario.
///
/// ```
/// use windfall::prelude::*;
/// let flights = Scenario::bundled("appendix-c")?.fly(&Fly { seed: Some(3) })?;
/// assert_eq!(flights.scenario.file.scenario.seed, 3);
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct Fly {
    /// Seed of all chance, in place of the scenario's
    #[cfg_attr(feature = "cli", arg(long, value_name = "N"))]
    pub seed: Option<u64>,
}

/// How to identify a campaign.
///
/// ```
/// use windfall::Identify;
/// let request = Identify { hold: vec![windfall::hold("Cl_0=0.0125")?], ..Identify::default() };
/// let json = r#"{"hold": [{"name": "Cl_0", "value": 0.0125}]}"#;
/// assert_eq!(serde_json::from_str::<Identify>(json).expect("a request"), request);
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct Identify {
    /// How to identify [default: output-error where its residual is noise, filter-error where process noise is found; the result says
    /// which and why]
    #[cfg_attr(feature = "cli", arg(long, value_parser = method()))]
    pub method: Option<Method>,
    /// Only all runs together, without each kind of run alone
    #[cfg_attr(feature = "cli", arg(long))]
    pub combined: bool,
    /// Check the stated errors by N copies: the identified model is flown again with the campaign's own inputs and noise, and identified
    /// again; scatter over stated error is known to 1/√(2N)
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=MOST_COPIES.into())))]
    pub bootstrap: Option<u16>,
    /// Hold a parameter: it is not estimated but kept at this value (Cl_0=0.0125); may be repeated
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME=VALUE", value_parser = crate::hold))]
    pub hold: Vec<Held>,
    /// Tie a parameter to another: both are one unknown (Cn_1=Cm_1: pitch and yaw damping shared); methods that integrate; may be
    /// repeated
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME=NAME", value_parser = crate::tie))]
    pub tie: Vec<Tie>,
    /// What is known of a parameter beforehand: mean and standard deviation (Cl_p=-5.7±0.3 or Cl_p=-5.7:0.3); methods that integrate;
    /// may be repeated
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME=MEAN±STD", value_parser = crate::prior))]
    pub prior: Vec<Prior>,
    /// Cut-off frequency of the thesis' smoothing, Hz: one for all channels (3), or by channel (X=1.5,Rx=2.5), where a channel that is not
    /// named has that of its Table 3.1; method thesis [default: Table 3.1]
    #[cfg_attr(feature = "cli", arg(long, value_name = "HZ|CHANNEL=HZ", value_delimiter = ',', value_parser = crate::cutoff))]
    pub cutoffs: Vec<Cutoff>,
    /// No smoothing, as in the thesis' Appendix C: values as recorded, derivatives by quadratics through five samples; method thesis
    #[cfg_attr(feature = "cli", arg(long, conflicts_with = "cutoffs"))]
    pub unsmoothed: bool,
    /// Go on although the check of the record refuses it; the result says so
    #[cfg_attr(feature = "cli", arg(long))]
    pub accept_record: bool,
}

/// Cut-off frequency of a channel's smoothing.
///
/// ```
/// use windfall::{Cutoff, Identify};
/// let all = Cutoff { channel: "all".to_owned(), hz: 3.0 };
/// let order = Identify { cutoffs: vec![all], ..Identify::default() };
/// assert!(!order.unsmoothed);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cutoff {
    /// Channel of the run file (`X_m` or `X`), or `all`.
    pub channel: String,
    /// Frequency at which half of the amplitude passes, Hz.
    pub hz: f64,
}

impl Cutoff {
    /// Sets the frequencies of the channels that it names.
    fn set(&self, cutoffs_hz: &mut PerChannel<f64>) -> Result<()> {
        let short = |name: &'static str| name.split('_').next().unwrap_or(name);
        let named = |name: &'static str| self.channel == "all" || self.channel == name || self.channel == short(name);
        let wrong = |what: String| Err(Error::Request(format!("cutoffs {} = {}: {what}", self.channel, self.hz)));
        if !(self.hz.is_finite() && self.hz > 0.0) {
            return wrong("needs a finite frequency above 0, in Hz; 1e6 leaves every frequency".to_owned());
        }
        if !CHANNEL_NAMES.into_iter().any(named) {
            return wrong(format!("channels are {}, or all", CHANNEL_NAMES.map(short).join(", ")));
        }
        for (hz, _) in cutoffs_hz.iter_mut().zip(CHANNEL_NAMES).filter(|(_, n)| named(n)) {
            *hz = self.hz;
        }
        Ok(())
    }
}

impl Identify {
    /// How the thesis' method is to smooth, where that is said.
    pub(crate) fn smoother(&self) -> Result<Option<Smoother>> {
        if !self.unsmoothed && self.cutoffs.is_empty() {
            return Ok(None);
        }
        let word = if self.unsmoothed { "unsmoothed" } else { "cutoffs" };
        if self.unsmoothed && !self.cutoffs.is_empty() {
            return Err(Error::Request("unsmoothed or cutoffs, not both".to_owned()));
        }
        if self.method != Some(Method::Thesis) {
            let given = self.method.map_or("none is asked for", Method::name);
            let what = format!("{word}: only the thesis' method smooths as it is told (method: {given}); add --method thesis");
            return Err(Error::Request(what));
        }
        if self.unsmoothed {
            return Ok(Some(Smoother::Unsmoothed));
        }
        let mut cutoffs_hz = TABLE_3_1_HZ;
        self.cutoffs.iter().try_for_each(|c| c.set(&mut cutoffs_hz))?;
        Ok(Some(Smoother::Thesis { cutoffs_hz }))
    }
    /// The order to the loop, of sound numbers.
    pub(crate) fn order(&self) -> Result<windfall_discover::IdentifyOrder> {
        let wrong = |what: String| Err(Error::Request(what));
        if let Some(h) = self.hold.iter().find(|h| !h.value.is_finite()) {
            return wrong(format!("hold {}: needs a finite number", h.name));
        }
        if let Some(p) = self.prior.iter().find(|p| !(p.mean.is_finite() && p.std.is_finite() && p.std > 0.0)) {
            return wrong(format!("prior {}: needs a finite mean and a standard deviation above 0", p.name));
        }
        if let Some(n) = self.bootstrap.filter(|n| !(2..=MOST_COPIES).contains(n)) {
            return wrong(format!("bootstrap = {n}: needs two copies or more, and at most {MOST_COPIES}"));
        }
        Ok(windfall_discover::IdentifyOrder {
            method: self.method,
            combined_only: self.combined,
            hold: self.hold.clone(),
            tie: self.tie.clone(),
            prior: self.prior.clone(),
            bootstrap: self.bootstrap.map(usize::from),
            smoother: self.smoother()?,
            accept_record: self.accept_record,
        })
    }
}

/// Methods by name, each with a line of help.
#[cfg(feature = "cli")]
fn method() -> impl clap::builder::TypedValueParser<Value = Method> {
    use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser as _};
    let named = PossibleValuesParser::new(Method::ALL.map(|m| PossibleValue::new(m.name()).help(m.help())));
    named.try_map(|name| Method::of_name(&name).ok_or_else(|| Error::Request(format!("no method {name}"))))
}

/// Which aerodynamic terms to look for.
///
/// ```
/// use windfall::Structure;
/// let request = Structure { criterion: windfall::criterion("bic")? };
/// assert_ne!(request, Structure::default());
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct Structure {
    /// By which terms are chosen: likelihood (trajectories and gusts), subset or f or agreed (regression, residuals of any colour), bic,
    /// pse, press, cross-validation; white-f and white-pse take residuals as white
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME", default_value = "likelihood", value_parser = crate::criterion))]
    pub criterion: Criterion,
}

impl Default for Structure {
    fn default() -> Self {
        Self { criterion: Criterion::Likelihood }
    }
}

/// Which errors are wanted, or which rivals are to part.
///
/// ```
/// use windfall::Plan;
/// let request = Plan { target: vec![windfall::target("Cm_2 = 5%")?], ..Plan::default() };
/// assert_eq!((request.target[0].parameter.as_str(), request.between), ("Cm_2", 60.0));
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct Plan {
    /// Parameter and wanted standard error, in percent of its estimate (Cm_2=5%) or in its unit (Cm_2=10); may be repeated
    #[cfg_attr(feature = "cli", arg(long, value_name = "PARAMETER=ERROR", required_unless_present = "separate", value_parser = crate::target))]
    pub target: Vec<Target>,
    /// Instead: the runs that part the effects these runs cannot tell apart, and sharpen bounds that are wide, for their tunnel time
    #[cfg_attr(feature = "cli", arg(long, conflicts_with = "target"))]
    pub separate: bool,
    /// Time between runs that counts as tunnel time, s
    #[cfg_attr(feature = "cli", arg(long, value_name = "S", default_value_t = Self::default().between, value_parser = crate::seconds))]
    pub between: f64,
    /// With --separate: go on although the check of the record refuses it; the result says so
    #[cfg_attr(feature = "cli", arg(long))]
    pub accept_record: bool,
}

impl Default for Plan {
    fn default() -> Self {
        Self { target: Vec::new(), separate: false, between: 60.0, accept_record: false }
    }
}

/// How often to fly an identified model.
///
/// ```
/// use windfall::Resimulate;
/// let bands = Resimulate { draws: 100, ..Resimulate::default() };
/// assert_eq!((bands.seeds, bands.draws), (1, 100));
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct Resimulate {
    /// Number of seeds over which simulated statistics are averaged
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = Self::default().seeds, value_parser = clap::value_parser!(u16).range(1..=MOST_COPIES.into())))]
    pub seeds: u16,
    /// Also fly N models with parameters drawn from their covariance: 95 % bands on Θ and ω_q,r, intervals of the statistics; 40 to
    /// 200 are enough, 0 is none
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = Self::default().draws, value_parser = clap::value_parser!(u16).range(0..=MOST_COPIES.into())))]
    pub draws: u16,
}

impl Default for Resimulate {
    fn default() -> Self {
        Self { seeds: 1, draws: 0 }
    }
}

impl Resimulate {
    /// Seeds and draws, of sound size.
    pub(crate) fn order(&self) -> Result<(usize, usize)> {
        let wrong = |name: &str, n: u16, low: u16| Err(Error::Request(format!("{name} = {n}: allowed: {low} to {MOST_COPIES}")));
        match (self.seeds, self.draws) {
            (n, _) if !(1..=MOST_COPIES).contains(&n) => wrong("seeds", n, 1),
            (_, n) if n > MOST_COPIES => wrong("draws", n, 0),
            (seeds, draws) => Ok((usize::from(seeds), usize::from(draws))),
        }
    }
}

/// Descents at most: quantiles are known to a thousandth of their probability by then, and each descent keeps some 5 kB.
pub const MOST_DESCENTS: u32 = 1_000_000;

/// How to fly an identified model down.
///
/// ```
/// use windfall::Descend;
/// let few = Descend { draws: 100, seed: Some(7), ..Descend::default() };
/// assert_eq!(serde_json::from_str::<Descend>(r#"{"draws": 100, "seed": 7}"#).expect("a request"), few);
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct Descend {
    /// Number of descents, each with a model drawn from the identification's posterior; where gusts or the start differ as well, each
    /// model flies twice
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", default_value_t = Self::default().draws, value_parser = clap::value_parser!(u32).range(1..=MOST_DESCENTS.into())))]
    pub draws: u32,
    /// Seed of all chance, in place of the scenario's
    #[cfg_attr(feature = "cli", arg(long, value_name = "N"))]
    pub seed: Option<u64>,
    /// Which flight of the scenario [default: the first]
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME"))]
    pub flight: Option<String>,
}

impl Default for Descend {
    fn default() -> Self {
        Self { draws: 1000, seed: None, flight: None }
    }
}

impl Descend {
    /// Draws and seed, of sound size; `seed` where the request has none.
    pub(crate) fn order(&self, seed: u64) -> Result<windfall_replay::descent::DescentOrder> {
        if !(1..=MOST_DESCENTS).contains(&self.draws) {
            return Err(Error::Request(format!("draws = {}: allowed: 1 to {MOST_DESCENTS}", self.draws)));
        }
        Ok(windfall_replay::descent::DescentOrder { draws: self.draws.into(), seed: self.seed.unwrap_or(seed) })
    }
}

/// How to close the loop.
///
/// ```
/// use windfall::Close;
/// assert_eq!(serde_json::to_string(&Close::default()).expect("JSON"), r#"{"accept_record":false}"#);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct Close {
    /// Go on although the check of the record refuses it; the result says so
    #[cfg_attr(feature = "cli", arg(long))]
    pub accept_record: bool,
}

/// How to draw a study into a folder.
///
/// ```
/// use windfall::Study;
/// let share: Study = serde_json::from_str(r#"{"resume": true, "shard": "2/8"}"#).expect("a request");
/// assert!(share.resume && !share.force && share.shard == "2/8".parse().ok());
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct Study {
    /// Go on with the draws that another run of this study left in the folder
    #[cfg_attr(feature = "cli", arg(long, conflicts_with = "force"))]
    pub resume: bool,
    /// Draw share i of n only, i from 1 to n; when all shares are there, --resume without --shard joins them
    #[cfg_attr(feature = "cli", arg(long, value_name = "i/n", value_parser = clap::value_parser!(Shard), conflicts_with = "force"))]
    pub shard: Option<Shard>,
    /// Overwrite results that exist.
    #[cfg_attr(feature = "cli", arg(skip))]
    pub force: bool,
}

impl Study {
    /// How the folder is opened, and which share is drawn.
    pub(crate) fn order(&self) -> Result<(Opening, Shard)> {
        let opening = match (self.resume, self.force) {
            (true, true) => return Err(Error::Request("resume or force, not both".to_owned())),
            (true, false) => Opening::Resume,
            (false, true) => Opening::Force,
            (false, false) => Opening::New,
        };
        match self.shard {
            Some(_) if self.force => Err(Error::Request("shard or force, not both".to_owned())),
            shard => Ok((opening, shard.unwrap_or(Shard::ALL))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::de::DeserializeOwned;
    use std::fmt::Debug;

    fn round_trip<T: Serialize + DeserializeOwned + Debug + PartialEq>(request: T) {
        let json = serde_json::to_string(&request).expect("JSON");
        assert_eq!(serde_json::from_str::<T>(&json).expect(&json), request);
    }

    fn default<T: Serialize + DeserializeOwned + Debug + PartialEq + Default>() {
        round_trip(T::default());
        assert_eq!(serde_json::from_str::<T>("{}").expect("nothing said"), T::default());
        assert!(serde_json::from_str::<T>(r#"{"sed": 1}"#).is_err_and(|e| e.to_string().contains("unknown field `sed`")));
    }

    #[test]
    fn law_requests_are_json_and_misspelt_fields_are_refused() {
        default::<Fly>();
        default::<Identify>();
        default::<Structure>();
        default::<Plan>();
        default::<Resimulate>();
        default::<Close>();
        default::<Study>();
        default::<Descend>();
        round_trip(Identify {
            method: Some(Method::FilterError),
            hold: crate::hold("Cl_0=0.0125").into_iter().collect(),
            tie: crate::tie("Cn_1=Cm_1").into_iter().collect(),
            prior: crate::prior("Cl_p=-5.7±0.3").into_iter().collect(),
            cutoffs: crate::cutoff("X=2").into_iter().collect(),
            ..Identify::default()
        });
        round_trip(Plan { target: crate::target("Cm_2=5%").into_iter().collect(), between: 30.0, ..Plan::default() });
        round_trip(Study { shard: "2/8".parse().ok(), ..Study::default() });
        assert!(serde_json::from_str::<Study>(r#"{"shard": "9/8"}"#).is_err());
    }

    fn cutoff(channel: &str, hz: f64) -> Vec<Cutoff> {
        vec![Cutoff { channel: channel.to_owned(), hz }]
    }
    fn thesis() -> Identify {
        Identify { method: Some(Method::Thesis), ..Identify::default() }
    }

    /// Table 3.1 for what is not named; the last word holds.
    #[test]
    fn exact_cutoffs_by_channel() {
        let all = ["3", "Rx=2.5", "VW_m_s=9"].iter().filter_map(|w| crate::cutoff(w).ok()).collect();
        let of = |cutoffs| Identify { cutoffs, ..thesis() }.smoother().ok().flatten();
        assert_eq!(of(all), Some(Smoother::Thesis { cutoffs_hz: [3.0, 3.0, 3.0, 2.5, 3.0, 3.0, 9.0] }));
        assert_eq!(of(cutoff("Y", 4.0)), Some(Smoother::Thesis { cutoffs_hz: [1.5, 4.0, 1.5, 1.5, 2.5, 2.5, 1.5] }));
        assert_eq!(Identify { unsmoothed: true, ..thesis() }.smoother().ok().flatten(), Some(Smoother::Unsmoothed));
        assert_eq!(thesis().smoother().ok().flatten(), None);
    }

    #[test]
    fn law_what_cannot_be_is_said_before_any_work() {
        let held = Held { name: "Cl_0".to_owned(), value: f64::NAN };
        let prior = Prior { name: "Cl_p".to_owned(), mean: 1.0, std: 0.0 };
        let all = [
            (Identify { hold: vec![held], ..Identify::default() }, "hold Cl_0"),
            (Identify { prior: vec![prior], ..Identify::default() }, "prior Cl_p"),
            (Identify { bootstrap: Some(1), ..Identify::default() }, "bootstrap = 1"),
            (Identify { bootstrap: Some(65_535), ..Identify::default() }, "at most 10000"),
            (Identify { unsmoothed: true, ..Identify::default() }, "add --method thesis"),
            (
                Identify { method: Some(Method::EquationError), cutoffs: cutoff("all", 3.0), ..Identify::default() },
                "equation-error",
            ),
            (Identify { cutoffs: cutoff("P", 3.0), ..thesis() }, "channels are X, Y, Z, Rx, Ry, Rz, VW, or all"),
            (Identify { cutoffs: cutoff("X", f64::INFINITY), ..thesis() }, "1e6 leaves every frequency"),
            (Identify { unsmoothed: true, cutoffs: cutoff("X", 3.0), ..thesis() }, "not both"),
        ];
        for (request, word) in all {
            assert!(request.order().is_err_and(|e| e.to_string().contains(word)), "{word}");
        }
        for (seeds, draws, word) in [(0, 0, "seeds = 0: allowed: 1 to 10000"), (1, 65_535, "draws = 65535")] {
            assert!(Resimulate { seeds, draws }.order().is_err_and(|e| e.to_string().contains(word)), "{word}");
        }
        let many = Descend { draws: MOST_DESCENTS + 1, ..Descend::default() };
        assert!(many.order(1).is_err_and(|e| e.to_string().contains("draws = 1000001: allowed: 1 to 1000000")));
        let both = Study { resume: true, force: true, shard: None };
        assert!(both.order().is_err_and(|e| e.to_string().contains("not both")));
    }
}
