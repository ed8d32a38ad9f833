//! The analysis as JSON; the Monte Carlo figures have the same keys as the analytic ones.

use super::five_bar::Cheapest;
use super::path::PathAccuracy;
use fivebar_design::accuracy::Moments;
use fivebar_design::accuracy::five_bar::{AccuracyAnalysis, AccuracyMap, MonteCarlo, ToolState};
use serde_json::{Value, json};

pub(crate) const JOINTS: [&str; 5] = ["a", "b", "c", "d", "e"];

/// One JSON object; the units are in the keys: m, N·m (`nm`), N.
pub fn answer(
    robot: &str,
    state: &ToolState,
    analysis: &AccuracyAnalysis,
    sampled: &MonteCarlo,
) -> Value {
    let deviations = analysis.position.deviations();
    let covariance = &analysis.position.covariance;
    let shares = [analysis.position.shares(0), analysis.position.shares(1)];
    let total: f64 = covariance.trace();
    let contributors: Vec<Value> = analysis
        .primitives
        .iter()
        .enumerate()
        .map(|(i, primitive)| {
            let parts = analysis.position.contributions.column(i);
            json!({
                "name": primitive.name,
                "sd": primitive.deviation,
                "share": if total > 0.0 { parts.sum() / total } else { 0.0 },
                "share_x": shares[0][i],
                "share_y": shares[1][i],
            })
        })
        .collect();
    let forces = analysis.forces.as_ref();
    let force_deviations = forces.map(|forces| forces.scatter.deviations());
    let equilibrium = forces.map(|forces| &forces.equilibrium);
    let motion = forces.map(|forces| forces.motion.deviations());
    json!({
        "robot": robot,
        "at_m": [state.position.x, state.position.y],
        "position_sd_m": [deviations[0], deviations[1]],
        "position_covariance": rows(|i, j| covariance[(i, j)]),
        "input_worst_m": analysis.input_worst,
        "clearance_worst_m": analysis.clearance.worst,
        "clearance_worst_linear_m": analysis.clearance.worst_linear,
        "clearance_rms_m": analysis.clearance.rms,
        "clearance_seated_m": equilibrium.map(|s| [s.displacement.x, s.displacement.y]),
        "clearance_seated_settled": equilibrium.map(|s| s.converged),
        "velocity_sd_m_s": motion.as_ref().map(|sd| [sd[0], sd[1]]),
        "acceleration_sd_m_s2": motion.as_ref().map(|sd| [sd[2], sd[3]]),
        "torque_sd_nm": force_deviations.as_ref().map(|sd| [sd[0], sd[1]]),
        "reaction_sd_n": force_deviations.as_ref().map(|sd| joints(|i| sd[i])),
        "contributors": contributors,
        "monte_carlo": twins(analysis, sampled),
    })
}

fn twins(analysis: &AccuracyAnalysis, sampled: &MonteCarlo) -> Value {
    let position = &sampled.position;
    let variance = |m: &Moments<2>| m.covariance(0, 0) + m.covariance(1, 1);
    let total: f64 = sampled.alone.iter().map(variance).sum();
    let share = |part: f64, total: f64| if total > 0.0 { part / total } else { 0.0 };
    let axis_total = |i| {
        sampled
            .alone
            .iter()
            .map(|m| m.covariance(i, i))
            .sum::<f64>()
    };
    let contributors: Vec<Value> = analysis
        .primitives
        .iter()
        .zip(&sampled.alone)
        .map(|(primitive, alone)| {
            json!({
                "name": primitive.name,
                "sd": primitive.deviation,
                "share": share(variance(alone), total),
                "share_x": share(alone.covariance(0, 0), axis_total(0)),
                "share_y": share(alone.covariance(1, 1), axis_total(1)),
            })
        })
        .collect();
    let forces = sampled.forces.as_ref();
    let motion = sampled.motion.as_ref();
    json!({
        "samples": sampled.sampling.samples,
        "seed": sampled.sampling.seed,
        "failed": position.failed,
        "relative_error_of_sd": position.relative_error(),
        "position_sd_m": [position.deviation(0), position.deviation(1)],
        "position_covariance": rows(|i, j| position.covariance(i, j)),
        "position_mean_shift_m": position.mean,
        "input_worst_m": sampled.input.largest[0],
        "clearance_worst_m": sampled.clearance.largest[0],
        "clearance_worst_linear_m": sampled.clearance.largest[1],
        "clearance_rms_m": sampled.clearance.rms(0),
        "velocity_sd_m_s": motion.map(|m| [m.deviation(0), m.deviation(1)]),
        "acceleration_sd_m_s2": motion.map(|m| [m.deviation(2), m.deviation(3)]),
        "torque_sd_nm": forces.map(|m| [m.deviation(0), m.deviation(1)]),
        "reaction_sd_n": forces.map(|m| joints(|i| m.deviation(i))),
        "contributors": contributors,
    })
}

