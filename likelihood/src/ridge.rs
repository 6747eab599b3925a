//! likelihood: ridges. In: a fit. Out: the fit at the top of the likelihood along each effect's ridge, and how much farther than its errors it reaches.
//!
//! The strength of an effect whose shapes are fitted with it is known far worse than beside given shapes: it lies on a ridge. Slopes are taken with
//! the filter's gain held and at the states that the filter knew, so that the information is right to a few hundredths; of a loose mass, whose own
//! motion is found with it, that is as much as what the ridge leaves, and its mass came out a twentieth to a fifth too small, at two to five of its
//! errors. There the posterior itself is walked, all other numbers following (profile likelihood: Pawitan, In All Likelihood, 2001, §3.4).

use crate::engine::{Engine, Fit, penalty};
use crate::model::{Id, Model, Number};
use nalgebra::DVector;
use windfall_pid::NORMAL_95;

/// Standard error of a strength, as a multiple of that beside all other numbers known, from which on it lies on a ridge.
const RIDGE: f64 = 4.0;
/// Growth of the walk's steps, of which the first is a standard error; most steps to a side; most steps of all other numbers at each.
const GROWTH: f64 = 1.5;
const MOST: usize = 6;
const STEPS: usize = 6;
/// Standard deviations below the top at which the walk ends.
const FALLEN: f64 = 2.2;

/// A place on a ridge: the strength, the log posterior, the model there.
struct Place {
    value: f64,
    height: f64,
    model: Model,
}

/// Where a ridge is highest, and how far it reaches, 1.96 standard deviations below that on the side where it is farther, over as many.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Crest {
    value: f64,
    std: f64,
}

/// Strengths on a ridge, by their places among a fit's numbers.
fn on_ridges(engine: &Engine, fit: &Fit) -> Vec<usize> {
    let member = |id: Id| if let Id::Member(m, _) = id { Some(m) } else { None };
    let has_shapes = |m: usize| fit.numbers.iter().any(|n| member(n.id) == Some(m) && !fit.model.is_strength(n.id));
    let is_open = |n: &Number| fit.model.is_strength(n.id) && n.at_end == [false; 2] && member(n.id).is_some_and(has_shapes);
    let open: Vec<usize> = (0..fit.numbers.len()).filter(|&i| is_open(&fit.numbers[i])).collect();
    if open.is_empty() {
        return open;
    }
    let Ok((gram, _)) = engine.gram(&fit.model, fit.numbers.clone()) else { return Vec::new() };
    let is_ridge = |&i: &usize| fit.covariance[(i, i)] * gram.g[(i, i)] > RIDGE * RIDGE;
    open.into_iter().filter(is_ridge).collect()
}

impl Engine {
    /// A fit with the strengths that lie on ridges at the top of the log posterior there, and what their ridges add to its covariance: columns, each
    /// times its transpose.
    pub(crate) fn along_ridges(&self, fit: Fit) -> (Fit, Vec<DVector<f64>>) {
        let ids: Vec<Id> = on_ridges(self, &fit).into_iter().map(|i| fit.numbers[i].id).collect();
        let mut fit = fit;
        let mut crests: Vec<(Id, Crest)> = Vec::new();
        for id in ids {
            if let Some((at, crest)) = self.on_crest(&fit, id) {
                fit = at;
                crests.push((id, crest));
            }
        }
        let added = |(id, crest): (Id, Crest)| {
            let (step, std) = step(&fit, id)?;
            beyond(step, std, crest.std)
        };
        let added = crests.into_iter().filter_map(added).collect();
        (fit, added)
    }

    /// A fit with a strength where its ridge is highest; none where it cannot be walked.
    fn on_crest(&self, fit: &Fit, strength: Id) -> Option<(Fit, Crest)> {
        let places = self.ridge_of(fit, strength)?;
        let crest = crest(&places.iter().map(|p| (p.value, p.height)).collect::<Vec<_>>())?;
        let nearest = places.iter().min_by(|a, b| (a.value - crest.value).abs().total_cmp(&(b.value - crest.value).abs()))?;
        let (step, std) = step(fit, strength)?;
        let start = along(&nearest.model, &fit.numbers, &step, (crest.value - nearest.value) / std);
        let top = self.holding(strength).climb(&start, true, STEPS).ok()?;
        // With no steps: where it stands, with this number among the others.
        let top = self.climb(&top.model, true, 0).ok()?;
        (height(&top) > height(fit) - 0.5).then_some((top, crest))
    }

