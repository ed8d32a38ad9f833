//! Drives that are not ideal, and their state. `integration.rs` advances it.

use crate::chain::PerJoint;
use crate::drive::{Drive, DriveAction, DriveState};
use crate::dynamics::{CARRIER, DRIVEN, Loads, Model, SHORTEST_STEP, State};
use crate::mismatch::Mismatch;
use crate::motor::Motor;
use crate::parameters::Parameters;
use crate::pen::Pen;
use crate::ripple::RipplePeriods;
use crate::supply::Supply;
use fivebar_kinematics::five_bar::Joint;
use nalgebra::Vector2;

/// Energies since the start [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Given by the supply, by brakes (less than 0) and by the force on the tool.
    pub supplied: f64,
    /// Turned into heat by windings, supply, friction and springs.
    pub lost: f64,
}

impl Energy {
    pub(crate) const ZERO: Self = Self {
        supplied: 0.0,
        lost: 0.0,
    };
}

/// Phase of the tip's oscillation on a pen that sticks in one integration step [rad]; the tip is lighter than its link.
const PEN_PHASE: f64 = 0.2;

/// The drives and the pen, if any of their effects is on.
#[derive(Clone, Debug)]
pub struct Drives {
    drives: [Drive; 2],
    pub(crate) supply: Option<Supply>,
    pub(crate) pen: Option<Pen>,
    /// Whether it touches the paper.
    pub(crate) pen_is_down: bool,
    /// Its deflection [m].
    pub(crate) deflection: Vector2<f64>,
    pub(crate) state: [DriveState; 2],
    pub(crate) energy: Energy,
    /// The work of those motors on their rotors [J].
    pub(crate) motor_work: f64,
    /// The duties of the latest tick.
    duty: [Option<f64>; 2],
    /// Torques of motors that are no brushed ones, at the joint [N·m], without their ripple.
    pub(crate) motor_torque: [f64; 2],
    /// The longest integration step while the joints are at rest [s].
    longest_at_rest: f64,
}

impl Drives {
    /// The drives of an arm with this mismatch, at rest in `state`; `periods` are those of its motors'
    /// ripple.
    pub(crate) fn new(
        parameters: &Parameters,
        mismatch: &Mismatch,
        periods: RipplePeriods,
        (model, state): (&Model, &State),
    ) -> Self {
        let links = model.about_pivots();
        let drives = Joint::ALL.map(|j| {
            Drive::new(
                parameters,
                mismatch,
                j,
                (&model.motors[j], periods),
                links[j],
            )
        });
        let resistance = mismatch.supply_resistance;
        let supply = (resistance > 0.0).then_some(Supply { resistance });
        let steps =
            Joint::ALL.map(|j| drives[j].longest_step_at_rest(&model.motors[j], resistance));
        Self {
            longest_at_rest: model.longest_step().min(steps[0]).min(steps[1]),
            pen: Pen::new(mismatch.pen_friction),
            pen_is_down: false,
            deflection: Vector2::zeros(),
            supply,
            state: Joint::ALL.map(|j| DriveState {
                angle: drives[j].rotor_at(state.q[DRIVEN[j]].angular),
                speed: state.v[DRIVEN[j]].angular,
                bristles: 0.0,
            }),
            drives,
            energy: Energy::default(),
            motor_work: 0.0,
            duty: [None; 2],
            motor_torque: [0.0; 2],
        }
    }

    /// Whether none of their effects is on.
    pub(crate) fn are_ideal(&self) -> bool {
        self.supply.is_none() && self.pen.is_none() && self.drives.iter().all(Drive::is_ideal)
    }

    /// Puts the drives to rest behind the joints of `state`.
    pub(crate) fn rest_at(&mut self, state: &State) {
        self.deflection = Vector2::zeros();
        self.state = Joint::ALL.map(|j| DriveState {
            angle: self.rotor_at(j, state.q[DRIVEN[j]].angular),
            ..DriveState::default()
        });
    }

    /// The rotor's angle over the gear ratio behind a joint at rest at `theta` [rad].
    pub(crate) fn rotor_at(&self, joint: Joint, theta: f64) -> f64 {
        self.drives[joint].rotor_at(theta)
    }

    /// Breaks a drive's belt; a rigid drive has none.
    pub(crate) fn break_belt(&mut self, joint: Joint) {
        if let Some(spring) = &mut self.drives[joint].spring {
            spring.break_apart();
        }
    }

