//! likelihood: what moves the model at random, as states driven by white noise. In: a plant's disturbances. Out: their transitions.
//!
//! A gust of Dryden's form (MIL-F-8785C 1980) is seen through a short lag that makes its rate a state, so that what follows the gust's rate
//! (α̇, apparent mass) feels a finite one; that of a band has one without. A narrow-band moment is an oscillator.
//!
//! A spectrum has a form of its own and others that the runs may prefer ([`Spectra`]): where gusts end at a frequency, a filter that falls off
//! gently beyond it expects motion that is not there, and damping and rates make up for it.

use nalgebra::{Matrix2, Matrix3, SMatrix, SVector};
use std::f64::consts::FRAC_1_SQRT_2;
use windfall_model::{Disturbance, Entry, Plant, Shape};

/// Most states of one random input: a steep band needs six, a gentle one four, Dryden's form three, an oscillator two.
pub(crate) const ORDER: usize = 6;
const SQUARE: usize = ORDER * ORDER;
/// States with their first, second and third integrals over a step.
const WITH_SUMS: usize = 4 * ORDER;
/// The short lag over the gust's own time, and its bounds, s.
const FAST: f64 = 0.1;
const FAST_S: [f64; 2] = [0.002, 0.02];

type Rates = SMatrix<f64, ORDER, ORDER>;
type States = SVector<f64, ORDER>;

/// Size of a band's gusts that lies outside the band, over the size in it: no tunnel's spectrum is empty there, and a filter that is told so
/// follows no slow motion that it has once lost.
const OUTSIDE: f64 = 0.03;

/// A matrix over one input's states.
pub(crate) type Block = [[f64; ORDER]; ORDER];

/// States driven by white noise, over a step: what a motion that follows them needs of them, exactly, however short their own
/// times are.
#[derive(Clone, Debug)]
struct Driven {
    /// Transition of the states.
    whole: Rates,
    /// First, second and third integrals over the step, by the states at its start.
    sums: [Rates; 3],
    /// Covariance that a step adds to the states and those integrals.
    added: Box<SMatrix<f64, WITH_SUMS, WITH_SUMS>>,
    /// Values at each quarter of a step, by the states, that give these integrals in two Runge-Kutta steps.
    stages: [Rates; QUARTERS],
}

/// Instants at which a step in two halves takes its inputs, by the classical Runge-Kutta method.
pub(crate) const QUARTERS: usize = 5;

/// Integrals that move a body over a step: first, second and third, each of the input and of its rate.
pub(crate) const REACH: usize = 6;

/// One random input ready for a step. Its first state is the input itself.
#[derive(Clone, Debug)]
pub(crate) struct Input {
    pub(crate) entry: Entry,
    /// Number of its states; the rest of what follows is zero.
    pub(crate) order: usize,
    /// Rate of the input by its states (a gust's); zero for others.
    pub(crate) rate: [f64; ORDER],
    /// Transition of the states over a step, and the covariance that it adds.
    pub(crate) whole: Block,
    pub(crate) added: Block,
    /// Values at each quarter of a step, by the states, that give the step's integrals.
    pub(crate) stages: [Block; QUARTERS],
    /// Integrals over a step by the states at its start, the covariance that it adds to them, and to them with the states.
    pub(crate) reach: [[f64; ORDER]; REACH],
    pub(crate) reach_added: [[f64; REACH]; REACH],
    pub(crate) crossed: [[f64; ORDER]; REACH],
    /// Covariance in the long run.
    pub(crate) stationary: Block,
    /// Standard deviation of what changes from step to step beside it.
    pub(crate) broad: f64,
}

/// Forms of spectra in place of a plant's own, of the same sizes and scales.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Spectra {
    /// Von Kármán's in place of Dryden's.
    pub(crate) von_karman: bool,
    /// Bands with steep edges in place of Butterworth's.
    pub(crate) steep: bool,
}

/// The random inputs of a plant at mean speed, for steps of `step_s`.
pub(crate) fn inputs(plant: &Plant, speed_m_s: f64, step_s: f64, spectra: Spectra) -> Vec<Input> {
    plant.disturbances(speed_m_s).iter().map(|d| input(d, step_s, spectra)).collect()
}

fn rows(m: &Rates) -> Block {
    std::array::from_fn(|i| std::array::from_fn(|k| m[(i, k)]))
}

