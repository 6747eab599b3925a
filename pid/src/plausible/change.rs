//! pid: what a record may be instead of what it says. In: instants. Out: the same read otherwise, and its name.

use super::balance::Point;
use super::motion::MotionSample;
use crate::euler::{euler_rates, t_bef};
use crate::instrument::Sample;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;
use windfall_model::RunChannel;

/// Another reading of a record.
#[derive(Clone, Debug)]
pub(super) struct Change {
    /// What is then wrong with the record as it stands.
    pub(super) cause: String,
    /// The change, as one would make it.
    pub(super) words: String,
    pub(super) act: Act,
}

/// What a reading does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Act {
    /// Position along axis i is that recorded along `axis[i]`, times `sign[i]`.
    Positions { axis: [usize; 3], sign: [f64; 3] },
    /// Angle i is that recorded in column `column[i]`, times `sign[i]`.
    Angles { column: [usize; 3], sign: [f64; 3] },
    /// The tunnel's frame is turned by half a turn about Y: X and Z point the other way, in positions and angles.
    HalfTurn,
    /// Body to tunnel is the product of turns about these axes, by the angles of those columns; or the inverse of it.
    Sequence { order: [usize; 3], inverse: bool },
    /// Positions times a factor.
    Length(f64),
    /// One position (0, 1, 2) or angle (3, 4, 5) times a factor.
    Axis { axis: usize, by: f64 },
    /// The vertical position, down or up as its sign is 1 or -1, from a zero so many metres below.
    Zero { sign: f64, metres: f64 },
    /// Angles times a factor.
    Angle(f64),
    /// Times times a factor.
    Time(f64),
    /// Tunnel speed times a factor.
    Wind(f64),
    /// Tunnel speed as recorded so many steps of [`super::motion::DELAY_S`] later; none: the record as it stands.
    Late(usize),
    /// The motion as it is given: turned already, in room and body together.
    Frames,
}

const AXES: [&str; 3] = ["X", "Y", "Z"];
const ANGLES: [&str; 3] = ["Rx", "Ry", "Rz"];
const LOWER: [&str; 3] = ["x", "y", "z"];

/// All readings that stand against the record as it is, the more usual slips first: of readings that say the same the first is named.
pub(super) fn all() -> Vec<Change> {
    let mut list = [positions(), angles(), sequences(), scales(), axes(), zeros()].concat();
    list.sort_by_key(|c| c.act.rarity());
    list
}

fn signed(sign: f64, name: &str) -> String {
    if sign < 0.0 { format!("-{name}") } else { name.to_owned() }
}

const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [2, 1, 0], [1, 0, 2], [1, 2, 0], [2, 0, 1]];

fn signs() -> impl Iterator<Item = [f64; 3]> {
    (0..8_u8).map(|k| [0, 1, 2].map(|bit| if k >> bit & 1 == 1 { -1.0 } else { 1.0 }))
}

fn positions() -> Vec<Change> {
    let mut list = Vec::new();
    for axis in ORDERS {
        for sign in signs() {
            let same = axis == ORDERS[0];
            let flipped: Vec<usize> = (0..3).filter(|k| sign[*k] < 0.0).collect();
            let cause = match (same, flipped.as_slice()) {
                (true, []) => continue,
                (true, [0]) => "X points up (it must point down)".to_owned(),
                (true, [k]) => format!("{} is mirrored: the axes are left-handed", AXES[*k]),
                (true, [0, ..]) => {
                    let names: Vec<&str> = flipped.iter().map(|k| AXES[*k]).collect();
                    format!("X points up: {} have the wrong sign", names.join(" and "))
                }
                (true, _) => "Y and Z have the wrong sign".to_owned(),
                (false, f) => {
                    let names: Vec<&str> = (0..3).filter(|k| axis[*k] != *k).map(|k| AXES[k]).collect();
                    let and = if f.is_empty() { "" } else { ", and a sign is wrong" };
                    format!("{} are swapped{and}", names.join(" and "))
                }
            };
            let words: Vec<String> = (0..3)
                .filter(|k| axis[*k] != *k || sign[*k] < 0.0)
                .map(|k| format!("{} = {}", AXES[k], signed(sign[k], AXES[axis[k]])))
                .collect();
            list.push(Change { cause, words: words.join(", "), act: Act::Positions { axis, sign } });
        }
    }
    list.push(Change {
        cause: "X points up, in positions and angles".to_owned(),
        words: "positions and attitude turned by half a turn about Y".to_owned(),
        act: Act::HalfTurn,
    });
    list
}

