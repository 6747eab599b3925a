//! pid: a record whose room and body axes are both others. In: records. Out: each record read otherwise, where the nose could then point down.
//!
//! The room's axis that is down and the body's axis that is out of the nose are each one of six. A model in a spin tunnel keeps its nose near
//! the vertical, so that of the 36 pairs those remain whose two axes stay near each other; right-handed axes about them are taken in turn,
//! since turns about the vertical change nothing and those about the nose little. An attitude that is turned the other way, read through axes
//! that are right, is one of 24 others as well: the axes stand on both of its sides. Attitudes are turned sample by sample: angles of the
//! wrong axes may pass through the attitude at which they are not defined, and have no rates there.

use super::change::{Act, Change};
use super::motion::{MotionSample, instants};
use super::{median, quantile};
use crate::euler::t_bef;
use windfall_model::Record;

/// Median cosine between down and the nose from which on a pair is one.
const NEAR: f64 = 0.7;
/// |sin R_y| beyond which angles x-y-z have rates that say nothing.
const SINGULAR: f64 = 0.98;

type Matrix = [[f64; 3]; 3];

/// An axis and its sign.
#[derive(Clone, Copy, PartialEq)]
struct Signed {
    axis: usize,
    sign: f64,
}

impl Signed {
    /// Rows of the right-handed axes whose first it is.
    fn rows(self) -> Matrix {
        let mut rows = [[0.0; 3]; 3];
        rows[0][self.axis] = self.sign;
        rows[1][(self.axis + 1) % 3] = 1.0;
        rows[2][(self.axis + 2) % 3] = self.sign;
        rows
    }
    /// As `[columns.axes]` has it.
    fn words(self) -> String {
        let name = |row: &[f64; 3]| {
            let axis = row.iter().position(|x| x.abs() > 0.5).unwrap_or(0);
            format!("\"{}{}\"", if row[axis] < 0.0 { "-" } else { "" }, ["x", "y", "z"][axis])
        };
        format!("[{}]", self.rows().each_ref().map(name).join(", "))
    }
    fn name(self) -> String {
        format!("{}{}", if self.sign < 0.0 { "-" } else { "" }, ["x", "y", "z"][self.axis])
    }
}

/// Whether angles pass near the attitude at which they are not defined, so that they jump without the body's doing so.
pub(super) fn is_singular(runs: &[(&str, &Record)]) -> bool {
    runs.iter().any(|(_, r)| quantile(r.attitude_rad[1].iter().map(|y| y.sin().abs()).collect(), 0.99) > SINGULAR)
}

/// Other readings of the axes of room and body together, with the motion that each gives.
pub(super) fn readings(runs: &[(&str, &Record)]) -> Vec<(Change, Vec<MotionSample>)> {
    let middle = medians(runs);
    let mut all = Vec::new();
    for (room, body) in (0..9).map(|k| (k / 3, k % 3)).filter(|(a, b)| middle[*a][*b].abs() > NEAR) {
        for sign in [1.0, -1.0] {
            let room = Signed { axis: room, sign };
            let body = Signed { axis: body, sign: sign * middle[room.axis][body].signum() };
            let as_it_is = |s: Signed| s.axis == 0 && s.sign > 0.0;
            if !(as_it_is(room) && as_it_is(body)) {
                let turned: Vec<(&str, Record)> = runs.iter().map(|(n, r)| (*n, turned(r, room, body))).collect();
                let by_name: Vec<(&str, &Record)> = turned.iter().map(|(n, r)| (*n, r)).collect();
                all.push((change(room, body), instants(&by_name)));
            }
        }
    }
    all.extend(backward(runs, &middle));
    all
}

