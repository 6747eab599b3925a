//! scenarios: which way up a record of a tunnel model is. In: attitudes, body to room. Out: which axis of the room and of the body point
//! down, as far as they tell.

/// Least mean cosine between two axes that are nearly parallel all the time: 37 deg, more than a model swings in a spin tunnel.
const PARALLEL: f64 = 0.8;

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

/// Mean of matrices of unit quaternions `[x, y, z, w]`; rows that are none are left out.
pub(super) fn mean_of_quaternions(all: impl Iterator<Item = [f64; 4]>) -> [[f64; 3]; 3] {
    mean(all.filter_map(|q| {
        let size = q.iter().map(|v| v * v).sum::<f64>().sqrt();
        let [x, y, z, w] = q.map(|v| v / size);
        let m = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ];
        (size - 1.0).abs().le(&0.1).then_some(m)
    }))
}

/// Mean of `Rx Ry Rz` of angles in rad.
pub(super) fn mean_of_angles(all: impl Iterator<Item = [f64; 3]>) -> [[f64; 3]; 3] {
    mean(all.filter(|a| a.iter().all(|v| v.is_finite())).map(|angles| {
        let [(sa, ca), (sb, cb), (sc, cc)] = angles.map(f64::sin_cos);
        [
            [cb * cc, -cb * sc, sb],
            [ca * sc + sa * sb * cc, ca * cc - sa * sb * sc, -sa * cb],
            [sa * sc - ca * sb * cc, sa * cc + ca * sb * sc, ca * cb],
        ]
    }))
}

fn mean(all: impl Iterator<Item = [[f64; 3]; 3]>) -> [[f64; 3]; 3] {
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
