//! likelihood: how well sizes and shapes of random members are known. In: a fit. Out: standard deviation and 95 % interval of each.
//!
//! Of short gusts the motion shows the product of their variance and their length; the likelihood of the length alone falls off slowly on one
//! side and steeply on the other, which no standard error at its top says. Where the logarithm of a shape is known worse than [`WIDE`] the
//! posterior is walked along its ridge (profile likelihood: Pawitan, In All Likelihood, 2001, §3.4), flat beforehand in the logarithm.
//! Dryden's gusts and von Kármán's of another size and length move a model alike: intervals are the average's over both forms, by
//! their likelihoods (Hoeting et al., Bayesian model averaging, Statistical Science 14, 1999).
//!
//! No filter's spectrum ends like a band's. The likeliest size follows what the record shows best, the lower edge: bands came out a twentieth to a
//! third too weak. A band's size is therefore the mean square of the smoothed gusts (`blown.rs`), and where its upper edge lies beyond what is seen
//! only the form says so: the part that is not seen may be twice as large.

use crate::blown::Blown;
use crate::engine::{Engine, Fit, penalty};
use crate::model::Model;
use crate::random_fit::{log_range, random_numbers};
use nalgebra::DMatrix;
use windfall_model::{Disturbance, Entry, Role, Shape};
use windfall_pid::NORMAL_95;

/// What is known of one number of a random member.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RandomRange {
    /// Member of the model and its number.
    pub place: (usize, usize),
    /// Its estimate: the model's own, but of a band's size that of the gusts that blew.
    pub value: f64,
    /// Root mean square departure from the estimate.
    pub std: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

/// Standard error of a shape's logarithm beyond which its posterior is walked.
const WIDE: f64 = 0.15;
/// Growth of the walk's steps, of which the first is that standard error or, where the top is flat or an end of the range, less; most steps to a
/// side; the fall of the log posterior at which it ends.
const GROWTH: f64 = 1.5;
const LONGEST_FIRST: f64 = 0.5;
const MOST: usize = 12;
const FALLEN: f64 = 6.0;
/// Step in the logarithm of the size for the parabola across the ridge, and the farthest that its top is believed.
const ACROSS: f64 = 0.1;
const FARTHEST: f64 = 0.4;

/// A place on the ridge: logarithm of the shape, log posterior, logarithm of the size there with its standard deviation.
#[derive(Clone, Copy, Debug)]
struct RidgePoint {
    shape: f64,
    height: f64,
    size: f64,
    spread: f64,
}

/// 95 % interval of a number whose logarithm is known to `s`, within its plausible range: an unknown one has all of it.
fn log_normal(value: f64, s: f64, [low, high]: [f64; 2]) -> [f64; 2] {
    [-NORMAL_95, NORMAL_95].map(|z: f64| (value * (z * s).exp()).min(high).max(low))
}

impl Engine {
    /// Of every number of a fit's random members; none where a model departs.
    pub(crate) fn random_ranges(&self, fit: &Fit) -> Vec<RandomRange> {
        let blown = if self.has_band(&fit.model) { self.blown(&fit.model) } else { None }.unwrap_or_default();
        let one = |range: RandomRange| {
            let (m, i) = range.place;
            let (member, p) = (&fit.model.members[m], &fit.model.members[m].parameters[i]);
            let axis = if p.role == Role::Strength { self.axis_of(member, i) } else { None };
            // Along the stream or across it.
            let direction = axis.map(|axis| axis.min(1));
            let range = direction.and_then(|d| blown[d]).map_or(range, |blown| sized(range, blown));
            within(range, [p.low, p.high], direction.map_or(0.0, |d| self.bursts_std[d]))
        };
        self.over_forms(fit).into_iter().map(one).collect()
    }

