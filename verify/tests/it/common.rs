//! verify tests: shared data and the plant of the thesis. In: names. Out: campaigns.

use std::io::Write as _;
use std::path::PathBuf;
use windfall_model::{Campaign, Plant, Scenario};
use windfall_scenarios::{read_bundled, read_campaign};
use windfall_verify::close::{Closing, Options, close};

/// Thesis Table 5.5, with the yaw damping equal to that of pitch.
pub(crate) const TABLE_5_5: [f64; 11] =
    [6.6620, 3.5129, -2.0035, 0.0125, -5.6816, -2.0655, 2.5278, -3.3025, -205.4289, -3.3025, -205.4289];

/// Folder of shared data, if there is one; otherwise says that the named test is skipped.
pub(crate) fn shared(test: &str) -> Option<PathBuf> {
    let root = std::env::var_os("WINDFALL_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared"), PathBuf::from);
    if root.join("data/campaigns").is_dir() {
        return Some(root);
    }
    // Past the harness, which keeps to itself what a passing test prints.
    let _ = writeln!(std::io::stderr(), "skipped: {test}: no shared data");
    None
}

/// A shared campaign by name.
pub(crate) fn campaign(test: &str, name: &str) -> Option<Campaign> {
    let path = shared(test)?.join("data/campaigns").join(name).join("campaign.toml");
    Some(read_campaign(&path).expect("a shared campaign is well-formed"))
}

/// A bundled campaign of what others measured, by its file.
pub(crate) fn measured(file: &str) -> Campaign {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../benchmarks/measured").join(file);
    read_campaign(&path).expect("a bundled campaign is well-formed")
}

/// Closes a campaign, and says on the error stream what was found.
pub(crate) fn closed(c: &Campaign) -> Closing {
    let begun = std::time::Instant::now();
    let closing = close(c, &Options::default()).expect("closes");
    eprintln!("{}: {:?} in {:.1} s, {} runs", c.name, closing.verdict, begun.elapsed().as_secs_f64(), c.runs.len());
    for r in closing.residual.per_channel.iter().zip(&closing.residual_after.per_channel) {
        eprintln!("  {} rms {:.4} -> {:.4}, p {:.1e} -> {:.1e}", r.0.channel, r.0.rms, r.1.rms, r.0.p_value, r.1.p_value);
    }
    for e in &closing.effects {
        eprintln!("  {} p {:.1e} probability {:?} rivals {:?}", e.family, e.p_value, e.probability, e.rivals);
        e.parameters.iter().for_each(|p| eprintln!("    {} = {:.5} ± {:?} {}", p.name, p.estimate, p.std_error, p.unit));
    }
    closing.constants.iter().for_each(|k| eprintln!("  {} {} -> {} ± {:?}", k.key, k.declared, k.estimate, k.std_error));
    closing.shifts.iter().for_each(|p| eprintln!("  {} {:.4} -> {:.4} ± {:.4}", p.name, p.before, p.after, p.std_error_after));
    closing.after.parameters.iter().for_each(|p| eprintln!("  {} = {} ± {:?}", p.name, p.estimate, p.std_error));
    closing.candidates.iter().for_each(|k| eprintln!("  candidate {} {:.1} p {:.1e}", k.family, k.score, k.p_value));
    closing.sets.iter().for_each(|s| eprintln!("  set {:?} {:.3}", s.families, s.probability));
    eprintln!("  held out {:?} -> {:?}", closing.before.hold_out, closing.after.hold_out);
    closing.unexplained.iter().for_each(|u| eprintln!("  unexplained {}: {}", u.channel, u.description));
    closing
}

/// Families named, in order of their names.
pub(crate) fn families(c: &Closing) -> Vec<&str> {
    let mut all: Vec<&str> = c.effects.iter().map(|e| e.family.as_str()).collect();
    all.sort_unstable();
    all
}

/// The campaign's plant with the true parameters of the shared data.
pub(crate) fn with_table_5_5(campaign: &Campaign) -> Plant {
    let mut plant = campaign.plant.clone();
    plant.aero.values = TABLE_5_5.to_vec();
    plant
}

/// A bundled scenario.
pub(crate) fn bundled(name: &str) -> Scenario {
    read_bundled(name).expect("bundled scenarios are well-formed").scenario
}