    /// Prepares a step with these duties: what the pen and the currents of floating terminals held is lost.
    pub(crate) fn begin(
        &mut self,
        model: &Model,
        state: &State,
        loads: &Loads,
        duty: [Option<f64>; 2],
    ) {
        self.energy.lost += self.cleared(model, state, loads);
        if !self.pen_is_down {
            self.energy.lost += self.pen_energy();
            self.deflection = Vector2::zeros();
        }
        self.duty = duty;
    }

    /// What a drive does in its state, with its joint at θ [rad] and ω [rad/s] and this current [A].
    #[inline(always)]
    pub(crate) fn action(
        &self,
        motor: &Motor,
        state: &DriveState,
        j: Joint,
        (theta, omega): (f64, f64),
        current: f64,
    ) -> DriveAction {
        let inputs = (current, self.motor_torque[j]);
        self.drives[j].action(motor, state, theta, omega, inputs)
    }

    /// The longest integration step that resolves the drives at this state [s].
    pub(crate) fn longest_step(&self, model: &Model, state: &State) -> f64 {
        let mut step = self.longest_at_rest;
        if let Some(pen) = self.pen.filter(|_| self.pen_is_down) {
            step = step.min(1.0 / pen.sliding_rate(model.tool_velocity(state).norm()));
            step = step.min(PEN_PHASE / pen.resonance(model.chain.bodies[CARRIER].mass));
        }
        for (j, drive) in self.drives.iter().enumerate() {
            let omega = state.v[DRIVEN[j]].angular;
            step = step.min(drive.longest_step_at(&self.state[j], omega));
        }
        step.max(SHORTEST_STEP)
    }

    /// Energy of the currents that floating terminals end [J].
    fn cleared(&self, model: &Model, state: &State, loads: &Loads) -> f64 {
        let ended = |j: Joint| match loads.voltage[j] {
            Some(_) => 0.0,
            None => winding(model, state, j),
        };
        let [ended1, ended4] = Joint::ALL.map(ended);
        ended1 + ended4
    }

    /// Puts the drives into these states, with the pen up.
    pub(crate) fn set_state(&mut self, state: [DriveState; 2]) {
        self.state = state;
        self.deflection = Vector2::zeros();
    }

    /// The drives' states.
    pub fn state(&self) -> &[DriveState; 2] {
        &self.state
    }

    /// The work on their rotors of motors that are no brushed ones [J]. It is not in the energy that was supplied.
    pub fn motor_work(&self) -> f64 {
        self.motor_work
    }

    /// The energies that were supplied and lost.
    pub fn energy(&self) -> Energy {
        self.energy
    }

    /// Energy of the pen's deflection [J].
    fn pen_energy(&self) -> f64 {
        self.pen.map_or(0.0, |pen| pen.energy(self.deflection))
    }

    /// Energy in the arm, the windings, the rotors, the springs, the bristles, the magnets'
    /// cogging and the pen [J].
    pub fn stored(&self, model: &Model, state: &State) -> f64 {
        let of = |j: Joint| {
            let theta = state.q[DRIVEN[j]].angular;
            winding(model, state, j) + self.drives[j].energy(&self.state[j], theta)
        };
        let [drive1, drive4] = Joint::ALL.map(of);
        model.energy(state) + drive1 + drive4 + self.pen_energy()
    }

    /// The voltage that the supply's resistance takes [V].
    pub(crate) fn voltage_drop(&self, state: &State) -> f64 {
        self.supply
            .map_or(0.0, |s| s.drop(self.duty, state.current))
    }

    /// The angle over the gear ratio [rad] and its rate [rad/s] of a rotor; none without a spring.
    pub(crate) fn rotor(&self, joint: Joint) -> Option<(f64, f64)> {
        let DriveState { angle, speed, .. } = self.state[joint];
        self.drives[joint].spring.map(|_| (angle, speed))
    }

    /// The force through each joint, A to E, on the body nearer to E [N].
    pub(crate) fn reactions(&self, model: &Model, state: &State, force: Vector2<f64>) -> PerJoint {
        let torque = Joint::ALL.map(|j| {
            let (motor, link) = (&model.motors[j], DRIVEN[j]);
            let motion = (state.q[link].angular, state.v[link].angular);
            let action = self.action(motor, &self.state[j], j, motion, state.current[j]);
            action.torque
        });
        let held = self
            .pen
            .map_or_else(Vector2::zeros, |pen| pen.force(self.deflection));
        model.accelerations(state, torque, force + held).1
    }
}

/// Energy of a winding [J].
fn winding(model: &Model, state: &State, joint: Joint) -> f64 {
    0.5 * model.motors[joint].inductance * state.current[joint] * state.current[joint]
}
