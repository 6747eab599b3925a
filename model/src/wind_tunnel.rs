//! model: static coefficients measured elsewhere, on a balance in a wind tunnel. In: the declaring file. Out: points that identified
//! curves are held against; nothing is fitted to them.

use crate::aero::Coefficient;

/// One coefficient over the total angle of attack, as one wind-tunnel test has it.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticPoints {
    /// Name of the test.
    pub test: String,
    /// C_A, C_N or C_m, about the geometric origin, the flow from below (φ = 0).
    pub coefficient: Coefficient,
    /// Points in the order of their angles.
    pub points: Vec<StaticPoint>,
}

/// One point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticPoint {
    /// Total angle of attack, rad.
    pub alpha_t_rad: f64,
    /// Measured value, dimensionless.
    pub value: f64,
    /// Its standard uncertainty (1 σ); none where the test states none.
    pub std: Option<f64>,
}

impl StaticPoints {
    /// C_m about the geometric origin of points whose moments are about a point of the body's axis, `over_d` reference diameters from the
    /// origin (positive: toward the nose): M_O = M_P + r × F with F = −(C_A, 0, C_N), so that C_m,O = C_m,P + (x/d) C_N. Points of C_N at
    /// the same angles are needed; none where one is missing.
    #[must_use]
    pub fn about_origin(&self, normal: &Self, over_d: f64) -> Option<Self> {
        let one = |p: &StaticPoint| {
            let force = normal.points.iter().find(|n| (n.alpha_t_rad - p.alpha_t_rad).abs() < 1e-9)?;
            let std = p.std.map(|s| s.hypot(over_d * force.std.unwrap_or(0.0)));
            Some(StaticPoint { value: p.value + over_d * force.value, std, ..*p })
        };
        Some(Self { points: self.points.iter().map(one).collect::<Option<_>>()?, ..self.clone() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// C_N = 1.2 acts at the origin: about a point half a diameter toward the nose its moment is −0.6, and about the origin none.
    #[test]
    fn exact_moment_about_the_origin() {
        let of = |coefficient, value, std| StaticPoints {
            test: "t".to_owned(),
            coefficient,
            points: vec![StaticPoint { alpha_t_rad: 0.2, value, std: Some(std) }],
        };
        let (normal, moment) = (of(Coefficient::CN, 1.2, 0.04), of(Coefficient::Cm, -0.6, 0.015));
        let p = moment.about_origin(&normal, 0.5).expect("the same angle").points[0];
        assert!(p.value.abs() < 1e-15 && (p.std.expect("stated") - 0.025).abs() < 1e-15);
        let elsewhere = StaticPoints { points: vec![StaticPoint { alpha_t_rad: 0.3, ..normal.points[0] }], ..normal };
        assert!(moment.about_origin(&elsewhere, 0.5).is_none());
    }
}
