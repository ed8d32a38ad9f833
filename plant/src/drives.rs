//! Drives that are not ideal: their state, and its integration together with the arm's.
//!
//! The state of the arm (positions, velocities, currents) is extended by the rotors behind springs
//! (θm, ωm), the bristles of friction that holds (z), and the sums of supplied and lost energy. All
//! of it is integrated by the classic fourth-order Runge–Kutta method, then the joints are closed.
//! [`Model::step`] integrates an arm whose drives are all ideal.

use crate::chain::PerJoint;
use crate::dynamics::{DRIVEN, Loads, Model, Rates, State};
use crate::friction::{Presliding, Sliding};
use crate::mismatch::Mismatch;
use crate::parameters::Parameters;
use crate::planar::PlanarVector;
use crate::ripple::Ripple;
use crate::supply::Supply;
use crate::transmission::Spring;
use nalgebra::Vector2;

/// Phase of a rotor's oscillation on its spring in one integration step [rad]. Numerically it is
/// then damped by a ratio of 0.35⁵/144 = 4e-5.
const PHASE: f64 = 0.35;

/// What is not ideal in one drive.
#[derive(Clone, Copy, Debug)]
struct Drive {
    spring: Option<Spring>,
    friction: Option<Presliding>,
    ripple: Option<Ripple>,
    /// The rotor's inertia at the joint, n² J [kg·m²].
    rotor: f64,
    /// The link's inertia about its pivot, a lower bound of the joint's [kg·m²].
    link: f64,
}

/// The state of one drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveState {
    /// The rotor's angle over the gear ratio, θm [rad], if the drive has a spring.
    pub angle: f64,
    /// Its rate [rad/s].
    pub speed: f64,
    /// The bristles' deflection z, if friction holds [rad].
    pub bristles: f64,
}

/// Energies since the start [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Given by the supply, by brakes (less than 0) and by the force on the tool.
    pub supplied: f64,
    /// Turned into heat by windings, supply, friction and springs.
    pub lost: f64,
}

/// The drives, if any of their effects is on.
#[derive(Clone, Debug)]
pub struct Drives {
    drives: [Drive; 2],
    supply: Option<Supply>,
    state: [DriveState; 2],
    energy: Energy,
    /// The duties of the latest tick.
    duty: [Option<f64>; 2],
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
}

#[derive(Clone, Copy)]
struct WholeRates {
    arm: Rates,
    drives: [DriveState; 2],
    energy: Energy,
}

impl Whole {
    #[inline]
    fn after(&self, rates: &WholeRates, time: f64) -> Self {
        let drive = |j: usize| {
            let (state, rate) = (&self.drives[j], &rates.drives[j]);
            DriveState {
                angle: state.angle + rate.angle * time,
                speed: state.speed + rate.speed * time,
                bristles: state.bristles + rate.bristles * time,
            }
        };
        Self {
            arm: self.arm.after(&rates.arm, time),
            drives: [drive(0), drive(1)],
            energy: Energy {
                supplied: self.energy.supplied + rates.energy.supplied * time,
                lost: self.energy.lost + rates.energy.lost * time,
            },
        }
    }
}

