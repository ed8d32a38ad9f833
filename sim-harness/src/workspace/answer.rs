//! The figures of a study, for people and for programs.

use super::{Branch, Study};
use crate::report::quantity;
use fivebar_design::workspace::reachable_area;
use fivebar_kinematics::Vec2;
use serde_json::{Value, json};
use std::fmt::Write as _;

impl Study<'_> {
    /// One object; units in the keys.
    pub fn answer(&self) -> Value {
        let branches: Vec<Value> = self.branches.iter().map(answer).collect();
        json!({
            "robot": self.robot.name,
            "working_mode": [self.robot.working_mode.elbow1, self.robot.working_mode.elbow4],
            "resolution_m": self.resolution(),
            "singularity_margin": self.robot.limits.singularity_margin,
            "reached_exactly_m2": self.exact_area(),
            "branches": branches,
        })
    }

    /// A table of the branches, a line each.
    pub fn table(&self) -> String {
        let mut text = format!(
            "{}: cells of {}; singularity margin {}\n\n\
             elbows 1, 4   assembly   reached  in limits      clear  largest clear rectangle                      best 1/κ\n\
             \u{20}                          [cm²]      [cm²]      [cm²]  [mm]\n",
            self.robot.name,
            quantity(self.resolution(), "m"),
            self.robot.limits.singularity_margin,
        );
        for branch in &self.branches {
            let elbows = format!("{}, {}", branch.mode.elbow1, branch.mode.elbow4);
            let rectangle = branch.rectangle.map_or("none".into(), |rectangle| {
                let (size, low) = (rectangle.size(), rectangle.low);
                format!("{} × {} from {}", mm(size.x), mm(size.y), at(low))
            });
            let best = branch.best.map_or("none".into(), |(place, value)| {
                format!("{value:.3} at {} mm", at(place))
            });
            let [reached, limits, clear] = [
                branch.areas.reached,
                branch.areas.within_limits,
                branch.areas.admitted,
            ]
            .map(|area| 1e4 * area);
            let own = if branch.mode == self.robot.working_mode {
                " *"
            } else {
                ""
            };
            let _ = writeln!(
                text,
                "{elbows:<13} {:<8} {reached:>9.1} {limits:>10.1} {clear:>10.1}  {rectangle:<44} {best}{own}",
                branch.assembly,
            );
        }
        text.push_str("\n* the robot's own working mode\n");
        if let Some(exact) = self.exact_area() {
            let _ = writeln!(
                text,
                "reached in every working mode, exactly: {:.1} cm²",
                1e4 * exact
            );
        }
        text
    }

    /// Side of a cell [m].
    pub(super) fn resolution(&self) -> f64 {
        self.maps.first().map_or(0.0, |map| map.grid().pitch())
    }

    /// What both legs reach [m²], if the tool is where they meet.
    fn exact_area(&self) -> Option<f64> {
        let at_c = self.robot.tool.offset == [0.0; 2];
        at_c.then(|| reachable_area(&self.robot.geometry))
    }
}

fn answer(branch: &Branch) -> Value {
    // To a tenth of a micrometre: the rest is noise.
    let pair = |point: Vec2<f64>| [point.x, point.y].map(|part| (1e7 * part).round() / 1e7);
    json!({
        "elbow1": branch.mode.elbow1,
        "elbow4": branch.mode.elbow4,
        "assembly": branch.assembly,
        "reached_m2": branch.areas.reached,
        "within_limits_m2": branch.areas.within_limits,
        "clear_m2": branch.areas.admitted,
        "clear_rectangle": branch.rectangle.map(|rectangle| json!({
            "size_m": pair(rectangle.size()),
            "low_m": pair(rectangle.low),
            "high_m": pair(rectangle.high),
        })),
        "best": branch.best.map(|(place, inverse_condition)| json!({
            "at_m": pair(place),
            "condition_number": 1.0 / inverse_condition,
        })),
    })
}

/// Metres in millimetres.
fn mm(metres: f64) -> String {
    format!("{:.1}", 1e3 * metres).replace('-', "−")
}

fn at(place: Vec2<f64>) -> String {
    format!("({}, {})", mm(place.x), mm(place.y))
}
