//! scenarios: dropouts and spikes of one channel. In: times and values, NaN where nothing was measured. Out: the channel repaired
//! and what was done.
//!
//! The local fit is a polynomial through the neighbours of a sample, without the sample; its error is scaled to that of one sample,
//! so that Gaussian noise gives errors of its own standard deviation in the middle and at the ends of a run. Before a sample is removed its
//! neighbours are fitted again without those that do not lie on one curve with the most of them: next to a spike at an end of a run a sound
//! sample is farther from its fit than the spike. Spikes go alone or in pairs: what more neighbouring samples share, a step or a pulse, is a signal
//! whatever its size, and stays. So does a sample that continues the curve of one side: the corner of a pulse.

/// Neighbours of a sample that a spike is judged by.
const NEIGHBOURS: usize = 10;
/// Degree of the fit that a spike is judged by.
const DEGREE: usize = 3;
/// Samples on each side that give the local scale.
const SCALE_REACH: usize = 30;
/// A spike is an error beyond so many robust standard deviations.
pub(crate) const SIGMAS: f64 = 6.0;
/// No channel of a run, in any unit, has numbers beyond this.
const POSSIBLE: f64 = 1e12;
/// Standard deviation of a Gaussian over its median absolute deviation.
const MAD_TO_SIGMA: f64 = 1.482_602_218_505_602;
/// Samples on each side of a dropout that bridge it, and the degree of the bridge.
const BRIDGE: (usize, usize) = (10, 5);

/// Samples from which on a departure is shared by neighbours: a tracker's slip and its repetition are two.
const SHARED: usize = 3;
/// Share of a departure below which the difference between neighbours joins them, and the distance from the curve of one side.
const JOINED: f64 = 0.5;
/// Samples of one side that a curve is continued from, and its degree: its error is 2.4 times that of a sample.
const SIDE: (usize, usize) = (5, 2);
/// Most that they may leave of their own curve, as a share of the departure; a spike among them as large as the sample's leaves a quarter.
const ON_CURVE: f64 = 0.2;

/// A sample that was removed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spike {
    pub(crate) index: usize,
    pub(crate) value: f64,
    /// What the local fit puts there; NaN when its neighbours are gone too.
    pub(crate) fit: f64,
}

/// Most points of a local fit, and most powers in one.
const MOST_POINTS: usize = 2 * BRIDGE.0;
const MOST_POWERS: usize = BRIDGE.1 + 1;

/// Points (time, value) of a local fit; kept off the heap, for there is one for each sample.
#[derive(Clone, Copy)]
struct Points {
    all: [(f64, f64); MOST_POINTS],
    count: usize,
}

impl std::ops::Deref for Points {
    type Target = [(f64, f64)];
    fn deref(&self) -> &Self::Target {
        &self.all[..self.count]
    }
}

/// Value at time zero of the least-squares polynomial through points (time, value), and the sum of its squared weights.
fn fit_at_zero(points: &[(f64, f64)], degree: usize) -> (f64, f64) {
    let span = points.iter().fold(0.0_f64, |m, p| m.max(p.0.abs())).max(f64::MIN_POSITIVE);
    let mut columns = [[0.0; MOST_POINTS]; MOST_POWERS];
    let mut basis = [(0.0, 0.0); MOST_POWERS];
    let (mut value, mut weights2) = (0.0, 0.0);
    for power in 0..=degree.min(points.len().saturating_sub(1)) {
        let (before, rest) = columns.split_at_mut(power);
        let column = &mut rest[0][..points.len()];
        #[expect(clippy::cast_possible_wrap, clippy::cast_possible_truncation, reason = "a degree below ten")]
        column.iter_mut().zip(points).for_each(|(x, p)| *x = (p.0 / span).powi(power as i32));
        let mut at_zero = if power == 0 { 1.0 } else { 0.0 };
        for (b, (b_zero, b_norm2)) in before.iter().zip(&basis) {
            let along = column.iter().zip(b).map(|(x, y)| x * y).sum::<f64>() / b_norm2;
            column.iter_mut().zip(b).for_each(|(x, y)| *x -= along * y);
            at_zero -= along * b_zero;
        }
        let norm2: f64 = column.iter().map(|x| x * x).sum();
        if norm2 < 1e-18 {
            break;
        }
        value += at_zero * column.iter().zip(points).map(|(x, p)| x * p.1).sum::<f64>() / norm2;
        weights2 += at_zero * at_zero / norm2;
        basis[power] = (at_zero, norm2);
    }
    (value, weights2)
}

