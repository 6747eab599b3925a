//! model: axes, vectors and rotations. In: components. Out: typed vectors whose axes the compiler checks.
//!
//! Axes (design note "Frames"): **tunnel** X down, Y and Z horizontal; **body** x out of the nose (down in flight), origin at
//! the c.m.; **ned** the north-east-down axes of the thesis' eq. B.67, or of a place over a planet; **inertial** x through the
//! equator at longitude 0 when a flight starts, z through the north pole of a planet, not turning with it. A rotation `r_to_from` maps components in `from` to
//! components in `to`, so letters that touch cancel: `r_tunnel_body * v_body` is in tunnel axes.
//!
//! Registered words for names: quantities `p v a w f m r i`, points `cm origin hook ring air`, axes `tunnel body ned inertial`,
//! points of a planet `ground`.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use std::marker::PhantomData;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A set of axes. Implemented by [`Tunnel`], [`Body`], [`Ned`] and [`Inertial`] only.
pub trait Axes: Copy + Default + std::fmt::Debug + PartialEq + Send + Sync + 'static {}
/// Tunnel axes: X down, Y and Z horizontal, fixed to the test section.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tunnel;
/// Body axes: x out of the nose, y along the outrigger opposite the excavation arm, z completing a right-handed set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Body;
/// North-east-down axes: of the thesis' simulation, eq. B.67 (X_sim = Y, Y_sim = Z, Z_sim = X of the tunnel), or of a place over a
/// planet, down along the normal of its ellipsoid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ned;
/// Axes through a planet's centre that do not turn: z through its north pole, x through the equator at longitude 0 at the time 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inertial;
impl Axes for Tunnel {}
impl Axes for Body {}
impl Axes for Ned {}
impl Axes for Inertial {}

/// A vector with its axes in the type; the unit is in the name of the variable that holds it (SI).
///
/// ```
/// use windfall_model::frames::{Body, Vec3};
///
/// let arm: Vec3<Body> = Vec3::new(0.0, 0.0, 0.1);
/// let force: Vec3<Body> = Vec3::new(2.0, 0.0, 0.0);
/// assert_eq!(arm.cross(force).to_array(), [0.0, 0.2, 0.0]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3<A: Axes> {
    /// Components along the axes' x, y and z.
    pub xyz: Vector3<f64>,
    axes: PhantomData<A>,
}

impl<A: Axes> Vec3<A> {
    /// Vector from its components.
    #[must_use]
    pub const fn new(x: f64, y: f64, z: f64) -> Self {
        Self { xyz: Vector3::new(x, y, z), axes: PhantomData }
    }
    /// Zero vector.
    #[must_use]
    pub const fn zero() -> Self {
        Self::new(0.0, 0.0, 0.0)
    }
    /// Vector from an array `[x, y, z]`.
    #[must_use]
    pub const fn from_array(c: [f64; 3]) -> Self {
        Self::new(c[0], c[1], c[2])
    }
    /// Components as an array `[x, y, z]`.
    #[must_use]
    pub fn to_array(self) -> [f64; 3] {
        [self.xyz.x, self.xyz.y, self.xyz.z]
    }
    /// First component.
    #[must_use]
    pub fn x(self) -> f64 {
        self.xyz.x
    }
    /// Second component.
    #[must_use]
    pub fn y(self) -> f64 {
        self.xyz.y
    }
    /// Third component.
    #[must_use]
    pub fn z(self) -> f64 {
        self.xyz.z
    }
    /// Scalar product.
    #[must_use]
    pub fn dot(self, other: Self) -> f64 {
        self.xyz.dot(&other.xyz)
    }
    /// Vector product `self × other`.
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        self.xyz.cross(&other.xyz).into()
    }
    /// Euclidean length.
    #[must_use]
    pub fn norm(self) -> f64 {
        self.xyz.norm()
    }
    /// True when no component is NaN or infinite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.xyz.iter().all(|c| c.is_finite())
    }
}

impl<A: Axes> From<Vector3<f64>> for Vec3<A> {
    fn from(xyz: Vector3<f64>) -> Self {
        Self { xyz, axes: PhantomData }
    }
}
impl<A: Axes> Add for Vec3<A> {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        (self.xyz + o.xyz).into()
    }
}
impl<A: Axes> AddAssign for Vec3<A> {
    fn add_assign(&mut self, o: Self) {
        self.xyz += o.xyz;
    }
}
impl<A: Axes> Sub for Vec3<A> {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        (self.xyz - o.xyz).into()
    }
}
impl<A: Axes> Neg for Vec3<A> {
    type Output = Self;
    fn neg(self) -> Self {
        (-self.xyz).into()
    }
}
impl<A: Axes> Mul<f64> for Vec3<A> {
    type Output = Self;
    fn mul(self, s: f64) -> Self {
        (self.xyz * s).into()
    }
}

