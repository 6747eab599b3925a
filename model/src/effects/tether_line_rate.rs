//! model: effect `tether-line-rate`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "tether-line-rate",
    acts: Acts::Lander,
    physics: "The line resists being pulled through the ring: friction and the momentum of the line oppose motion along it. A line that is let go does not push: it goes slack.",
    source: "Thesis §6.1 (tether carries momentum that opposes motion)",
    separate_by: "runs with vertical bounces at several speeds, and one without tether",
    parameters: |_| vec![Parameter::strength("n_s_per_m", "N s/m", 5.0)],
    apply: |plant, v| {
        if let Some(t) = &mut plant.tether {
            t.line_rate_n_s_m += v[0];
        }
    },
};
