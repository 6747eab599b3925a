//! discover tests: effects as numbers on [0, 1] against the additive sequence and the catalogue.

use super::*;
use windfall_model::Acts;
use windfall_model::effects::find;

fn effect(family: &str) -> &'static Effect {
    find(family, Acts::Lander).expect("an effect of the catalogue")
}

/// Golden ratio, plastic number, and the next of Roberts 2018: printed values.
#[test]
fn pub_generalised_golden_ratios() {
    for (d, printed) in [(1, 1.618_033_988_749_895), (2, 1.324_717_957_244_746), (3, 1.220_744_084_605_759_6)] {
        assert!((golden(d) - printed).abs() < 1e-14, "{d}");
    }
}

/// Points of the cover: the fractional part of `½ + (k + 1) g⁻ʲ`, odd j for places, even j for signs, with `g¹⁷ = g + 1` by bisection
/// for eight parameters; shapes are those that the catalogue tries, in turn. What leads keeps its place.
#[test]
fn exact_cover() {
    let h = Hypothesis::none(9.0).with(effect("axial-speed")).with(effect("turbulence")).with(effect("asymmetry"));
    assert_eq!((h.dimension(), h.of_last()), (9, 4));
    let (mut low, mut high) = (1.0_f64, 2.0_f64);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if middle.powi(17) < middle + 1.0 { low = middle } else { high = middle }
    }
    let mut signs = [0; 2];
    for k in 0..6 {
        let spread = |j: i32| (0.5 + f64::from(k + 1) * low.powi(-j)).fract();
        let (mut there, mut at) = (h.clone(), vec![0.123; 9]);
        there.cover(1, usize::try_from(k).expect("small"), &mut at);
        assert!((at[0] - 0.123).abs() < 1e-15 && (there.value(0, 1.0) - 10.0).abs() < 1e-14);
        for j in 0..8 {
            let (place, sign) = (spread(2 * j + 1), spread(2 * j + 2));
            let i = usize::try_from(j).expect("small") + 1;
            let is_scale = j == 2 || j == 3;
            let third = if place < 1.0 / 3.0 {
                0.2
            } else if place < 2.0 / 3.0 {
                0.6
            } else {
                1.8_f64
            };
            let expected = if is_scale { (third / 0.05).ln() / 200.0_f64.ln() } else { place };
            assert!((at[i] - expected).abs() < 1e-12, "{k} {j}: {} for {expected}", at[i]);
            if !is_scale {
                let limit = if j < 2 {
                    2.0
                } else if sign < 0.5 {
                    -0.5
                } else {
                    0.5
                };
                signs[usize::from(limit > 0.0)] += 1;
                // From the largest plausible strength four decades down.
                assert!(
                    (there.value(i, 1.0) - limit).abs() < 1e-14 && (there.value(i, 0.0) / limit - 1e-4).abs() < 1e-14,
                    "{k} {j}"
                );
            }
        }
    }
    assert!(signs.iter().all(|n| *n > 5), "both signs: {signs:?}");
}

/// Sum of squares over shapes that are searched: places on the logarithm from 0.05 m to 10 m, typical at 0.6 m; one that is held counts
/// nothing, strengths neither.
#[test]
fn exact_shape_distance() {
    let h = Hypothesis::none(9.0).with(effect("turbulence"));
    assert_eq!((h.dimension(), h.of_last(), h.strengths()), (4, 4, vec![0, 1]));
    let typical = 12.0_f64.ln() / 200.0_f64.ln();
    let x = [0.9, 0.2, 0.35, 0.71];
    let [one, two] = [0.35 - typical, 0.71 - typical];
    assert!((h.shape_distance(&x) - (one * one + two * two)).abs() < 1e-14);
    assert!((h.holding(2, 0.3).shape_distance(&x) - two * two).abs() < 1e-14);
}
