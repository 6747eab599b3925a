//! scenarios: attitudes of run files. In: quaternions or three angles of any sequence, about the owner's axes. Out: R_x, R_y, R_z of ours.
//!
//! A rotation matrix here takes components in body axes to components in the axes of the room: v_room = R v_body. Ours is T = Rx Ry Rz.

use crate::column_unit::ColumnUnit;
use crate::columns::Columns;
use windfall_model::frames::{Body, Rotation, Tunnel};

type Matrix = [[f64; 3]; 3];
const ONE: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The twelve sequences, each angle about an axis of the body as the one before has left it.
pub(crate) const SEQUENCES: [&str; 12] = ["xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"];
/// Largest difference of a quaternion's length from one.
const LENGTH: f64 = 0.01;
/// More quaternions than this fraction that have another length are none.
const MOST: f64 = 0.05;

/// For our X, Y, Z (or x, y, z of the body): which of the owner's axes, and its sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OwnAxes {
    pub(super) room: Matrix,
    pub(super) body: Matrix,
}

impl Default for OwnAxes {
    fn default() -> Self {
        Self { room: ONE, body: ONE }
    }
}

impl OwnAxes {
    /// Row of a word such as `-z`.
    pub(super) fn row(word: &str) -> Option<[f64; 3]> {
        let (sign, letter) = match word.strip_prefix('-') {
            Some(rest) => (-1.0, rest),
            None => (1.0, word.strip_prefix('+').unwrap_or(word)),
        };
        let axis = ["x", "y", "z"].iter().position(|a| a.eq_ignore_ascii_case(letter))?;
        let mut row = [0.0; 3];
        row[axis] = sign;
        Some(row)
    }
    /// Positions along the owner's axes as positions in tunnel axes.
    pub(super) fn tunnel(&self, position: [Vec<f64>; 3]) -> [Vec<f64>; 3] {
        self.room.map(|row| {
            let axis = row.iter().position(|x| x.abs() > 0.5).unwrap_or(0);
            position[axis].iter().map(|x| row[axis] * x).collect()
        })
    }
}

pub(super) fn determinant(m: &Matrix) -> f64 {
    m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j]))
}

fn transposed(m: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

/// What the columns of an attitude are.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum GivenAttitude {
    /// Scalar part, then x, y, z.
    Quaternion([String; 4]),
    /// Angles in the order of their axes (0 = x).
    Euler { angles: [String; 3], axes: [usize; 3], unit: ColumnUnit },
}

/// `[columns.attitude]`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Attitude {
    pub(super) given: GivenAttitude,
    /// The rotation takes components in the axes of the room to body axes.
    pub(super) to_body: bool,
}

/// An attitude row by row: our three angles in deg, and the quaternion tunnel from body, scalar first, which has no singular attitude.
#[derive(Default)]
pub(super) struct Turned {
    pub(super) angles_deg: [Vec<f64>; 3],
    pub(super) quaternion: [Vec<f64>; 4],
}

/// Our attitude and what to note; or value, what is wrong and what to try.
type Attitudes = Result<(Turned, Option<String>), (String, String, String)>;

impl Attitude {
    pub(super) fn columns(&self) -> &[String] {
        match &self.given {
            GivenAttitude::Quaternion(names) => names,
            GivenAttitude::Euler { angles, .. } => angles,
        }
    }
    pub(super) fn turned(&self, file: &Columns, axes: OwnAxes) -> Attitudes {
        let column = |name: &String| file.get(name).unwrap_or_default();
        let mut out = Turned::default();
        let mut long = 0;
        for i in 0..file.rows() {
            let rotation = match &self.given {
                GivenAttitude::Quaternion(names) => {
                    let q = [0, 1, 2, 3].map(|k| column(&names[k]).get(i).copied().unwrap_or(f64::NAN));
                    let of = of_quaternion(q);
                    long += usize::from(of.is_none() && q.iter().all(|x| x.is_finite()));
                    of
                }
                GivenAttitude::Euler { angles, axes, unit } => {
                    let angle = |k: usize| column(&angles[k]).get(i).map_or(f64::NAN, |x| unit.ours(*x).to_radians());
                    Some(of_euler([angle(0), angle(1), angle(2)], *axes))
                }
            };
            let rotation = rotation.unwrap_or([[f64::NAN; 3]; 3]);
            let rotation = if self.to_body { transposed(&rotation) } else { rotation };
            out.push(&product(&product(&axes.room, &rotation), &transposed(&axes.body)));
        }
        if long as f64 > MOST * file.rows() as f64 {
            let what = format!("{long} of {} quaternions differ in length from one by more than {LENGTH}", file.rows());
            return Err((self.columns().join(", "), what, "the four columns of a unit quaternion".to_owned()));
        }
        let note = (long > 0).then(|| format!("{long} quaternions of another length than one taken as not measured"));
        Ok((out, note))
    }
}

impl Turned {
    /// Adds a row: the matrix tunnel from body, NaN where there is none.
    fn push(&mut self, t: &Matrix) {
        self.angles_deg.iter_mut().zip(ours_deg(t)).for_each(|(c, a)| c.push(a));
        let finite = t.iter().flatten().all(|x| x.is_finite());
        let q = if finite { Rotation::<Tunnel, Body>::from_rows(*t).to_quaternion() } else { [f64::NAN; 4] };
        self.quaternion.iter_mut().zip(q).for_each(|(c, x)| c.push(x));
    }
    /// Of angles of our own sequence, in deg, about other axes.
    pub(super) fn of_ours([x, y, z]: [Vec<f64>; 3], axes: OwnAxes) -> Self {
        let mut out = Self::default();
        for ((x, y), z) in x.into_iter().zip(y).zip(z) {
            let rotation = of_euler([x, y, z].map(f64::to_radians), [0, 1, 2]);
            out.push(&product(&product(&axes.room, &rotation), &transposed(&axes.body)));
        }
        out
    }
}

/// Rotation by `angle` about axis 0, 1 or 2, right-handed.
fn about(axis: usize, angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut m = [[0.0; 3]; 3];
    m[axis][axis] = 1.0;
    (m[j][j], m[j][k], m[k][j], m[k][k]) = (c, -s, s, c);
    m
}

fn of_euler(angles: [f64; 3], axes: [usize; 3]) -> Matrix {
    let [a, b, c] = [0, 1, 2].map(|k| about(axes[k], angles[k]));
    product(&product(&a, &b), &c)
}

/// Rotation of a quaternion, its length taken out; `None` when that is not near one.
fn of_quaternion([w, x, y, z]: [f64; 4]) -> Option<Matrix> {
    let length = (w * w + x * x + y * y + z * z).sqrt();
    if length.is_nan() || (length - 1.0).abs() > LENGTH {
        return None;
    }
    let [w, x, y, z] = [w, x, y, z].map(|q| q / length);
    Some([
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ])
}

/// R_x, R_y, R_z in deg of T = Rx Ry Rz; R_y within 90 deg.
fn ours_deg(t: &Matrix) -> [f64; 3] {
    let y = t[0][2].atan2(t[0][0].hypot(t[0][1]));
    [(-t[1][2]).atan2(t[2][2]), y, (-t[0][1]).atan2(t[0][0])].map(f64::to_degrees)
}
