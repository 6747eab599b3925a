//! replay: statistics of many descents. In: descents in the order of their draws. Out: lines at touch-down and over height, rows.

use super::quantity::{OVER_HEIGHT, TOUCH_DOWN};
use super::result::{DescentEnds, DescentReason, HeightLine, TouchDownLine};
use super::shares::{Regressors, of_pairs};
use crate::quantile::quantile;
use windfall_model::study::{Cell, CellKind, Column, Row};
use windfall_sim::{DescentFlown, SimError};

/// One descent with its parameters.
pub(super) struct FlownDraw {
    /// Number of the drawn model.
    pub(super) model: u64,
    /// Values of what was drawn.
    pub(super) values: Vec<f64>,
    pub(super) flown: Result<DescentFlown, SimError>,
}

impl FlownDraw {
    fn landed(&self) -> Option<[f64; TOUCH_DOWN.len()]> {
        let touch_down = self.flown.as_ref().ok()?.touch_down.as_ref()?;
        Some(TOUCH_DOWN.map(|(_, of)| of(touch_down)))
    }
}

/// Mean, standard deviation and quantiles 0.025, 0.5, 0.975 of some numbers; zeros of none.
struct Spread {
    mean: f64,
    std: f64,
    quantiles: [f64; 3],
}

impl Spread {
    fn of(mut x: Vec<f64>) -> Self {
        let n = x.len() as f64;
        if x.is_empty() {
            return Self { mean: 0.0, std: 0.0, quantiles: [0.0; 3] };
        }
        let mean = x.iter().sum::<f64>() / n;
        let std = (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0)).sqrt();
        x.sort_by(f64::total_cmp);
        let quantiles = [0.025, 0.5, 0.975].map(|p| quantile(&x, p));
        Self { mean, std, quantiles }
    }
}

/// How the descents ended.
pub(super) fn ends(all: &[FlownDraw]) -> DescentEnds {
    let mut ends = DescentEnds::default();
    for f in all {
        match &f.flown {
            Ok(flown) => {
                ends.landed += u64::from(flown.touch_down.is_some());
                ends.aloft += u64::from(flown.touch_down.is_none());
                ends.tumbled += u64::from(flown.tumbled_at_m.is_some());
            }
            Err(error) => {
                ends.failed += 1;
                note(&mut ends.reasons, error);
            }
        }
    }
    ends.reasons.sort_by(|a, b| b.count.cmp(&a.count).then_with(|| a.reason.cmp(&b.reason)));
    ends
}

/// Counts an error with those of its kind: messages that are alike but for their numbers.
fn note(reasons: &mut Vec<DescentReason>, error: &SimError) {
    let reason = error.to_string();
    let words = |text: &str| text.chars().filter(|c| !c.is_ascii_digit() && !".-+e".contains(*c)).collect::<String>();
    match reasons.iter_mut().find(|r| words(&r.reason) == words(&reason)) {
        Some(r) => r.count += 1,
        None => reasons.push(DescentReason { reason, count: 1 }),
    }
}

/// Lines at touch-down. `paired`: draws 2k and 2k + 1 share their model; `chance`: flights of one model differ.
pub(super) fn touch_down(
    all: &[FlownDraw],
    nominal: Option<&DescentFlown>,
    names: &[String],
    [paired, chance]: [bool; 2],
) -> Vec<TouchDownLine> {
    let landed: Vec<(&FlownDraw, [f64; TOUCH_DOWN.len()])> = all.iter().filter_map(|f| Some((f, f.landed()?))).collect();
    if landed.is_empty() {
        return Vec::new();
    }
    let values: Vec<&[f64]> = landed.iter().map(|(f, _)| f.values.as_slice()).collect();
    let mut models: Vec<u64> = landed.iter().map(|(f, _)| f.model).collect();
    models.dedup();
    let regressors = Regressors::new(names.to_vec(), &values, models.len());
    let line = |(k, (name, of)): (usize, &super::quantity::OfTouchDown)| {
        let y: Vec<f64> = landed.iter().map(|(_, x)| x[k]).collect();
        let pairs = landed.windows(2).filter(|w| w[0].0.model == w[1].0.model).map(|w| [w[0].1[k], w[1].1[k]]);
        let (share_linear, parameters) = regressors.shares(&y);
        let (share, share_ci95) = match (names.is_empty(), chance) {
            (true, _) => (0.0, [0.0; 2]),
            (false, false) => (1.0, [1.0; 2]),
            // Without pairs the linear part is all that can be determined.
            (false, true) if !paired => (share_linear, [share_linear, 1.0]),
            (false, true) => of_pairs(&pairs.collect::<Vec<_>>()),
        };
        let Spread { mean, std, quantiles: [low, median, high] } = Spread::of(y);
        TouchDownLine {
            quantity: (*name).to_owned(),
            nominal: nominal.and_then(|n| n.touch_down.as_ref()).map(of),
            mean,
            std,
            low,
            median,
            high,
            std_of_parameters: std * share.sqrt(),
            std_of_flight: std * (1.0 - share).sqrt(),
            share_of_parameters: share,
            share_ci95,
            share_linear,
            parameters,
        }
    };
    TOUCH_DOWN.iter().enumerate().map(line).collect()
}

