//! windfall: scenarios, flown. In: a scenario by file or name. Out: records, truths, the campaign they make, files.

use crate::{Campaign, Error, Fly, Result};
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;
use windfall_model::effects::{self, Acts};
use windfall_model::{CATALOGUE, Flight, Run};
use windfall_scenarios::{
    EffectValues, FileKind, FileSet, RunLine, ScenarioFile, must_be, read_bundled, read_scenario_file, write_campaign_toml,
    write_columns_csv, write_record_csv, write_resolved_scenario,
};
use windfall_sim::{End, Flown, Seed, Truth, fly};

/// Names of the campaign's file and of the resolved scenario's.
const CAMPAIGN: &str = "campaign.toml";
const RESOLVED: &str = "scenario.toml";

/// True for a word that is no file and looks like none: then it is a bundled scenario's name, right or wrong.
pub(crate) fn is_bundled(word: &Path) -> bool {
    !word.is_file() && word.to_str().is_some_and(|w| !w.contains(['/', '\\', '.']))
}

/// A true plant, what a campaign declares of it, and flights.
///
/// ```
/// use windfall::prelude::*;
/// let scenario = Scenario::bundled("sage-perturbed")?.with_effect("center-of-mass", &[("z_m", 0.002)])?;
/// assert_eq!(scenario.file.scenario.effects, ["center-of-mass"]);
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// All that was read; what is changed here is flown so.
    pub file: ScenarioFile,
}

impl Scenario {
    /// The bundled scenario of that name, see [`crate::files::BUNDLED`].
    ///
    /// # Errors
    /// A name that is none; the message lists all.
    pub fn bundled(name: &str) -> Result<Self> {
        Ok(Self { file: read_bundled(name)? })
    }
    /// Reads a scenario file.
    ///
    /// # Errors
    /// Every fault of the file.
    pub fn read(path: &Path) -> Result<Self> {
        must_be(path, FileKind::Scenario)?;
        Ok(Self { file: read_scenario_file(path)? })
    }
    /// A scenario by path, or by bundled name where the word looks like no path.
    ///
    /// # Errors
    /// As [`Scenario::bundled`] and [`Scenario::read`].
    pub fn find(word: &Path) -> Result<Self> {
        match word.to_str().filter(|_| is_bundled(word)) {
            Some(name) => Self::bundled(name),
            None => Self::read(word),
        }
    }
    /// Puts an effect of the catalogue into what is flown, not into what is declared. Parameters that are not given keep their null
    /// value; units are the catalogue's.
    ///
    /// # Errors
    /// A family or parameter that does not exist, a value outside its range.
    pub fn with_effect(mut self, family: &str, given: &[(&str, f64)]) -> Result<Self> {
        let wrong = |what: String| Error::Request(format!("effect {family}: {what}"));
        let effect = effects::find(family, Acts::Lander).ok_or_else(|| {
            let known: Vec<&str> = CATALOGUE.iter().filter(|e| e.acts.on(Acts::Lander)).map(|e| e.family).collect();
            wrong(format!("is not in the catalogue; families: {}", known.join(", ")))
        })?;
        let parameters = (effect.parameters)(&[]);
        let mut values: Vec<(String, f64)> = parameters.iter().map(|p| (p.name.clone(), p.left_out())).collect();
        for (name, value) in given {
            let i = values.iter().position(|(n, _)| n == name).ok_or_else(|| {
                let known: Vec<&str> = parameters.iter().map(|p| p.name.as_str()).collect();
                wrong(format!("has no parameter {name}; parameters: {}", known.join(", ")))
            })?;
            let (p, value) = (&parameters[i], *value);
            if !(p.lowest()..=p.high).contains(&value) {
                return Err(wrong(format!("{name} = {value} {}: allowed: {} to {}", p.unit, p.lowest(), p.high)));
            }
            values[i].1 = value;
        }
        let scenario = &mut self.file.scenario;
        let mut given: Vec<f64> = values.iter().map(|v| v.1).collect();
        effects::act_in_flights(&mut scenario.plant, std::iter::once((effect, given.as_mut_slice())), &scenario.flights);
        self.file.scenario.effects.push(family.to_owned());
        self.file.effects.push(EffectValues { family: family.to_owned(), values });
        Ok(self)
    }
    /// Names of the files that [`Flights::write`] makes.
    #[must_use]
    pub fn files(&self) -> Vec<String> {
        let flights = &self.file.scenario.flights;
        let names = flights.iter().flat_map(|f| <[String; 2]>::from(names(f, flights.len())));
        names.chain([CAMPAIGN.to_owned(), RESOLVED.to_owned()]).collect()
    }
    /// Flies every flight, effects included.
    ///
    /// # Errors
    /// [`Error::Flight`]: a plant that cannot be flown, or a flight that failed.
    pub fn fly(&self, request: &Fly) -> Result<Flights> {
        self.fly_seen(request, || {})
    }
    /// The same; `seen` is called after each flight.
    ///
    /// # Errors
    /// As [`Scenario::fly`].
    pub fn fly_seen(&self, request: &Fly, seen: impl Fn() + Sync) -> Result<Flights> {
        let mut scenario = self.clone();
        let s = &mut scenario.file.scenario;
        // Every field is named, so that a new one is asked for here.
        let Fly { seed } = request;
        s.seed = seed.unwrap_or(s.seed);
        let one = |(i, flight): (usize, &Flight)| {
            let flown = fly(&s.plant.for_run(i, &[]), flight, Seed { campaign: s.seed, run: i as u64 });
            seen();
            flown.map_err(|error| Error::Flight { name: flight.name.clone(), error })
        };
        // All are flown before the first error is taken: which one that is does not depend on threads.
        let all: Vec<Result<Flown>> = s.flights.par_iter().enumerate().map(one).collect();
        let flown = all.into_iter().collect::<Result<_>>()?;
        Ok(Flights { scenario, flown })
    }
}