fn angles() -> Vec<Change> {
    let mut list = Vec::new();
    for column in ORDERS {
        for sign in signs() {
            let same = column == ORDERS[0];
            let flipped: Vec<&str> = (0..3).filter(|k| sign[*k] < 0.0).map(|k| ANGLES[k]).collect();
            let cause = match (same, flipped.len()) {
                (true, 0) => continue,
                (true, 3) => "all Euler angles have the opposite sign".to_owned(),
                (true, _) => format!("Euler angle {} has the opposite sign", flipped.join(" and ")),
                // Swaps of two columns with their signs right; others are not what anybody does.
                (false, 0) => {
                    let names: Vec<&str> = (0..3).filter(|k| column[*k] != *k).map(|k| ["roll", "pitch", "yaw"][k]).collect();
                    format!("{} are swapped", names.join(" and "))
                }
                (false, _) => continue,
            };
            let words: Vec<String> = (0..3)
                .filter(|k| column[*k] != *k || sign[*k] < 0.0)
                .map(|k| format!("{} = {}", ANGLES[k], signed(sign[k], ANGLES[column[k]])))
                .collect();
            list.push(Change { cause, words: words.join(", "), act: Act::Angles { column, sign } });
        }
    }
    list
}

fn sequences() -> Vec<Change> {
    let mut list = Vec::new();
    for order in ORDERS {
        for inverse in [false, true] {
            if order == ORDERS[0] && !inverse {
                continue;
            }
            let name = order.map(|k| LOWER[k]).join("-");
            let product = order.map(|k| ANGLES[k]).join("·");
            let (cause, words) = if inverse {
                (
                    format!("the attitude is from tunnel to body (sequence {name}), not from body to tunnel"),
                    format!("T = ({product})^-1 (`rotates` the other way in [columns.attitude])"),
                )
            } else {
                (format!("the Euler sequence is {name}, not x-y-z"), format!("T = {product}"))
            };
            list.push(Change { cause, words, act: Act::Sequence { order, inverse } });
        }
    }
    list
}

fn scales() -> Vec<Change> {
    let length = [(1e-3, "mm"), (1e-2, "cm"), (FOOT_M, "feet"), (0.0254, "inches"), (1e3, "km")];
    let times = [(1e-3, "times are in ms"), (1e-6, "times are in microseconds"), (60.0, "times are in minutes")];
    let mut list: Vec<Change> = length
        .iter()
        .map(|(f, name)| Change {
            cause: format!("positions are in {name}"),
            words: format!("X, Y, Z times {f}"),
            act: Act::Length(*f),
        })
        .collect();
    let degrees = PI / 180.0;
    list.push(Change {
        cause: "angles are in radians where degrees are declared".to_owned(),
        words: "Rx, Ry, Rz times 57.29578".to_owned(),
        act: Act::Angle(1.0 / degrees),
    });
    list.push(Change {
        cause: "angles are in degrees where radians are expected".to_owned(),
        words: "Rx, Ry, Rz divided by 57.29578".to_owned(),
        act: Act::Angle(degrees),
    });
    let speeds = [(3.6, "km/h"), (1.943_84, "knots"), (3.280_84, "ft/s"), (2.236_94, "mph"), (100.0, "cm/s")];
    list.extend(speeds.iter().map(|(f, name)| Change {
        cause: format!("speed is in {name}"),
        words: format!("VW divided by {f}"),
        act: Act::Wind(1.0 / f),
    }));
    list.push(Change { cause: "V_W points down".to_owned(), words: "VW = -VW".to_owned(), act: Act::Wind(-1.0) });
    list.extend(times.iter().map(|(f, cause)| Change {
        cause: (*cause).to_owned(),
        words: format!("t times {f}"),
        act: Act::Time(*f),
    }));
    list.extend(STRETCHED.iter().map(|f| Change {
        cause: format!("the sample rate is wrong: times are stretched by about {}", super::short(1.0 / f)),
        words: format!("t times {}", super::short(*f)),
        act: Act::Time(*f),
    }));
    list
}

