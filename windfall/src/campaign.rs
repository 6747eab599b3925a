//! windfall: a campaign and what can be asked of it. In: files or flights, and requests. Out: results.

use crate::scenario::is_bundled;
use crate::{Close, Error, Fly, Identify, Plan, Resimulate, Result, Scenario, Structure};
use serde::Serialize;
use std::path::Path;
use windfall_discover::close::{
    Closing, Figure, Options, SignalTracks, SmoothingTracks, as_closed, close, coefficient_tracks, figures, flight_tracks,
    smoothing, tracks,
};
use windfall_discover::separate::{Separation, separate};
use windfall_discover::{Identified, identify};
use windfall_model::Plant;
use windfall_pid::bandwidth::thin;
use windfall_pid::compatibility::{Pressure, pressure};
use windfall_pid::plan::{TestPlan as Targets, plan};
use windfall_pid::plausible::looked;
use windfall_pid::smooth::Smoother;
use windfall_pid::structure::{Choice, choose};
use windfall_pid::{Identification, Method};
use windfall_replay::{ReplayError, Resimulation, drawn, resimulate_with_draws};
use windfall_scenarios::{
    BUNDLED, BUNDLED_FREE, FileKind, RunColumns, kind_of, must_be, read_campaign_with_warnings, runs_of_columns,
};

/// One vehicle, its declared model, its runs.
///
/// ```
/// use windfall::prelude::*;
/// let campaign = Campaign::find("appendix-c".as_ref(), &Fly::default())?;
/// let request = Identify { method: Some(Method::EquationError), combined: true, ..Identify::default() };
/// let found = campaign.identify(&request)?.found;
/// let drag = found.combined().and_then(|set| set.parameters.iter().find(|p| p.name == "CA_T0")).expect("declared");
/// assert!((drag.estimate - 6.662).abs() < 1e-4);
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Campaign {
    /// Declared model and runs.
    pub data: windfall_model::Campaign,
    /// What reading its files had to say; they lead the warnings of [`Campaign::identify`].
    pub warnings: Vec<String>,
}

/// What a path or name stands for where a campaign is asked for.
///
/// ```
/// use windfall::CampaignSource;
/// assert!(matches!(CampaignSource::find("sage-perturbed".as_ref())?, CampaignSource::Scenario(_)));
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug)]
pub enum CampaignSource {
    /// A campaign file.
    Campaign(Box<Campaign>),
    /// A scenario, which has to be flown first.
    Scenario(Box<Scenario>),
}

impl CampaignSource {
    /// Reads a campaign file, a scenario file or a bundled scenario.
    ///
    /// # Errors
    /// Every fault of the file.
    pub fn find(word: &Path) -> Result<Self> {
        if is_bundled(word) || (word.is_file() && kind_of(word)? == FileKind::Scenario) {
            return Ok(Self::Scenario(Box::new(Scenario::find(word)?)));
        }
        Ok(Self::Campaign(Box::new(Campaign::read(word)?)))
    }
}

