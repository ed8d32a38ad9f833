//! Lettering: text as single strokes of a pen, in the Hershey simplex sans (NOTICE.txt beside this file).

mod glyph;
#[cfg(feature = "svg")]
mod truetype;

use glyph::CAPITAL;
pub(crate) use glyph::glyph;
use std::fmt::Write as _;

#[cfg(feature = "svg")]
pub(crate) use truetype::{drawn_once, font as truetype_font};

/// Distance of the base lines of two lines of text, in heights of capital letters.
const LINE: f64 = 1.75;
/// Speed along the strokes in G-code [mm/min]; a reader's own speed takes its place.
const FEED: u32 = 1200;

/// Where the lines of a text meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// At the left.
    #[default]
    Left,
    /// In the middle.
    Middle,
    /// At the right.
    Right,
}

/// How a text is laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// Height of capital letters [m].
    pub size: f64,
    /// Distance between letters beyond the font's own [m].
    pub spacing: f64,
    /// Where the lines meet.
    pub align: Align,
}

/// Why a text cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LetteringError {
    /// Characters without a glyph.
    #[error(
        "the font has no {0}: it has Latin letters, also with accents, digits and signs; leave them out, or draw them as an \
         SVG with their outlines"
    )]
    NoGlyph(String),
    /// Nothing is drawn.
    #[error("the text has nothing to draw: give letters, digits or signs")]
    Empty,
}

/// A text as strokes in a box whose lower left corner is (0, 0) [m].
#[derive(Clone, Debug, PartialEq)]
pub struct Lettering {
    /// The strokes [m].
    pub strokes: Vec<Vec<[f64; 2]>>,
    /// Width and height of the box around them [m].
    pub size: [f64; 2],
}

impl Lettering {
    /// The strokes of a text, whose lines are divided by line feeds.
    ///
    /// # Errors
    /// A character without a glyph, or nothing to draw.
    pub fn new(text: &str, layout: &Layout) -> Result<Self, LetteringError> {
        let unit = layout.size / CAPITAL;
        let mut lines = Vec::new();
        let mut missing: Vec<char> = Vec::new();
        for line in text.lines() {
            let mut x = 0.0;
            let mut strokes: Vec<Vec<[f64; 2]>> = Vec::new();
            for of in line.chars() {
                let Some(glyph) = glyph(of) else {
                    if !missing.contains(&of) {
                        missing.push(of);
                    }
                    continue;
                };
                let placed = |&[u, v]: &[f64; 2]| [x + unit * u, unit * v];
                strokes.extend(
                    glyph
                        .strokes
                        .iter()
                        .map(|it| it.iter().map(placed).collect()),
                );
                x += unit * glyph.advance + layout.spacing;
            }
            lines.push((x - layout.spacing, strokes));
        }
        if !missing.is_empty() {
            return Err(LetteringError::NoGlyph(named(&missing)));
        }
        let widest = lines.iter().map(|&(width, _)| width).fold(0.0, f64::max);
        let share = match layout.align {
            Align::Left => 0.0,
            Align::Middle => 0.5,
            Align::Right => 1.0,
        };
        let mut strokes = Vec::new();
        for (index, (width, of_line)) in lines.into_iter().enumerate() {
            let right = share * (widest - width);
            let down = index as f64 * LINE * layout.size;
            let placed = |[x, y]: [f64; 2]| [x + right, y - down];
            strokes.extend(
                of_line
                    .into_iter()
                    .map(|it| it.into_iter().map(placed).collect()),
            );
        }
        Self::in_corner(strokes).ok_or(LetteringError::Empty)
    }

    /// The strokes moved so that (0, 0) is the lower left corner; none if there are none.
    fn in_corner(mut strokes: Vec<Vec<[f64; 2]>>) -> Option<Self> {
        let range = |axis: usize| {
            let along = strokes.iter().flatten().map(|point| point[axis]);
            let low = along.clone().reduce(f64::min)?;
            Some([low, along.reduce(f64::max)?])
        };
        let [x, y] = [range(0)?, range(1)?];
        for point in strokes.iter_mut().flatten() {
            *point = [point[0] - x[0], point[1] - y[0]];
        }
        Some(Self {
            strokes,
            size: [x[1] - x[0], y[1] - y[0]],
        })
    }

    /// The strokes as an SVG in millimetres.
    pub fn to_svg(&self) -> String {
        let [width, height] = self.size.map(|side| 1e3 * side);
        let mut paths = String::new();
        for stroke in &self.strokes {
            let points = stroke
                .iter()
                .map(|[x, y]| format!("{:.4},{:.4}", 1e3 * x, height - 1e3 * y));
            let points = points.collect::<Vec<_>>().join(" ");
            let _ = writeln!(paths, "<polyline points=\"{points}\"/>");
        }
        // A line of no height would be no page.
        let [wide, high] = [width, height].map(|side| side.max(0.01));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{wide:.4}mm\" height=\"{high:.4}mm\" viewBox=\"0 0 {wide:.4} \
             {high:.4}\">\n<g fill=\"none\" stroke=\"black\" stroke-width=\"0.3\">\n{paths}</g>\n</svg>\n"
        )
    }

    /// The strokes as G-code in millimetres: M3 puts the tool down, M5 lifts it.
    pub fn to_gcode(&self) -> String {
        let mut code = format!("; Hershey simplex sans\nG21 G90\nM5\nF{FEED}\n");
        for stroke in &self.strokes {
            for (index, [x, y]) in stroke.iter().enumerate() {
                let [x, y] = [1e3 * x, 1e3 * y];
                let _ = match index {
                    0 => writeln!(code, "G0 X{x:.4} Y{y:.4}\nM3 S1000"),
                    _ => writeln!(code, "G1 X{x:.4} Y{y:.4}"),
                };
            }
            code.push_str("M5\n");
        }
        code
    }
}

/// Characters with their numbers, such as `漢 (U+6F22)`.
pub(crate) fn named(characters: &[char]) -> String {
    const MOST: usize = 8;
    let mut names: Vec<String> = characters
        .iter()
        .take(MOST)
        .map(|&of| match of.is_control() {
            true => format!("U+{:04X}", of as u32),
            false => format!("{of} (U+{:04X})", of as u32),
        })
        .collect();
    if characters.len() > MOST {
        names.push(format!("{} others", characters.len() - MOST));
    }
    names.join(", ")
}
