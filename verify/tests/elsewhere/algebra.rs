//! Vectors, matrices and modified Rodrigues parameters on plain arrays: none of the program's own.

/// Three components.
pub(crate) type V = [f64; 3];
/// Rows.
pub(crate) type M = [[f64; 3]; 3];

pub(crate) const ONE: M = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

pub(crate) fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
pub(crate) fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
pub(crate) fn add(a: V, b: V) -> V {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}
pub(crate) fn sub(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
pub(crate) fn scale(a: V, k: f64) -> V {
    [a[0] * k, a[1] * k, a[2] * k]
}
pub(crate) fn norm(a: V) -> f64 {
    dot(a, a).sqrt()
}
pub(crate) fn times(m: &M, v: V) -> V {
    [dot(m[0], v), dot(m[1], v), dot(m[2], v)]
}
pub(crate) fn transpose(m: &M) -> M {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}
/// `mᵀ v`.
pub(crate) fn back(m: &M, v: V) -> V {
    std::array::from_fn(|i| m[0][i] * v[0] + m[1][i] * v[1] + m[2][i] * v[2])
}
pub(crate) fn product(a: &M, b: &M) -> M {
    let bt = transpose(b);
    std::array::from_fn(|i| std::array::from_fn(|j| dot(a[i], bt[j])))
}
/// Inverse by cofactors.
pub(crate) fn inverse(m: &M) -> M {
    let rows = [cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])];
    let det = dot(m[0], rows[0]);
    transpose(&rows.map(|r| scale(r, 1.0 / det)))
}

/// Matrix from turned to reference axes of modified Rodrigues parameters σ = e tan(θ/4) (Schaub and Junkins 2003, eq. 3.144).
pub(crate) fn turned(s: V) -> M {
    let s2 = dot(s, s);
    let k = 1.0 / ((1.0 + s2) * (1.0 + s2));
    let tilde: M = [[0.0, -s[2], s[1]], [s[2], 0.0, -s[0]], [-s[1], s[0], 0.0]];
    let square = product(&tilde, &tilde);
    std::array::from_fn(|i| std::array::from_fn(|j| ONE[i][j] + k * (8.0 * square[i][j] + 4.0 * (1.0 - s2) * tilde[i][j])))
}
/// Rate of the parameters at body rates ω (ibid. eq. 3.152).
pub(crate) fn turning(s: V, w: V) -> V {
    let (s2, along, across) = (dot(s, s), dot(s, w), cross(s, w));
    std::array::from_fn(|i| 0.25 * ((1.0 - s2) * w[i] + 2.0 * across[i] + 2.0 * along * s[i]))
}
/// Parameters of a rotation by less than half a turn.
pub(crate) fn rodrigues(m: &M) -> V {
    let half = 0.5 * (m[0][0] + m[1][1] + m[2][2] + 1.0).max(0.0).sqrt();
    let k = 1.0 / (4.0 * half * (1.0 + half));
    [(m[2][1] - m[1][2]) * k, (m[0][2] - m[2][0]) * k, (m[1][0] - m[0][1]) * k]
}
/// Matrix body to tunnel of Euler angles x-y-z: three elementary rotations, one after the other.
pub(crate) fn attitude([x, y, z]: V) -> M {
    let about = |angle: f64, i: usize, j: usize| {
        let mut m = ONE;
        m[i][i] = angle.cos();
        m[j][j] = angle.cos();
        m[i][j] = -angle.sin();
        m[j][i] = angle.sin();
        m
    };
    product(&about(x, 1, 2), &product(&about(y, 2, 0), &about(z, 0, 1)))
}
/// Its angles, rad, roll within half a turn.
pub(crate) fn angles(m: &M) -> V {
    [(-m[1][2]).atan2(m[2][2]), m[0][2].clamp(-1.0, 1.0).asin(), (-m[0][1]).atan2(m[0][0])]
}
