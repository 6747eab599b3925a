//! pid: how much more tunnel time a wanted error costs. In: a campaign, wanted standard errors. Out: runs, their length and release
//! angle, and the tunnel time, cheapest first.
//!
//! Fisher information adds over runs (Klein and Morelli 2006, §9.3). That of the campaign is taken at its own estimates; that of a
//! run still to be flown from a flight of the identified model, released at rest at an angle in pitch and yaw alike, tunnel speed at
//! trim, with the sensors' noise, hand at the throttle and turbulence of the campaign. The filter's information is causal, so one
//! flight gives all shorter ones. Gusts are not flown, only allowed for: what they would excite comes on top.

use crate::choice::identify_chosen;
use crate::equations::{Craft, Drive, Extra, INPUTS, STATES, Segment, Transition, TunnelAir, origin};
use crate::error::PidError;
use crate::filter_error::{Filter, NONE_M_S, Random};
use crate::output_error::{EstimateOptions, FreeColumns, NODE, PreparedRun, SPEED, ready, run_plants, unknowns};
use crate::plant::START_SCALE_M;
use crate::{SearchKind, StopReason};
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};
use windfall_model::frames::EulerXyz;
use windfall_model::{CHANNELS, Campaign, PerChannel, Plant, Record, Turbulence, Unknowns};

/// Release angles tried, deg.
const RELEASES_DEG: [f64; 8] = [2.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0];
/// Lengths of a run tried, s.
const LENGTHS_S: [f64; 7] = [5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0];
/// Most runs of one kind.
const MOST_RUNS: u32 = 4096;

/// A wanted standard error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// Parameter.
    pub parameter: String,
    /// Wanted standard error, in the parameter's unit, or as part of its estimate.
    pub error: Wanted,
}

/// How an error is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Wanted {
    /// In the parameter's unit.
    Absolute(f64),
    /// Percent of the estimate.
    Percent(f64),
}

/// What the campaign has and what it takes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TestPlan {
    /// Method by which the campaign was identified, and why.
    pub method: String,
    /// One for each target.
    pub targets: Vec<TargetPlan>,
    /// Speed at which the model hovers, m/s.
    pub trim_m_s: f64,
    /// Largest total angle of attack flown so far, deg: beyond it the model is extrapolated.
    pub flown_deg: f64,
    /// Time between runs that counts as tunnel time, s.
    pub between_s: f64,
    /// What a user should know.
    pub warnings: Vec<String>,
}

impl TestPlan {
    /// Whether every wanted error is reached already or can be.
    #[must_use]
    pub fn is_within_reach(&self) -> bool {
        self.targets.iter().all(|t| t.std_error_now <= t.std_error_wanted || !t.options.is_empty())
    }
}

/// One parameter's way to its wanted error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TargetPlan {
    /// Parameter.
    pub parameter: String,
    /// Estimate now.
    pub estimate: f64,
    /// Its standard error by the campaign as it is.
    pub std_error_now: f64,
    /// That wanted.
    pub std_error_wanted: f64,
    /// Cheapest first, one for each release angle from which it can be reached; empty where nothing is needed or nothing helps.
    pub options: Vec<Choice>,
}

/// Runs of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Choice {
    /// Total angle of attack at release, deg.
    pub release_deg: f64,
    /// Length of a run, s.
    pub run_s: f64,
    /// Number of runs.
    pub runs: u32,
    /// Tunnel time with what lies between runs, min.
    pub minutes: f64,
    /// Standard error then.
    pub std_error: f64,
}

