//! Pages of the accuracy of a five-bar: figures by analysis and sampling, ellipses, maps.

use super::heat_map::heat_map;
use super::pareto::pareto;
use crate::html::{Chart, Page};
use crate::study::accuracy::{JOINTS, PathAccuracy};
use crate::text::quantity;
use fivebar_design::accuracy::five_bar::{AccuracyAnalysis, AccuracyMap, MonteCarlo};
use fivebar_design::workspace::singularity_curves;
use fivebar_files::robot::Robot;
use fivebar_kinematics::five_bar::Tool;
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// One figure of an analysis [m].
pub(super) type Figure = fn(&AccuracyAnalysis) -> f64;

/// The limits of the models, stated on every page.
const LIMITS: &str = "First order, except where a figure is called exact: errors are small \
    compared with lengths and distances from singularities. Clearances are kineto-static: every \
    pin stays in contact. For impacts and flight, run `fivebar clearance`.";

/// The page of one state.
pub fn at_page(robot: &str, analysis: &AccuracyAnalysis, sampled: &MonteCarlo) -> Page {
    let mut page = Page::new(format!("Accuracy of {robot}"));
    let c = analysis.pose.c;
    page.paragraph(&format!(
        "Tool at ({:.4}, {:.4}) m. {LIMITS} {} samples from seed {}.",
        c.x, c.y, sampled.sampling.samples, sampled.sampling.seed
    ));
    let rows = figures(analysis, sampled);
    page.table(&["figure", "analytic", "sampled"], &rows);
    page.heading("Contributions");
    page.figure(
        &pareto(&position_shares(analysis)),
        "Share of each dimension in the variance of the tool's position.",
    );
    page
}

/// The figures by analysis beside those by sampling, as rows of a table.
fn figures(analysis: &AccuracyAnalysis, sampled: &MonteCarlo) -> Vec<Vec<String>> {
    let deviations = analysis.position.deviations();
    let position = &sampled.position;
    let error = position.relative_error();
    let row = |name: &str, value: f64, twin: f64, error: f64, unit: &str| {
        vec![
            name.to_string(),
            quantity(value, unit),
            format!(
                "{} ± {}",
                quantity(twin, unit),
                quantity(twin * error, unit)
            ),
        ]
    };
    let bound = |name: &str, value: f64, largest: f64| {
        vec![
            name.to_string(),
            quantity(value, "m"),
            format!("≤ {}", quantity(largest, "m")),
        ]
    };
    let mut rows = vec![
        row(
            "standard deviation in x",
            deviations[0],
            position.deviation(0),
            error,
            "m",
        ),
        row(
            "standard deviation in y",
            deviations[1],
            position.deviation(1),
            error,
            "m",
        ),
        bound(
            "input errors, exact worst case",
            analysis.input_worst,
            sampled.input.largest[0],
        ),
        bound(
            "clearances, exact worst case",
            analysis.clearance.worst,
            sampled.clearance.largest[0],
        ),
        bound(
            "clearances, linear worst case",
            analysis.clearance.worst_linear,
            sampled.clearance.largest[1],
        ),
        row(
            "clearances, root mean square",
            analysis.clearance.rms,
            sampled.clearance.rms(0),
            error,
            "m",
        ),
    ];
    if let (Some(forces), Some(twin)) = (&analysis.forces, &sampled.forces) {
        let deviations = forces.scatter.deviations();
        let names = ["torque 1", "torque 4"].map(String::from).into_iter();
        let joints = JOINTS.iter().flat_map(|joint| {
            ["x", "y"].map(|axis| format!("force in {} along {axis}", joint.to_uppercase()))
        });
        for (index, name) in names.chain(joints).enumerate() {
            let unit = if index < 2 { "N·m" } else { "N" };
            let name = format!("standard deviation of {name}");
            rows.push(row(
                &name,
                deviations[index],
                twin.deviation(index),
                error,
                unit,
            ));
        }
    }
    rows
}

