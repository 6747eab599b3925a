//! discover: what a single flight cannot tell. In: a contest over one recording. Out: the same without effects that a push of this flight's own
//! stands for as well, and what was set aside.
//!
//! Where flights are many, what each has of its own - a steady push: a draught, a leaning camera, an error of its clock - has a size from the
//! scatter between them. One flight shows none, so that an effect which a steady push replaces at odds of less than twenty may be that flight's
//! own: two drops of one golf ball differ by 0.7 m/s² (`ball-drops`).

use super::contest::TrackContest;
use super::rivals;
use crate::close::{ChannelResidual, Unexplained};

/// The family of a steady push.
const PUSH: &str = "constant-acceleration";

/// Sets aside, one by one, effects of the best set that are a steady push or have one as a rival.
pub(super) fn set_aside(mut found: TrackContest<'_>) -> (TrackContest<'_>, Vec<String>) {
    let mut aside = Vec::new();
    while found.evidence.recordings() == 1 {
        let own = |k: usize| {
            let names: Vec<String> = [found.family_name(found.best.families[k])].into_iter().chain(rivals(&found, k)).collect();
            names.iter().any(|n| n == PUSH).then_some((k, names))
        };
        let Some((k, names)) = (0..found.best.families.len()).find_map(own) else { break };
        let Some(rest) = found.without(k).cloned() else { break };
        found.stand_at(rest);
        aside.push(names.join(", "));
    }
    (found, aside)
}

/// Why a family of the most probable set is not named.
pub(super) fn reason(aside: &[String], family: &str) -> String {
    if aside.iter().any(|names| names.split(", ").any(|n| n == family)) {
        return "a steady push of this one flight's own would explain as much: a second flight tells".to_owned();
    }
    "a smaller set is as likely within the odds that a larger one must beat it by".to_owned()
}

/// As a line of what is unexplained, of the channel that is worst without them.
pub(super) fn described(aside: &[String], left: &[ChannelResidual]) -> Option<Unexplained> {
    let worst = left.iter().min_by(|a, b| a.p_value.total_cmp(&b.p_value))?;
    let description = format!(
        "rms {:.3e} where noise leaves {:.3e}; {} would explain it, and so would a steady push of this one flight's own: a second flight tells",
        worst.rms,
        worst.expected_rms,
        aside.join("; ")
    );
    (!aside.is_empty()).then(|| Unexplained { channel: worst.channel.clone(), description })
}
