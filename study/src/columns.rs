//! study: names of a study's results. In: the order. Out: columns, before any draw is made.

use super::recovery::CLOSING_COLUMNS;
use windfall_model::study::{CellKind, Column, StudyOrder};
use windfall_pid::{Method, estimated};

/// Statistics of each flight's truth, in the order of [`super::draw`].
pub(super) const FLIGHT: [&str; 8] = [
    "flown_s",
    "alpha_t_max_deg",
    "theta_mean_deg",
    "theta_median_deg",
    "theta_std_deg",
    "omega_qr_mean_deg_s",
    "omega_qr_median_deg_s",
    "omega_qr_std_deg_s",
];
/// Errors of a re-simulation.
pub(super) const TRAJECTORY: [&str; 3] = ["attitude_rms_deg", "position_rms_m", "rate_rms_deg_s"];
/// Verdict flags of a closing.
pub(super) const VERDICTS: [&str; 3] = ["consistent", "effect", "unexplained"];

/// All columns of a study, in order; the draw's number comes before them.
pub(super) fn columns(study: &StudyOrder, methods: &[Method]) -> Vec<Column> {
    let mut all = List(vec![Column { name: "failure".to_owned(), kind: CellKind::Word }]);
    for v in &study.vary {
        all.number(format!("vary.{}", v.name));
    }
    if study.histories.is_some() {
        all.number("vary.history".to_owned());
    }
    if study.keep.flights {
        for f in &study.flights {
            FLIGHT.iter().for_each(|s| all.number(format!("flight.{}.{s}", f.name)));
        }
    }
    for m in methods {
        for (coefficient, name) in estimated(&study.declared_plant, &study.declared) {
            all.estimate(&format!("{}.{coefficient}.{name}", m.name()), study);
        }
        if study.steps.resimulate && study.keep.resimulation {
            TRAJECTORY.iter().for_each(|t| all.number(format!("{}.resimulate.{t}", m.name())));
        }
    }
    if study.steps.close && study.keep.closing {
        all.closing(study);
    }
    all.0
}

struct List(Vec<Column>);

impl List {
    fn add(&mut self, name: String, kind: CellKind) {
        self.0.push(Column { name, kind });
    }
    fn number(&mut self, name: String) {
        self.add(name, CellKind::Number);
    }
    /// Columns of one estimate.
    fn estimate(&mut self, stem: &str, study: &StudyOrder) {
        if study.keep.estimates {
            ["estimate", "error", "std_error"].iter().for_each(|s| self.number(format!("{stem}.{s}")));
            self.add(format!("{stem}.covered"), CellKind::Flag);
        }
        if study.keep.intervals {
            ["low", "high"].iter().for_each(|s| self.number(format!("{stem}.{s}")));
        }
    }
    fn closing(&mut self, study: &StudyOrder) {
        for name in ["close.verdict", "close.families", "close.rivals"] {
            self.add(name.to_owned(), CellKind::Word);
        }
        CLOSING_COLUMNS.iter().for_each(|(name, kind)| self.add((*name).to_owned(), *kind));
        for name in VERDICTS.iter().chain(&["right", "right_or_rival"]) {
            self.add(format!("close.{name}"), CellKind::Flag);
        }
        for e in &study.effects {
            for p in (e.effect.parameters)(&[]) {
                let stem = format!("close.{}.{}", e.effect.family, p.name);
                self.estimate(&stem, study);
                self.number(format!("{stem}.upper95"));
                self.add(format!("{stem}.bounded"), CellKind::Flag);
            }
        }
    }
}
