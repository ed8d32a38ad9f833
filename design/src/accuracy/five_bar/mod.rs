//! The errors of the five-bar: the sensitivity of C to inputs and lengths, and its worst
//! displacement by inputs and clearances.
//!
//! The closure (C−B)·(C−B) = l2², (C−D)·(C−D) = l3², differentiated:
//!
//! u2·δC = u2·δB + δl2, u3·δC = u3·δD + δl3,
//! δB = u1 δl1 + l1 n1 δθ1, δD = x̂ δl5 + u4 δl4 + l4 n4 δθ4.
//!
//! Positions are measured from the middle of the base, so that an error of the base's length
//! displaces both pivots alike: ½ x̂ δl5 is subtracted.
//!
//! Clearance: with a massless link of length up to r in every joint, C on link 2, the distance
//! of C from B is l2 ± (rA + rB) and from D l3 ± (rC + rD + rE). To first order u2·δC = p,
//! u3·δC = q with |p| ≤ rA + rB, |q| ≤ rC + rD + rE: a parallelogram, whose farthest point is
//! a vertex. The exact bound has arcs in place of its sides; each massless link then lies
//! along its distal link.

mod analysis;
mod map;
mod monte_carlo;

pub use analysis::{
    AccuracyAnalysis, ArmTolerance, ForceAnalysis, TolerancedArm, ToolState, analyse,
};
pub use map::{AccuracyCell, AccuracyMap, MapError, accuracy_map, cheapest_classes};
pub use monte_carlo::{MonteCarlo, draws, monte_carlo, sample_forces, sample_positions};

use super::AccuracyError;
use crate::accuracy::corners::CORNERS;
use crate::linkage::dyad::Rrr;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Geometry, Pose, PoseError, Singularity};
use nalgebra::Vector2;

/// The sensitivity of C to each input and length of the arm.
///
/// ```
/// use fivebar_design::accuracy::five_bar::tool_sensitivities;
/// use fivebar_kinematics::five_bar::{Geometry, Side};
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let pose = geometry.forward(2.0, 1.1, Side::Left)?; // rad
/// let sensitivities = tool_sensitivities(&geometry, &pose)?;
/// // An error of 1 µrad in θ1 displaces C by ∂C/∂θ1 · 1 µrad.
/// let displaced = geometry.forward(2.0 + 1e-6, 1.1, Side::Left)?;
/// let quotient = (displaced.c - pose.c) / 1e-6;
/// assert!((sensitivities.inputs[0] - quotient).norm() < 1e-5); // m/rad
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolSensitivities {
    /// ∂C/∂θ1 and ∂C/∂θ4 [m/rad].
    pub inputs: [Vector2<f64>; 2],
    /// ∂C/∂l1 … ∂C/∂l5 [m/m], C from the middle of the base.
    pub lengths: [Vector2<f64>; 5],
}

impl ToolSensitivities {
    /// Of an arm whose links have the directions u1…u4 and whose driven links have the lengths l1, l4 [m]; none at
    /// type 2.
    pub(crate) fn of_links(
        [u1, u2, u3, u4]: [Vector2<f64>; 4],
        [l1, l4]: [f64; 2],
    ) -> Option<Self> {
        let [by2, by3] = dual_basis(u2, u3)?;
        let base = Vector2::new(1.0, 0.0);
        let from_b = |delta_b: Vector2<f64>| by2 * u2.dot(&delta_b);
        let from_d = |delta_d: Vector2<f64>| by3 * u3.dot(&delta_d);
        Some(Self {
            inputs: [
                from_b(u1.perpendicular() * l1),
                from_d(u4.perpendicular() * l4),
            ],
            lengths: [from_b(u1), by2, by3, from_d(u4), from_d(base) - base * 0.5],
        })
    }

    /// √(σx² + σy²) of C [m] for standard deviations of the inputs [rad] and of the lengths [m].
    pub fn radial_deviation(&self, inputs: [f64; 2], lengths: [f64; 5]) -> f64 {
        let inputs = self.inputs.iter().zip(inputs);
        let all = inputs.chain(self.lengths.iter().zip(lengths));
        all.map(|(by, deviation)| (by * deviation).norm_squared())
            .sum::<f64>()
            .sqrt()
    }
}