/// The page of a path.
pub fn path_page(robot: &str, along: &PathAccuracy) -> Page {
    let mut page = Page::new(format!("Accuracy of {robot} along a path"));
    page.paragraph(LIMITS);
    let curve = |figure: &dyn Fn(&AccuracyAnalysis) -> f64| -> Vec<[f64; 2]> {
        let points = along.points.iter();
        points.map(|s| [s.distance, figure(&s.analysis)]).collect()
    };
    let microns = |figure: Figure| curve(&move |analysis| 1e6 * figure(analysis));
    page.chart(
        &Chart::new("Tool error", "distance along the path [m]", "error [µm]")
            .line(
                "standard deviation, radial",
                microns(AccuracyAnalysis::radial_deviation),
            )
            .line("input errors, worst", microns(|a| a.input_worst))
            .line("clearances, worst", microns(|a| a.clearance.worst))
            .line("clearances, rms", microns(|a| a.clearance.rms)),
    );
    let path = along
        .points
        .iter()
        .map(|s| [s.analysis.pose.c.x, s.analysis.pose.c.y]);
    let mut plane =
        Chart::new("Scatter along the path", "x [m]", "y [m]").line("path", path.collect());
    plane.equal_aspect = true;
    let step = (along.points.len() / 24).max(1);
    for (index, point) in along.points.iter().step_by(step).enumerate() {
        let name = if index == 0 {
            "2σ ellipses, magnified 20×"
        } else {
            ""
        };
        plane = plane.line(name, ellipse(&point.analysis, 40.0));
    }
    page.chart(&plane);
    if along.points.iter().any(|s| s.analysis.forces.is_some()) {
        let mut chart = Chart::new("Joint forces", "distance along the path [m]", "force [N]");
        for (joint, name) in JOINTS.iter().enumerate() {
            let force = move |analysis: &AccuracyAnalysis| {
                analysis
                    .forces
                    .as_ref()
                    .map_or(f64::NAN, |f| f.equilibrium.reactions[joint].norm())
            };
            chart = chart.line(name.to_uppercase(), curve(&force));
        }
        page.chart(&chart);
        page.heading("Expected losses of contact");
        if along.contact_losses.is_empty() {
            page.paragraph("None: no reaction reverses, so every pin can stay in contact.");
        } else {
            let rows: Vec<Vec<String>> = along
                .contact_losses
                .iter()
                .take(200)
                .map(|loss| {
                    let joint = JOINTS[loss.joint_index].to_uppercase();
                    vec![joint, quantity(loss.distance, "m"), loss.line.to_string()]
                })
                .collect();
            page.paragraph("At these points a reaction reverses, so the pin crosses its bearing.");
            page.table(&["joint", "distance along the path", "line"], &rows);
        }
    }
    page
}

/// The page of a map.
pub fn map_page(robot: &Robot, map: &AccuracyMap) -> Page {
    let mut page = Page::new(format!("Accuracy of {} over its workspace", robot.name));
    // The map is that of C.
    let at_c = Tool::new(robot.geometry, Vector2::zeros());
    let curves = at_c.map_or_else(
        |_| Vec::new(),
        |at_c| singularity_curves(&at_c, robot.elbows),
    );
    let figures: [(&str, Figure); 4] = [
        (
            "standard deviation, radial",
            AccuracyAnalysis::radial_deviation,
        ),
        ("input errors, exact worst case", |a| a.input_worst),
        ("clearances, exact worst case", |a| a.clearance.worst),
        ("clearances, root mean square", |a| a.clearance.rms),
    ];
    for (name, figure) in figures {
        let values = map.reached().map(figure);
        let (least, greatest) = values
            .fold((f64::INFINITY, 0.0_f64), |(least, greatest), value| {
                (least.min(value), greatest.max(value))
            });
        if greatest > 0.0 {
            let (from, to) = (quantity(least, "m"), quantity(greatest, "m"));
            page.figure(
                &heat_map(map, &curves, (name, figure), [least, greatest]),
                &format!(
                    "{name}: {from} (yellow) to {to} (violet), on a logarithmic scale. Lines: a leg \
                     is straight or folded; dashed: the couplers are parallel. Axes in mm."
                ),
            );
        }
    }
    page.paragraph(LIMITS);
    page
}

/// The covariance ellipse about C for `factor` standard deviations.
fn ellipse(analysis: &AccuracyAnalysis, factor: f64) -> Vec<[f64; 2]> {
    let covariance = &analysis.position.covariance;
    let eigen = covariance.clone().symmetric_eigen();
    (0..=32)
        .map(|i| {
            let (sin, cos) = (TAU * f64::from(i) / 32.0).sin_cos();
            let along = |j: usize| factor * eigen.eigenvalues[j].max(0.0).sqrt();
            let offset = |row: usize| {
                eigen.eigenvectors[(row, 0)] * along(0) * cos
                    + eigen.eigenvectors[(row, 1)] * along(1) * sin
            };
            [analysis.pose.c.x + offset(0), analysis.pose.c.y + offset(1)]
        })
        .collect()
}

/// The share of each dimension in the variance of the tool's position, the greatest first.
fn position_shares(analysis: &AccuracyAnalysis) -> Vec<(&str, f64)> {
    let total = analysis.position.covariance.trace();
    let share = |i: usize| {
        let part: f64 = analysis.position.contributions.column(i).sum();
        if total > 0.0 { part / total } else { 0.0 }
    };
    let primitives = analysis.primitives.iter().enumerate();
    let mut shares: Vec<_> = primitives
        .map(|(i, primitive)| (primitive.name.as_str(), share(i)))
        .collect();
    shares.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    shares
}