/// Attitudes turned the other way under axes of room and body that are right but not ours: what was read is M = P Tᵀ Q with signed axes, and
/// T = D Mᵀ D with D = P Qᵀ of it, one of the 24 right-handed ones. Those are looked at whose nose then points down; D of one is a
/// sequence read backward.
fn backward(runs: &[(&str, &Record)], middle: &Matrix) -> Vec<(Change, Vec<MotionSample>)> {
    let axes = (0..3).flat_map(|axis| [1.0, -1.0].map(|sign| Signed { axis, sign }));
    // All right-handed axes: cyclic ones about each signed axis, turned about it in quarters.
    let all = axes.flat_map(|first| (0..4).map(move |quarters| product(&quarter_turns(quarters), &first.rows())));
    let nose = |d: &Matrix| (0..9).map(|k| d[0][k / 3] * middle[k % 3][k / 3] * d[k % 3][0]).sum::<f64>();
    let same = |d: &Matrix| (0..3).all(|k| d[k][k] > 0.5);
    all.filter(|d| !same(d) && nose(d) > NEAR)
        .map(|d| {
            let turned: Vec<(&str, Record)> =
                runs.iter().map(|(n, r)| (*n, read_otherwise(r, &OURS, |t| product(&d, &product(&transposed(t), &d))))).collect();
            let by_name: Vec<(&str, &Record)> = turned.iter().map(|(n, r)| (*n, r)).collect();
            let change = Change {
                cause: "the attitude is from tunnel to body (world-to-body), not from body to tunnel".to_owned(),
                words: "`rotates` the other way in [columns.attitude]".to_owned(),
                act: Act::Frames,
            };
            (change, instants(&by_name))
        })
        .collect()
}

