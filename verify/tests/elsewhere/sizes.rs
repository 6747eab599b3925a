//! How plainly what is planted can be seen: the distance of noise-free records from the best that the declared model makes of
//! them, in standard deviations of the declared noise, or beside gusts of noise and of what gusts nobody knows leave (`unknown.rs`).

use crate::air::{Gusts, Track};
use crate::algebra::{V, angles, attitude, product, turned};
use crate::craft::Craft;
use crate::flight::{Plan, follow};
use crate::instruments::{Row, SIGMA, clean};
use crate::knobs::Knobs;
use crate::motion::{Drive, World};
use crate::spec::{Run, Spec};
use crate::unknown::Whitener;
use nalgebra::{DMatrix, DVector};

/// One sample in so many is flown and compared.
pub(crate) const THIN: usize = 6;
/// Runs that are looked at.
const MOST: usize = 3;
/// Numbers of a run's start: place, turn, velocity, rates.
const START: usize = 12;
const AERO: usize = 11;
/// Steps of the numbers for differences.
const STEPS: [f64; START] = [1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3];
/// Steps by the slopes of the first round.
const ROUNDS: usize = 4;

/// One run that the declared model is to meet.
struct Target<'a> {
    spec: &'a Spec,
    k: usize,
    plan: Plan,
    rows: Vec<Row>,
    speed: Track,
    /// What gusts that are not known leave of a residual.
    whitener: Option<Whitener>,
}

impl<'a> Target<'a> {
    fn new(spec: &'a Spec, k: usize, run: &Run, unknown: Option<&Gusts>) -> Self {
        let all = clean(&run.flown, &spec.craft, &spec.knobs, spec.craft.trim());
        let step = all[1][0] - all[0][0];
        let speed = Track::new(0.0, step, all.iter().map(|r| r[7]).collect());
        let rows: Vec<Row> = all.iter().step_by(THIN).copied().collect();
        let first = run.flown.sample(0);
        let plan = Plan {
            rate_hz: 1.0 / (step * THIN as f64),
            duration: rows[rows.len() - 1][0],
            start: [first.x, angles(&first.r), first.v, first.w],
            ..run.plan.clone()
        };
        let mut target = Self { spec, k, plan, rows, speed, whitener: None };
        if let Some(gusts) = unknown {
            let nothing = Knobs::default();
            let mut world = target.world(&spec.craft, &nothing);
            target.whitener = follow(&world, &target.plan).map(|flown| Whitener::new(&mut world, &flown, gusts));
        }
        target
    }

    /// The declared model's world with these aerodynamics.
    fn world<'w>(&self, craft: &'w Craft, nothing: &'w Knobs) -> World<'w> {
        World::new(craft, nothing, self.spec.craft.trim(), Drive::Given(self.speed.clone()), self.k as f64 + 1.0)
    }

    /// Residuals over standard deviations, by aerodynamics and start.
    fn residual(&self, aero: &[f64], start: &[f64]) -> Option<DVector<f64>> {
        let mut craft: Craft = self.spec.reference.clone();
        craft.aero.copy_from_slice(aero);
        let nothing = Knobs::default();
        let world = self.world(&craft, &nothing);
        let [x, e, v, w] = self.plan.start;
        let moved = |a: V, j: usize| [a[0] + start[j], a[1] + start[j + 1], a[2] + start[j + 2]];
        let turn = product(&attitude(e), &turned([0.25 * start[3], 0.25 * start[4], 0.25 * start[5]]));
        let plan = Plan { start: [moved(x, 0), angles(&turn), moved(v, 6), moved(w, 9)], ..self.plan.clone() };
        let flown = follow(&world, &plan)?;
        let model = clean(&flown, &craft, &nothing, world.trim);
        let weight = (THIN as f64).sqrt();
        let one = |(row, made): (&Row, &Row)| -> [f64; 6] {
            std::array::from_fn(|c| {
                let unit = if c < 3 { 1.0 } else { 1.0_f64.to_radians() };
                let mut apart = (row[c + 1] - made[c + 1]) * unit;
                if c == 3 {
                    apart -= std::f64::consts::TAU * (apart / std::f64::consts::TAU).round();
                }
                weight * apart / SIGMA[c]
            })
        };
        let all = DVector::from_iterator(self.rows.len().min(model.len()) * 6, self.rows.iter().zip(&model).flat_map(one));
        Some(if let Some(whitener) = &self.whitener { whitener.whitened(&all) } else { all })
    }
}

/// Distance in standard deviations; `None` when the declared model cannot follow at all. Beside gusts: of the same flights in calm air, by what
/// stands out of noise and gusts together.
pub(crate) fn apart(spec: &Spec, runs: &[Run]) -> Option<f64> {
    match spec.gusts.filter(|_| spec.families.len() > 1) {
        Some(gusts) => {
            let calm = Spec { gusts: None, ..spec.clone() };
            distance(&calm, &calm.fly()?, Some(&gusts))
        }
        None => distance(spec, runs, None),
    }
}

