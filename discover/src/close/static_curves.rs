//! discover: static coefficients of a closing over the angle, with the points of wind-tunnel tests. In: plants, a campaign's points. Out:
//! figures.

use super::{Figure, Role, Series, Topic};
use windfall_model::{Campaign, Plant, StaticPoints};
use windfall_pid::NORMAL_95;
use windfall_pid::bands::{mean_speed_m_s, static_name, still_flow};

/// Points of a curve.
const CURVE: usize = 61;

/// A figure of each line: curves of both sides up to the last angle, and the points with their 95 % uncertainty.
pub(super) fn figures(campaign: &Campaign, plants: &[(Role, &Plant)], reached_rad: f64) -> Vec<Figure> {
    let speed = mean_speed_m_s(campaign);
    let one = |s: &StaticPoints| {
        let end = s.points.iter().map(|p| p.alpha_t_rad).fold(reached_rad, f64::max);
        let angles: Vec<f64> = (0..CURVE).map(|k| end * k as f64 / (CURVE - 1) as f64).collect();
        let curve = |(role, plant): &(Role, &Plant)| {
            let y = angles.iter().map(|a| plant.aero.coefficients(&still_flow(*a, speed))[s.coefficient as usize]).collect();
            Series { role: *role, x: angles.iter().map(|a| a.to_degrees()).collect(), y, ..Series::default() }
        };
        let name = static_name(s.coefficient)?;
        Some(Figure {
            topic: Topic::Static,
            title: format!("{name} over α_T against {}", s.test),
            x_label: "α_T (deg)".to_owned(),
            y_label: format!("{name} (1)"),
            marks: vec![reached_rad.to_degrees()],
            series: plants.iter().map(curve).chain([points(s)]).collect(),
            ..Figure::default()
        })
    };
    campaign.knowledge.wind_tunnel.iter().filter_map(one).collect()
}

fn points(s: &StaticPoints) -> Series {
    let end = |sign: f64| s.points.iter().map(|p| p.value + sign * NORMAL_95 * p.std.unwrap_or(0.0)).collect();
    let stated = s.points.iter().any(|p| p.std.is_some());
    Series {
        role: Role::Measured,
        x: s.points.iter().map(|p| p.alpha_t_rad.to_degrees()).collect(),
        y: s.points.iter().map(|p| p.value).collect(),
        band: stated.then(|| [end(-1.0), end(1.0)]),
        points: true,
    }
}

#[cfg(test)]
mod tests;