/// The dual basis of (u2, u3): δC = p·across2 + q·across3 for u2·δC = p, u3·δC = q; none at type 2.
fn dual_basis(u2: Vector2<f64>, u3: Vector2<f64>) -> Option<[Vector2<f64>; 2]> {
    let sine = u2.cross_z(u3);
    (sine.abs() >= 1e-9).then(|| {
        [
            -u3.perpendicular() * (1.0 / sine),
            u2.perpendicular() * (1.0 / sine),
        ]
    })
}

/// The arm is singular of type 2.
const PARALLEL: AccuracyError = AccuracyError::Pose(PoseError::Singular(Singularity::Parallel));

/// The sensitivity of C to inputs and lengths at a pose.
///
/// # Errors
/// `Pose(Singular)` at type 2.
pub fn tool_sensitivities(
    geometry: &Geometry<f64>,
    pose: &Pose<f64>,
) -> Result<ToolSensitivities, AccuracyError> {
    let directions = [pose.u1, pose.u2, pose.u3, pose.u4];
    ToolSensitivities::of_links(directions, [geometry.l1(), geometry.l4()]).ok_or(PARALLEL)
}

/// The greatest displacement of C [m] by errors of θ1 and θ4 of up to ± `greatest` [rad]. It
/// is exact, and occurs at a corner of the rectangle of errors.
///
/// # Errors
/// Where the arm cannot be assembled at a corner.
pub fn worst_input_error(
    geometry: &Geometry<f64>,
    pose: &Pose<f64>,
    greatest: [f64; 2],
) -> Result<f64, AccuracyError> {
    let [theta1, _, _, theta4] = pose.angles();
    let assembly = pose.assembly();
    let mut worst = 0.0_f64;
    for (sign1, sign4) in CORNERS {
        let displaced = geometry.forward(
            theta1 + sign1 * greatest[0],
            theta4 + sign4 * greatest[1],
            assembly,
        )?;
        worst = worst.max((displaced.c - pose.c).norm());
    }
    Ok(worst)
}

/// The displacement of C by joint clearances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearanceError {
    /// The worst case to first order [m].
    pub worst_linear: f64,
    /// The worst case of the exact geometry [m].
    pub worst: f64,
    /// Root mean square for uniformly random directions, to first order [m].
    pub rms: f64,
}

/// The displacement of C by clearances of these radii in the joints A, B, C, D, E [m].
///
/// # Errors
/// `Pose` at type 2, or where the worst case cannot be assembled.
pub fn clearance_error(
    geometry: &Geometry<f64>,
    pose: &Pose<f64>,
    radii: [f64; 5],
) -> Result<ClearanceError, AccuracyError> {
    let [by2, by3] = dual_basis(pose.u2, pose.u3).ok_or(PARALLEL)?;
    let [a, b, c, d, e] = radii;
    let (left, right) = (a + b, c + d + e);
    let mut worst_linear = 0.0_f64;
    let mut worst = 0.0_f64;
    for (sign2, sign3) in CORNERS {
        let (p, q) = (sign2 * left, sign3 * right);
        worst_linear = worst_linear.max((by2 * p + by3 * q).norm());
        let displaced = distal_dyad(geometry, pose, [p, q]).position(pose.b, pose.d)?;
        worst = worst.max((displaced - pose.c).norm());
    }
    // ⟨(r cos a)²⟩ = r²/2 for a direction a that is uniform.
    let square = |radii: &[f64]| radii.iter().map(|r| r * r / 2.0).sum::<f64>();
    let rms =
        (by2.norm_squared() * square(&[a, b]) + by3.norm_squared() * square(&[c, d, e])).sqrt();
    Ok(ClearanceError {
        worst_linear,
        worst,
        rms,
    })
}

/// The exact position of C [m] when each joint's pin has the given offset [m] from the centre
/// of its bearing and the driven links are held.
///
/// # Errors
/// `Pose` where links 2 and 3 cannot meet.
pub fn tool_with_pin_offsets(
    geometry: &Geometry<f64>,
    pose: &Pose<f64>,
    offsets: [Vector2<f64>; 5],
) -> Result<Vector2<f64>, AccuracyError> {
    let [a, b, c, d, e] = offsets;
    let dyad = distal_dyad(geometry, pose, [0.0; 2]);
    Ok(dyad.position(pose.b + a + b, pose.d + c + d + e)?)
}

/// Links 2 and 3, longer by `longer` [m].
fn distal_dyad(geometry: &Geometry<f64>, pose: &Pose<f64>, longer: [f64; 2]) -> Rrr<f64> {
    Rrr {
        lengths: [geometry.l2() + longer[0], geometry.l3() + longer[1]],
        side: pose.assembly(),
    }
}
