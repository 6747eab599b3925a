//! pid tests: a point of the search moved, varied and without a size, by hand.

use super::*;
use crate::filter_error::likelihood::tests::point;
use crate::output_error::flown::erring;

/// Four unknowns (the third of which two parameters share) come first, then six logarithms; to rounding.
#[test]
fn exact_moved_varied_and_without() {
    let plant = erring();
    let here = point(&plant);
    let same = |found: [f64; RANDOM], expected: [f64; RANDOM]| {
        assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-14), "{found:?} {expected:?}");
    };
    let step = DVector::from_fn(4 + RANDOM, |i, _| 0.3 * (1.0 + i as f64).sin());
    let there = here.moved(&step);
    same(there.random, std::array::from_fn(|k| here.random[k] + step[4 + k]));
    for (parameter, column) in [(0, Some(0)), (1, Some(1)), (2, None), (7, Some(2)), (9, Some(2))] {
        let expected = here.unknowns.parameters()[parameter] + column.map_or(0.0, |c: usize| step[c]);
        assert!((there.unknowns.parameters()[parameter] - expected).abs() < 1e-13, "{parameter}");
    }
    for k in 0..RANDOM {
        let Random { turbulence: t, turning: [roll, across] } = here.varied(k, 0.2);
        let mut expected = here.random;
        expected[k] += 0.2;
        same([t.axial_rms_m_s, t.lateral_rms_m_s, t.axial_scale_m, t.lateral_scale_m, roll, across].map(f64::ln), expected);
    }
    for (size, k) in SIZES.into_iter().enumerate() {
        let without = here.without(size);
        let mut expected = here.random;
        expected[k] = NONE_M_S.ln();
        if k < 2 {
            expected[2 + k] = START_SCALE_M.ln();
        }
        same(without.random, expected);
        assert!((without.negligible[size].expect("noted") - here.random[k].exp()).abs() < 1e-15);
        // A gust that is not there takes its scale with it.
        let held: Vec<usize> = (0..4 + RANDOM).filter(|i| without.held(*i)).collect();
        assert_eq!(held, if k < 2 { vec![4 + k, 6 + k] } else { vec![4 + k] });
    }
}
