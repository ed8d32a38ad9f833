//! Forces in a dyad: the six equations of equilibrium of its two links.
//!
//! The inertia forces are part of the loads (d'Alembert), so the same equations hold at rest
//! and in motion (kineto-statics).

use super::dyad::{DyadError, Singular};
use super::joint::Joint;
use super::wrench::Wrench;
use fivebar_kinematics::Scalar;

/// The wrenches in a dyad's joints, given the `loads` on its two links: on link 1 from
/// its carrier, on link 2 from link 1, on link 2 from its carrier.
///
/// R1 − R12 = −load1, R12 + R2 = −load2, where each R is a sum of the two wrenches that its
/// joint can transmit: six unknowns, by elimination with row pivoting.
///
/// # Errors
/// `Singular` where the loads do not determine the reactions. This does not occur for the
/// joints of a [`DyadMotion`], because statics and velocities have the same determinant.
///
/// [`DyadMotion`]: super::dyad::DyadMotion
pub fn reactions<S: Scalar>(
    joints: &[Joint<S>; 3],
    loads: &[Wrench<S>; 2],
) -> Result<[Wrench<S>; 3], DyadError> {
    let [r1, r12, r2] = [joints[0].basis(), joints[1].basis(), joints[2].basis()];
    let zero = Wrench::zero();
    let columns = [
        [r1[0], zero],
        [r1[1], zero],
        [-r12[0], r12[0]],
        [-r12[1], r12[1]],
        [zero, r2[0]],
        [zero, r2[1]],
        [-loads[0], -loads[1]],
    ];
    // Moments are about the inner joint, so that the rows have similar size far from the
    // origin too.
    let centre = joints[1].position();
    let mut rows = [[S::ZERO; 7]; 6];
    for (j, [on1, on2]) in columns.iter().enumerate() {
        for (i, wrench) in [on1, on2].into_iter().enumerate() {
            rows[3 * i][j] = wrench.force.x;
            rows[3 * i + 1][j] = wrench.force.y;
            rows[3 * i + 2][j] = wrench.moment_about(centre);
        }
    }
    let x = eliminate(rows)?;
    let sum = |basis: [Wrench<S>; 2], i: usize| basis[0].scaled(x[i]) + basis[1].scaled(x[i + 1]);
    Ok([sum(r1, 0), sum(r12, 2), sum(r2, 4)])
}

/// Gaussian elimination of six equations, the right-hand side in the last column.
fn eliminate<S: Scalar>(mut rows: [[S; 7]; 6]) -> Result<[S; 6], DyadError> {
    for k in 0..6 {
        let mut pivot = k;
        for i in k + 1..6 {
            if rows[i][k].abs() > rows[pivot][k].abs() {
                pivot = i;
            }
        }
        rows.swap(k, pivot);
        let pivot_row = rows[k];
        if pivot_row[k] == S::ZERO {
            return Err(DyadError::Singular(Singular::Reactions));
        }
        for row in &mut rows[k + 1..] {
            let factor = row[k] / pivot_row[k];
            for (entry, &above) in row.iter_mut().zip(&pivot_row).skip(k) {
                *entry -= factor * above;
            }
        }
    }
    let mut x = [S::ZERO; 6];
    for k in (0..6).rev() {
        let mut rest = rows[k][6];
        for j in k + 1..6 {
            rest -= rows[k][j] * x[j];
        }
        x[k] = rest / rows[k][k];
    }
    Ok(x)
}
