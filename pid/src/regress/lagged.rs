//! pid: regression where something drives body and residual alike. In: rows of runs. Out: estimates by instruments, with their errors.
//!
//! A gust that no instrument sees is in the residual, and the motion that it causes is in the regressors. What the body did a while before
//! knows nothing of the gust of now, and the body swings on: regressors of a while ago are instruments (Söderström and Stoica,
//! Instrumental Variable Methods for System Identification, 1983, ch. 3). Errors are of blocks of time, which may be coloured and unlike
//! each other inside; freedom is what blocks there are that move an estimate (Bell and McCaffrey, Survey Methodology 28(2), 2002).

use super::RegressionSeries;
use nalgebra::{DMatrix, DVector};

/// Times before that are tried, in diameters of flow: the first is three times the 3 diameters after which a gust as long as the model's
/// surroundings is another one; the last is one and a half periods of the tunnel's pitch mode.
const LAGS: std::ops::RangeInclusive<u32> = 10..=52;
/// Step between them.
const STEP: usize = 3;
/// Length of a block, diameters of flow: a period of the pitch mode, and longer than gusts are remembered.
const BLOCK: f64 = 35.0;

/// One series, and the diameters of flow that pass between its samples.
#[derive(Clone, Copy)]
pub(super) struct Timed<'a> {
    pub(super) series: &'a RegressionSeries,
    pub(super) step: f64,
}

impl Timed<'_> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of samples")]
    fn samples(&self, diameters: f64) -> usize {
        if self.step > 0.0 { (diameters / self.step).round() as usize } else { 0 }
    }
    fn shift(&self, lag: u32) -> usize {
        self.samples(f64::from(lag))
    }
    fn block(&self) -> usize {
        self.samples(BLOCK).max(1)
    }
    fn len(&self) -> usize {
        self.series.response.len()
    }
}

/// What lagged instruments find.
pub(super) struct Lagged {
    pub(super) estimate: Vec<f64>,
    pub(super) covariance: DMatrix<f64>,
    pub(super) freedom: Vec<f64>,
    /// F of the first stage: what of a regressor its instrument tells over what it would by chance.
    pub(super) strength: Vec<f64>,
    /// Time before, in diameters of flow.
    pub(super) lag: u32,
}

/// Estimates with the lag whose weakest instrument is strongest; none where a run is too short or nothing is told.
pub(super) fn lagged(series: &[Timed<'_>], columns: &[usize]) -> Option<Lagged> {
    let tried = LAGS.step_by(STEP).filter_map(|lag| Some((strengths(&Moments::of(series, columns, lag)?)?, lag)));
    let least = |s: &[f64]| s.iter().copied().fold(f64::INFINITY, f64::min);
    let (strength, lag) = tried.max_by(|a, b| least(&a.0).total_cmp(&least(&b.0)))?;
    let m = Moments::of(series, columns, lag)?;
    let inverse = m.zx.clone().try_inverse()?;
    let estimate = &inverse * &m.zy;
    let p = columns.len();
    let (mut meat, mut shares) = (DMatrix::zeros(p, p), Vec::new());
    for s in series {
        let shift = s.shift(lag);
        let mut from = shift;
        while from < s.len() {
            let to = (from + s.block()).min(s.len());
            let own = Moments::of_rows(s, columns, shift, from..to);
            let leverage = &inverse * &own.zx;
            let mut pull = &inverse * (&own.zy - &own.zx * &estimate);
            for j in 0..p {
                // A block that decides a fit alone says nothing of the noise; a tenth keeps it from deciding the error.
                pull[j] /= (1.0 - leverage[(j, j)]).max(0.1).sqrt();
            }
            meat += &pull * pull.transpose();
            let moved = &inverse * &own.zz * inverse.transpose();
            shares.push(moved.diagonal());
            from = to;
        }
    }
    let freedom = (0..p)
        .map(|j| {
            let (sum, squares) = shares.iter().fold((0.0, 0.0), |(a, b), s| (a + s[j], b + s[j] * s[j]));
            (sum * sum / squares - 1.0).max(1.0)
        })
        .collect();
    Some(Lagged { estimate: estimate.as_slice().to_vec(), covariance: meat, freedom, strength, lag })
}

/// Sums of products of instruments z, regressors x and response y.
struct Moments {
    zx: DMatrix<f64>,
    zz: DMatrix<f64>,
    xx: DMatrix<f64>,
    zy: DVector<f64>,
    blocks: f64,
}

impl Moments {
    fn of(series: &[Timed<'_>], columns: &[usize], lag: u32) -> Option<Self> {
        let p = columns.len();
        let zero = || DMatrix::zeros(p, p);
        let mut sum = Self { zx: zero(), zz: zero(), xx: zero(), zy: DVector::zeros(p), blocks: 0.0 };
        for s in series {
            let shift = s.shift(lag);
            if shift == 0 || shift >= s.len() {
                return None;
            }
            let own = Self::of_rows(s, columns, shift, shift..s.len());
            sum.zx += own.zx;
            sum.zz += own.zz;
            sum.xx += own.xx;
            sum.zy += own.zy;
            sum.blocks += (s.len() - shift) as f64 / s.block() as f64;
        }
        Some(sum)
    }
    fn of_rows(s: &Timed<'_>, columns: &[usize], shift: usize, rows: std::ops::Range<usize>) -> Self {
        let now = |c: usize| &s.series.regressors[columns[c]][rows.clone()];
        let before = |c: usize| &s.series.regressors[columns[c]][rows.start - shift..rows.end - shift];
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let p = columns.len();
        Self {
            zx: DMatrix::from_fn(p, p, |i, j| dot(before(i), now(j))),
            zz: DMatrix::from_fn(p, p, |i, j| dot(before(i), before(j))),
            xx: DMatrix::from_fn(p, p, |i, j| dot(now(i), now(j))),
            zy: DVector::from_fn(p, |i, _| dot(before(i), &s.series.response[rows.clone()])),
            blocks: 0.0,
        }
    }
}

/// Of each regressor the part that the others do not have, and what of it the instruments tell, blocks counted as independent.
fn strengths(m: &Moments) -> Option<Vec<f64>> {
    let (zx, zz, xx) = (m.zx.clone().try_inverse()?, m.zz.clone().try_inverse()?, m.xx.clone().try_inverse()?);
    let one = |j: usize| {
        let r2 = (xx[(j, j)] * zz[(j, j)] / zx[(j, j)].powi(2)).min(1.0 - 1e-12);
        m.blocks * r2 / (1.0 - r2)
    };
    Some((0..zx.nrows()).map(one).collect())
}

#[cfg(test)]
mod tests;
