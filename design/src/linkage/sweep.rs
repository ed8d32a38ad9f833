//! A linkage driven over an interval of time: its samples, the limits of its motion, and the
//! instants at which a smooth motion changes to another branch.

use super::dyad::DyadError;
use super::forces::Forces;
use super::group::Group;
use super::model::Linkage;
use super::motion::Coordinate;
use super::solve::{LinkageMotion, SolveError};
use core::f64::consts::TAU;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The motion of a driving coordinate: q(t) = start + speed t + amplitude sin(2π f t + φ).
///
/// ```
/// use fivebar_design::linkage::DriveLaw;
///
/// // From 0.5 rad at 10 rad/s, and an oscillation of 0.1 rad at 2 Hz.
/// let law = DriveLaw { start: 0.5, speed: 10.0, amplitude: 0.1, frequency: 2.0, phase: 0.0 };
/// let half_a_period = law.at(0.25);
/// assert!((half_a_period.value - 3.0).abs() < 1e-15);
/// assert!((half_a_period.rate - (10.0 - 0.4 * core::f64::consts::PI)).abs() < 1e-12);
/// ```
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
    /// Positions, velocities and accelerations.
    pub motion: LinkageMotion<f64>,
    /// The forces that the motion needs.
    pub forces: Forces<f64>,
}

/// One instant of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepSample {
    /// Time [s].
    pub time: f64,
    /// The driving coordinates.
    pub inputs: Vec<Coordinate<f64>>,
    /// Motion and forces, or the element that has no solution.
    pub solved: Result<SolvedSample, SolveError>,
}

/// A limit of the motion: the linkage closes only on one side of it.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosureLimit {
    /// Time [s].
    pub time: f64,
    /// The driving coordinates at the limit [rad or m].
    pub inputs: Vec<f64>,
    /// True if the motion ends at the limit, false if it begins there.
    pub ends: bool,
    /// The element without a solution beyond the limit, and the reason.
    pub failure: SolveError,
}

/// A dead point at which a smooth motion changes to the other branch of a dyad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BranchChange {
    /// The first sample after it, an index in [`Sweep::samples`].
    pub sample: usize,
    /// The dyad, an index in [`Linkage::elements`].
    pub element: usize,
}

/// A linkage driven over an interval of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The instants, evenly spaced from 0 to the end.
    pub samples: Vec<SweepSample>,
    /// Where the motion ends and begins. Gaps shorter than a step are not found.
    pub limits: Vec<ClosureLimit>,
    /// Where a smooth motion leaves the stated branch of a dyad.
    pub branch_changes: Vec<BranchChange>,
}

/// Bisections of a step to find a limit, enough to reach the rounding error of time.
const BISECTIONS: usize = 50;

/// A dyad may have passed a dead point only if |sin μ| is below this at both samples.
const NEAR_DEAD_POINT: f64 = 0.3;

impl Sweep {
    /// Drives `linkage` by one law for each driven link, over `duration` [s] in `steps` equal
    /// steps.
    ///
    /// # Panics
    /// If the number of laws differs from the number of driven links.
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

/// The limit between two samples of which exactly one closes.
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
    // A singular sample within a motion is a dead point. The motion goes on beyond it.
    if !matches!(failure.reason, DyadError::Unreachable(_)) {
        return None;
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (good + bad);
        match sample(linkage, laws, middle).solved {
            Ok(_) => good = middle,
            Err(why) => {
                bad = middle;
                // Within rounding of the limit the rates are singular where the position
                // still exists.
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

/// The dyads whose other branch continues the motion of the sample before better than their
/// present branch.
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
        // The error of the other branch must be less than half of the error of this one.
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

/// The distance of a link's direction after `step` [s] from the direction predicted by its
/// rates before.
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
    /// The same linkage with one dyad on its other branch; none if the element has only one.
    /// `element` is an index in [`Linkage::elements`].
    pub fn with_other_branch(&self, element: usize) -> Option<Self> {
        let mut other = self.clone();
        other
            .elements
            .get_mut(element)?
            .group
            .change_branch()
            .then_some(other)
    }

    /// All assemblies of the linkage, its own first: 2ᵏ for k dyads with two branches.
    ///
    /// # Panics
    /// If k > 16, because there would be too many assemblies.
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
    /// Changes to the other branch; false if there is none.
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
