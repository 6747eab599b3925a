//! Scores a closed campaign by its answer, as outside checks score it: right, exact, named beside, missed, covered.

use serde_json::Value;
use std::fmt::Write as _;

/// What came of one campaign.
#[derive(Clone, Debug, Default)]
pub(crate) struct Score {
    pub(crate) name: String,
    pub(crate) what: String,
    pub(crate) want: Vec<String>,
    pub(crate) verdict: String,
    pub(crate) named: Vec<String>,
    pub(crate) finished: bool,
    pub(crate) right: bool,
    pub(crate) exact: bool,
    pub(crate) extra: usize,
    pub(crate) missed: usize,
    /// Aerodynamic numbers whose 95 % interval holds the truth, of all with an interval.
    pub(crate) covered: [usize; 2],
    pub(crate) seconds: f64,
}

fn words(v: &Value) -> Vec<String> {
    match v {
        Value::String(s) => vec![s.clone()],
        Value::Array(all) => all.iter().filter_map(|s| s.as_str().map(str::to_owned)).collect(),
        _ => Vec::new(),
    }
}

/// Something outside the catalogue is said to act.
fn flagged(closing: &Value) -> bool {
    let failed = |e: &Value| e["form_ok"] == Value::Bool(false) || e["form"]["ok"] == Value::Bool(false);
    closing["verdict"] == "unexplained"
        || closing["unexplained"].as_array().is_some_and(|u| !u.is_empty())
        || closing["effects"].as_array().is_some_and(|e| e.iter().any(failed))
}

fn coverage(closing: &Value, aero: &Value) -> [usize; 2] {
    let mut count = [0, 0];
    for p in closing["after"]["parameters"].as_array().into_iter().flatten() {
        let interval = [&p["ci95"][0], &p["ci95"][1]].map(Value::as_f64);
        let truth = p["name"].as_str().and_then(|n| aero[n].as_f64());
        if let (Some(t), [Some(low), Some(high)], Some(s)) = (truth, interval, p["std_error"].as_f64())
            && s > 0.0
        {
            count[0] += usize::from(low <= t && t <= high);
            count[1] += 1;
        }
    }
    count
}

/// Score of `closing` (close.json; none when the program did not get that far) against its answer.
pub(crate) fn score(answer: &Value, closing: Option<&Value>, seconds: f64) -> Score {
    let want = words(&answer["family"]);
    let text = |key: &str| answer[key].as_str().unwrap_or_default().to_owned();
    let real = |w: &&String| !["none", "unexplained"].contains(&w.as_str());
    let mut s = Score {
        name: text("name"),
        what: text("what"),
        verdict: "none".to_owned(),
        missed: want.iter().filter(real).count(),
        seconds,
        ..Score::default()
    };
    let Some(c) = closing else { return Score { want, ..s } };
    let effects = c["effects"].as_array().cloned().unwrap_or_default();
    s.named = effects.iter().flat_map(|e| words(&e["family"])).collect();
    s.verdict = c["verdict"].as_str().unwrap_or_default().to_owned();
    s.finished = true;
    s.covered = coverage(c, &answer["aero"]);
    if want == ["none"] {
        s.right = s.verdict == "consistent" && s.named.is_empty();
        s.exact = s.right;
        s.extra = s.named.len();
    } else if want == ["unexplained"] {
        let form = answer["tags"]["form"].as_str().unwrap_or_default();
        let later = crate::families::LATER.contains(&form) && s.named == [form];
        s.right = flagged(c) || later;
        s.exact = s.verdict == "unexplained";
        s.extra = if s.right { 0 } else { s.named.len() };
    } else {
        effects_named(&mut s, &want, &effects);
        if answer["group"] == "G" {
            // Small: silence is right, a wrong name is not.
            s.right = s.extra == 0;
        }
    }
    Score { want, ..s }
}