    /// The ridge of a strength, ascending: from the fit down and up until it has fallen.
    fn ridge_of(&self, fit: &Fit, strength: Id) -> Option<Vec<Place>> {
        let held = self.holding(strength);
        let (step, std) = step(fit, strength)?;
        let at = fit.numbers.iter().find(|n| n.id == strength)?;
        let mut places = vec![Place { value: at.value, height: height(fit), model: fit.model.clone() }];
        let mut highest = height(fit);
        for side in [-1.0, 1.0] {
            let mut by = side;
            for _ in 0..MOST {
                let last = if side < 0.0 { places.first()? } else { places.last()? };
                let value = last.value + by * std;
                let start = along(&last.model, &fit.numbers, &step, by);
                if value <= at.range[0] || value >= at.range[1] {
                    break;
                }
                let Ok(there) = held.climb(&start, true, STEPS) else { break };
                let height = there.log_likelihood - penalty(&self.free(&there.model, true));
                let place = Place { value, height, model: there.model };
                places.insert(if side < 0.0 { 0 } else { places.len() }, place);
                highest = highest.max(height);
                if highest - height > 0.5 * FALLEN * FALLEN {
                    break;
                }
                by *= GROWTH;
            }
        }
        Some(places)
    }
}

/// Log posterior of a fit where it stands.
fn height(fit: &Fit) -> f64 {
    fit.log_likelihood - penalty(&fit.numbers)
}

/// What a standard error along the ridge of a strength changes, and that error.
fn step(fit: &Fit, strength: Id) -> Option<(DVector<f64>, f64)> {
    let at = fit.numbers.iter().position(|n| n.id == strength)?;
    let std = fit.covariance[(at, at)].sqrt();
    (std > 0.0).then(|| (fit.covariance.column(at) / std, std))
}

/// What a ridge of that reach adds to a covariance, times its transpose: the strength's standard deviation becomes the reach where that is more.
fn beyond(step: DVector<f64>, std: f64, reach: f64) -> Option<DVector<f64>> {
    (reach > std).then(|| step * ((reach / std).powi(2) - 1.0).sqrt())
}

/// A model some steps further, numbers within their ranges.
fn along(model: &Model, numbers: &[Number], step: &DVector<f64>, by: f64) -> Model {
    let mut moved = model.clone();
    numbers.iter().zip(step.iter()).for_each(|(n, s)| moved.change(n, by * s));
    moved
}

/// Where a ridge, given by places (value, height) in ascending order, is highest, by a parabola through the highest and its neighbours; and its reach.
/// None of fewer than three places.
fn crest(places: &[(f64, f64)]) -> Option<Crest> {
    let k = (0..places.len()).max_by(|a, b| places[*a].1.total_cmp(&places[*b].1))?;
    let k = k.clamp(1, places.len().checked_sub(2).filter(|last| *last > 0)?);
    let [(x0, y0), (x1, y1), (x2, y2)] = [places[k - 1], places[k], places[k + 1]];
    // Newton's divided differences.
    let (first, second) = ((y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1));
    let bend = (second - first) / (x2 - x0);
    let highest = places.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let parabola = |x: f64| y0 + (x - x0) * (first + bend * (x - x1));
    let (value, top) = if bend < 0.0 {
        let value = (0.5 * (x0 + x1) - 0.5 * first / bend).clamp(x0, x2);
        (value, parabola(value).max(highest.1))
    } else {
        highest
    };
    // Standard deviations below the top, in which a parabola is straight.
    let below = |y: f64| (2.0 * (top - y)).max(0.0).sqrt();
    let reach = |side: f64| {
        let mut last = (value, 0.0);
        let outward = places.iter().filter(|p| side * (p.0 - value) > 0.0).map(|p| (p.0, below(p.1)));
        let mut outward: Vec<(f64, f64)> = outward.collect();
        if side < 0.0 {
            outward.reverse();
        }
        for &(x, r) in &outward {
            if r >= NORMAL_95 {
                return Some(side * (last.0 + (x - last.0) * (NORMAL_95 - last.1) / (r - last.1) - value));
            }
            last = (x, r);
        }
        // It has not fallen so far: as it goes on.
        (last.1 > 0.0).then(|| side * (last.0 - value) * NORMAL_95 / last.1)
    };
    let std = [-1.0, 1.0].into_iter().filter_map(reach).fold(0.0, f64::max) / NORMAL_95;
    (std > 0.0).then_some(Crest { value, std })
}

#[cfg(test)]
mod tests;
