//! One drive that is not ideal: motor, spring and friction at one state.
//!
//! τm = n k(θm) i + τc(θm) + k(θm)/k τx   motor with its ripple and cogging, and the torque of one that is no brushed motor
//! τ = k x + d ẋ             through the spring, x = ψ(θm) − θ; rigid: τ = τm
//! n² J θ̈m = τm − τ dψ/dθm, where ψ = θm but for the errors of a pulley
//! τ + τf(θ̇, z)              turns the joint, with the friction

use crate::friction::{Presliding, Sliding};
use crate::mismatch::Mismatch;
use crate::motor::Motor;
use crate::parameters::Parameters;
use crate::pulley::Pulley;
use crate::ripple::{Ripple, RipplePeriods};
use crate::transmission::Spring;
use fivebar_kinematics::five_bar::Joint;

/// Phase of an oscillation in one integration step [rad]. Numerically it is then damped by a
/// ratio of 0.35⁵/144 = 4e-5.
const PHASE: f64 = 0.35;

/// What is not ideal in one drive.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drive {
    pub(crate) spring: Option<Spring>,
    pulley: Option<Pulley>,
    friction: Option<Presliding>,
    ripple: Option<Ripple>,
    /// The rotor's inertia at the joint, n² J [kg·m²].
    rotor: f64,
    /// The link's inertia about its pivot, a lower bound of the joint's; with the rotor's, if the
    /// drive is rigid [kg·m²].
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

impl DriveState {
    /// At rest at 0.
    pub(crate) const ZERO: Self = Self {
        angle: 0.0,
        speed: 0.0,
        bristles: 0.0,
    };
}

/// What a drive does at one state.
pub(crate) struct DriveAction {
    /// The torque at the joint, friction included [N·m].
    pub(crate) torque: f64,
    /// n k at the rotor's angle [N·m/A].
    pub(crate) constant: f64,
    /// What a motor that is no brushed one gives its rotor [W].
    pub(crate) motor_power: f64,
    /// The rotor's speed over the gear ratio [rad/s].
    pub(crate) speed: f64,
    /// The rates of the drive's state.
    pub(crate) rates: DriveState,
    /// The power lost in friction and spring [W].
    pub(crate) lost: f64,
}

impl Drive {
    /// A drive, with its motor, the periods of its ripple, and the inertia of its link about the pivot [kg·m²].
    pub(crate) fn new(
        parameters: &Parameters,
        mismatch: &Mismatch,
        joint: Joint,
        (motor, periods): (&Motor, RipplePeriods),
        link: f64,
    ) -> Self {
        let (ripple, cogging) = (mismatch.torque_ripple[joint], mismatch.cogging[joint]);
        Self {
            spring: mismatch.spring(parameters, joint),
            pulley: mismatch.pulley(motor.gear_ratio, joint),
            friction: Presliding::new(motor, mismatch.stiction[joint], link),
            ripple: Ripple::new(motor, ripple, cogging, periods),
            rotor: motor.reflected_inertia(),
            link,
        }
    }

    /// Whether none of its effects is on.
    pub(crate) fn is_ideal(&self) -> bool {
        self.spring.is_none() && self.friction.is_none() && self.ripple.is_none()
    }

    /// The rotor's angle over the gear ratio behind a joint at rest at `theta` [rad].
    pub(crate) fn rotor_at(&self, theta: f64) -> f64 {
        self.pulley.map_or(theta, |pulley| pulley.rotor(theta))
    }

    /// What it does with the joint at θ and θ̇, the current i [A] and a motor's torque τx without its
    /// ripple [N·m].
    #[inline(always)]
    pub(crate) fn action(
        &self,
        motor: &Motor,
        state: &DriveState,
        theta: f64,
        omega: f64,
        (current, extra): (f64, f64),
    ) -> DriveAction {
        let (angle, speed) = match self.spring {
            Some(_) => (state.angle, state.speed),
            None => (theta, omega),
        };
        let (share, cogging) = self.ripple.map_or((1.0, 0.0), |ripple| ripple.at(angle));
        let constant = motor.gear_ratio * motor.torque_constant * share;
        let driving = constant * current + cogging + share * extra;
        let Sliding { rate, torque, loss } = match &self.friction {
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
        let mut action = DriveAction {
            torque: driving + torque,
            constant,
            motor_power: share * extra * speed,
            speed,
            rates: DriveState {
                bristles: rate,
                ..DriveState::default()
            },
            lost: loss,
        };
        if let Some(spring) = &self.spring {
            let (ahead, slope) = self.pulley.map_or((0.0, 1.0), |pulley| pulley.at(angle));
            let (x, x_rate) = (angle + ahead - theta, slope * speed - omega);
            let transmitted = spring.torque(x, x_rate);
            action.torque = transmitted + torque;
            action.lost += spring.loss(x, x_rate, transmitted);
            action.rates.angle = speed;
            action.rates.speed = (driving - slope * transmitted) / self.rotor;
        }
        action
    }

    /// Energy in the rotor behind a spring, the spring, the bristles and the magnets' cogging,
    /// with the joint at θ [J].
    pub(crate) fn energy(&self, state: &DriveState, theta: f64) -> f64 {
        let mut energy = self.friction.map_or(0.0, |f| f.energy(state.bristles));
        let mut angle = theta;
        if let Some(spring) = &self.spring {
            angle = state.angle;
            let ahead = self.pulley.map_or(0.0, |pulley| pulley.at(angle).0);
            energy += spring.energy(angle + ahead - theta);
            energy += 0.5 * self.rotor * state.speed * state.speed;
        }
        energy + self.ripple.map_or(0.0, |ripple| ripple.energy(angle))
    }

    /// The longest integration step that resolves it at rest [s], on a supply of this
    /// resistance [Ω].
    pub(crate) fn longest_step_at_rest(&self, motor: &Motor, resistance: f64) -> f64 {
        // Both bridges may be fully on.
        let mut step = motor.inductance / (motor.resistance + 2.0 * resistance);
        let mut turning = self.link;
        if let Some(spring) = &self.spring {
            let inertia = [self.rotor, self.link];
            step = step.min(PHASE / spring.resonance(inertia));
            step = step.min(1.0 / spring.damping_rate(inertia));
            turning = self.rotor;
        }
        if let Some(friction) = &self.friction {
            step = step.min(1.0 / friction.presliding_rate(self.link));
        }
        if let Some(ripple) = &self.ripple {
            step = step.min(PHASE / ripple.resonance(turning));
        }
        step
    }

    /// The longest integration step that resolves what grows with the joint's speed ω [s].
    pub(crate) fn longest_step_at(&self, state: &DriveState, omega: f64) -> f64 {
        let mut step = f64::INFINITY;
        if let Some(friction) = &self.friction {
            step = step.min(1.0 / friction.sliding_rate(omega));
        }
        if let Some(ripple) = &self.ripple {
            let speed = self.spring.map_or(omega, |_| state.speed);
            step = step.min(PHASE / ripple.rate(speed));
        }
        if let Some(pulley) = &self.pulley {
            step = step.min(PHASE / pulley.rate(state.speed));
        }
        step
    }
}
