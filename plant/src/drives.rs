//! Drives that are not ideal: their state, and its integration together with the arm's.
//!
//! The state of the arm (positions, velocities, currents) is extended by the rotors behind springs
//! (θm, ωm), the bristles of friction that holds (z) at joints and pen, and the sums of supplied and lost energy. All
//! of it is integrated by the classic fourth-order Runge–Kutta method, then the joints are closed.
//! [`Model::step`] integrates an arm whose drives are all ideal.

use crate::chain::PerJoint;
use crate::drive::{Drive, DriveAction, DriveState};
use crate::dynamics::{CARRIER, DRIVEN, Loads, Model, Rates, SHORTEST_STEP, State};
use crate::mismatch::Mismatch;
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

/// Phase of the tip's oscillation on a pen that sticks in one integration step [rad]; the tip is lighter than its link.
const PEN_PHASE: f64 = 0.2;

/// The drives and the pen, if any of their effects is on.
#[derive(Clone, Debug)]
pub struct Drives {
    drives: [Drive; 2],
    supply: Option<Supply>,
    pen: Option<Pen>,
    /// Whether it touches the paper.
    pub(crate) pen_is_down: bool,
    /// Its deflection [m].
    deflection: Vector2<f64>,
    state: [DriveState; 2],
    energy: Energy,
    /// The work of those motors on their rotors [J].
    motor_work: f64,
    /// The duties of the latest tick.
    duty: [Option<f64>; 2],
    /// Torques of motors that are no brushed ones, at the joint [N·m], without their ripple.
    pub(crate) motor_torque: [f64; 2],
    /// The longest integration step while the joints are at rest [s].
    longest_at_rest: f64,
}

/// The inputs of a step.
#[derive(Clone, Copy)]
struct Inputs<'a> {
    loads: &'a Loads,
    duty: [Option<f64>; 2],
}

#[derive(Clone, Copy)]
struct Whole {
    arm: State,
    drives: [DriveState; 2],
    energy: Energy,
    motor_work: f64,
    deflection: Vector2<f64>,
}

#[derive(Clone, Copy)]
struct WholeRates {
    arm: Rates,
    drives: [DriveState; 2],
    energy: Energy,
    motor_power: f64,
    deflection: Vector2<f64>,
}

impl Whole {
    #[inline(always)]
    fn after(&self, rates: &WholeRates, time: f64) -> Self {
        let drive = |j: Joint| {
            let (state, rate) = (&self.drives[j], &rates.drives[j]);
            DriveState {
                angle: state.angle + rate.angle * time,
                speed: state.speed + rate.speed * time,
                bristles: state.bristles + rate.bristles * time,
            }
        };
        Self {
            arm: self.arm.after(&rates.arm, time),
            drives: Joint::ALL.map(drive),
            energy: Energy {
                supplied: self.energy.supplied + rates.energy.supplied * time,
                lost: self.energy.lost + rates.energy.lost * time,
            },
            motor_work: self.motor_work + rates.motor_power * time,
            deflection: self.deflection + rates.deflection * time,
        }
    }
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

    /// Advances the arm by `time` [s] under constant loads. `loads.voltage` is without the
    /// supply's resistance, `duty` times the supply's voltage.
    pub(crate) fn step(
        &mut self,
        model: &Model,
        state: &mut State,
        loads: &Loads,
        duty: [Option<f64>; 2],
        time: f64,
    ) {
        self.energy.lost += self.cleared(model, state, loads);
        if !self.pen_is_down {
            self.energy.lost += self.pen_energy();
            self.deflection = Vector2::zeros();
        }
        state.clear_floating_currents(loads);
        self.duty = duty;
        let inputs = Inputs { loads, duty };
        let mut whole = Whole {
            arm: *state,
            drives: self.state,
            energy: self.energy,
            motor_work: self.motor_work,
            deflection: self.deflection,
        };
        let steps = (time / self.longest_step(model, state)).ceil().max(1.0);
        for _ in 0..steps as usize {
            self.runge_kutta(model, &mut whole, &inputs, time / steps);
        }
        *state = whole.arm;
        self.state = whole.drives;
        self.energy = whole.energy;
        self.motor_work = whole.motor_work;
        self.deflection = whole.deflection;
    }

