//! discover: measured and modelled signals over time, for the page and whoever plots them. In: a campaign, models. Out: a series per
//! channel and run: `tracks.json`, `coefficients.json`, `flights.json`.

use super::figure::{short, times};
use super::figures::runs_flown;
use super::sides::Sides;
use super::signals::{BodyShape, RunTracks, SignalTracks, TrackSignal, named};
use super::slope::slope;
use super::{Closing, Role};
use crate::DiscoverError;
use crate::tracks::{TrackEvidence, stated_std};
use rayon::prelude::*;
use windfall_model::{Aero, Campaign, Coefficient, Data, Measured, Plant, Record, Run, Variable};
use windfall_pid::coefficients::CoefficientRow;
use windfall_pid::smooth::Smoother;
use windfall_pid::{Identification, Method, process, rates_and_angles};
use windfall_replay::{Replay, ReplayError, estimate_initial};
use windfall_sim::Flown;

/// Most samples of all runs together: longer campaigns are thinned.
pub(super) const SAMPLES: usize = 20_000;
/// Most samples of coefficients, which are smooth.
const COEFFICIENT_SAMPLES: usize = 6_000;

/// Measured pose, rates and tunnel speed of every run beside flights from its own initial state, with the declared model and with the
/// effects added. Of point bodies the position.
///
/// # Errors
/// A closing that was read from a file; as closing itself. A run that cannot be flown again has its measurement alone.
pub fn tracks(campaign: &Campaign, closing: &Closing) -> Result<SignalTracks, DiscoverError> {
    let sides = closing.plants()?;
    let after = if sides.after.is_some() { "with the effects added" } else { "" };
    let runs = of_runs(campaign, sides)?;
    Ok(SignalTracks { before: "declared model".to_owned(), after: after.to_owned(), runs, ..empty(campaign, sides.last()) })
}

/// The same with an identified model, whose series are those of role `after`.
///
/// # Errors
/// No data set, or an identification of another structure.
pub fn flight_tracks(campaign: &Campaign, found: &Identification) -> Result<SignalTracks, DiscoverError> {
    let plant = identified(campaign, found)?;
    let thin = thinning(campaign, SAMPLES);
    let one = |(i, run): (usize, &Run)| -> Option<RunTracks> {
        let Data::Tunnel(record) = &run.data else { return None };
        Some(tunnel_run(run, record, &[(Role::After, campaign.plant_for(&plant, i))], thin))
    };
    let runs = campaign.runs.par_iter().enumerate().filter_map(one).collect();
    Ok(SignalTracks { after: "identified model".to_owned(), runs, ..empty(campaign, &plant) })
}

/// Coefficients that the record's motion needs, about the geometric origin, beside those of an identified model at the same states. The record
/// is smoothed as the method does, and each coefficient has the estimates of its own data: regression gives C_m and C_n the static moment
/// apart.
///
/// # Errors
/// No data set, or an identification of another structure.
pub fn coefficient_tracks(campaign: &Campaign, found: &Identification) -> Result<SignalTracks, DiscoverError> {
    let set = found.combined().ok_or(ReplayError::NoDataSet)?;
    let plant = set.plant_in(campaign)?;
    let own = Coefficient::ALL.map(|c| set.values_of(c, &plant.aero));
    let smoother = Method::of_name(&found.method).map_or(Smoother::Auto, Method::smoother);
    let thin = thinning(campaign, COEFFICIENT_SAMPLES);
    let one = |(i, run): (usize, &Run)| -> Option<RunTracks> {
        let Data::Tunnel(record) = &run.data else { return None };
        let processed = process(&run.name, &run.kind, record, &campaign.plant_for(&plant, i), &smoother).ok()?;
        let channel = |c: Coefficient| {
            let place = c as usize;
            let aero = Aero { values: own[place].clone(), ..plant.aero.clone() };
            let of = |value: &dyn Fn(&CoefficientRow) -> f64| -> Vec<f64> {
                processed.rows.iter().step_by(thin).map(|row| short(value(row))).collect()
            };
            let (measured, after) = (of(&|row| row.exp_origin[place]), of(&|row| aero.coefficients(&row.flow)[place]));
            TrackSignal { measured, after, ..TrackSignal::new(c.name(), "", None) }
        };
        let angle = processed.rows.iter().step_by(thin).map(|row| short(row.flow.get(Variable::AlphaT).to_degrees()));
        let angle = TrackSignal { measured: angle.collect(), ..TrackSignal::new("α_T", "deg", None) };
        let channels = Coefficient::ALL.into_iter().map(channel).chain([angle]).collect();
        Some(RunTracks { t_s: times(&record.t_s, thin), channels, interior_s: processed.interior_s(), ..named(run) })
    };
    let runs = campaign.runs.par_iter().enumerate().filter_map(one).collect();
    Ok(SignalTracks { after: "identified model".to_owned(), runs, ..empty(campaign, &plant) })
}

