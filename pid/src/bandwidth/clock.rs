//! pid: were rows made between the samples of a slower clock? In: the series of a channel group. Out: that clock.
//!
//! A slower clock has `p` samples to `q` rows. Rows on straight lines between its samples leave nothing when straight lines between its
//! ticks are fitted by least squares; fitted between other ticks of the same rate they leave noise. Rows that repeat the last sample are
//! equal wherever the clock did not tick.

/// A clock slower than the rows: ticks at `first + j q/p` rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clock {
    pub(crate) p: usize,
    pub(crate) q: usize,
    /// Place of a tick, rows, from 0 to below `q/p`.
    pub(crate) first: f64,
}

/// Longest pattern that is looked for, rows, and the longest of clocks that tick at whole rows.
const LONGEST: usize = 12;
const LONGEST_WHOLE: usize = 20;
/// Rows that are looked at first.
const LOOKED: usize = 600;
/// Largest square of what is left at the right ticks over that at others. Ratios of rows that no clock made are within exp(±0.7) of one: four
/// standard deviations of the logarithm for the 50 degrees of freedom of a channel at 12 rows for 11 ticks.
const LEFT: f64 = 0.25;
/// Largest share of rows at which a repeated sample may differ: repaired spikes.
const REPAIRED: f64 = 0.01;

impl Clock {
    /// Rows from tick to tick.
    pub(crate) fn step(&self) -> f64 {
        self.q as f64 / self.p as f64
    }
    /// Its ticks within `n` rows, in rows.
    pub(crate) fn ticks(&self, n: usize) -> Vec<f64> {
        let last = n.saturating_sub(1) as f64 + 1e-9;
        (0..).map(|j| self.first + self.step() * f64::from(j)).take_while(|x| *x <= last).collect()
    }
}

/// Ratios that are looked for, the slowest first.
fn ratios() -> Vec<(usize, usize)> {
    let whole = (LONGEST + 1..=LONGEST_WHOLE).map(|q| (1, q));
    let others = (2..=LONGEST).flat_map(|q| (1..q).filter(move |p| divisor(*p, q) == 1).map(move |p| (p, q)));
    let mut all: Vec<(usize, usize)> = whole.chain(others).collect();
    all.sort_by(|a, b| (a.0 * b.1).cmp(&(b.0 * a.1)));
    all
}

fn divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { divisor(b, a % b) }
}

/// The clock whose samples rows repeat; `None` where they are rows of their own.
pub(crate) fn repeated(series: &[&[f64]], measured: &dyn Fn(usize) -> bool) -> Option<Clock> {
    let n = series.first()?.len();
    let new: Vec<bool> = (1..n).map(|i| series.iter().any(|x| x[i].to_bits() != x[i - 1].to_bits())).collect();
    let changes = new.iter().filter(|c| **c).count();
    // No change at all is no clock.
    if changes < 8 || changes as f64 > 0.95 * new.len() as f64 {
        return None;
    }
    let of = |(p, q): (usize, usize)| {
        // Rows of the pattern at which the clock has ticked since the row before, for each of its places.
        (0..q).find_map(|shift| {
            let ticks = |i: usize| ((i + shift) * p) / q != ((i - 1 + shift) * p) / q;
            let (mut same, mut broken, mut ticked) = (0_u32, 0_u32, 0_usize);
            for i in (1..n).filter(|i| measured(*i)) {
                match (ticks(i), new[i - 1]) {
                    (false, changed) => {
                        same += 1;
                        broken += u32::from(changed);
                    }
                    (true, changed) => ticked += usize::from(changed),
                }
            }
            let most = new.len() * p / q;
            // Row i repeats tick floor((i + shift) p/q), so that ticks are at j q/p - shift.
            let step = q as f64 / p as f64;
            let clock = Clock { p, q, first: (-(shift as f64)).rem_euclid(step) };
            (f64::from(broken) <= REPAIRED * f64::from(same) && 2 * ticked > most).then_some(clock)
        })
    };
    ratios().into_iter().find_map(of)
}

