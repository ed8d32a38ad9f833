//! An animation of a mechanism: moving bodies, fixed curves, and curves that grow with time.

use super::Point;
use super::decimate::{BoundingBox, is_finite};
use super::page::json_element;
use quick_xml::escape::escape;
use serde_json::{Value, json};
use std::fmt::Write as _;

/// A moving body: a chain of straight members, joined at its points.
#[derive(Clone, Debug)]
pub struct AnimatedBody {
    /// Name in the legend.
    pub name: String,
    /// Its points at each of the animation's times. All frames have the same number of points.
    pub frames: Vec<Vec<Point>>,
}

/// A curve that grows with time.
#[derive(Clone, Debug)]
pub struct AnimatedTrace {
    /// Name in the legend.
    pub name: String,
    /// Time at which each point appears [s], not decreasing.
    pub times: Vec<f64>,
    /// Its points. A point that is not finite is a gap in the curve.
    pub points: Vec<Point>,
}

/// An animation with play, pause and a slider for the time.
#[derive(Clone, Debug)]
pub struct Animation {
    /// Caption.
    pub caption: String,
    /// Unit of the coordinates, for the scale bar.
    pub unit: String,
    /// Times of the frames [s], increasing.
    pub times: Vec<f64>,
    /// Fixed curves with their names.
    pub fixed: Vec<(String, Vec<Point>)>,
    /// Moving bodies.
    pub bodies: Vec<AnimatedBody>,
    /// Curves that grow with time.
    pub traces: Vec<AnimatedTrace>,
}

/// Most frames in the file. The page interpolates between them.
const FRAMES: usize = 600;
/// Most points of a curve in the file.
const POINTS: usize = 6_000;
/// Coordinates are rounded to the picture's larger side divided by this.
const STEPS: f64 = 16_000.0;

impl Animation {
    /// An empty animation over the given times [s], with coordinates in `unit`.
    pub fn new(caption: impl Into<String>, unit: impl Into<String>, times: Vec<f64>) -> Self {
        Self {
            caption: caption.into(),
            unit: unit.into(),
            times,
            fixed: Vec::new(),
            bodies: Vec::new(),
            traces: Vec::new(),
        }
    }

    /// The animation as HTML, with its controls and data.
    pub(super) fn to_html(&self) -> String {
        let caption = escape(&self.caption);
        let mut legend = String::new();
        let names = [
            ("fixed", self.fixed.iter().map(|(name, _)| name).collect()),
            ("body", self.bodies.iter().map(|body| &body.name).collect()),
            (
                "trace",
                self.traces
                    .iter()
                    .map(|trace| &trace.name)
                    .collect::<Vec<_>>(),
            ),
        ];
        for (kind, names) in names {
            for (index, name) in names.into_iter().enumerate() {
                if !name.is_empty() {
                    let (class, name) = (index % 4 + 1, escape(name));
                    let _ = write!(legend, "<span class=\"entry {kind}{class}\">{name}</span>");
                }
            }
        }
        let data = json_element(&self.data());
        format!(
            "<figure class=\"animation\"><figcaption><b>{caption}</b>{legend}</figcaption>\n\
             <canvas role=\"img\" aria-label=\"{caption}\"></canvas>\n\
             <div class=\"controls\"><button type=\"button\">Play</button>\
             <input type=\"range\" min=\"0\" max=\"1\" step=\"any\" value=\"0\" \
             aria-label=\"time\"><output></output>\
             <label>speed <select></select></label></div>\n\
             {data}</figure>\n"
        )
    }