fn identified(campaign: &Campaign, found: &Identification) -> Result<Plant, DiscoverError> {
    let set = found.combined().ok_or(ReplayError::NoDataSet)?;
    Ok(set.plant_in(campaign)?)
}

/// Diameter of the circle of an area.
fn circle_m(area_m2: f64) -> f64 {
    2.0 * (area_m2 / std::f64::consts::PI).sqrt()
}

/// Tracks without runs; the body and its tether are drawn as this plant has them.
pub(super) fn empty(campaign: &Campaign, plant: &Plant) -> SignalTracks {
    let tether = plant.tether.as_ref().filter(|_| !campaign.has_tracks());
    // Of a rigid body in free flight nothing is known of its shape but an area.
    let of_area = |f: &windfall_model::FreeFlight| circle_m(f.area_m2);
    let body = BodyShape {
        rigid: !campaign.has_tracks(),
        free: campaign.measured() == Measured::Pose,
        diameter_m: plant.free_flight.as_ref().map_or(plant.vehicle.diameter_m, of_area),
        center_of_mass_m: plant.vehicle.p_origin_cm.to_array(),
        attachment_m: tether.map(|t| t.p_origin_hook.to_array()),
        ring_m: tether.map(|t| t.ring().to_array()),
    };
    SignalTracks { campaign: campaign.name.clone(), body, ..SignalTracks::default() }
}

fn of_runs(campaign: &Campaign, sides: &Sides) -> Result<Vec<RunTracks>, DiscoverError> {
    let thin = thinning(campaign, SAMPLES);
    if campaign.measured() == Measured::Pose {
        return super::poses::runs(campaign, sides);
    }
    if campaign.has_tracks() {
        return points(campaign, sides, thin);
    }
    let one = |(i, run): (usize, &Run)| -> Option<RunTracks> {
        let Data::Tunnel(record) = &run.data else { return None };
        let plants: Vec<(Role, Plant)> = sides.each().map(|(role, p)| (role, campaign.plant_for(p, i))).collect();
        Some(tunnel_run(run, record, &plants, thin))
    };
    Ok(campaign.runs.par_iter().enumerate().filter_map(one).collect())
}

/// Every so-manieth sample, so that all runs together have at most so many.
pub(super) fn thinning(campaign: &Campaign, most: usize) -> usize {
    let samples = |r: &Run| match &r.data {
        Data::Tunnel(t) => t.t_s.len(),
        Data::Point(p) => p.t_s.len(),
    };
    campaign.runs.iter().map(samples).sum::<usize>().div_ceil(most).max(1)
}

/// The channels of a tunnel run, empty: pose, swing and body rates, tunnel speed, airspeed, the tether's pull.
fn tunnel_channels(plant: &Plant) -> Vec<TrackSignal> {
    let s = &plant.sensors;
    let (at, roll, turn) = (Some(s.position_std_m), Some(s.roll_std_rad.to_degrees()), Some(s.pitch_yaw_std_rad.to_degrees()));
    let mut all = vec![
        TrackSignal::new("X", "m", at),
        TrackSignal::new("Y", "m", at),
        TrackSignal::new("Z", "m", at),
        TrackSignal::new("Rx", "deg", roll),
        TrackSignal::new("Ry", "deg", turn),
        TrackSignal::new("Rz", "deg", turn),
        TrackSignal::new("Θ", "deg", None),
        TrackSignal::new("p", "deg/s", None),
        TrackSignal::new("q", "deg/s", None),
        TrackSignal::new("r", "deg/s", None),
        TrackSignal::new("V_W", "m/s", Some(s.wind_std_m_s)),
        TrackSignal::new("airspeed", "m/s", None),
    ];
    if plant.tether.is_some() {
        all.push(TrackSignal::new("tether pull", "N", None));
    }
    all
}

fn tunnel_run(run: &Run, record: &Record, plants: &[(Role, Plant)], thin: usize) -> RunTracks {
    let mut channels = plants.first().map_or_else(Vec::new, |(_, p)| tunnel_channels(p));
    let mut put = |role: Role, series: Vec<Vec<f64>>| {
        for (channel, values) in channels.iter_mut().zip(series) {
            *channel.side(role) = values.iter().step_by(thin).map(|v| short(*v)).collect();
        }
    };
    for (k, (role, plant)) in plants.iter().enumerate() {
        let Ok(replay) = Replay::new(record, plant) else { continue };
        if k == 0 {
            let airspeed = replay.states().iter().map(|s| s.speed).collect();
            put(Role::Measured, series(record, &replay, record.vw_m_s.clone(), airspeed));
        }
        let flown: Option<Flown> =
            estimate_initial(record, plant).ok().and_then(|i| replay.fly_as_far_as_it_goes(i.release).ok());
        if let Some(flown) = flown {
            let mut all = series(&flown.record, &replay, Vec::new(), flown.truth.airspeed_m_s);
            all.push(flown.truth.tether_n);
            put(*role, all);
        }
    }
    RunTracks { t_s: times(&record.t_s, thin), channels, ..named(run) }
}

