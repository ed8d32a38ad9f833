//! A crossing on the simulated arm, in closed loop.
//!
//! The cranks' angles are those of the encoders, whole counts, their speeds from the observer of the
//! tick. The torque acts one tick later; the motors are sources of torque here.

use fivebar_design::crossing::{CrossingControl, CrossingError, CrossingPlan, CrossingTask};
use fivebar_files::robot::{MissingMasses, Robot};
use fivebar_kinematics::control::{ObserverState, VelocityObserver};
use fivebar_kinematics::five_bar::Side;
use fivebar_plant::{Loads, Mismatch, Model, State};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// What the arm meets on the way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CrossingConditions {
    /// How the arm differs from the controller's model.
    pub mismatch: Mismatch,
    /// A force on the tip against its motion [N].
    pub drag: f64,
    /// |sin(θ3−θ2)| below which the drag acts; none: everywhere.
    pub drag_below: Option<f64>,
    /// Whether the encoders show the cranks' angles exactly; else in whole counts.
    pub exact_angles: bool,
}

/// How a crossing went.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossingRun {
    /// The assembly mode at the end, of the simulated arm itself.
    pub assembly: Side,
    /// The greatest distance of the tip from the plan [m].
    pub tip_error: f64,
    /// The distance at the end [m].
    pub end_error: f64,
    /// The torques of each tick [N·m].
    pub torque: Vec<[f64; 2]>,
    /// Ticks in which a torque was at its limit.
    pub saturated_ticks: usize,
    /// The time of the end of the torque [s], if the arm was found stuck.
    pub unpowered_at: Option<f64>,
}

/// Why a crossing is not simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CrossingRunError {
    /// The robot has lengths only.
    #[error(transparent)]
    Masses(#[from] MissingMasses),
    /// The plan cannot be followed.
    #[error(transparent)]
    Crossing(#[from] CrossingError),
}

/// The simulation goes on for this time after the plan, in times of the plan.
const AFTERMATH: f64 = 1.0;
/// Below this speed the drag falls to zero [m/s].
const CREEP: f64 = 1e-3;
/// The integration's longest step [s].
const STEP: f64 = 1e-5;

/// Follows a plan on the simulated arm.
///
/// # Errors
/// A robot without masses.
pub fn follow(
    robot: &Robot,
    task: &CrossingTask<'_>,
    plan: &CrossingPlan,
    conditions: &CrossingConditions,
) -> Result<CrossingRun, CrossingRunError> {
    let parameters = robot.plant_parameters()?;
    let model = Model::new(&parameters, &conditions.mismatch);
    let period = 1.0 / robot.control.tick_rate;
    let mut control = CrossingControl::new(task, plan, period)?;
    let geometry = task.arm.geometry();
    let start = geometry
        .inverse(task.from, task.mode)
        .map_err(|error| CrossingError::Pose(0.0, error))?;
    let mut state = model.state_at(&start, [0.0; 4]);
    let begins = sine(&state);

    let drives = robot.drives()?;
    let count = drives.map(|drive| TAU / f64::from(drive.encoder_counts) / drive.gear_ratio.abs());
    let observer = VelocityObserver::new(robot.control.observer_bandwidth, period);
    let cranks = |state: &State| [state.q[0].angular, state.q[3].angular];
    let mut estimates = cranks(&state).map(ObserverState::at_rest);
    let ticks = (task.time * (1.0 + AFTERMATH) / period).ceil() as usize;
    let steps = (period / STEP.min(model.longest_step())).ceil();
    let mut run = CrossingRun {
        assembly: plan.assembly[0],
        tip_error: 0.0,
        end_error: 0.0,
        torque: Vec::with_capacity(ticks),
        saturated_ticks: 0,
        unpowered_at: None,
    };
    let mut applied = [0.0; 2];
    for tick in 0..ticks {
        let measured = cranks(&state);
        let at = *control.setpoint(tick);
        for j in 0..2 {
            let shown = match conditions.exact_angles {
                true => measured[j],
                false => (measured[j] / count[j]).round() * count[j],
            };
            observer.update(&mut estimates[j], shown, at.alpha[j]);
        }
        let (theta, omega) = (
            estimates.map(|estimate| estimate.angle),
            estimates.map(|estimate| estimate.velocity),
        );
        let torque = control.torque(tick, theta, omega);
        if torque.is_none() && run.unpowered_at.is_none() {
            run.unpowered_at = Some(period * tick as f64);
        }
        let torque = torque.unwrap_or_default();
        let limited = (0..2).any(|j| torque[j].abs() >= task.torque[j]);
        run.saturated_ticks += usize::from(limited);
        run.torque.push(torque);
        let velocity = model.tool_velocity(&state);
        let drags = conditions
            .drag_below
            .is_none_or(|below| sine(&state).abs() < below);
        let drag = if drags { conditions.drag } else { 0.0 };
        let loads = Loads {
            voltage: [None; 2],
            joint_torque: std::mem::replace(&mut applied, torque),
            tool_force: -velocity * (drag / velocity.norm().max(CREEP)),
        };
        for _ in 0..steps as usize {
            model.step(&mut state, &loads, period / steps);
        }
        run.end_error = distance(&model, &state, control.setpoint(tick + 1).tip);
        run.tip_error = run.tip_error.max(run.end_error);
    }
    if sine(&state) * begins < 0.0 {
        run.assembly = plan.assembly[1];
    }
    Ok(run)
}

/// sin(θ3−θ2).
fn sine(state: &State) -> f64 {
    (state.q[2].angular - state.q[1].angular).sin()
}

fn distance(model: &Model, state: &State, place: Vector2<f64>) -> f64 {
    (model.tool(state) - place).norm()
}
