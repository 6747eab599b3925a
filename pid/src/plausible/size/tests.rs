//! pid tests: radii of gyration by hand.

use super::super::tests::campaign;
use super::*;
use crate::equations::tests::plant;

/// 138 000 g cm² taken for kg m² of a body of 0.7873 kg: √(138000/0.7873) m = 418.7 m is 1970 diameters of 0.2125 m. A body of 0.36
/// to 0.77 diameters is one.
#[test]
fn exact_radius_of_gyration() {
    assert!(fault(&campaign(plant(), Vec::new())).is_none());
    let mut wrong = plant();
    wrong.vehicle.inertia.yy = 138_000.0;
    let found = fault(&campaign(wrong, Vec::new())).expect("no body");
    assert!(
        found.evidence.starts_with("yy = 138000 kg m2 with 0.787 kg is a radius of gyration of 1970 diameters"),
        "{}",
        found.evidence
    );
}
