//! scenarios: which way up a record of a tunnel model is. In: attitudes, body to room. Out: which axis of the room and of the body point
//! down, as far as they tell.

/// Least mean cosine between two axes that are nearly parallel all the time: 37 deg, more than a model swings in a spin tunnel.
pub(super) const PARALLEL: f64 = 0.8;

/// Rows of `[columns.axes]`, and what speaks for them.
pub(super) struct AxesGuess {
    pub(super) tunnel: [String; 3],
    pub(super) body: [String; 3],
    pub(super) why: String,
}

const NAMES: [&str; 3] = ["x", "y", "z"];

fn signed(axis: usize, sign: f64) -> String {
    format!("{}{}", if sign < 0.0 { "-" } else { "" }, NAMES[axis])
}

/// The first axis is that one; the others complete it to a right-handed set, by a cyclic step where its sign is kept.
fn rows(axis: usize, sign: f64) -> [String; 3] {
    let (second, third) = ((axis + 1) % 3, (axis + 2) % 3);
    [signed(axis, sign), signed(second, 1.0), signed(third, sign)]
}

/// A model in a spin tunnel swings and rolls about the vertical: one axis of its body stays near one of the room, which is the vertical.
/// Rooms have it upward when it is their y or z, and tunnels have X downward. None where no two axes stay near each other.
pub(super) fn upright(mean_room_body: [[f64; 3]; 3]) -> Option<AxesGuess> {
    let all = (0..9).map(|k| (k / 3, k % 3, mean_room_body[k / 3][k % 3]));
    let (room, body, cosine) = all.max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()))?;
    if cosine.abs() < PARALLEL {
        return None;
    }
    let down = if room == 0 { 1.0 } else { -1.0 };
    let nose = down * cosine.signum();
    let why = format!(
        "GUESS: the body's {} stays near the room's {} (mean cosine {cosine:.2}), whose {} is down",
        NAMES[body],
        NAMES[room],
        signed(room, down)
    );
    Some(AxesGuess { tunnel: rows(room, down), body: rows(body, nose), why })
}

/// Least mean cosine between a body's axis and its way through the room for that axis to be the nose: 45 deg.
const ALONG: f64 = 0.7;

/// A body in free flight: the room's axis that is down, and of the body the one that leads the way as nose, and of the others the one that
/// stays lowest as z. `way`: mean of the body's velocity in its own axes, of length one at each instant; `down_body`: the same of down.
pub(super) fn flying(down: (usize, f64), told: &str, way: [f64; 3], down_body: [f64; 3]) -> AxesGuess {
    let largest = |v: [f64; 3], without: Option<usize>| {
        (0..3).filter(|k| Some(*k) != without).max_by(|a, b| v[*a].abs().total_cmp(&v[*b].abs())).unwrap_or(0)
    };
    let nose = largest(way, None);
    let tunnel = rows(down.0, down.1);
    if way[nose].abs() < ALONG {
        let why = format!("{told}; GUESS: body axes as the file has them, for none of them leads the way");
        return AxesGuess { tunnel, body: NAMES.map(str::to_owned), why };
    }
    let low = largest(down_body, Some(nose));
    let mut m = [[0.0; 3]; 3];
    m[0][nose] = way[nose].signum();
    m[2][low] = if down_body[low] < 0.0 { -1.0 } else { 1.0 };
    // y = z x x.
    m[1] = [m[2][1] * m[0][2] - m[2][2] * m[0][1], m[2][2] * m[0][0] - m[2][0] * m[0][2], m[2][0] * m[0][1] - m[2][1] * m[0][0]];
    let word = |row: [f64; 3]| signed(largest(row, None), row[largest(row, None)]);
    let why = format!(
        "{told}; GUESS: the body's {} leads the way (mean cosine {:.2}) and its {} is lowest (mean cosine with down {:.2})",
        word(m[0]),
        way[nose].abs(),
        word(m[2]),
        down_body[low].abs()
    );
    AxesGuess { tunnel, body: m.map(word), why }
}

/// Mean cosine of the two axes that stay nearest to each other.
pub(super) fn nearness(mean_room_body: [[f64; 3]; 3]) -> f64 {
    mean_room_body.iter().flatten().fold(0.0, |m, x| x.abs().max(m))
}

/// Mean of matrices of unit quaternions `[x, y, z, w]`; rows that are none are left out.
#[cfg(test)]
fn mean_of_quaternions(all: impl Iterator<Item = [f64; 4]>) -> [[f64; 3]; 3] {
    mean(all.filter_map(of_quaternion))
}

