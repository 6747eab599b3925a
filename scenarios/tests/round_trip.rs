//! scenarios: what is written is read, to the bit. In: numbers drawn. Out: the same text after writing, reading and writing again.

use proptest::prelude::*;
use std::fs;
use std::path::Path;
use windfall_model::{Aero, Coefficient, Contribution, Data, Factor, Structure, Term, Use, Variable};
use windfall_scenarios::{
    FileKind, RunLine, kind_of, read_campaign, read_planet, read_record_csv, read_scenario_file, read_structure, text_atomically,
    write_campaign_toml, write_record_csv, write_resolved_planet, write_resolved_scenario, write_structure,
};

mod common;

/// So many cases of a property, or as many as `PROPTEST_CASES` asks for.
fn cases(few: u32) -> ProptestConfig {
    if std::env::var_os("PROPTEST_CASES").is_some() { ProptestConfig::default() } else { ProptestConfig::with_cases(few) }
}

/// Numbers of any size that a parameter may have, some of them short.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-1e3_f64..1e3, (-9.0_f64..9.0).prop_map(|p| 10.0_f64.powf(p)), Just(0.0), Just(-0.1), Just(1e-300)]
}

fn bytes(path: &Path) -> Vec<u8> {
    fs::read(path).expect("just written")
}

fn term() -> impl Strategy<Value = (usize, usize, f64, Vec<Factor>)> {
    let variable = || prop::sample::select(Variable::ALL.to_vec());
    let factor = prop_oneof![
        (variable(), 1_u8..=9).prop_map(|(v, n)| Factor::Power(v, n)),
        (1_u8..=99).prop_map(Factor::SinClock),
        (1_u8..=99).prop_map(Factor::CosClock),
        (variable(), 1e-3_f64..3.0).prop_map(|(v, w)| Factor::Bump(v, w)),
    ];
    (0_usize..6, 0_usize..3, number(), prop::collection::vec(factor, 0..4))
}

proptest! {
    // Each case writes and reads files.
    #![proptest_config(cases(48))]

    #[test]
    fn law_structures(terms in prop::collection::vec(term(), 3..8)) {
        let dir = tempfile::tempdir().expect("a temporary folder");
        let path = dir.path().join("made.toml");
        // Every parameter is in a term.
        let contributions = terms.into_iter().enumerate().map(|(i, (c, p, scale, factors))| Contribution {
            coefficient: Coefficient::ALL[c],
            parameter: if i < 3 { i } else { p },
            term: Term { scale, factors },
        });
        let made = Structure { name: "made".to_owned(), parameters: ["a", "b-1", "c d"].map(str::to_owned).to_vec(), contributions: contributions.collect() };
        write_structure(&path, &made).expect("writable");
        prop_assert_eq!(read_structure(&path).expect("what was written"), made);
    }

    #[test]
    fn law_scenarios_and_campaigns(values in prop::collection::vec(number(), 11), seed in 0_u64..(1 << 53)) {
        let dir = tempfile::tempdir().expect("a temporary folder");
        let (one, two) = (dir.path().join("one.toml"), dir.path().join("two.toml"));
        fs::write(&one, windfall_scenarios::bundled("sage-undeclared").expect("bundled")).expect("writable");
        let mut file = read_scenario_file(&one).expect("bundled");
        file.scenario.seed = seed;
        let aero = |a: &Aero| Aero::new(a.structure.clone(), values.clone());
        (file.declared_plant.aero, file.scenario.plant.aero) = (aero(&file.declared_plant.aero), aero(&file.scenario.plant.aero));
        write_resolved_scenario(&one, &file).expect("writable");
        let mut again = read_scenario_file(&one).expect("what was written");
        prop_assert_eq!(again.declared_plant.aero.values.iter().map(|v| v.to_bits()).collect::<Vec<_>>(), values.iter().map(|v| v.to_bits()).collect::<Vec<_>>());
        (again.input, again.input_hash) = (file.input.clone(), file.input_hash.clone());
        write_resolved_scenario(&two, &again).expect("writable");
        prop_assert_eq!(bytes(&one), bytes(&two));
        write_record_csv(&dir.path().join("run.csv"), &common::waves()).expect("writable");
        let runs = [RunLine { file: "run.csv".to_owned(), kind: "perturbed".to_owned(), used: Use::HoldOut, window_s: None }];
        write_campaign_toml(&one, &file, &runs).expect("writable");
        write_campaign_toml(&two, &again, &runs).expect("writable");
        prop_assert_eq!(bytes(&one), bytes(&two));
    }

    #[test]
    fn law_records(size in prop::array::uniform3(0.01_f64..0.3), shift in -5.0_f64..5.0, start in 0.0_f64..1e3) {
        let dir = tempfile::tempdir().expect("a temporary folder");
        let path = dir.path().join("run.csv");
        let mut made = common::waves();
        for (k, axis) in made.position_m.iter_mut().enumerate() {
            axis.iter_mut().for_each(|x| *x = size[k] * *x + shift);
        }
        made.t_s.iter_mut().for_each(|t| *t += start);
        write_record_csv(&path, &made).expect("writable");
        let again = read_record_csv(&path).expect("what was written");
        prop_assert_eq!((&again.t_s, &again.position_m, &again.vw_m_s), (&made.t_s, &made.position_m, &made.vw_m_s));
        let turned = again.attitude_rad.iter().flatten().zip(made.attitude_rad.iter().flatten());
        // Degrees and back: two roundings of numbers below one.
        prop_assert!(turned.into_iter().all(|(a, b)| (a - b).abs() <= 2.0 * f64::EPSILON));
    }
}

