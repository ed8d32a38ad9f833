//! Curves over two axes, drawn by plotters as SVG.

use super::Point;
use super::decimate::{BoundingBox, is_finite, thin};
use plotters::prelude::*;
use quick_xml::escape::escape;
use std::fmt::Write as _;

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
/// assert!(page.chart(&chart).render().contains("<svg"));
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
}

/// Magnification of the drawing. Plotters' SVG has integer coordinates; this gives a resolution of
/// a quarter of a pixel.
const FINE: u32 = 4;
const MARGIN: u32 = 8;
const X_LABELS: u32 = 40;

/// Dimensions of a drawing [px]. The page contains a drawing for wide and one for narrow screens,
/// shows one of them, and scales it with its text to the screen.
struct Size {
    /// Its class in the style sheet.
    class: &'static str,
    width: u32,
    height: u32,
    text: u32,
    /// Width of the vertical axis's numbers and name.
    y_labels: u32,
    /// Approximate number of labels at each axis.
    ticks: [usize; 2],
}

const SIZES: [Size; 2] = [
    Size {
        class: "wide",
        width: 720,
        height: 280,
        text: 14,
        y_labels: 68,
        ticks: [8, 6],
    },
    Size {
        class: "narrow",
        width: 360,
        height: 240,
        text: 13,
        y_labels: 62,
        ticks: [4, 5],
    },
];

/// Colours in plotters' output that are replaced by the style sheet's, so that a chart follows
/// the reader's light or dark mode.
const INK: RGBColor = RGBColor(1, 1, 1);
const GRID: RGBColor = RGBColor(2, 2, 2);
const SERIES: [RGBColor; 6] = [
    RGBColor(3, 3, 3),
    RGBColor(4, 4, 4),
    RGBColor(5, 5, 5),
    RGBColor(6, 6, 6),
    RGBColor(7, 7, 7),
    RGBColor(8, 8, 8),
];

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

    /// The chart as a figure with its legend.
    pub(super) fn to_html(&self) -> String {
        let mut legend = String::new();
        for (index, series) in self.series.iter().enumerate() {
            if !series.name.is_empty() {
                let dashed = match series.stroke {
                    Stroke::Dashed => " dashed",
                    Stroke::Line | Stroke::Dots => "",
                };
                let _ = write!(
                    legend,
                    "<span class=\"entry{dashed} s{}\">{}</span>",
                    index % SERIES.len() + 1,
                    escape(&series.name)
                );
            }
        }
        let points = self.series.iter().flat_map(|series| &series.points);
        let drawings = match BoundingBox::of(points) {
            None => "<p>No data to show.</p>".into(),
            Some(range) => SIZES
                .map(|size| {
                    let svg = self.to_svg(range, &size);
                    format!("<div class=\"{}\">{svg}</div>", size.class)
                })
                .concat(),
        };
        format!(
            "<figure class=\"chart\"><figcaption><b>{}</b>{legend}</figcaption>{drawings}\
             </figure>\n",
            escape(&self.title),
        )
    }

    fn to_svg(&self, range: BoundingBox, size: &Size) -> String {
        let (range, height) = if self.equal_aspect {
            same_scale(range, size)
        } else {
            (widened(range), size.height)
        };
        let mut svg = String::new();
        // Drawing into a string cannot fail: there is no device that could return an error.
        self.draw(&mut svg, range, height, size)
            .expect("drawing into memory does not fail");
        themed(&svg)
    }

    fn draw(
        &self,
        svg: &mut String,
        range: BoundingBox,
        height: u32,
        size: &Size,
    ) -> Result<(), Box<dyn std::error::Error>> {
        let pixels = (size.width * FINE, height * FINE);
        let area = SVGBackend::with_string(svg, pixels).into_drawing_area();
        let [x_ticks, y_ticks] = size.ticks;
        let mut chart = ChartBuilder::on(&area)
            .margin(MARGIN * FINE)
            .x_label_area_size(X_LABELS * FINE)
            .y_label_area_size(size.y_labels * FINE)
            .build_cartesian_2d(range.low[0]..range.high[0], range.low[1]..range.high[1])?;
        let text = ("sans-serif", size.text * FINE).into_font().color(&INK);
        chart
            .configure_mesh()
            .x_desc(&self.x_label)
            .y_desc(&self.y_label)
            .x_labels(x_ticks)
            .y_labels(y_ticks)
            .x_label_formatter(&|value| tick(*value, range.width()))
            .y_label_formatter(&|value| tick(*value, range.height()))
            .label_style(text.clone())
            .axis_desc_style(text)
            .axis_style(GRID.stroke_width(FINE))
            .bold_line_style(GRID.stroke_width(FINE / 2))
            .light_line_style(TRANSPARENT)
            .draw()?;
        for (series, color) in self.series.iter().zip(SERIES.iter().cycle()) {
            let points = thin(&series.points, f64::from(size.width));
            let style = color.stroke_width(3 * FINE / 2);
            for part in points.split(|point| !is_finite(point)) {
                let part = part.iter().map(|&[x, y]| (x, y));
                match series.stroke {
                    Stroke::Line => {
                        chart.draw_series(LineSeries::new(part, style))?;
                    }
                    Stroke::Dashed => {
                        let dash = (5 * FINE, 4 * FINE);
                        chart.draw_series(DashedLineSeries::new(part, dash.0, dash.1, style))?;
                    }
                    Stroke::Dots => {
                        let dot = |at| Circle::new(at, 2 * FINE, color.filled());
                        chart.draw_series(part.map(dot))?;
                    }
                }
            }
        }
        area.present()?;
        Ok(())
    }
}

