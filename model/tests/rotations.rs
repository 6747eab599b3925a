//! model tests: algebra of rotations over random ones. In: quaternions and angles drawn. Out: identities to rounding.

use proptest::prelude::*;
use windfall_model::frames::{Body, EulerNed, EulerXyz, Ned, Rotation, Tunnel, Vec3};

/// A dozen operations on numbers of size one: each rounds by 1.1e-16.
const ROUNDING: f64 = 1e-14;

prop_compose! {
    /// A unit quaternion of any direction.
    fn quaternion()(q in prop::array::uniform4(-1.0_f64..1.0).prop_filter("not near zero", |q| q.iter().map(|c| c * c).sum::<f64>() > 0.01)) -> [f64; 4] {
        let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        q.map(|c| c / norm)
    }
}

fn near<A: windfall_model::frames::Axes>(a: Vec3<A>, b: Vec3<A>) -> bool {
    (a - b).norm() <= ROUNDING * (1.0 + a.norm())
}

proptest! {
    #[test]
    fn law_rotations_are_a_group_that_keeps_lengths_and_angles(a in quaternion(), b in quaternion(), v in prop::array::uniform3(-1.0_f64..1.0), w in prop::array::uniform3(-1.0_f64..1.0)) {
        let (outer, inner) = (Rotation::<Ned, Tunnel>::from_quaternion(a), Rotation::<Tunnel, Body>::from_quaternion(b));
        let (v, w) = (Vec3::<Body>::from_array(v), Vec3::<Body>::from_array(w));
        prop_assert!(near((outer * inner) * v, outer * (inner * v)), "composition");
        prop_assert!(near(inner.inverse() * (inner * v), v), "inverse");
        prop_assert!(((inner * v).dot(inner * w) - v.dot(w)).abs() <= ROUNDING, "angles");
        prop_assert!(near((inner * v).cross(inner * w), inner * v.cross(w)), "handedness");
        prop_assert!((outer * inner).inverse().angle_to(inner.inverse() * outer.inverse()) < 1e-7, "inverse of a product");
    }

    #[test]
    fn law_a_turn_is_by_its_angle_and_a_quaternion_of_any_length(q in quaternion(), axis in quaternion(), angle in 0.0_f64..3.1, length in 0.1_f64..10.0) {
        let r = Rotation::<Tunnel, Body>::from_quaternion(q);
        let (n, (s, c)) = (axis[1].hypot(axis[2]).hypot(axis[3]), (0.5 * angle).sin_cos());
        prop_assume!(n > 0.01);
        let turn = Rotation::<Body, Body>::from_quaternion([c, s * axis[1] / n, s * axis[2] / n, s * axis[3] / n]);
        prop_assert!((r.angle_to(r * turn) - angle).abs() < 10.0 * ROUNDING, "{} {angle}", r.angle_to(r * turn));
        let long = Rotation::<Tunnel, Body>::from_quaternion(q.map(|x| x * length));
        prop_assert!((long.matrix - r.matrix).norm() < ROUNDING, "{long:?} {r:?}");
        let e = EulerXyz::from_rotation(r);
        let down = r * Vec3::new(1.0, 0.0, 0.0);
        prop_assert!((e.off_vertical_rad().cos() - down.x()).abs() < 10.0 * ROUNDING, "{e:?}");
    }

    #[test]
    fn law_quaternions_and_angles_round_trip(q in quaternion(), rx in -3.1_f64..3.1, ry in -1.5_f64..1.5, rz in -1.5_f64..1.5) {
        let r = Rotation::<Tunnel, Body>::from_quaternion(q);
        let again = r.to_quaternion();
        let sign = q.iter().zip(again).map(|(a, b)| a * b).sum::<f64>().signum();
        prop_assert!(q.iter().zip(again).all(|(a, b)| (a - sign * b).abs() < ROUNDING), "q or -q");
        prop_assert!(again[0] >= 0.0, "of the two the one of the smaller angle");
        let e = EulerXyz { rx_rad: rx, ry_rad: ry, rz_rad: rz };
        let back = EulerXyz::from_rotation(e.r_tunnel_body());
        // Away from |R_y| = 90 deg by 0.07 rad, angles lose a factor of 1/cos R_y = 14.
        for (x, y) in [(rx, back.rx_rad), (ry, back.ry_rad), (rz, back.rz_rad)] {
            prop_assert!((x - y).abs() < 20.0 * ROUNDING, "{e:?} {back:?}");
        }
        let ned = EulerNed::from_xyz(e).to_xyz();
        prop_assert!(ned.r_tunnel_body().angle_to(e.r_tunnel_body()) < 1e-6, "{e:?} {ned:?}");
    }
}