/// Finite neighbours of sample `i`, up to `each` on each side and more on one where the other ends, within `reach_s`.
fn neighbours(t: &[f64], x: &[f64], i: usize, each: usize, reach_s: f64) -> Points {
    let near = |k: &usize| (t[*k] - t[i]).abs() <= reach_s;
    let mut side = [[0_usize; MOST_POINTS]; 2];
    let mut found = [0; 2];
    let take = |side: &mut [usize], ks: &mut dyn Iterator<Item = usize>| {
        let good = ks.take_while(near).filter(|k| x[*k].is_finite()).take(2 * each);
        side.iter_mut().zip(good).map(|(place, k)| *place = k).count()
    };
    found[0] = take(&mut side[0], &mut (0..i).rev());
    found[1] = take(&mut side[1], &mut (i + 1..x.len()));
    let short = found.map(|n| each.saturating_sub(n));
    let kept = [found[0].min(each + short[1]), found[1].min(each + short[0])];
    let mut points = Points { all: [(0.0, 0.0); MOST_POINTS], count: kept[0] + kept[1] };
    let chosen = side[0][..kept[0]].iter().chain(&side[1][..kept[1]]);
    points.all.iter_mut().zip(chosen).for_each(|(p, k)| *p = (t[*k] - t[i], x[*k]));
    points
}

/// Error of sample `i` against its local fit, scaled to one sample; `None` without enough neighbours.
fn error_of(t: &[f64], x: &[f64], i: usize, at: f64, reach_s: f64) -> Option<(f64, f64)> {
    let points = neighbours(t, x, i, NEIGHBOURS / 2, reach_s);
    if points.len() < DEGREE + 3 {
        return None;
    }
    Some(error_by(&points, at))
}

/// Error of a value at time zero against the fit through points, scaled to one sample, and the fit.
fn error_by(points: &[(f64, f64)], at: f64) -> (f64, f64) {
    let (fit, weights2) = fit_at_zero(points, DEGREE);
    ((at - fit) / (1.0 + weights2).sqrt(), fit)
}

/// The same by the neighbours that are no spikes themselves: those within `scale` times [`SIGMAS`] of the cubic through four of them to which the
/// larger part is nearest (least quantile of squares over all fours: Rousseeuw 1984, with as many as its breakdown point asks).
fn robust_error_of(t: &[f64], x: &[f64], i: usize, scale: f64, reach_s: f64) -> Option<f64> {
    let points = neighbours(t, x, i, NEIGHBOURS / 2, reach_s);
    if points.len() < DEGREE + 3 {
        return None;
    }
    let most = (points.len() + DEGREE + 2) / 2;
    let reaches = fours(points.len()).map(|four| (quantile(&points, four, most), four));
    let (_, four) = reaches.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let mut sound = Points { all: [(0.0, 0.0); MOST_POINTS], count: 0 };
    for point in points.iter().filter(|p| off(&points, four, p) <= SIGMAS * scale) {
        sound.all[sound.count] = *point;
        sound.count += 1;
    }
    Some(error_by(&sound, x[i]).0)
}

/// Every choice of four places of so many.
fn fours(n: usize) -> impl Iterator<Item = [usize; DEGREE + 1]> {
    (0..n).flat_map(move |a| (a + 1..n).flat_map(move |b| (b + 1..n).flat_map(move |c| (c + 1..n).map(move |d| [a, b, c, d]))))
}

/// Distance of a point from the cubic through four others.
fn off(points: &[(f64, f64)], four: [usize; DEGREE + 1], point: &(f64, f64)) -> f64 {
    let weight = |k: usize| {
        let others = four.iter().filter(|o| **o != k);
        others.map(|o| (point.0 - points[*o].0) / (points[k].0 - points[*o].0)).product::<f64>()
    };
    (point.1 - four.iter().map(|k| weight(*k) * points[*k].1).sum::<f64>()).abs()
}

/// Distance within which the nearest `most` points lie of the cubic through four of them.
fn quantile(points: &[(f64, f64)], four: [usize; DEGREE + 1], most: usize) -> f64 {
    let mut all = [f64::INFINITY; MOST_POINTS];
    all.iter_mut().zip(points).for_each(|(d, p)| *d = off(points, four, p));
    *all.select_nth_unstable_by(most - 1, f64::total_cmp).1
}

