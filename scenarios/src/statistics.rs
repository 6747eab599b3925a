//! scenarios: published statistics of a run. In: a TOML file. Out: the figures, the plant and the flight that they are held against.

use crate::error::ReadError;
use crate::keys::{self, Key, Kind, TableSpec};
use crate::open::text_of;
use crate::plant::read_declared;
use crate::table::{Source, Table};
use std::path::Path;
use windfall_model::{Flight, Numerics, Operator, Plant, Release, TestSection, TunnelSpeed};

/// One published figure.
#[derive(Clone, Debug, PartialEq)]
pub struct PublishedFigure {
    /// `theta_deg`, `omega_qr_deg_s`, `q_deg_s` or `r_deg_s`.
    pub quantity: String,
    /// `mean`, `median`, `std` or `max` (largest size).
    pub statistic: String,
    /// The test's value, deg or deg/s.
    pub test: f64,
    /// The value that the source's own simulation gave, when printed.
    pub simulation: Option<f64>,
    /// Fitted; otherwise only held against the result.
    pub fitted: bool,
}

/// A file of published statistics.
#[derive(Clone, Debug, PartialEq)]
pub struct StatisticsFile {
    /// Name.
    pub name: String,
    /// Where the figures are printed.
    pub source: String,
    /// Seed of all chance.
    pub seed: u64,
    /// The declared plant.
    pub plant: Plant,
    /// The run that the figures were taken from.
    pub flight: Flight,
    /// The figures.
    pub figures: Vec<PublishedFigure>,
}

const fn key(name: &'static str, kind: Kind, meaning: &'static str) -> Key {
    Key { name, kind, unit: "-", range: [f64::NEG_INFINITY, f64::INFINITY], needed: true, meaning }
}
const fn figure(name: &'static str, needed: bool, meaning: &'static str) -> Key {
    Key { name, kind: Kind::Number, unit: "deg or deg/s", range: [1e-9, 1e6], needed, meaning }
}
const fn length(name: &'static str, unit: &'static str, low: f64, high: f64, meaning: &'static str) -> Key {
    Key { name, kind: Kind::Number, unit, range: [low, high], needed: true, meaning }
}

static FILE: TableSpec = TableSpec {
    path: "",
    meaning: "Published statistics of a run, with the model and the run that they are held against.",
    keys: &[
        key("statistics", Kind::Table, "name and source"),
        key("figure", Kind::Tables, "published figures, [[figure]]"),
        key("vehicle", Kind::Table, "mass side"),
        Key { needed: false, ..key("tether", Kind::Table, "safety tether; absent: free flight") },
        key("environment", Kind::Table, "gravity and gas"),
        key("sensors", Kind::Table, "noise of the instruments"),
        key("aero", Kind::Table, "the declared aerodynamics, [aero.<name>]"),
        Key { needed: false, ..key("section", Kind::Table, "walls and nets; runs that leave are counted") },
        key("run", Kind::Table, "the run"),
    ],
};
static STATISTICS: TableSpec = TableSpec {
    path: "statistics",
    meaning: "What is published where.",
    keys: &[
        key("name", Kind::Text, "name"),
        key("source", Kind::Text, "author, year, table"),
        Key { kind: Kind::Integer, range: [0.0, 9_007_199_254_740_992.0], ..key("seed", Kind::Integer, "seed of all chance") },
    ],
};
static FIGURE: TableSpec = TableSpec {
    path: "figure",
    meaning: "One published figure.",
    keys: &[
        key("quantity", Kind::Choice(&QUANTITIES), "what it is a statistic of"),
        key("statistic", Kind::Choice(&STATISTIC), "which statistic; max is the largest size"),
        key("use", Kind::Choice(&["fit", "check"]), "fitted, or only held against the result"),
        figure("test", true, "value in the test"),
        figure("simulation", false, "value in the source's own simulation"),
    ],
};
const QUANTITIES: [&str; 4] = ["theta_deg", "omega_qr_deg_s", "q_deg_s", "r_deg_s"];
const STATISTIC: [&str; 4] = ["mean", "median", "std", "max"];
static RUN: TableSpec = TableSpec {
    path: "run",
    meaning: "The run: release, and an operator's hand on the tunnel speed.",
    keys: &[
        length("duration_s", "s", 1.0, 1e4, "duration"),
        length("rate_hz", "Hz", 1.0, 1e4, "sample rate"),
        key("release", Kind::Table, "state at the first sample"),
        key("operator", Kind::Table, "a hand that throttles to hold the model's height"),
    ],
};

/// Reads a file of published statistics.
///
/// # Errors
/// [`ReadError`] with every fault of the file.
pub fn read_statistics(path: &Path) -> Result<StatisticsFile, ReadError> {
    parse(path, &text_of(path)?)
}

/// Text of the bundled file: thesis Table 5.6.
pub const TABLE_5_6: &str = include_str!("../sage/table-5.6.toml");

/// The bundled file of thesis Table 5.6.
///
/// ```
/// let file = windfall_scenarios::bundled_statistics().expect("the bundled file is valid");
/// assert_eq!(file.figures.iter().filter(|f| f.fitted).count(), 6);
/// ```
///
/// # Errors
/// None: the file is part of the program and tested.
pub fn bundled_statistics() -> Result<StatisticsFile, ReadError> {
    parse(Path::new("table-5.6.toml (bundled)"), TABLE_5_6)
}

