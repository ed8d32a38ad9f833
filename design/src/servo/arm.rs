//! The arm behind its drives at one pose, linear about rest, and sampled.
//!
//! With the rotors' angles θm, the joints' angles θ, the rotors' inertia Jr, the arm's mass
//! matrix Ma without them, stiffness k and damping d of the drives:
//!
//! Jr θ̈m = N k i − k(θm − θ) − d(θ̇m − θ̇), Ma θ̈ = k(θm − θ) + d(θ̇m − θ̇) − b θ̇,
//! L di/dt = v − R i − N k θ̇m.
//!
//! A rigid drive has θm = θ. The voltages v are held over a tick.

use super::exponential::exponential;
use fivebar_kinematics::control::Belt;
use nalgebra::{DMatrix, Matrix2};

/// One drive, as its loop meets it. Angles and torques are at the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoDrive {
    /// N k: torque per current [N·m/A], without sign.
    pub torque_per_current: f64,
    /// R [Ω].
    pub resistance: f64,
    /// L [H].
    pub inductance: f64,
    /// Jr: the rotor's inertia [kg·m²].
    pub rotor_inertia: f64,
    /// b: viscous friction at the joint [N·m·s/rad].
    pub viscous_friction: f64,
    /// k: stiffness of gear or belt [N·m/rad]; none: rigid.
    pub stiffness: Option<f64>,
    /// d: its damping [N·m·s/rad].
    pub damping: f64,
    /// Whether the encoder is at the joint; else it is at the rotor.
    pub encoder_at_joint: bool,
    /// Age of the encoder's angle when it is sampled [s].
    pub encoder_latency: f64,
    /// One count of the encoder [rad].
    pub count: f64,
    /// Greatest torque [N·m].
    pub peak_torque: f64,
}

impl ServoDrive {
    /// The drive's natural frequency when both ends are free [Hz], with `inertia` [kg·m²] at the
    /// joint, of the arm without the rotor: √(k(1/Jr + 1/J))/2π; none for a rigid drive.
    pub fn resonance(&self, inertia: f64) -> Option<f64> {
        let stiffness = self.stiffness.filter(|_| self.rotor_inertia > 0.0)?;
        let rate = (stiffness * (1.0 / self.rotor_inertia + 1.0 / inertia)).sqrt();
        Some(rate / std::f64::consts::TAU)
    }

    /// What stretches; infinitely stiff for a rigid drive.
    pub(super) fn belt(&self) -> Belt<f64> {
        Belt {
            stiffness: self.stiffness.unwrap_or(f64::INFINITY),
            damping: self.damping,
            rotor_inertia: self.rotor_inertia,
            encoder_at_joint: self.encoder_at_joint,
        }
    }

    /// Whether rotor and joint move by themselves.
    pub(super) fn is_elastic(&self) -> bool {
        self.stiffness.is_some() && self.rotor_inertia > 0.0
    }
}

/// An arm at one pose with its drives, sampled at the tick.
#[derive(Clone, Debug)]
pub struct Servo {
    /// M(θ) with the rotors [kg·m²], which the controller uses.
    pub mass_matrix: Matrix2<f64>,
    /// The drives of joint 1 and joint 4.
    pub drives: [ServoDrive; 2],
    /// T [s].
    pub period: f64,
    /// x ← A x + B v + W w over one tick; x: angles, the joints' first, rates, then the currents; w: torques on the
    /// joints from outside.
    pub(super) a: DMatrix<f64>,
    pub(super) b: DMatrix<f64>,
    pub(super) w: DMatrix<f64>,
    /// For each joint, the row that gives the encoder's angle, when it is younger than a whole
    /// number of ticks by 1 − ε ticks, from the state and the voltages of the tick before.
    pub(super) angle: [Angle; 2],
    /// The states that are currents.
    pub(super) currents: [usize; 2],
}

/// What the encoder of one joint reads.
#[derive(Clone, Debug)]
pub(super) struct Angle {
    /// The angle at the tick is row·x.
    pub(super) row: DMatrix<f64>,
    /// The angle at (k − ε)T is early.0·x(k−1) + early.1·v(k−1); none for ε = 0.
    pub(super) early: Option<(DMatrix<f64>, DMatrix<f64>)>,
    /// Whole ticks that it is late besides.
    pub(super) ticks: usize,
}

/// The continuous system: ẋ = A x + B v.
struct Continuous {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
}

