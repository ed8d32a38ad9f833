//! The accuracy of a linkage: the scatter of its motion and forces at one instant and over its
//! sweep, by analysis and by sampling.

use super::point_error::{self, PinRadius, PointError};
use super::{LinkageAccuracyModel, LinkageTolerance, ResultKind, clearance_equilibrium};
use crate::accuracy::sampling::{Deviations, Progress, Sampling, sample};
use crate::accuracy::{DifferentiableModel as _, Primitive, Scatter, sensitivities};
use crate::linkage::{Clearance, Coordinate, DriveLaw, Linkage, ParameterKind, SolveError};
use rayon::prelude::*;

/// A linkage with the motion of its driven links and its tolerances.
#[derive(Clone, Copy, Debug)]
pub struct TolerancedLinkage<'a> {
    /// The nominal linkage.
    pub linkage: &'a Linkage<f64>,
    /// The motion of each driven link.
    pub laws: &'a [DriveLaw],
    /// Its tolerances.
    pub tolerance: &'a LinkageTolerance,
}

/// The effect of tolerances and clearances on a linkage at one instant.
#[derive(Clone, Debug)]
pub struct LinkageAnalysis {
    /// The instant [s].
    pub time: f64,
    /// The driving coordinates.
    pub inputs: Vec<Coordinate<f64>>,
    /// The results: motion and forces.
    pub results: Vec<ResultKind>,
    /// Their nominal values, with the pins at their assumed positions.
    pub values: Vec<f64>,
    /// All primitives with a scatter: inputs and their rates, then parameters.
    pub primitives: Vec<Primitive>,
    /// The scatter of the results.
    pub scatter: Scatter,
    /// Worst errors of each point by pins and inputs, in the order of the linkage's points; none
    /// for points of the frame.
    pub point_errors: Vec<Option<PointError>>,
    /// Whether the search for the clearance equilibrium has converged; otherwise a joint is
    /// about to lose contact.
    pub settled: bool,
    linkage: Linkage<f64>,
    varied: Vec<usize>,
}

impl LinkageAnalysis {
    /// The share of each primitive in the summed variance of `rows` results from `row` on,
    /// largest first.
    pub fn shares(&self, row: usize, rows: usize) -> Vec<(usize, f64)> {
        let parts = self.scatter.contributions.rows(row, rows).row_sum();
        let total = parts.sum();
        let share = |part: f64| if total > 0.0 { part / total } else { 0.0 };
        let mut shares: Vec<_> = parts.iter().map(|part| share(*part)).enumerate().collect();
        shares.sort_by(|(_, a), (_, b)| b.total_cmp(a));
        shares
    }
}

/// The analysis over the sweep, and one instant also by sampling.
#[derive(Clone, Debug)]
pub struct LinkageStudy {
    /// The chosen instant.
    pub instant: LinkageAnalysis,
    /// Its results by sampling.
    pub sampled: Deviations,
    /// Number and seed of the samples.
    pub sampling: Sampling,
    /// All instants of the sweep at which the linkage closes.
    pub sweep: Vec<LinkageAnalysis>,
}

/// Analyses a linkage at the ends of `steps` equal steps over `duration` [s], and at `time` [s]
/// also by sampling.
///
/// # Errors
/// The element that cannot be solved at `time`. Instants of the sweep at which the linkage does
/// not close are left out.
pub fn study_linkage(
    driven: &TolerancedLinkage<'_>,
    duration: f64,
    steps: usize,
    time: f64,
    sampling: Sampling,
    progress: Progress<'_>,
) -> Result<LinkageStudy, SolveError> {
    let instant = analyse_linkage(driven, time)?;
    let times = (0..=steps).into_par_iter();
    let times = times.map(|i| duration * i as f64 / steps.max(1) as f64);
    let sweep = times.filter_map(|time| analyse_linkage(driven, time).ok());
    let sweep: Vec<_> = sweep.collect();
    Ok(LinkageStudy {
        sampled: sample_linkage(&instant, sampling, progress),
        sampling,
        instant,
        sweep,
    })
}

