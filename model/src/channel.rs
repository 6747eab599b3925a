//! model: the measured motion signals of a tunnel run. In: nothing. Out: their order, names, and arrays with one entry for each.

use crate::sensors::Sensors;

/// A measured motion signal of a tunnel run, in channel order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunChannel {
    /// Position of the geometric origin along tunnel X, m.
    X,
    /// Along tunnel Y, m.
    Y,
    /// Along tunnel Z, m.
    Z,
    /// Euler angle R_x, rad.
    Rx,
    /// Euler angle R_y, rad.
    Ry,
    /// Euler angle R_z, rad.
    Rz,
    /// Tunnel speed V_W, m/s.
    Wind,
}

/// Number of motion signals.
pub const CHANNELS: usize = RunChannel::ALL.len();
/// Number of those that are the pose: position and angles, the first.
pub const POSE: usize = 6;
/// Names as in the run file, where angles are in degrees.
pub const CHANNEL_NAMES: PerChannel<&str> = ["X_m", "Y_m", "Z_m", "Rx_deg", "Ry_deg", "Rz_deg", "VW_m_s"];

/// One entry for each motion signal, by [`RunChannel::at`].
pub type PerChannel<T> = [T; CHANNELS];

impl RunChannel {
    /// All, in channel order.
    pub const ALL: [Self; 7] = [Self::X, Self::Y, Self::Z, Self::Rx, Self::Ry, Self::Rz, Self::Wind];

    /// Its place in a [`PerChannel`].
    #[must_use]
    pub const fn at(self) -> usize {
        self as usize
    }
    /// Whether it is an Euler angle: rad in a record, degrees in a file.
    #[must_use]
    pub const fn is_angle(self) -> bool {
        matches!(self, Self::Rx | Self::Ry | Self::Rz)
    }
}

impl Sensors {
    /// Declared standard deviation of each motion signal, SI and rad.
    #[must_use]
    pub fn std_by_channel(&self) -> PerChannel<f64> {
        let (p, a) = (self.position_std_m, self.pitch_yaw_std_rad);
        [p, p, p, self.roll_std_rad, a, a, self.wind_std_m_s]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_places_names_and_kinds_agree() {
        for (place, channel) in RunChannel::ALL.into_iter().enumerate() {
            assert_eq!(channel.at(), place);
            assert_eq!(channel.is_angle(), CHANNEL_NAMES[place].ends_with("_deg"));
            assert_eq!(place < POSE, channel != RunChannel::Wind);
        }
    }
}
