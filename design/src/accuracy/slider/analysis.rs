//! The accuracy of the slider-driven mechanism at one position of P, by its transfer
//! coefficients (Tu 2005, corrected) and by sampling.

use super::{
    ClearanceEquilibrium, ClearanceError, clearance_equilibrium, clearance_error, worst_input_error,
};
use crate::accuracy::sampling::{Moments, Progress, Sampling, sample};
use crate::accuracy::{AnalysisError, Primitive, Scatter};
use crate::linkage::dyad::Rrr;
use crate::slider::{ErrorTransfer, Geometry, Pose, Travel, WorkingMode};
use core::f64::consts::TAU;
use fivebar_kinematics::PlanarVector;
use nalgebra::{DMatrix, Vector2};

/// The tolerances of a slider-driven mechanism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliderTolerance {
    /// Standard deviation of l3, l7 and l5 [m].
    pub length_sd: [f64; 3],
    /// Standard deviation of x2 and x8 [m].
    pub input_sd: [f64; 2],
    /// Greatest error of x2 and x8 [m].
    pub input_max: [f64; 2],
    /// Radial clearance of each limb at its slider and at the platform, left limb first [m].
    pub clearance_radius: [f64; 4],
}

/// A slider-driven mechanism with its tolerances, in one working mode.
#[derive(Clone, Copy, Debug)]
pub struct TolerancedSlider<'a> {
    /// Its nominal lengths.
    pub geometry: &'a Geometry<f64>,
    /// The side of the platform on which each slider is.
    pub working_mode: WorkingMode,
    /// Least and greatest position of the sliders; none: unlimited.
    pub travel: Option<Travel<f64>>,
    /// Its tolerances.
    pub tolerance: &'a SliderTolerance,
}

/// The effect of tolerances and clearances on P.
#[derive(Clone, Debug)]
pub struct SliderAnalysis {
    /// The pose.
    pub pose: Pose<f64>,
    /// x2, x8, l3, l7 and l5 with their scatter.
    pub primitives: Vec<Primitive>,
    /// Displacement of P per error of each of them.
    pub transfer: ErrorTransfer<f64>,
    /// The scatter of P [m²].
    pub position: Scatter,
    /// Greatest displacement of P by errors of the sliders [m].
    pub input_worst: f64,
    /// Displacement of P by clearances.
    pub clearance: ClearanceError,
    /// The pins as the force on P presses them, links without mass.
    pub equilibrium: ClearanceEquilibrium,
}

/// The sampled figures of a [`SliderAnalysis`].
#[derive(Clone, Debug)]
pub struct SliderMonteCarlo {
    /// Number and seed of the samples.
    pub sampling: Sampling,
    /// Displacement of P by errors of sliders and lengths [m].
    pub position: Moments<2>,
    /// Distance of P from its ideal position with uniform errors of the sliders, and with pins
    /// on the rims of their bearings in random directions [m].
    pub distance: Moments<2>,
}

impl SliderAnalysis {
    /// Displacement of P per error of each primitive, in their order.
    pub fn displacements(&self) -> [Vector2<f64>; 5] {
        columns(&self.transfer)
    }

    /// The share of each primitive in the variance of P.
    pub fn shares(&self) -> Vec<(&str, f64)> {
        let parts = self.position.contributions.row_sum();
        let total = parts.sum();
        let share = |part: f64| if total > 0.0 { part / total } else { 0.0 };
        let primitives = self.primitives.iter().zip(parts.iter());
        primitives
            .map(|(primitive, part)| (primitive.name.as_str(), share(*part)))
            .collect()
    }
}

/// Analyses a mechanism with P at `at` [m] and a force on P [N].
///
/// # Errors
/// The reason why P cannot be there.
pub fn analyse_slider(
    mechanism: &TolerancedSlider<'_>,
    at: Vector2<f64>,
    force: Vector2<f64>,
) -> Result<SliderAnalysis, AnalysisError> {
    let TolerancedSlider {
        geometry,
        tolerance,
        ..
    } = *mechanism;
    let pose = geometry.inverse(at, mechanism.working_mode)?;
    if mechanism
        .travel
        .is_some_and(|travel| !travel.contains(&pose))
    {
        let (x2, x8) = (pose.x2, pose.x8);
        return Err(AnalysisError::BeyondTravel { x2, x8 });
    }
    let transfer = geometry.error_transfer(&pose)?;
    let means = [
        pose.x2,
        pose.x8,
        geometry.l3(),
        geometry.l7(),
        geometry.l5(),
    ];
    let deviations = tolerance.input_sd.into_iter().chain(tolerance.length_sd);
    let names = ["x2", "x8", "l3", "l7", "l5"].into_iter().zip(means);
    let primitives: Vec<Primitive> = names
        .zip(deviations)
        .map(|((name, mean), deviation)| Primitive {
            name: name.into(),
            mean,
            deviation,
        })
        .collect();
    let columns = columns(&transfer);
    let t = DMatrix::from_fn(2, 5, |row, column| columns[column][row]);
    let radii = tolerance.clearance_radius;
    Ok(SliderAnalysis {
        position: Scatter::propagate(&t, &primitives),
        input_worst: worst_input_error(geometry, &pose, tolerance.input_max)?,
        clearance: clearance_error(geometry, &pose, radii)?,
        equilibrium: clearance_equilibrium(geometry, &pose, force, radii)?,
        transfer,
        primitives,
        pose,
    })
}

/// The displacements per error, in the order of the primitives.
fn columns(by: &ErrorTransfer<f64>) -> [Vector2<f64>; 5] {
    [by.x2, by.x8, by.l3, by.l7, by.l5]
}

/// Samples the same figures with random errors of the mechanism.
pub fn sample_slider(
    mechanism: &TolerancedSlider<'_>,
    analysis: &SliderAnalysis,
    sampling: Sampling,
    progress: Progress<'_>,
) -> SliderMonteCarlo {
    let ideal = &analysis.pose;
    let position = sample(sampling, progress, |noise| {
        let [x2, x8, l3, l7, l5] = core::array::from_fn(|i| {
            let primitive = &analysis.primitives[i];
            primitive.mean + primitive.deviation * noise.normal()
        });
        let geometry = Geometry::new(l3, l7, l5).ok()?;
        let p = geometry.forward(x2, x8, ideal.assembly()).ok()?.p;
        Some([p.x - ideal.p.x, p.y - ideal.p.y])
    });
    let TolerancedSlider {
        geometry,
        tolerance,
        ..
    } = *mechanism;
    let limbs = Rrr {
        lengths: [geometry.l3(), geometry.l7()],
        side: ideal.assembly(),
    };
    let distance = sample(sampling, progress, |noise| {
        let mut within = |greatest: f64| greatest * (2.0 * noise.uniform() - 1.0);
        let [max2, max8] = tolerance.input_max;
        let (x2, x8) = (ideal.x2 + within(max2), ideal.x8 + within(max8));
        let moved = geometry.forward(x2, x8, ideal.assembly()).ok()?.p;
        let rims = tolerance.clearance_radius;
        let [a, b, c, d] = rims.map(|radius| Vector2::unit(TAU * noise.uniform()) * radius);
        // The limbs' lower ends, shifted so that the platform's two ends coincide.
        let left = ideal.p - ideal.u3 * geometry.l3();
        let right = ideal.p - ideal.u7 * geometry.l7();
        let loose = limbs.position(left + a + b, right + c + d).ok()?;
        Some([(moved - ideal.p).norm(), (loose - ideal.p).norm()])
    });
    SliderMonteCarlo {
        sampling,
        position,
        distance,
    }
}
