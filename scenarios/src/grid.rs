//! scenarios: the clock of a run. In: its times. Out: a uniform grid in which rows may be missing, or the step that is not even.

use crate::columns::fault;
use crate::error::ReadError;
use std::path::Path;

/// Largest deviation of a sample interval from the usual one, as a fraction of it.
const UNEVEN: f64 = 0.01;
/// Steps that times may be rounded to, s.
const ROUNDED_TO_S: [f64; 6] = [0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
/// Largest range of the distances of rounded times from their clock, as a fraction of the step they are rounded to: one whether they are
/// rounded or cut off, and what the fit is off by.
const OFF_CLOCK: f64 = 1.05;

/// Longest dropout that is bridged, s.
pub const LONGEST_BRIDGE_S: f64 = 0.1;
/// Missing rows that are kept of a gap, or twice what is bridged, if that is more: a run is split there in any case, and no spike is told by
/// samples so far away.
const MISSING: f64 = 500.0;
/// Rows of a grid for each of the file, and beyond.
const MOST_ROWS: [usize; 2] = [20, 100_000];

/// Uniform sample grid of a file in which rows may be missing; of long gaps not all.
pub(crate) struct Grid {
    pub(crate) t_s: Vec<f64>,
    pub(crate) interval_s: f64,
    /// Samples from the first time to the last, there or missing.
    pub(crate) samples: usize,
    /// Place of each row of the file on the grid.
    places: Vec<usize>,
}

impl Grid {
    /// The grid of increasing times, two at least; `lines` are those of the rows in the file.
    pub(crate) fn of(path: &Path, t: Vec<f64>, lines: &[usize], notes: &mut Vec<String>) -> Result<Self, ReadError> {
        match Self::even(path, &t, lines) {
            Err(uneven) => match rounded_clock(&t) {
                Some((clock, note)) => {
                    notes.push(note);
                    Self::even(path, &clock, lines)
                }
                None => Err(uneven),
            },
            even => even,
        }
    }
    fn even(path: &Path, t: &[f64], lines: &[usize]) -> Result<Self, ReadError> {
        let usual = usual_step(t);
        let refused = |line: usize, value: &str, what: &str, remedy: &str| {
            ReadError::Faults(vec![fault(path, Some(line), "t_s", value, what, remedy)])
        };
        let kept = MISSING.max(2.0 * LONGEST_BRIDGE_S / usual);
        let (mut places, mut samples) = (vec![0], 1);
        let mut uneven = Vec::new();
        for (i, w) in t.windows(2).enumerate() {
            let step = w[1] - w[0];
            let count = (step / usual).round().max(1.0);
            if (step - count * usual).abs() > UNEVEN * usual {
                uneven.push((lines[i + 1], step));
            }
            if count > 1e7 {
                let what = "leaves a gap of more than ten million samples";
                return Err(refused(lines[i + 1], &w[1].to_string(), what, "seconds, one run"));
            }
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 1 and 1e7, checked above")]
            let [rows, missed] = [count.min(kept), count].map(|x| x as usize);
            places.push(places[i] + rows);
            samples += missed;
        }
        if let Some((line, step)) = uneven.first() {
            let what = format!(
                "sampling must be uniform to 1 %: {} of {} steps are not, this one is {step:.6} s where {usual:.6} s is usual",
                uneven.len(),
                t.len() - 1
            );
            return Err(refused(*line, "", &what, "resample the run to a uniform rate"));
        }
        let rows = places[t.len() - 1] + 1;
        if rows > MOST_ROWS[0] * t.len() + MOST_ROWS[1] {
            let what = format!("long gaps take most of the samples: {} of {samples} are there", t.len());
            let last = t.len() - 1;
            return Err(refused(lines[last], &t[last].to_string(), &what, "a run with fewer dropouts, or a part of it"));
        }
        let mut t_s = vec![f64::NAN; rows];
        places.iter().zip(t).for_each(|(p, t)| t_s[*p] = *t);
        for (p, w) in places.windows(2).zip(t.windows(2)) {
            let step = (w[1] - w[0]) / (p[1] - p[0]) as f64;
            (1..p[1] - p[0]).for_each(|k| t_s[p[0] + k] = w[0] + step * k as f64);
        }
        let interval_s = (t[t.len() - 1] - t[0]) / (samples - 1) as f64;
        Ok(Self { t_s, interval_s, samples, places })
    }
    /// A column on the grid, NaN in missing rows.
    pub(crate) fn spread(&self, column: &[f64]) -> Vec<f64> {
        let mut all = vec![f64::NAN; self.t_s.len()];
        self.places.iter().zip(column).for_each(|(p, x)| all[*p] = *x);
        all
    }
}

fn usual_step(t: &[f64]) -> f64 {
    let mut steps: Vec<f64> = t.windows(2).map(|w| w[1] - w[0]).collect();
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Times that are a uniform clock rounded to a tenth, a hundredth ... of a second: that clock, by least squares, and a note of it. Nothing
/// where they are not rounded, or not to less than half a sample, or no clock is within the rounding of them all.
fn rounded_clock(t: &[f64]) -> Option<(Vec<f64>, String)> {
    let to = ROUNDED_TO_S.into_iter().find(|q| t.iter().all(|t| (t / q - (t / q).round()).abs() < 1e-3))?;
    let usual = usual_step(t);
    if to > 0.5 * usual {
        return None;
    }
    // Counted by the mean interval so far, which a long run makes good enough for a long gap; then along the line that comes of it.
    let mut places = vec![0.0];
    let mut interval_s = usual;
    for w in t.windows(2) {
        let place = places[places.len() - 1] + ((w[1] - w[0]) / interval_s).round().max(1.0);
        places.push(place);
        interval_s = (w[1] - t[0]) / place;
    }
    let mut start_s = 0.0;
    for _ in 0..3 {
        (start_s, interval_s) = line(&places, t);
        places = t.iter().map(|t| ((t - start_s) / interval_s).round()).collect();
    }
    let clock: Vec<f64> = places.iter().map(|p| start_s + interval_s * p).collect();
    let range = clock.iter().zip(t).map(|(a, b)| a - b).fold((f64::MAX, f64::MIN), |(low, high), d| (low.min(d), high.max(d)));
    let fits = range.1 - range.0 <= OFF_CLOCK * to && places.windows(2).all(|w| w[1] > w[0]);
    let note = || {
        format!(
            "t_s: rounded to {to} s, which is not even to {} %; taken as a clock of {:.4} Hz, within the rounding of every time (write \
             more digits to be rid of this)",
            100.0 * UNEVEN,
            1.0 / interval_s
        )
    };
    fits.then(|| (clock, note()))
}

/// Least-squares line through points: its value at zero and its slope.
fn line(x: &[f64], y: &[f64]) -> (f64, f64) {
    let n = x.len() as f64;
    let (mean_x, mean_y) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let along: f64 = x.iter().zip(y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let slope = along / x.iter().map(|x| (x - mean_x) * (x - mean_x)).sum::<f64>();
    (mean_y - slope * mean_x, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times rounded to 1 ms with a tenth of the rows gone and one long gap: the clock comes back to the
    /// rounding of both ends, 1 ms in 10 s, and every row at its place.
    #[test]
    fn recover_a_rounded_clock() {
        let kept: Vec<u32> = (0..1500).filter(|i| i * 7 % 10 != 3 && !(600..900).contains(i)).collect();
        let truth: Vec<f64> = kept.iter().map(|i| 0.4 + f64::from(*i) / 150.0).collect();
        for (name, rounded) in [("nearest", 0.0), ("cut off", 0.5)] {
            let t: Vec<f64> = truth.iter().map(|t| (1e3 * t - rounded).round() / 1e3).collect();
            let mut notes = Vec::new();
            let grid = Grid::of(Path::new("run.csv"), t, &[1; 1080], &mut notes).expect("a clock");
            assert!(notes.len() == 1 && notes[0].contains("0.001 s"), "{notes:?}");
            assert!((grid.interval_s * 150.0 - 1.0).abs() < 1e-4, "{name}: {}", grid.interval_s);
            assert_eq!(grid.places, kept.iter().map(|i| *i as usize).collect::<Vec<_>>(), "{name}");
        }
    }

    /// A day between two takes of a second keeps few rows, and every time; a row in ten thousand is no run.
    #[test]
    fn law_long_gaps_take_no_memory() {
        let t: Vec<f64> = (0..200).map(|i| f64::from(i) / 100.0 + if i < 100 { 0.0 } else { 86_400.0 }).collect();
        let grid = Grid::of(Path::new("run.csv"), t.clone(), &[1; 200], &mut Vec::new()).expect("a clock");
        assert!(grid.t_s.len() < 1000 && grid.samples == 200 + 8_640_000, "{} rows, {} samples", grid.t_s.len(), grid.samples);
        // The mean over a day of hundredths, to rounding.
        assert!((grid.interval_s - 0.01).abs() < 1e-12, "{}", grid.interval_s);
        assert_eq!(grid.spread(&t).into_iter().filter(|t| t.is_finite()).collect::<Vec<_>>(), t);
        let rare: Vec<f64> = (0..4000).map(|i| f64::from(i / 2 * 10_000 + i % 2)).collect();
        let refused = Grid::of(Path::new("run.csv"), rare, &[1; 4000], &mut Vec::new()).err().map(|e| e.to_string());
        assert!(refused.as_ref().is_some_and(|e| e.contains("4000 of 19990002")), "{refused:?}");
    }

    /// Jitter beyond the rounding is no clock.
    #[test]
    fn law_uneven_times_stay_faults() {
        let t: Vec<f64> =
            (0..300).map(|i| (1e3 * (f64::from(i) / 150.0 + if i % 9 == 0 { 2e-3 } else { 0.0 })).round() / 1e3).collect();
        assert!(Grid::of(Path::new("run.csv"), t, &[1; 300], &mut Vec::new()).is_err());
        let whole: Vec<f64> = [0.0, 0.1, 0.2, 0.5, 0.6, 0.7, 0.71].to_vec();
        assert!(Grid::of(Path::new("run.csv"), whole, &[1; 7], &mut Vec::new()).is_err());
    }
}