fn distance(spec: &Spec, runs: &[Run], unknown: Option<&Gusts>) -> Option<f64> {
    let used = runs.iter().enumerate().filter(|(_, r)| !r.plan.hold_out).take(MOST);
    let targets: Vec<Target<'_>> = used.map(|(k, r)| Target::new(spec, k, r, unknown)).collect();
    let mut numbers = vec![0.0; AERO + START * targets.len()];
    numbers[..AERO].copy_from_slice(&spec.craft.aero);
    let mut now = residuals(&targets, &numbers)?;
    let mut best = now.norm();
    let j = slopes(&targets, &numbers, &now)?;
    let scale: Vec<f64> = j.column_iter().map(|c| c.norm().max(1e-12)).collect();
    let j = DMatrix::from_fn(j.nrows(), j.ncols(), |r, c| j[(r, c)] / scale[c]);
    // Scaled columns, and a ridge that a direction of less than 1e-5 of its column falls under.
    let normal = j.tr_mul(&j) + DMatrix::identity(j.ncols(), j.ncols()) * 1e-10;
    let root = normal.cholesky()?;
    for _ in 0..ROUNDS {
        let step = root.solve(&j.tr_mul(&now));
        numbers.iter_mut().zip(step.iter().zip(&scale)).for_each(|(n, (s, k))| *n -= s / k);
        let Some(next) = residuals(&targets, &numbers) else { break };
        let gained = best - next.norm();
        best = best.min(next.norm());
        if gained < 0.03 * best {
            break;
        }
        now = next;
    }
    Some(best)
}

fn residuals(targets: &[Target<'_>], numbers: &[f64]) -> Option<DVector<f64>> {
    let mut all = Vec::new();
    for (t, start) in targets.iter().zip(numbers[AERO..].chunks(START)) {
        all.extend(t.residual(&numbers[..AERO], start)?.iter());
    }
    Some(DVector::from_vec(all))
}

fn slopes(targets: &[Target<'_>], numbers: &[f64], now: &DVector<f64>) -> Option<DMatrix<f64>> {
    let mut j = DMatrix::zeros(now.len(), numbers.len());
    let mut row = 0;
    for (i, t) in targets.iter().enumerate() {
        let (aero, start) = (&numbers[..AERO], &numbers[AERO + START * i..AERO + START * (i + 1)]);
        let here = t.residual(aero, start)?;
        for c in 0..AERO + START {
            let (mut a, mut s) = (aero.to_vec(), start.to_vec());
            let (step, column) = if c < AERO {
                let step = 1e-4 * a[c].abs().max(0.1);
                a[c] += step;
                (step, c)
            } else {
                s[c - AERO] += STEPS[c - AERO];
                (STEPS[c - AERO], AERO + START * i + c - AERO)
            };
            let slope = (t.residual(&a, &s)? - &here) / step;
            j.view_mut((row, column), (here.len(), 1)).copy_from(&slope);
        }
        row += here.len();
    }
    Some(j)
}

#[cfg(test)]
mod tests {
    use super::{Gusts, apart};
    use crate::groups::spec;

    /// Gusts that are not known hide more the stronger they are, and nothing where they are all but gone.
    #[test]
    fn law_unknown_gusts_hide() {
        let in_gusts = |seed: u64, size: Option<f64>| {
            // A scale of the tunnel speed.
            let mut spec = spec("D", 23, seed, 0.05);
            let with = |g: Gusts, size: f64| Gusts { axial: size * g.axial, lateral: size * g.lateral, ..g };
            spec.gusts = spec.gusts.zip(size).map(|(g, size)| with(g, size));
            apart(&spec, &spec.fly()?)
        };
        let sizes = [None, Some(1e-6), Some(0.1), Some(1.0)];
        let one = |seed: u64| sizes.map(|size| in_gusts(seed, size).unwrap_or(f64::NAN));
        let flies = |d: &[f64; 4]| d.iter().all(|d| d.is_finite());
        let [known, faint, weak, strong] = (1..20).map(one).find(flies).expect("one flies");
        assert!((faint / known - 1.0).abs() < 0.01, "{faint} {known}");
        assert!(weak < 0.2 * faint && strong < 0.5 * weak, "{faint} {weak} {strong}");
    }

    /// Nothing is seen where nothing acts, and what is seen grows with the size where both are small.
    #[test]
    fn law_distance_is_of_the_effect() {
        let seen = |group: &str, gain: f64| {
            let spec = spec(group, 2, 5, gain);
            apart(&spec, &spec.fly().expect("it flies")).expect("it can be followed")
        };
        let nothing = seen("A", 1.0);
        let (small, twice) = (seen("S", 1e-3), seen("S", 2e-3));
        println!("{nothing:.4} {small:.3} {twice:.3} {:.1} {:.1}", seen("S", 0.02), seen("S", 1.0));
        assert!(nothing < 0.1, "{nothing}");
        assert!((twice / small - 2.0).abs() < 0.1, "{small} {twice}");
    }
}
