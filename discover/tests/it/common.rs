//! discover tests: measured sets and what closing says of them. In: names. Out: campaigns, closings.

use std::path::PathBuf;
use windfall_discover::close::{Closing, Options, close};
use windfall_model::{Campaign, Scenario};
use windfall_scenarios::{read_bundled, read_campaign};

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

/// A bundled scenario.
pub(crate) fn bundled(name: &str) -> Scenario {
    read_bundled(name).expect("bundled scenarios are well-formed").scenario
}
