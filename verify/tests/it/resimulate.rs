//! verify tests: re-simulation. In: shared campaigns and known parameters. Out: whether flights meet the runs.

use crate::common::*;
use windfall_verify::{estimate_initial, hold_out};

#[test]
fn recover_trajectories_to_the_noise_floor() {
    let Some(campaign) = campaign("recover_trajectories_to_the_noise_floor", "open-00") else { return };
    let mut plant = campaign.plant.clone();
    plant.aero.values = TABLE_5_5.to_vec();
    let t = std::time::Instant::now();
    let all: Vec<usize> = (0..campaign.runs.len()).collect();
    let h = hold_out(&campaign, &plant, &all, 1).expect("flies");
    eprintln!("{:?} s", t.elapsed());
    for r in &h.runs {
        eprintln!(
            "{} {:?} first {:?} misfit {} {:?} {:?} {:?}",
            r.name,
            r.trajectory,
            r.trajectory_from_first_sample,
            r.misfit,
            r.initial,
            r.specific_force_rms,
            r.specific_moment_rms
        );
        for s in &r.statistics {
            eprintln!("   {s:?}");
        }
    }
    for s in &h.statistics {
        eprintln!("{s:?}");
    }
    if let windfall_model::Data::Tunnel(record) = &campaign.runs[2].data {
        let t = std::time::Instant::now();
        let i = estimate_initial(record, &plant).expect("x");
        eprintln!("{:?} {:?}", t.elapsed(), i);
    }
}