/// Matrix body to room of a unit quaternion `[x, y, z, w]`.
pub(super) fn of_quaternion(q: [f64; 4]) -> Option<[[f64; 3]; 3]> {
    let size = q.iter().map(|v| v * v).sum::<f64>().sqrt();
    let [x, y, z, w] = q.map(|v| v / size);
    let m = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ];
    (size - 1.0).abs().le(&0.1).then_some(m)
}

#[cfg(test)]
fn mean_of_angles(all: impl Iterator<Item = [f64; 3]>) -> [[f64; 3]; 3] {
    mean(all.map(|a| of_angles(a, "xyz")))
}

/// Matrix body to room of three angles in rad, in the order of their sequence.
pub(super) fn of_angles(angles: [f64; 3], sequence: &str) -> [[f64; 3]; 3] {
    let mut m = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for (angle, axis) in angles.into_iter().zip(sequence.bytes()) {
        let (s, c) = angle.sin_cos();
        let k = usize::from(axis.saturating_sub(b'x')).min(2);
        let (a, b) = ((k + 1) % 3, (k + 2) % 3);
        m = m.map(|row| {
            let mut out = row;
            (out[a], out[b]) = (row[a] * c + row[b] * s, row[b] * c - row[a] * s);
            out
        });
    }
    m
}

pub(super) fn mean(all: impl Iterator<Item = [[f64; 3]; 3]>) -> [[f64; 3]; 3] {
    let mut sum = [[0.0; 3]; 3];
    let mut n = 0.0_f64;
    for m in all {
        sum.iter_mut().flatten().zip(m.iter().flatten()).for_each(|(s, v)| *s += v);
        n += 1.0;
    }
    sum.map(|row| row.map(|v| v / n.max(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Determinant of signed unit rows.
    fn handed(rows: &[String; 3]) -> f64 {
        let m: Vec<[f64; 3]> = rows
            .iter()
            .map(|r| {
                let (sign, name) = r.strip_prefix('-').map_or((1.0, r.as_str()), |rest| (-1.0, rest));
                let mut v = [0.0; 3];
                v[NAMES.iter().position(|n| *n == name).expect("an axis")] = sign;
                v
            })
            .collect();
        let [a, b, c] = [m[0], m[1], m[2]];
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    }

    /// A body whose nose, x, points down in a room with z up, and that rolls: a quarter turn about y and any turn about x after it.
    #[test]
    fn exact_a_nose_down_body_in_a_room_with_z_up() {
        let half = std::f64::consts::FRAC_PI_4;
        let roll = |k: i32| 0.5 * 0.1 * f64::from(k);
        let turned = |k: i32| {
            let (s, c) = (half.sin(), half.cos());
            let (sr, cr) = (roll(k).sin(), roll(k).cos());
            // (y by a quarter turn)(x by roll), as [x, y, z, w].
            [c * sr, s * cr, -s * sr, c * cr]
        };
        let g = upright(mean_of_quaternions((0..63).map(turned))).expect("x stays near -z");
        assert_eq!((g.tunnel[0].as_str(), g.body[0].as_str()), ("-z", "x"), "{}", g.why);
        assert!((handed(&g.tunnel) - 1.0).abs() < 1e-12 && (handed(&g.body) - 1.0).abs() < 1e-12);
    }

    /// Angles of the program's own run file: X down, nose along it.
    #[test]
    fn exact_our_own_angles_and_none() {
        let small = (0..100).map(|k| [0.3 * f64::from(k), 0.1, -0.05]);
        let g = upright(mean_of_angles(small)).expect("upright");
        assert_eq!((g.tunnel, g.body), (["x", "y", "z"].map(str::to_owned), ["x", "y", "z"].map(str::to_owned)));
        let tumbling = (0..629).map(|k| [0.0, 0.01 * f64::from(k), 0.013 * f64::from(k)]);
        assert!(upright(mean_of_angles(tumbling)).is_none());
    }

    #[test]
    fn law_every_guess_is_right_handed() {
        for room in 0..3 {
            for body in 0..3 {
                for sign in [-1.0, 1.0] {
                    let mut m = [[0.0; 3]; 3];
                    m[room][body] = 0.95 * sign;
                    let g = upright(m).expect("nearly parallel");
                    for rows in [g.tunnel, g.body] {
                        assert!((handed(&rows) - 1.0).abs() < 1e-12, "{rows:?}");
                    }
                }
            }
        }
    }
}
