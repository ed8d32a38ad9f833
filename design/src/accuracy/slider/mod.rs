//! The errors of the slider-driven mechanism: the worst displacement of P by sliders and
//! clearances, and its clearance equilibrium (Tu 2005). The transfer coefficients are
//! [`Geometry::error_transfer`].
//!
//! A limb counts as one bar with a pin at its slider and one at the platform. A massless limb
//! transmits a force only along itself: T3 u3 + T7 u7 = F for a force F on P, T > 0 in
//! tension; tension lengthens it by the sum of its clearances, compression shortens it. The
//! platform only translates if both links of a parallelogram are pressed alike, which is
//! assumed.

mod analysis;

pub use analysis::{
    SliderAnalysis, SliderMonteCarlo, SliderTolerance, TolerancedSlider, analyse_slider,
    sample_slider,
};

use super::five_bar::ClearanceError;
use crate::accuracy::corners::CORNERS;
use crate::slider::{Geometry, Pose, PoseError};
use fivebar_kinematics::PlanarVector;
use nalgebra::Vector2;

/// The greatest displacement of P [m] by errors of the left and right slider of up to the
/// given values [m]. It is exact, and occurs at a corner of the rectangle of errors.
///
/// # Errors
/// Where the mechanism cannot be assembled at a corner.
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

/// The error of P for clearances of these radii at each limb's slider and platform, left limb
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

/// The mechanism with its pins in clearance equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearanceEquilibrium {
    /// T3 and T7, the tension in each limb [N].
    pub tension: [f64; 2],
    /// The increase of each limb's length [m].
    pub longer: [f64; 2],
    /// The displacement of P from its ideal position [m].
    pub displacement: Vector2<f64>,
    /// Whether the iteration converged; otherwise a joint is about to lose contact.
    pub converged: bool,
}

/// The clearance equilibrium of a massless mechanism under a force on P [N], with its sliders
/// held; `radii` [m] as for [`clearance_error`].
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

/// +1 in tension, −1 in compression, 0 without a force.
fn side(tension: f64) -> f64 {
    if tension == 0.0 {
        0.0
    } else {
        tension.signum()
    }
}

/// The sum of each limb's two clearances.
fn sums([a, b, c, d]: [f64; 4]) -> [f64; 2] {
    [a + b, c + d]
}

fn lengthened(
    geometry: &Geometry<f64>,
    pose: &Pose<f64>,
    [left, right]: [f64; 2],
) -> Result<Pose<f64>, PoseError> {
    let longer = Geometry::new(geometry.l3() + left, geometry.l7() + right, geometry.l5());
    // Refused only if a clearance exceeds its limb.
    let longer = longer.map_err(|_| PoseError::NotFinite)?;
    longer.forward(pose.x2, pose.x8, pose.assembly())
}
