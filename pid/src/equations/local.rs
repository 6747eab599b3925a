//! pid: rates of motion at one instant with their slopes, for filters of any kind. In: state, air. Out: rates and slopes.
//!
//! Forward-mode derivatives of the same formula that is integrated (Wengert 1964), compiled once here.

use super::{Craft, Dual, Extra, LOOSE, STATES, Scalar, TunnelAir};

/// Motion and loose mass: c.m. position, Euler angles, velocity, body rates, then displacement and rate of the loose mass.
pub const MOTION: usize = STATES + LOOSE;
/// What the air may add: gust velocity (3) and its rate (3), tunnel axes; then the six coefficients.
pub const ADDED: usize = 12;

/// Rates of the motion and their slopes.
#[derive(Clone, Copy, Debug)]
pub struct Local {
    /// Rates of the [`MOTION`] states, SI.
    pub rate: [f64; MOTION],
    /// Slopes by the states.
    pub by_state: [[f64; MOTION]; MOTION],
    /// Slopes by what the air adds.
    pub by_added: [[f64; ADDED]; MOTION],
    /// Slopes by tunnel speed and by its rate.
    pub by_speed: [[f64; 2]; MOTION],
}

/// Rates of all states from those of the motion and the loose mass' acceleration.
#[inline(always)]
fn joined<S: Copy>(x: &[S; MOTION], (rate, part): ([S; STATES], [S; 2])) -> [S; MOTION] {
    let mut all = [rate[0]; MOTION];
    all[..STATES].copy_from_slice(&rate);
    all[STATES..].copy_from_slice(&[x[STATES + 2], x[STATES + 3], part[0], part[1]]);
    all
}

#[inline(always)]
fn parts<S: Copy>(x: &[S; MOTION]) -> ([S; STATES], [S; LOOSE]) {
    (std::array::from_fn(|i| x[i]), std::array::from_fn(|i| x[STATES + i]))
}

impl Craft<'_> {
    /// Rates of the motion; `None` where the flow or the Euler angles are not defined.
    #[inline(never)]
    pub fn rates(&self, x: &[f64; MOTION], air: TunnelAir, added: &[f64; ADDED], terms: &mut Vec<f64>) -> Option<[f64; MOTION]> {
        terms.resize(self.terms.acts.len(), 0.0);
        let (motion, part) = parts(x);
        let extra = Extra {
            velocity: std::array::from_fn(|i| added[i]),
            acceleration: std::array::from_fn(|i| added[3 + i]),
            coefficients: std::array::from_fn(|i| added[6 + i]),
        };
        Some(joined(x, self.motion(&motion, &part, air, &extra, &self.plant.aero.values, terms)?))
    }

    /// Rates of the motion and their slopes; `None` where the flow or the Euler angles are not defined.
    #[inline(never)]
    pub fn local(&self, x: &[f64; MOTION], air: TunnelAir, added: &[f64; ADDED], terms: &mut Vec<f64>) -> Option<Local> {
        terms.resize(self.terms.acts.len(), 0.0);
        let parameters = &self.plant.aero.values;
        let by_state = {
            type D = Dual<MOTION>;
            let x: [D; MOTION] = std::array::from_fn(|i| D::variable(x[i], i));
            let (motion, part) = parts(&x);
            let extra = Extra {
                velocity: std::array::from_fn(|i| D::real(added[i])),
                acceleration: std::array::from_fn(|i| D::real(added[3 + i])),
                coefficients: std::array::from_fn(|i| D::real(added[6 + i])),
            };
            joined(&x, self.motion(&motion, &part, air, &extra, parameters, terms)?)
        };
        let by_added = {
            type D = Dual<ADDED>;
            let x: [D; MOTION] = std::array::from_fn(|i| D::real(x[i]));
            let (motion, part) = parts(&x);
            let extra = Extra {
                velocity: std::array::from_fn(|i| D::variable(added[i], i)),
                acceleration: std::array::from_fn(|i| D::variable(added[3 + i], 3 + i)),
                coefficients: std::array::from_fn(|i| D::variable(added[6 + i], 6 + i)),
            };
            joined(&x, self.motion(&motion, &part, air, &extra, parameters, terms)?)
        };
        let shape = self.wind_per_speed(&parts(x).0);
        let dot = |a: &[f64], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        // Apparent mass feels the steady wind's rate otherwise than a gust's: by difference, exact for what is linear.
        let by_rate = if self.plant.vehicle.apparent.is_null() { None } else { Some(self.by_wind(x, air, added, terms)?) };
        let speed = |i: usize| match &by_rate {
            Some(slopes) => slopes[i],
            None => {
                let d = &by_added[i].slopes;
                [dot(&d[..3], &shape.along) + dot(&d[3..6], &shape.rate), dot(&d[3..6], &shape.along)]
            }
        };
        Some(Local {
            rate: by_state.map(|d| d.value),
            by_state: by_state.map(|d| d.slopes),
            by_added: by_added.map(|d| d.slopes),
            by_speed: std::array::from_fn(speed),
        })
    }

    /// Slopes by tunnel speed and its rate as central differences.
    fn by_wind(
        &self,
        x: &[f64; MOTION],
        air: TunnelAir,
        added: &[f64; ADDED],
        terms: &mut Vec<f64>,
    ) -> Option<[[f64; 2]; MOTION]> {
        const STEP: f64 = 1e-4;
        let mut at = |v: f64, r: f64| {
            self.rates(x, TunnelAir { vw_m_s: air.vw_m_s + v, vw_rate_m_s2: air.vw_rate_m_s2 + r, ..air }, added, terms)
        };
        let (up, down, more, less) = (at(STEP, 0.0)?, at(-STEP, 0.0)?, at(0.0, STEP)?, at(0.0, -STEP)?);
        Some(std::array::from_fn(|i| [(up[i] - down[i]) / (2.0 * STEP), (more[i] - less[i]) / (2.0 * STEP)]))
    }
}
