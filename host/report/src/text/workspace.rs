//! The figures of a workspace as a table of text.

use super::quantity;
use crate::study::workspace::WorkspaceStudy;
use nalgebra::Vector2;
use std::fmt::Write as _;

/// A table with one line for each branch.
pub fn workspace(study: &WorkspaceStudy<'_>) -> String {
    let mut text = format!(
        "{}: cells of {}; singularity margin {}\n\n\
         elbows 1, 4   assembly   reached  in limits      clear  largest clear rectangle                      best 1/κ\n\
         \u{20}                          [cm²]      [cm²]      [cm²]  [mm]\n",
        study.robot.name,
        quantity(study.resolution(), "m"),
        study.robot.limits.singularity_margin,
    );
    for branch in &study.branches {
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
            branch.areas.clear,
        ]
        .map(|area| 1e4 * area);
        let own = if branch.mode == study.robot.working_mode() {
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
    if let Some(exact) = study.exact_area() {
        let _ = writeln!(text, "exact area of the reach: {:.1} cm²", 1e4 * exact);
    }
    text
}

/// Metres in millimetres.
fn mm(metres: f64) -> String {
    format!("{:.1}", 1e3 * metres).replace('-', "−")
}

fn at(place: Vector2<f64>) -> String {
    format!("({}, {})", mm(place.x), mm(place.y))
}