    fn data(&self) -> Value {
        let all = self
            .fixed
            .iter()
            .flat_map(|(_, points)| points)
            .chain(
                self.bodies
                    .iter()
                    .flat_map(|body| body.frames.iter().flatten()),
            )
            .chain(self.traces.iter().flat_map(|trace| &trace.points));
        let range = BoundingBox::of(all).unwrap_or(BoundingBox {
            low: [0.0; 2],
            high: [1.0; 2],
        });
        let quantum = (range.width().max(range.height()) / STEPS).max(f64::MIN_POSITIVE);
        let flat = |points: &mut dyn Iterator<Item = &Point>| -> Value {
            points
                .flat_map(|point| {
                    [0, 1].map(|axis| {
                        let steps = ((point[axis] - range.low[axis]) / quantum).round();
                        is_finite(point).then_some(steps as i64)
                    })
                })
                .collect::<Vec<_>>()
                .into()
        };
        let frame_step = self.times.len().div_ceil(FRAMES).max(1);
        let bodies: Vec<Value> = self
            .bodies
            .iter()
            .map(|body| {
                sample(&body.frames, frame_step)
                    .map(|points| flat(&mut points.iter()))
                    .collect()
            })
            .collect();
        let fixed: Vec<Value> = self
            .fixed
            .iter()
            .map(|(_, points)| flat(&mut sample(points, points.len().div_ceil(POINTS))))
            .collect();
        let traces: Vec<Value> = self
            .traces
            .iter()
            .map(|trace| {
                let step = trace.points.len().div_ceil(POINTS);
                json!({
                    "times": sample(&trace.times, step).map(|&t| milliseconds(t)).collect::<Vec<_>>(),
                    "points": flat(&mut sample(&trace.points, step)),
                })
            })
            .collect();
        json!({
            "unit": self.unit,
            "origin": range.low,
            "quantum": quantum,
            "size": [range.width() / quantum, range.height() / quantum],
            "times": sample(&self.times, frame_step).map(|&t| milliseconds(t)).collect::<Vec<_>>(),
            "fixed": fixed,
            "bodies": bodies,
            "traces": traces,
        })
    }
}

/// Every `step`th item and the last item.
fn sample<T>(items: &[T], step: usize) -> impl Iterator<Item = &T> {
    let step = step.max(1);
    let last = items.len().saturating_sub(1);
    items
        .iter()
        .enumerate()
        .filter(move |&(index, _)| index % step == 0 || index == last)
        .map(|(_, item)| item)
}

fn milliseconds(seconds: f64) -> i64 {
    (seconds * 1e3).round() as i64
}

#[cfg(test)]
mod tests {
    use super::{AnimatedBody, AnimatedTrace, Animation};

    #[test]
    fn the_data_of_a_long_run_stay_small() {
        let long = 200_000;
        let times: Vec<f64> = (0..long).map(|i| f64::from(i) * 1e-3).collect();
        let points: Vec<[f64; 2]> = times.iter().map(|t| [t.cos(), t.sin()]).collect();
        let mut animation = Animation::new("arm", "m", times.clone());
        animation.bodies.push(AnimatedBody {
            name: "arm".into(),
            frames: points.iter().map(|&tip| vec![[0.0, 0.0], tip]).collect(),
        });
        animation.traces.push(AnimatedTrace {
            name: "path".into(),
            times,
            points,
        });
        let html = animation.to_html();
        assert!(html.len() < 300_000, "{} bytes", html.len());
        let data = animation.data();
        assert_eq!(data["times"].as_array().unwrap().last().unwrap(), 199_999);
        assert_eq!(
            data["times"].as_array().unwrap().len(),
            data["bodies"][0].as_array().unwrap().len()
        );
    }

    #[test]
    fn coordinates_are_rounded_to_a_small_fraction_of_the_picture() {
        let mut animation = Animation::new("arm", "m", vec![0.0]);
        let point = [0.123_456_78, 0.25];
        animation
            .fixed
            .push(("".into(), vec![[0.0, 0.0], point, [f64::NAN, 0.0]]));
        let data = animation.data();
        let quantum = data["quantum"].as_f64().unwrap();
        let x = data["fixed"][0][2].as_f64().unwrap() * quantum;
        assert!((x - point[0]).abs() < 0.25 / 16_000.0);
        assert!(data["fixed"][0][4].is_null());
    }
}
