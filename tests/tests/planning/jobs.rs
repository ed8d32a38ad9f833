//! Whole jobs by time-optimal motion: their limits, and the demonstration on the simulated arm.

use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::{Move, MoveKind, Planner};
use fivebar_plant::Mismatch;
use fivebar_sim::simulation::Simulate;
use fivebar_sim::time_optimal::JobPlanner;

fn demonstration(share: f64) -> Scenario {
    let mut scenario = Scenario::demonstration(Robot::load("benchtop").unwrap());
    scenario.time_optimal = Some(share);
    scenario
}

/// The time of the timed moves [s].
fn motion(moves: &[Move]) -> f64 {
    let timed = moves.iter().filter_map(|next| match next.kind {
        MoveKind::Timed(timed) => Some(f64::from(timed.duration)),
        _ => None,
    });
    timed.sum()
}

#[test]
fn the_demonstration_takes_a_third_of_the_time_under_the_declared_mismatch() {
    let scenario = demonstration(0.7);
    let job = scenario.job().unwrap();
    let time = motion(&scenario.run_moves(&job).unwrap());
    assert!(time < 3.2, "{time} s");
    let (summary, record) = scenario.simulate(&job, &mut |_| ()).unwrap();
    assert_eq!(summary.faults, Vec::<String>::new());
    // Fourteen dwells of 40 ms, and the few milliseconds to the place where the job begins.
    let whole = record.job_time.unwrap();
    assert!(whole < time + 14.0 * 0.04 + 0.05, "{whole} s for {time} s");
    assert_eq!(summary.saturated_ticks, 0);
    assert!(summary.tip_error.max_m < 3e-4, "{:?}", summary.tip_error);
}

#[test]
fn an_identified_arm_uses_more_of_its_torque() {
    let mut scenario = demonstration(0.9);
    scenario.mismatch = Mismatch {
        current_noise: 2.0,
        ..Mismatch::NONE
    };
    let job = scenario.job().unwrap();
    let time = motion(&scenario.run_moves(&job).unwrap());
    assert!(time < 2.6, "{time} s");
    let (summary, _) = scenario.simulate(&job, &mut |_| ()).unwrap();
    assert_eq!(summary.faults, Vec::<String>::new());
    assert_eq!(summary.saturated_ticks, 0);
    assert!(summary.tip_error.max_m < 3e-4, "{:?}", summary.tip_error);
}

/// The controller's check of each piece, with the model that the plan has.
fn check(share: f64) -> Result<(), MoveErrorKind> {
    let scenario = demonstration(0.7);
    let mut planner = Planner::new(&scenario.robot.settings().unwrap().check().unwrap());
    let job = scenario.job().unwrap();
    let moves = scenario.moves(&job).unwrap();
    let from = [0.04, 0.18];
    let planned = JobPlanner::new(&scenario.robot, share).unwrap();
    let mut at = from;
    for next in planned.moves(from, &moves, &mut planner).unwrap() {
        at = planner.check(at, &next).map_err(|error| error.kind)?;
    }
    Ok(())
}

#[test]
fn the_controller_refuses_what_passes_the_joints_torque_and_nothing_less() {
    assert_eq!(check(0.98), Ok(()));
    let beyond = check(1.1);
    assert!(
        matches!(beyond, Err(MoveErrorKind::Overload(1 | 4))),
        "{beyond:?}"
    );
}
