//! pid tests: every reading against what its own words say, done to angles and places by the model's rotations.

use super::super::motion::DELAYS;
use super::*;
use nalgebra::Rotation3;
use std::collections::HashSet;
use windfall_model::frames::{Body, EulerXyz, Rotation, Tunnel};

/// Sines of a channel's own with two derivatives.
fn channel(k: usize, t: f64) -> [f64; 3] {
    let c = k as f64;
    let (size, rate, phase) = (0.3 + 0.05 * c, 1.1 + 0.2 * c, 0.4 + 1.3 * c);
    let (sin, cos) = (rate * t + phase).sin_cos();
    [0.1 + 0.03 * c + size * sin, size * rate * cos, -size * rate * rate * sin]
}

fn sample(t: f64) -> MotionSample {
    let later = std::array::from_fn(|k| channel(6, t + 0.15 * (k as f64 + 1.0)));
    let motion = std::array::from_fn(|k| channel(k, t));
    MotionSample { t_s: t, span_s: 0.1, motion, later, ps_pa: 1.01e5, ts_k: 295.0 }
}

/// What the words make of seven values.
fn said(words: &str, m: [f64; 7]) -> [f64; 7] {
    let at = |name: &str| ["X", "Y", "Z", "Rx", "Ry", "Rz", "VW"].iter().position(|n| *n == name).expect("a channel");
    let about = |k: usize, angle: f64| Rotation3::from_scaled_axis(Vector3::from_fn(|i, _| if i == k { angle } else { 0.0 }));
    let turns = |names: &mut dyn Iterator<Item = &str>| {
        names.map(at).fold(Rotation3::identity(), |product, k| product * about(k - 3, m[k]))
    };
    let mut to = m;
    // A remedy stands behind the words.
    let words = words.split(" (`").next().expect("words");
    let attitude = |r: Rotation3<f64>, to: &mut [f64; 7]| {
        let e = EulerXyz::from_rotation(Rotation::<Tunnel, Body>::from_matrix(r.into_inner()));
        to[3..6].copy_from_slice(&[e.rx_rad, e.ry_rad, e.rz_rad]);
    };
    if let Some(product) = words.strip_prefix("T = ") {
        let r = turns(&mut product.trim_start_matches('(').trim_end_matches(")^-1").split('·'));
        attitude(if product.ends_with("^-1") { r.inverse() } else { r }, &mut to);
    } else if words == "positions and attitude turned by half a turn about Y" {
        let half = about(1, std::f64::consts::PI);
        to[..3].copy_from_slice((half * Vector3::new(m[0], m[1], m[2])).as_slice());
        attitude(half * turns(&mut ["Rx", "Ry", "Rz"].into_iter()), &mut to);
    } else if let [zero, sign, "X"] = words.trim_start_matches("X = ").split(' ').collect::<Vec<_>>().as_slice() {
        let metres: f64 = zero.parse().expect("a number");
        to[0] = if *sign == "+" { metres + m[0] } else { metres - m[0] };
    } else if words.contains(" = ") {
        for (left, right) in words.split(", ").filter_map(|part| part.split_once(" = ")) {
            to[at(left)] = right.strip_prefix('-').map_or_else(|| m[at(right)], |name| -m[at(name)]);
        }
    } else {
        let (names, _) = words.split_once(" times ").or_else(|| words.split_once(" divided by ")).expect("a factor");
        names.split(", ").filter(|n| *n != "t").for_each(|n| to[at(n)] *= factor(words));
    }
    to
}

/// The factor that words name.
fn factor(words: &str) -> f64 {
    let number = |text: &str| text.parse::<f64>().expect("a number");
    let by = |(_, text): (&str, &str)| number(text);
    words.split_once(" times ").map(by).unwrap_or_else(|| 1.0 / words.split_once(" divided by ").map(by).expect("a factor"))
}

/// Values, rates and second derivatives of all readings against differences of what their words say. Differences err by a fourth
/// derivative of 100 times h²/12 and by rounding of 30 rad over h²; factors are printed to three digits where the clock is
/// stretched.
#[test]
fn exact_readings_do_what_their_words_say() {
    let (h, list) = (3e-4, all());
    for c in &list {
        let of_clock = c.words.starts_with("t times");
        let (tolerance, clock) = if of_clock { (5e-3, factor(&c.words)) } else { (1e-5, 1.0) };
        for t in [0.2, 0.9, 1.7] {
            let point = c.act.apply(&sample(t));
            let at = |t: f64| said(&c.words, std::array::from_fn(|k| channel(k, t)[0]));
            let (before, now, after) = (at(t - h), at(t), at(t + h));
            assert!((point.t_s / (clock * t) - 1.0).abs() < tolerance, "{}", c.words);
            assert!((point.ps_pa - 1.01e5).abs() < 1e-9 && (point.ts_k - 295.0).abs() < 1e-9);
            for k in 0..7 {
                let expected = [
                    now[k],
                    (after[k] - before[k]) / (2.0 * h) / clock,
                    (after[k] - 2.0 * now[k] + before[k]) / (h * h) / (clock * clock),
                ];
                for (found, expected) in point.motion[k].iter().zip(expected) {
                    assert!((found - expected).abs() < tolerance * (1.0 + expected.abs()), "{} {k} {found} {expected}", c.words);
                }
            }
        }
    }
}

