//! The simulated benchtop arm and a small drawing for it.

use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_firmware::{ActuatorCommand, Move, MoveKind, SensorSample, Settings};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::Mismatch;
use fivebar_plant::Plant;
use fivebar_sim::link::{Loopback, Target};
use fivebar_sim::simulation::{Record, Simulation};

pub(crate) fn robot() -> Robot {
    Robot::load(BuiltIn::DEFAULT).expect("the default robot")
}

/// The arm, 0.03 rad before its home switches.
pub(crate) fn plant() -> Plant {
    plant_of(&robot())
}

fn plant_of(robot: &Robot) -> Plant {
    let before = |joint: Joint| match robot.settings().expect("the robot has masses").axes[joint]
        .home_forward
    {
        true => -0.03,
        false => 0.03,
    };
    let pose = robot
        .pose_near_home(Joint::ALL.map(before))
        .expect("a reachable pose");
    Plant::new(
        &robot.plant_parameters().expect("the robot has masses"),
        &Mismatch::default(),
        &pose,
        7,
    )
}

/// A line from home, a half circle, a dwell and a line back.
pub(crate) fn moves() -> Vec<Move> {
    let robot = robot();
    let [x, y] = robot
        .best_point()
        .expect("a reachable point")
        .map(|x| x as f32);
    let feed = 0.3;
    let kinds = [
        MoveKind::Line { to: [x, y], feed },
        MoveKind::Arc {
            to: [x + 0.02, y],
            center: [x + 0.01, y],
            clockwise: true,
            feed,
        },
        MoveKind::Dwell { duration: 0.02 },
        MoveKind::Line { to: [x, y], feed },
    ];
    (1..)
        .zip(kinds)
        .map(|(tag, kind)| Move { tag, tool: 0, kind })
        .collect()
}

/// Draws with a controller.
pub(crate) fn run(target: &mut impl Target) -> Record {
    let rate = robot().control.tick_rate;
    Simulation::new(target, plant(), rate)
        .run(&moves(), &[], &mut |_| ())
        .expect("all moves are accepted")
}

/// The benchtop arm with a controller that has its own clock.
pub(crate) fn driving() -> Loopback {
    driving_of(&robot())
}

/// The same with another arm.
pub(crate) fn driving_of(robot: &Robot) -> Loopback {
    let mut plant = plant_of(robot);
    let period = 1.0 / robot.control.tick_rate;
    let step = move |command: &ActuatorCommand| -> SensorSample {
        plant.step(command, period);
        plant.sense()
    };
    let settings = robot.settings().expect("the robot has masses");
    Loopback::driving(&settings, Box::new(step)).expect("valid settings")
}

pub(crate) fn settings() -> Settings {
    robot().settings().expect("the robot has masses")
}
