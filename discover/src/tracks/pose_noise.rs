//! discover: what sensors' noise alone leaves of poses flown again. In: evidence and a plant. Out: the rms to expect of positions and attitudes.
//!
//! Where the initial state is that of the record's first samples, their noise grows along the flight, and most of what is left may be that.

use super::evidence::TrackEvidence;
use super::track::Track;
use nalgebra::DVector;
use windfall_model::Plant;

impl TrackEvidence {
    /// Root mean squares as [`TrackEvidence::pose_rms`] has them, as sensors' noise as stated would make them were the plant right: in the samples,
    /// and in the initial state.
    #[must_use]
    pub fn pose_rms_of_noise(&self, plant: &Plant) -> [f64; 2] {
        let of_track = |t: &Track| -> Option<[f64; 3]> {
            let n = t.t_s.len();
            let variances = self.sample_variances(t, plant)?;
            Some([variances.rows(0, 3 * n).sum(), variances.rows(3 * n, 3 * n).sum(), n as f64])
        };
        let all: Vec<_> = self.tracks.iter().map(of_track).collect();
        let sum = |k: usize| all.iter().map(|x| x.map_or(f64::NAN, |s| s[k])).sum::<f64>();
        [0, 1].map(|k| (sum(k) / sum(2)).sqrt())
    }

    /// Variance of every number of a track's residual.
    fn sample_variances(&self, t: &Track, plant: &Plant) -> Option<DVector<f64>> {
        let n = t.t_s.len();
        let mut variances = DVector::from_fn(6 * n, |i, _| self.white_variance(i / n));
        if !t.given {
            // A state of least squares takes its own share of the noise.
            let taken = |i: usize| t.state_basis.row(i).norm_squared();
            variances.iter_mut().enumerate().for_each(|(i, v)| *v *= 1.0 - taken(i));
            return Some(variances);
        }
        let (theta, of_noise) = t.given_start()?;
        let (_, jacobian) = t.linearised(&t.own(plant), &theta)?;
        for a in 0..6 {
            let (place, rate) = (jacobian.column(a), jacobian.column(6 + a));
            let variance = self.white_variance(a);
            for (i, v) in variances.iter_mut().enumerate() {
                let (p, r) = (place[i], rate[i]);
                *v += variance * (p * p * of_noise[(0, 0)] + 2.0 * p * r * of_noise[(0, 1)] + r * r * of_noise[(1, 1)]);
            }
        }
        Some(variances)
    }
}