    /// The same, averaged over the forms of the gusts' spectrum.
    fn over_forms(&self, fit: &Fit) -> Vec<RandomRange> {
        /// Most steps of scoring in the other form, which starts near.
        const STEPS: usize = 4;
        let own = self.ranges_in(&fit.model);
        let dryden = |d: &Disturbance| {
            let is_of_form = matches!(d.shape, Shape::DrydenLongitudinal { .. } | Shape::DrydenLateral { .. });
            is_of_form && matches!(d.entry, Entry::AirVelocity(_))
        };
        let plant = fit.model.plant(&self.campaign);
        if self.spectra.von_karman || !plant.disturbances(1.0).iter().any(dryden) {
            return own;
        }
        let mut other = self.clone();
        other.spectra.von_karman = true;
        let Ok(start) = other.climb(&fit.model, false, 0) else { return own };
        let end = other.settle_random(&start, STEPS);
        let ranges = other.ranges_in(&end.model);
        let odds = (end.total - fit.total).exp();
        let with_other = |one: RandomRange| match ranges.iter().find(|r| r.place == one.place) {
            Some(two) => averaged(one, *two, odds),
            None => one,
        };
        own.into_iter().map(with_other).collect()
    }

    /// The same in one form of the gusts' spectrum.
    fn ranges_in(&self, model: &Model) -> Vec<RandomRange> {
        let places = random_numbers(model);
        if places.is_empty() {
            return Vec::new();
        }
        let Some((covariance, own)) = self.random_covariance(model) else { return Vec::new() };
        let mut all: Vec<RandomRange> = places
            .iter()
            .enumerate()
            .map(|(j, &place)| {
                let member = &model.members[place.0];
                let (value, p) = (member.values[place.1], &member.parameters[place.1]);
                let s = covariance[(j, j)].max(0.0).sqrt();
                RandomRange { place, value, std: value * s, ci95: log_normal(value, s, [p.low, p.high]) }
            })
            .collect();
        for (w, &place) in places.iter().enumerate() {
            let role = model.members[place.0].parameters[place.1].role;
            if !matches!(role, Role::Shape(_)) || covariance[(w, w)] < WIDE * WIDE {
                continue;
            }
            let Some(size) = partner(model, &places, &covariance, w) else { continue };
            // Where the data's spectrum is not the model's, the likelihood is as much too steep as its own variance is too small.
            let steep = (covariance[(w, w)] / own[(w, w)]).max(1.0);
            let slope = covariance[(size, w)] / covariance[(w, w)];
            let ridge = self.ridge(model, [place, places[size]], covariance[(w, w)].sqrt(), slope, steep);
            let of = |j: usize| model.members[places[j].0].values[places[j].1];
            if let Some((shape, strength)) = ranges(&ridge, [of(w), of(size)]) {
                all[w] = RandomRange { place, value: of(w), ..shape };
                all[size] = RandomRange { place: places[size], value: of(size), ..strength };
            }
        }
        all
    }

    /// The posterior along a shape, its size and all other numbers but those of random members the likeliest everywhere, from one end to the other.
    fn ridge(&self, model: &Model, [shape, size]: [(usize, usize); 2], first: f64, slope: f64, steep: f64) -> Vec<RidgePoint> {
        let log = |(m, i): (usize, usize)| model.members[m].values[i].max(1e-12).ln();
        let [low, high] = log_range(model, shape.0, shape.1);
        let Some((top, _)) = self.across(model, [shape, size], [log(shape), log(size)], steep) else { return Vec::new() };
        let mut all = vec![top];
        for way in [-1.0, 1.0] {
            let (mut last, mut followed, mut stride) = (top, model.clone(), way * first.min(LONGEST_FIRST));
            for _ in 0..MOST {
                let next = (last.shape + stride).clamp(low, high);
                stride *= GROWTH;
                if (next - last.shape).abs() < 1e-9 {
                    break;
                }
                let guess = last.size + slope * (next - last.shape);
                let Some((point, there)) = self.across(&followed, [shape, size], [next, guess], steep) else { break };
                all.push(point);
                (last, followed) = (point, there);
                if point.height < top.height - FALLEN {
                    break;
                }
            }
        }
        all.sort_by(|a, b| a.shape.total_cmp(&b.shape));
        all
    }