/// A scenario's flights.
///
/// ```
/// use windfall::prelude::*;
/// let flights = Scenario::bundled("appendix-c")?.fly(&Fly::default())?;
/// assert_eq!(flights.flown[0].record.len(), 2251);
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Flights {
    /// What was flown, with its seed.
    pub scenario: Scenario,
    /// Record and truth of each flight, in the scenario's order.
    pub flown: Vec<Flown>,
}

/// What `windfall simulate --json` prints.
///
/// ```
/// use windfall::prelude::*;
/// let said = Scenario::bundled("appendix-c")?.fly(&Fly::default())?.summary(false);
/// assert_eq!((said.scenario.as_str(), said.campaign), ("appendix-c", None));
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Simulation {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of all chance.
    pub seed: u64,
    /// Each flight.
    pub flights: Vec<FlightSummary>,
    /// The campaign's file, where files were written.
    pub campaign: Option<&'static str>,
}

/// One flight in short.
///
/// ```
/// use windfall::prelude::*;
/// let said = Scenario::bundled("appendix-c")?.fly(&Fly::default())?.summary(false);
/// assert_eq!((said.flights[0].end, said.flights[0].samples), ("completed", 2251));
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FlightSummary {
    /// Its name.
    pub name: String,
    /// Samples of the record.
    pub samples: usize,
    /// `completed`, or what was reached: `wall`, `upper net`, `lower net`.
    pub end: &'static str,
    /// When, s.
    pub end_t_s: f64,
    /// Steps of the integrator.
    pub steps: u64,
    /// File of the record, where files were written.
    pub record: Option<String>,
    /// File of the truth, where files were written.
    pub truth: Option<String>,
    /// What a user should know of a flight that ended early.
    #[serde(skip)]
    pub warning: Option<String>,
}

