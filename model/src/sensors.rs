//! model: what the instruments do to the truth. In: standard deviations and errors. Out: constants for both rooms.

/// Standard deviations (thesis Table A.3) and undeclared instrument errors (zero in a declared model).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensors {
    /// Position of the geometric origin, each axis, m.
    pub position_std_m: f64,
    /// Roll angle R_x, rad.
    pub roll_std_rad: f64,
    /// Pitch and yaw angles R_y and R_z, rad.
    pub pitch_yaw_std_rad: f64,
    /// Tunnel speed V_W, m/s.
    pub wind_std_m_s: f64,
    /// Specific force of a body without attitude, each axis, m/s².
    pub specific_force_std_m_s2: f64,
    /// Angle of a body on a pivot, rad.
    pub angle_std_rad: f64,
    /// Recorded V_W is the true one times `1 + wind_scale`.
    pub wind_scale: f64,
    /// Recorded V_W is the true one this long ago, s.
    pub wind_delay_s: f64,
    /// Recorded position and attitude are the true ones this long ago, s.
    pub pose_delay_s: f64,
    /// Small rotation from the true body axes to those that the motion capture reports, rad about body x, y, z:
    /// recorded `r_tunnel_body` = true `r_tunnel_body` · Rx·Ry·Rz(misalignment).
    pub misalignment_rad: [f64; 3],
    /// Recorded positions are the true ones times `1 + length_scale`.
    pub length_scale: f64,
    /// Recorded times are the true ones times `1 + time_base`.
    pub time_base: f64,
}
