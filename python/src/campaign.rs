//! python: simulate, identify, re-simulate, close. In: scenarios, campaigns, arrays. Out: arrays and results.

use crate::errors::Error;
use crate::threads::on_threads;
use numpy::{IntoPyArray as _, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;
use windfall_model::{Data, Flight, Record, Run, Use};
use windfall_pid::output_error::Prior;
use windfall_pid::{Held, Identification, Method};
use windfall_scenarios::{
    FileKind, ScenarioFile, json_text, kind_of, read_bundled, read_campaign_with_warnings, read_scenario_file,
};
use windfall_sim::{End, Flown, Seed, Truth, fly};
use windfall_verify::close::Options;
use windfall_verify::{Identify, Tie, campaign_of};

fn is_bundled(word: &str) -> bool {
    !word.contains(['/', '\\', '.'])
}

fn scenario(word: &str) -> Result<ScenarioFile, Error> {
    Ok(if is_bundled(word) { read_bundled(word)? } else { read_scenario_file(&PathBuf::from(word))? })
}

fn fly_all(s: &ScenarioFile) -> Result<Vec<Flown>, Error> {
    let one = |(i, f): (usize, &Flight)| {
        let seed = Seed { campaign: s.scenario.seed, run: i as u64 };
        Ok(fly(&s.scenario.plant.for_run(i, &[]), f, seed)?)
    };
    s.scenario.flights.par_iter().enumerate().map(one).collect()
}

/// Flights of a scenario: for each its name, kind, use, record and truth (dictionaries of arrays) and how it ended.
#[pyfunction]
#[pyo3(signature = (word, seed=None, threads=0))]
pub(crate) fn simulate<'py>(py: Python<'py>, word: &str, seed: Option<u64>, threads: usize) -> PyResult<Bound<'py, PyList>> {
    let word = word.to_owned();
    let (file, flown) = on_threads(py, threads, move || {
        let mut file = scenario(&word)?;
        file.scenario.seed = seed.unwrap_or(file.scenario.seed);
        let flown = fly_all(&file)?;
        Ok((file, flown))
    })?;
    let all = PyList::empty(py);
    for (flight, flown) in file.scenario.flights.iter().zip(flown) {
        let d = PyDict::new(py);
        d.set_item("name", &flight.name)?;
        d.set_item("kind", &flight.kind)?;
        d.set_item("use", flight.used.name())?;
        let (end, end_t_s) = match flown.end {
            End::Completed => ("completed", flown.truth.t_s.last().copied().unwrap_or(0.0)),
            End::Wall { t_s } => ("wall", t_s),
            End::UpperNet { t_s } => ("upper net", t_s),
            End::LowerNet { t_s } => ("lower net", t_s),
        };
        d.set_item("end", end)?;
        d.set_item("end_t_s", end_t_s)?;
        d.set_item("record", record_columns(py, flown.record)?)?;
        d.set_item("truth", truth_columns(py, flown.truth)?)?;
        all.append(d)?;
    }
    Ok(all)
}

/// Hands a series over to NumPy without a copy.
fn give(d: &Bound<'_, PyDict>, name: &str, x: Vec<f64>) -> PyResult<()> {
    d.set_item(name, x.into_pyarray(d.py()))
}

fn degrees(mut x: Vec<f64>) -> Vec<f64> {
    x.iter_mut().for_each(|v| *v = v.to_degrees());
    x
}