impl Flights {
    /// The campaign that they make: the declared plant without the scenario's effects, and the records.
    #[must_use]
    pub fn campaign(&self) -> Campaign {
        let file = &self.scenario.file;
        let runs = file.scenario.flights.iter().zip(&self.flown).map(|(f, flown)| Run::of_flight(f, flown.record.clone()));
        let data = windfall_model::Campaign::of_flights(
            &file.scenario.name,
            &file.declared_plant,
            &file.declared,
            &file.knowledge,
            runs.collect(),
        );
        Campaign { data, warnings: Vec::new() }
    }
    /// How the flights went; with names of files where they were written.
    #[must_use]
    pub fn summary(&self, written: bool) -> Simulation {
        let s = &self.scenario.file.scenario;
        let one = |(flight, flown): (&Flight, &Flown)| {
            let (end, end_t_s) = match flown.end {
                End::Completed => ("completed", flown.truth.t_s.last().copied().unwrap_or(0.0)),
                End::Wall { t_s } => ("wall", t_s),
                End::UpperNet { t_s } => ("upper net", t_s),
                End::LowerNet { t_s } => ("lower net", t_s),
            };
            let (record, truth) = names(flight, s.flights.len());
            let early = || {
                format!(
                    "{}: the model reached the {end} after {end_t_s:.3} of {} s; try: another release, operator or [section]",
                    flight.name, flight.duration_s
                )
            };
            FlightSummary {
                name: flight.name.clone(),
                samples: flown.record.len(),
                end,
                end_t_s,
                steps: flown.steps,
                record: written.then_some(record),
                truth: written.then_some(truth),
                warning: (flown.end != End::Completed).then(early),
            }
        };
        Simulation {
            scenario: s.name.clone(),
            seed: s.seed,
            flights: s.flights.iter().zip(&self.flown).map(one).collect(),
            campaign: written.then_some(CAMPAIGN),
        }
    }
    /// Writes records, truths, the campaign they make and the resolved scenario into a folder that exists: all of them or, if the process
    /// ends before, none.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let set = FileSet::new(folder)?;
        self.write_into(set.stage())?;
        Ok(set.commit(true)?)
    }
    fn write_into(&self, folder: &Path) -> Result<()> {
        let file = &self.scenario.file;
        let flights = &file.scenario.flights;
        let mut lines = Vec::new();
        for (flight, flown) in flights.iter().zip(&self.flown) {
            let (record, truth) = names(flight, flights.len());
            write_record_csv(&folder.join(&record), &flown.record)?;
            write_truth(&folder.join(truth), &flown.truth)?;
            lines.push(RunLine { file: record, kind: flight.kind.clone(), used: flight.used, window_s: flight.window_s });
        }
        write_campaign_toml(&folder.join(CAMPAIGN), file, &lines)?;
        write_resolved_scenario(&folder.join(RESOLVED), file)?;
        Ok(())
    }
}

/// Names of the files of record and truth.
fn names(flight: &Flight, flights: usize) -> (String, String) {
    if flights == 1 {
        ("run.csv".to_owned(), "truth.csv".to_owned())
    } else {
        (format!("{}.csv", flight.name), format!("{}-truth.csv", flight.name))
    }
}

