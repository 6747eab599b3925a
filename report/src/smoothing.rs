//! report: what smoothing takes out of the records. In: raw and smoothed signals with their spectra. Out: two sections.

use crate::html::section;
use crate::legend::key;
use crate::plot::Plots;
use crate::signals::over_time;
use windfall_discover::close::SmoothingTracks;

/// Name of these tracks in the page's data.
pub(crate) const ID: &str = "smoothing";

/// Raw and smoothed signals over time, then their spectra with the filter's cut-off; nothing without runs.
pub(crate) fn smoothing(s: Option<&SmoothingTracks>, plots: &mut Plots) -> String {
    let Some(s) = s else { return String::new() };
    let lead = "Look for a raw record less the smoothed one that has no shape and stays between the dashed lines: two standard deviations of the \
                sensor's noise as declared. What has a shape there was smoothed away.";
    let signals = over_time(ID, &s.signals).map_or_else(String::new, |body| section("Raw and smoothed signals", lead, &body));
    let lead = "Look for a raw spectrum that has come down to the level of the noise before the cut-off: then smoothing takes noise alone. A \
                peak beyond the cut-off is a line in the record or a motion that was cut away. Amplitude spectral density, mean power of all runs; \
                the cut-off is half the spline's rate of knots, or that of the thesis' Wiener filter.";
    let drawn = plots.charts(s.spectra.iter().cloned());
    if drawn.is_empty() {
        return signals;
    }
    let marks = [("measured", "raw record"), ("after", "smoothed"), ("noise", "white noise as declared"), ("cut", "cut-off")];
    signals + &section("Spectra and the filter's cut-off", lead, &format!("{}<div class=\"grid\">{drawn}</div>\n", key(&marks)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::Plot;
    use windfall_discover::close::{BodyShape, Figure, Role, RunTracks, Series, SignalTracks, Topic, TrackSignal};

    #[test]
    fn law_spectra_are_drawn_with_their_cut_off() {
        let (x, y) = (vec![0.1, 1.0, 10.0], vec![1.0, 0.1, 1e-3]);
        let figure = Figure {
            topic: Topic::Spectrum,
            title: "X: spectrum".to_owned(),
            x_label: "frequency (Hz)".to_owned(),
            y_label: "amplitude (m/√Hz)".to_owned(),
            log_y: true,
            log_x: true,
            marks: vec![2.5],
            series: vec![Series { role: Role::Measured, x, y, ..Series::default() }],
            ..Figure::default()
        };
        let (name, unit) = ("X".to_owned(), "m".to_owned());
        let series = vec![0.0, 0.5, 1.0];
        let channel =
            TrackSignal { name, unit, noise_std: Some(0.1), measured: series.clone(), before: Vec::new(), after: series.clone() };
        let run = RunTracks {
            name: "a".to_owned(),
            kind: String::new(),
            used: "identify".to_owned(),
            t_s: series,
            channels: vec![channel],
            notes: Vec::new(),
            interior_s: None,
        };
        let signals = SignalTracks { runs: vec![run], body: BodyShape::default(), ..SignalTracks::default() };
        let mut plots = Plots::default();
        let page = smoothing(Some(&SmoothingTracks { signals, spectra: vec![figure] }), &mut plots);
        for text in ["Raw and smoothed signals", "data-tracks=\"smoothing\"", "cut-off", "line one"] {
            assert!(page.contains(text), "{text} in {page}");
        }
        // Three places on a logarithmic axis: the mark at 2.5 Hz lies log(25)/log(100) of the way from 0.1 to 10 Hz.
        let drawing = plots.all[0].drawing([400.0, 200.0]).expect("a drawing");
        let lines = |look: crate::draw::Look| {
            let of = move |i: &crate::draw::Item| match i {
                crate::draw::Item::Line { look: own, pieces } if *own == look => Some(pieces[0].clone()),
                _ => None,
            };
            drawing.items.iter().filter_map(of).collect::<Vec<_>>()
        };
        let (curve, mark) = (&lines(crate::draw::Look::Measured)[0], &lines(crate::draw::Look::Mark)[0]);
        let way = (mark[0][0] - curve[0][0]) / (curve[2][0] - curve[0][0]);
        assert!((way - 25.0_f64.log10() / 2.0).abs() < 1e-9, "{way}");
        let Plot::Chart(f) = &plots.all[0] else { panic!("a chart") };
        assert!(plots.all[0].csv().contains("mark,2.5,,,\n") && f.log_x);
        assert!(smoothing(None, &mut plots).is_empty());
    }
}
