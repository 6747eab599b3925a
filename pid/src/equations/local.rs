//! pid: rates of motion at one instant with their slopes, for filters of any kind. In: state, air. Out: rates and slopes.
//!
//! Forward-mode derivatives of the same formula that is integrated (Wengert 1964), compiled once here for each vector unit.

use super::{Craft, Dual, Extra, LOOSE, STATES, Scalar, TunnelAir};
use pulp::{Arch, Simd, WithSimd};

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

/// By what slopes are taken.
#[derive(Clone, Copy, PartialEq)]
enum By {
    Motion,
    Loose,
    Added,
}

/// What is linearised, and where.
struct Linearised<'w, 'p> {
    craft: &'w Craft<'p>,
    x: &'w [f64; MOTION],
    air: TunnelAir,
    added: &'w [f64; ADDED],
    terms: &'w mut [f64],
}

impl WithSimd for Linearised<'_, '_> {
    type Output = Option<Local>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Option<Local> {
        let Self { craft, x, air, added, terms } = self;
        let mut local = Local {
            rate: [0.0; MOTION],
            by_state: [[0.0; MOTION]; MOTION],
            by_added: [[0.0; ADDED]; MOTION],
            by_speed: [[0.0; 2]; MOTION],
        };
        type D = Dual<STATES>;
        const { assert!(STATES == ADDED && LOOSE <= STATES) }
        // By twelve directions at a time: larger numbers are copied by calls. One call for all three, for it is long and copied, too.
        for by in [By::Motion, By::Loose, By::Added] {
            if by == By::Loose && craft.plant.vehicle.loose.is_none() {
                continue;
            }
            let one = |of: By, value: f64, i: usize| if by == of { D::variable(value, i) } else { D::real(value) };
            let (mut motion, mut part, mut coefficients) = ([D::default(); STATES], [D::default(); LOOSE], [D::default(); 6]);
            motion.iter_mut().enumerate().for_each(|(i, d)| *d = one(By::Motion, x[i], i));
            part.iter_mut().enumerate().for_each(|(i, d)| *d = one(By::Loose, x[STATES + i], i));
            coefficients.iter_mut().enumerate().for_each(|(i, d)| *d = one(By::Added, added[6 + i], 6 + i));
            let extra = Extra {
                velocity: each!(|i| one(By::Added, added[i], i)),
                acceleration: each!(|i| one(By::Added, added[3 + i], 3 + i)),
                coefficients,
            };
            let (motion, acceleration) = craft.motion(&motion, &part, air, &extra, &craft.plant.aero.values, terms)?;
            let loose = (0..2).map(|k| (STATES + 2 + k, &acceleration[k]));
            for (i, d) in motion.iter().enumerate().chain(loose) {
                local.rate[i] = d.value;
                match by {
                    By::Motion => local.by_state[i][..STATES].copy_from_slice(&d.slopes),
                    By::Loose => local.by_state[i][STATES..].copy_from_slice(&d.slopes[..LOOSE]),
                    By::Added => local.by_added[i] = d.slopes,
                }
            }
        }
        for k in 0..2 {
            local.rate[STATES + k] = x[STATES + 2 + k];
            if craft.plant.vehicle.loose.is_some() {
                local.by_state[STATES + k][STATES + 2 + k] = 1.0;
            }
        }
        Some(local)
    }
}

/// Constants.
#[inline(always)]
fn constants<S: Scalar, const N: usize>(values: &[f64]) -> [S; N] {
    let mut all = [S::default(); N];
    all.iter_mut().zip(values).for_each(|(one, v)| *one = S::real(*v));
    all
}

/// What the air adds, as constants.
#[inline(always)]
fn given<S: Scalar>(added: &[f64; ADDED]) -> Extra<S> {
    Extra { velocity: constants(&added[..3]), acceleration: constants(&added[3..6]), coefficients: constants(&added[6..]) }
}

impl Craft<'_> {
    /// Rates of the motion; `None` where the flow or the Euler angles are not defined.
    #[inline(never)]
    pub fn rates(&self, x: &[f64; MOTION], air: TunnelAir, added: &[f64; ADDED], terms: &mut Vec<f64>) -> Option<[f64; MOTION]> {
        terms.resize(self.terms.acts.len(), 0.0);
        let (motion, part): ([f64; STATES], [f64; LOOSE]) = (constants(&x[..STATES]), constants(&x[STATES..]));
        let (rate, acceleration) = self.motion(&motion, &part, air, &given(added), &self.plant.aero.values, terms)?;
        let mut all = [0.0; MOTION];
        all[..STATES].copy_from_slice(&rate);
        all[STATES..].copy_from_slice(&[part[2], part[3], acceleration[0], acceleration[1]]);
        Some(all)
    }

    /// Rates of the motion and their slopes; `None` where the flow or the Euler angles are not defined.
    pub fn local(&self, x: &[f64; MOTION], air: TunnelAir, added: &[f64; ADDED], terms: &mut Vec<f64>) -> Option<Local> {
        terms.resize(self.terms.acts.len(), 0.0);
        let mut local = Arch::new().dispatch(Linearised { craft: self, x, air, added, terms })?;
        // Apparent mass feels the steady wind's rate otherwise than a gust's: by difference, exact for what is linear.
        if !self.plant.vehicle.apparent.is_null() {
            local.by_speed = self.by_wind(x, air, added, terms)?;
            return Some(local);
        }
        let shape = self.wind_per_speed(&constants(&x[..STATES]));
        let dot = |a: &[f64], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        for (slopes, d) in local.by_speed.iter_mut().zip(&local.by_added) {
            *slopes = [dot(&d[..3], &shape.along) + dot(&d[3..6], &shape.rate), dot(&d[3..6], &shape.along)];
        }
        Some(local)
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

#[cfg(test)]
mod tests;
