//! verify tests: the scenario files of the NESC check cases. In: scenarios/planet/. Out: distance from the last printed row of simulation 4.

use std::path::Path;
use windfall_scenarios::read_planet;
use windfall_sim::fly_planet;

const FOOT_M: f64 = 0.3048;

/// NASA/TM-2015-218675, atmospheric cases, simulation 4 at 30 s: altitude, velocity east and down (ft, ft/s), longitude (deg). Bounds of
/// the issue: 1e-3 m and 1e-5 m/s.
#[test]
fn pub_scenario_files_fly_the_check_cases() {
    for (name, altitude_ft, east_ft_s, down_ft_s, longitude_deg) in [
        ("nesc-01", 15_598.904_352_2, 2.101_011_086_17, 960.293_064_507, 5.745_522_132_87e-5_f64),
        ("nesc-03", 4_754.546_046_55 / FOOT_M, 0.640_388_179_065 / FOOT_M, 292.697_326_062 / FOOT_M, 5.745_522_132_87e-5),
        ("nesc-04", 4_947.302_045_73 / FOOT_M, 0.0, 264.293_580_979 / FOOT_M, 0.0),
        ("nesc-06", 16_284.443_772, 1.842_930_856_03, 864.010_905_567, 5.337_982_513_62e-5),
        ("nesc-07", 16_285.161_247_2, 4.708_375_899_78, 863.966_976_848, 1.285_417_351_28e-4),
        ("nesc-08", 16_290.997_874_3, 8.730_999_851_97, 863.694_253_332, 2.735_796_672_79e-4),
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenarios/planet/{name}.toml"));
        let file = read_planet(&path).unwrap_or_else(|e| panic!("{e}"));
        let t = fly_planet(&file.scenario, &file.scenario.flights[0]).unwrap_or_else(|e| panic!("{name}: {e}")).truth;
        let (place, v) = (t.place[300], t.v_ground_ned[300]);
        assert!((place.height_m - altitude_ft * FOOT_M).abs() < 1e-3, "{name}: {} m", place.height_m);
        assert!((place.longitude_rad - longitude_deg.to_radians()).abs() * 6.4e6 < 1e-3, "{name}");
        assert!((v[1] - east_ft_s * FOOT_M).abs() < 1e-5 && (v[2] - down_ft_s * FOOT_M).abs() < 1e-5, "{name}: {v:?}");
    }
}
