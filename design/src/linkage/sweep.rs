//! A linkage driven through a stretch of time: its samples, where it stops being able to
//! move, and where the branch it is on is not the one a smooth motion would keep.

use super::dyad::DyadError;
use super::forces::Forces;
use super::group::Group;
use super::model::Linkage;
use super::motion::Coordinate;
use super::solve::{LinkageMotion, SolveError};
use core::f64::consts::TAU;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// How a driving coordinate moves: q(t) = start + speed t + amplitude sin(2π f t + φ).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveLaw {
    /// Its value at t = 0 without the oscillation [rad or m].
    pub start: f64,
    /// Its steady rate [rad/s or m/s].
    pub speed: f64,
    /// Amplitude of its oscillation [rad or m].
    pub amplitude: f64,
    /// f, frequency of its oscillation [Hz].
    pub frequency: f64,
    /// φ, phase of its oscillation at t = 0 [rad].
    pub phase: f64,
}

impl DriveLaw {
    /// The coordinate at time t [s].
    pub fn at(&self, t: f64) -> Coordinate<f64> {
        let w = TAU * self.frequency;
        let (sin, cos) = (w * t + self.phase).sin_cos();
        Coordinate {
            value: self.start + self.speed * t + self.amplitude * sin,
            rate: self.speed + self.amplitude * w * cos,
            acceleration: -self.amplitude * w * w * sin,
        }
    }
}

/// The linkage at one instant, where it has a solution.
#[derive(Clone, Debug, PartialEq)]
pub struct SolvedSample {
    /// What moves, and how.
    pub motion: LinkageMotion<f64>,
    /// The forces it takes.
    pub forces: Forces<f64>,
}

/// One instant of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepSample {
    /// When [s].
    pub time: f64,
    /// The driving coordinates.
    pub inputs: Vec<Coordinate<f64>>,
    /// The linkage, or why it cannot be there.
    pub solved: Result<SolvedSample, SolveError>,
}

/// An edge of the motion: on one side of it the linkage closes, on the other not.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosureLimit {
    /// When it is met [s].
    pub time: f64,
    /// The driving coordinates there [rad or m].
    pub inputs: Vec<f64>,
    /// Whether the motion ends here; else it begins here.
    pub ends: bool,
    /// What fails beyond it.
    pub failure: SolveError,
}

/// A dead point that a smooth motion passes onto the other branch of a dyad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BranchChange {
    /// The first sample after it, its place in the sweep.
    pub sample: usize,
    /// The dyad, its place in [`Linkage::elements`].
    pub element: usize,
}

/// A linkage driven through a stretch of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The instants, evenly spaced from 0 to the end.
    pub samples: Vec<SweepSample>,
    /// Where the motion ends and begins. Gaps shorter than a step go unseen.
    pub limits: Vec<ClosureLimit>,
    /// Where the stated branch has a kink that a smooth motion has not.
    pub branch_changes: Vec<BranchChange>,
}

/// Halvings of a step in search of a limit: to the rounding of the time.
const BISECTIONS: usize = 50;

/// Only a dyad with sin μ below this, on a sample beside, may have passed a dead point.
const NEAR_DEAD_POINT: f64 = 0.3;

impl Sweep {
    /// Drives `linkage` by one law for each driven link, over `duration` [s] in `steps`.
    ///
    /// # Panics
    /// If there are not as many laws as driven links.
    pub fn new(linkage: &Linkage<f64>, laws: &[DriveLaw], duration: f64, steps: usize) -> Self {
        let samples: Vec<_> = (0..=steps)
            .map(|i| sample(linkage, laws, duration * i as f64 / steps.max(1) as f64))
            .collect();
        let limits = samples
            .windows(2)
            .filter_map(|pair| limit(linkage, laws, &pair[0], &pair[1]))
            .collect();
        let branch_changes = (1..samples.len())
            .flat_map(|after| branch_changes(linkage, &samples, after))
            .collect();
        Self {
            samples,
            limits,
            branch_changes,
        }
    }

    /// The samples at which the linkage closes.
    pub fn solved(&self) -> impl Iterator<Item = (&SweepSample, &SolvedSample)> {
        let solved = |sample| Some((sample, SweepSample::solved(sample)?));
        self.samples.iter().filter_map(solved)
    }
}

impl SweepSample {
    fn solved(&self) -> Option<&SolvedSample> {
        self.solved.as_ref().ok()
    }
}

fn sample(linkage: &Linkage<f64>, laws: &[DriveLaw], time: f64) -> SweepSample {
    let inputs: Vec<_> = laws.iter().map(|law| law.at(time)).collect();
    let solved = linkage.motion(&inputs).and_then(|motion| {
        let forces = linkage.forces(&motion)?;
        Ok(SolvedSample { motion, forces })
    });
    SweepSample {
        time,
        inputs,
        solved,
    }
}