impl Drives {
    /// The drives of an arm with this mismatch, at rest in `state`. None if all are ideal.
    pub(crate) fn new(
        parameters: &Parameters,
        mismatch: &Mismatch,
        model: &Model,
        state: &State,
    ) -> Option<Self> {
        let links = model.about_pivots();
        let drives = [0, 1].map(|j| {
            let motor = &model.motors[j];
            let spring = mismatch.spring(parameters, j);
            let rotor = motor.reflected_inertia();
            let inertia = links[j] + if spring.is_some() { 0.0 } else { rotor };
            Drive {
                spring,
                friction: Presliding::new(motor, mismatch.stiction[j], inertia),
                ripple: Ripple::new(motor, mismatch.torque_ripple[j], mismatch.cogging[j]),
                rotor,
                link: inertia,
            }
        });
        let resistance = mismatch.supply_resistance;
        let supply = (resistance > 0.0).then_some(Supply { resistance });
        let ideal = |d: &Drive| d.spring.is_none() && d.friction.is_none() && d.ripple.is_none();
        if supply.is_none() && drives.iter().all(ideal) {
            return None;
        }
        Some(Self {
            drives,
            supply,
            state: DRIVEN.map(|link| DriveState {
                angle: state.q[link].angular,
                speed: state.v[link].angular,
                bristles: 0.0,
            }),
            energy: Energy::default(),
            duty: [None; 2],
        })
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
        state.clear_floating_currents(loads);
        self.duty = duty;
        let inputs = Inputs { loads, duty };
        let mut whole = Whole {
            arm: *state,
            drives: self.state,
            energy: self.energy,
        };
        let steps = (time / self.longest_step(model, state)).ceil().max(1.0);
        for _ in 0..steps as usize {
            self.runge_kutta(model, &mut whole, &inputs, time / steps);
        }
        *state = whole.arm;
        self.state = whole.drives;
        self.energy = whole.energy;
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
        let mut energy = Energy::default();
        let drop = self.supply.map_or(0.0, |s| s.drop(*duty, arm.current));
        energy.lost += drop * Supply::current(*duty, arm.current);
        for j in 0..2 {
            let motor = &model.motors[j];
            let omega = arm.v[DRIVEN[j]].angular;
            energy.supplied += loads.joint_torque[j] * omega;
            let Turning {
                torque: turning,
                constant,
                rates,
                lost,
                speed,
            } = self.turning(model, arm, &whole.drives[j], j);
            torque[j] += turning;
            drives[j] = rates;
            energy.lost += lost;
            if let Some(voltage) = loads.voltage[j] {
                let i = arm.current[j];
                let u = voltage - duty[j].unwrap_or(0.0) * drop;
                current[j] = (u - motor.resistance * i - constant * speed) / motor.inductance;
                energy.supplied += voltage * i;
                energy.lost += motor.resistance * i * i;
            }
        }
        if loads.tool_force != Vector2::zeros() {
            energy.supplied += loads.tool_force.dot(&model.tool_velocity(arm));
        }
        let (a, _) = model.accelerations(arm, torque, loads.tool_force);
        WholeRates {
            arm: Rates {
                v: arm.v,
                a,
                current,
            },
            drives,
            energy,
        }
    }

    /// What a drive does at this state, without the voltage of its bridge.
    #[inline]
    fn turning(&self, model: &Model, arm: &State, state: &DriveState, j: usize) -> Turning {
        let (drive, motor) = (&self.drives[j], &model.motors[j]);
        let PlanarVector { angular: theta, .. } = arm.q[DRIVEN[j]];
        let PlanarVector { angular: omega, .. } = arm.v[DRIVEN[j]];
        let (angle, speed) = match drive.spring {
            Some(_) => (state.angle, state.speed),
            None => (theta, omega),
        };
        let (share, cogging) = drive.ripple.map_or((1.0, 0.0), |ripple| ripple.at(angle));
        let constant = motor.gear_ratio * motor.torque_constant * share;
        let driving = constant * arm.current[j] + cogging;
        let Sliding { rate, torque, loss } = match &drive.friction {
            Some(friction) => friction.at(omega, state.bristles),
            None => {
                let torque = motor.friction(omega);
                Sliding {
                    rate: 0.0,
                    torque,
                    loss: -torque * omega,
                }
            }
        };
        let mut rates = DriveState {
            bristles: rate,
            ..DriveState::default()
        };
        let (mut lost, mut transmitted) = (loss, driving);
        if let Some(spring) = &drive.spring {
            let (x, x_rate) = (angle - theta, speed - omega);
            transmitted = spring.torque(x, x_rate);
            lost += spring.loss(x, x_rate, transmitted);
            rates.angle = speed;
            rates.speed = (driving - transmitted) / drive.rotor;
        }
        Turning {
            torque: transmitted + torque,
            constant,
            rates,
            lost,
            speed,
        }
    }

