//! Curves over two axes, which uPlot draws in the reader's browser (`charts.js`).

use super::Point;
use super::decimate::{is_finite, thin};
use super::page::json_element;
use quick_xml::escape::escape;
use serde::Serialize;
use serde_json::json;

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Stroke {
    /// A solid line.
    Line,
    /// A dashed line, for references and limits.
    Dashed,
    /// Separate dots.
    Dots,
}

/// One curve of a chart.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend. A series with an empty name has no entry there.
    pub name: String,
    /// Its points, in the units of the axes. A point that is not finite is a gap in the line.
    pub points: Vec<Point>,
    /// How it is drawn.
    pub stroke: Stroke,
}

/// Series over two labelled axes.
///
/// ```
/// use fivebar_report::html::{Chart, Page};
///
/// let sine = |turns: f64| (1e-2 * turns, (std::f64::consts::TAU * turns).sin());
/// let points = (0..=100).map(|i| sine(0.01 * f64::from(i)).into()).collect();
/// let chart = Chart::new("Torque", "time [s]", "torque [N·m]").line("joint 1", points);
/// let mut page = Page::new("A turn");
/// assert!(page.chart(&chart).render().contains("time [s]"));
/// ```
#[derive(Clone, Debug)]
pub struct Chart {
    /// Title.
    pub title: String,
    /// Name and unit of the horizontal axis: "time [s]".
    pub x_label: String,
    /// Name and unit of the vertical axis: "tip error [µm]".
    pub y_label: String,
    /// The curves, in the order of drawing.
    pub series: Vec<Series>,
    /// Whether both axes have the same scale, for paths in the plane.
    pub equal_aspect: bool,
    /// Whether the horizontal axis is logarithmic, for frequencies.
    pub log_x: bool,
}

impl Chart {
    /// A chart without series.
    pub fn new(
        title: impl Into<String>,
        x_label: impl Into<String>,
        y_label: impl Into<String>,
    ) -> Self {
        Self {
            title: title.into(),
            x_label: x_label.into(),
            y_label: y_label.into(),
            series: Vec::new(),
            equal_aspect: false,
            log_x: false,
        }
    }

    /// Adds a series.
    #[must_use]
    pub fn series(mut self, stroke: Stroke, name: impl Into<String>, points: Vec<Point>) -> Self {
        self.series.push(Series {
            name: name.into(),
            points,
            stroke,
        });
        self
    }

    /// Adds a solid line.
    #[must_use]
    pub fn line(self, name: impl Into<String>, points: Vec<Point>) -> Self {
        self.series(Stroke::Line, name, points)
    }

    /// Adds a dashed line.
    #[must_use]
    pub fn dashed(self, name: impl Into<String>, points: Vec<Point>) -> Self {
        self.series(Stroke::Dashed, name, points)
    }

    /// Adds separate dots.
    #[must_use]
    pub fn dots(self, name: impl Into<String>, points: Vec<Point>) -> Self {
        self.series(Stroke::Dots, name, points)
    }

    /// Gives both axes the same scale.
    #[must_use]
    pub fn with_equal_aspect(mut self) -> Self {
        self.equal_aspect = true;
        self
    }

    /// Makes the horizontal axis logarithmic.
    #[must_use]
    pub fn with_log_x(mut self) -> Self {
        self.log_x = true;
        self
    }

    /// The chart as a figure with its data.
    pub(super) fn to_html(&self) -> String {
        let curves = self
            .series
            .iter()
            .map(|series| self.thinned(&series.points));
        let curves: Vec<_> = curves.collect();
        let content = if curves.iter().all(Vec::is_empty) {
            "<p>No data to show.</p>".into()
        } else {
            let series = self.series.iter().zip(&curves).map(|(series, curve)| {
                let (x, y) = columns(curve);
                json!({ "label": series.name, "stroke": series.stroke, "x": x, "y": y })
            });
            json_element(&json!({
                "x": self.x_label,
                "y": self.y_label,
                "equal": self.equal_aspect,
                "log": self.log_x,
                "series": series.collect::<Vec<_>>(),
            }))
        };
        let title = escape(&self.title);
        format!(
            "<figure class=\"chart\"><figcaption><b>{title}</b></figcaption>{content}</figure>\n"
        )
    }

    /// A curve without the points that the page is too coarse to show.
    fn thinned(&self, points: &[Point]) -> Vec<Point> {
        let across = |f: fn(f64) -> f64, points: &[Point]| -> Vec<Point> {
            points.iter().map(|&[x, y]| [f(x), y]).collect()
        };
        if self.log_x {
            let decades = thin(&across(f64::log10, points), COLUMNS);
            across(|decades| 10_f64.powf(decades), &decades)
        } else {
            thin(points, COLUMNS)
        }
    }
}

/// Columns to which curves are thinned [px]: the width of a chart on a wide screen.
const COLUMNS: f64 = 1000.0;

/// The coordinates of a thinned curve. A gap is a null between its neighbours.
fn columns(curve: &[Point]) -> (Vec<f64>, Vec<Option<f64>>) {
    let point = |(i, point): (usize, &Point)| {
        if is_finite(point) {
            (digits(point[0], 9), Some(digits(point[1], 6)))
        } else {
            (0.5 * (curve[i - 1][0] + curve[i + 1][0]), None)
        }
    };
    curve.iter().enumerate().map(point).unzip()
}

/// The number with so many significant digits, which keeps the file small.
fn digits(value: f64, digits: usize) -> f64 {
    let text = format!("{value:.*e}", digits - 1);
    text.parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::{Chart, columns};

    #[test]
    fn numbers_are_short_and_a_gap_is_a_null_between_its_neighbours() {
        let curve = [[0.1 + 0.2, 1.0 / 3.0], [f64::NAN; 2], [1.3, -2.5e-7]];
        let expected = (
            vec![0.3, 0.8, 1.3],
            vec![Some(0.333_333), None, Some(-2.5e-7)],
        );
        assert_eq!(columns(&curve), expected);
    }

    #[test]
    fn a_chart_without_points_says_so() {
        let empty = Chart::new("t", "x", "y").line("a", vec![[f64::NAN, 0.0]]);
        assert!(empty.to_html().contains("No data to show"));
    }

    #[test]
    fn a_logarithmic_axis_keeps_its_lowest_decade() {
        let decades = |i: i32| f64::from(i) / 5_000.0;
        let points = (0..20_000).map(|i| [10_f64.powf(decades(i)), f64::from(i % 2)]);
        let chart = Chart::new("t", "frequency [Hz]", "size [dB]").with_log_x();
        let thinned = chart.thinned(&points.collect::<Vec<_>>());
        let lowest = thinned.iter().filter(|point| point[0] < 10.0).count();
        assert!(thinned.len() < 4_100 && lowest >= 500, "{lowest}");
    }
}
