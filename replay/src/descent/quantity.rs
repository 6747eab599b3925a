//! replay: what is reported of a descent. In: states in SI and rad. Out: numbers in the units of their names.

use windfall_sim::{DescentState, TouchDown};

/// A quantity of a state: name and value.
pub(super) type OfState = (&'static str, fn(&DescentState) -> f64);
/// A quantity of a touch-down.
pub(super) type OfTouchDown = (&'static str, fn(&TouchDown) -> f64);

/// Quantities over height.
pub(super) const OVER_HEIGHT: [OfState; 7] = [
    ("descent_speed_m_s", |s| s.descent_m_s),
    ("across_speed_m_s", |s| s.across_m_s),
    ("airspeed_m_s", |s| s.airspeed_m_s),
    ("off_vertical_deg", |s| s.off_vertical_rad.to_degrees()),
    ("alpha_T_deg", |s| s.alpha_t_rad.to_degrees()),
    ("pitch_yaw_rate_deg_s", |s| s.pitch_yaw_rate_rad_s.to_degrees()),
    ("roll_rate_deg_s", |s| s.roll_rate_rad_s.to_degrees()),
];

/// Quantities at touch-down; `last_km` is the root mean square over the last kilometre.
pub(super) const TOUCH_DOWN: [OfTouchDown; 11] = [
    ("descent_speed_m_s", |t| t.state.descent_m_s),
    ("across_speed_m_s", |t| t.state.across_m_s),
    ("off_vertical_deg", |t| t.state.off_vertical_rad.to_degrees()),
    ("off_vertical_last_km_deg", |t| t.off_vertical_rms_rad.to_degrees()),
    ("alpha_T_deg", |t| t.state.alpha_t_rad.to_degrees()),
    ("pitch_yaw_rate_deg_s", |t| t.state.pitch_yaw_rate_rad_s.to_degrees()),
    ("pitch_yaw_rate_last_km_deg_s", |t| t.pitch_yaw_rate_rms_rad_s.to_degrees()),
    ("roll_rate_deg_s", |t| t.state.roll_rate_rad_s.to_degrees()),
    ("time_s", |t| t.state.t_s),
    ("drift_north_m", |t| t.drift_m[0]),
    ("drift_east_m", |t| t.drift_m[1]),
];