/// A foot, m.
const FOOT_M: f64 = 0.3048;

/// One axis in a unit of its own among the others: what it is in, what they are in, and the factor that makes them one.
const OWN_UNITS: [(&str, &str, f64); 11] = [
    ("cm", "mm", 10.0),
    ("mm", "cm", 0.1),
    ("mm", "m", 1e-3),
    ("cm", "m", 1e-2),
    ("m", "cm", 1e2),
    ("m", "mm", 1e3),
    ("feet", "m", FOOT_M),
    ("m", "feet", 1.0 / FOOT_M),
    ("inches", "mm", 25.4),
    ("inches", "cm", 2.54),
    ("inches", "m", 0.0254),
];

fn axes() -> Vec<Change> {
    let one = |axis: usize| {
        OWN_UNITS.iter().map(move |(own, others, by)| Change {
            cause: format!("{} is in {own} among axes in {others}", AXES[axis]),
            words: if *own == "m" && *others == "feet" {
                format!("{} divided by {FOOT_M}", AXES[axis])
            } else {
                format!("{} times {by}", AXES[axis])
            },
            act: Act::Axis { axis, by: *by },
        })
    };
    let angle = |k: usize| {
        [("radians", "degrees", "times"), ("degrees", "radians", "divided by")].map(|(own, others, how)| Change {
            cause: format!("{} is in {own} among angles in {others}", ANGLES[k]),
            words: format!("{} {how} 57.29578", ANGLES[k]),
            act: Act::Axis { axis: 3 + k, by: if own == "radians" { 180.0 / PI } else { PI / 180.0 } },
        })
    };
    (0..3).flat_map(one).chain((0..3).flat_map(angle)).collect()
}

/// Farthest zero of the vertical position that is tried, and the step, m. The tunnel is 6 m wide; a line of some metres pulls hardly otherwise
/// half a step away.
const FARTHEST_M: f64 = 5.0;
const STEP_M: f64 = 0.5;

/// Vertical positions from a floor or a ceiling, upward or downward.
fn zeros() -> Vec<Change> {
    #[expect(clippy::cast_possible_truncation, reason = "ten steps")]
    let steps = (FARTHEST_M / STEP_M) as i32;
    let one = |k: i32| {
        let metres = f64::from(k) * STEP_M;
        [1.0, -1.0].map(|sign| Change {
            cause: format!(
                "X is counted {} from a zero about {} m {} that of the declared line",
                if sign > 0.0 { "downward" } else { "upward" },
                metres.abs(),
                if metres > 0.0 { "below" } else { "above" }
            ),
            words: format!("X = {metres:?} {} X", if sign > 0.0 { "+" } else { "-" }),
            act: Act::Zero { sign, metres },
        })
    };
    (-steps..=steps).filter(|k| *k != 0).flat_map(one).collect()
}

/// Factors of the clock that are tried, each a seventh from the next where they are near one.
const STRETCHED: [f64; 14] = [0.1, 0.2, 0.25, 1.0 / 3.0, 0.4, 0.5, 0.6, 0.7, 0.8, 1.25, 1.5, 2.0, 3.0, 5.0];

