//! pid: how far the declared vehicle's equations of motion close on a record. In: instants and a plant. Out: what part of the
//! accelerations is left when aerodynamics are fitted, and what they come out as.
//!
//! Known forces are those of the declared mass, gravity and tether; the rest is for the air, by the declared structure, linear in its
//! parameters. What is left is measured against the accelerations themselves: along the tunnel, across it, of roll, and of pitch and
//! yaw.

use crate::coefficients::{CoefficientRow, coefficients};
use crate::instrument::Sample;
use crate::states::{State, state};
use nalgebra::{DMatrix, DVector};
use windfall_model::{Aero, Coefficient, Plant};

/// Groups of accelerations: along X, across, roll, pitch and yaw.
pub(super) const GROUPS: [&str; 4] = ["vertical", "lateral", "roll", "pitch and yaw"];
/// Group of each of C_A, C_Y, C_N, C_l, C_m, C_n.
const GROUP: [usize; 6] = [0, 1, 1, 2, 3, 3];
/// Share of instants, the worst, that a fit leaves out: a touched model, outliers.
const LEFT_OUT: f64 = 0.05;
/// Largest share of instants at which the flow or the angles may not be defined.
const UNDEFINED: f64 = 0.1;
/// Independent instants a second: motion of about 1 Hz.
pub(super) const PER_S: f64 = 2.0;
/// Loose hold of parameters near their declared values, relative: it acts where the runs say nothing.
const HOLD: f64 = 1e4;

/// One instant as a change of the record gives it.
pub(super) struct Point {
    pub(super) t_s: f64,
    pub(super) motion: Sample,
    pub(super) ps_pa: f64,
    pub(super) ts_k: f64,
}

/// A fitted balance.
#[derive(Clone, Debug)]
pub(super) struct Balance {
    /// What is left of each of [`GROUPS`], root mean square, m/s² and rad/s².
    pub(super) left: [f64; 4],
    /// The accelerations themselves, root mean square, m/s² and rad/s².
    pub(super) signal: [f64; 4],
    /// Fitted over declared, and its relative standard error, for each declared parameter that is not zero.
    pub(super) ratio: Vec<Ratio>,
}

/// One parameter's outcome.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ratio {
    /// Its index in the structure.
    pub(super) parameter: usize,
    /// Fitted over declared value.
    pub(super) value: f64,
    /// Standard error of that.
    pub(super) std: f64,
}

/// A state and the acceleration of the origin, m/s², tunnel axes.
type Seen = (State, [f64; 3]);

/// Equations of one instant: six accelerations by aerodynamics to be explained, and what each parameter gives.
struct Equations {
    wanted: [f64; 6],
    by: Vec<[f64; 6]>,
}