/// Plans runs for the targets; `between_s`: time between runs that counts as tunnel time.
///
/// # Errors
/// As [`identify_chosen`]; [`PidError::Unknown`] for a target that is no estimated parameter or no positive error.
pub fn plan(campaign: &Campaign, targets: &[Target], between_s: f64) -> Result<TestPlan, PidError> {
    let options = EstimateOptions { combined_only: true, ..EstimateOptions::default() };
    let found = identify_chosen(campaign, &options)?;
    let mut unknowns = unknowns(campaign, &options)?;
    let set = found.of_all_runs().ok_or_else(|| PidError::NothingToEstimate { campaign: campaign.name.clone() })?;
    unknowns.start(&set.values(&campaign.plant.aero.structure, &unknowns.parameters()));
    let found_gusts = set.plant(&Plant { turbulence: Turbulence::default(), ..campaign.plant.clone() })?.turbulence;
    let scale = |m: f64| if m > 0.0 { m } else { START_SCALE_M };
    let turbulence = Turbulence {
        axial_rms_m_s: found_gusts.axial_rms_m_s.max(NONE_M_S),
        lateral_rms_m_s: found_gusts.lateral_rms_m_s.max(NONE_M_S),
        axial_scale_m: scale(found_gusts.axial_scale_m),
        lateral_scale_m: scale(found_gusts.lateral_scale_m),
        bandwidth: found_gusts.bandwidth,
    };
    let own = campaign.with_effects_in_plant();
    let plants = run_plants(&own)?;
    let runs = ready(&own, &plants)?;
    let scene = Scene::new(&own, &runs, &unknowns, turbulence)?;
    let now = scene.campaign(&runs)?;
    let kinds = scene.kinds();
    let one = |t: &Target| scene.target(t, &now, &kinds, between_s);
    let targets = targets.iter().map(one).collect::<Result<Vec<_>, _>>()?;
    let flown_deg = runs
        .iter()
        .flat_map(|r| &r.smoothed.nodes)
        .map(|n| EulerXyz { rx_rad: n[3], ry_rad: n[4], rz_rad: n[5] }.off_vertical_rad().to_degrees());
    let flown_deg = flown_deg.fold(0.0, f64::max);
    let mut warnings = found.warnings;
    for t in targets.iter().filter(|t| t.options.is_empty() && t.std_error_now > t.std_error_wanted) {
        warnings.push(format!(
            "{}: no number of such runs brings its standard error from {:.3e} to {:.3e}: declare fewer parameters or give a prior",
            t.parameter, t.std_error_now, t.std_error_wanted
        ));
    }
    let method = found.reason.map_or(found.method.clone(), |r| format!("{}: {r}", found.method));
    Ok(TestPlan { method, targets, trim_m_s: scene.trim_m_s, flown_deg, between_s, warnings })
}

/// What planned flights share.
struct Scene<'s> {
    plant: &'s Plant,
    unknowns: &'s Unknowns,
    turbulence: Turbulence,
    noise: PerChannel<f64>,
    jerk_root: f64,
    interval_s: f64,
    ps_pa: f64,
    ts_k: f64,
    trim_m_s: f64,
}

/// Information of a kind of run: release angle, length, matrix.
type Kind = (f64, f64, DMatrix<f64>);

