//! The slider-driven mechanism's errors: how far sliders and clearances take P at worst, and
//! where its pins are pressed (Tu 2005). Its transfer coefficients are
//! [`Geometry::error_transfer`].
//!
//! A limb counts as one bar with a pin at its slider and one at the platform. A massless limb
//! bears a force along itself alone: T3 u3 + T7 u7 = F for a force F on P, T > 0 in tension;
//! tension lengthens it by the sum of its clearances, compression shortens it. That the
//! platform only translates takes both links of a parallelogram to be pressed alike.

use super::five_bar::ClearanceError;
use crate::slider::{Geometry, Pose, PoseError};
use fivebar_kinematics::PlanarVector;
use nalgebra::Vector2;

/// The farthest that errors of the sliders of up to ± `greatest` [m] take P [m]: exactly, at a
/// corner of their square.
///
/// # Errors
/// Where a corner cannot be assembled.
pub fn worst_input_error(
    geometry: &Geometry<f64>,
    pose: &Pose<f64>,
    [left, right]: [f64; 2],
) -> Result<f64, PoseError> {
    let mut worst = 0.0_f64;
    for (sign2, sign8) in CORNERS {
        let (x2, x8) = (pose.x2 + sign2 * left, pose.x8 + sign8 * right);
        let displaced = geometry.forward(x2, x8, pose.assembly())?;
        worst = worst.max((displaced.p - pose.p).length());
    }
    Ok(worst)
}

const CORNERS: [(f64, f64); 4] = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];

/// P's error for clearances of these radii at each limb's slider and platform, left limb
/// first [m].
///
/// # Errors
/// `Parallel` at type 2, or where the worst case cannot be assembled.
pub fn clearance_error(
    geometry: &Geometry<f64>,
    pose: &Pose<f64>,
    radii: [f64; 4],
) -> Result<ClearanceError, PoseError> {
    let by = geometry.error_transfer(pose)?;
    let [left, right] = sums(radii);
    let mut worst_linear = 0.0_f64;
    let mut worst = 0.0_f64;
    for (sign3, sign7) in CORNERS {
        let longer = [sign3 * left, sign7 * right];
        worst_linear = worst_linear.max((by.l3 * longer[0] + by.l7 * longer[1]).length());
        let displaced = lengthened(geometry, pose, longer)?;
        worst = worst.max((displaced.p - pose.p).length());
    }
    // A pin's offset c lengthens its limb by u·c; ⟨(r cos a)²⟩ = r²/2.
    let [a, b, c, d] = radii.map(|r| r * r / 2.0);
    let rms = (by.l3.length_squared() * (a + b) + by.l7.length_squared() * (c + d)).sqrt();
    Ok(ClearanceError {
        worst_linear,
        worst,
        rms,
    })
}

/// The mechanism with every pin pressed to one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearanceEquilibrium {
    /// T3 and T7, the tension in each limb [N].
    pub tension: [f64; 2],
    /// How much longer each limb is [m].
    pub longer: [f64; 2],
    /// Where P goes from its ideal place [m].
    pub displacement: Vector2<f64>,
    /// Whether the sides settled; if not, some joint is about to lose contact.
    pub converged: bool,
}

/// Seats the pins of a massless mechanism under a force on P [N], its sliders held.
///
/// # Errors
/// `Parallel` at type 2, or where the lengthened limbs cannot meet.
pub fn clearance_equilibrium(
    geometry: &Geometry<f64>,
    pose: &Pose<f64>,
    force: Vector2<f64>,
    radii: [f64; 4],
) -> Result<ClearanceEquilibrium, PoseError> {
    // Two limbs with two sides each: a fifth round would repeat one.
    const MAX_ITERATIONS: usize = 5;
    let mut seated = *pose;
    let mut equilibrium = ClearanceEquilibrium {
        tension: [0.0; 2],
        longer: [0.0; 2],
        displacement: Vector2::zeros(),
        converged: false,
    };
    for _ in 0..MAX_ITERATIONS {
        let s = seated.sin73();
        let tension = [force.cross_z(seated.u7) / s, seated.u3.cross_z(force) / s];
        let [left, right] = sums(radii);
        let longer = [side(tension[0]) * left, side(tension[1]) * right];
        equilibrium.converged = longer == equilibrium.longer;
        equilibrium.tension = tension;
        equilibrium.longer = longer;
        seated = lengthened(geometry, pose, longer)?;
        equilibrium.displacement = seated.p - pose.p;
        if equilibrium.converged {
            break;
        }
    }
    Ok(equilibrium)
}

/// Which way a force presses; nothing presses where there is none.
fn side(tension: f64) -> f64 {
    if tension == 0.0 {
        0.0
    } else {
        tension.signum()
    }
}

/// Each limb's two clearances together.
fn sums([a, b, c, d]: [f64; 4]) -> [f64; 2] {
    [a + b, c + d]
}

fn lengthened(
    geometry: &Geometry<f64>,
    pose: &Pose<f64>,
    [left, right]: [f64; 2],
) -> Result<Pose<f64>, PoseError> {
    let longer = Geometry::new(geometry.l3() + left, geometry.l7() + right, geometry.l5());
    // No clearance is as large as a limb.
    let longer = longer.map_err(|_| PoseError::NotFinite)?;
    longer.forward(pose.x2, pose.x8, pose.assembly())
}
