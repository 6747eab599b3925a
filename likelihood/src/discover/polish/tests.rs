//! likelihood tests: when a set's forms are the same, and strengths that are weakened.

use super::super::tests::{bare, in_gusts, member};
use super::*;

/// Widths within three tenths of the other's are one form, whatever the strengths.
#[test]
fn exact_same_forms() {
    let (engine, _) = in_gusts();
    let of = |values: [f64; 2]| Model {
        members: vec![Member { values: values.to_vec(), ..member(&engine, "damping-shape") }],
        ..bare()
    };
    assert!(same_forms(&of([30.0, 0.25]), &of([-4.0, 0.2])) && !same_forms(&of([30.0, 0.27]), &of([30.0, 0.2])));
    assert!(!same_forms(&of([30.0, 0.2]), &of([30.0, 0.3])) && !same_forms(&of([30.0, 0.2]), &bare()));
    let mut m = of([30.0, 0.25]).members.remove(0);
    weaken(&mut m);
    assert!((m.values[0] - 9.0).abs() < 1e-12 && (m.values[1] - 0.25).abs() < 1e-15);
}
