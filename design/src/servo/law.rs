//! The controller's loops as numbers: found by asking the code that the target runs.

use super::arm::{Servo, ServoDrive};
use super::belt_law::belt_laws;
use super::linear::Linear;
use fivebar_kinematics::control::{
    BeltGains, BeltLaw, Bus, CurrentLoop, CurrentState, ObserverState, PositionLoop,
    VelocityObserver,
};
use nalgebra::{DMatrix, Matrix2, Vector2};

/// Bandwidths of the loops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Of the position loop [rad/s].
    pub bandwidth: f64,
    /// Its damping ratio.
    pub damping: f64,
    /// Rate of the integral action [rad/s].
    pub integral_rate: f64,
    /// Of the velocity observer [rad/s].
    pub observer_bandwidth: f64,
    /// Of the current loop [rad/s].
    pub current_bandwidth: f64,
    /// The loops of joints behind belts, which then take the position loop's part.
    pub belts: Option<[BeltGains<f64>; 2]>,
}

impl Gains {
    /// Bandwidth of the feedback of the joints' angles [rad/s]; of joints behind belts the lower one.
    pub fn feedback_bandwidth(&self) -> f64 {
        match &self.belts {
            None => self.bandwidth,
            Some([belt1, belt4]) => belt1.bandwidth.min(belt4.bandwidth),
        }
    }
}

/// What a controller does that has the model of the arm at a pose.
#[derive(Clone, Debug)]
pub struct ArmLaw {
    pub(super) joints: [Law; 2],
    /// M of the model [kg·m²].
    pub(super) mass_matrix: Matrix2<f64>,
    /// Kp of each joint [1/s²].
    pub(super) angle_gains: [f64; 2],
    /// From the encoders' angles to the demanded torques, of joints behind belts.
    pub(super) belts: Option<Linear>,
}

impl Servo {
    /// What a controller does whose model is this arm. It may then control another one.
    pub fn law(&self, gains: &Gains) -> ArmLaw {
        let joints = self.drives;
        ArmLaw {
            joints: joints.map(|drive| Law::new(gains, &drive, self.period)),
            mass_matrix: self.mass_matrix,
            angle_gains: match &gains.belts {
                None => [gains.bandwidth; 2],
                Some(belts) => belts.map(|belt| belt.bandwidth),
            }
            .map(|bandwidth| bandwidth * bandwidth),
            belts: gains.belts.map(|belts| self.belt_law(&belts, gains)),
        }
    }

    fn belt_law(&self, belts: &[BeltGains<f64>; 2], gains: &Gains) -> Linear {
        let drive_lag = 1.0 / gains.current_bandwidth;
        let laws = [0, 1].map(|j| {
            let drive = &self.drives[j];
            let lag = drive_lag + drive.encoder_latency;
            BeltLaw::new(&drive.belt(), &belts[j], drive_lag, lag, self.period)
        });
        let latency = self.drives.map(|drive| drive.encoder_latency);
        let late = (latency[0].max(latency[1]) / self.period).round() as usize;
        let mass_matrix = DMatrix::from_column_slice(2, 2, self.mass_matrix.as_slice());
        let rotors = self.drives.map(|drive| drive.rotor_inertia);
        belt_laws(&laws, &mass_matrix, &rotors, late)
    }
}

/// The laws of one joint. Each is linear while nothing is limited, so its answers to unit inputs
/// are its coefficients.
#[derive(Clone, Copy, Debug)]
pub(super) struct Law {
    /// (θ̂, ω̂) ← observer (θ̂, ω̂) + measured θ.
    pub(super) observer: Matrix2<f64>,
    pub(super) measured: Vector2<f64>,
    /// −α = angle_gain θ̂ + velocity_gain ω̂ − integral.
    pub(super) angle_gain: f64,
    pub(super) velocity_gain: f64,
    /// integral ← integral − integral_gain (θ̂ + lead ω̂).
    pub(super) integral_gain: f64,
    pub(super) lead: f64,
    /// v = current_gain e + x + back_emf ω̂, x ← x + current_integral e.
    pub(super) current_gain: f64,
    pub(super) current_integral: f64,
    pub(super) back_emf: f64,
}

/// A bus that limits nothing [V].
const AMPLE: f64 = 1e9;

impl Law {
    pub(super) fn new(gains: &Gains, drive: &ServoDrive, period: f64) -> Self {
        let observer = VelocityObserver::new(gains.observer_bandwidth, period);
        let observed = |angle, velocity, measured| {
            let mut state = ObserverState { angle, velocity };
            observer.update(&mut state, measured, 0.0);
            Vector2::new(state.angle, state.velocity)
        };
        // The prediction bridges the encoder's latency, too.
        let lag = 1.0 / gains.current_bandwidth + drive.encoder_latency;
        let position = PositionLoop::new(
            gains.bandwidth,
            gains.damping,
            lag,
            gains.integral_rate,
            period,
        );
        let demanded = |angle, velocity| {
            let (angle, velocity) = position.predict(angle, velocity, 0.0);
            let none = fivebar_kinematics::control::Integral(0.0);
            -position.acceleration(none, 0.0, -angle, -velocity)
        };
        let mut integral = fivebar_kinematics::control::Integral(0.0);
        position.integrate(&mut integral, 1.0, false);
        let current = CurrentLoop::new(
            gains.current_bandwidth,
            period,
            drive.resistance,
            drive.inductance,
            drive.torque_per_current,
        );
        let bus = Bus::new(AMPLE, 1.0);
        let volts = |demand, omega| {
            let mut state = CurrentState(0.0);
            let drive = current.update(&mut state, demand, 0.0, omega, &bus);
            (AMPLE * drive.duty, state.0)
        };
        let (current_gain, current_integral) = volts(1.0, 0.0);
        let (back_emf, _) = volts(0.0, 1.0);
        Self {
            observer: Matrix2::from_columns(&[observed(1.0, 0.0, 0.0), observed(0.0, 1.0, 0.0)]),
            measured: observed(0.0, 0.0, 1.0),
            angle_gain: demanded(1.0, 0.0),
            velocity_gain: demanded(0.0, 1.0),
            integral_gain: integral.0,
            lead: position.lag(),
            current_gain,
            current_integral,
            back_emf,
        }
    }
}