/// A record's series in the order of [`tunnel_channels`], degrees of angles.
fn series(record: &Record, replay: &Replay, vw: Vec<f64>, airspeed: Vec<f64>) -> Vec<Vec<f64>> {
    let degrees = |s: &[f64]| s.iter().map(|x| x.to_degrees()).collect::<Vec<f64>>();
    let mut all: Vec<Vec<f64>> = record.position_m.to_vec();
    all.extend(record.attitude_rad.iter().map(|s| degrees(s)));
    // Flights and records go through the same smoothing.
    match rates_and_angles(record, replay.smoother()) {
        Ok(a) => {
            all.push(degrees(&a.theta_rad));
            all.extend((0..3).map(|k| a.pqr_rad_s.iter().map(|w| w[k].to_degrees()).collect::<Vec<f64>>()));
        }
        Err(_) => all.extend(vec![Vec::new(); 4]),
    }
    all.extend([vw, airspeed]);
    all
}

/// What was measured of bodies without attitude.
fn points(campaign: &Campaign, sides: &Sides, thin: usize) -> Result<Vec<RunTracks>, DiscoverError> {
    let indices: Vec<usize> = (0..campaign.runs.len()).collect();
    let evidence = TrackEvidence::new(campaign, &indices, &sides.before)?;
    let kind = campaign.measured();
    let down = |channel: usize| channel == 0 && kind.unit(0) == "m";
    let name = |channel: usize| if down(channel) { "X (down)" } else { kind.names().get(channel).copied().unwrap_or("") };
    let (unit, per_unit) = match kind {
        Measured::Angle => (Some("deg"), 1.0_f64.to_degrees()),
        _ => (None, 1.0),
    };
    let noise = |channel: usize| Some(per_unit * stated_std(&campaign.plant, kind, channel)).filter(|s| *s > 0.0);
    let mut all: Vec<RunTracks> = Vec::new();
    for run in &campaign.runs {
        let Data::Point(track) = &run.data else { continue };
        let channel = |axis: usize| -> Option<TrackSignal> {
            let measured = track.channel(axis)?.iter().step_by(thin).map(|v| short(per_unit * v)).collect();
            Some(TrackSignal { measured, ..TrackSignal::new(name(axis), unit.unwrap_or(kind.unit(axis)), noise(axis)) })
        };
        let mut channels: Vec<TrackSignal> = (0..6).filter_map(channel).collect();
        let whole: Vec<&[f64]> = track.position_m.iter().flatten().map(Vec::as_slice).collect();
        if let Some((name, unit, rate)) = rate(kind, &track.t_s, &whole) {
            let measured = rate.into_iter().step_by(thin).map(|v| short(per_unit * v)).collect();
            channels.push(TrackSignal { measured, ..TrackSignal::new(name, unit, None) });
        }
        all.push(RunTracks { t_s: times(&track.t_s, thin), channels, ..named(run) });
    }
    for (role, flown) in runs_flown(&evidence, sides) {
        for r in flown {
            let Data::Point(track) = &campaign.runs[r.run].data else { continue };
            let measured = (0..6).filter_map(|c| track.channel(c));
            let left = r.residual_m.iter().flatten();
            // A track may begin before the times that its residual has.
            let both = measured.zip(left).filter(|(m, e)| m.len() == e.len());
            let simulated: Vec<Vec<f64>> = both.map(|(m, e)| m.iter().zip(e).map(|(m, e)| m - e).collect()).collect();
            let channels = &mut all[r.run].channels;
            let whole: Vec<&[f64]> = simulated.iter().map(Vec::as_slice).collect();
            let rate = rate(kind, &track.t_s, &whole).map(|(.., rate)| rate);
            for (channel, series) in channels.iter_mut().zip(simulated.iter().chain(&rate)) {
                *channel.side(role) = series.iter().step_by(thin).map(|v| short(per_unit * v)).collect();
            }
        }
    }
    Ok(all)
}

/// The rate of what was measured, with name and unit: speed where all three axes were, the rate of an angle; none of others.
fn rate(kind: Measured, t_s: &[f64], series: &[&[f64]]) -> Option<(&'static str, &'static str, Vec<f64>)> {
    let slopes: Vec<Vec<f64>> = series.iter().map(|x| slope(t_s, x)).collect();
    match (kind, slopes.as_slice()) {
        (Measured::Position, [x, y, z]) => {
            let speed = x.iter().zip(y).zip(z).map(|((x, y), z)| x.hypot(*y).hypot(*z)).collect();
            Some(("speed", "m/s", speed))
        }
        (Measured::Angle, [rate]) => Some(("rate", "deg/s", rate.clone())),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
