//! sim tests: effects that are put in with no strength. In: any effect, seed and release. Out: the flight without it, bit by bit.

use crate::common::{REST, cases, flight, lander};
use proptest::prelude::*;
use windfall_model::effects::{Acts, Role};
use windfall_model::{CATALOGUE, Effect, Release};
use windfall_sim::{Seed, fly};

/// Those that bring something along even without strength: a part on springs, a pulse whose time no step may jump over, and what makes
/// forces depend on accelerations.
const BRING: [&str; 3] = ["loose-mass", "contact", "apparent-mass"];

fn quiet() -> impl Strategy<Value = &'static Effect> {
    let all: Vec<&'static Effect> =
        CATALOGUE.into_iter().filter(|e| matches!(e.acts, Acts::Lander | Acts::Runs) && !BRING.contains(&e.family)).collect();
    prop::sample::select(all)
}

proptest! {
    // Each case is two flights of a second.
    #![proptest_config(cases(64))]
    #[test]
    fn law_an_effect_without_strength_changes_no_bit(effect in quiet(), campaign in 0_u64..1000, tilt in -0.5_f64..0.5, rate in -1.0_f64..1.0) {
        let plain = lander();
        let mut with = lander();
        let values: Vec<f64> = (effect.parameters)(&[]).iter().map(|p| if p.role == Role::Strength { 0.0 } else { p.null }).collect();
        (effect.apply)(&mut with, &values);
        let release = Release { attitude_rad: [0.1, tilt, -0.5 * tilt], rates_rad_s: [rate, 0.3, -0.2], ..REST };
        let mut order = flight(1.0, 100.0, 7.4, release);
        order.sensor_noise = true;
        let seed = Seed { campaign, run: 0 };
        let (a, b) = (fly(&plain, &order, seed), fly(&with, &order, seed));
        prop_assert_eq!(a, b, "{}", effect.family);
    }
}
