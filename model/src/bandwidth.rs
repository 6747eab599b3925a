//! model: what was done to a record before it was exported. In: nothing. Out: channels, cause, usable bandwidth, rates before and after thinning.

use serde::{Deserialize, Serialize};

/// Channels of one instrument, which are exported alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChannelGroup {
    /// X, Y, Z.
    Position,
    /// R_x, R_y, R_z.
    Attitude,
    /// V_W.
    TunnelSpeed,
}

impl ChannelGroup {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Position, Self::Attitude, Self::TunnelSpeed];
    /// Its channels, as places in a [`crate::PerChannel`].
    #[must_use]
    pub const fn channels(self) -> std::ops::Range<usize> {
        match self {
            Self::Position => 0..3,
            Self::Attitude => 3..6,
            Self::TunnelSpeed => 6..7,
        }
    }
    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Position => "the position",
            Self::Attitude => "the attitude",
            Self::TunnelSpeed => "the tunnel speed",
        }
    }
}

/// Why a record has less bandwidth than its rows suggest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ExportCause {
    /// A low-pass filter took off the noise above its corner.
    Smoothed,
    /// Rows between the samples of a slower clock, on straight lines.
    Interpolated,
    /// Every sample of a slower clock given several times.
    Repeated,
    /// None: other runs of the campaign were smoothed, and the noise of all is learnt together.
    OtherRuns,
}

/// What was recognised of a channel group of a record, and at which rate it is used.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bandwidth {
    /// Channels.
    pub channels: ChannelGroup,
    /// What was done to them.
    pub cause: ExportCause,
    /// Frequency at which a smoothing filter passes half of the power, or a quarter where it ran forward and backward, Hz.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub corner_hz: Option<f64>,
    /// Rate of the clock between whose samples rows were made, Hz.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub original_hz: Option<f64>,
    /// Highest frequency at which they carry what the instrument saw, Hz.
    pub bandwidth_hz: f64,
    /// Rate of the file's rows, Hz.
    pub thinned_from_hz: f64,
    /// Rate of the rows that are used, Hz.
    pub thinned_to_hz: f64,
}
