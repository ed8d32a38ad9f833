//! The way from home to a job.

use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::{MoveKind, Planner};
use fivebar_sim::simulation::Simulate;
use std::sync::LazyLock;

/// A scenario with the job's (0, 0) at a place [m].
fn scenario(text: &str, origin: [f64; 2]) -> Scenario {
    // Its bandwidths follow from its arm: they are searched once.
    static BENCHTOP: LazyLock<Robot> = LazyLock::new(|| Robot::load("benchtop").unwrap());
    let robot = BENCHTOP.clone();
    let mut scenario = Scenario::new("approach", robot, "approach.gcode", text.into());
    scenario.origin = Some(origin);
    scenario
}

/// Whether the arm moves to the job by its joints; the job is accepted.
fn is_by_joints(scenario: &Scenario) -> bool {
    let job = scenario.job().unwrap();
    scenario
        .check(&job)
        .unwrap_or_else(|error| panic!("{error}"));
    let moves = scenario.run_moves(&job).unwrap();
    matches!(moves[0].kind, MoveKind::Joint { .. })
}

#[test]
fn the_way_is_straight_where_that_is_possible() {
    assert!(!is_by_joints(&scenario(
        "G0 X0 Y0\nG1 X5 F3000",
        [0.04, 0.18]
    )));
}

#[test]
fn the_joints_move_where_a_straight_way_would_leave_the_workspace() {
    let text = "G0 X0 Y0\nM3\nG1 X2 F3000";
    let robot = Robot::load("benchtop").unwrap();
    let home = robot.tool_at(&robot.home_pose().unwrap()).map(|x| x as f32);
    let planner = Planner::new(&robot.settings().unwrap().check().unwrap());
    // Places all over the reach.
    let places = (0..40).flat_map(|x| (0..30).map(move |y| (x, y)));
    let mut by_joints = 0;
    for (x, y) in places {
        let origin = [-0.15 + 0.01 * f64::from(x), 0.01 * f64::from(y)];
        let scenario = scenario(text, origin);
        let job = scenario.job().unwrap();
        let first = job.moves(0.3).next().unwrap();
        let is_straight = planner.check(home, &first).is_ok();
        if !is_straight && scenario.check(&job).is_ok() {
            assert!(is_by_joints(&scenario), "{origin:?}");
            by_joints += 1;
        }
    }
    assert!(by_joints >= 3, "{by_joints} places");
}

#[test]
fn a_job_from_a_line_on_stays_in_place_and_goes_there_with_the_tool_up() {
    let text = "G21 G90 F600\nM3\nG1 X10\nG1 Y10\nM0\nG1 X0\n";
    let mut scenario = scenario(text, [0.04, 0.2]);
    let whole = scenario.job().unwrap();
    scenario.from_line = Some(4);
    let job = scenario.job().unwrap();
    let way = job.steps[0];
    assert_eq!(
        (way.line, way.tool, way.action.end()),
        (0, 0.0, Some([0.05, 0.2]))
    );
    assert_eq!(job.steps[1..], whole.steps[whole.steps.len() - 2..]);
    assert_eq!(job.stops[0].before, 2, "behind the way and line 4");
    scenario.from_line = Some(7);
    let refusal = scenario.job().unwrap_err().to_string();
    assert!(
        refusal.contains("no motion at or behind line 7"),
        "{refusal}"
    );
}

#[test]
fn an_arm_whose_home_is_given_stands_there() {
    let text = BuiltIn::find("benchtop").unwrap().text;
    let text = format!("{text}\n[homing]\nmethod = \"given\"\n");
    let robot = Robot::parse("given.toml", &text).unwrap();
    let mut scenario = Scenario::new(
        "given",
        robot,
        "job.gcode",
        "G0 X0 Y0\nM3\nG1 X5 F3000".into(),
    );
    scenario.origin = Some([0.04, 0.18]);
    let job = scenario.job().unwrap();
    let (summary, _) = scenario.simulate(&job, &mut |_| ()).unwrap();
    let error = summary.tip_error.rms_m;
    assert!(
        error < 20e-6,
        "{error} m: home is where a jig holds the arm"
    );
}