fn effects_named(s: &mut Score, want: &[String], effects: &[Value]) {
    let pools: Vec<Vec<String>> = effects.iter().map(|e| [words(&e["family"]), words(&e["rivals"])].concat()).collect();
    s.missed = want.iter().filter(|w| !pools.iter().any(|p| p.contains(w))).count();
    let strange = pools.iter().filter(|p| !p.iter().any(|f| want.contains(f))).count();
    s.extra = strange + (s.named.len() - strange).saturating_sub(want.len());
    s.right = s.missed == 0 && s.named.len() <= want.len() && s.verdict != "unexplained";
    let (mut a, mut b) = (s.named.clone(), want.to_vec());
    a.sort();
    b.sort();
    s.exact = a == b;
}

/// A row per kind and one for all.
pub(crate) fn table(scores: &[Score]) -> String {
    let mut kinds: Vec<&str> = Vec::new();
    for s in scores {
        if !kinds.contains(&s.what.as_str()) {
            kinds.push(&s.what);
        }
    }
    kinds.push("all");
    let mut text = format!(
        "{:28} {:>4} {:>4} {:>5} {:>5} {:>5} {:>4} {:>7} {:>12}\n",
        "what", "n", "end", "right", "exact", "extra", "miss", "max s", "aero cover"
    );
    for kind in kinds {
        let of: Vec<&Score> = scores.iter().filter(|s| kind == "all" || s.what == kind).collect();
        let count = |f: &dyn Fn(&Score) -> bool| of.iter().filter(|s| f(s)).count();
        let covered = of.iter().fold([0, 0], |sum, s| [sum[0] + s.covered[0], sum[1] + s.covered[1]]);
        let slowest = of.iter().map(|s| s.seconds).fold(0.0, f64::max);
        let _ = writeln!(
            text,
            "{kind:28} {:4} {:4} {:5} {:5} {:5} {:4} {slowest:7.1} {:5.1} % {:>4}",
            of.len(),
            count(&|s| s.finished),
            count(&|s| s.right),
            count(&|s| s.exact),
            count(&|s| s.extra > 0),
            count(&|s| s.missed > 0),
            100.0 * covered[0] as f64 / covered[1].max(1) as f64,
            covered[1]
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn right(family: &Value, closing: &Value) -> Score {
        score(
            &json!({"name": "x", "group": "B", "what": "x", "family": family, "tags": {}, "aero": {"CA_T0": 6.0}}),
            Some(closing),
            0.0,
        )
    }
    fn said(verdict: &str, effects: &Value) -> Value {
        let p = json!([{"name": "CA_T0", "estimate": 6.1, "std_error": 0.1, "ci95": [5.9, 6.3]}]);
        json!({"verdict": verdict, "effects": effects, "unexplained": [], "after": {"parameters": p}})
    }
    fn effect(family: &str, rivals: &[&str]) -> Value {
        json!({"family": family, "rivals": rivals, "parameters": []})
    }

    #[test]
    fn law_scores_follow_the_rules() {
        let none = json!("none");
        assert!(right(&none, &said("consistent", &json!([]))).right);
        assert!(!right(&none, &said("unexplained", &json!([]))).right);
        assert_eq!(right(&none, &said("effect", &json!([effect("magnus", &[])]))).extra, 1);
        let magnus = json!("magnus");
        let rival = right(&magnus, &said("effect", &json!([effect("inertia", &["magnus"])])));
        assert!(rival.right && !rival.exact && rival.extra == 0 && rival.missed == 0);
        let more = right(&magnus, &said("effect", &json!([effect("magnus", &[]), effect("swirl", &[])])));
        assert!(!more.right && more.extra == 1 && more.missed == 0);
        let both = right(&json!(["turbulence", "magnus"]), &said("effect", &json!([effect("turbulence", &[])])));
        assert!(!both.right && both.missed == 1 && both.extra == 0);
        let unknown = json!("unexplained");
        assert!(right(&unknown, &said("unexplained", &json!([]))).right);
        assert!(!right(&unknown, &said("effect", &json!([effect("magnus", &[])]))).right);
        let mut failed = said("effect", &json!([effect("magnus", &[])]));
        failed["effects"][0]["form"] = json!({"ok": false});
        assert!(right(&unknown, &failed).right);
        assert_eq!(right(&none, &said("consistent", &json!([]))).covered, [1, 1]);
    }
}