impl Campaign {
    /// Reads a campaign file and its runs.
    ///
    /// # Errors
    /// Every fault of the files.
    pub fn read(path: &Path) -> Result<Self> {
        if let Some(name) = path.to_str().filter(|w| is_bundled(path) && BUNDLED.iter().chain(&BUNDLED_FREE).any(|b| b == w)) {
            let what = "is a bundled scenario; needed here: a campaign file (.toml), which declares a vehicle and names its runs";
            let way = format!("windfall simulate {name} --out DIR writes its runs and a campaign file, DIR/campaign.toml");
            return Err(Error::Request(format!("{name}: {what}; try: {way}")));
        }
        must_be(path, FileKind::Campaign)?;
        let (data, warnings) = read_campaign_with_warnings(path)?;
        Ok(Self { data, warnings }.thinned())
    }
    /// Reads a campaign file; or flies a scenario, by file or bundled name, whose effects its campaign does not declare.
    ///
    /// # Errors
    /// Every fault of the file, a flight that failed, a seed for runs that were measured.
    pub fn find(word: &Path, request: &Fly) -> Result<Self> {
        // Every field is named, so that a new one is asked for here.
        let Fly { seed } = request;
        match CampaignSource::find(word)? {
            CampaignSource::Scenario(scenario) => Ok(scenario.fly(request)?.campaign()),
            CampaignSource::Campaign(_) if seed.is_some() => {
                Err(Error::Request("seed is for scenarios; a campaign file has its runs".to_owned()))
            }
            CampaignSource::Campaign(campaign) => Ok(*campaign),
        }
    }
    /// The same declared model with these tunnel runs, which are held against all that run files are held against.
    ///
    /// # Errors
    /// A campaign of another kind of body; every fault of the runs: columns that are missing, units that cannot be, time that does not
    /// increase, gaps, too few samples.
    pub fn with_runs(&self, runs: Vec<RunColumns>) -> Result<Self> {
        if !self.data.inputs.is_empty() || self.data.runs.iter().any(|r| matches!(r.data, windfall_model::Data::Point(_))) {
            let what = "other runs are for tunnel campaigns without inputs; name these in a campaign of their own";
            return Err(Error::Request(what.to_owned()));
        }
        for run in &runs {
            let rows = run.columns.first().map_or(0, |(_, c)| c.len());
            if let Some((name, c)) = run.columns.iter().find(|(_, c)| c.len() != rows) {
                let what = format!("run {}: columns differ in length: {name} has {} rows, the first {rows}", run.name, c.len());
                return Err(Error::Request(what));
            }
            if runs.iter().filter(|r| r.name == run.name).count() > 1 {
                return Err(Error::Request(format!("run {}: appears twice; give each run a name of its own", run.name)));
            }
        }
        let (runs, warnings) = runs_of_columns(runs, &self.data.plant)?;
        Ok(Self { data: windfall_model::Campaign { runs, ..self.data.clone() }, warnings }.thinned())
    }
    /// The same on the rows that carry what the instruments saw; the warnings say which runs were smoothed or resampled before their export.
    fn thinned(mut self) -> Self {
        self.warnings.extend(thin(&mut self.data));
        self
    }
    /// Runs whose recorders share one clock, as they are identified on.
    fn on_one_clock(&self) -> Result<windfall_model::Campaign> {
        Ok(looked(&self.data, true)?.campaign)
    }
    /// Parameters with intervals: the content of `identification.json`.
    ///
    /// # Errors
    /// A record that is not what its campaign says it is, knowledge of parameters that do not exist, and what the method refuses.
    pub fn identify(&self, request: &Identify) -> Result<Identified> {
        Ok(identify(&self.data, &self.warnings, &request.order()?)?)
    }
    /// Flies an identified model against every run: the content of `resimulation.json`.
    ///
    /// # Errors
    /// A point-mass campaign, no run, an identification of another structure or, for draws, without covariance.
    pub fn resimulate(&self, found: &impl AsRef<Identification>, request: &Resimulate) -> Result<Resimulation> {
        let (seeds, draws) = request.order()?;
        Ok(resimulate_with_draws(&self.on_one_clock()?, found.as_ref(), seeds, draws)?)
    }
    /// `n` models drawn as the runs leave them: the estimates of all runs with their joint errors, gusts and held parameters as they
    /// are. Draw i is a function of the seed and i alone. What a question of one's own is to be asked of, when its answer shall carry
    /// the identification's uncertainty.
    ///
    /// ```
    /// use windfall::prelude::*;
    /// let campaign = Scenario::bundled("sage-perturbed")?.fly(&Fly::default())?.campaign();
    /// let found = campaign.identify(&Identify { method: Some(Method::OutputError), combined: true, ..Identify::default() })?;
    /// let models = campaign.draw(&found, 100, 1)?;
    /// let drag = models.iter().map(|m| m.aero.values[0]).sum::<f64>() / 100.0;
    /// let estimate = found.as_ref().combined().expect("all runs").parameters[0].clone();
    /// assert!((drag - estimate.estimate).abs() < 0.5 * estimate.std_error);
    /// # Ok::<(), windfall::Error>(())
    /// ```
    ///
    /// # Errors
    /// An identification of another structure, or without covariance.
    pub fn draw(&self, found: &impl AsRef<Identification>, n: usize, seed: u64) -> Result<Vec<Plant>> {
        let set = found.as_ref().combined().ok_or(ReplayError::NoDataSet)?;
        Ok(drawn(&self.data, set, n, seed)?)
    }
    /// What the declared model lacks, and the errors before and after: the content of `close.json`.
    ///
    /// # Errors
    /// A record that is not what its campaign says it is, no run to identify on, runs too short, a declared model that cannot be fitted.
    pub fn close(&self, request: &Close) -> Result<Closing> {
        Ok(close(&self.data, &Options { accept_record: request.accept_record, ..Options::default() })?)
    }
    /// Series of a closing's figures: the content of `figures.json`.
    ///
    /// # Errors
    /// As [`Campaign::close`].
    pub fn figures(&self, closing: &Closing) -> Result<Vec<Figure>> {
        Ok(figures(&as_closed(&self.data)?, closing, &Options::default())?)
    }
    /// Measured signals of every run beside flights with the declared model and with the effects added: the content of `tracks.json`.
    ///
    /// # Errors
    /// As [`Campaign::close`].
    pub fn tracks(&self, closing: &Closing) -> Result<SignalTracks> {
        Ok(tracks(&as_closed(&self.data)?, closing)?)
    }
    /// Coefficients of every run beside those of an identified model: the content of `coefficients.json`; without runs for point bodies.
    ///
    /// # Errors
    /// No data set, or an identification of another structure.
    pub fn coefficient_tracks(&self, found: &impl AsRef<Identification>) -> Result<SignalTracks> {
        Ok(coefficient_tracks(&self.on_one_clock()?, found.as_ref())?)
    }
    /// Measured signals of every run beside flights with an identified model: the content of `flights.json`.
    ///
    /// # Errors
    /// As [`Campaign::coefficient_tracks`].
    pub fn flight_tracks(&self, found: &impl AsRef<Identification>) -> Result<SignalTracks> {
        Ok(flight_tracks(&self.on_one_clock()?, found.as_ref())?)
    }
    /// Raw and smoothed records with their spectra, as a method smooths them, or as closing does: the content of `smoothing.json`; without
    /// runs for bodies that are no tunnel models.
    ///
    /// # Errors
    /// A record that cannot be smoothed.
    pub fn smoothing(&self, method: Option<Method>) -> Result<SmoothingTracks> {
        Ok(smoothing(&self.data, &method.map_or(Smoother::Auto, Method::smoother))?)
    }
    /// The same as an identification smoothed them that was asked for and found so.
    ///
    /// # Errors
    /// As [`Campaign::smoothing`].
    pub fn smoothing_of(&self, found: &Identified, request: &Identify) -> Result<SmoothingTracks> {
        match request.smoother()? {
            Some(smoother) => Ok(smoothing(&self.data, &smoother)?),
            None => self.smoothing(Method::of_name(&found.found.method)),
        }
    }
    /// Which aerodynamic terms the runs carry, whatever is declared: the content of `structure.json`.
    ///
    /// # Errors
    /// Runs that cannot be processed.
    pub fn structure(&self, request: &Structure) -> Result<Choice> {
        Ok(choose(&self.on_one_clock()?, request.criterion)?)
    }
    /// Tunnel time that brings wanted errors, or runs that part rivals: the content of `plan.json`.
    ///
    /// # Errors
    /// As [`Campaign::identify`] or, to part rivals, as [`Campaign::close`]; a target that is no estimated parameter or no positive error.
    pub fn plan(&self, request: &Plan) -> Result<Planned> {
        Ok(if request.separate {
            Planned::Rivals(separate(&self.data, request.between, request.accept_record)?)
        } else {
            Planned::Targets(plan(&self.data, &request.target, request.between)?)
        })
    }
    /// Tunnel speed against dynamic pressure; none where no run has q_W.
    #[must_use]
    pub fn pressure(&self) -> Option<Pressure> {
        pressure(&self.data)
    }
}

/// What to fly next.
///
/// ```no_run
/// use windfall::prelude::*;
/// let campaign = Campaign::read("flights/campaign.toml".as_ref())?;
/// let plan = campaign.plan(&Plan { target: vec![windfall::target("Cm_2=5%")?], ..Plan::default() })?;
/// println!("within reach: {}", plan.is_within_reach());
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Planned {
    /// For wanted standard errors.
    Targets(Targets),
    /// For effects that cannot be told apart, and wide bounds.
    Rivals(Separation),
}

impl Planned {
    /// Whether what is wanted can be reached.
    #[must_use]
    pub fn is_within_reach(&self) -> bool {
        match self {
            Self::Targets(t) => t.is_within_reach(),
            Self::Rivals(r) => r.is_within_reach(),
        }
    }
}
