//! README's table of tip errors: every figure is that of a run.

use crate::servo_loop::changed;
use fivebar_files::scenario::{ControlLaw, Scenario};
use fivebar_sim::simulation::Simulate as _;

const README: &str = include_str!("../../../README.md");
pub(crate) const UPRIGHT: (&str, &str) = ("gravity", "gravity = [0.0, -9.81]");
/// Upright, an arm needs brakes, or it falls when it has no power.
pub(crate) const BRAKES: (&str, &str) = ("[[actuator]]", "[[actuator]]\nbrake_torque = 0.5");

/// The greatest and the RMS tip error under a law, as the table writes them.
fn errors(scenario: &Scenario, law: ControlLaw) -> String {
    let scenario = Scenario {
        control_law: law,
        ..scenario.clone()
    };
    let job = scenario.job().expect("the demonstration");
    let (summary, record) = scenario.simulate(&job, &mut |_| ()).expect("it runs");
    assert_eq!(record.faults, []);
    let microns = |metres: f64| 1e6 * metres;
    let rms = microns(summary.tip_error.rms_m);
    let digits = usize::from(rms < 9.95);
    format!(
        "{rms:.digits$} µm ({:.0})",
        microns(summary.tip_error.max_m)
    )
}

#[test]
fn the_first_tip_errors_of_readme_are_those_of_runs() {
    are_those_of_runs(2);
}

#[test]
#[ignore = "some seconds: ./ci.sh tables"]
fn whole_table_of_readmes_tip_errors_is_that_of_runs() {
    are_those_of_runs(5);
}

/// The table's first rows, so many.
fn are_those_of_runs(count: usize) {
    let [rigid, belts] = ["benchtop", "benchtop_belt"];
    let fast = [
        ("max_acceleration = 4", "max_acceleration = 20.0"),
        ("max_jerk", "max_jerk = 2000.0"),
    ];
    let rows = [
        ("level", rigid, "demonstration", &[][..]),
        ("upright", rigid, "demonstration", &[UPRIGHT, BRAKES]),
        (
            "level, five times the acceleration",
            rigid,
            "demonstration",
            &fast,
        ),
        ("level, realistic arm", belts, "realistic", &[]),
        (
            "upright, realistic arm",
            belts,
            "realistic",
            &[UPRIGHT, BRAKES],
        ),
    ];
    let mut wrong = String::new();
    for (name, robot, scenario, changes) in rows.into_iter().take(count) {
        let file = format!(
            "{}/../host/files/scenarios/{scenario}.toml",
            env!("CARGO_MANIFEST_DIR")
        );
        let mut scenario = Scenario::load(&file).expect("a scenario");
        scenario.robot = changed(robot, changes);
        let [ours, pid] =
            [ControlLaw::ComputedTorque, ControlLaw::Pid].map(|law| errors(&scenario, law));
        let row = format!("| {name} | {ours} | {pid} |\n");
        if !README.contains(&row) {
            wrong += &row;
        }
    }
    assert!(wrong.is_empty(), "README lacks these rows:\n{wrong}");
}
