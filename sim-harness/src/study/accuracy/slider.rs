//! The accuracy of the slider-driven mechanism at one position of P, by its transfer
//! coefficients (Tu 2005, corrected) and by sampling.

use super::error::{AccuracyStudyError, PlaceError};
use super::sampling::{Moments, Sampling, sample};
use crate::input::robot::SliderRobot;
use fivebar_design::accuracy::five_bar::ClearanceError;
use fivebar_design::accuracy::slider::{
    ClearanceEquilibrium, clearance_equilibrium, clearance_error, worst_input_error,
};
use fivebar_design::accuracy::{Primitive, Scatter};
use fivebar_design::linkage::dyad::Rrr;
use fivebar_design::slider::{ErrorTransfer, Geometry, Pose};
use fivebar_kinematics::PlanarVector;
use fivebar_plant::Noise;
use indicatif::ProgressBar;
use nalgebra::DMatrix;
use nalgebra::Vector2;
use serde_json::{Value, json};
use std::f64::consts::TAU;

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

/// Analyses the mechanism with P at `at` [m] and a force on P [N].
///
/// # Errors
/// `Place` with the reason why P cannot be there.
pub fn analyse_slider(
    robot: &SliderRobot,
    at: Vector2<f64>,
    force: Vector2<f64>,
) -> Result<SliderAnalysis, AccuracyStudyError> {
    analyse_at(robot, at, force).map_err(|reason| AccuracyStudyError::Place {
        place: at.into(),
        reason,
    })
}

fn analyse_at(
    robot: &SliderRobot,
    at: Vector2<f64>,
    force: Vector2<f64>,
) -> Result<SliderAnalysis, PlaceError> {
    let geometry = &robot.geometry;
    let tolerance = &robot.tolerance;
    let pose = geometry.inverse(at, robot.working_mode)?;
    if robot.travel.is_some_and(|travel| !travel.contains(&pose)) {
        let (x2, x8) = (pose.x2, pose.x8);
        return Err(PlaceError::BeyondTravel { x2, x8 });
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
    let t = DMatrix::from_fn(2, 5, |row, column| {
        [columns[column].x, columns[column].y][row]
    });
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
    robot: &SliderRobot,
    analysis: &SliderAnalysis,
    sampling: Sampling,
    progress: &ProgressBar,
) -> SliderMonteCarlo {
    let ideal = &analysis.pose;
    let position = sample(sampling, progress, |noise: &mut Noise| {
        let made: Vec<f64> = analysis
            .primitives
            .iter()
            .map(|primitive| primitive.mean + primitive.deviation * noise.normal())
            .collect();
        let &[x2, x8, l3, l7, l5] = made.as_slice() else {
            return None;
        };
        let geometry = Geometry::new(l3, l7, l5).ok()?;
        let p = geometry.forward(x2, x8, ideal.assembly()).ok()?.p;
        Some([p.x - ideal.p.x, p.y - ideal.p.y])
    });
    let tolerance = &robot.tolerance;
    let geometry = &robot.geometry;
    let limbs = Rrr {
        lengths: [geometry.l3(), geometry.l7()],
        side: ideal.assembly(),
    };
    let distance = sample(sampling, progress, |noise: &mut Noise| {
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

/// One JSON object; the units are in the keys. The Monte Carlo figures have the same keys.
pub fn slider_answer(
    robot: &SliderRobot,
    analysis: &SliderAnalysis,
    sampled: &SliderMonteCarlo,
) -> Value {
    let covariance = &analysis.position.covariance;
    let deviations = analysis.position.deviations();
    let twin = &sampled.position;
    let rows = |entry: &dyn Fn(usize, usize) -> f64| {
        json!([[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]])
    };
    let pair = |v: Vector2<f64>| json!([v.x, v.y]);
    let contributors: Vec<Value> = analysis
        .shares()
        .into_iter()
        .zip(&analysis.primitives)
        .map(|((name, share), primitive)| {
            json!({"name": name, "sd": primitive.deviation, "share": share})
        })
        .collect();
    let transfer: Value = analysis
        .primitives
        .iter()
        .zip(columns(&analysis.transfer))
        .map(|(primitive, by)| (primitive.name.clone(), pair(by)))
        .collect();
    json!({
        "robot": robot.name,
        "at_m": pair(analysis.pose.p),
        "transfer": transfer,
        "position_sd_m": [deviations[0], deviations[1]],
        "position_covariance": rows(&|i, j| covariance[(i, j)]),
        "input_worst_m": analysis.input_worst,
        "clearance_worst_m": analysis.clearance.worst,
        "clearance_worst_linear_m": analysis.clearance.worst_linear,
        "clearance_rms_m": analysis.clearance.rms,
        "clearance_seated_m": pair(analysis.equilibrium.displacement),
        "clearance_seated_settled": analysis.equilibrium.converged,
        "limb_tension_n": analysis.equilibrium.tension,
        "contributors": contributors,
        "monte_carlo": {
            "samples": sampled.sampling.samples,
            "seed": sampled.sampling.seed,
            "failed": twin.failed,
            "relative_error_of_sd": twin.relative_error(),
            "position_sd_m": [twin.deviation(0), twin.deviation(1)],
            "position_covariance": rows(&|i, j| twin.covariance(i, j)),
            "input_worst_m": sampled.distance.largest[0],
            "clearance_worst_m": sampled.distance.largest[1],
            "clearance_rms_m": sampled.distance.rms(1),
        },
    })
}