impl Act {
    /// An instant as this reading has it.
    pub(super) fn apply(&self, i: &MotionSample) -> Point {
        let m = &i.motion;
        let mut to = *m;
        let mut t_s = i.t_s;
        match *self {
            Self::Positions { axis, sign } => (0..3).for_each(|k| to[k] = m[axis[k]].map(|v| v * sign[k])),
            Self::Angles { column, sign } => (0..3).for_each(|k| to[3 + k] = m[3 + column[k]].map(|v| v * sign[k])),
            Self::HalfTurn => half_turn(&mut to),
            Self::Sequence { order, inverse } => sequence(&mut to, order, inverse),
            Self::Length(f) => to[..3].iter_mut().for_each(|x| *x = x.map(|v| v * f)),
            Self::Axis { axis, by } => to[axis] = m[axis].map(|v| v * by),
            Self::Zero { sign, metres } => to[0] = [metres + sign * m[0][0], sign * m[0][1], sign * m[0][2]],
            Self::Angle(f) => to[3..6].iter_mut().for_each(|x| *x = x.map(|v| v * f)),
            Self::Time(f) => {
                t_s *= f;
                to = to.map(|[value, rate, second]| [value, rate / f, second / (f * f)]);
            }
            Self::Late(0) => {}
            Self::Late(k) => to[RunChannel::Wind.at()] = i.later[k - 1],
            Self::Frames => {}
            Self::Wind(f) => to[RunChannel::Wind.at()] = m[RunChannel::Wind.at()].map(|v| v * f),
        }
        Point { t_s, motion: to, ps_pa: i.ps_pa, ts_k: i.ts_k }
    }
    /// How rarely a slip of this kind is made: simple ones come first.
    fn rarity(&self) -> usize {
        let negative = |sign: &[f64; 3]| sign.iter().filter(|s| **s < 0.0).count();
        match self {
            Self::Length(_) | Self::Angle(_) | Self::Wind(_) | Self::Late(_) => 0,
            Self::Positions { axis, sign } if *axis == ORDERS[0] => negative(sign),
            Self::Positions { sign, .. } => 1 + 2 * negative(sign),
            Self::Angles { column, sign } if *column == ORDERS[0] => {
                if negative(sign) == 3 {
                    2
                } else {
                    negative(sign)
                }
            }
            Self::Sequence { order: [2, 1, 0], inverse: false } => 1,
            Self::Angles { .. } | Self::Time(_) | Self::Axis { .. } | Self::Zero { .. } => 2,
            Self::Sequence { order, inverse } => {
                if *inverse && *order != ORDERS[0] {
                    4
                } else {
                    3
                }
            }
            Self::HalfTurn => 4,
            Self::Frames => 5,
        }
    }
    /// Whether accelerations keep their size, so that what is left can be measured against those of the record as it stands.
    pub(super) fn keeps_size(&self) -> bool {
        !matches!(self, Self::Length(_) | Self::Axis { .. } | Self::Angle(_) | Self::Time(_) | Self::Frames)
    }
}

/// Value and two derivatives of a matrix.
type Turning = [Matrix3<f64>; 3];

fn times(a: &Turning, b: &Turning) -> Turning {
    [a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + a[1] * b[1] * 2.0 + a[0] * b[2]]
}

/// Turn about one axis by an angle with two derivatives.
fn turn(axis: usize, [angle, rate, second]: [f64; 3]) -> Turning {
    let mut euler = [0.0; 3];
    euler[axis] = angle;
    let t = matrix(&t_bef(euler));
    let mut along = Vector3::zeros();
    along[axis] = 1.0;
    let spin = along.cross_matrix();
    [t, t * spin * rate, t * spin * second + t * spin * spin * (rate * rate)]
}

fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, k| rows[i][k])
}

fn sequence(m: &mut Sample, order: [usize; 3], inverse: bool) {
    let [a, b, c] = order.map(|k| turn(k, m[3 + k]));
    let t = times(&times(&a, &b), &c);
    put(m, if inverse { t.map(|x| x.transpose()) } else { t });
}

fn half_turn(m: &mut Sample) {
    for k in [0, 2] {
        m[k] = m[k].map(|v| -v);
    }
    let [a, b, c] = [0, 1, 2].map(|k| turn(k, m[3 + k]));
    let t = times(&times(&a, &b), &c);
    let half = Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, -1.0));
    put(m, t.map(|x| half * x));
}

/// Writes an attitude with its derivatives as Euler angles x-y-z.
fn put(m: &mut Sample, [t, rate, second]: Turning) {
    let of = |s: Matrix3<f64>| [0.5 * (s[(2, 1)] - s[(1, 2)]), 0.5 * (s[(0, 2)] - s[(2, 0)]), 0.5 * (s[(1, 0)] - s[(0, 1)])];
    let spin = of(t.transpose() * rate);
    let spin_rate = of(t.transpose() * second + rate.transpose() * rate);
    let euler = [(-t[(1, 2)]).atan2(t[(2, 2)]), t[(0, 2)].clamp(-1.0, 1.0).asin(), (-t[(0, 1)]).atan2(t[(0, 0)])];
    let (rates, seconds) = euler_rates(euler, spin, spin_rate);
    for k in 0..3 {
        m[3 + k] = [euler[k], rates[k], seconds[k]];
    }
}

#[cfg(test)]
mod tests;