/// Fits the declared structure, and where `offset` says so constant pitching and yawing moments beside it (a centre of mass that is elsewhere);
/// `None` where flow or angles are not defined or nothing can be fitted.
pub(super) fn balance(points: &[Point], plant: &Plant, declared: &[bool], seconds: f64, offset: bool) -> Option<Balance> {
    let at = |p: &Point| {
        let density = plant.environment.density_kg_m3(p.ps_pa, p.ts_k);
        Some(state(p.t_s, &p.motion, density, plant))
            .filter(|s| s.checked().is_ok())
            .map(|s| (s, [0, 1, 2].map(|k| p.motion[k][2])))
    };
    let states: Vec<Seen> = points.iter().filter_map(at).collect();
    if states.is_empty() || states.len() as f64 <= (1.0 - UNDEFINED) * points.len() as f64 {
        return None;
    }
    let all: Vec<usize> = (0..states.len()).collect();
    let rough = signal(&states, &all);
    let (states, accelerations): (Vec<State>, Vec<[f64; 3]>) = states.into_iter().unzip();
    let free: Vec<usize> = (0..declared.len()).filter(|i| declared[*i]).collect();
    // What is not fitted is taken off: effects that the plant has, and parameters that are not declared.
    let mut rest = plant.aero.clone();
    free.iter().for_each(|i| rest.values[*i] = 0.0);
    let rows: Vec<Equations> = coefficients(&states, plant).iter().map(|r| equations(r, plant, &rest, &free, offset)).collect();
    let weight = GROUP.map(|g| rough[g].max(1e-9).powi(-2));
    let (first, _) = fit(&rows, &all, &weight, plant, &free)?;
    let mut order: Vec<(f64, usize)> = all.iter().map(|i| (size(&residual(&rows[*i], &first), &weight), *i)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a length")]
    order.truncate(((1.0 - LEFT_OUT) * rows.len() as f64).ceil() as usize);
    let kept: Vec<usize> = order.into_iter().map(|o| o.1).collect();
    let (found, inverse) = fit(&rows, &kept, &weight, plant, &free)?;
    let left = left(&rows, &kept, &found);
    let states: Vec<Seen> = states.into_iter().zip(accelerations).collect();
    let signal = signal(&states, &kept);
    let independent = (seconds * PER_S).clamp(1.0, rows.len() as f64);
    let ratio = |(k, i): (usize, &usize)| {
        let value = plant.aero.values[*i];
        // Noise of the group that tells most of it, as many rows as are independent.
        let group =
            plant.aero.structure.contributions.iter().find(|c| c.parameter == *i).map_or(0, |c| GROUP[c.coefficient as usize]);
        let std = (inverse[(k, k)] * (left[group] / rough[group].max(1e-9)).powi(2) * rows.len() as f64 / independent).sqrt();
        Ratio { parameter: *i, value: found[k] / value, std: std / value.abs() }
    };
    let ratio = free.iter().enumerate().filter(|(_, i)| plant.aero.values[**i].abs() > 0.0).map(ratio).collect();
    Some(Balance { left, signal, ratio })
}

/// Root mean square of the accelerations themselves at some instants, per group (m/s², rad/s²).
fn signal(states: &[Seen], which: &[usize]) -> [f64; 4] {
    let mean = |f: &dyn Fn(&Seen) -> f64| (which.iter().map(|i| f(&states[*i])).sum::<f64>() / which.len().max(1) as f64).sqrt();
    [
        mean(&|(_, a)| a[0] * a[0]),
        mean(&|(_, a)| 0.5 * (a[1] * a[1] + a[2] * a[2])),
        mean(&|(s, _)| s.pqr_rate[0].powi(2)),
        mean(&|(s, _)| 0.5 * (s.pqr_rate[1].powi(2) + s.pqr_rate[2].powi(2))),
    ]
}

/// `rest` is the plant's aerodynamics without what is fitted.
fn equations(row: &CoefficientRow, plant: &Plant, rest: &Aero, free: &[usize], offset: bool) -> Equations {
    let v = &plant.vehicle;
    let force = row.q_pa * v.area_m2() / v.mass_kg;
    let turn = |inertia: f64| row.q_pa * v.area_m2() * v.diameter_m / inertia;
    let scale = [force, force, force, turn(v.inertia.xx), turn(v.inertia.yy), turn(v.inertia.zz)];
    let known = rest.coefficients(&row.flow);
    let wanted = std::array::from_fn(|c| (row.exp_origin[c] - known[c]) * scale[c]);
    let mut by = vec![[0.0; 6]; free.len()];
    for k in &plant.aero.structure.contributions {
        if let Some(column) = free.iter().position(|i| *i == k.parameter) {
            by[column][k.coefficient as usize] += k.term.value(&row.flow) * scale[k.coefficient as usize];
        }
    }
    let moments = if offset { &[Coefficient::Cm, Coefficient::Cn][..] } else { &[] };
    by.extend(moments.iter().map(|c| {
        let mut constant = [0.0; 6];
        constant[*c as usize] = scale[*c as usize];
        constant
    }));
    Equations { wanted, by }
}

fn residual(e: &Equations, found: &DVector<f64>) -> [f64; 6] {
    std::array::from_fn(|c| e.wanted[c] - e.by.iter().zip(found.iter()).map(|(b, f)| b[c] * f).sum::<f64>())
}

fn size(r: &[f64; 6], weight: &[f64; 6]) -> f64 {
    r.iter().zip(weight).map(|(x, w)| x * x * w).sum()
}

/// Weighted least squares with the loose hold; the estimate and the inverse of the normal matrix.
fn fit(
    rows: &[Equations],
    which: &[usize],
    weight: &[f64; 6],
    plant: &Plant,
    free: &[usize],
) -> Option<(DVector<f64>, DMatrix<f64>)> {
    // Offsets beside what is declared are none.
    let n = rows.first().map_or(0, |e| e.by.len());
    let declared = DVector::from_fn(n, |k, _| free.get(k).map_or(0.0, |i| plant.aero.values[*i]));
    let scale = declared.map(|v| v.abs().max(0.1));
    let mut normal = DMatrix::<f64>::zeros(n, n);
    let mut right = DVector::<f64>::zeros(n);
    for i in which {
        let e = &rows[*i];
        let apart = residual(e, &declared);
        for c in 0..6 {
            for a in 0..n {
                let left = e.by[a][c] * weight[c] * scale[a];
                if left.abs() > 0.0 {
                    right[a] += left * apart[c];
                    (0..n).for_each(|b| normal[(a, b)] += left * e.by[b][c] * scale[b]);
                }
            }
        }
    }
    (0..n).for_each(|k| normal[(k, k)] += HOLD.powi(-2));
    let inverse = normal.try_inverse()?;
    let step: DVector<f64> = &inverse * right;
    let found = DVector::from_fn(n, |k, _| declared[k] + step[k] * scale[k]);
    let inverse = DMatrix::from_fn(n, n, |a, b| inverse[(a, b)] * scale[a] * scale[b]);
    found.iter().all(|f| f.is_finite()).then_some((found, inverse))
}

fn left(rows: &[Equations], which: &[usize], found: &DVector<f64>) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for i in which {
        let r = residual(&rows[*i], found);
        GROUP.iter().zip(r).for_each(|(g, x)| sum[*g] += x * x);
    }
    let each = [1.0, 2.0, 1.0, 2.0];
    std::array::from_fn(|g| (sum[g] / (each[g] * which.len().max(1) as f64)).sqrt())
}

#[cfg(test)]
mod tests;