/// A step is made of short ones, each twice the one before.
const DOUBLINGS: i32 = 9;

fn driven(a: &Rates, b: &States, step_s: f64) -> Driven {
    type Wide = SMatrix<f64, WITH_SUMS, WITH_SUMS>;
    // The states, and chains of integrals behind them.
    let mut f = Wide::zeros();
    f.fixed_view_mut::<ORDER, ORDER>(0, 0).copy_from(a);
    (0..3 * ORDER).for_each(|i| f[(ORDER + i, i)] = 1.0);
    let mut drive = SVector::<f64, WITH_SUMS>::zeros();
    drive.fixed_rows_mut::<ORDER>(0).copy_from(b);
    let short = step_s / 2.0_f64.powi(DOUBLINGS);
    let exp = |t: f64| {
        let m = f * t;
        let m2 = m * m;
        Wide::identity() + m + m2 * 0.5 + m * m2 / 6.0 + m2 * m2 / 24.0
    };
    // ∫ e^{Fs} b bᵀ e^{Fᵀs} ds over the shortest by Gauss's rule of three points.
    let root = 0.6_f64.sqrt();
    let mut added = Wide::zeros();
    for (x, w) in [(-root, 5.0 / 18.0), (0.0, 8.0 / 18.0), (root, 5.0 / 18.0)] {
        let v = exp(0.5 * short * (1.0 + x)) * drive;
        added += v * v.transpose() * (w * short);
    }
    let mut phi = exp(short);
    for _ in 0..DOUBLINGS {
        added += phi * added * phi.transpose();
        phi *= phi;
    }
    let sum = |k: usize| phi.fixed_view::<ORDER, ORDER>(ORDER * (k + 1), 0).into_owned();
    let (j0, j1, j2) = (sum(0), sum(1), sum(2));
    let h = step_s;
    // Simpson's sums of start, middle and end are the integrals, weighted by (h - s)^k / k! for k = 0, 1, 2; those of two halves with a parabola
    // through them are the same for k = 0 and 1.
    let start = j2 * (24.0 / h.powi(3)) - j1 * (6.0 / (h * h));
    let middle = j1 * (6.0 / (h * h)) - j2 * (12.0 / h.powi(3));
    let end = j0 * (6.0 / h) - j1 * (18.0 / (h * h)) + j2 * (24.0 / h.powi(3));
    let quarter = |near: Rates, far: Rates| near * 0.375 + middle * 0.75 - far * 0.125;
    let stages = [start, quarter(start, end), middle, quarter(end, start), end];
    Driven { whole: phi.fixed_view::<ORDER, ORDER>(0, 0).into_owned(), sums: [j0, j1, j2], added: Box::new(added), stages }
}

