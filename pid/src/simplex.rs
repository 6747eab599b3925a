//! pid: downhill simplex (Nelder and Mead 1965) on the unit cube. In: a function and a start. Out: the best place met.

use crate::StopReason;

/// The best place met.
#[derive(Clone, Debug, PartialEq)]
pub struct Minimum {
    /// Where, each in [0, 1].
    pub at: Vec<f64>,
    /// Value there.
    pub value: f64,
    /// [`StopReason::Converged`] when the simplex had shrunk to a thousandth of the cube's side, [`StopReason::Iterations`] when the
    /// evaluations were used up first.
    pub stop: StopReason,
}

/// Smallest value found within `evaluations` calls, and where. Places outside the cube are drawn to its nearest face.
#[must_use]
pub fn minimise(mut f: impl FnMut(&[f64]) -> f64, start: &[f64], reach: f64, evaluations: usize) -> Minimum {
    let n = start.len();
    let mut used = 0;
    let mut call = |x: &mut Vec<f64>| {
        x.iter_mut().for_each(|v| *v = v.clamp(0.0, 1.0));
        used += 1;
        (f(x), used)
    };
    let mut corners: Vec<(Vec<f64>, f64)> = Vec::new();
    for k in 0..=n {
        let mut x = start.to_vec();
        if let Some(i) = k.checked_sub(1) {
            x[i] += if x[i] > 0.5 { -reach } else { reach };
        }
        let (value, _) = call(&mut x);
        corners.push((x, value));
    }
    let stop = loop {
        corners.sort_by(|a, b| a.1.total_cmp(&b.1));
        let size = (0..n).map(|i| (corners[n].0[i] - corners[0].0[i]).abs()).fold(0.0, f64::max);
        let centre: Vec<f64> = (0..n).map(|i| corners[..n].iter().map(|c| c.0[i]).sum::<f64>() / n as f64).collect();
        let along = |s: f64| -> Vec<f64> { (0..n).map(|i| centre[i] + s * (corners[n].0[i] - centre[i])).collect() };
        let mut reflected = along(-1.0);
        let (value, count) = call(&mut reflected);
        if count >= evaluations || size < 1e-3 {
            corners.push((reflected, value));
            break if size < 1e-3 { StopReason::Converged } else { StopReason::Iterations };
        }
        let tried = if value < corners[0].1 {
            let mut further = along(-2.0);
            let (v, _) = call(&mut further);
            if v < value { (further, v) } else { (reflected, value) }
        } else if value < corners[n - 1].1 {
            (reflected, value)
        } else {
            let mut nearer = along(if value < corners[n].1 { -0.5 } else { 0.5 });
            let (v, _) = call(&mut nearer);
            (nearer, v)
        };
        if tried.1 < corners[n].1 {
            corners[n] = tried;
        } else {
            let best = corners[0].0.clone();
            for c in &mut corners[1..] {
                let mut x: Vec<f64> = c.0.iter().zip(&best).map(|(a, b)| 0.5 * (a + b)).collect();
                let (value, _) = call(&mut x);
                *c = (x, value);
            }
        }
    };
    let (at, value) = corners.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((start.to_vec(), f64::INFINITY));
    Minimum { at, value, stop }
}

#[cfg(test)]
mod tests;
