//! The accuracy of the slider-driven mechanism at one position of P, and its JSON.

use super::error::AccuracyStudyError;
use fivebar_design::accuracy::slider::{self, SliderAnalysis, SliderMonteCarlo};
use fivebar_files::robot::SliderRobot;
use nalgebra::Vector2;
use serde_json::{Value, json};

/// Analyses the mechanism with P at `at` [m] and a force on P [N].
///
/// # Errors
/// `Place` with the reason why P cannot be there.
pub fn analyse_slider(
    robot: &SliderRobot,
    at: Vector2<f64>,
    force: Vector2<f64>,
) -> Result<SliderAnalysis, AccuracyStudyError> {
    slider::analyse_slider(&robot.toleranced(), at, force).map_err(|reason| {
        AccuracyStudyError::Place {
            place: at.into(),
            reason,
        }
    })
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
        .zip(analysis.displacements())
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
