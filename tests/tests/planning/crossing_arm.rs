//! A crossing by the controller, tick by tick, on a simulated arm that a test can hinder.

use crate::crossing_controller::moves;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{Controller, Move, Planner, Request};
use fivebar_kinematics::five_bar::Side;
use fivebar_plant::{Mismatch, Plant};
use fivebar_sim::simulation::Simulate;
use nalgebra::Vector2;
use serde_json::Value;
use std::f64::consts::TAU;

/// How a crossing ended.
#[derive(Debug)]
pub(crate) struct Ending {
    pub(crate) fault: Option<Fault>,
    pub(crate) homed: bool,
    pub(crate) powered: bool,
    /// sin(θ3−θ2) of the arm itself at the end, positive in its first assembly mode.
    pub(crate) sine: f64,
    /// The greatest distance of the tip from its reference on the way [m].
    pub(crate) tip_error: f64,
    pub(crate) saturated: bool,
    /// What the plan's mode leaves unexplained, over what the other one does.
    pub(crate) ratio: f32,
}

/// The arm of a run.
pub(crate) struct Arm {
    plant: Plant,
    robot: Robot,
    /// The demanded torques of this tick [N·m].
    pub(crate) torque: [f64; 2],
    /// Of sin(θ3−θ2) before the crossing.
    sign: f64,
}

impl Arm {
    /// sin(θ3−θ2), positive in the first assembly mode.
    pub(crate) fn sine(&self) -> f64 {
        let q = &self.plant.state().q;
        self.sign * (q[2].angular - q[1].angular).sin()
    }

    /// Puts the links into the first assembly mode, with the cranks and their speeds as they are.
    pub(crate) fn fall_back(&mut self) {
        let state = *self.plant.state();
        let geometry = &self.robot.geometry;
        let [theta1, theta4] = [0, 3].map(|link| state.q[link].angular);
        let poses = [Side::Left, Side::Right].map(|side| geometry.forward(theta1, theta4, side));
        let first = |pose: &&_| self.sign * fivebar_kinematics::five_bar::Pose::sin32(pose) > 0.0;
        let pose = poses.iter().flatten().find(first).unwrap();
        let [omega1, omega4] = [0, 3].map(|link| state.v[link].angular);
        let velocities = geometry.forward_velocities(pose, omega1, omega4).unwrap();
        let mut links = self.plant.model().state_at(pose, velocities.omega);
        for (link, was) in links.q.iter_mut().zip(&state.q) {
            link.angular += ((was.angular - link.angular) / TAU).round() * TAU;
        }
        self.plant.set_links(&links);
    }

    /// An elastic wall where B, C and D are in line: C comes back from it.
    pub(crate) fn bounce(&mut self) {
        let lengths = self.robot.geometry.lengths();
        let q = &self.plant.state().q;
        let along = |angle: f64| Vector2::new(angle.cos(), angle.sin());
        let b = along(q[0].angular) * lengths[0];
        let d = Vector2::new(lengths[4], 0.0) + along(q[3].angular) * lengths[3];
        let n = Vector2::new((b - d).y, (d - b).x).normalize() * self.sign;
        let behind = -(self.plant.tool() - b).dot(&n);
        self.plant.set_tool_force(n * (1e5 * behind.max(0.0)));
    }
}

/// The crossing of a case by a robot, with an arm that `hinder` can change after each tick, by the time since the
/// plan's beginning [s].
pub(crate) fn cross(
    case: &Value,
    robot: Robot,
    mismatch: Mismatch,
    mut hinder: impl FnMut(&mut Arm, f64),
) -> Ending {
    let moves = moves(case, &robot);
    let settings = robot.settings().unwrap().check().unwrap();
    let (mut controller, mut planner) = (Controller::new(&settings), Planner::new(&settings));
    let mut scenario = Scenario::new("crossing", robot, "none", String::new());
    scenario.mismatch = mismatch;
    let plant = scenario.plant().unwrap();
    let mut arm = Arm {
        plant,
        robot: scenario.robot,
        torque: [0.0; 2],
        sign: 1.0,
    };
    let mut ending = Ending {
        fault: None,
        homed: false,
        powered: false,
        sine: 0.0,
        tip_error: 0.0,
        saturated: false,
        ratio: 0.0,
    };
    let (mut offered, mut begun) = (0, None);
    for tick in 0..400_000_u32 {
        controller.feed_host_timeout();
        planner.run(&mut controller);
        let command = controller.tick(&arm.plant.sense());
        let status = controller.status();
        let begin = match status.state {
            State::Crossing => *begun.get_or_insert_with(|| {
                arm.sign = arm.sine().signum();
                tick
            }),
            _ if begun.is_some() => {
                let [plan, other] = planner.crossing_evidence();
                ending.ratio = plan / other;
                ending.sine = arm.sine();
                (ending.fault, ending.homed) = (status.fault, status.homed);
                ending.powered = command.enable != [false; 2];
                return ending;
            }
            _ => tick,
        };
        if begun.is_some() {
            ending.saturated |= !status.limits.is_empty();
            if let Some([x, y]) = status.reference {
                let away = arm.plant.tool() - Vector2::new(f64::from(x), f64::from(y));
                ending.tip_error = ending.tip_error.max(away.norm());
            }
            arm.torque = status.torque.map(f64::from);
            hinder(&mut arm, f64::from(tick - begin) * 1e-4);
        }
        arm.plant.step(&command, 1e-4);
        match status.state {
            State::Stopped if tick == 0 => controller.request(Request::Home).unwrap(),
            State::Stopped if status.homed => {
                // Refused until the arm rests.
                let _ = controller.request(Request::Arm);
            }
            State::Armed | State::Running => {
                offered += push(&mut planner, &mut controller, &moves[offered..]);
            }
            _ => {}
        }
    }
    panic!("the crossing never ends");
}

/// Pushes the next move. Returns how many were accepted.
fn push(planner: &mut Planner, controller: &mut Controller, moves: &[Move]) -> usize {
    let Some(next) = moves.first() else {
        return 0;
    };
    match planner.push(controller, next) {
        Ok(()) => 1,
        Err(error) => {
            assert_eq!(error.kind, MoveErrorKind::Full);
            0
        }
    }
}
