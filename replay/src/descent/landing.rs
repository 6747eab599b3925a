//! replay: where descents come down. In: ways over the ground. Out: the scatter's ellipse, and some of the places.

use nalgebra::{Matrix2, SymmetricEigen, Vector2};
use serde::{Deserialize, Serialize};

/// Places that are kept one by one.
const KEPT: usize = 500;
/// χ² of two degrees of freedom that 95 % stay under: −2 ln 0.05.
const CHI2_95: f64 = 5.991_464_547_107_98;

/// Places of touch-down from the start, in the horizontal plane of the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LandingScatter {
    /// Mean way toward north and east, m.
    pub mean_m: [f64; 2],
    /// Half axes of the ellipse that holds 95 % of a normal scatter of this covariance, m, the longer first.
    pub half_axes95_m: [f64; 2],
    /// Heading of the longer axis from north over east, deg, 0 to 180.
    pub heading_deg: f64,
    /// Share of the descents inside it: near 0.95 where the scatter is normal.
    pub inside: f64,
    /// Radius about the mean that holds half of the descents (CEP), m.
    pub half_within_m: f64,
    /// North and east of the first descents that landed, m.
    pub places_m: Vec<[f64; 2]>,
}

/// The scatter of places of touch-down (way toward north and east, m); none of fewer than three.
pub(super) fn scatter(places: &[[f64; 2]]) -> Option<LandingScatter> {
    let n = places.len() as f64;
    if places.len() < 3 {
        return None;
    }
    let mean = places.iter().fold(Vector2::zeros(), |s, p| s + Vector2::from(*p)) / n;
    let from_mean: Vec<Vector2<f64>> = places.iter().map(|p| Vector2::from(*p) - mean).collect();
    let covariance: Matrix2<f64> = from_mean.iter().fold(Matrix2::zeros(), |s, d| s + d * d.transpose()) / (n - 1.0);
    let eigen = SymmetricEigen::new(covariance);
    let long = usize::from(eigen.eigenvalues[1] > eigen.eigenvalues[0]);
    let half = |k: usize| (CHI2_95 * eigen.eigenvalues[k].max(0.0)).sqrt();
    let along = eigen.eigenvectors.column(long);
    let inverse = covariance.try_inverse();
    let inside = inverse.map_or(0, |i| from_mean.iter().filter(|d| (d.transpose() * i * *d)[0] <= CHI2_95).count());
    let mut ranges: Vec<f64> = from_mean.iter().map(nalgebra::Matrix::norm).collect();
    ranges.sort_by(f64::total_cmp);
    Some(LandingScatter {
        mean_m: mean.into(),
        half_axes95_m: [half(long), half(1 - long)],
        heading_deg: along[1].atan2(along[0]).to_degrees().rem_euclid(180.0),
        inside: inside as f64 / n,
        half_within_m: crate::quantile::quantile(&ranges, 0.5),
        places_m: places.iter().take(KEPT).copied().collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight places on an ellipse of half axes 3 and 1 whose longer axis heads 30°, 90°, or 120°: covariance (8/7)·(9, 1)/2 along the axes.
    #[test]
    fn exact_ellipse() {
        let half = |a: f64| (CHI2_95 * 8.0 / 7.0 * a * a / 2.0).sqrt();
        let places = |heading_deg: f64| -> Vec<[f64; 2]> {
            let (s, c) = heading_deg.to_radians().sin_cos();
            let place = |k: u32| {
                let (y, x) = (f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos();
                [10.0 + 3.0 * x * c - y * s, -4.0 + 3.0 * x * s + y * c]
            };
            (0..8).map(place).collect()
        };
        for heading_deg in [30.0, 90.0, 120.0] {
            let found = scatter(&places(heading_deg)).expect("eight");
            assert!((found.mean_m[0] - 10.0).abs() < 1e-12 && (found.mean_m[1] + 4.0).abs() < 1e-12);
            assert!((found.half_axes95_m[0] - half(3.0)).abs() < 1e-9 && (found.half_axes95_m[1] - half(1.0)).abs() < 1e-9);
            assert!((found.heading_deg - heading_deg).abs() < 1e-9 && (found.inside - 1.0).abs() < 1e-15);
        }
        assert!(scatter(&places(30.0)[..2]).is_none());
    }
}