    /// The likeliest size at a value of a shape, by a parabola through three sizes, and the model with all other numbers but those of random members
    /// moved there: what gusts of another length leave of the motion damping and stiffness take up.
    fn across(
        &self,
        model: &Model,
        [shape, size]: [(usize, usize); 2],
        [at, guess]: [f64; 2],
        steep: f64,
    ) -> Option<(RidgePoint, Model)> {
        let sized = |model: &Model, by: f64| {
            let mut model = model.clone();
            model.members[shape.0].values[shape.1] = at.exp();
            model.members[size.0].values[size.1] = (guess + by).exp();
            model
        };
        let start = sized(model, 0.0);
        let (gram, _) = self.gram(&start, self.free(&start, true)).ok()?;
        let mut moved = start.clone();
        let (_, step, _) = gram.laplace()?;
        gram.numbers.iter().zip(step.iter()).for_each(|(n, s)| moved.change(n, *s));
        let heights = |model: &Model| {
            let (middle, others) = self.likelihoods_beside(model, &[sized(model, -ACROSS), sized(model, ACROSS)])?;
            Some(([others[0], middle, others[1]], penalty(&self.free(model, true))))
        };
        let before = gram.log_likelihood - penalty(&gram.numbers);
        let moved_heights = heights(&moved).filter(|(here, penalty)| here[1] - penalty > before).map(|h| (h, moved));
        let (([below, middle, above], penalty), model) = moved_heights.or_else(|| Some((heights(&start)?, start)))?;
        let slope = (above - below) / (2.0 * ACROSS);
        let bend = (2.0 * middle - above - below) / (ACROSS * ACROSS);
        if bend <= 0.0 {
            return None;
        }
        let by = (slope / bend).clamp(-FARTHEST, FARTHEST);
        let top = middle - penalty + slope * by - 0.5 * bend * by * by;
        Some((RidgePoint { shape: at, height: top / steep, size: guess + by, spread: (steep / bend).sqrt() }, model))
    }
}

/// A range with what `bursts` leave of its logarithm, within what is plausible.
fn within(range: RandomRange, [low, high]: [f64; 2], bursts: f64) -> RandomRange {
    let ends = range.ci95.map(|end| end.clamp(low, high));
    let half = (ends[1] / ends[0].max(1e-12)).ln() / (2.0 * NORMAL_95);
    let wider = (NORMAL_95 * (half.hypot(bursts) - half)).exp();
    RandomRange {
        std: range.std.hypot(range.value * bursts).min(high - low),
        ci95: [ends[0] / wider, (ends[1] * wider).min(high)],
        ..range
    }
}

/// A size by the gusts that blew: what is not seen of them may be twice as large as the form says.
fn sized(range: RandomRange, blown: Blown) -> RandomRange {
    let by = blown.square.sqrt();
    let value = range.value * by;
    let unseen = 0.5 * (3.0 * blown.unseen / blown.square).ln_1p();
    let above = (range.ci95[1] / range.value).ln().max(0.0).hypot(NORMAL_95 * unseen);
    RandomRange {
        value,
        std: (range.std * by).hypot(value * unseen.exp_m1()),
        ci95: [range.ci95[0] * by, value * above.exp()],
        ..range
    }
}