    fn runge_kutta(&self, model: &Model, whole: &mut Whole, inputs: &Inputs<'_>, time: f64) {
        let k1 = self.rates(model, whole, inputs);
        let k2 = self.rates(model, &whole.after(&k1, 0.5 * time), inputs);
        let k3 = self.rates(model, &whole.after(&k2, 0.5 * time), inputs);
        let k4 = self.rates(model, &whole.after(&k3, time), inputs);
        let mut next = whole.after(&k1, time / 6.0);
        next = next.after(&k2, time / 3.0);
        next = next.after(&k3, time / 3.0);
        next = next.after(&k4, time / 6.0);
        let State { q, v, .. } = &mut next.arm;
        model.chain.close_joints(q, v);
        *whole = next;
    }

    #[inline]
    fn rates(&self, model: &Model, whole: &Whole, inputs: &Inputs<'_>) -> WholeRates {
        let Inputs { loads, duty } = inputs;
        let arm = &whole.arm;
        let mut torque = loads.joint_torque;
        let mut current = [0.0; 2];
        let mut drives = [DriveState::default(); 2];
        let (mut energy, mut motor_power) = (Energy::default(), 0.0);
        let drop = self.supply.map_or(0.0, |s| s.drop(*duty, arm.current));
        energy.lost += drop * Supply::current(*duty, arm.current);
        for j in Joint::ALL {
            let motor = &model.motors[j];
            let action = self.action(model, arm, &whole.drives[j], j);
            torque[j] += action.torque;
            drives[j] = action.rates;
            energy.lost += action.lost;
            motor_power += action.motor_power;
            energy.supplied += loads.joint_torque[j] * arm.v[DRIVEN[j]].angular;
            if let Some(voltage) = loads.voltage[j] {
                let i = arm.current[j];
                let u = voltage - duty[j].unwrap_or(0.0) * drop;
                let back_emf = action.constant * action.speed;
                current[j] = (u - motor.resistance * i - back_emf) / motor.inductance;
                energy.supplied += voltage * i;
                energy.lost += motor.resistance * i * i;
            }
        }
        if loads.tool_force != Vector2::zeros() {
            energy.supplied += loads.tool_force.dot(&model.tool_velocity(arm));
        }
        let mut deflection = Vector2::zeros();
        let mut tool_force = loads.tool_force;
        if let Some(pen) = self.pen.filter(|_| self.pen_is_down) {
            let (rate, lost) = pen.rate(model.tool_velocity(arm), whole.deflection);
            (deflection, energy.lost) = (rate, energy.lost + lost);
            tool_force += pen.force(whole.deflection);
        }
        let (a, _) = model.accelerations(arm, torque, tool_force);
        WholeRates {
            arm: Rates {
                v: arm.v,
                a,
                current,
            },
            drives,
            energy,
            motor_power,
            deflection,
        }
    }

    /// What a drive does at this state.
    #[inline]
    fn action(&self, model: &Model, arm: &State, state: &DriveState, j: Joint) -> DriveAction {
        let (theta, omega) = (arm.q[DRIVEN[j]].angular, arm.v[DRIVEN[j]].angular);
        let inputs = (arm.current[j], self.motor_torque[j]);
        self.drives[j].action(&model.motors[j], state, theta, omega, inputs)
    }

    /// The longest integration step that resolves the drives at this state [s].
    fn longest_step(&self, model: &Model, state: &State) -> f64 {
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
        let torque = Joint::ALL.map(|j| self.action(model, state, &self.state[j], j).torque);
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
