//! The picture's legend.

use super::bands::scale;
use super::{INK, PAPER, TYPE_2, cross, dimensions};
use nalgebra::Vector2;
use std::fmt::Write as _;

/// Distances of two lines of text, and of two entries.
const LINE: f64 = 17.0;
const ENTRY: f64 = 14.0;
/// Width of a symbol.
const SIGN: f64 = 44.0;

/// The content of the legend.
pub(super) struct LegendContent {
    pub(super) left: f64,
    pub(super) top: f64,
    /// Whether the joint limits exclude any cell.
    pub(super) limits: bool,
    pub(super) margin: f64,
    /// Width and height of the rectangle [m].
    pub(super) rectangle: Option<Vector2<f64>>,
    /// The best-conditioned position [m] and 1/κ there.
    pub(super) best: Option<(Vector2<f64>, f64)>,
}

/// The legend.
pub(super) fn legend(shown: &LegendContent) -> String {
    let LegendContent { left, top, .. } = *shown;
    let mut svg = heading(left, top);
    svg.push_str(&scale(left, top + 78.0));
    let mut y = top + 278.0;
    let mut entry = |sign: &dyn Fn(f64) -> String, lines: &[String]| {
        svg.push_str(&sign(y));
        for (index, line) in lines.iter().enumerate() {
            let baseline = y + 4.5 + LINE * index as f64;
            let _ = writeln!(
                svg,
                "<text x=\"{}\" y=\"{baseline}\">{line}</text>",
                left + SIGN + 12.0
            );
        }
        y += LINE * lines.len() as f64 + ENTRY;
    };
    let stroke =
        |y: f64, style: &str| format!("<path d=\"M{left} {y}h{SIGN}\" fill=\"none\" {style}/>\n");
    entry(
        &|y| stroke(y, &format!("stroke=\"{INK}\" stroke-width=\"2\"")),
        &["type 1: a leg is".into(), "straight or folded".into()],
    );
    entry(
        &|y| {
            stroke(
                y,
                &format!("stroke=\"{TYPE_2}\" stroke-width=\"2\" stroke-dasharray=\"7 4\""),
            )
        },
        &["type 2: links 2 and 3".into(), "are in line".into()],
    );
    if shown.limits {
        entry(
            &|y| {
                format!(
                    "<rect x=\"{left}\" y=\"{}\" width=\"{SIGN}\" height=\"16\" fill=\"url(#hatch)\" \
                     stroke=\"#5a6372\"/>\n",
                    y - 8.0
                )
            },
            &["outside the joint limits".into()],
        );
    }
    entry(
        &|y| scale_sample(left, y),
        &[
            "pale: outside the limits or".into(),
            format!("within the margin of {}", shown.margin),
        ],
    );
    if let Some(size) = shown.rectangle {
        entry(
            &|y| {
                format!(
                    "<rect x=\"{left}\" y=\"{}\" width=\"{SIGN}\" height=\"16\" fill=\"{PAPER}\" \
                     stroke=\"{INK}\" stroke-width=\"2\"/>\n",
                    y - 8.0
                )
            },
            &["largest clear rectangle".into(), dimensions(size)],
        );
    }
    if let Some((place, value)) = shown.best {
        entry(
            &|y| cross(left + 0.5 * SIGN, y) + "\n",
            &[
                format!("best 1/κ: {value:.2}"),
                format!("at ({:.0}, {:.0}) mm", 1e3 * place.x, 1e3 * place.y).replace('-', "−"),
            ],
        );
    }
    svg
}

/// What the colours mean.
fn heading(left: f64, top: f64) -> String {
    format!(
        "<text x=\"{left}\" y=\"{}\">1/κ = σmin/σmax of the Jacobian</text>\n\
         <text x=\"{left}\" y=\"{}\">1: the same in all directions</text>\n\
         <text x=\"{left}\" y=\"{}\">0: singular</text>\n\
         <text x=\"{left}\" y=\"{}\">left: clear; right: not allowed</text>\n",
        top + 12.0,
        top + 12.0 + LINE,
        top + 12.0 + 2.0 * LINE,
        top + 12.0 + 3.0 * LINE,
    )
}

/// A colour and its pale form.
fn scale_sample(left: f64, y: f64) -> String {
    use super::bands::{BANDS, colour};
    let half = 0.5 * SIGN;
    let rect = |x: f64, pale: bool| {
        format!(
            "<rect x=\"{x}\" y=\"{}\" width=\"{half}\" height=\"16\" fill=\"{}\"/>",
            y - 8.0,
            colour(BANDS[5], pale)
        )
    };
    rect(left, false) + &rect(left + half, true) + "\n"
}