fn write_truth(path: &Path, truth: &Truth) -> Result<()> {
    let axis = |series: &[[f64; 3]], k: usize| series.iter().map(|v| v[k]).collect::<Vec<f64>>();
    let mut columns: Vec<(&str, Vec<f64>)> = vec![("t_s", truth.t_s.clone())];
    for (names, series) in [
        (["Xcm_m", "Ycm_m", "Zcm_m"], &truth.p_tunnel_cm),
        (["vX_m_s", "vY_m_s", "vZ_m_s"], &truth.v_tunnel_cm),
        (["p_rad_s", "q_rad_s", "r_rad_s"], &truth.w_tunnel_body),
        (["Rx_rad", "Ry_rad", "Rz_rad"], &truth.attitude_rad),
    ] {
        columns.extend(names.into_iter().enumerate().map(|(k, n)| (n, axis(series, k))));
    }
    for (k, name) in ["q_w", "q_x", "q_y", "q_z"].into_iter().enumerate() {
        columns.push((name, truth.quaternion.iter().map(|q| q[k]).collect()));
    }
    columns.extend([
        ("VW_m_s", truth.vw_m_s.clone()),
        ("alphaT_rad", truth.alpha_t_rad.clone()),
        ("Vinf_m_s", truth.airspeed_m_s.clone()),
        ("Ftr_N", truth.tether_n.clone()),
    ]);
    let views: Vec<(&str, &[f64])> = columns.iter().map(|(n, c)| (*n, c.as_slice())).collect();
    Ok(write_columns_csv(path, &views)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `sage-thesis` against the printed Table 5.1: durations as printed, angles within 15 %, rates within a quarter. Its unperturbed yaw rate is
    /// the one that gusts do not reach.
    #[test]
    fn pub_table_5_1() {
        let campaign = Scenario::bundled("sage-thesis").and_then(|s| s.fly(&Fly::default())).expect("flown").campaign();
        let table = windfall_pid::test_table(&campaign.data);
        let printed =
            [("unperturbed", 55.0, 8.6, 26.8, 54.4), ("perturbed", 18.3, 38.8, 46.9, 98.3), ("combined", 73.3, 38.8, 46.9, 98.3)];
        for (name, time_s, alpha_t_deg, q_deg_s, r_deg_s) in printed {
            let e = &table.data_sets.iter().find(|s| s.name == name).expect("a data set").envelope;
            assert!((e.duration_s - time_s).abs() < 0.05, "{name}: {e:?}");
            assert!((e.max_alpha_t_deg / alpha_t_deg - 1.0).abs() < 0.15, "{name}: {e:?}");
            assert!((e.max_q_deg_s / q_deg_s - 1.0).abs() < 0.25, "{name}: {e:?}");
            assert!(
                (e.max_r_deg_s / r_deg_s - 1.0).abs() < 0.25 || name == "unperturbed" && e.max_r_deg_s < r_deg_s,
                "{name}: {e:?}"
            );
        }
        let held_out = table.runs.iter().find(|r| r.used == "hold-out").expect("a run held out");
        // "Approximately 18 deg", section 5.3.2.
        assert!((held_out.envelope.max_alpha_t_deg - 18.0).abs() < 1.0 && (held_out.envelope.duration_s - 10.5).abs() < 0.05);
    }

    /// What is put into the truth is not in the campaign, which declares what the scenario declares, uncertainties included.
    #[test]
    fn law_a_campaign_declares_no_effect() {
        let bare = Scenario::bundled("sage-perturbed").expect("bundled");
        let mut scenario = bare.clone().with_effect("center-of-mass", &[("z_m", 0.002)]).expect("in range");
        scenario.file.knowledge.exact_noise = true;
        assert_ne!(scenario.file.scenario.plant, bare.file.scenario.plant);
        let flights = scenario.fly(&Fly { seed: Some(3) }).expect("flown");
        let campaign = flights.campaign().data;
        assert_eq!((campaign.plant, campaign.declared), (bare.file.declared_plant.clone(), bare.file.declared.clone()));
        assert!(campaign.knowledge.exact_noise && flights.scenario.file.scenario.seed == 3);
        let names = scenario.files();
        assert_eq!(names, ["run.csv", "truth.csv", "campaign.toml", "scenario.toml"]);
        for (family, given, word) in [
            ("centre-of-mass", &[][..], "families: "),
            ("center-of-mass", &[("w_m", 0.0)], "parameters: x_m"),
            ("center-of-mass", &[("z_m", f64::NAN)], "allowed: "),
        ] {
            let refused = bare.clone().with_effect(family, given);
            assert!(refused.is_err_and(|e| e.to_string().contains(word)), "{family} {given:?}");
        }
    }
}