/// Six orders of axes with eight signs each but for the record itself, and half a turn; seven signs of angles and five orders; six
/// orders of turns both ways but for the declared; 30 factors; three axes with eleven units of their own and three angles with two; twenty zeros
/// of X both ways. No two are the same.
#[test]
fn exact_number_of_readings() {
    let list = all();
    assert_eq!(list.len(), (6 * 8 - 1 + 1) + (7 + 5) + (2 * 6 - 1) + 30 + 3 * 11 + 3 * 2 + 20 * 2);
    assert_eq!(list.iter().map(|c| c.words.as_str()).collect::<HashSet<_>>().len(), list.len());
    // By which times are stretched, over the factor that undoes it: to three digits of both.
    let stretched: Vec<&Change> = list.iter().filter(|c| c.cause.contains("stretched")).collect();
    assert_eq!(stretched.len(), 14);
    for c in stretched {
        let about: f64 = c.cause.rsplit_once(' ').expect("words").1.parse().expect("a number");
        assert!((about * factor(&c.words) - 1.0).abs() < 1e-2, "{} {}", c.cause, c.words);
    }
}

/// The more usual slip first.
#[test]
fn order_of_readings() {
    let swapped = |sign: [f64; 3]| Act::Positions { axis: [1, 0, 2], sign };
    let rarities = [
        Act::Wind(-1.0),
        Act::Positions { axis: [0, 1, 2], sign: [-1.0, 1.0, 1.0] },
        Act::Positions { axis: [0, 1, 2], sign: [-1.0, -1.0, 1.0] },
        swapped([1.0; 3]),
        swapped([1.0, -1.0, 1.0]),
        swapped([-1.0, 1.0, -1.0]),
        swapped([-1.0; 3]),
        Act::Angles { column: [0, 1, 2], sign: [1.0, 1.0, -1.0] },
        Act::Angles { column: [0, 1, 2], sign: [-1.0; 3] },
        Act::Sequence { order: [2, 1, 0], inverse: false },
        Act::Sequence { order: [2, 1, 0], inverse: true },
        Act::Frames,
    ]
    .map(|a| a.rarity());
    assert_eq!(rarities, [0, 1, 2, 1, 3, 5, 7, 1, 2, 1, 4, 5]);
    assert!(all().windows(2).all(|w| w[0].act.rarity() <= w[1].act.rarity()));
}

/// A turn by an angle that slows down, against differences of the rotation: a fourth derivative of 30 times h²/12, and rounding
/// over h².
#[test]
fn exact_turn_about_an_axis() {
    let ([angle, rate, second], h) = ([0.7, 1.3, -0.9], 1e-4);
    for axis in 0..3 {
        let at = |t: f64| {
            let angle = angle + rate * t + 0.5 * second * t * t;
            Rotation3::from_scaled_axis(Vector3::from_fn(|k, _| if k == axis { angle } else { 0.0 })).into_inner()
        };
        let found = turn(axis, [angle, rate, second]);
        let expected = [at(0.0), (at(h) - at(-h)) / (2.0 * h), (at(h) - at(0.0) * 2.0 + at(-h)) / (h * h)];
        assert!(found.iter().zip(&expected).all(|(f, e)| (f - e).amax() < 1e-6), "{found:?} {expected:?}");
    }
}

/// The anemometer late by so many steps, and motion that is given as it is.
#[test]
fn exact_late_anemometer() {
    let i = sample(0.7);
    let same = |a: &Sample, b: &Sample| a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-15);
    for act in [Act::Late(0), Act::Frames] {
        assert!(same(&act.apply(&i).motion, &i.motion));
    }
    for k in 1..=DELAYS {
        let mut expected = i.motion;
        expected[6] = channel(6, 0.7 + 0.15 * k as f64);
        assert!(same(&Act::Late(k).apply(&i).motion, &expected), "{k}");
    }
}