fn parse(path: &Path, text: &str) -> Result<StatisticsFile, ReadError> {
    let source = Source::new(path, text);
    let root = source.parse()?;
    let file = Table::new(&source, "", &root, 0..0, &FILE);
    let head = file.table(&STATISTICS).map(|t| (t.text("name"), t.text("source"), t.integer_if("seed").unwrap_or(1)));
    let declared = read_declared(&file, true);
    let section = section(&file);
    let air = declared.as_ref().map_or([f64::NAN; 2], |d| d.air);
    let flight = file.table(&RUN).and_then(|t| flight(&t, section, air));
    let figures: Vec<PublishedFigure> = file.tables(&FIGURE).iter().filter_map(published).collect();
    if !figures.iter().any(|f| f.fitted) {
        source.fault(None, "[[figure]] use", "", "no figure is fitted", "use = \"fit\" for at least one");
    }
    for (i, f) in figures.iter().enumerate() {
        if figures[..i].iter().any(|o| o.quantity == f.quantity && o.statistic == f.statistic) {
            let what = "the same statistic of the same quantity appears twice";
            source.fault(None, "[[figure]]", format!("{} {}", f.statistic, f.quantity), what, "remove one");
        }
    }
    let built = declared.zip(head).zip(flight).map(|((declared, (name, from, seed)), flight)| StatisticsFile {
        flight: Flight { name: name.clone(), ..flight },
        name,
        source: from,
        seed,
        plant: declared.plant,
        figures,
    });
    source.finish(built)
}

fn published(t: &Table<'_>) -> Option<PublishedFigure> {
    let (test, simulation) = (t.number("test"), t.number_if("simulation"));
    let (quantity, statistic, used) = (t.choice("quantity"), t.choice("statistic"), t.choice("use"));
    Some(PublishedFigure {
        quantity: QUANTITIES[quantity?].to_owned(),
        statistic: STATISTIC[statistic?].to_owned(),
        test,
        simulation,
        fitted: used? == 0,
    })
}

fn section(file: &Table<'_>) -> Option<TestSection> {
    let t = file.table_if(&keys::SECTION)?;
    Some(TestSection { radius_m: t.number("radius_m"), top_x_m: t.number("top_x_m"), bottom_x_m: t.number("bottom_x_m") })
}

fn flight(t: &Table<'_>, section: Option<TestSection>, [ps_pa, ts_k]: [f64; 2]) -> Option<Flight> {
    let release = t.table(&keys::RELEASE).map(|r| Release {
        position_m: r.numbers("position_m"),
        velocity_m_s: r.numbers("velocity_m_s"),
        attitude_rad: r.numbers::<3>("attitude_deg").map(f64::to_radians),
        rates_rad_s: r.numbers::<3>("rates_deg_s").map(f64::to_radians),
    });
    let operator = t.table(&keys::OPERATOR).map(|o| Operator {
        trim_m_s: o.number_if("trim_m_s"),
        height_gain_per_s: o.number("height_gain_per_s"),
        rate_gain: o.number("rate_gain"),
        integral_gain_per_s2: o.number("integral_gain_per_s2"),
        lag_s: o.number("lag_s"),
        unsteady_rms_m_s: o.number("unsteady_rms_m_s"),
        unsteady_time_s: o.number("unsteady_time_s"),
        hold_x_m: o.number("hold_x_m"),
    });
    let (duration_s, rate_hz) = (t.number("duration_s"), t.number("rate_hz"));
    Some(Flight {
        name: String::new(),
        kind: "unperturbed".to_owned(),
        used: windfall_model::Use::Identify,
        duration_s,
        rate_hz,
        sensor_noise: true,
        pushes: Vec::new(),
        window_s: None,
        release: release?,
        speed: TunnelSpeed::Operator(operator?),
        ps_pa,
        ts_k,
        section,
        numerics: Numerics::default(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thesis Table 5.6 (test and simulation) and Table 5.1 (largest rates of the same run), digit by digit.
    #[test]
    fn pub_table_5_6_as_printed() {
        let file = bundled_statistics().expect("valid");
        let fitted: Vec<[f64; 2]> =
            file.figures.iter().filter(|f| f.fitted).map(|f| [f.test, f.simulation.unwrap_or(f64::NAN)]).collect();
        let printed =
            [[2.5653, 1.3257], [2.3575, 1.2761], [1.4957, 0.2028], [14.8574, 1.3210], [12.3386, 0.2489], [9.8990, 2.3376]];
        assert_eq!(fitted, printed);
        let held: Vec<f64> = file.figures.iter().filter(|f| !f.fitted).map(|f| f.test).collect();
        assert_eq!(held, [26.8, 54.4]);
        assert!((file.plant.aero.values[0] - 6.6620).abs() < 1e-12);
    }

    #[test]
    fn law_every_fault_is_named() {
        let bad = TABLE_5_6
            .replacen("statistic = \"median\"", "statistic = \"mean\"", 1)
            .replacen("test = 1.4957", "test = nan", 1)
            .replacen("duration_s = 55.0", "duration = 55.0", 1);
        let Err(e) = parse(Path::new("bad.toml"), &bad) else { panic!("faults are found") };
        let text = e.to_string();
        for part in ["appears twice", "nan", "unknown key", "duration_s"] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }
}