/// A record in the columns of the run file.
fn record_columns(py: Python<'_>, r: Record) -> PyResult<Bound<'_, PyDict>> {
    let d = PyDict::new(py);
    let ([x, y, z], [rx, ry, rz]) = (r.position_m, r.attitude_rad);
    give(&d, "t_s", r.t_s)?;
    for (name, series) in [("X_m", x), ("Y_m", y), ("Z_m", z)] {
        give(&d, name, series)?;
    }
    for (name, series) in [("Rx_deg", rx), ("Ry_deg", ry), ("Rz_deg", rz)] {
        give(&d, name, degrees(series))?;
    }
    for (name, series) in [("ps_Pa", r.ps_pa), ("VW_m_s", r.vw_m_s), ("Ts_K", r.ts_k)] {
        give(&d, name, series)?;
    }
    r.qw_pa.map_or(Ok(()), |q| give(&d, "qW_Pa", q))?;
    Ok(d)
}

fn truth_columns(py: Python<'_>, t: Truth) -> PyResult<Bound<'_, PyDict>> {
    let d = PyDict::new(py);
    give(&d, "t_s", t.t_s)?;
    d.set_item("p_tunnel_cm_m", numpy::PyArray2::from_owned_array(py, matrix(t.p_tunnel_cm)))?;
    d.set_item("v_tunnel_cm_m_s", numpy::PyArray2::from_owned_array(py, matrix(t.v_tunnel_cm)))?;
    d.set_item("w_tunnel_body_rad_s", numpy::PyArray2::from_owned_array(py, matrix(t.w_tunnel_body)))?;
    d.set_item("attitude_rad", numpy::PyArray2::from_owned_array(py, matrix(t.attitude_rad)))?;
    d.set_item("quaternion", numpy::PyArray2::from_owned_array(py, matrix(t.quaternion)))?;
    give(&d, "vw_m_s", t.vw_m_s)?;
    give(&d, "alpha_t_rad", t.alpha_t_rad)?;
    give(&d, "airspeed_m_s", t.airspeed_m_s)?;
    give(&d, "tether_n", t.tether_n)?;
    Ok(d)
}

/// Rows of N numbers as a matrix over the same memory.
fn matrix<const N: usize>(rows: Vec<[f64; N]>) -> numpy::ndarray::Array2<f64> {
    numpy::ndarray::Array2::from(rows)
}

/// A campaign: declared model and runs.
#[pyclass(frozen, module = "windfall._windfall")]
pub(crate) struct Campaign {
    inner: Arc<windfall_model::Campaign>,
    #[pyo3(get)]
    warnings: Vec<String>,
}

#[pymethods]
impl Campaign {
    /// Reads a campaign file; or flies a scenario (file or bundled), whose effects its campaign does not declare.
    #[new]
    #[pyo3(signature = (word, seed=None))]
    fn new(py: Python<'_>, word: &str, seed: Option<u64>) -> PyResult<Self> {
        let word = word.to_owned();
        let (inner, warnings) = on_threads(py, 0, move || {
            let path = PathBuf::from(&word);
            if is_bundled(&word) || kind_of(&path)? == FileKind::Scenario {
                let mut file = scenario(&word)?;
                file.scenario.seed = seed.unwrap_or(file.scenario.seed);
                return Ok((flown_campaign(&file)?, Vec::new()));
            }
            if seed.is_some() {
                return Err(Error::Argument("seed is for scenarios; a campaign file has its runs".to_owned()));
            }
            Ok(read_campaign_with_warnings(&path)?)
        })?;
        Ok(Self { inner: Arc::new(inner), warnings })
    }
    /// The same declared model with these runs: (name, kind, use, columns of the run file).
    fn with_runs(&self, runs: Vec<(String, String, String, Bound<'_, PyDict>)>) -> PyResult<Self> {
        let mut inner = windfall_model::Campaign::clone(&self.inner);
        inner.runs = runs.into_iter().map(run_of).collect::<PyResult<_>>()?;
        Ok(Self { inner: Arc::new(inner), warnings: Vec::new() })
    }
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }
    #[getter]
    fn runs(&self) -> Vec<&str> {
        self.inner.runs.iter().map(|r| r.name.as_str()).collect()
    }
    fn __repr__(&self) -> String {
        format!("Campaign({:?}, runs={:?})", self.inner.name, self.runs())
    }
}

fn flown_campaign(file: &ScenarioFile) -> Result<windfall_model::Campaign, Error> {
    let flown = fly_all(file)?;
    let pairs: Vec<_> = file.scenario.flights.iter().zip(flown.into_iter().map(|f| f.record)).collect();
    let mut campaign = campaign_of(&file.declared_plant, &pairs);
    campaign.name.clone_from(&file.scenario.name);
    campaign.plant.clone_from(&file.declared_plant);
    campaign.declared.clone_from(&file.declared);
    campaign.knowledge.clone_from(&file.knowledge);
    Ok(campaign)
}

fn run_of((name, kind, used, columns): (String, String, String, Bound<'_, PyDict>)) -> PyResult<Run> {
    let wrong = |what: String| PyErr::from(Error::Argument(format!("run {name}: {what}")));
    let used = Use::of_name(&used)
        .ok_or_else(|| wrong(format!("use {used:?} must be one of {}", Use::ALL.map(Use::name).join(", "))))?;
    let series = |key: &str| -> PyResult<Option<Vec<f64>>> {
        let Some(at) = columns.get_item(key)? else { return Ok(None) };
        let array: PyReadonlyArray1<'_, f64> =
            at.extract().map_err(|_| wrong(format!("column {key} must be a one-dimensional array of float64")))?;
        Ok(Some(array.as_array().to_vec()))
    };
    let needed = |key: &str| series(key)?.ok_or_else(|| wrong(format!("column {key} is missing")));
    let radians = |key: &str| Ok::<_, PyErr>(needed(key)?.into_iter().map(f64::to_radians).collect::<Vec<f64>>());
    let record = Record {
        t_s: needed("t_s")?,
        position_m: [needed("X_m")?, needed("Y_m")?, needed("Z_m")?],
        attitude_rad: [radians("Rx_deg")?, radians("Ry_deg")?, radians("Rz_deg")?],
        vw_m_s: needed("VW_m_s")?,
        ps_pa: needed("ps_Pa")?,
        ts_k: needed("Ts_K")?,
        qw_pa: series("qW_Pa")?,
        bridged: Vec::new(),
    };
    let n = record.t_s.len();
    let others = [&record.ps_pa, &record.ts_k].map(Vec::as_slice);
    let all = || record.channels().into_iter().chain(others).chain(record.qw_pa.as_deref()).chain([record.t_s.as_slice()]);
    if all().any(|c| c.len() != n) {
        return Err(wrong("columns differ in length".to_owned()));
    }
    if all().any(|c| c.iter().any(|x| !x.is_finite())) {
        return Err(wrong("holds NaN or infinity; write it as a run file and read that, which bridges dropouts".to_owned()));
    }
    let step = record.interval_s();
    if record.t_s.windows(2).any(|w| ((w[1] - w[0]) / step - 1.0).abs() > 0.01) || n < 30 {
        return Err(wrong("needs 30 samples or more, uniform in time to 1 %".to_owned()));
    }
    Ok(Run { name, kind, used, inputs: Vec::new(), data: Data::Tunnel(record), notes: Vec::new() })
}

fn json(value: &impl serde::Serialize) -> Result<String, Error> {
    Ok(serde_json::to_string(value)?)
}

/// `identification.json` of a campaign, to the byte: `hold` has names and values, `tie` two names, `prior` name, mean and deviation.
#[pyfunction]
#[pyo3(signature = (campaign, method_name=None, combined=false, hold=Vec::new(), tie=Vec::new(), prior=Vec::new(), bootstrap=None, threads=0))]
#[expect(clippy::too_many_arguments, reason = "named in Python")]
pub(crate) fn identify(
    py: Python<'_>,
    campaign: &Campaign,
    method_name: Option<String>,
    combined: bool,
    hold: Vec<(String, f64)>,
    tie: Vec<(String, String)>,
    prior: Vec<(String, f64, f64)>,
    bootstrap: Option<usize>,
    threads: usize,
) -> PyResult<String> {
    let names = || Method::ALL.map(Method::name).join(", ");
    let named =
        |name: String| Method::of_name(&name).ok_or_else(|| Error::Argument(format!("no method {name:?}; methods: {}", names())));
    let wrong = |what: String| PyErr::from(Error::Argument(what));
    if let Some((name, _)) = hold.iter().find(|(_, value)| !value.is_finite()) {
        return Err(wrong(format!("hold {name}: needs a finite number")));
    }
    if let Some((name, ..)) = prior.iter().find(|(_, mean, std)| !(mean.is_finite() && std.is_finite() && *std > 0.0)) {
        return Err(wrong(format!("prior {name}: needs a finite mean and a standard deviation above 0")));
    }
    if bootstrap.is_some_and(|n| n < 2) {
        return Err(wrong("bootstrap: needs two copies or more".to_owned()));
    }
    let request = Identify {
        method: method_name.map(named).transpose()?,
        combined_only: combined,
        hold: hold.into_iter().map(|(name, value)| Held { name, value }).collect(),
        tie: tie.into_iter().map(|(name, to)| Tie { name, to }).collect(),
        prior: prior.into_iter().map(|(name, mean, std)| Prior { name, mean, std }).collect(),
        bootstrap,
    };
    let (campaign, notes) = (Arc::clone(&campaign.inner), campaign.warnings.clone());
    on_threads(py, threads, move || Ok(json_text(&windfall_verify::identify(&campaign, &notes, &request)?)?))
}

/// `resimulation.json` of an identification against a campaign.
#[pyfunction]
#[pyo3(signature = (campaign, identification, seeds=1, threads=0))]
pub(crate) fn resimulate(
    py: Python<'_>,
    campaign: &Campaign,
    identification: &str,
    seeds: usize,
    threads: usize,
) -> PyResult<String> {
    let (campaign, identification) = (Arc::clone(&campaign.inner), identification.to_owned());
    on_threads(py, threads, move || {
        let found: Identification = serde_json::from_str(&identification)?;
        json(&windfall_verify::resimulate(&campaign, &found, seeds)?)
    })
}

/// `close.json` of a campaign.
#[pyfunction]
#[pyo3(signature = (campaign, threads=0))]
pub(crate) fn close(py: Python<'_>, campaign: &Campaign, threads: usize) -> PyResult<String> {
    let campaign = Arc::clone(&campaign.inner);
    on_threads(py, threads, move || json(&windfall_verify::close::close(&campaign, &Options::default())?))
}
