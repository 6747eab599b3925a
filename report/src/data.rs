//! report: what a page's own program reads. In: tracks and plots. Out: JSON that is safe inside HTML; series as 32-bit floats in base64.

use crate::plot::{Plot, Plots};
use serde_json::{Value, json};
use std::collections::HashMap;
use windfall_discover::close::{RunTracks, SignalTracks, TrackSignal};

/// The data of a page.
pub(crate) fn data(tracks: &[(&str, &SignalTracks)], plots: &Plots) -> String {
    let mut series = SeriesPool::default();
    let tracks: Vec<Value> = tracks.iter().map(|(id, t)| of_tracks(id, t, &mut series)).collect();
    let plots: Vec<Value> = plots.all.iter().map(of_plot).collect();
    let text = json!({ "tracks": tracks, "plots": plots, "series": series.all }).to_string();
    // Neither a tag nor a comment can begin inside it.
    text.replace('<', "\\u003c").replace('>', "\\u003e").replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029")
}

fn of_plot(plot: &Plot) -> Value {
    match plot {
        Plot::Chart(f) => serde_json::to_value(f).unwrap_or(Value::Null),
        _ => Value::Null,
    }
}

/// Packed series; one that several tracks of a page have is there once.
#[derive(Default)]
struct SeriesPool {
    all: Vec<String>,
    places: HashMap<String, usize>,
}

impl SeriesPool {
    /// The place of a series.
    fn put(&mut self, values: &[f64]) -> usize {
        let text = packed(values);
        *self.places.entry(text).or_insert_with_key(|text| {
            self.all.push(text.clone());
            self.all.len() - 1
        })
    }
}

fn of_tracks(id: &str, t: &SignalTracks, pool: &mut SeriesPool) -> Value {
    let runs: Vec<Value> = t.runs.iter().map(|r| of_run(r, pool)).collect();
    json!({ "id": id, "campaign": t.campaign, "body": t.body, "before": t.before, "after": t.after, "runs": runs })
}

fn of_run(r: &RunTracks, pool: &mut SeriesPool) -> Value {
    let channels: Vec<Value> = r.channels.iter().map(|c| of_channel(c, pool)).collect();
    json!({ "name": r.name, "kind": r.kind, "use": r.used, "t": pool.put(&r.t_s), "interior": r.interior_s, "channels": channels })
}

fn of_channel(c: &TrackSignal, pool: &mut SeriesPool) -> Value {
    json!({ "name": c.name, "unit": c.unit, "noise": c.noise_std, "measured": pool.put(&c.measured), "before": pool.put(&c.before),
            "after": pool.put(&c.after) })
}

/// Little-endian floats in base64 (RFC 4648).
fn packed(values: &[f64]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    #[expect(clippy::cast_possible_truncation, reason = "seven digits are drawn")]
    let bytes: Vec<u8> = values.iter().flat_map(|v| (*v as f32).to_le_bytes()).collect();
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let word = three.iter().fold(0_u32, |w, b| (w << 8) | u32::from(*b)) << (8 * (3 - three.len()));
        for k in 0..4 {
            let letter = LETTERS[(word >> (18 - 6 * k)) as usize & 63];
            out.push(if k <= three.len() { char::from(letter) } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1.0 is 00 00 80 3f; two of them, and one with the filling.
    #[test]
    fn exact_floats_in_base64() {
        assert_eq!(packed(&[1.0]), "AACAPw==");
        assert_eq!(packed(&[1.0, 1.0, 1.0]), "AACAPwAAgD8AAIA/");
    }

    #[test]
    fn law_no_tag_ends_the_data() {
        let tracks = SignalTracks { campaign: "</script><script>alert(1)</script>".to_owned(), ..SignalTracks::default() };
        let text = data(&[("tracks", &tracks)], &Plots::default());
        assert!(!text.contains('<'), "{text}");
        assert_eq!(serde_json::from_str::<Value>(&text).expect("JSON")["tracks"][0]["campaign"], tracks.campaign);
    }
}