/// Analyses a linkage at `time` [s].
///
/// # Errors
/// The element that cannot be solved.
pub fn analyse_linkage(
    driven: &TolerancedLinkage<'_>,
    time: f64,
) -> Result<LinkageAnalysis, SolveError> {
    let tolerance = driven.tolerance;
    let inputs: Vec<_> = driven.laws.iter().map(|law| law.at(time)).collect();
    let (linkage, settled) = with_pin_offsets(driven, &inputs)?;
    let varied = Varied::of(tolerance, &linkage);
    let model = LinkageAccuracyModel {
        linkage: &linkage,
        varied: varied.indices,
    };
    let nominal = model.primitives(&inputs);
    let names = driven.linkage.driven_links();
    let names: Vec<&str> = names
        .map(|link| driven.linkage.links()[link.index()].name.as_str())
        .collect();
    let of_inputs = ["position", "rate", "acceleration"].into_iter();
    let mut primitives: Vec<Primitive> = of_inputs
        .zip(&tolerance.input_sd)
        .flat_map(|(what, deviations)| {
            let inputs = names.iter().zip(deviations);
            inputs.map(move |(name, &deviation)| Primitive {
                name: format!("{name} {what}"),
                mean: 0.0,
                deviation,
            })
        })
        .collect();
    let first_parameter = primitives.len();
    primitives.extend(varied.primitives);
    for (primitive, &mean) in primitives.iter_mut().zip(&nominal) {
        primitive.mean = mean;
    }
    let t = sensitivities(&model, &nominal)?;
    let results = model.result_kinds();
    let values = model.evaluate(&nominal)?;
    let pins = varied.radii.into_iter().map(|pin| PinRadius {
        column: first_parameter + pin.column,
        ..pin
    });
    let pins: Vec<_> = pins.collect();
    let motion = linkage.motion(&inputs)?;
    let corners = point_error::input_worst(&linkage, &inputs, &tolerance.input_max, &motion);
    let point_errors = point_error::point_errors(&motion, &pins, corners.as_deref(), &t, &results);
    Ok(LinkageAnalysis {
        time,
        inputs,
        values,
        scatter: Scatter::propagate(&t, &primitives),
        results,
        primitives,
        point_errors,
        settled,
        varied: model.varied,
        linkage,
    })
}

/// The linkage with its pins out of their centres: at the angles of the file, or else in
/// clearance equilibrium.
fn with_pin_offsets(
    driven: &TolerancedLinkage<'_>,
    inputs: &[Coordinate<f64>],
) -> Result<(Linkage<f64>, bool), SolveError> {
    let mut linkage = driven.linkage.clone();
    let mut radii = vec![0.0; linkage.joint_links().count()];
    for pin in &driven.tolerance.pins {
        if let Some(angle) = pin.angle {
            let radius = pin.radius;
            // This cannot fail: the file's joints are pins and its radii are valid.
            let _ = linkage.set_clearance(pin.joint_index, Clearance { radius, angle });
        } else {
            radii[pin.joint_index] = pin.radius;
        }
    }
    let equilibrium = clearance_equilibrium(&linkage, inputs, &radii)?;
    Ok((equilibrium.linkage, equilibrium.converged))
}

/// The parameters that have a scatter or belong to a pin.
struct Varied {
    /// Their indices in the order of [`Linkage::map_parameters`].
    indices: Vec<usize>,
    /// A primitive for each of them.
    primitives: Vec<Primitive>,
    /// The pins' radii, each with its index among the primitives.
    radii: Vec<PinRadius>,
}

impl Varied {
    fn of(tolerance: &LinkageTolerance, linkage: &Linkage<f64>) -> Self {
        let has_section = |name: &str| {
            let mut links = linkage.links().iter();
            links.any(|link| link.name == name && link.section.is_some())
        };
        let mut varied = Self {
            indices: Vec::new(),
            primitives: Vec::new(),
            radii: Vec::new(),
        };
        // The pins come in the order of the joints, each with its radius before its angle.
        let mut radii = tolerance.pins.iter();
        let mut angles = tolerance.pins.iter();
        for (index, (parameter, mean)) in linkage.parameters().into_iter().enumerate() {
            let part = parameter.part;
            let found = match parameter.kind {
                ParameterKind::Clearance(_) => {
                    varied.radii.push(PinRadius {
                        radius: mean,
                        column: varied.primitives.len(),
                    });
                    let pin = radii.next();
                    pin.map(|pin| (format!("clearance of {}", pin.name), pin.radius_sd))
                }
                ParameterKind::ClearanceAngle(_) => {
                    let pin = angles.next();
                    pin.map(|pin| (format!("clearance angle of {}", pin.name), pin.angle_sd))
                }
                ParameterKind::Mass if mean == 0.0 || has_section(part) => None,
                kind => {
                    let deviation = tolerance.deviation(parameter);
                    (deviation > 0.0).then(|| (format!("{} of {part}", noun(kind)), deviation))
                }
            };
            if let Some((name, deviation)) = found {
                varied.indices.push(index);
                varied.primitives.push(Primitive {
                    name,
                    mean,
                    deviation,
                });
            }
        }
        varied
    }
}

/// What a parameter with a scatter measures, in a word.
fn noun(kind: ParameterKind) -> &'static str {
    match kind {
        ParameterKind::Length => "length",
        ParameterKind::Offset => "offset",
        ParameterKind::Local(0) => "x",
        ParameterKind::Local(_) => "y",
        ParameterKind::Mass => "mass",
        _ => "section",
    }
}

/// Samples the results with normally distributed errors of all primitives.
pub fn sample_linkage(
    analysis: &LinkageAnalysis,
    sampling: Sampling,
    progress: Progress<'_>,
) -> Deviations {
    let model = LinkageAccuracyModel {
        linkage: &analysis.linkage,
        varied: analysis.varied.clone(),
    };
    sample(sampling, progress, |noise| {
        let made = |primitive: &Primitive| primitive.mean + primitive.deviation * noise.normal();
        let primitives: Vec<f64> = analysis.primitives.iter().map(made).collect();
        model.evaluate(&primitives).ok()
    })
}