/// Proper rotation that maps components in `From` axes to components in `To` axes.
///
/// ```
/// use windfall_model::frames::{Body, Rotation, Tunnel, Vec3};
///
/// // A quarter turn about x takes body y to tunnel Z, and its inverse takes it back.
/// let half = std::f64::consts::FRAC_1_SQRT_2;
/// let r_tunnel_body: Rotation<Tunnel, Body> = Rotation::from_quaternion([half, half, 0.0, 0.0]);
/// let y_body: Vec3<Body> = Vec3::new(0.0, 1.0, 0.0);
/// let y_tunnel: Vec3<Tunnel> = r_tunnel_body * y_body;
/// assert!((y_tunnel - Vec3::new(0.0, 0.0, 1.0)).norm() < 1e-15);
/// assert!((r_tunnel_body.inverse() * y_tunnel - y_body).norm() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation<To: Axes, From: Axes> {
    /// Direction cosine matrix.
    pub matrix: Matrix3<f64>,
    axes: PhantomData<(To, From)>,
}

impl<To: Axes, From: Axes> Rotation<To, From> {
    /// Rotation from a direction cosine matrix, which the caller guarantees to be orthonormal.
    #[must_use]
    pub fn from_matrix(matrix: Matrix3<f64>) -> Self {
        Self { matrix, axes: PhantomData }
    }
    /// Rotation from the rows of a direction cosine matrix, which the caller guarantees to be orthonormal.
    #[must_use]
    pub fn from_rows(rows: [[f64; 3]; 3]) -> Self {
        Self::from_matrix(Matrix3::from_fn(|i, j| rows[i][j]))
    }
    /// Rotation from a quaternion `[w, x, y, z]`; it need not be of unit length (a simulator's drifts by its tolerance).
    #[must_use]
    pub fn from_quaternion(q: [f64; 4]) -> Self {
        let [w, x, y, z] = q;
        let s = 2.0 / (w * w + x * x + y * y + z * z);
        #[rustfmt::skip]
        let m = Matrix3::new(
            1.0 - s * (y * y + z * z), s * (x * y - w * z),       s * (x * z + w * y),
            s * (x * y + w * z),       1.0 - s * (x * x + z * z), s * (y * z - w * x),
            s * (x * z - w * y),       s * (y * z + w * x),       1.0 - s * (x * x + y * y),
        );
        Self::from_matrix(m)
    }
    /// Unit quaternion `[w, x, y, z]` with `w ≥ 0`.
    #[must_use]
    pub fn to_quaternion(self) -> [f64; 4] {
        let q = shepperd(&self.matrix);
        let s = if q.w < 0.0 { -1.0 } else { 1.0 };
        [s * q.w, s * q.i, s * q.j, s * q.k]
    }
    /// The rotation back.
    #[must_use]
    pub fn inverse(self) -> Rotation<From, To> {
        Rotation::from_matrix(self.matrix.transpose())
    }
    /// Rotation angle between two attitudes, rad, in [0, π].
    #[must_use]
    pub fn angle_to(self, other: Self) -> f64 {
        let d = self.matrix.transpose() * other.matrix;
        let sine = Vector3::new(d[(2, 1)] - d[(1, 2)], d[(0, 2)] - d[(2, 0)], d[(1, 0)] - d[(0, 1)]).norm();
        sine.atan2(d.trace() - 1.0)
    }
}

/// Quaternion of a direction cosine matrix (Shepperd 1978: the largest of four pivots, so that nothing cancels).
fn shepperd(m: &Matrix3<f64>) -> UnitQuaternion<f64> {
    let (t, a, b, c) = (m.trace(), m[(0, 0)], m[(1, 1)], m[(2, 2)]);
    let (yz, zx, xy) = (m[(2, 1)] - m[(1, 2)], m[(0, 2)] - m[(2, 0)], m[(1, 0)] - m[(0, 1)]);
    let (syz, szx, sxy) = (m[(2, 1)] + m[(1, 2)], m[(0, 2)] + m[(2, 0)], m[(1, 0)] + m[(0, 1)]);
    let q = if t >= a.max(b).max(c) {
        Quaternion::new(1.0 + t, yz, zx, xy)
    } else if a >= b.max(c) {
        Quaternion::new(yz, 1.0 + 2.0 * a - t, sxy, szx)
    } else if b >= c {
        Quaternion::new(zx, sxy, 1.0 + 2.0 * b - t, syz)
    } else {
        Quaternion::new(xy, szx, syz, 1.0 + 2.0 * c - t)
    };
    UnitQuaternion::new_normalize(q)
}

impl<To: Axes, From: Axes> Mul<Vec3<From>> for Rotation<To, From> {
    type Output = Vec3<To>;
    fn mul(self, v: Vec3<From>) -> Vec3<To> {
        (self.matrix * v.xyz).into()
    }
}
impl<To: Axes, Mid: Axes, From: Axes> Mul<Rotation<Mid, From>> for Rotation<To, Mid> {
    type Output = Rotation<To, From>;
    fn mul(self, o: Rotation<Mid, From>) -> Rotation<To, From> {
        Rotation::from_matrix(self.matrix * o.matrix)
    }
}