/// The clock between whose samples rows are on straight lines; `None` where they are not.
pub(crate) fn straight(series: &[&[f64]], measured: &dyn Fn(usize) -> bool) -> Option<Clock> {
    let n = series.first()?.len();
    let looked = n.min(LOOKED);
    let left = |clock: &Clock| -> Vec<f64> { series.iter().map(|x| on_lines(x, clock, measured).1).collect() };
    ratios().into_iter().filter(|(_, q)| 8 * q <= looked).find_map(|(p, q)| {
        let clocks: Vec<Clock> = (0..q).map(|k| Clock { p, q, first: (k as f64).rem_euclid(q as f64 / p as f64) }).collect();
        // One channel on some rows, then every channel on all rows.
        let best = fewest_left(&clocks, &|c| vec![on_lines(&series[0][..looked], c, measured).1])?;
        let again = [&clocks[best], &clocks[(best + 1) % q]].map(&left);
        is_clear(&again[0], &again[1]).then(|| clocks[best])
    })
}

/// The place of the clock that leaves clearly less than the others in every channel that is not constant.
fn fewest_left(clocks: &[Clock], left: &dyn Fn(&Clock) -> Vec<f64>) -> Option<usize> {
    let each: Vec<Vec<f64>> = clocks.iter().map(left).collect();
    let sum = |i: usize| each[i].iter().sum::<f64>();
    let best = (0..clocks.len()).min_by(|a, b| sum(*a).total_cmp(&sum(*b)))?;
    let others = |c: usize| {
        let mut all: Vec<f64> = (0..clocks.len()).filter(|i| *i != best).map(|i| each[i][c]).collect();
        let middle = all.len() / 2;
        *all.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    let typical: Vec<f64> = (0..each[best].len()).map(others).collect();
    is_clear(&each[best], &typical).then_some(best)
}

fn is_clear(left: &[f64], others: &[f64]) -> bool {
    let moving = || left.iter().zip(others).filter(|(_, other)| **other > 0.0);
    moving().count() > 0 && moving().all(|(own, other)| *own < LEFT * other)
}

/// Values at a clock's ticks whose straight lines fit the rows by least squares, and the mean square of what is left.
pub(crate) fn on_lines(x: &[f64], clock: &Clock, measured: &dyn Fn(usize) -> bool) -> (Vec<f64>, f64) {
    let n = x.len();
    // A tick before the first row, where the first is none.
    let before = usize::from(clock.first > 1e-9);
    let origin = clock.first - clock.step() * before as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive number of ticks")]
    let place = |i: usize| {
        let at = ((i as f64 - origin) / clock.step()).max(0.0);
        let j = (at + 1e-9).floor();
        (j as usize, (at - j).max(0.0))
    };
    let ticks = place(n - 1).0 + 2;
    let about = x[0];
    let (mut diagonal, mut beside, mut right) = (vec![1e-12; ticks], vec![0.0; ticks], vec![0.0; ticks]);
    for i in (0..n).filter(|i| measured(*i)) {
        let (j, u) = place(i);
        let (a, y) = (1.0 - u, x[i] - about);
        diagonal[j] += a * a;
        diagonal[j + 1] += u * u;
        beside[j] += a * u;
        right[j] += a * y;
        right[j + 1] += u * y;
    }
    for j in 1..ticks {
        let w = beside[j - 1] / diagonal[j - 1];
        diagonal[j] -= w * beside[j - 1];
        right[j] -= w * right[j - 1];
    }
    let mut values = vec![0.0; ticks];
    for j in (0..ticks).rev() {
        let next = if j + 1 < ticks { beside[j] * values[j + 1] } else { 0.0 };
        values[j] = (right[j] - next) / diagonal[j];
    }
    let left = |i: usize| {
        let (j, u) = place(i);
        (x[i] - about - (1.0 - u) * values[j] - u * values[j + 1]).powi(2)
    };
    let mean = (0..n).filter(|i| measured(*i)).map(left).sum::<f64>() / n as f64;
    (values.iter().skip(before).map(|v| v + about).collect(), mean)
}

#[cfg(test)]
mod tests;
