//! sim: all chance. In: campaign seed, run number, channel. Out: one stream of random numbers each, whatever else is drawn.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// What a flight's chance comes from. Equal seeds give equal bits, whatever the number of threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Seed {
    /// Of the whole campaign or study: the key of the cipher.
    pub campaign: u64,
    /// Number of the run: selects its streams. Below 2⁵⁶.
    pub run: u64,
}

/// Random inputs of a run. Each has its own stream, so that switching one on or off leaves the others as they were.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Sensor noise: 0 to 6 for X, Y, Z, R_x, R_y, R_z, V_W.
    Sensor(u8),
    /// The unsteady hand of the operator.
    Operator,
    /// Gust along tunnel axis 0 to 2.
    Gust(u8),
    /// Random increment of coefficient 0 to 5.
    Coefficient(u8),
    /// Scatter of a descent's start.
    Start,
    /// Drift of a recorded channel, 0 to 6 as sensor noise.
    Drift(u8),
    /// Numbers that differ from run to run, by their place.
    Number(u8),
    /// What a study varies, 0 to 127.
    Varied(u8),
}

impl Channel {
    fn index(self) -> u64 {
        match self {
            Self::Sensor(c) => u64::from(c),
            Self::Operator => 8,
            Self::Gust(axis) => 16 + u64::from(axis),
            Self::Coefficient(c) => 24 + u64::from(c),
            Self::Start => 32,
            Self::Drift(c) => 40 + u64::from(c),
            Self::Number(place) => 48 + u64::from(place & 63),
            Self::Varied(v) => 128 + u64::from(v & 127),
        }
    }
}

impl Seed {
    /// Standard normal numbers of one channel, without end.
    pub fn normals(self, channel: Channel) -> impl Iterator<Item = f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(self.campaign);
        rng.set_stream((self.run << 8) | channel.index());
        std::iter::repeat_with(move || StandardNormal.sample(&mut rng))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_streams_differ_and_repeat() {
        let first = |campaign, run, channel| Seed { campaign, run }.normals(channel).take(4).collect::<Vec<f64>>();
        let a = first(1, 0, Channel::Sensor(0));
        assert_eq!(a, first(1, 0, Channel::Sensor(0)));
        let others = [
            first(2, 0, Channel::Sensor(0)),
            first(1, 1, Channel::Sensor(0)),
            first(1, 0, Channel::Sensor(1)),
            first(1, 0, Channel::Operator),
            first(1, 0, Channel::Gust(0)),
            first(1, 0, Channel::Coefficient(4)),
            first(1, 0, Channel::Start),
            first(1, 0, Channel::Varied(0)),
            first(1, 0, Channel::Varied(127)),
        ];
        for (i, b) in others.iter().enumerate() {
            assert_ne!(&a, b);
            assert!(others[..i].iter().all(|c| c != b));
        }
    }
}
