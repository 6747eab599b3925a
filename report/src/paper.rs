//! report: figures for papers. In: plots of a page, a column's width. Out: SVG, PDF and CSV of each, in one style.

use crate::draw::LETTERS;
use crate::html::slug;
use crate::plot::Plots;
use crate::{pdf, svg};

/// Width of a column, mm, where none is asked for: a single column of most journals.
pub const WIDTH_MM: f64 = 86.0;
/// Size of letters on paper, points.
const LETTERS_PT: f64 = 8.0;
/// Points in a millimetre.
const PT_MM: f64 = 72.0 / 25.4;
/// Height over width of a chart.
const SHAPE: f64 = 0.62;

/// One figure as files.
#[derive(Clone, Debug, PartialEq)]
pub struct PaperFigure {
    /// Name without ending.
    pub name: String,
    /// Title, as in the page.
    pub title: String,
    /// Vector drawing.
    pub svg: String,
    /// The same as PDF.
    pub pdf: Vec<u8>,
    /// The data, a row a point.
    pub csv: String,
}

/// Every plot, `width_mm` wide, letters of eight points.
pub(crate) fn paper(plots: &Plots, width_mm: f64) -> Vec<PaperFigure> {
    let points_of_unit = LETTERS_PT / LETTERS;
    let w = width_mm * PT_MM / points_of_unit;
    let one = |(k, p): (usize, &crate::plot::Plot)| {
        let d = p.drawing([w, SHAPE * w])?;
        Some(PaperFigure {
            name: format!("{:02}-{}", k + 1, slug(name(p.title()))),
            title: p.title().to_owned(),
            svg: svg::file(&d, width_mm),
            pdf: pdf::file(&d, points_of_unit),
            csv: p.csv(),
        })
    };
    plots.all.iter().enumerate().filter_map(one).collect()
}

/// A title without the numbers behind it, which would give the file another name after every change of the data.
fn name(title: &str) -> &str {
    [", ±", " (beyond"].iter().fold(title, |t, mark| t.split(mark).next().unwrap_or(t))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_names_do_not_follow_the_numbers() {
        assert_eq!(name("C_A over α_T, ± 0.2000 at most"), "C_A over α_T");
        assert_eq!(name("X: distribution (beyond the ends: declared model 4 %)"), "X: distribution");
        assert_eq!(name("Coverage"), "Coverage");
    }
}
