//! pid: the instruments' noise in rows of a regression. In: a record, its noise as smoothing found it. Out: the rows as draws of it change
//! them.
//!
//! A draw gives every sample of a channel the noise's standard deviation with a sign by chance: of noise only the power and the whiteness
//! matter to what is linear in it. Draw and sign hang on the record alone, and a channel with the other sign has noise of the other sign.

use super::{RunRows, process};
use crate::PidError;
use crate::smooth::{Smoother, smooth};
use windfall_model::{PerChannel, Plant, Record, Variable};

/// Draws of the noise: standard errors are known to 1/√(2·23), 15 %, which intervals allow for by Student's t.
const DRAWS: u64 = 24;

/// A run's rows under draws of the noise.
#[derive(Clone, Debug)]
pub(crate) struct Draws {
    pub(crate) rows: Vec<RunRows>,
    /// Diameters of flow from sample to sample.
    pub(crate) step: f64,
}

/// Rows of a record under draws of its noise, smoothed as `base` was.
pub(crate) fn draws(base: &RunRows, record: &Record, plant: &Plant) -> Result<Draws, PidError> {
    let smoother = Smoother::Spline { knot_s: 0.5 / base.bandwidth_hz };
    let std = smooth(record, &smoother)?.noise_std;
    let one = |draw| process(&base.name, &base.kind, &disturbed(record, &std, draw), plant, &smoother);
    let speed = base.rows.iter().map(|r| r.flow.get(Variable::Speed)).sum::<f64>() / base.rows.len() as f64;
    let step = base.interval_s * speed / plant.vehicle.diameter_m;
    Ok(Draws { rows: (0..DRAWS).map(one).collect::<Result<_, _>>()?, step })
}

fn disturbed(record: &Record, std: &PerChannel<f64>, draw: u64) -> Record {
    let mut record = record.clone();
    let seed = record.vw_m_s.iter().fold(draw, |seed, v| mixed(seed ^ v.to_bits()));
    for (c, (series, std)) in (0..).zip(record.channels_mut().into_iter().zip(std)) {
        let side = if series[0] < 0.0 { -std } else { *std };
        let mut state = mixed(seed ^ c);
        for x in series {
            state = mixed(state);
            *x += if state >> 63 == 0 { side } else { -side };
        }
    }
    record
}

/// The next number of chance (SplitMix64: Steele, Lea and Flood, OOPSLA 2014).
fn mixed(state: u64) -> u64 {
    let z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