impl<'s> Scene<'s> {
    fn new(
        campaign: &'s Campaign,
        runs: &[PreparedRun<'_>],
        unknowns: &'s Unknowns,
        turbulence: Turbulence,
    ) -> Result<Self, PidError> {
        let mean = |f: &dyn Fn(&PreparedRun<'_>) -> f64| runs.iter().map(f).sum::<f64>() / runs.len() as f64;
        let middle = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
        let mut scene = Self {
            plant: &campaign.plant,
            unknowns,
            turbulence,
            noise: std::array::from_fn(|c| mean(&|r| r.noise_std[c].powi(2)).sqrt().max(1e-9)),
            jerk_root: mean(&|r| r.jerk_root.powi(2)).sqrt(),
            interval_s: runs[0].interval_s,
            ps_pa: mean(&|r| middle(&r.record.ps_pa)),
            ts_k: mean(&|r| middle(&r.record.ts_k)),
            trim_m_s: 0.0,
        };
        scene.trim_m_s = scene.trim(&Craft::new(scene.plant)?)?;
        Ok(scene)
    }

    fn density(&self) -> f64 {
        self.plant.environment.density_kg_m3(self.ps_pa, self.ts_k)
    }

    /// Speed at which the level model hovers, by bisection: drag grows with speed.
    fn trim(&self, craft: &Craft<'_>) -> Result<f64, PidError> {
        let parameters = self.unknowns.parameters();
        let mut terms = vec![0.0; craft.terms.acts.len()];
        let mut sinks = |vw_m_s: f64| {
            let air = TunnelAir { t_s: 0.0, density_kg_m3: self.density(), vw_m_s, vw_rate_m_s2: 0.0 };
            let rate = craft.rate(&[0.0; STATES], air, &Extra::default(), &parameters, &mut terms);
            rate.is_some_and(|r| r[6] > 0.0)
        };
        let (mut low, mut high) = (0.01, 300.0);
        if !sinks(low) || sinks(high) {
            return Err(PidError::NotIntegrable { what: "no speed between 0.01 and 300 m/s at which it hovers" });
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if sinks(middle) { low = middle } else { high = middle }
        }
        Ok(0.5 * (low + high))
    }

    /// Information of the campaign's own runs.
    fn campaign(&self, runs: &[PreparedRun<'_>]) -> Result<DMatrix<f64>, PidError> {
        let free = self.unknowns.free();
        let mut sum = DMatrix::zeros(free, free);
        for run in runs {
            let seen = self.information(run, &[f64::INFINITY]).ok_or_else(|| PidError::NoAnswer {
                campaign: run.name.to_owned(),
                set: run.name.to_owned(),
                search: SearchKind::Plan,
                stop: StopReason::FlightFails,
            })?;
            sum += &seen[0];
        }
        Ok(sum)
    }

    /// Information of every length of run at every release angle that can be flown.
    fn kinds(&self) -> Vec<Kind> {
        let mut kinds = Vec::new();
        for release_deg in RELEASES_DEG {
            let Some((record, first)) = self.fly(release_deg) else { continue };
            let Ok(run) = PreparedRun::planned(&record, self.plant, first, self.jerk_root, self.noise) else { continue };
            let Some(informations) = self.information(&run, &LENGTHS_S) else { continue };
            kinds.extend(LENGTHS_S.iter().zip(informations).map(|(length, m)| (release_deg, *length, m)));
        }
        kinds
    }

    /// The identified model released at rest; record without noise, and its first node.
    fn fly(&self, release_deg: f64) -> Option<(Record, [f64; NODE])> {
        let craft = Craft::new(self.plant).ok()?;
        let longest = LENGTHS_S[LENGTHS_S.len() - 1];
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive number of samples")]
        let steps = (longest / self.interval_s).ceil() as usize;
        let mut constant = vec![0.0; INPUTS * SPEED];
        constant[0] = 1.0;
        let drive = Drive { states: SPEED, splits: 1, at: vec![constant; 2 * steps + 1] };
        let parameters = self.unknowns.parameters();
        let none = vec![None; parameters.len()];
        // The same throughout.
        let density = [self.density()];
        let segment = Segment {
            craft: &craft,
            drive: &drive,
            parameters: &parameters,
            columns: &none,
            free: 0,
            start_s: 0.0,
            interval_s: self.interval_s,
            density: &density,
            steps,
            spread_m_s: [0.0; 3],
        };
        let mut x = [0.0; STATES];
        // cos α_T = cos R_y cos R_z, with the two alike.
        let half = release_deg.to_radians().cos().sqrt().acos();
        (x[4], x[5]) = (half, half);
        let mut work = Transition::default();
        if !segment.fly(x, &[self.trim_m_s, 0.0, 0.0], &mut work) {
            return None;
        }
        let mut first = [0.0; NODE];
        first[..STATES].copy_from_slice(&x);
        first[STATES] = self.trim_m_s;
        let states: Vec<[f64; STATES]> = std::iter::once(x).chain(work.states.iter().copied()).collect();
        let places: Vec<[f64; 3]> = states.iter().map(|x| origin(x, self.plant.vehicle.p_origin_cm.to_array())).collect();
        let n = states.len();
        let scale = 1.0 + self.plant.sensors.wind_scale;
        let record = Record {
            t_s: (0..n).map(|i| i as f64 * self.interval_s).collect(),
            position_m: std::array::from_fn(|k| places.iter().map(|p| p[k]).collect()),
            attitude_rad: std::array::from_fn(|k| states.iter().map(|x| x[3 + k]).collect()),
            vw_m_s: vec![self.trim_m_s * scale; n],
            ps_pa: vec![self.ps_pa; n],
            ts_k: vec![self.ts_k; n],
            ..Record::default()
        };
        Some((record, first))
    }

    /// Information on the free parameters of a run's first part, for each length, s.
    fn information(&self, run: &PreparedRun<'_>, lengths_s: &[f64]) -> Option<Vec<DMatrix<f64>>> {
        let c = FreeColumns::of(self.unknowns);
        let random = Random { turbulence: self.turbulence, turning: [0.0; 2] };
        let seen = Filter::new(run, self.noise).run(&random, &c, &mut Transition::default())?;
        let mut m = DMatrix::<f64>::zeros(c.free, c.free);
        let mut out = Vec::with_capacity(lengths_s.len());
        for (row, (slopes, variance)) in seen.by_parameter.chunks_exact(c.free).zip(&seen.pass.variance).enumerate() {
            let t = (row / CHANNELS) as f64 * run.interval_s;
            while lengths_s.get(out.len()).is_some_and(|length| t > *length) {
                out.push(m.clone());
            }
            for (j, a) in slopes.iter().enumerate() {
                (0..=j).for_each(|i| m[(i, j)] += a * slopes[i] / variance);
            }
        }
        out.resize(lengths_s.len(), m);
        out.iter_mut().for_each(|m| m.fill_lower_triangle_with_upper_triangle());
        Some(out)
    }

    fn target(&self, target: &Target, now: &DMatrix<f64>, kinds: &[Kind], between_s: f64) -> Result<TargetPlan, PidError> {
        let fault = |what| PidError::Unknown { what, name: target.parameter.clone() };
        let names = self.unknowns.names();
        let column =
            names.iter().position(|n| *n == target.parameter).ok_or_else(|| fault("target that is no free parameter"))?;
        let estimate = self.unknowns.values()[column];
        let wanted = match target.error {
            Wanted::Absolute(e) => e,
            Wanted::Percent(p) => 0.01 * p * estimate.abs(),
        };
        if !(wanted > 0.0 && wanted.is_finite()) {
            return Err(fault("target without a positive error"));
        }
        let error = |m: &DMatrix<f64>| std_error(m, column);
        let std_error_now = error(now).unwrap_or(f64::MAX);
        let mut options: Vec<Choice> = Vec::new();
        if std_error_now > wanted {
            for (release_deg, run_s, m) in kinds {
                let with = |runs: u32| error(&(now + m * f64::from(runs))).unwrap_or(f64::MAX);
                let Some(runs) = fewest(|n| with(n) <= wanted) else { continue };
                let minutes = f64::from(runs) * (run_s + between_s) / 60.0;
                let choice = Choice { release_deg: *release_deg, run_s: *run_s, runs, minutes, std_error: with(runs) };
                match options.iter_mut().find(|o| (o.release_deg - release_deg).abs() < 1e-9) {
                    Some(o) if o.minutes <= minutes => {}
                    Some(o) => *o = choice,
                    None => options.push(choice),
                }
            }
        }
        options.sort_by(|a, b| a.minutes.total_cmp(&b.minutes));
        Ok(TargetPlan { parameter: target.parameter.clone(), estimate, std_error_now, std_error_wanted: wanted, options })
    }
}

/// Fewest runs for which it is enough; more runs are never worse.
fn fewest(enough: impl Fn(u32) -> bool) -> Option<u32> {
    let mut high = 1;
    while !enough(high) {
        high *= 2;
        if high > MOST_RUNS {
            return None;
        }
    }
    let mut low = high / 2;
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if enough(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

/// Standard error of one parameter by its information, scaled to unit diagonal; none where it is not determined.
fn std_error(m: &DMatrix<f64>, column: usize) -> Option<f64> {
    let scale: Vec<f64> = m.diagonal().iter().map(|d| d.sqrt()).collect();
    if !scale[column].is_normal() {
        return None;
    }
    // What these runs do not excite at all is taken as known.
    let safe = |i: usize| if scale[i].is_normal() { scale[i] } else { 1.0 };
    let scaled = DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| if i == j { 1.0 } else { m[(i, j)] / (safe(i) * safe(j)) });
    let inverse = scaled.cholesky()?.inverse();
    Some(inverse[(column, column)].sqrt() / scale[column])
}

#[cfg(test)]
mod tests;
