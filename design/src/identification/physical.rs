//! Masses of parts with the torques of given base parameters.
//!
//! Many sets of masses have the same base parameters. Each link is written in the planar
//! log-Cholesky form (a, b, cx, cy): m = e^{2a}, centre of mass c, moment of inertia about it
//! e^{2b}. Whatever these numbers are, the link is physical. Levenberg–Marquardt makes the
//! base parameters equal, with a weak pull to the drawing that chooses one of the sets.

use super::arm_masses::{base_parameters, standard_parameters};
use super::least_squares::scales;
use crate::fit::{Loss, Rows, minimise};
use fivebar_kinematics::dynamics::{Arm, Link};
use nalgebra::{DMatrix, DVector, Vector2};

/// The weight of the pull, relative to base parameters in units of 1e-3 kg·m² and 1e-2 kg·m.
const PULL: f64 = 1e-4;

/// Links with given base parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhysicalLinks {
    /// Links 1 to 4; payload and rotors are the drawing's.
    pub links: [Link<f64>; 4],
    /// The greatest difference of their base parameters from the given ones, in units of 1e-3
    /// kg·m² and 1e-2 kg·m; not small if the given ones are those of no real arm.
    pub difference: f64,
}

/// Physical links near the drawn arm's with these base parameters, 7 or 11; none if the drawing
/// has a link without mass or inertia.
pub fn physical_links(drawn: &Arm<f64>, base: &[f64]) -> Option<PhysicalLinks> {
    let scales = scales(base.len());
    let count = base.len();
    let start = DVector::from_iterator(
        16,
        drawn.links().iter().flat_map(|link| {
            [
                0.5 * link.mass.ln(),
                0.5 * link.inertia.ln(),
                link.com.x,
                link.com.y,
            ]
        }),
    );
    if !start.iter().all(|value| value.is_finite()) {
        return None;
    }
    let differences = |x: &DVector<f64>| -> Option<DVector<f64>> {
        let arm = Arm::new(
            *drawn.geometry(),
            links(x),
            drawn.payload(),
            drawn.gravity(),
            drawn.rotor_inertia(),
        );
        let standard = standard_parameters(&arm.ok()?);
        let own = base_parameters(drawn.geometry().lengths(), &standard);
        Some(DVector::from_fn(count, |i, _| {
            (own[i] - base[i]) / scales[i]
        }))
    };
    // A change of the mass by a factor e, of a centre by 0.1 m.
    let unit = |index: usize| if index % 4 < 2 { 1.0 } else { 0.1 };
    let rows = |x: &DVector<f64>| -> Option<Rows> {
        let mut residuals = DVector::zeros(count + 16);
        let mut jacobian = DMatrix::zeros(count + 16, 16);
        residuals.rows_mut(0, count).copy_from(&differences(x)?);
        for index in 0..16 {
            let step = 1e-5 * unit(index);
            let at = |step: f64| {
                let mut moved = x.clone();
                moved[index] += step;
                differences(&moved)
            };
            let slope = (at(step)? - at(-step)?) / (2.0 * step);
            jacobian.view_mut((0, index), (count, 1)).copy_from(&slope);
            residuals[count + index] = PULL * (x[index] - start[index]) / unit(index);
            jacobian[(count + index, index)] = PULL / unit(index);
        }
        Some((residuals, jacobian))
    };
    let (x, _) = minimise(&start, &rows, Loss::Squares)?;
    Some(PhysicalLinks {
        links: links(&x),
        difference: differences(&x)?.amax(),
    })
}

fn links(x: &DVector<f64>) -> [Link<f64>; 4] {
    [0, 1, 2, 3].map(|link: usize| Link {
        mass: (2.0 * x[4 * link]).exp(),
        inertia: (2.0 * x[4 * link + 1]).exp(),
        com: Vector2::new(x[4 * link + 2], x[4 * link + 3]),
    })
}
