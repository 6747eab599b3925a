//! study: a row of a study under construction. In: what a draw gave. Out: cells in their places.

use super::columns::FLIGHT;
use std::collections::HashMap;
use windfall_model::frames::Rotation;
use windfall_model::study::Cell;
use windfall_pid::Estimate;
use windfall_replay::mean_median_std;
use windfall_sim::Truth;

/// A row under construction. What the study does not keep has no place and is let go.
pub(super) struct Cells<'p> {
    pub(super) cells: Vec<Cell>,
    pub(super) places: &'p HashMap<String, usize>,
}

impl Cells<'_> {
    pub(super) fn set(&mut self, name: &str, cell: Cell) {
        if let Some(&i) = self.places.get(name) {
            self.cells[i] = cell;
        }
    }
    pub(super) fn number(&mut self, name: &str, x: f64) {
        self.set(name, Cell::Number(x.is_finite().then_some(x)));
    }
    pub(super) fn flag(&mut self, name: &str, x: bool) {
        self.set(name, Cell::Flag(Some(x)));
    }
    /// An estimate beside the truth.
    pub(super) fn estimate(&mut self, stem: &str, estimate: f64, std_error: Option<f64>, ci95: Option<[f64; 2]>, truth: f64) {
        self.number(&format!("{stem}.estimate"), estimate);
        self.number(&format!("{stem}.error"), estimate - truth);
        if let Some(s) = std_error {
            self.number(&format!("{stem}.std_error"), s);
        }
        if let Some([low, high]) = ci95 {
            self.number(&format!("{stem}.low"), low);
            self.number(&format!("{stem}.high"), high);
            self.flag(&format!("{stem}.covered"), low <= truth && truth <= high);
        }
    }
    pub(super) fn parameter(&mut self, stem: &str, p: &Estimate, truth: f64) {
        self.estimate(stem, p.estimate, Some(p.std_error), Some(p.ci95), truth);
    }
    pub(super) fn flight(&mut self, name: &str, truth: &Truth) {
        let theta: Vec<f64> = truth.quaternion.iter().map(|q| off_vertical_rad(*q).to_degrees()).collect();
        let omega: Vec<f64> = truth.w_tunnel_body.iter().map(|w| w[1].hypot(w[2]).to_degrees()).collect();
        let flown_s = truth.t_s.last().copied().unwrap_or(0.0);
        let alpha = truth.alpha_t_rad.iter().copied().fold(0.0, f64::max).to_degrees();
        let all = [[flown_s, alpha].as_slice(), &mean_median_std(&theta), &mean_median_std(&omega)].concat();
        for (s, x) in FLIGHT.iter().zip(all) {
            self.number(&format!("flight.{name}.{s}"), x);
        }
    }
}

/// Angle between the body's x axis and the tunnel's X (thesis eq. 5.1), rad.
fn off_vertical_rad(quaternion: [f64; 4]) -> f64 {
    let r: Rotation<windfall_model::frames::Tunnel, windfall_model::frames::Body> = Rotation::from_quaternion(quaternion);
    r.matrix[(1, 0)].hypot(r.matrix[(2, 0)]).atan2(r.matrix[(0, 0)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_off_vertical_is_the_angle_of_the_pitch() {
        let half: f64 = 0.5 * 0.3;
        assert!((off_vertical_rad([half.cos(), 0.0, half.sin(), 0.0]) - 0.3).abs() < 1e-15);
    }

    /// What is written beside an estimate: its error is it less the truth.
    #[test]
    fn exact_cells_of_an_estimate() {
        let names = ["p.estimate", "p.error", "p.std_error", "p.low", "p.high", "p.covered"];
        let places: HashMap<String, usize> = names.iter().zip(0..).map(|(n, i)| ((*n).to_owned(), i)).collect();
        let mut cells = Cells { cells: vec![Cell::Number(None); 6], places: &places };
        cells.estimate("p", 5.5, Some(0.7), Some([4.0, 7.0]), 3.25);
        let numbers = [5.5, 2.25, 0.7, 4.0, 7.0].map(|x| Cell::Number(Some(x)));
        assert!(cells.cells[..5] == numbers && cells.cells[5] == Cell::Flag(Some(false)), "{:?}", cells.cells);
    }
}
