//! report: an axis on paper. In: values. Out: places and round ticks with their labels.

/// A range of one axis and how it lies on paper.
pub(crate) struct Scale {
    low: f64,
    high: f64,
    log: bool,
    from: f64,
    to: f64,
}

impl Scale {
    pub(crate) fn new(values: impl Iterator<Item = f64>, log: bool, from: f64, to: f64) -> Option<Self> {
        let usable = values.filter(|v| v.is_finite() && (!log || *v > 0.0)).map(|v| if log { v.log10() } else { v });
        let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if low > high {
            return None;
        }
        let margin = if high > low { 0.05 * (high - low) } else { 0.5 * high.abs().max(1e-12) };
        Some(Self { low: low - margin, high: high + margin, log, from, to })
    }
    /// Ends at the data; for time and frequency.
    pub(crate) fn tight(self) -> Self {
        let margin = (self.high - self.low) / 22.0;
        Self { low: self.low + margin, high: self.high - margin, ..self }
    }
    pub(crate) fn place(&self, v: f64) -> Option<f64> {
        let x = if self.log { v.log10() } else { v };
        x.is_finite().then(|| self.from + (x - self.low) / (self.high - self.low) * (self.to - self.from))
    }
    /// Least and largest place on the paper.
    pub(crate) fn ends(&self) -> [f64; 2] {
        [self.from.min(self.to), self.from.max(self.to)]
    }
    /// Round values inside, with their labels.
    pub(crate) fn ticks(&self) -> Vec<(f64, String)> {
        if self.log {
            return self.log_ticks();
        }
        // Labels of about 40 units need that much room.
        let most = ((self.to - self.from).abs() / 55.0).clamp(2.0, 8.0);
        linear_ticks(self.low, self.high, most)
    }
    fn log_ticks(&self) -> Vec<(f64, String)> {
        #[expect(clippy::cast_possible_truncation, reason = "exponents of doubles")]
        let (a, b) = (self.low.floor() as i32, self.high.ceil() as i32);
        let marks: &[f64] = if self.high - self.low < 1.6 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let all = (a..=b).flat_map(|e| marks.iter().map(move |m| m * 10_f64.powi(e)));
        let inside: Vec<f64> = all.filter(|v| (self.low..=self.high).contains(&v.log10())).collect();
        if inside.len() < 2 {
            return linear_ticks(10_f64.powf(self.low), 10_f64.powf(self.high), 5.0);
        }
        let every = inside.len().div_ceil(6).max(1);
        inside.into_iter().step_by(every).map(|v| (v, plain(v))).collect()
    }
}

/// Round values between two ends, with labels.
fn linear_ticks(low: f64, high: f64, most: f64) -> Vec<(f64, String)> {
    let step = round_step((high - low) / most);
    let first = (low / step - 1e-9).ceil();
    (0..12).map(|k| (first + f64::from(k)) * step).take_while(|v| *v <= high + 1e-9 * step).map(|v| (v, label(v, step))).collect()
}

/// 1, 2 or 5 times a power of ten, not below what is asked for.
fn round_step(least: f64) -> f64 {
    let power = 10_f64.powf(least.abs().max(f64::MIN_POSITIVE).log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= least * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

fn label(v: f64, step: f64) -> String {
    if v.abs() < 1e-9 * step {
        return "0".to_owned();
    }
    let whole = -step.log10().floor();
    if !(-4.0..=4.0).contains(&whole) {
        // As many digits as tell neighbours apart.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 9")]
        let digits = (v.abs().log10().floor() + whole).clamp(0.0, 9.0) as usize;
        return format!("{v:.digits$e}").replace('-', "−");
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 4")]
    let digits = whole.max(0.0) as usize;
    format!("{v:.digits$}").replace('-', "−")
}

pub(crate) fn plain(v: f64) -> String {
    if (1e-3..1e4).contains(&v) { format!("{v}") } else { format!("{v:.0e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_steps_are_round() {
        for (least, step) in [(0.9, 1.0), (1.1, 2.0), (2.1, 5.0), (6.0, 10.0), (0.03, 0.05)] {
            assert!((round_step(least) / step - 1.0).abs() < 1e-12, "{least}");
        }
    }

    /// Neighbours have labels of their own, however small their distance.
    #[test]
    fn law_labels_differ() {
        for (low, high) in [(0.002, 0.002_000_2), (-3e-7, 2e-7), (6.661_5, 6.662_5), (1e6, 1.000_3e6)] {
            let s = Scale::new([low, high].into_iter(), false, 0.0, 300.0).expect("finite");
            let mut labels: Vec<String> = s.ticks().into_iter().map(|(_, text)| text).collect();
            let count = labels.len();
            labels.dedup();
            assert!(count > 1 && labels.len() == count, "{low} {high}: {labels:?}");
        }
    }

    #[test]
    fn law_ticks_lie_inside() {
        for (low, high, log) in [(0.0, 12.0, false), (-3e-4, 2e-4, false), (1e-7, 3e-2, true), (0.8, 1.3, true)] {
            let s = Scale::new([low, high].into_iter(), log, 0.0, 300.0).expect("finite");
            let ticks = s.ticks();
            assert!((2..=12).contains(&ticks.len()), "{low} {high}: {ticks:?}");
            for (v, _) in ticks {
                let p = s.place(v).expect("finite");
                assert!((-1e-6..=300.000_001).contains(&p), "{v}");
            }
        }
    }
}
