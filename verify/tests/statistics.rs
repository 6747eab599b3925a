//! verify: closing against published statistics. In: the bundled Table 5.6. Out: what closes it, within its own sampling error.

#![expect(clippy::print_stdout, reason = "a test prints what it measured")]

use windfall_scenarios::StatisticsFile;
use windfall_verify::statistics::{
    Figure, Moment, Quantity, StatisticsOptions, StatisticsSetup, close_statistics, statistics_table,
};

fn setup(file: &StatisticsFile) -> StatisticsSetup {
    let figure = |f: &windfall_scenarios::PublishedFigure| Figure {
        quantity: Quantity::from_name(&f.quantity).expect("the reader checks it"),
        statistic: Moment::from_name(&f.statistic).expect("the reader checks it"),
        test: f.test,
        simulation: f.simulation,
        fitted: f.fitted,
    };
    let figures = file.figures.iter().map(figure).collect();
    StatisticsSetup::new((&file.name, &file.source), file.seed, file.plant.clone(), file.flight.clone(), figures).expect("valid")
}

#[test]
#[ignore = "slow: 60 s on two cores"]
fn pub_table_5_6_closes() {
    let file = windfall_scenarios::bundled_statistics().expect("valid");
    let start = std::time::Instant::now();
    let closing = close_statistics(
        &setup(&file),
        &StatisticsOptions { screen_points: 12, final_runs: 200, fine_runs: 24, ..StatisticsOptions::default() },
    )
    .expect("the declared model flies");
    println!("{}", statistics_table(&closing));
    for s in &closing.screened {
        println!("{s:?}");
    }
    for s in &closing.separations {
        println!("{s:?}");
    }
    println!("{:?}\n{} flights, {:.1} s", closing.processing, closing.flights, start.elapsed().as_secs_f64());
}
