//! cli: identified curves beside wind-tunnel points, in words. In: lines of a result. Out: a few lines.

use windfall::results::{WindTunnelLine, WindTunnelModel};

/// Identified static coefficients against wind-tunnel points, a line each; nothing without points.
pub(crate) fn lines(lines: &[WindTunnelLine]) -> String {
    let side = |m: &WindTunnelModel, n: usize| {
        let apart = m.apart.map_or_else(String::new, |a| format!(", {a} of {n} beyond 95 % of both"));
        let beyond = if m.beyond_runs > 0 { format!(", {} beyond the angles flown", m.beyond_runs) } else { String::new() };
        format!("{} rms {} mean {:+.3e}{apart}{beyond}", m.model, windfall::report::number(m.rms), m.mean)
    };
    let one = |l: &WindTunnelLine| {
        let models: Vec<String> = l.models.iter().map(|m| side(m, l.measured.len())).collect();
        format!("  {:<6}{}: {}\n", l.quantity, l.test, models.join("; "))
    };
    let all: String = lines.iter().map(one).collect();
    if all.is_empty() { all } else { format!("\nwind-tunnel points less model (nothing is fitted to them)\n{all}") }
}