const OURS: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Turns by a quarter about the first axis.
fn quarter_turns(count: usize) -> Matrix {
    let (c, s) = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][count % 4];
    [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn transposed(a: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

fn change(room: Signed, body: Signed) -> Change {
    Change {
        cause: format!(
            "axes of room and body are others: down is {} of the room, and {} of the body is out of the nose",
            room.name(),
            body.name()
        ),
        words: format!("[columns.axes] tunnel = {}, body = {} of the axes as they are read now", room.words(), body.words()),
        act: Act::Frames,
    }
}

/// Median of every element of the attitude over all samples.
fn medians(runs: &[(&str, &Record)]) -> Matrix {
    let attitudes: Vec<Matrix> = runs.iter().flat_map(|(_, r)| (0..r.len()).map(|i| attitude(r, i))).collect();
    std::array::from_fn(|i| std::array::from_fn(|j| median(&attitudes.iter().map(|t| t[i][j]).collect::<Vec<_>>())))
}

fn attitude(r: &Record, i: usize) -> Matrix {
    t_bef([0, 1, 2].map(|k| r.attitude_rad[k][i]))
}

/// The record along other axes: positions P p and attitudes P T Qᵀ.
fn turned(r: &Record, room: Signed, body: Signed) -> Record {
    let (p, q) = (room.rows(), transposed(&body.rows()));
    read_otherwise(r, &p, |t| product(&p, &product(t, &q)))
}

/// The record with positions P p and attitudes by a rule, angles without whole turns between samples.
fn read_otherwise(r: &Record, p: &Matrix, rule: impl Fn(&Matrix) -> Matrix) -> Record {
    let mut out = r.clone();
    for i in 0..r.len() {
        let t = rule(&attitude(r, i));
        let y = t[0][2].clamp(-1.0, 1.0).asin();
        let angles = [(-t[1][2]).atan2(t[2][2]), y, (-t[0][1]).atan2(t[0][0])];
        for k in 0..3 {
            let before = if i > 0 { out.attitude_rad[k][i - 1] } else { angles[k] };
            let turns = ((before - angles[k]) / std::f64::consts::TAU).round();
            out.attitude_rad[k][i] = angles[k] + turns * std::f64::consts::TAU;
            out.position_m[k][i] = (0..3).map(|j| p[k][j] * r.position_m[j][i]).sum();
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record() -> Record {
        let n = 60;
        let of = |f: &dyn Fn(f64) -> f64| (0..n).map(|i| f(f64::from(i) * 0.01)).collect::<Vec<f64>>();
        Record {
            t_s: of(&|t| t),
            position_m: [of(&|t| 0.1 * t), of(&|t| 0.2 + t), of(&|t| -t * t)],
            attitude_rad: [of(&|t| 2.0 + 9.0 * t), of(&|t| 0.1 * t.sin()), of(&|t| 0.2 - 0.1 * t)],
            vw_m_s: vec![6.0; 60],
            ps_pa: vec![1e5; 60],
            ts_k: vec![290.0; 60],
            ..Record::default()
        }
    }

    /// Rows of right-handed axes: a rotation whose first row is the signed axis.
    #[test]
    fn law_rows_are_right_handed() {
        for (axis, sign) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
            let rows = Signed { axis, sign }.rows();
            let m = nalgebra::Matrix3::from_fn(|i, j| rows[i][j]);
            assert!((m.determinant() - 1.0).abs() < 1e-15 && (m * m.transpose() - nalgebra::Matrix3::identity()).amax() < 1e-15);
            assert!((rows[0][axis] - sign).abs() < 1e-15);
        }
    }

    /// Axes as they are give the record, whose roll goes on beyond half a turn; whatever the axes, no angle goes by more than half
    /// a turn from sample to sample.
    #[test]
    fn law_no_turns_between_samples() {
        let sound = record();
        let as_it_is = Signed { axis: 0, sign: 1.0 };
        let same = turned(&sound, as_it_is, as_it_is);
        for (found, expected) in same.channels().into_iter().flatten().zip(sound.channels().into_iter().flatten()) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        for (axis, sign) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
            let to = Signed { axis, sign };
            let steps = |x: &[f64]| x.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
            assert!(turned(&sound, to, to).attitude_rad.iter().all(|x| steps(x) < 3.15), "{axis} {sign}");
        }
    }

    /// Axes read otherwise and back again are the record, whole turns of the roll apart.
    #[test]
    fn law_there_and_back() {
        let sound = record();
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                let to = Signed { axis, sign };
                // Rows of the inverse of a signed cyclic turn are its columns.
                let rows = to.rows();
                let first = Signed { axis: (3 - axis) % 3, sign: rows[(3 - axis) % 3][0] };
                let there = turned(&sound, to, to);
                let columns: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| rows[j][i]));
                if first.rows() != columns {
                    continue;
                }
                let back = turned(&there, first, first);
                for k in 0..3 {
                    for i in 0..sound.len() {
                        assert!((back.position_m[k][i] - sound.position_m[k][i]).abs() < 1e-12);
                        let apart = (back.attitude_rad[k][i] - sound.attitude_rad[k][i]).rem_euclid(std::f64::consts::TAU);
                        assert!(apart.min(std::f64::consts::TAU - apart) < 1e-9, "{axis} {sign} {k} {i}");
                    }
                }
            }
        }
    }

    /// An attitude that was turned the other way under axes of a room with z up comes back, whole turns apart, by one of the readings.
    #[test]
    fn law_an_attitude_turned_the_other_way_comes_back() {
        let sound = record();
        let p: Matrix = [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
        // Theirs is Pᵀ T; its transpose, read as theirs, is P (Pᵀ T)ᵀ.
        let wrong = read_otherwise(&sound, &OURS, |t| product(&p, &product(&transposed(t), &p)));
        let runs = [("r", &wrong)];
        let found = backward(&runs, &medians(&runs));
        let expected = instants(&[("r", &sound)]);
        let same = |all: &[MotionSample]| {
            all.iter().zip(&expected).all(|(a, b)| {
                let (a, b) = (a.motion[3..6].as_flattened(), b.motion[3..6].as_flattened());
                // Whole turns apart, within what second derivatives by windows of 0.4 s round.
                a.iter()
                    .zip(b)
                    .all(|(a, b)| (a - b - ((a - b) / std::f64::consts::TAU).round() * std::f64::consts::TAU).abs() < 1e-6)
            })
        };
        assert!(found.iter().any(|(_, all)| same(all)), "{} readings", found.len());
        assert!(found.iter().all(|(c, _)| c.words.contains("rotates")));
    }

    /// A model that turns about its nose: of a sound record the only other reading is half a turn of both.
    #[test]
    fn law_few_readings_of_a_spinning_model() {
        let sound =
            Record { attitude_rad: [(0..60).map(|i| 0.3 * f64::from(i)).collect(), vec![0.05; 60], vec![0.0; 60]], ..record() };
        let axes = |f: &(Change, Vec<MotionSample>)| f.0.words.contains("tunnel = ");
        let found: Vec<_> = readings(&[("r", &sound)]).into_iter().filter(axes).collect();
        assert_eq!(found.len(), 1, "{:?}", found.iter().map(|f| &f.0.words).collect::<Vec<_>>());
        assert!(
            found[0].0.words.contains("tunnel = [\"-x\", \"y\", \"-z\"], body = [\"-x\", \"y\", \"-z\"]"),
            "{}",
            found[0].0.words
        );
    }
}
