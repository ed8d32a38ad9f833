//! What the controller says of crossings that the host has planned.

use crate::crossing::{case, pair};
use crate::crossing_controller::allowed;
use fivebar_report::study::crossing::{check_by_controller, task};

/// The refusal of a line [m] of the arm of a case in `time` [s]; none: the controller accepts it.
fn refusal(name: &str, ends: [[f64; 2]; 2], time: f64) -> Option<String> {
    let robot = allowed(&case(name));
    let task = task(&robot, ends, time).unwrap();
    let plan = task.plan().unwrap();
    let checked = check_by_controller(&robot, &task, &plan);
    checked.err().map(|refusal| refusal.to_string())
}

#[test]
fn the_examples_are_accepted_there_and_back() {
    for name in ["short", "pinched"] {
        let case = case(name);
        let [start, end] = [pair(&case["start"]), pair(&case["end"])];
        assert_eq!(refusal(name, [start, end], 0.3), None);
        assert_eq!(refusal(name, [end, start], 0.3), None);
    }
}

/// Each refusal tells its reason, and its way out leads to a crossing.
#[test]
fn what_the_controller_refuses_is_told_with_a_way_out() {
    let short = [[0.06, 0.115], [0.03, 0.012]];
    let near = [[0.06, 0.115], [0.0118, 0.0391]];
    let quick = [[0.1408, 0.08], [0.2193, 0.0797]];
    for (name, ends, time, reason, way_out) in [
        ("short", short, 1.0, "cross in less time", (short, 0.7)),
        (
            "short",
            short,
            4.5,
            "longer than 4 s; go faster",
            (short, 0.7),
        ),
        (
            "short",
            near,
            0.3,
            "too nearly in line at (11.800",
            (short, 0.3),
        ),
        ("pinched", quick, 0.2, "cross in more time", (quick, 0.4)),
    ] {
        let refused = refusal(name, ends, time).unwrap();
        assert!(refused.contains(reason), "{refused}");
        let (ends, time) = way_out;
        assert_eq!(refusal(name, ends, time), None, "{reason}");
    }
}