impl Continuous {
    /// e^(At), and the integral of e^(As) B over 0…t.
    fn sampled(&self, t: f64) -> (DMatrix<f64>, DMatrix<f64>) {
        let (n, inputs) = self.b.shape();
        let mut both = DMatrix::zeros(n + inputs, n + inputs);
        both.view_mut((0, 0), (n, n)).copy_from(&(&self.a * t));
        both.view_mut((0, n), (n, inputs)).copy_from(&(&self.b * t));
        let grown = exponential(&both);
        let part = |from, columns| grown.view((0, from), (n, columns)).into_owned();
        (part(0, n), part(n, inputs))
    }
}

impl Servo {
    /// The arm with the mass matrix `mass_matrix` [kg·m²], the rotors included, at ticks of
    /// `period` [s].
    pub fn new(mass_matrix: Matrix2<f64>, drives: [ServoDrive; 2], period: f64) -> Self {
        // Coordinates: the joints, then the rotors that move by themselves.
        let elastic: Vec<usize> = (0..2).filter(|&j| drives[j].is_elastic()).collect();
        let n = 2 + elastic.len();
        let rotor = |j: usize| elastic.iter().position(|&e| e == j).map_or(j, |at| 2 + at);
        let mut mass = DMatrix::zeros(n, n);
        let mut stiffness = DMatrix::zeros(n, n);
        let mut damping = DMatrix::zeros(n, n);
        mass.view_mut((0, 0), (2, 2)).copy_from(&mass_matrix);
        for (j, drive) in drives.iter().enumerate() {
            let m = rotor(j);
            damping[(j, j)] += drive.viscous_friction;
            if m == j {
                continue;
            }
            mass[(j, j)] -= drive.rotor_inertia;
            mass[(m, m)] = drive.rotor_inertia;
            for (matrix, value) in [
                (&mut stiffness, drive.stiffness.unwrap_or(0.0)),
                (&mut damping, drive.damping),
            ] {
                for (row, column, sign) in [(m, m, 1.0), (j, j, 1.0), (m, j, -1.0), (j, m, -1.0)] {
                    matrix[(row, column)] += sign * value;
                }
            }
        }
        let size = 2 * n + 2;
        let mut a = DMatrix::zeros(size, size);
        let mut b = DMatrix::zeros(size, 2);
        let inverse = mass
            .try_inverse()
            .unwrap_or_else(|| DMatrix::from_element(n, n, f64::NAN));
        a.view_mut((0, n), (n, n)).fill_with_identity();
        a.view_mut((n, 0), (n, n))
            .copy_from(&(-&inverse * stiffness));
        a.view_mut((n, n), (n, n)).copy_from(&(-&inverse * damping));
        let currents = [2 * n, 2 * n + 1];
        for (j, drive) in drives.iter().enumerate() {
            let (m, i) = (rotor(j), currents[j]);
            for row in 0..n {
                a[(n + row, i)] = inverse[(row, m)] * drive.torque_per_current;
            }
            a[(i, i)] = -drive.resistance / drive.inductance;
            a[(i, n + m)] = -drive.torque_per_current / drive.inductance;
            b[(i, j)] = 1.0 / drive.inductance;
        }
        let mut loads = DMatrix::zeros(size, 2);
        loads
            .view_mut((n, 0), (n, 2))
            .copy_from(&inverse.columns(0, 2));
        let (_, w) = Continuous {
            a: a.clone(),
            b: loads,
        }
        .sampled(period);
        let continuous = Continuous { a, b };
        let (a, b) = continuous.sampled(period);
        let angle = [0, 1].map(|j| {
            let mut row = DMatrix::zeros(1, size);
            row[(
                0,
                if drives[j].encoder_at_joint {
                    j
                } else {
                    rotor(j)
                },
            )] = 1.0;
            Angle::new(row, drives[j].encoder_latency / period, &continuous, period)
        });
        Self {
            mass_matrix,
            drives,
            period,
            a,
            b,
            w,
            angle,
            currents,
        }
    }
}

impl Angle {
    /// The reading of the angle row·x, `late` ticks old.
    fn new(row: DMatrix<f64>, late: f64, continuous: &Continuous, period: f64) -> Self {
        // A thousandth of a tick is no time.
        let late = (late * 1e3).round() / 1e3;
        let part = late.fract();
        let early = (part > 0.0).then(|| {
            let (a, b) = continuous.sampled((1.0 - part) * period);
            (&row * a, &row * b)
        });
        let ticks = late.trunc() as usize;
        Self { row, early, ticks }
    }
}
