//! Which lengths to build: the arm whose work area is the largest, or which is the smallest for a work
//! area, with 1/κ ≥ k at each point of it.
//!
//! 1/κ = σmin/σmax of the Jacobian. A known answer: of the symmetric coaxial arms (cranks a, couplers b,
//! a + b = L) the widest ring with 1/κ ≥ k = tan ψ0 has a = b cos ψ0 and the width
//! 2 L √cos 2ψ0/(1 + cos ψ0).
//!
//! A design is a base, the shares of its links and a place of the area. For these the size of the area,
//! or the sum of the links, follows by bisection, because smaller areas at the same place lie in larger
//! ones; differential evolution searches the rest. Where a measure of the tip is sought, it searches the
//! sum too. The samples of the search prove nothing:
//! [`Synthesis::proof`] is by interval arithmetic.

mod area;
mod condition;
mod cranks;
mod evolution;
mod front;
mod interval;
mod measure;
mod payload;
mod problem;
mod proof;
mod stock;
mod study;

pub use area::Area;
pub use cranks::CrankRange;
pub use measure::{Measure, Measures, Tolerance, WorstPoints};
pub use payload::{Drive, Load, Payload};
pub use proof::Proof;
pub use stock::Stock;
pub use study::{Candidate, Found, Study};

use core::fmt;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};

/// What is wanted of an arm. Its elbows turn outwards: `working_mode = ["right", "left"]` in robot files.
#[derive(Clone, Debug, PartialEq)]
pub struct Specification {
    /// Whether both legs are equal.
    pub symmetric: bool,
    /// Least and greatest base [m].
    pub base: [f64; 2],
    /// Greatest sum of the links of a leg and half the base [m].
    pub link_sum: f64,
    /// The shape of the work area.
    pub area: Area,
    /// Least 1/κ in the area; 0 where the least sine is above 0, which keeps singularities out by itself.
    pub dexterity: f64,
    /// Least |sin| of the angles at the elbows and at C in the area; 0 where the least 1/κ is above 0.
    pub sine: f64,
    /// The range of the cranks' angles; none if they may turn anywhere.
    pub cranks: Option<CrankRange>,
    /// The lengths that a builder can have.
    pub stock: Stock,
    /// What the tip carries, and the drives to choose from; none if nothing is asked of them.
    pub payload: Option<Payload>,
    /// The errors of the arm, for the error of its tip.
    pub tolerance: Tolerance,
    /// What is sought.
    pub objective: Objective,
    /// Designs of the front, the best being the first; the others have more dexterity.
    pub front: usize,
    /// Searches of each design, from seeds of their own; the best result counts.
    pub starts: usize,
}

/// What is sought.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Objective {
    /// The largest area within the sum of the links.
    Size,
    /// The least sum of the links for an area of this size [m].
    LinkSum(f64),
    /// The greatest 1/κ in an area of this size [m].
    Dexterity(f64),
    /// The best worst point of an area of this size [m] by a measure of the tip.
    Measure(Measure, f64),
}

/// An arm with its work area.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Design {
    /// l1…l4 and the base [m].
    pub lengths: [f64; 5],
    /// The size of the area [m].
    pub size: f64,
    /// The area's place from the middle of the base [m].
    pub place: [f64; 2],
    /// The least 1/κ found in the area.
    pub dexterity: f64,
    /// What the tip can at the worst point of the area for each.
    pub measures: Measures,
    /// Where these worst points are.
    pub worst_points: WorstPoints,
    /// What the specification's payload asks of a drive; 0 without one.
    pub load: Load,
}

impl Design {
    /// The links of the longer leg and half the base [m].
    pub fn link_sum(&self) -> f64 {
        let [l1, l2, l3, l4, base] = self.lengths;
        (l1 + l2).max(l3 + l4) + 0.5 * base
    }
}

/// The answer to a specification.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Synthesis {
    /// The best design.
    pub best: Design,
    /// The best one with lengths that are in stock, the base too where its range has one; to be checked
    /// like any other design.
    pub stock: Design,
    /// Designs for more and more dexterity, the best being the first.
    pub front: Vec<Design>,
    /// How much 1/κ changes per length of l1…l4 and the base [1/m], at the worst point of the best
    /// design's area; the greater loss of a longer and a shorter link.
    pub sensitivity: [f64; 5],
    /// The cheapest drive that carries the payload in the area of the best design, and in that of the lengths in stock.
    pub drives: [Option<Drive>; 2],
    /// How often the area of an arm was examined.
    pub evaluations: u64,
    /// Whether the best design is free of singularities in its area.
    pub proof: Proof,
    /// The same for the design of lengths in stock.
    pub stock_proof: Proof,
}

/// Why there is no design.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SynthesisError {
    /// None was found; the best candidate falls short of 1/κ or of the sine by this much.
    NotFound(f64),
    /// No lengths in stock beside the best ones are within the limits of the links and the base.
    NotInStock,
}

impl fmt::Display for SynthesisError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFound(short) => write!(
                f,
                "no arm was found; the best candidate falls short of `dexterity`, `sine`, `crank` or [payload] by {short:.3}: \
                 allow a longer `link_sum`, a wider range of `base`, or require less"
            ),
            Self::NotInStock => f.write_str(
                "no arm of lengths in [stock] is within `link_sum`: add shorter lengths, or allow a longer `link_sum`",
            ),
        }
    }
}

impl core::error::Error for SynthesisError {}

/// Proves an arm of these lengths [m], elbows out, free of singularities in an area of this size [m] at a
/// place from the middle of its base [m].
pub fn prove(lengths: [f64; 5], area: &Area, size: f64, place: [f64; 2]) -> Proof {
    proof::prove(lengths, area, area::Placed { size, place }, None)
}

/// Searches the best arm. The result depends on the seed, not on the number of threads. `progress`
/// receives the share of the searches that are done.
///
/// # Errors
/// No arm that meets the requirements was found.
pub fn synthesise(
    specification: &Specification,
    seed: u64,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Synthesis, SynthesisError> {
    let study = Study::new(specification, seed);
    let count = AtomicUsize::new(0);
    study.run(&[], &|_, _| {
        let done = 1 + count.fetch_add(1, Ordering::Relaxed);
        progress(done as f64 / study.searches() as f64);
    })
}