/// Euler angles of the tunnel's motion capture, rad: sequence x-y-z, `T = Rx·Ry·Rz`, body to tunnel (thesis eqs B.13-B.14).
/// Roll `rx` may pass ±π (unwrapped in records); `ry` in [−π/2, π/2].
///
/// ```
/// use windfall_model::frames::{EulerXyz, Vec3};
///
/// // Pitched by 10° alone, the nose leans against tunnel Z.
/// let attitude = EulerXyz { ry_rad: 10_f64.to_radians(), ..EulerXyz::default() };
/// let nose_tunnel = attitude.r_tunnel_body() * Vec3::new(1.0, 0.0, 0.0);
/// assert!((nose_tunnel.z() + 10_f64.to_radians().sin()).abs() < 1e-15);
/// assert!((attitude.off_vertical_rad().to_degrees() - 10.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EulerXyz {
    /// Roll R_x.
    pub rx_rad: f64,
    /// Pitch R_y.
    pub ry_rad: f64,
    /// Yaw R_z.
    pub rz_rad: f64,
}

impl EulerXyz {
    /// Body-to-tunnel rotation of these angles (thesis eq. B.14).
    #[must_use]
    pub fn r_tunnel_body(self) -> Rotation<Tunnel, Body> {
        let (sx, cx) = self.rx_rad.sin_cos();
        let (sy, cy) = self.ry_rad.sin_cos();
        let (sz, cz) = self.rz_rad.sin_cos();
        #[rustfmt::skip]
        let m = Matrix3::new(
            cz * cy,                -sz * cy,                sy,
            cz * sy * sx + sz * cx, cz * cx - sz * sy * sx, -cy * sx,
            sz * sx - cz * sy * cx, sz * sy * cx + cz * sx,  cy * cx,
        );
        Rotation::from_matrix(m)
    }
    /// Angles of a body-to-tunnel rotation; `rx`, `rz` in (−π, π]. Singular only at `ry = ±π/2` (nose horizontal).
    #[must_use]
    pub fn from_rotation(r_tunnel_body: Rotation<Tunnel, Body>) -> Self {
        let m = &r_tunnel_body.matrix;
        Self {
            rx_rad: (-m[(1, 2)]).atan2(m[(2, 2)]),
            ry_rad: m[(0, 2)].atan2(m[(0, 0)].hypot(m[(0, 1)])),
            rz_rad: (-m[(0, 1)]).atan2(m[(0, 0)]),
        }
    }
    /// Off-vertical angle Θ, rad, in [0, π] (thesis eq. 5.1).
    #[must_use]
    pub fn off_vertical_rad(self) -> f64 {
        (self.ry_rad.cos() * self.rz_rad.cos()).clamp(-1.0, 1.0).acos()
    }
}

/// Standard aerospace Euler angles (yaw-pitch-roll) from the north-east-down axes of eq. B.67, rad.
///
/// ```
/// use windfall_model::frames::{EulerNed, EulerXyz};
///
/// // Pitched by 10° from nose down, the aerospace pitch is −80°; back again it is the same attitude.
/// let e = EulerXyz { ry_rad: 10_f64.to_radians(), ..EulerXyz::default() };
/// let ned = EulerNed::from_xyz(e);
/// assert!((ned.theta_rad.to_degrees() + 80.0).abs() < 1e-12);
/// assert!(ned.to_xyz().r_tunnel_body().angle_to(e.r_tunnel_body()) < 1e-7);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EulerNed {
    /// Yaw ψ in (−π, π].
    pub psi_rad: f64,
    /// Pitch θ in [−π/2, π/2]; −π/2 in undisturbed flight (nose down), where ψ and φ are singular.
    pub theta_rad: f64,
    /// Roll φ in (−π, π].
    pub phi_rad: f64,
}

impl EulerNed {
    /// Thesis eqs B.68-B.70 (B.70 with both signs kept, so that the quadrant is right).
    #[must_use]
    pub fn from_xyz(e: EulerXyz) -> Self {
        let (sx, cx) = e.rx_rad.sin_cos();
        let (sy, cy) = e.ry_rad.sin_cos();
        let (sz, cz) = e.rz_rad.sin_cos();
        Self {
            psi_rad: (sz * sx - cz * sy * cx).atan2(cz * sy * sx + sz * cx),
            theta_rad: (-cz * cy).clamp(-1.0, 1.0).asin(),
            phi_rad: (-sz * cy).atan2(sy),
        }
    }
    /// Thesis eqs B.71-B.73; B.73 as corrected by the errata: `atan2(−sin φ cos θ, −sin θ)`.
    #[must_use]
    pub fn to_xyz(self) -> EulerXyz {
        let (sf, cf) = self.phi_rad.sin_cos();
        let (st, ct) = self.theta_rad.sin_cos();
        let (sp, cp) = self.psi_rad.sin_cos();
        EulerXyz {
            rx_rad: (-cf * st * cp - sf * sp).atan2(cf * st * sp - sf * cp),
            ry_rad: (cf * ct).clamp(-1.0, 1.0).asin(),
            rz_rad: (-sf * ct).atan2(-st),
        }
    }
}

/// Rotation from tunnel to north-east-down axes (eq. B.67).
#[must_use]
pub fn r_ned_tunnel() -> Rotation<Ned, Tunnel> {
    Rotation::from_matrix(Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0))
}