fn input(d: &Disturbance, step_s: f64, spectra: Spectra) -> Input {
    let is_gust = matches!(d.entry, Entry::AirVelocity(_));
    let spectra = if is_gust { spectra } else { Spectra::default() };
    // Rates of the states, where white noise enters, and the form by the states.
    let (order, (a, b, form)) = match d.shape {
        Shape::Constant => return constant(d),
        Shape::DrydenLongitudinal { time_s } if !is_gust => (1, first_order(time_s)),
        Shape::DrydenLongitudinal { time_s } if spectra.von_karman => (3, ratio(time_s, &ALONG)),
        Shape::DrydenLateral { time_s } if spectra.von_karman => (4, ratio(time_s, &ACROSS)),
        Shape::DrydenLongitudinal { time_s } => (3, gust(time_s, 1.0)),
        Shape::DrydenLateral { time_s } => (3, gust(time_s, 3.0_f64.sqrt())),
        Shape::Band { centre_rad_s, bandwidth_rad_s } => {
            let edges: &[Pole] = if spectra.steep { &CHEBYSHEV } else { &BUTTERWORTH };
            band(centre_rad_s, bandwidth_rad_s / centre_rad_s, edges)
        }
        Shape::Narrow { centre_rad_s: w, bandwidth_rad_s } => {
            let (mut a, mut b) = (-Rates::identity(), States::zeros());
            a.fixed_view_mut::<2, 2>(0, 0).copy_from(&Matrix2::new(0.0, 1.0, -w * w, -bandwidth_rad_s));
            b[1] = 1.0;
            (2, (a, b, States::x()))
        }
    };
    let p = lyapunov(&a, &b);
    // The size is that of the form itself: the lag takes off its fast part, and must not add to the slow one.
    let share = match d.shape {
        Shape::DrydenLongitudinal { .. } if spectra.von_karman => ALONG.share,
        Shape::DrydenLateral { .. } if spectra.von_karman => ACROSS.share,
        _ => 1.0,
    };
    let size = d.rms * (share / (form.transpose() * p * form)[(0, 0)]).sqrt();
    let rate = if is_gust { a.row(0).transpose() } else { States::zeros() };
    let step = driven(&a, &(b * size), step_s);
    // Rows that make the integrals of the input and of its rate from those of the states.
    let mut of_sums = SMatrix::<f64, REACH, WITH_SUMS>::zeros();
    for level in 0..REACH / 2 {
        of_sums[(2 * level, ORDER * (level + 1))] = 1.0;
        of_sums.fixed_view_mut::<1, ORDER>(2 * level + 1, ORDER * (level + 1)).copy_from(&rate.transpose());
    }
    let crossed = of_sums * step.added.fixed_view::<WITH_SUMS, ORDER>(0, 0);
    let reach_added = of_sums * *step.added * of_sums.transpose();
    let reach = |r: usize, c: usize| {
        let sums = &step.sums[r / 2];
        if r.is_multiple_of(2) { sums[(0, c)] } else { rate.dot(&sums.column(c)) }
    };
    Input {
        entry: d.entry,
        order,
        rate: rate.into(),
        whole: rows(&step.whole),
        added: rows(&step.added.fixed_view::<ORDER, ORDER>(0, 0).into_owned()),
        stages: step.stages.map(|m| rows(&m)),
        reach: std::array::from_fn(|r| std::array::from_fn(|c| reach(r, c))),
        reach_added: std::array::from_fn(|r| std::array::from_fn(|c| reach_added[(r, c)])),
        crossed: std::array::from_fn(|r| std::array::from_fn(|c| crossed[(r, c)])),
        stationary: rows(&(p * (size * size))),
        broad: if matches!(d.shape, Shape::Band { .. }) { OUTSIDE * d.rms } else { 0.0 },
    }
}

/// `1/(1 + T s)` without a lag: rates of the states, where white noise enters, and the form by the states.
fn first_order(time_s: f64) -> (Rates, States, States) {
    // The other states stay at zero.
    (Rates::from_diagonal_element(-1.0 / time_s), States::x(), States::x())
}

/// One number for the whole of a run.
fn constant(d: &Disturbance) -> Input {
    let mut one = [[0.0; ORDER]; ORDER];
    one[0][0] = 1.0;
    let mut stationary = [[0.0; ORDER]; ORDER];
    stationary[0][0] = d.rms * d.rms;
    Input {
        entry: d.entry,
        order: 1,
        rate: [0.0; ORDER],
        whole: one,
        added: [[0.0; ORDER]; ORDER],
        stages: [one; QUARTERS],
        reach: [[0.0; ORDER]; REACH],
        reach_added: [[0.0; REACH]; REACH],
        crossed: [[0.0; ORDER]; REACH],
        stationary,
        broad: 0.0,
    }
}

/// `(1 + ζ T s)/(1 + T s)²` behind a short lag: ζ = 1 along the stream, √3 across it. Rates of the states, where white noise enters, and the
/// form before the lag by the states.
fn gust(time_s: f64, zeta: f64) -> (Rates, States, States) {
    let fast = 1.0 / (FAST * time_s).clamp(FAST_S[0], FAST_S[1]);
    let per = 1.0 / time_s;
    // The form's state and, in units of 1/T, its rate.
    let mut a = -Rates::identity();
    a.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::new(-fast, fast, fast * zeta, 0.0, 0.0, per, 0.0, -per, -2.0 * per));
    (a, States::z(), States::y() + zeta * States::z())
}

