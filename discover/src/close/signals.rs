//! discover: series of signals over time. In: nothing. Out: what `tracks.json`, `coefficients.json` and `flights.json` hold.

use super::Role;
use serde::{Deserialize, Serialize};
use windfall_model::Run;

/// What is drawn of the body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BodyShape {
    /// True for a model in a tunnel; a point body is drawn as a sphere.
    pub rigid: bool,
    /// True for a rigid body in free flight, whose channels are roll, pitch and heading: drawn as a box with nose and fin.
    #[serde(default)]
    pub free: bool,
    /// Reference diameter, m.
    pub diameter_m: f64,
    /// Centre of mass from the geometric origin, body axes, m.
    pub center_of_mass_m: [f64; 3],
    /// Tether's attachment, body axes, m; none in free flight.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attachment_m: Option<[f64; 3]>,
    /// Tether's ring, tunnel axes, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ring_m: Option<[f64; 3]>,
}

/// Signals of some runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SignalTracks {
    /// Campaign.
    #[serde(default)]
    pub campaign: String,
    /// What is drawn of the body.
    #[serde(default)]
    pub body: BodyShape,
    /// What the model of role `before` is called; empty where there is none.
    #[serde(default)]
    pub before: String,
    /// What the model of role `after` is called; empty where there is none.
    #[serde(default)]
    pub after: String,
    /// Each run.
    pub runs: Vec<RunTracks>,
}

/// Signals of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunTracks {
    /// Name.
    pub name: String,
    /// Kind.
    pub kind: String,
    /// `identify`, `select` or `hold-out`.
    #[serde(rename = "use")]
    pub used: String,
    /// Times from the first sample, s.
    pub t_s: Vec<f64>,
    /// Signals.
    pub channels: Vec<TrackSignal>,
    /// What reading the file bridged, removed or split.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Times from the first sample, s, between which a chart takes its scale: beyond, the smoother hangs on one side. None where the whole
    /// run sets it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interior_s: Option<[f64; 2]>,
}

/// One signal. A series that ends early was flown no further; an empty one is not known.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrackSignal {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Standard deviation of its sensor's noise as declared; none where it is no raw signal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise_std: Option<f64>,
    /// Measured.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub measured: Vec<f64>,
    /// With the declared model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub before: Vec<f64>,
    /// With the effects added, or with the identified model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub after: Vec<f64>,
}

impl TrackSignal {
    pub(super) fn new(name: &str, unit: &str, noise_std: Option<f64>) -> Self {
        let none = Vec::new;
        Self { name: name.to_owned(), unit: unit.to_owned(), noise_std, measured: none(), before: none(), after: none() }
    }
    pub(super) fn side(&mut self, role: Role) -> &mut Vec<f64> {
        match role {
            Role::Measured | Role::Noise => &mut self.measured,
            Role::Before => &mut self.before,
            Role::After => &mut self.after,
        }
    }
}

/// A run without series.
pub(super) fn named(run: &Run) -> RunTracks {
    RunTracks {
        name: run.name.clone(),
        kind: run.kind.clone(),
        used: run.used.name().to_owned(),
        t_s: Vec::new(),
        channels: Vec::new(),
        notes: run.notes.clone(),
        interior_s: None,
    }
}
