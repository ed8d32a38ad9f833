//! The study as JSON.

use super::{Branch, WorkspaceStudy};
use fivebar_design::workspace::reachable_area;
use nalgebra::Vector2;
use serde_json::{Value, json};

impl WorkspaceStudy<'_> {
    /// One JSON object; the units are in the keys.
    pub fn answer(&self) -> Value {
        let branches: Vec<Value> = self.branches.iter().map(answer).collect();
        let mode = self.robot.working_mode();
        json!({
            "robot": self.robot.name,
            "working_mode": [mode.elbow1, mode.elbow4],
            "resolution_m": self.resolution(),
            "singularity_margin": self.robot.limits.singularity_margin,
            "reached_exactly_m2": self.exact_area(),
            "branches": branches,
        })
    }

    /// Side of a cell [m].
    pub fn resolution(&self) -> f64 {
        self.maps.first().map_or(0.0, |map| map.grid().pitch())
    }

    /// The exact area of the reach [m²], if the tool is C.
    pub fn exact_area(&self) -> Option<f64> {
        let at_c = self.robot.tool.offset == [0.0; 2];
        at_c.then(|| reachable_area(&self.robot.geometry))
    }
}

fn answer(branch: &Branch) -> Value {
    // Rounded to 0.1 µm: further digits are noise.
    let pair = |point: Vector2<f64>| [point.x, point.y].map(|part| (1e7 * part).round() / 1e7);
    json!({
        "elbow1": branch.mode.elbow1,
        "elbow4": branch.mode.elbow4,
        "assembly": branch.assembly,
        "reached_m2": branch.areas.reached,
        "within_limits_m2": branch.areas.within_limits,
        "clear_m2": branch.areas.clear,
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