/// Lines over height.
pub(super) fn over_height(all: &[FlownDraw], nominal: Option<&DescentFlown>, heights_m: &[f64]) -> Vec<HeightLine> {
    let line = |(name, of): &super::quantity::OfState| {
        let at =
            |i: usize| -> Vec<f64> { all.iter().filter_map(|f| f.flown.as_ref().ok()?.at_heights[i].as_ref().map(of)).collect() };
        let columns: Vec<Vec<f64>> = (0..heights_m.len()).map(at).collect();
        let draws = columns.iter().map(|c| c.len() as u64).collect();
        let spreads: Vec<Spread> = columns.into_iter().map(Spread::of).collect();
        let each = |of: fn(&Spread) -> f64| spreads.iter().map(of).collect();
        HeightLine {
            quantity: (*name).to_owned(),
            height_m: heights_m.to_vec(),
            draws,
            nominal: (0..heights_m.len()).map(|i| Some(of(nominal?.at_heights[i].as_ref()?))).collect(),
            mean: each(|s| s.mean),
            std: each(|s| s.std),
            low: each(|s| s.quantiles[0]),
            median: each(|s| s.quantiles[1]),
            high: each(|s| s.quantiles[2]),
        }
    };
    OVER_HEIGHT.iter().map(line).collect()
}

/// Columns after the draw's number.
pub(super) fn columns(names: &[String]) -> Vec<Column> {
    let number = |name: String| Column { name, kind: CellKind::Number };
    let mut all = vec![Column { name: "failure".to_owned(), kind: CellKind::Word }, number("model".to_owned())];
    all.extend(names.iter().map(|n| number(format!("parameter.{n}"))));
    all.extend([Column { name: "landed".to_owned(), kind: CellKind::Flag }, number("tumbled_at_m".to_owned())]);
    all.extend(TOUCH_DOWN.iter().map(|(n, _)| number(format!("touch_down.{n}"))));
    all
}

/// Ways over the ground of the descents that landed, toward north and east, m.
pub(super) fn places_m(all: &[FlownDraw]) -> Vec<[f64; 2]> {
    all.iter().filter_map(|f| Some(f.flown.as_ref().ok()?.touch_down.as_ref()?.drift_m)).collect()
}

/// A row a draw.
pub(super) fn rows(all: &[FlownDraw]) -> Vec<Row> {
    let row = |(draw, f): (usize, &FlownDraw)| {
        let failure = f.flown.as_ref().err().map_or_else(String::new, SimError::to_string);
        let mut cells = vec![Cell::Word(failure), Cell::Number(Some(f.model as f64))];
        cells.extend(f.values.iter().map(|v| Cell::Number(Some(*v))));
        let flown = f.flown.as_ref().ok();
        cells.push(Cell::Flag(flown.map(|x| x.touch_down.is_some())));
        cells.push(Cell::Number(flown.and_then(|x| x.tumbled_at_m)));
        let landed = f.landed();
        cells.extend((0..TOUCH_DOWN.len()).map(|k| Cell::Number(landed.map(|x| x[k]))));
        Row { draw: draw as u64, cells }
    };
    all.iter().enumerate().map(row).collect()
}

#[cfg(test)]
mod tests;
