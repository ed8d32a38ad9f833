//! How the arm yields to a load at its tip, and the frequencies of its belts.

use super::arm::Servo;
use super::law::ArmLaw;
use nalgebra::{Matrix2, SymmetricEigen};
use num_complex::Complex;
use std::f64::consts::{PI, TAU};

/// Frequencies at which the compliance is computed, besides those about the resonances.
const POINTS: usize = 100;

impl Servo {
    /// The greatest compliance of the tip over all frequencies and directions of a force, per its static one, with
    /// `jacobian` from the joints' rates to the tip's velocity.
    ///
    /// The static one is that of the belts and of the position loop in series, J (k⁻¹ + (M Kp)⁻¹) Jᵀ: without the
    /// integral, or the estimated load, which takes away what is slow.
    pub fn disturbance_peak(&self, law: &ArmLaw, jacobian: &Matrix2<f64>) -> f64 {
        let closed = self.closed(law);
        let to_tip = jacobian.map(|x| Complex::new(x, 0.0));
        let greatest = self
            .frequencies(POINTS)
            .into_iter()
            .filter(|&omega| omega < 0.5 * PI / self.period)
            .map(|omega| {
                let joints = closed.compliance(Complex::from_polar(1.0, omega * self.period));
                norm(&(to_tip * joints * to_tip.transpose()))
            })
            .fold(0.0, f64::max);
        let nan = Matrix2::from_element(f64::NAN);
        let held = self.mass_matrix * Matrix2::from_diagonal(&law.angle_gains.into());
        let belts = self.drives.map(|drive| 1.0 / drive.belt().stiffness);
        let springs = Matrix2::from_diagonal(&belts.into()) + held.try_inverse().unwrap_or(nan);
        let fixed = jacobian * springs * jacobian.transpose();
        greatest / norm(&fixed.map(|x| Complex::new(x, 0.0)))
    }

    /// The free frequencies of the arm on its belts [Hz], the lower one first; none for a rigid drive.
    ///
    /// The twists ε of the belts obey ε̈ = −(Jr⁻¹ + Ma⁻¹) k ε, with the rotor of a rigid drive in Ma.
    pub fn modes(&self) -> [Option<f64>; 2] {
        let elastic = self.drives.map(|drive| drive.is_elastic());
        let mut links = self.mass_matrix;
        for (j, drive) in self.drives.iter().enumerate() {
            links[(j, j)] -= if elastic[j] { drive.rotor_inertia } else { 0.0 };
        }
        let Some(inverse) = links.try_inverse() else {
            return [None; 2];
        };
        // Symmetric by √k on both sides; zero where nothing stretches.
        let root = [0, 1].map(|j| {
            let stiffness = self.drives[j].stiffness.filter(|_| elastic[j]);
            stiffness.unwrap_or(0.0).sqrt()
        });
        let squares = Matrix2::from_fn(|i, j| {
            let rotor = if i == j && elastic[j] {
                1.0 / self.drives[j].rotor_inertia
            } else {
                0.0
            };
            root[i] * (inverse[(i, j)] + rotor) * root[j]
        });
        let mut rates: Vec<f64> = SymmetricEigen::new(squares)
            .eigenvalues
            .iter()
            .filter(|&&square| square > 0.0)
            .map(|square| square.sqrt() / TAU)
            .collect();
        rates.sort_by(f64::total_cmp);
        [rates.first().copied(), rates.get(1).copied()]
    }
}

/// The greatest singular value.
fn norm(matrix: &Matrix2<Complex<f64>>) -> f64 {
    let square = matrix.adjoint() * matrix;
    let (trace, determinant) = (square.trace().re, square.determinant().re);
    let half = 0.5 * trace;
    (half + (half * half - determinant).max(0.0).sqrt()).sqrt()
}