/// What is known of a number by one model and by another that is `odds` times as likely; departures from the first one's estimate.
fn averaged(one: RandomRange, two: RandomRange, odds: f64) -> RandomRange {
    let (at, away) = (one.value, two.value);
    let share = if odds.is_finite() { odds / (1.0 + odds) } else { 1.0 };
    // Each side of a number's logarithm is a normal one's, as wide as its interval says.
    let below = |r: &RandomRange, centre: f64, x: f64| {
        let end = if x < centre { r.ci95[0] } else { r.ci95[1] };
        let spread = (end.max(1e-300) / centre).ln().abs().max(1e-9) / NORMAL_95;
        statrs::function::erf::erfc(-(x / centre).ln() / (spread * std::f64::consts::SQRT_2)) / 2.0
    };
    let all = |x: f64| (1.0 - share) * below(&one, at, x) + share * below(&two, away, x);
    let ends = [one.ci95[0].min(two.ci95[0]).max(1e-300), one.ci95[1].max(two.ci95[1]).max(1e-300)];
    let quantile = |p: f64| {
        let [mut low, mut high] = ends.map(f64::ln);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if all(middle.exp()) < p { low = middle } else { high = middle }
        }
        (0.5 * (low + high)).exp()
    };
    let square = (1.0 - share) * one.std.powi(2) + share * (two.std.powi(2) + (away - at).powi(2));
    RandomRange { std: square.sqrt(), ci95: [quantile(0.025), quantile(0.975)], ..one }
}

/// The strength that hangs on a shape most, of the same member.
fn partner(model: &Model, places: &[(usize, usize)], covariance: &DMatrix<f64>, w: usize) -> Option<usize> {
    let strength = |j: usize| model.members[places[j].0].parameters[places[j].1].role == Role::Strength;
    let correlation = |j: usize| (covariance[(j, w)] / covariance[(j, j)].sqrt()).abs();
    (0..places.len())
        .filter(|&j| places[j].0 == places[w].0 && strength(j))
        .max_by(|&a, &b| correlation(a).total_cmp(&correlation(b)))
}

/// What a ridge says of the shape and the size whose estimates are given; none of a single point.
fn ranges(ridge: &[RidgePoint], estimates: [f64; 2]) -> Option<(RandomRange, RandomRange)> {
    /// Pieces of a stretch between two points, and places of a standard normal with equal weights.
    const PIECES: usize = 24;
    const NORMAL: [f64; 8] = [-1.534, -0.887, -0.489, -0.157, 0.157, 0.489, 0.887, 1.534];
    let top = ridge.iter().max_by(|a, b| a.height.total_cmp(&b.height))?;
    // The signed root of the fall is nearly straight (Barndorff-Nielsen and Cox 1994, §4.2), whatever the fall itself.
    let root = |p: &RidgePoint| (p.shape - top.shape).signum() * (top.height - p.height).sqrt();
    let (mut shapes, mut sizes) = (Vec::new(), Vec::new());
    for pair in ridge.windows(2) {
        let between = |f: &dyn Fn(&RidgePoint) -> f64, x: f64| f(&pair[0]) + x * (f(&pair[1]) - f(&pair[0]));
        for piece in 0..PIECES {
            let x = (piece as f64 + 0.5) / PIECES as f64;
            let weight = (-between(&root, x).powi(2)).exp() * (pair[1].shape - pair[0].shape);
            shapes.push((between(&|p| p.shape, x).exp(), weight));
            let (size, spread) = (between(&|p| p.size, x), between(&|p| p.spread, x));
            sizes.extend(NORMAL.iter().map(|z| ((size + z * spread).exp(), weight)));
        }
    }
    let place = (0, 0);
    let range = |all: &mut Vec<(f64, f64)>, estimate: f64| {
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let sum: f64 = all.iter().map(|v| v.1).sum();
        let quantile = |share: f64| {
            let mut so_far = 0.0;
            all.iter().find(|v| {
                so_far += v.1;
                so_far >= share * sum
            })
        };
        let ci95 = [quantile(0.025)?.0, quantile(0.975)?.0];
        let square = all.iter().map(|v| v.1 * (v.0 - estimate).powi(2)).sum::<f64>() / sum;
        Some(RandomRange { place, value: estimate, std: square.sqrt(), ci95 })
    };
    Some((range(&mut shapes, estimates[0])?, range(&mut sizes, estimates[1])?))
}

#[cfg(test)]
mod tests;