/// A ratio of polynomials of `T s`, coefficients by rising power, that is near a form of von Kármán's (Campbell, Monte Carlo turbulence
/// simulation using rational approximations to von Karman spectra, AIAA J. 24, 1986), and its share of that form's variance: it has less of
/// what is fast.
struct Ratio {
    above: &'static [f64],
    below: &'static [f64],
    share: f64,
}
const ALONG: Ratio = Ratio { above: &[1.0, 0.25], below: &[1.0, 1.357, 0.1987], share: 0.9686 };
const ACROSS: Ratio = Ratio { above: &[1.0, 2.7478, 0.3398], below: &[1.0, 2.9958, 1.9754, 0.1539], share: 0.9623 };

/// Such a ratio behind the same lag as [`gust`].
fn ratio(time_s: f64, of: &Ratio) -> (Rates, States, States) {
    let fast = 1.0 / (FAST * time_s).clamp(FAST_S[0], FAST_S[1]);
    let (per, last) = (1.0 / time_s, of.below.len() - 1);
    let (mut a, mut b, mut form) = (-Rates::identity(), States::zeros(), States::zeros());
    a[(0, 0)] = -fast;
    for (k, x) in of.above.iter().enumerate() {
        (form[1 + k], a[(0, 1 + k)]) = (*x, fast * x);
    }
    // A state and its derivatives, time in units of T.
    for k in 1..last {
        (a[(k, k)], a[(k, k + 1)]) = (0.0, per);
    }
    for (k, x) in of.below[..last].iter().enumerate() {
        a[(last, 1 + k)] = -per * x / of.below[last];
    }
    b[last] = 1.0;
    (a, b, form)
}

/// A pole of a low-pass filter whose half power is at 1 rad/s, on or above the real axis.
type Pole = [f64; 2];
/// Butterworth's of second order (1930), maximally flat.
const BUTTERWORTH: [Pole; 1] = [[-FRAC_1_SQRT_2, FRAC_1_SQRT_2]];
/// Chebyshev's of third order and 1.4 dB ripple (Zverev, Handbook of Filter Synthesis, 1967, §3), `-sinh v sin θ + j cosh v cos θ` with
/// tanh v = 0.4 over the half-power frequency.
const CHEBYSHEV: [Pole; 2] = [[-0.204_808_291_492_126, 0.886_845_916_689_347], [-0.409_616_582_984_252, 0.0]];

/// A low-pass filter made a band-pass one, `p -> (s² + 1)/(b s)` with s in units of the centre: sections `b s/(s² + d s + w)` in a row,
/// two for each pole above the axis. States are outputs and their integrals, the last section's first; white noise enters the first section,
/// so that the output's rate has none.
fn band(centre_rad_s: f64, b: f64, poles: &[Pole]) -> (usize, (Rates, States, States)) {
    let mut a = -Rates::identity();
    let mut order = 0;
    for &[re, im] in poles {
        let p = nalgebra::Complex::new(b * re, b * im);
        let root = (p * p - 4.0).sqrt();
        let halves = [(p + root) * 0.5, (p - root) * 0.5].map(|s| [-2.0 * s.re, s.norm_sqr()]);
        let own = [[-b * re, 1.0]];
        for &[d, w] in if im > 0.0 { &halves[..] } else { &own[..] } {
            if order > 0 {
                a[(order - 2, order)] = 1.0;
            }
            (a[(order, order)], a[(order, order + 1)]) = (-d, -w);
            (a[(order + 1, order)], a[(order + 1, order + 1)]) = (1.0, 0.0);
            order += 2;
        }
    }
    (order, (a * centre_rad_s, States::ith(order - 2, 1.0), States::x()))
}

/// Stationary covariance: `A P + P Aᵀ + b bᵀ = 0`.
fn lyapunov(a: &Rates, b: &States) -> Rates {
    let mut m = SMatrix::<f64, SQUARE, SQUARE>::zeros();
    for i in 0..ORDER {
        for k in 0..ORDER {
            for l in 0..ORDER {
                m[(ORDER * i + k, ORDER * l + k)] += a[(i, l)];
                m[(ORDER * i + k, ORDER * i + l)] += a[(k, l)];
            }
        }
    }
    let right = SVector::<f64, SQUARE>::from_fn(|j, _| -b[j / ORDER] * b[j % ORDER]);
    let p = m.lu().solve(&right).unwrap_or_else(SVector::zeros);
    Rates::from_fn(|i, k| 0.5 * (p[ORDER * i + k] + p[ORDER * k + i]))
}

#[cfg(test)]
mod tests;