    /// The longest integration step that resolves the drives at this state [s].
    fn longest_step(&self, model: &Model, state: &State) -> f64 {
        let mut step = model.longest_step();
        for (j, drive) in self.drives.iter().enumerate() {
            let omega = state.v[DRIVEN[j]].angular;
            let motor = &model.motors[j];
            if let Some(Supply { resistance }) = self.supply {
                step = step.min(motor.inductance / (motor.resistance + 2.0 * resistance));
            }
            let mut speed = omega;
            if let Some(spring) = &drive.spring {
                let inertia = [drive.rotor, drive.link];
                step = step.min(PHASE / spring.resonance(inertia));
                step = step.min(1.0 / spring.damping_rate(inertia));
                speed = self.state[j].speed;
            }
            if let Some(friction) = &drive.friction {
                step = step.min(1.0 / friction.fastest_rate(omega, drive.link));
            }
            if let Some(ripple) = &drive.ripple {
                step = step.min(PHASE / ripple.rate(speed));
            }
        }
        step.max(crate::dynamics::SHORTEST_STEP)
    }

    /// Energy of the currents that floating terminals end [J].
    fn cleared(&self, model: &Model, state: &State, loads: &Loads) -> f64 {
        let ended = |j: usize| match loads.voltage[j] {
            Some(_) => 0.0,
            None => winding(model, state, j),
        };
        ended(0) + ended(1)
    }

    /// The drives' states.
    pub fn state(&self) -> &[DriveState; 2] {
        &self.state
    }

    /// The energies that were supplied and lost.
    pub fn energy(&self) -> Energy {
        self.energy
    }

    /// Energy in the arm, the windings, the rotors, the springs, the bristles and the magnets'
    /// cogging [J].
    pub fn stored(&self, model: &Model, state: &State) -> f64 {
        let of = |j: usize| {
            let (drive, own) = (&self.drives[j], &self.state[j]);
            let theta = state.q[DRIVEN[j]].angular;
            let mut energy = winding(model, state, j);
            let mut angle = theta;
            if let Some(spring) = &drive.spring {
                angle = own.angle;
                energy += spring.energy(angle - theta);
                energy += 0.5 * drive.rotor * own.speed * own.speed;
            }
            energy += drive.ripple.map_or(0.0, |ripple| ripple.energy(angle));
            energy + drive.friction.map_or(0.0, |f| f.energy(own.bristles))
        };
        model.energy(state) + of(0) + of(1)
    }

    /// The voltage that the supply's resistance takes [V].
    pub(crate) fn voltage_drop(&self, state: &State) -> f64 {
        self.supply
            .map_or(0.0, |s| s.drop(self.duty, state.current))
    }

    /// The angle over the gear ratio [rad] and its rate [rad/s] of a rotor; none without a spring.
    pub(crate) fn rotor(&self, joint: usize) -> Option<(f64, f64)> {
        let DriveState { angle, speed, .. } = self.state[joint];
        self.drives[joint].spring.map(|_| (angle, speed))
    }

    /// The force through each joint, A to E, on the body nearer to E [N].
    pub(crate) fn reactions(&self, model: &Model, state: &State, force: Vector2<f64>) -> PerJoint {
        let torque = [0, 1].map(|j| self.turning(model, state, &self.state[j], j).torque);
        model.accelerations(state, torque, force).1
    }
}

/// What one drive does.
struct Turning {
    /// The torque at the joint, friction included [N·m].
    torque: f64,
    /// n k at the rotor's angle [N·m/A].
    constant: f64,
    /// The rates of its state.
    rates: DriveState,
    /// The power that it loses [W].
    lost: f64,
    /// The rotor's speed over the gear ratio [rad/s].
    speed: f64,
}

/// Energy of a winding [J].
fn winding(model: &Model, state: &State, joint: usize) -> f64 {
    0.5 * model.motors[joint].inductance * state.current[joint] * state.current[joint]
}
