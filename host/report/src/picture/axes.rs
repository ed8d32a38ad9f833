//! The picture's axes, and the conversion from metres to its units.

use super::INK;
use crate::study::workspace::WorkspaceStudyError;
use fivebar_design::workspace::{Grid, reach_bounds};
use fivebar_kinematics::five_bar::Tool;
use nalgebra::Vector2;
use std::fmt::Write as _;

/// The longer side of the reach, in the picture's units.
const SIDE: f64 = 680.0;
/// Space between the reach and the axes.
const AIR: f64 = 14.0;
/// Space above the axes for the title, below and left of them for their numbers, and right
/// of them for the legend.
const TITLE: f64 = 70.0;
const NUMBERS: f64 = 62.0;
const LEGEND: f64 = 300.0;
/// Least height of the legend.
const LEGEND_HEIGHT: f64 = 560.0;
/// Most numbers along the longer axis.
const TICKS: f64 = 12.0;

/// The position of the plane in the picture: one cell of its grid is one unit.
pub(super) struct PictureFrame {
    grid: Grid,
}

impl PictureFrame {
    /// A frame around the tool's reach.
    pub(super) fn around(tool: &Tool<f64>) -> Result<Self, WorkspaceStudyError> {
        let [low, high] = reach_bounds(tool);
        let pitch = (high.x - low.x).max(high.y - low.y) / SIDE;
        let refused = |error| WorkspaceStudyError::Grid { pitch, error };
        let grid = Grid::over(tool, pitch).map_err(refused)?;
        Ok(Self { grid })
    }

    /// The grid, with cells of one unit.
    pub(super) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Left end of the axes.
    pub(super) fn left(&self) -> f64 {
        NUMBERS
    }

    /// Upper end of the axes.
    pub(super) fn top(&self) -> f64 {
        TITLE
    }

    /// The corner of the first cell of the highest row.
    pub(super) fn corner(&self) -> [f64; 2] {
        [NUMBERS + AIR, TITLE + AIR]
    }

    /// Width and height within the axes.
    fn size(&self) -> [f64; 2] {
        [self.grid.columns(), self.grid.rows()].map(|cells| cells as f64 + 2.0 * AIR)
    }

    /// Left end of the legend.
    pub(super) fn legend_left(&self) -> f64 {
        NUMBERS + self.size()[0] + 28.0
    }

    /// Width and height of the whole picture.
    pub(super) fn picture_size(&self) -> [f64; 2] {
        let [width, height] = self.size();
        let height = height.max(LEGEND_HEIGHT);
        [NUMBERS + width + LEGEND, TITLE + height + NUMBERS]
    }

    /// A position [m] in the picture's units.
    pub(super) fn to_picture(&self, point: Vector2<f64>) -> [f64; 2] {
        let [left, top] = self.corner();
        let (low, high) = (self.grid.low(), self.grid.high());
        let pitch = self.grid.pitch();
        [
            left + (point.x - low.x) / pitch,
            top + (high.y - point.y) / pitch,
        ]
    }

    /// The path of a line through positions [m].
    pub(super) fn path(&self, points: &[Vector2<f64>]) -> String {
        let mut path = String::new();
        for (index, &point) in points.iter().enumerate() {
            let [x, y] = self.to_picture(point);
            let _ = write!(path, "{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' });
        }
        path
    }

    /// The axes with numbers in millimetres and a pale grid.
    pub(super) fn axes(&self) -> String {
        let ([left, top], [width, height]) = ([NUMBERS, TITLE], self.size());
        let (right, bottom) = (left + width, top + height);
        let span = 1e3 * self.grid.pitch() * width.max(height);
        let step = round_step(span / TICKS);
        let mut svg = String::new();
        let along = |from: f64, to: f64| {
            let first = (from / step).ceil() as i64;
            let last = (to / step).floor() as i64;
            (first..=last).map(move |index| index as f64 * step)
        };
        let air = AIR * self.grid.pitch();
        let low = (self.grid.low() - Vector2::new(air, air)) * 1e3;
        let high = (self.grid.high() + Vector2::new(air, air)) * 1e3;
        for tick in along(low.x, high.x) {
            let [x, _] = self.to_picture(Vector2::new(1e-3 * tick, 0.0));
            let _ = writeln!(
                svg,
                "<path d=\"M{x:.1} {top}V{bottom}\" stroke=\"#e3e6ea\"/>\
                 <text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                bottom + 19.0,
                number(tick, step),
            );
        }
        for tick in along(low.y, high.y) {
            let [_, y] = self.to_picture(Vector2::new(0.0, 1e-3 * tick));
            let _ = writeln!(
                svg,
                "<path d=\"M{left} {y:.1}H{right}\" stroke=\"#e3e6ea\"/>\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                left - 6.0,
                y + 4.5,
                number(tick, step),
            );
        }
        let (middle_x, middle_y) = (left + 0.5 * width, top + 0.5 * height);
        let _ = writeln!(
            svg,
            "<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"none\" \
             stroke=\"{INK}\"/>\n\
             <text x=\"{middle_x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">x [mm]</text>\n\
             <text transform=\"translate(15 {middle_y:.1}) rotate(-90)\" \
             text-anchor=\"middle\">y [mm]</text>",
            bottom + 42.0,
        );
        svg
    }
}

/// The least number of 1, 2, 5, 10, 20, … that is at least `value`.
fn round_step(value: f64) -> f64 {
    let decade = 10_f64.powf(value.log10().floor());
    let steps = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|step| step * decade >= value);
    steps.unwrap_or(10.0) * decade
}

/// A multiple of `step` as text, with the step's decimals.
fn number(value: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}").replace('-', "−")
}