/// The edge between two samples of which one alone closes.
fn limit(
    linkage: &Linkage<f64>,
    laws: &[DriveLaw],
    before: &SweepSample,
    after: &SweepSample,
) -> Option<ClosureLimit> {
    let (mut good, mut bad, mut failure) = match (&before.solved, &after.solved) {
        (Ok(_), Err(failure)) => (before.time, after.time, *failure),
        (Err(failure), Ok(_)) => (after.time, before.time, *failure),
        _ => return None,
    };
    // A singular sample in the midst of a motion is a dead point, not an edge.
    if !matches!(failure.reason, DyadError::Unreachable(_)) {
        return None;
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (good + bad);
        match sample(linkage, laws, middle).solved {
            Ok(_) => good = middle,
            Err(why) => {
                bad = middle;
                // Within rounding of the edge the rates fail before the position does.
                if matches!(why.reason, DyadError::Unreachable(_)) {
                    failure = why;
                }
            }
        }
    }
    Some(ClosureLimit {
        time: good,
        inputs: laws.iter().map(|law| law.at(good).value).collect(),
        ends: before.solved.is_ok(),
        failure,
    })
}

/// The dyads whose other branch carries on the motion of the sample before better than
/// the branch they are on.
fn branch_changes(
    linkage: &Linkage<f64>,
    samples: &[SweepSample],
    after: usize,
) -> Vec<BranchChange> {
    let (earlier, later) = (&samples[after - 1], &samples[after]);
    let (Some(before), Some(now)) = (earlier.solved(), later.solved()) else {
        return Vec::new();
    };
    let step = later.time - earlier.time;
    let near_dead_point = |motion: &LinkageMotion<f64>, element: usize| {
        motion.dyads[element].is_some_and(|dyad| Scalar::abs(dyad.sine) < NEAR_DEAD_POINT)
    };
    let changed = |&element: &usize| {
        if !(near_dead_point(&before.motion, element) && near_dead_point(&now.motion, element)) {
            return false;
        }
        let Some(other) = linkage.with_other_branch(element) else {
            return false;
        };
        // The other branch must carry on clearly better: by half.
        other.motion(&later.inputs).is_ok_and(|other| {
            let links = linkage.elements()[element].links();
            let prediction_error = |motion: &LinkageMotion<f64>| -> f64 {
                let prediction_error = |link| direction_error(&before.motion, motion, link, step);
                links
                    .clone()
                    .map(|link| prediction_error(link.index()))
                    .sum()
            };
            prediction_error(&other) < 0.5 * prediction_error(&now.motion)
        })
    };
    let elements = (0..linkage.elements().len()).filter(changed);
    elements
        .map(|element| BranchChange {
            sample: after,
            element,
        })
        .collect()
}

/// How far a link's direction is from where its rates would have taken it in `step`.
fn direction_error(
    before: &LinkageMotion<f64>,
    after: &LinkageMotion<f64>,
    link: usize,
    step: f64,
) -> f64 {
    let (before, after) = (&before.links[link], &after.links[link]);
    let turn = step * (before.omega + 0.5 * step * before.alpha);
    let predicted = Vector2::unit(turn).to_base_frame(before.axis);
    (after.axis - predicted).length()
}

impl<S: Scalar> Linkage<S> {
    /// The same linkage with one dyad on its other branch; none where it has but one.
    pub fn with_other_branch(&self, element: usize) -> Option<Self> {
        let mut other = self.clone();
        other
            .elements
            .get_mut(element)?
            .group
            .change_branch()
            .then_some(other)
    }

    /// The linkage on every assembly, this one's own first: 2ᵏ for k dyads with branches.
    ///
    /// # Panics
    /// Beyond 16 such dyads: there would be too many to go through.
    pub fn assemblies(&self) -> impl Iterator<Item = Self> + '_ {
        let branching: Vec<usize> = (0..self.elements.len())
            .filter(|&element| self.elements[element].group.clone().change_branch())
            .collect();
        assert!(branching.len() <= 16, "too many assemblies");
        (0..1_usize << branching.len()).map(move |mask| {
            let mut assembly = self.clone();
            for (bit, &element) in branching.iter().enumerate() {
                if mask >> bit & 1 == 1 {
                    assembly.elements[element].group.change_branch();
                }
            }
            assembly
        })
    }
}

impl<S> Group<S> {
    /// Takes the other branch; false where there is none.
    fn change_branch(&mut self) -> bool {
        match self {
            Self::Rrr { dyad, .. } => dyad.side = dyad.side.opposite(),
            Self::Rrp { dyad, .. } => dyad.branch = dyad.branch.opposite(),
            Self::Rpr { dyad, .. } => dyad.branch = dyad.branch.opposite(),
            Self::Crank { .. } | Self::Slider { .. } | Self::Prp { .. } | Self::Rpp { .. } => {
                return false;
            }
        }
        true
    }
}
