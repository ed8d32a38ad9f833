//! The drawing of the arm.

use super::axes::PictureFrame;
use super::{INK, PAPER, label};
use fivebar_files::robot::Robot;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Pose, WorkingMode};
use nalgebra::Vector2;
use std::fmt::Write as _;

/// Distance of a joint's letter from the joint, in the picture's units.
const APART: f64 = 16.0;

/// The arm in a pose.
pub(super) struct ArmDrawing {
    pose: Pose<f64>,
    e: Vector2<f64>,
    /// The tool, if it is not at C.
    tool: Option<Vector2<f64>>,
}

impl ArmDrawing {
    /// The arm at home; in a working mode other than its own, with the tool at `best` [m].
    pub(super) fn of(robot: &Robot, mode: WorkingMode, best: Option<Vector2<f64>>) -> Option<Self> {
        let home = robot.home_pose().ok();
        let own = home.filter(|_| mode == robot.working_mode());
        let at_best = || robot.workspace(mode).ok()?.tool.inverse(best?, mode).ok();
        let pose = own.or_else(at_best)?;
        let [x, y] = robot.tool_at(&pose);
        Some(Self {
            pose,
            e: robot.geometry.e(),
            tool: (robot.tool.offset != [0.0; 2]).then_some(Vector2::new(x, y)),
        })
    }

    /// Links 1, 2, 3 and 4, and the line to the tool.
    pub(super) fn links(&self) -> Vec<[Vector2<f64>; 2]> {
        let Pose { b, c, d, .. } = self.pose;
        let links = [[Vector2::zeros(), b], [b, c], [d, c], [self.e, d]];
        let tool = self.tool.map(|tool| [c, tool]);
        links.into_iter().chain(tool).collect()
    }

    /// The links with their joints and letters.
    pub(super) fn drawn(&self, frame: &PictureFrame) -> String {
        let base = [Vector2::zeros(), self.e];
        let links: String = self.links().iter().map(|ends| frame.path(ends)).collect();
        let mut svg = String::new();
        for (colour, wide) in [(PAPER, 3.0), (INK, 0.0)] {
            let _ = writeln!(
                svg,
                "<g fill=\"none\" stroke=\"{colour}\" stroke-linecap=\"round\">\
                 <path d=\"{}\" stroke-width=\"{}\" stroke-dasharray=\"2 5\"/>\
                 <path d=\"{links}\" stroke-width=\"{}\"/></g>",
                frame.path(&base),
                2.0 + wide,
                4.0 + wide,
            );
        }
        let Pose { b, c, d, .. } = self.pose;
        let joints = [
            ("A", Vector2::zeros()),
            ("B", b),
            ("C", c),
            ("D", d),
            ("E", self.e),
        ];
        let tool = self.tool.map(|tool| ("tool", tool));
        let joints: Vec<_> = joints.into_iter().chain(tool).collect();
        for &(_, joint) in &joints {
            let [x, y] = frame.to_picture(joint);
            let _ = writeln!(
                svg,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.5\" fill=\"{PAPER}\" \
                 stroke=\"{INK}\" stroke-width=\"2\"/>"
            );
        }
        for (name, joint) in joints {
            let [x, y] = frame.to_picture(joint);
            let out = self.away_from_links(joint, base);
            let wide = if name.len() > 1 { 1.6 } else { 1.0 };
            let middle = [x + wide * APART * out.x, y - APART * out.y + 4.5];
            svg.push_str(&label(middle, name));
        }
        svg
    }

    /// A direction from a joint, away from its links.
    fn away_from_links(&self, joint: Vector2<f64>, base: [Vector2<f64>; 2]) -> Vector2<f64> {
        let mut sum = Vector2::zeros();
        let mut along = Vector2::new(1.0, 0.0);
        for [from, to] in self.links().into_iter().chain([base]) {
            let other = if from == joint {
                to
            } else if to == joint {
                from
            } else {
                continue;
            };
            let displacement = other - joint;
            if displacement.norm() > 0.0 {
                along = displacement * (1.0 / displacement.norm());
                sum += along;
            }
        }
        // With links in line, both sides are free.
        if sum.norm() < 1e-6 {
            sum = along.perpendicular();
        }
        sum * (-1.0 / sum.norm())
    }
}

/// The distance of a point from a line segment, in the picture's units.
pub(super) fn distance([x, y]: [f64; 2], [[x0, y0], [x1, y1]]: [[f64; 2]; 2]) -> f64 {
    let (from, displacement) = (Vector2::new(x0, y0), Vector2::new(x1 - x0, y1 - y0));
    let point = Vector2::new(x, y) - from;
    let share = point.dot(&displacement) / displacement.norm_squared().max(f64::MIN_POSITIVE);
    (point - displacement * share.clamp(0.0, 1.0)).norm()
}
