//! report: a drawing as a list of marks. In: places in drawing units, y downward. Out: what SVG and PDF are written from.

/// How a mark looks; both writers know every one of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Look {
    /// Measured.
    Measured,
    /// Declared model.
    Before,
    /// With the effects added, or identified.
    After,
    /// What noise alone leaves.
    Noise,
    /// Lines of axes and grids.
    Axis,
    /// A line that values are held against.
    Mark,
    /// Neither before nor after.
    Plain,
    /// A measured point.
    Point,
    /// Labels.
    Soft,
    /// Names.
    Ink,
}

impl Look {
    /// Class on a page.
    pub(crate) fn class(self) -> &'static str {
        match self {
            Self::Measured => "measured",
            Self::Before => "before",
            Self::After => "after",
            Self::Noise => "noise",
            Self::Axis => "axis",
            Self::Mark => "one",
            Self::Plain => "plain",
            Self::Point => "point",
            Self::Soft => "soft",
            Self::Ink => "ink",
        }
    }
    /// Colour on paper: vermilion and blue of Okabe and Ito (2008), which colour-blind eyes tell apart, and greys.
    pub(crate) fn rgb(self) -> [u8; 3] {
        match self {
            Self::Before => [0xc2, 0x54, 0x1b],
            Self::After => [0x17, 0x69, 0xaa],
            Self::Measured | Self::Plain => [0x8a, 0x94, 0x9d],
            Self::Noise | Self::Mark => [0x6d, 0x77, 0x80],
            Self::Point => [0x2b, 0x33, 0x3a],
            Self::Axis => [0xd9, 0xde, 0xe3],
            Self::Soft => [0x4a, 0x54, 0x5d],
            Self::Ink => [0x1d, 0x23, 0x29],
        }
    }
    /// Width of a line, drawing units.
    pub(crate) fn width(self) -> f64 {
        match self {
            Self::Measured => 3.2,
            Self::Axis => 1.0,
            _ => 1.5,
        }
    }
    /// Dashes, drawing units.
    pub(crate) fn dash(self) -> Option<[f64; 2]> {
        match self {
            Self::Noise => Some([4.0, 3.0]),
            Self::Mark => Some([3.0, 3.0]),
            _ => None,
        }
    }
}

/// Which end of a text is at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// One mark.
#[derive(Clone, Debug)]
pub(crate) enum Item {
    /// Connected points; several pieces.
    Line { look: Look, pieces: Vec<Vec<[f64; 2]>> },
    /// A filled outline, thin enough to see through.
    Area { look: Look, points: Vec<[f64; 2]> },
    /// A filled rectangle: left, top, width, height.
    Rect { look: Look, at: [f64; 4] },
    /// A filled disc.
    Disc { look: Look, at: [f64; 2], radius: f64 },
    /// Words; `turned`: read from below.
    Text { look: Look, at: [f64; 2], anchor: Anchor, turned: bool, text: String },
}

/// A figure as marks.
#[derive(Clone, Debug)]
pub(crate) struct LineDrawing {
    pub(crate) title: String,
    pub(crate) size: [f64; 2],
    /// Largest size on a page, as a share of its own: figures of text keep theirs.
    pub(crate) fixed: bool,
    pub(crate) items: Vec<Item>,
}

impl LineDrawing {
    pub(crate) fn line(&mut self, look: Look, points: &[[f64; 2]]) {
        self.items.push(Item::Line { look, pieces: vec![points.to_vec()] });
    }
    pub(crate) fn text(&mut self, look: Look, at: [f64; 2], anchor: Anchor, text: impl Into<String>) {
        self.items.push(Item::Text { look, at, anchor, turned: false, text: text.into() });
    }
}

/// Size of letters, drawing units.
pub(crate) const LETTERS: f64 = 11.0;

/// Width of Helvetica's characters from the space to `~`, thousandths of the size (Adobe font metrics of the base fonts).
const WIDTHS: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556, 556, 556, 556, 556, 556, 556,
    556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778,
    722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278, 556, 556, 222, 222,
    500, 222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584,
];

/// Width of a text, drawing units; of what Helvetica lacks a mean.
pub(crate) fn width(text: &str) -> f64 {
    let one = |c: char| match c {
        ' '..='~' => f64::from(WIDTHS[c as usize - 32]),
        '\u{a0}' => 278.0,
        _ => 580.0,
    };
    text.chars().map(one).sum::<f64>() / 1000.0 * LETTERS
}
