//! cli: planet scenarios in words. In: a planet scenario. Out: its truths and the resolved scenario; what `windfall check` says of it.

use crate::session::{Failure, Session};
use windfall::Fly;
use windfall::planet::{self, Atmosphere, Dispersions, Gravity, PlanetFile, PlanetScenario, Winds};

pub(crate) fn simulate(file: &PlanetFile, request: &Fly, session: &mut Session<'_>) -> Result<bool, Failure> {
    let outputs = planet::files(file);
    let names: Vec<&str> = outputs.iter().map(String::as_str).collect();
    let folder = session.outputs(&names)?;
    if file.scenario.dispersions != Dispersions::default() {
        session.say("turbulence and [uncertainty] are for windfall descend: this flight has even air and an exact start");
    }
    let flown = session.pool()?.install(|| planet::fly(file, request))?;
    session.write(folder.as_deref(), |stage| planet::write(stage, file, &flown))?;
    let simulation = planet::summary(file, &flown, folder.is_some());
    for (r, f) in simulation.flights.iter().zip(&file.scenario.flights) {
        session.say(&format!("{}: {} samples, {} at {:.3} s, {} steps", r.name, r.samples, r.end, r.end_t_s, r.steps));
        if r.end == "ground" {
            let [north, east, down] = r.end_velocity_ned_m_s;
            let across = north.hypot(east);
            session.say(&format!(
                "{}: reached the ground after {:.3} of {} s at {down:.3} m/s down and {across:.3} m/s along it",
                r.name, r.end_t_s, f.duration_s
            ));
        }
    }
    session.written(folder.as_deref(), &names);
    if session.common.json {
        session.print_json(&simulation)?;
    }
    Ok(true)
}

/// What `windfall check` understood.
pub(crate) fn summary(s: &PlanetScenario) -> Vec<String> {
    let (p, r) = (&s.planet, &s.body.reference);
    let kind = if s.body.point { "point mass" } else { "rigid body" };
    let gravity = match p.gravity {
        Gravity::Uniform { gravity_m_s2 } => format!("uniform, {gravity_m_s2} m/s2"),
        Gravity::Central { mu_m3_s2 } => format!("central, mu = {mu_m3_s2} m3/s2"),
        Gravity::J2 { mu_m3_s2, j2 } => format!("central with J2, mu = {mu_m3_s2} m3/s2, J2 = {j2}"),
    };
    let air = match &p.atmosphere {
        None => "none: a vacuum".to_owned(),
        Some(Atmosphere::Us1976) => "U.S. Standard Atmosphere 1976".to_owned(),
        Some(Atmosphere::Venus) => "Venus, Seiff and others 1985".to_owned(),
        Some(a @ Atmosphere::Table(_)) => format!("from a file, {} to {} m", a.range_m()[0], a.range_m()[1]),
    };
    let wind = match &p.wind {
        Winds::Steady { north_m_s, east_m_s } => format!("{north_m_s} m/s toward north, {east_m_s} m/s toward east"),
        Winds::Table(t) => format!("{} rows over height", t.rows().len()),
    };
    let lengths = if s.body.point { String::new() } else { format!(", b = {} m, c = {} m", r.span_m, r.chord_m) };
    let mut all = vec![
        format!("{kind}: {} kg, S = {:.6} m2{lengths}", s.body.vehicle.mass_kg, r.area_m2),
        format!(
            "planet: radius {} m, flattening {}, turning at {} rad/s",
            p.figure.equatorial_radius_m, p.figure.flattening, p.rotation_rad_s
        ),
        format!("gravity: {gravity}"),
        format!("air: {air}"),
        format!("wind: {wind}"),
    ];
    all.extend(dispersions(&s.dispersions));
    all.extend(s.flights.iter().map(|f| {
        let g = f.start.place;
        let (lat, lon) = (g.latitude_rad.to_degrees(), g.longitude_rad.to_degrees());
        format!(
            "flight {}: {} s at {} Hz from {} m at {lat} deg north, {lon} deg east",
            f.name, f.duration_s, f.rate_hz, g.height_m
        )
    }));
    all
}

/// What differs from one descent to the next.
fn dispersions(d: &Dispersions) -> Vec<String> {
    let mut all = Vec::new();
    if let Some((_, g)) = d.gusts.as_ref().and_then(|g| g.rows().first()) {
        let rows = d.gusts.as_ref().map_or(0, |g| g.rows().len());
        let over = if rows > 1 { format!(" at the lowest of {rows} heights") } else { String::new() };
        all.push(format!(
            "turbulence for descend: {} m/s rms vertical, {} m/s horizontal, scales {} and {} m{over}",
            g.axial_rms_m_s, g.lateral_rms_m_s, g.axial_scale_m, g.lateral_scale_m
        ));
    }
    let uncertain: Vec<String> = d.vehicle.numbers().iter().map(|n| format!("{} ± {}", n.name, n.std)).collect();
    if !uncertain.is_empty() {
        all.push(format!("uncertain for descend: {}", uncertain.join(", ")));
    }
    if !d.start.is_exact() {
        all.push("scattered start for descend: [uncertainty.initial]".to_owned());
    }
    all
}
