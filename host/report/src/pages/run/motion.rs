//! The arm in motion, and its path against the reference.

use super::{RunReport, spaced};
use crate::html::{AnimatedBody, AnimatedTrace, Animation, Chart, Page, Point};
use fivebar_kinematics::PlanarVector;
use fivebar_sim::simulation::Sample;
use nalgebra::Vector2;

/// Samples for the drawn path.
const PATH_SAMPLES: usize = 20_000;
/// Frames of the animation.
const FRAMES: usize = 600;
/// A gap in a curve, for a pen that is up.
const BREAK: Point = [f64::NAN; 2];

impl RunReport<'_> {
    pub(super) fn add_motion(&self, page: &mut Page) {
        let samples = self.trace.samples();
        let reference = self.drawn_path(|sample| sample.reference);
        let tool = self.drawn_path(|sample| sample.tool);

        let frames: Vec<&Sample> = spaced(samples, FRAMES).collect();
        let times = frames.iter().map(|sample| sample.time).collect();
        let mut animation = Animation::new("The arm in motion", "m", times);
        animation
            .fixed
            .push(("reference".into(), reference.clone()));
        animation.bodies.push(AnimatedBody {
            name: "arm".into(),
            frames: frames.iter().map(|sample| self.arm_at(sample)).collect(),
        });
        animation.traces.push(AnimatedTrace {
            name: "drawn".into(),
            times: path_samples(samples).map(|sample| sample.time).collect(),
            points: tool.clone(),
        });
        page.animation(&animation);

        let factor = magnification(samples);
        let magnified = path_samples(samples).zip(&tool).map(|(sample, &point)| {
            [0, 1].map(|axis| {
                1e3 * (sample.reference[axis] + factor * (point[axis] - sample.reference[axis]))
            })
        });
        let chart = Chart::new("Path", "x [mm]", "y [mm]")
            .line(
                format!("tool (error magnified {factor}×)"),
                magnified.collect(),
            )
            .dashed(
                "reference",
                reference
                    .iter()
                    .map(|point| point.map(|metres| 1e3 * metres))
                    .collect(),
            )
            .with_equal_aspect();
        page.heading("Path").chart(&chart);
    }

    /// A point of each path sample, with gaps where the pen is up.
    pub(super) fn drawn_path(&self, point: fn(&Sample) -> Point) -> Vec<Point> {
        path_samples(self.trace.samples())
            .map(|sample| {
                if self.draws(sample) {
                    point(sample)
                } else {
                    BREAK
                }
            })
            .collect()
    }

    /// The arm as one chain: A, B, C, to the tool and back, D, E.
    pub(super) fn arm_at(&self, sample: &Sample) -> Vec<Point> {
        let geometry = &self.robot.geometry;
        let b = Vector2::unit(sample.angle[0]) * geometry.l1();
        let d = geometry.e() + Vector2::unit(sample.angle[1]) * geometry.l4();
        let tool = Vector2::new(sample.tool[0], sample.tool[1]);
        // The tool from B is (l2 + along) u2 + left n2; the inverse rotation gives u2.
        let [along, left] = self.robot.tool.offset;
        let reach = Vector2::new(geometry.l2() + along, left);
        let u2 =
            Vector2::new(reach.x, -reach.y).to_base_frame(tool - b) * (1.0 / reach.norm_squared());
        let c = b + u2 * geometry.l2();
        [Vector2::zeros(), b, c, tool, c, d, geometry.e()]
            .map(|point| [point.x, point.y])
            .to_vec()
    }
}

pub(super) fn path_samples(samples: &[Sample]) -> impl Iterator<Item = &Sample> {
    spaced(samples, PATH_SAMPLES)
}

/// A round factor by which the greatest error becomes about 1/50 of the drawing.
fn magnification(path: &[Sample]) -> f64 {
    let greatest = path.iter().map(Sample::tip_error).fold(0.0, f64::max);
    let spread = |axis: usize| {
        let values = || path.iter().map(|sample| sample.reference[axis]);
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    let exact = 0.02 * spread(0).max(spread(1)) / greatest;
    let rounds = [1000.0, 500.0, 200.0, 100.0, 50.0, 20.0, 10.0, 5.0, 2.0];
    rounds
        .into_iter()
        .find(|&round| round <= exact)
        .unwrap_or(1.0)
}