fn rows(entry: impl Fn(usize, usize) -> f64) -> Value {
    json!([[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]])
}

/// The forces in the joints; they follow the two torques.
fn joints(deviation: impl Fn(usize) -> f64) -> Value {
    JOINTS
        .iter()
        .enumerate()
        .map(|(joint, name)| {
            let x = 2 + 2 * joint;
            ((*name).to_string(), json!([deviation(x), deviation(x + 1)]))
        })
        .collect()
}

/// The greatest values along a path, and all its points.
pub fn path_answer(robot: &str, along: &PathAccuracy) -> Value {
    let points: Vec<Value> = along
        .points
        .iter()
        .map(|point| {
            let mut figures = figures(&point.analysis);
            figures["distance_m"] = json!(point.distance);
            figures["line"] = json!(point.line);
            figures
        })
        .collect();
    let contact_losses: Vec<Value> = along
        .contact_losses
        .iter()
        .map(|loss| {
            json!({
                "joint": JOINTS[loss.joint_index],
                "distance_m": loss.distance,
                "line": loss.line,
            })
        })
        .collect();
    let analyses = along.points.iter().map(|point| &point.analysis);
    json!({
        "robot": robot,
        "worst": worst(analyses),
        "contact_loss_expected": contact_losses,
        "stations": points,
    })
}

/// The greatest values of a map, and all its cells.
pub fn map_answer(robot: &str, map: &AccuracyMap) -> Value {
    let places: Vec<Value> = map.reached().map(figures).collect();
    json!({
        "robot": robot,
        "pitch_m": map.pitch,
        "reached_area_m2": places.len() as f64 * map.pitch * map.pitch,
        "worst": worst(map.reached()),
        "places": places,
    })
}

/// The cheapest tolerances.
pub fn allocation_answer(cheapest: &Cheapest) -> Value {
    let names = cheapest.names.iter();
    json!({
        "cost": cheapest.allocation.cost,
        "worst_radial_sd_m": cheapest.allocation.worst_variance.sqrt(),
        "classes": names.map(|(dimension, class)| (dimension.to_string(), json!(class))).collect::<Value>(),
    })
}

fn figures(analysis: &AccuracyAnalysis) -> Value {
    let deviations = analysis.position.deviations();
    json!({
        "at_m": [analysis.pose.c.x, analysis.pose.c.y],
        "position_sd_m": [deviations[0], deviations[1]],
        "input_worst_m": analysis.input_worst,
        "clearance_worst_m": analysis.clearance.worst,
        "clearance_rms_m": analysis.clearance.rms,
    })
}

fn worst<'a>(analyses: impl Iterator<Item = &'a AccuracyAnalysis>) -> Value {
    let analyses: Vec<&AccuracyAnalysis> = analyses.collect();
    let greatest = |figure: fn(&AccuracyAnalysis) -> f64| {
        let figures = analyses.iter().map(|analysis| figure(analysis));
        figures.fold(0.0, f64::max)
    };
    json!({
        "position_sd_radial_m": greatest(AccuracyAnalysis::radial_deviation),
        "input_worst_m": greatest(|analysis| analysis.input_worst),
        "clearance_worst_m": greatest(|analysis| analysis.clearance.worst),
        "clearance_rms_m": greatest(|analysis| analysis.clearance.rms),
    })
}