/// The box with a margin around it; never empty.
fn widened(BoundingBox { low, high }: BoundingBox) -> BoundingBox {
    let air = |low: f64, high: f64, share: f64| {
        if high > low {
            (high - low) * share
        } else {
            low.abs().max(1.0) * 0.5
        }
    };
    let (x, y) = (air(low[0], high[0], 0.0), air(low[1], high[1], 0.05));
    BoundingBox {
        low: [low[0] - x, low[1] - y],
        high: [high[0] + x, high[1] + y],
    }
}

/// The box and the chart's height [px] for which both axes have the same scale.
fn same_scale(range: BoundingBox, size: &Size) -> (BoundingBox, u32) {
    let plot_width = f64::from(size.width - 2 * MARGIN - size.y_labels);
    let frame = f64::from(2 * MARGIN + X_LABELS);
    let air = 0.04 * range.width().max(range.height()).max(1e-9);
    let (width, height) = (range.width() + 2.0 * air, range.height() + 2.0 * air);
    let plot_height = (plot_width * height / width).clamp(200.0, 520.0).round();
    let per_pixel = (width / plot_width).max(height / plot_height);
    let middle = [0, 1].map(|axis| 0.5 * (range.low[axis] + range.high[axis]));
    let half = [0.5 * per_pixel * plot_width, 0.5 * per_pixel * plot_height];
    let widened = BoundingBox {
        low: [middle[0] - half[0], middle[1] - half[1]],
        high: [middle[0] + half[0], middle[1] + half[1]],
    };
    (widened, (plot_height + frame) as u32)
}

/// The label of a number at an axis. The number of decimals follows from the axis's span.
fn tick(value: f64, span: f64) -> String {
    let digits = (2.0 - span.log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.digits$}");
    let text = match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    match text {
        "-0" => "0".into(),
        text => text.replace('-', "−"),
    }
}

/// Replaces the colours of plotters' output by the style sheet's.
fn themed(svg: &str) -> String {
    let hex = |RGBColor(r, g, b)| format!("\"#{r:02X}{g:02X}{b:02X}\"");
    let mut svg = svg
        .replace(&hex(INK), "\"currentColor\"")
        .replace(&hex(GRID), "\"var(--grid)\"");
    for (index, color) in SERIES.into_iter().enumerate() {
        svg = svg.replace(&hex(color), &format!("\"var(--s{})\"", index + 1));
    }
    svg
}

#[cfg(test)]
mod tests {
    use super::{BoundingBox, Chart, SIZES, same_scale, tick};

    #[test]
    fn axis_labels_have_no_noise_digits() {
        assert_eq!(tick(0.1 + 0.2, 1.0), "0.3");
        assert_eq!(tick(-0.0, 1.0), "0");
        assert_eq!(tick(-25.0, 100.0), "−25");
        assert_eq!(tick(1200.0, 4000.0), "1200");
        assert_eq!(tick(2.5e-5, 1e-4), "0.000025");
    }

    #[test]
    fn equal_aspect_gives_both_axes_the_same_scale() {
        let low = [0.0, 0.0];
        for (high, size) in [[1.0, 1.0], [10.0, 1.0], [1.0, 10.0], low]
            .into_iter()
            .flat_map(|high| SIZES.map(|size| (high, size)))
        {
            let (range, height) = same_scale(BoundingBox { low, high }, &size);
            let across = range.width() / f64::from(size.width - 16 - size.y_labels);
            let up = range.height() / f64::from(height - 16 - 40);
            assert!((across / up - 1.0).abs() < 1e-9);
            assert!(range.low[0] <= 0.0 && range.high[1] >= high[1]);
        }
    }

    #[test]
    fn gaps_flat_lines_and_empty_charts_are_drawn() {
        let broken = vec![[0.0, 1.0], [f64::NAN, f64::NAN], [1.0, 1.0], [2.0, 1.0]];
        let html = Chart::new("t", "x [s]", "y [m]")
            .line("a", broken)
            .to_html();
        // Two parts, in the wide drawing and in the narrow one.
        assert_eq!(html.matches("var(--s1)").count(), 4);
        assert!(html.contains("x [s]") && html.contains("y [m]"));
        let empty = Chart::new("t", "x", "y").line("a", vec![[f64::NAN, 0.0]]);
        assert!(empty.to_html().contains("No data to show"));
    }
}
