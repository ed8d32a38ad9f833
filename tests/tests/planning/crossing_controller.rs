//! Crossings by the controller, with the real drives, on the simulated arm.

use crate::crossing::{case, number, pair, robot};
use fivebar::input::robot::Robot;
use fivebar::input::scenario::Scenario;
use fivebar::run::crossing_move::crossing_move;
use fivebar::run::link::InProcess;
use fivebar::run::simulation::{Record, Sample, Simulation};
use fivebar::study::crossing::task;
use fivebar_firmware::{Move, MoveKind};
use fivebar_kinematics::five_bar::Side;
use fivebar_plant::Mismatch;
use nalgebra::Vector2;
use serde_json::Value;

fn allowed(case: &Value) -> Robot {
    robot(case, "[crossing]\nallowed = true\n")
}

/// The crossing of a case, and the moves before it.
fn moves(case: &Value, robot: &Robot) -> Vec<Move> {
    let ends = [pair(&case["start"]), pair(&case["end"])];
    let task = task(robot, ends, number(&case["tf"])).unwrap();
    let plan = task.plan().unwrap();
    let start = task.arm.geometry().inverse(task.from, task.mode).unwrap();
    let [theta1, _, _, theta4] = start.angles().map(|angle| angle as f32);
    let joints = MoveKind::Joint {
        to: [theta1, theta4],
        speed: 0.2,
    };
    let kinds = [joints, crossing_move(&task, &plan)];
    kinds
        .map(|kind| Move {
            tag: 1,
            tool: 0,
            kind,
        })
        .into()
}

/// A run of these moves in this process.
fn run(scenario: &Scenario, moves: &[Move]) -> Record {
    let settings = scenario.robot.settings().unwrap();
    let mut target = InProcess::new(&settings).unwrap();
    let plant = scenario.plant().unwrap();
    let simulation = Simulation::new(&mut target, plant, scenario.robot.control.tick_rate);
    simulation.run(moves, &[], &mut |_| ()).unwrap()
}

fn scenario(robot: Robot, mismatch: Mismatch) -> Scenario {
    let mut scenario = Scenario::new("crossing", robot, "none", String::new());
    scenario.mismatch = mismatch;
    scenario
}

/// The time for which the controller settles after a plan [s].
const SETTLING: f64 = 0.02;

/// The samples of the crossing, and the time at which the plan is in the
/// singularity [s].
fn crossing_of<'a>(case: &Value, record: &'a Record) -> (Vec<&'a Sample>, f64) {
    let end = record.job_time.unwrap();
    let begin = end - SETTLING - number(&case["tf"]);
    let samples = record.trace.samples().iter();
    let samples = samples.filter(|sample| sample.time > begin && sample.time < end - SETTLING);
    (samples.collect(), begin + number(&case["tc"]))
}

/// The assembly mode of the simulated arm, by its true cranks and tool.
fn assembly(robot: &Robot, sample: &Sample) -> Side {
    let geometry = &robot.geometry;
    let [theta1, theta4] = sample.angle;
    let away = |side: &Side| {
        let pose = geometry.forward(theta1, theta4, *side).unwrap();
        (pose.c - Vector2::from(sample.tool)).norm()
    };
    let [left, right] = [Side::Left, Side::Right].map(|side| (away(&side), side));
    let (off, side) = if left.0 < right.0 { left } else { right };
    assert!(off < 1e-6, "{off} m");
    side
}

#[test]
fn the_controller_crosses_under_the_declared_mismatch() {
    for (name, most) in [("short", [2e-5, 2.7e-4]), ("pinched", [1.5e-4, 5.5e-4])] {
        let case = case(name);
        for (mismatch, most) in [Mismatch::NONE, Mismatch::default()].into_iter().zip(most) {
            let scenario = scenario(allowed(&case), mismatch);
            let record = run(&scenario, &moves(&case, &scenario.robot));
            assert_eq!(record.faults, [], "{name}");
            let (samples, _) = crossing_of(&case, &record);
            let error = samples
                .iter()
                .map(|sample| sample.tip_error())
                .fold(0.0, f64::max);
            assert!(error < most, "{name}: {error} m");
            assert!(!samples.iter().any(|sample| sample.saturated), "{name}");
            let last = record.trace.samples().last().unwrap();
            assert_eq!(assembly(&scenario.robot, samples[0]), Side::Left, "{name}");
            assert_eq!(assembly(&scenario.robot, last), Side::Right, "{name}");
        }
    }
}
