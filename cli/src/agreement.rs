//! cli: whether instruments agree, in words. In: the identifier's examination. Out: a few lines.

use windfall::report::{p_value, with_interval};
use windfall::results::{Compatibility, InstrumentError, Instruments, Pressure, WindTunnelLine, WindTunnelModel};

/// Lines for people: pressure against speed, then what trajectories tell.
pub(crate) fn lines(c: &Compatibility) -> Vec<String> {
    let mut all: Vec<String> = c.pressure.iter().map(|p| pressure(p, 0.5 * c.false_alarm_rate)).collect();
    match &c.instruments {
        Some(i) => instruments(i, 0.5 * c.false_alarm_rate, &mut all),
        None => all.push("instruments by trajectories: not examined (output error gave no answer)".to_owned()),
    }
    all
}

/// Tunnel speed against dynamic pressure.
pub(crate) fn pressure(p: &Pressure, limit: f64) -> String {
    let scale = of(p.pressure_scale, p.pressure_scale_ci95);
    if p.computed_from_speed {
        let word = if p.p_value < limit { ": more than moisture makes; check units, p_s, T_s and the gas constant" } else { "" };
        return format!("q_W was computed from V_W and says nothing of it; it is {scale} of ½ρV_W² of dry air{word}");
    }
    let delay = p.delay_s.zip(p.delay_ci95_s).map_or_else(
        || "V_W hardly changes, so no delay is determined".to_owned(),
        |(d, ci)| format!("{} s after V_W", of(d, ci)),
    );
    let (verdict, moist) = if p.p_value < limit { ("disagree", "; moist air makes it up to 0.9 % less") } else { ("agree", "") };
    format!("q_W and V_W {verdict} (p = {}): q_W is {scale} of ½ρV_W² of dry air{moist}, {delay}", p_value(p.p_value))
}

fn of(x: f64, ci: [f64; 2]) -> String {
    let half = 0.5 * (ci[1] - ci[0]);
    if half < 1e-6 * x.abs() {
        return format!("{x:.6}");
    }
    let (x, half) = with_interval(x, Some(half));
    half.map_or_else(|| x.clone(), |h| format!("{x} ± {h}"))
}

fn error(e: &InstrumentError) -> String {
    format!("{} = {}", e.name, of(e.estimate, e.ci95))
}

fn instruments(i: &Instruments, limit: f64, all: &mut Vec<String>) {
    let list = |errors: &[InstrumentError], and: &str| errors.iter().map(error).collect::<Vec<_>>().join(and);
    if !i.residual.is_empty() {
        all.push(format!(
            "pose and V_W: not decided: the residual is not noise, whatever errors of the instruments are allowed for ({}): the declared \
             model lacks something; windfall close tells what",
            i.residual.join(", ")
        ));
    } else if i.p_value >= limit {
        let within = |e: &InstrumentError| format!("{} {:.1e}", e.name, e.ci95[1].max(-e.ci95[0]));
        let all_within = i.errors.iter().map(within).collect::<Vec<_>>().join(", ");
        all.push(format!("pose and V_W agree (p = {}); errors at most (95 %): {all_within}", p_value(i.p_value)));
    } else {
        let rivals = if i.rivals.is_empty() {
            String::new()
        } else {
            format!(", or {}, which these runs cannot tell from it", list(&i.rivals, " or "))
        };
        all.push(format!(
            "pose and V_W disagree (p = {}) under the declared structure: {} accounts for it (p = {} of what is left){rivals}; correct the \
             record before the parameters are believed",
            p_value(i.p_value),
            list(&i.account, " and "),
            p_value(i.account_p_value)
        ));
    }
    let vague: Vec<String> = i
        .correlations
        .iter()
        .map(|c| format!("{} with {} ({:+.2})", c.second, c.first, c.correlation))
        .chain(i.not_told.iter().map(|n| format!("{n} (not at all)")))
        .collect();
    if !vague.is_empty() {
        all.push(format!("  hardly distinguished by these runs: {}", vague.join(", ")));
    }
}

/// Identified static coefficients against wind-tunnel points, a line each; nothing without points.
pub(crate) fn wind_tunnel(lines: &[WindTunnelLine]) -> String {
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
