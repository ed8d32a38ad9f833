//! The summary of a sweep, for the terminal and as JSON.

use super::parts::{branch, moment};
use fivebar_design::linkage::{Linkage, SolveError, Sweep, SweepSample};
use fivebar_files::linkage::{DrivenLinkage, driven_links, dyads, links_of, reaction_names};
use serde::Serialize;

/// Number of assemblies shown on a terminal or a page; the JSON has all.
pub const SHOWN_ASSEMBLIES: usize = 16;

/// The results of a sweep.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// The linkage's name.
    pub linkage: String,
    /// Number of driven links.
    pub freedoms: usize,
    /// Number of instants.
    pub samples: usize,
    /// Number of instants at which the linkage closes.
    pub closed: usize,
    /// The type of a four-bar by Grashof's rule.
    pub grashof: Option<String>,
    /// Extremes of each dyad's transmission angle.
    pub transmission: Vec<Range>,
    /// Extremes of each driving torque or force.
    pub driving: Vec<Range>,
    /// The greatest force and moment in each joint.
    pub peak_reactions: Vec<PeakReaction>,
    /// The limits at which the motion ends or begins.
    pub limits: Vec<LimitFound>,
    /// The points at which a smooth motion would change to another branch.
    pub branch_changes: Vec<BranchChangeFound>,
    /// All assemblies, the file's own first.
    pub assemblies: Vec<Assembly>,
}

/// The extremes of a quantity.
#[derive(Clone, Debug, Serialize)]
pub struct Range {
    /// The part whose quantity it is.
    pub of: String,
    /// Its unit.
    pub unit: &'static str,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
}

/// The greatest force and moment in a joint.
#[derive(Clone, Debug, Serialize)]
pub struct PeakReaction {
    /// The joint, by its two links.
    pub joint: String,
    /// The force [N].
    pub force_n: f64,
    /// Its time [s].
    pub time_s: f64,
    /// The greatest moment about the joint's centre [N·m]: in a driven pin the driving
    /// torque, in a slide the moment that keeps the slider from tilting, in a free pin zero.
    pub moment_nm: f64,
}

/// A limit of the motion.
#[derive(Clone, Debug, Serialize)]
pub struct LimitFound {
    /// Its time [s].
    pub time_s: f64,
    /// The driving coordinates there [rad or m].
    pub inputs: Vec<f64>,
    /// Whether the motion ends here; else it begins here.
    pub ends: bool,
    /// Why the linkage does not close beyond it.
    pub reason: String,
}

/// A dead point in the motion.
#[derive(Clone, Debug, Serialize)]
pub struct BranchChangeFound {
    /// The first sample after it [s].
    pub time_s: f64,
    /// The dyad.
    pub dyad: String,
}

/// An assembly of the linkage: one branch for each dyad.
#[derive(Clone, Debug, Serialize)]
pub struct Assembly {
    /// The branch of each dyad that has two, in order.
    pub branches: String,
    /// The share of the sweep during which it closes, 0…1.
    pub closes: f64,
}

/// A failure as a sentence with the names of the links.
pub fn explain(driven: &DrivenLinkage, failure: &SolveError) -> String {
    let element = &driven.linkage.elements()[failure.element];
    let links = links_of(&driven.linkage, element.links());
    format!("{links} {}", failure.reason)
}

/// The results of a sweep of this linkage.
pub fn summary(driven: &DrivenLinkage, sweep: &Sweep) -> Summary {
    let linkage = &driven.linkage;
    let range = |of: String, unit, value: &dyn Fn(usize) -> Option<f64>| {
        let values = (0..sweep.samples.len()).filter_map(value);
        let [min, max] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[min, max], x| {
            [min.min(x), max.max(x)]
        });
        min.is_finite().then_some(Range { of, unit, min, max })
    };
    let solved = |i: usize| sweep.samples[i].solved.as_ref().ok();
    let transmission = dyads(linkage).into_iter().filter_map(|(dyad, name)| {
        range(name, "deg", &|i| {
            let dyad = solved(i)?.motion.dyads[dyad]?;
            Some(dyad.transmission_angle().to_degrees())
        })
    });
    let driving = driven_links(linkage).enumerate();
    let driving = driving.filter_map(|(k, (link, unit))| {
        let unit = if unit == "rad" { "N·m" } else { "N" };
        range(link.into(), unit, &|i| Some(solved(i)?.forces.driving[k]))
    });
    Summary {
        linkage: driven.name.clone(),
        freedoms: linkage.degrees_of_freedom(),
        samples: sweep.samples.len(),
        closed: sweep.solved().count(),
        grashof: linkage.four_bar().map(|bars| bars.classify().to_string()),
        transmission: transmission.collect(),
        driving: driving.collect(),
        peak_reactions: peak_reactions(driven, sweep),
        limits: limits(driven, sweep),
        branch_changes: branch_changes(driven, sweep),
        assemblies: assemblies(driven, sweep),
    }
}

fn peak_reactions(driven: &DrivenLinkage, sweep: &Sweep) -> Vec<PeakReaction> {
    let names = reaction_names(&driven.linkage).into_iter().enumerate();
    names
        .filter_map(|(k, joint)| {
            let force = sweep.solved().map(|(sample, solved)| {
                (solved.forces.reactions[k].wrench.force.norm(), sample.time)
            });
            let (force_n, time_s) = force.max_by(|(a, _), (b, _)| a.total_cmp(b))?;
            let moments = sweep
                .solved()
                .map(|(_, solved)| moment(&solved.forces.reactions[k]).abs());
            Some(PeakReaction {
                joint,
                force_n,
                time_s,
                moment_nm: moments.fold(0.0, f64::max),
            })
        })
        .collect()
}

fn limits(driven: &DrivenLinkage, sweep: &Sweep) -> Vec<LimitFound> {
    let limits = sweep.limits.iter();
    limits
        .map(|limit| LimitFound {
            time_s: limit.time,
            inputs: limit.inputs.clone(),
            ends: limit.ends,
            reason: explain(driven, &limit.failure),
        })
        .collect()
}

fn branch_changes(driven: &DrivenLinkage, sweep: &Sweep) -> Vec<BranchChangeFound> {
    let changes = sweep.branch_changes.iter();
    changes
        .map(|change| BranchChangeFound {
            time_s: sweep.samples[change.sample].time,
            dyad: links_of(
                &driven.linkage,
                driven.linkage.elements()[change.element].links(),
            ),
        })
        .collect()
}

fn assemblies(driven: &DrivenLinkage, sweep: &Sweep) -> Vec<Assembly> {
    // All assemblies at all instants would cost 2ᵏ sweeps; a few instants are enough.
    const INSTANTS: usize = 73;
    let step = sweep.samples.len().div_ceil(INSTANTS).max(1);
    let instants = || sweep.samples.iter().step_by(step);
    let assemblies = driven.linkage.assemblies();
    assemblies
        .map(|linkage| {
            let closes = |sample: &&SweepSample| linkage.motion(&sample.inputs).is_ok();
            let closed = instants().filter(closes).count();
            Assembly {
                branches: branches(&linkage),
                closes: closed as f64 / instants().count() as f64,
            }
        })
        .collect()
}

/// The branches of the dyads that have two, in order.
fn branches(linkage: &Linkage<f64>) -> String {
    let elements = linkage.elements().iter();
    let branches: Vec<_> = elements
        .filter_map(|element| branch(&element.group))
        .collect();
    branches.join(", ")
}
