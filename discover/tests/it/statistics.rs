//! discover: closing against published statistics. In: the bundled Table 5.6. Out: what closes it, within its own sampling error.

#![expect(clippy::print_stdout, reason = "a test prints what it measured")]

use windfall_discover::statistics::{
    FigureQuantity, Moment, StatisticFigure, StatisticsClosing, StatisticsOptions, StatisticsSetup, close_statistics,
    statistics_table,
};
use windfall_model::{Flight, Plant};
use windfall_scenarios::StatisticsFile;

fn figures(file: &StatisticsFile) -> Vec<StatisticFigure> {
    let figure = |f: &windfall_scenarios::PublishedFigure| StatisticFigure {
        quantity: FigureQuantity::from_name(&f.quantity).expect("the reader checks it"),
        statistic: Moment::from_name(&f.statistic).expect("the reader checks it"),
        test: f.test,
        simulation: f.simulation,
        fitted: f.fitted,
    };
    file.figures.iter().map(figure).collect()
}

fn closed(
    file: &StatisticsFile,
    plant: &Plant,
    flight: &Flight,
    figures: Vec<StatisticFigure>,
    options: &StatisticsOptions,
) -> StatisticsClosing {
    let names = (file.name.as_str(), file.source.as_str());
    let setup = StatisticsSetup::new(names, file.seed, plant.clone(), flight.clone(), figures).expect("valid figures");
    let closing = close_statistics(&setup, options).expect("the declared model flies");
    println!("{}{} flights", statistics_table(&closing), closing.flights);
    closing
}

#[test]
#[ignore = "slow: 3 min of processor time"]
fn pub_table_5_6_closes() {
    let file = windfall_scenarios::bundled_statistics().expect("valid");
    let start = std::time::Instant::now();
    let closing = closed(&file, &file.plant, &file.flight, figures(&file), &StatisticsOptions::default());
    for s in closing.screened.iter().filter(|s| s.leads) {
        println!("{s:?}");
    }
    for s in &closing.separations {
        println!("{s:?}");
    }
    println!("{:?}\n{:.1} s", closing.processing, start.elapsed().as_secs_f64());
    // Thesis: mean Θ 48 % and mean ω_q,r 91 % below the test.
    assert!((closing.before[0].relative + 0.48).abs() < 0.02 && (closing.before[3].relative + 0.91).abs() < 0.02);
    assert!(closing.before_p_value < 0.05);
    assert_eq!(closing.verdict, "effect");
    let best = &closing.explanations[0];
    assert!(best.possible, "{}", best.p_value);
    for f in best.figures.iter().filter(|f| f.fitted) {
        assert!(f.inside && f.relative.abs() <= 0.15, "{f:?}");
    }
}

/// Figures that a planted gust makes, as means over runs of 20 s: found again, its size inside the interval.
#[test]
#[ignore = "slow: nightly"]
fn recover_a_planted_gust_from_its_statistics() {
    let file = windfall_scenarios::bundled_statistics().expect("valid");
    let flight = Flight { duration_s: 20.0, ..file.flight.clone() };
    let mut truth = file.plant.clone();
    (truth.turbulence.lateral_rms_m_s, truth.turbulence.lateral_scale_m, truth.turbulence.axial_scale_m) = (0.15, 0.6, 0.6);
    let few = StatisticsOptions {
        screen_points: 1,
        leads: 0,
        kept: [0, 0],
        pairs: 0,
        pair_points: 0,
        fine_runs: 10,
        final_runs: 60,
        ..StatisticsOptions::default()
    };
    let mut planted = figures(&file);
    let flown = closed(&file, &truth, &flight, planted.clone(), &few);
    planted.iter_mut().zip(&flown.before).for_each(|(f, b)| f.test = b.mean);
    let options = StatisticsOptions { screen_points: 8, leads: 2, kept: [1, 0], coarse_runs: 4, fine_runs: 16, ..few };
    let closing = closed(&file, &file.plant, &flight, planted, &options);
    assert_eq!(closing.verdict, "effect");
    let best = &closing.explanations[0];
    assert_eq!(best.families, ["turbulence"]);
    assert!(best.closes && best.possible);
    let size = best.parameters.iter().find(|p| p.name == "lateral_rms_m_s").expect("a strength");
    assert!((size.ci95[0]..=size.ci95[1]).contains(&0.15), "{size:?}");
    // Its range is four decades.
    assert!(size.decided, "{size:?}");
}