/// What is recorded beside the motion signals is in the file that is written, and is read from it.
#[test]
fn law_slow_channels() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let path = dir.path().join("run.csv");
    let mut made = common::waves();
    made.qw_pa = Some(made.vw_m_s.iter().zip(&made.ts_k).map(|(v, t)| 0.5 * 101_325.0 / (287.05 * t) * v * v).collect());
    assert!(made.slow().iter().all(Option::is_some), "give this record every slow channel");
    write_record_csv(&path, &made).expect("writable");
    let again = read_record_csv(&path).expect("what was written");
    assert_eq!(again.slow(), made.slow());
}

/// The bundled campaign of a flight and every planet scenario, resolved, read and resolved again.
#[test]
fn law_bundled_files() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let (one, two) = (dir.path().join("one.toml"), dir.path().join("two.toml"));
    let planets = Path::new(env!("CARGO_MANIFEST_DIR")).join("planet");
    let all: Vec<_> = fs::read_dir(planets).expect("of this room").flatten().map(|e| e.path()).collect();
    // Structures and tables of wind stand beside them.
    let planets: Vec<_> = all.iter().filter(|p| kind_of(p).is_ok_and(|k| k == FileKind::Planet)).collect();
    assert!(planets.len() >= 8, "{planets:?}");
    for path in planets {
        let file = read_planet(path).expect("bundled");
        write_resolved_planet(&one, &file).expect("writable");
        let mut again = read_planet(&one).expect("what was written");
        (again.input, again.input_hash) = (file.input.clone(), file.input_hash.clone());
        write_resolved_planet(&two, &again).expect("writable");
        assert_eq!(bytes(&one), bytes(&two), "{}", path.display());
    }
    write_record_csv(&dir.path().join("run.csv"), &common::waves()).expect("writable");
    let text = "[campaign]\nname = \"ball\"\n[vehicle]\nmass_kg = 0.1\nreference_diameter_m = 0.1\n[axes]\ndown = \"-Z\"\n[environment]\n\
                gravity_m_s2 = 9.81\nair_density_kg_m3 = 1.2\n[sensors]\nposition_std_m = 1e-3\n[aero.point_mass]\nCD = 0.5\n\
                [[run]]\nfile = \"run.csv\"\nkind = \"drop\"\nuse = \"identify\"\n";
    text_atomically(&one, text).expect("writable");
    let read = read_campaign(&one).expect("a point mass");
    let Data::Point(track) = &read.runs[0].data else { panic!("a track") };
    assert_eq!(track.t_s, common::waves().t_s);
}
