//! The frequency response L(e^(jωT)) of the open loop, block by block.

use super::arm::Servo;
use super::law::{ArmLaw, Law};
use super::linear::solve;
use nalgebra::{DMatrix, Matrix2};
use num_complex::Complex;

type C = Complex<f64>;

/// What the arm does at one frequency: currents and encoder angles for voltages.
#[derive(Clone, Copy, Debug)]
pub(super) struct ArmResponse {
    z: C,
    currents: Matrix2<C>,
    angles: Matrix2<C>,
}

/// The open loop at one frequency.
pub(super) struct OpenLoop {
    /// L: the torques demanded for torques.
    pub(super) response: Matrix2<C>,
    /// M K: the torques demanded for encoder angles.
    pub(super) feedback: Matrix2<C>,
}

fn complex(matrix: &DMatrix<f64>) -> DMatrix<C> {
    matrix.map(|x| C::new(x, 0.0))
}

impl Servo {
    /// The arm's response at ω [rad/s]. The voltages act one tick after they are set.
    pub(super) fn arm_response(&self, omega: f64) -> ArmResponse {
        let z = C::from_polar(1.0, omega * self.period);
        let x = solve(&self.a, &self.b, z);
        let rows = [0, 1].map(|j| {
            let angle = &self.angle[j];
            let read = match &angle.early {
                None => complex(&angle.row) * &x,
                Some((state, volts)) => (complex(state) * &x + complex(volts)) / z,
            };
            (read / z) * z.powi(-(angle.ticks as i32))
        });
        let currents = self.currents.map(|i| x.row(i) / z);
        let matrix =
            |rows: [[C; 2]; 2]| Matrix2::new(rows[0][0], rows[0][1], rows[1][0], rows[1][1]);
        ArmResponse {
            z,
            currents: matrix([0, 1].map(|j| [currents[j][0], currents[j][1]])),
            angles: matrix([0, 1].map(|j| [rows[j][(0, 0)], rows[j][(0, 1)]])),
        }
    }

    /// L(z) = M K(z) P(z) V(z): voltages for torques, encoder angles for voltages, torques
    /// demanded for angles.
    pub(super) fn open_loop(&self, law: &ArmLaw, arm: &ArmResponse) -> OpenLoop {
        let z = arm.z;
        let laws = &law.joints;
        let one = C::new(1.0, 0.0);
        let estimates = [Estimate::new(&laws[0], z), Estimate::new(&laws[1], z)];
        let current = |j: usize| laws[j].current_integral / (z - one) + laws[j].current_gain;
        let (current1, current4) = (current(0), current(1));
        let back_emf = |j: usize| estimates[j].velocity * laws[j].back_emf;
        // v = C (τ/(N k) − i) + Ke ω̂.
        let volts = Matrix2::identity() + rows(current1, current4, &arm.currents)
            - rows(back_emf(0), back_emf(1), &arm.angles);
        let per_torque = |j: usize, current: C| current / self.drives[j].torque_per_current;
        let nan = Matrix2::from_element(C::new(f64::NAN, 0.0));
        let volts = columns(
            &volts.try_inverse().unwrap_or(nan),
            per_torque(0, current1),
            per_torque(1, current4),
        );
        let feedback = law.feedback(z, &estimates);
        OpenLoop {
            response: product(&product(&feedback, &arm.angles), &volts),
            feedback,
        }
    }
}

impl ArmLaw {
    /// M K(z): the torques demanded against encoder angles.
    pub(super) fn feedback(&self, z: C, estimates: &[Estimate; 2]) -> Matrix2<C> {
        if let Some(belts) = &self.belts {
            let torques = belts.response(z);
            return Matrix2::from_fn(|row, column| -torques[(row, column)]);
        }
        let laws = &self.joints;
        let feedback = |j: usize| {
            let (law, estimate) = (&laws[j], &estimates[j]);
            let integral = law.integral_gain / (z - 1.0);
            estimate.angle * law.angle_gain
                + estimate.velocity * law.velocity_gain
                + (estimate.angle + estimate.velocity * law.lead) * integral
        };
        let mass = self.mass_matrix.map(|m| C::new(m, 0.0));
        columns(&mass, feedback(0), feedback(1))
    }
}

// Products of 2×2 matrices, written out: a search needs some hundred thousand of them, and
// nalgebra's general product takes several times longer in a build for tests.

/// A B.
pub(super) fn product(a: &Matrix2<C>, b: &Matrix2<C>) -> Matrix2<C> {
    let entry = |i: usize, j: usize| a[(i, 0)] * b[(0, j)] + a[(i, 1)] * b[(1, j)];
    Matrix2::new(entry(0, 0), entry(0, 1), entry(1, 0), entry(1, 1))
}

/// diag(x, y) A.
fn rows(x: C, y: C, a: &Matrix2<C>) -> Matrix2<C> {
    Matrix2::new(x * a.m11, x * a.m12, y * a.m21, y * a.m22)
}

/// A diag(x, y).
fn columns(a: &Matrix2<C>, x: C, y: C) -> Matrix2<C> {
    Matrix2::new(a.m11 * x, a.m12 * y, a.m21 * x, a.m22 * y)
}

/// θ̂ and ω̂ for the measured angle.
pub(super) struct Estimate {
    angle: C,
    velocity: C,
}

impl Estimate {
    /// (1 − O/z)⁻¹ o, with o the response to the measured angle.
    pub(super) fn new(law: &Law, z: C) -> Self {
        let o = law.observer.map(|x| C::new(x, 0.0) / z);
        let [x, y] = law.measured.into();
        let (p, q) = (1.0 - o[(0, 0)], 1.0 - o[(1, 1)]);
        let determinant = p * q - o[(0, 1)] * o[(1, 0)];
        Self {
            angle: (q * x + o[(0, 1)] * y) / determinant,
            velocity: (o[(1, 0)] * x + p * y) / determinant,
        }
    }
}
