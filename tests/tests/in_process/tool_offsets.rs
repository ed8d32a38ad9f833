//! An arm with its tool far from C draws the demonstration: from the robot file through the
//! settings, homing and the planner to the simulated tool, in every working mode.
//!
//! With a large offset A–B–T turns the other way than A–B–C. Code that confuses the two refuses
//! the job or follows it on the wrong branch.

use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_kinematics::five_bar::{Side, WorkingMode};
use fivebar_sim::simulation::Simulate;

/// Along link 2 and to its left [m]; each component is tried with both signs.
const OFFSETS: [[f64; 2]; 3] = [[0.16, 0.1], [0.1, 0.16], [0.2, 0.05]];

/// The drawing's greatest scale: large enough that a wrong branch shows.
const SCALE: f64 = 0.2;

/// Greatest distance of the tool from its reference [m].
const ERROR: f64 = 100e-6;

/// The benchtop arm with such a tool, its joints free to turn, in one of the modes of C.
/// Its home is where C is in front of the base's middle, as far from singularities as can be.
fn robot(mode: WorkingMode, [along, left]: [f64; 2]) -> Robot {
    let text = BuiltIn::find(BuiltIn::DEFAULT).expect("the default").text;
    let text = text
        .lines()
        .filter(|line| !line.starts_with("home = "))
        .map(|line| {
            if line.starts_with("working_mode = ") {
                format!(
                    "working_mode = [\"{}\", \"{}\"]\n",
                    mode.elbow1, mode.elbow4
                )
            } else if line.starts_with("angle = ") {
                "angle = [[-6.28, 6.28], [-6.28, 6.28]]\n".into()
            } else {
                format!("{line}\n")
            }
        });
    let text: String = text.collect();
    let text = format!("{text}\n[tool]\noffset = [{along:?}, {left:?}]\n");
    Robot::parse("offset.toml", &text).expect("a valid robot")
}

/// Draws the demonstration where it fits; returns whether A–B–T turned the other way than A–B–C.
fn draws(robot: Robot) -> bool {
    let mut scenario = Scenario::demonstration(robot);
    let (mode, of_c) = (scenario.robot.working_mode(), scenario.robot.elbows);
    let offset = scenario.robot.tool.offset;
    let what = format!("{offset:?} with C {}, {}", of_c.elbow1, of_c.elbow4);
    scenario
        .fit()
        .unwrap_or_else(|error| panic!("{what}: {error}"));
    scenario.scale = scenario.scale.min(SCALE);
    let job = scenario.job().expect("a job");
    let (summary, record) = scenario.simulate(&job, &mut |_| ()).expect("a run");
    assert_eq!(record.faults, [], "{what}");
    let end = record.trace.samples().last().expect("samples");
    let last = job
        .steps
        .iter()
        .filter_map(|step| step.action.end())
        .next_back();
    let [x, y] = last.expect("a motion");
    let missed = (end.tool[0] - x).hypot(end.tool[1] - y);
    println!(
        "{what}: scale {}, {:.1e} m",
        scenario.scale, summary.tip_error.max_m
    );
    assert!(missed < ERROR, "{what}: it ends {missed} m off");
    assert!(summary.tip_error.max_m < ERROR, "{what}: {summary:?}");
    mode != of_c
}

/// Draws with the first offsets in one of the modes of C. With some of them A–B–T must turn the
/// other way; otherwise the offsets are too small for this test.
fn draws_with_offsets(offsets: usize, [elbow1, elbow4]: [Side; 2]) {
    let mode = WorkingMode::new(elbow1, elbow4);
    let mut turned = 0;
    for [along, left] in OFFSETS.into_iter().take(offsets) {
        for signs in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
            turned += usize::from(draws(robot(mode, [signs[0] * along, signs[1] * left])));
        }
    }
    assert!(turned >= offsets, "of {}: {turned}", 4 * offsets);
}

#[test]
fn the_demonstration_is_drawn_with_large_tool_offsets_and_both_elbows_left() {
    draws_with_offsets(1, [Side::Left, Side::Left]);
}

#[test]
fn the_demonstration_is_drawn_with_large_tool_offsets_and_elbows_in() {
    draws_with_offsets(1, [Side::Left, Side::Right]);
}

#[test]
fn the_demonstration_is_drawn_with_large_tool_offsets_and_elbows_out() {
    draws_with_offsets(1, [Side::Right, Side::Left]);
}

#[test]
fn the_demonstration_is_drawn_with_large_tool_offsets_and_both_elbows_right() {
    draws_with_offsets(1, [Side::Right, Side::Right]);
}

#[test]
#[ignore = "ten seconds: ./ci.sh tables"]
fn whole_table_of_large_tool_offsets_with_which_the_demonstration_is_drawn() {
    for elbow1 in [Side::Left, Side::Right] {
        for elbow4 in [Side::Left, Side::Right] {
            draws_with_offsets(OFFSETS.len(), [elbow1, elbow4]);
        }
    }
}
