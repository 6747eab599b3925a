//! report: the page of any folder of results. In: results as they were read. Out: HTML, and figures as files; what has no page of its own
//! is laid out as tables.

use crate::closing::{closing_body, footer};
use crate::data::data;
use crate::descent::descent_body;
use crate::html::{escape, page, section};
use crate::identification::{identification, resimulation};
use crate::laid_out::laid_out;
use crate::many::{TITLE, many_body};
use crate::one_to_one::one_to_one;
use crate::paper::{PaperFigure, paper};
use crate::plot::Plots;
use crate::signals::signals;
use crate::smoothing::smoothing;
use crate::statistics::statistics;
use crate::study::study_body;
use serde_json::Value;
use windfall_discover::close::{Closing, Figure, SignalTracks, SmoothingTracks};
use windfall_replay::descent::DescentSummary;
use windfall_study::Summary;
use windfall_study::many::ManySummary;

/// What a folder holds.
#[derive(Default)]
pub struct FolderResults<'a> {
    /// A closing with a campaign.
    pub closing: Option<&'a Closing>,
    /// Its figures.
    pub figures: &'a [Figure],
    /// Its signals.
    pub tracks: Option<&'a SignalTracks>,
    /// Coefficients over time of an identification.
    pub coefficients: Option<&'a SignalTracks>,
    /// Signals of a re-simulation.
    pub flights: Option<&'a SignalTracks>,
    /// Raw and smoothed records.
    pub smoothing: Option<&'a SmoothingTracks>,
    /// A study.
    pub study: Option<&'a Summary>,
    /// Many campaigns.
    pub many: Option<&'a ManySummary>,
    /// Descents.
    pub descents: Option<&'a DescentSummary>,
    /// Any other results: title, then the JSON.
    pub others: &'a [(String, Value)],
}

/// The page of a folder.
#[must_use]
pub fn folder_page(title: &str, results: &FolderResults<'_>) -> String {
    let mut plots = Plots::default();
    let body = body(title, results, &mut plots);
    let smoothed = results.smoothing.map(|s| &s.signals);
    let named = [
        ("tracks", results.tracks),
        ("coefficients", results.coefficients),
        ("flights", results.flights),
        (crate::smoothing::ID, smoothed),
    ];
    let named: Vec<(&str, &SignalTracks)> = named.into_iter().filter_map(|(id, t)| Some((id, t?))).collect();
    page(&heading(title, results), &body, &data(&named, &plots))
}

/// The page of one result among many, by its file's name and text; none of another file.
#[must_use]
pub fn campaign_page(title: &str, file: &str, text: &str) -> Option<String> {
    if file == "close.json" {
        let closing: Closing = serde_json::from_str(text).ok()?;
        return Some(folder_page(title, &FolderResults { closing: Some(&closing), ..FolderResults::default() }));
    }
    let others = [("Identification".to_owned(), serde_json::from_str(text).ok()?)];
    Some(folder_page(title, &FolderResults { others: &others, ..FolderResults::default() }))
}

/// The figures of a folder's page as files, `width_mm` wide.
#[must_use]
pub fn folder_figures(title: &str, results: &FolderResults<'_>, width_mm: f64) -> Vec<PaperFigure> {
    let mut plots = Plots::default();
    body(title, results, &mut plots);
    paper(&plots, width_mm)
}

/// The campaign's name where a result tells it, and what the results are.
fn heading(title: &str, r: &FolderResults<'_>) -> String {
    let campaign = r.closing.map(|c| c.campaign.as_str()).or_else(|| {
        let named = [r.tracks, r.coefficients, r.flights].into_iter().flatten().map(|t| t.campaign.as_str());
        named.into_iter().find(|n| !n.is_empty())
    });
    let named = r.others.iter().find_map(|(_, v)| v.get("name")?.as_str());
    campaign
        .or(r.study.map(|s| s.study.as_str()))
        .or(r.many.map(|_| TITLE))
        .or(r.descents.map(|d| d.scenario.as_str()))
        .or(named)
        .unwrap_or(title)
        .to_owned()
}

fn body(title: &str, results: &FolderResults<'_>, plots: &mut Plots) -> String {
    let mut body = String::new();
    if let Some(c) = results.closing {
        body += &closing_body(c, results.figures, results.tracks, plots);
    }
    if let Some(s) = results.study {
        body += &study_body(s, plots);
    }
    if let Some(m) = results.many {
        body += &many_body(m, plots);
    }
    if let Some(d) = results.descents {
        body += &descent_body(d, plots);
    }
    if body.is_empty() {
        body = format!("<h1>{}</h1>\n", escape(&heading(title, results)));
    }
    for (name, value) in results.others {
        let own = match value {
            v if v.get("data_sets").is_some() => identification(v, plots),
            v if v.get("trajectory").is_some() => resimulation(v, plots),
            v if v.get("explanations").is_some() => statistics(v, plots),
            _ => None,
        };
        body += &own.unwrap_or_else(|| section(name, "", &laid_out(value, 3)));
    }
    body += &results.coefficients.map_or_else(String::new, |t| one_to_one(t, plots) + &signals("coefficients", t));
    body += &results.flights.map_or_else(String::new, |t| signals("flights", t));
    body += &smoothing(results.smoothing, plots);
    body + &results.closing.map_or_else(String::new, |_| footer())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identified() -> Value {
        serde_json::json!({"method": "output-error", "reason": "noise is all there is", "warnings": ["run <a>: bridged"],
            "data_sets": [{"name": "combined", "runs": ["<r>"], "condition_number": 3.0, "n_samples": 10, "covariance": [[123.456]],
            "fits": [{"coefficient": "CA", "r2": 0.99, "residual_std": 0.1, "residual_whiteness_p": 0.5}],
            "parameters": [{"coefficient": "CA", "name": "CA_T0", "estimate": 6.662, "std_error": 0.01, "rse_percent": 0.15,
                "ci95": [6.642, 6.682], "std_error_white": 0.01}],
            "curves": [{"quantity": "C_A", "over": "alpha_T", "angle_deg": [0.0, 10.0, 20.0], "value": [6.6, 6.5, 6.2],
                "low": [6.5, 6.4, 6.0], "high": [6.7, 6.6, 6.4]}]}]})
    }

    #[test]
    fn law_an_identification_has_a_page() {
        let others = [("Identification".to_owned(), identified())];
        let results = FolderResults { others: &others, ..Default::default() };
        let page = folder_page("r", &results);
        for text in
            ["C_A over α_T, ± 0.2000 at most", "band after", "6.642", "noise is all there is", "&lt;r&gt;", "run &lt;a&gt;"]
        {
            assert!(page.contains(text), "{text}");
        }
        assert!(!page.contains("123.4"), "a covariance is no table to read");
        // Estimates, one for the coefficient; the curve.
        let figures = folder_figures("r", &results, 86.0);
        assert_eq!(figures.len(), 2);
        assert!(figures.iter().all(|f| f.svg.contains("width=\"86mm\"") && f.pdf.starts_with(b"%PDF-1.4")));
    }

    #[test]
    fn law_any_result_is_laid_out_and_escaped() {
        let value =
            serde_json::json!({"verdict": "<pass>", "n": 3, "ci95": [1.0, 2.0], "checks": [{"name": "energy", "bound": 6.662}]});
        let page = folder_page("results", &FolderResults { others: &[("Checks".to_owned(), value)], ..Default::default() });
        for text in ["&lt;pass&gt;", "[1.000, 2.000]", "energy", "6.662"] {
            assert!(page.contains(text), "{text}");
        }
        assert!(!page.contains("<pass>"));
    }
}