fn median_of(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Scales of the errors of a channel.
struct Scales {
    errors: Vec<Option<f64>>,
    global: f64,
}

impl Scales {
    /// `floor`: the smallest standard deviation that the instrument can have.
    fn new(errors: &[Option<f64>], floor: f64) -> Self {
        Self { errors: errors.to_vec(), global: (MAD_TO_SIGMA * median_of(sizes(errors))).max(floor) }
    }
    fn ratio_of(&self, i: usize, error: Option<f64>) -> Option<f64> {
        error.map(|e| self.ratio(i, e))
    }
    /// An error over its scale: the larger of the whole channel's and the neighbourhood's robust deviation. The latter is looked for only
    /// where the former leaves a doubt.
    fn ratio(&self, i: usize, error: f64) -> f64 {
        let most = error.abs() / self.global;
        if most <= SIGMAS { most } else { error.abs() / self.at(i) }
    }
    fn at(&self, i: usize) -> f64 {
        let part = &self.errors[i.saturating_sub(SCALE_REACH)..(i + SCALE_REACH + 1).min(self.errors.len())];
        self.global.max(MAD_TO_SIGMA * median_of(sizes(part)))
    }
}

fn sizes(part: &[Option<f64>]) -> Vec<f64> {
    part.iter().filter_map(|e| e.map(f64::abs)).collect()
}

/// Removes spikes from a channel and puts the local fit in their place, or NaN where too few neighbours are
/// left and at the ends of the channel, where a fit would be a guess. `floor` is
/// the smallest standard deviation that the instrument can have. Times increase; `interval_s` is the usual step.
pub(crate) fn remove_spikes(t: &[f64], x: &mut [f64], interval_s: f64, floor: f64) -> Vec<Spike> {
    let reach_s = 2.0 * NEIGHBOURS as f64 * interval_s;
    let recorded = x.to_vec();
    let mut removed = impossible(x);
    let error = |x: &[f64], i: usize| if x[i].is_finite() { error_of(t, x, i, x[i], reach_s).map(|e| e.0) } else { None };
    let errors: Vec<Option<f64>> = (0..x.len()).map(|i| error(x, i)).collect();
    let scales = Scales::new(&errors, floor);
    let mut worst = Worst::of(errors.iter().enumerate().map(|(i, e)| scales.ratio_of(i, *e)).collect());
    while let Some((place, ratio)) = worst.first() {
        if ratio <= SIGMAS || removed.len() >= x.len() / 4 {
            break;
        }
        let among_sound = scales.ratio_of(place, robust_error_of(t, x, place, scales.at(place), reach_s));
        if among_sound.is_some_and(|ratio| ratio <= SIGMAS) {
            worst.put(place, among_sound);
            continue;
        }
        let departure = ratio * scales.at(place);
        if is_shared(&recorded, place, departure) || continues_a_side(t, x, place, departure, reach_s) {
            worst.put(place, None);
            continue;
        }
        removed.push((place, x[place]));
        x[place] = f64::NAN;
        let near = place.saturating_sub(2 * NEIGHBOURS)..(place + 2 * NEIGHBOURS + 1).min(x.len());
        near.for_each(|i| worst.put(i, scales.ratio_of(i, error(x, i))));
    }
    removed.sort_by_key(|r| r.0);
    restore_good(t, x, &mut removed, &scales, reach_s);
    let inside = |i: usize| x[..i].iter().any(|v| v.is_finite()) && x[i..].iter().any(|v| v.is_finite());
    let fit = |i: usize, v: f64| error_of(t, x, i, v, reach_s).filter(|_| inside(i)).map_or(f64::NAN, |e| e.1);
    let fits: Vec<f64> = removed.iter().map(|(i, v)| fit(*i, *v)).collect();
    removed
        .iter()
        .zip(fits)
        .map(|(&(index, value), fit)| {
            x[index] = fit;
            Spike { index, value, fit }
        })
        .collect()
}

/// The greatest of many numbers while some of them change: a tournament, whose first place costs a comparison a round and not one a
/// number. What is not finite takes no part; of equals the last one wins.
struct Worst {
    ratios: Vec<f64>,
    /// Winners: those of place k play from places 2 k and 2 k + 1; the numbers' own places are the last half.
    winners: Vec<usize>,
}

impl Worst {
    fn of(ratios: Vec<Option<f64>>) -> Self {
        let n = ratios.len().next_power_of_two();
        let mut all: Vec<f64> = ratios.into_iter().map(finite).collect();
        all.resize(n, f64::NEG_INFINITY);
        let mut worst = Self { ratios: all, winners: (0..n).chain(0..n).collect() };
        (1..n).rev().for_each(|k| worst.play(k));
        worst
    }
    fn play(&mut self, k: usize) {
        let (a, b) = (self.winners[2 * k], self.winners[2 * k + 1]);
        self.winners[k] = if self.ratios[a].total_cmp(&self.ratios[b]).is_gt() { a } else { b };
    }
    fn put(&mut self, i: usize, ratio: Option<f64>) {
        self.ratios[i] = finite(ratio);
        let mut k = (self.ratios.len() + i) / 2;
        while k > 0 {
            self.play(k);
            k /= 2;
        }
    }
    fn first(&self) -> Option<(usize, f64)> {
        let place = *self.winners.get(1)?;
        let ratio = self.ratios[place];
        ratio.is_finite().then_some((place, ratio))
    }
}

fn finite(ratio: Option<f64>) -> f64 {
    ratio.filter(|r| r.is_finite()).unwrap_or(f64::NEG_INFINITY)
}

/// Takes out what no instrument gives before any fit: a fit through such a number drowns its neighbours.
fn impossible(x: &mut [f64]) -> Vec<(usize, f64)> {
    let all: Vec<(usize, f64)> = x.iter().copied().enumerate().filter(|(_, v)| v.abs() > POSSIBLE).collect();
    all.iter().for_each(|(i, _)| x[*i] = f64::NAN);
    all
}

/// Whether neighbours have a sample's departure from the local fit as well: whether it is joined to [`SHARED`] samples with itself, one after
/// the other, by differences that are small beside the departure. A spike differs from the samples on both of its sides by all of it.
fn is_shared(x: &[f64], place: usize, departure: f64) -> bool {
    let joined = |k: &usize| (x[*k] - x[*k - 1]).abs() < JOINED * departure.abs();
    let after = (place + 1..x.len()).take_while(joined).take(SHARED).count();
    let before = (1..=place).rev().take_while(joined).take(SHARED).count();
    1 + before + after >= SHARED
}

/// Whether a sample lies on the curve of the samples before it or of those after it: where both curves meet in a corner, it departs from a curve
/// through all of them.
fn continues_a_side(t: &[f64], x: &[f64], place: usize, departure: f64, reach_s: f64) -> bool {
    let near = |k: &usize| (t[*k] - t[place]).abs() <= reach_s && x[*k].is_finite();
    let on_curve = |side: &mut dyn Iterator<Item = usize>| {
        let points: Vec<(f64, f64)> = side.filter(near).take(SIDE.0).map(|k| (t[k] - t[place], x[k])).collect();
        let off = |at: (f64, f64)| {
            let shifted: Vec<(f64, f64)> = points.iter().map(|p| (p.0 - at.0, p.1)).collect();
            (at.1 - fit_at_zero(&shifted, SIDE.1).0).abs()
        };
        points.len() == SIDE.0
            && off((0.0, x[place])) < JOINED * departure.abs()
            && points.iter().all(|p| off(*p) < ON_CURVE * departure.abs())
    };
    on_curve(&mut (0..place).rev()) || on_curve(&mut (place + 1..x.len()))
}

/// Neighbours of a cluster of spikes may have been taken for spikes while the cluster stood: those come back.
fn restore_good(t: &[f64], x: &mut [f64], removed: &mut Vec<(usize, f64)>, scales: &Scales, reach_s: f64) {
    removed.retain(|&(i, value)| {
        let good =
            value.abs() <= POSSIBLE && error_of(t, x, i, value, reach_s).is_some_and(|(e, _)| scales.ratio(i, e) <= SIGMAS);
        if good {
            x[i] = value;
        }
        !good
    });
}

/// Bridges NaN inside a channel by a local polynomial through both sides; returns how many samples. Ends must be finite.
pub(crate) fn bridge(t: &[f64], x: &mut [f64]) -> usize {
    let holes: Vec<usize> = (0..x.len()).filter(|i| !x[*i].is_finite()).collect();
    let fits: Vec<f64> = holes
        .iter()
        .map(|&i| {
            let points = neighbours(t, x, i, BRIDGE.0, f64::INFINITY);
            fit_at_zero(&points, BRIDGE.1.min(points.len() / 3)).0
        })
        .collect();
    holes.iter().zip(fits).for_each(|(i, fit)| x[*i] = fit);
    holes.len()
}

/// Stretches of rows to keep, when stretches of more than `longest` NaN in any channel cut the rows. Each starts and ends with a row
/// in which every channel is finite.
pub(crate) fn pieces(channels: &[&[f64]], longest: usize) -> Vec<std::ops::Range<usize>> {
    let rows = channels.first().map_or(0, |c| c.len());
    let mut keep = vec![true; rows];
    for channel in channels {
        let mut start = 0;
        for i in 0..=rows {
            if i == rows || channel[i].is_finite() {
                if i - start > longest {
                    keep[start..i].fill(false);
                }
                start = i + 1;
            }
        }
    }
    let whole = |i: usize| channels.iter().all(|c| c[i].is_finite());
    let mut all = Vec::new();
    let mut i = 0;
    while i < rows {
        let end = (i..rows).find(|k| !keep[*k]).unwrap_or(rows);
        if let (Some(first), Some(last)) = ((i..end).find(|k| whole(*k)), (i..end).rev().find(|k| whole(*k))) {
            all.push(first..last + 1);
        }
        i = (end..rows).find(|k| keep[*k]).unwrap_or(rows);
    }
    all
}

/// Takes jumps of 360° out of an angle in degrees; NaN are passed over.
pub(crate) fn unwrap_deg(x: &mut [f64]) {
    let mut last = f64::NAN;
    for value in x.iter_mut().filter(|v| v.is_finite()) {
        if last.is_finite() {
            *value -= 360.0 * ((*value - last) / 360.0).round();
        }
        last = *value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic is reproduced to rounding: sums of ten products of size one, a condition of the basis below 100.
    #[test]
    fn exact_fits_reproduce_their_degree() {
        let cubic = |t: f64| 1.0 - 2.0 * t + 3.0 * t * t - 0.5 * t * t * t;
        let points: Vec<(f64, f64)> = [-0.9, -0.5, -0.2, 0.1, 0.4, 0.8, 1.3].map(|t| (t, cubic(t))).to_vec();
        let (value, weights2) = fit_at_zero(&points, 3);
        assert!((value - 1.0).abs() < 1e-13);
        assert!(weights2 > 1.0 / 7.0, "no fit is better than the mean of all");
    }

    /// One cell of 1e308: it and nothing else is removed.
    #[test]
    fn law_an_impossible_number_costs_its_own_sample_only() {
        let t: Vec<f64> = (0..200).map(|i| f64::from(i) / 150.0).collect();
        let clean: Vec<f64> = t.iter().map(|t| (5.0 * t).sin()).collect();
        for (at, bad) in [(100, 1e308), (100, -1e308), (0, 1e300), (199, 1e13)] {
            let mut x = clean.clone();
            x[at] = bad;
            let spikes = remove_spikes(&t, &mut x, 1.0 / 150.0, 1e-3);
            assert_eq!(spikes.iter().map(|s| s.index).collect::<Vec<_>>(), [at], "{bad}");
            let others = x.iter().zip(&clean).enumerate().filter(|(i, _)| *i != at);
            assert!(others.into_iter().all(|(_, (a, b))| a.to_bits() == b.to_bits()), "{bad}");
        }
    }

    /// Spikes of a hundred deviations anywhere, at an end, next to it, two within five samples or so that both swell the scale there: they and
    /// nothing else are removed.
    #[test]
    fn law_spikes_cost_their_own_samples_only() {
        const N: usize = 200;
        let t: Vec<f64> = (0..N).map(|i| i as f64 / 150.0).collect();
        let noise = |i: usize| 1e-3 * (12.9898 * i as f64).sin();
        let clean: Vec<f64> = t.iter().enumerate().map(|(i, t)| 0.1 * (5.0 * t).sin() + noise(i)).collect();
        for at in (0..8).chain(95..100).chain(N - 13..N) {
            for (apart, sign) in (0..6).chain(22..28).flat_map(|d| [(d, 1.0), (d, -1.0)]) {
                let bad = [at, (at + apart).min(N - 1)];
                let mut x = clean.clone();
                (x[bad[1]], x[bad[0]]) = (clean[bad[1]] + sign * 0.1, clean[bad[0]] + 0.1);
                let spikes = remove_spikes(&t, &mut x, 1.0 / 150.0, 1e-3);
                let mut expected = bad.to_vec();
                expected.dedup();
                assert_eq!(spikes.iter().map(|s| s.index).collect::<Vec<_>>(), expected, "{bad:?} {sign}");
            }
        }
    }

    /// A step, a pulse of 0.4 s and a slip of three samples are shared by neighbours: nothing is removed. Two samples that slip together go.
    #[test]
    fn law_what_neighbours_share_stays() {
        let t: Vec<f64> = (0..400).map(|i| f64::from(i) / 80.0).collect();
        let noise = |i: usize| 1e-3 * (12.9898 * i as f64).sin();
        let with = |signal: &dyn Fn(f64) -> f64| -> Vec<f64> {
            t.iter().enumerate().map(|(i, t)| 10.0 * t - 4.9 * t * t + signal(*t) + noise(i)).collect()
        };
        let step = |t: f64| if t > 2.503 { 66.0 } else { 0.0 };
        let pulse = |t: f64| if (t - 2.5).abs() < 0.2 { -100.0 * (7.85 * (t - 2.5)).cos() } else { 0.0 };
        let slip = |t: f64| if (2.49..2.53).contains(&t) { 5.0 } else { 0.0 };
        let pair = |t: f64| if (2.49..2.52).contains(&t) { 5.0 } else { 0.0 };
        let count = |signal: &dyn Fn(f64) -> f64| remove_spikes(&t, &mut with(signal), 1.0 / 80.0, 1e-3).len();
        assert_eq!([count(&step), count(&pulse), count(&slip), count(&pair)], [0, 0, 0, 2]);
    }

    /// Of ten points on a cubic three may lie anywhere: the others are told.
    #[test]
    fn exact_sound_neighbours_are_told() {
        let cubic = |t: f64| 0.3 + t - 0.4 * t * t + 0.1 * t * t * t;
        let t: Vec<f64> = (0..11).map(f64::from).collect();
        for i in [0, 4, 10] {
            for bad in [[1, 2, 3], [2, 5, 9], [6, 7, 8]] {
                let mut x: Vec<f64> = t.iter().map(|t| cubic(*t)).collect();
                bad.iter().enumerate().for_each(|(k, b)| x[*b] += [5.0, -7.0, 6.0][k]);
                let error = robust_error_of(&t, &x, i, 1e-6, 20.0).expect("ten neighbours");
                assert!(error.abs() < 1e-9, "{i} {bad:?} {error}: rounding of values below 40");
            }
        }
        assert_eq!(fours(10).count(), 210);
        assert!(robust_error_of(&t[..6], &[0.0; 6], 2, 1e-6, 20.0).is_none(), "five neighbours");
    }

    #[test]
    fn exact_bridges_reproduce_the_fifth_degree() {
        let quintic = |t: f64| 1.0 + t - t.powi(2) + 0.3 * t.powi(3) - 0.2 * t.powi(4) + 0.1 * t.powi(5);
        let t: Vec<f64> = (0..40).map(|i| f64::from(i) * 0.05 - 1.0).collect();
        let mut x: Vec<f64> = t.iter().map(|t| quintic(*t)).collect();
        x[15..22].fill(f64::NAN);
        assert_eq!(bridge(&t, &mut x), 7);
        let worst = t.iter().zip(&x).fold(0.0_f64, |m, (t, x)| m.max((x - quintic(*t)).abs()));
        assert!(worst < 1e-11, "{worst}: rounding of a basis of sixth order");
    }

    #[test]
    fn law_pieces_start_and_end_with_whole_rows() {
        let mut a = vec![1.0; 30];
        let mut b = vec![1.0; 30];
        a[..2].fill(f64::NAN);
        a[10..14].fill(f64::NAN);
        b[14] = f64::NAN;
        b[20] = f64::NAN;
        assert_eq!(pieces(&[&a, &b], 3), [2..10, 15..30]);
        assert_eq!(pieces(&[&a, &b], 4), std::slice::from_ref(&(2..30)));
        assert_eq!(pieces(&[&[f64::NAN; 5]], 1), Vec::<std::ops::Range<usize>>::new());
    }

    #[test]
    fn law_unwrapping_takes_out_turns_only() {
        let mut x = [170.0, 179.0, f64::NAN, -178.0, -170.0, 179.0];
        unwrap_deg(&mut x);
        let expected = [170.0, 179.0, f64::NAN, 182.0, 190.0, 179.0];
        assert!(x.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12 || (a.is_nan() && b.is_nan())), "{x:?}");
    }
}
