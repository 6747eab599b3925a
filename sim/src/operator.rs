//! sim: the operator's hand and the fan. In: height and sinking rate of the model. Out: rate of tunnel speed.

use crate::noise::{realise_filter, samples};
use crate::seed::{Channel, Seed};
use crate::smooth::Smooth;
use windfall_model::{Operator, ShapingFilter};

/// An operator with his hand's unsteadiness drawn, ready to fly. States: tunnel speed (m/s) and integral of height error (m s).
#[derive(Clone, Debug)]
pub(crate) struct Hand {
    pub(crate) order: Operator,
    pub(crate) trim_m_s: f64,
    pub(crate) unsteady: Option<Smooth>,
}

impl Hand {
    pub(crate) fn new(order: Operator, trim_m_s: f64, duration_s: f64, seed: Seed) -> Self {
        let unsteady = (order.unsteady_rms_m_s > 0.0).then(|| {
            let grid_s = grid_s(&order);
            let n = samples(grid_s, duration_s);
            Smooth::new(grid_s, &realise_filter(&unsteady_filter(&order), grid_s, n, seed.normals(Channel::Operator)))
        });
        Self { order, trim_m_s, unsteady }
    }
    /// Longest step that still sees the unsteady hand, s.
    pub(crate) fn step_max_s(&self) -> f64 {
        if self.unsteady.is_some() { 8.0 * grid_s(&self.order) } else { f64::INFINITY }
    }
    /// States at release: the fan at trim, nothing integrated.
    pub(crate) fn start(&self) -> [f64; 2] {
        [self.trim_m_s, 0.0]
    }
    /// Rates of `[V_W, ∫ error]` with the c.m. at height `x_m` (tunnel X) sinking at `sink_m_s`:
    /// `V̇_W = (V_trim + K_h e + K_r Ẋ + K_i ∫e + n(t) − V_W)/lag`, `e = X − X_hold`.
    #[inline]
    pub(crate) fn rates(&self, t_s: f64, x_m: f64, sink_m_s: f64, state: [f64; 2]) -> [f64; 2] {
        let o = &self.order;
        let error = x_m - o.hold_x_m;
        let unsteady = self.unsteady.as_ref().map_or(0.0, |s| s.at(t_s).0);
        let wanted =
            self.trim_m_s + o.height_gain_per_s * error + o.rate_gain * sink_m_s + o.integral_gain_per_s2 * state[1] + unsteady;
        [(wanted - state[0]) / o.lag_s, error]
    }
}

fn grid_s(o: &Operator) -> f64 {
    o.unsteady_time_s / 32.0
}

/// Critically damped filter of second order: correlation `(1 + |τ|/T) exp(−|τ|/T)`, whose integral over τ > 0 is 2T, the
/// stated correlation time.
fn unsteady_filter(o: &Operator) -> ShapingFilter<2> {
    let t = 0.5 * o.unsteady_time_s;
    ShapingFilter {
        a: [[0.0, 1.0], [-1.0 / (t * t), -2.0 / t]],
        b: [0.0, 2.0 * o.unsteady_rms_m_s / (t * t.sqrt())],
        c: [1.0, 0.0],
    }
}
