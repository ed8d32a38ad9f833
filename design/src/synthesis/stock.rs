//! The nearest arms with lengths that are in stock, and the best of them.

use super::area::{Density, Placed};
use super::evolution::maximise;
use super::problem::{NOT_MET, Problem, is_met};
use super::proof::Proof;
use super::{Area, Design, Objective};

/// Generations of the search for a place.
const GENERATIONS: usize = 40;
/// By how many stock lengths links become longer where no rounded arm meets the requirements.
const MOST_LONGER: usize = 2;
/// A length this near to one in stock is that one [m].
const ROUNDING: f64 = 1e-9;
/// Nanometres in a metre.
const NANO: f64 = 1e9;
/// Least step of lengths in stock [m].
const LEAST_STEP: f64 = 1e-4;

/// The lengths that a builder can have.
#[derive(Clone, Debug, PartialEq)]
pub struct Stock {
    lengths: Lengths,
}

#[derive(Clone, Debug, PartialEq)]
enum Lengths {
    /// All multiples of this [m].
    Step(f64),
    /// These [m], each greater than the one before.
    List(Vec<f64>),
}

impl Default for Stock {
    /// Whole millimetres.
    fn default() -> Self {
        let lengths = Lengths::Step(1e-3);
        Self { lengths }
    }
}

impl Stock {
    /// All multiples of a length [m], of links and the base; none if it is less than 0.1 mm.
    pub fn step(step: f64) -> Option<Self> {
        (LEAST_STEP..f64::INFINITY).contains(&step).then_some(Self {
            lengths: Lengths::Step(step),
        })
    }

    /// Links of these lengths [m], in any order, and a base in whole millimetres; none if there is no length, or one is not
    /// more than 0.
    pub fn list(lengths: &[f64]) -> Option<Self> {
        let is_length = |length: &f64| (LEAST_STEP..f64::INFINITY).contains(length);
        let mut lengths = lengths.to_vec();
        lengths.sort_by(f64::total_cmp);
        lengths.dedup();
        (!lengths.is_empty() && lengths.iter().all(is_length)).then_some(Self {
            lengths: Lengths::List(lengths),
        })
    }

    /// The lengths of a link next to this one, below and above, so many further up; at the ends of a list one or none.
    fn beside(&self, length: f64, further: usize) -> Vec<f64> {
        match &self.lengths {
            Lengths::Step(step) => multiples(*step, length, further).to_vec(),
            Lengths::List(list) => {
                let below = list.partition_point(|&stock| stock <= length + ROUNDING);
                let from = (below + further).saturating_sub(1);
                let beside = list.iter().skip(from).take(2);
                beside.copied().collect()
            }
        }
    }

    /// The bases below and above this one.
    fn bases(&self, base: f64) -> [f64; 2] {
        match self.lengths {
            Lengths::Step(step) => multiples(step, base, 0),
            Lengths::List(_) => multiples(1e-3, base, 0),
        }
    }
}

/// The multiples of a step below and above a length, so many further up.
fn multiples(step: f64, length: f64, further: usize) -> [f64; 2] {
    let below = ((length + ROUNDING) / step).floor() + further as f64;
    // The number nearest to what a decimal fraction says.
    [below, below + 1.0].map(|count| (count * step * NANO).round() / NANO)
}

impl Problem<'_> {
    /// Of the arms with lengths in stock beside those of `best`, the best one that meets the requirements, with the best
    /// place of the area; if none meets them, of arms one or two lengths longer; else the one nearest to it. None if no such
    /// arm is within the limits of the links and the base.
    pub(super) fn in_stock(&self, best: &Design, seed: u64) -> Option<Design> {
        let mut nearest: Option<(f64, Design)> = None;
        for longer in 0..=MOST_LONGER {
            for lengths in self.rounded(best, longer) {
                let found = self.placed(lengths, best.size, seed);
                if nearest.is_none_or(|nearest| found.0 > nearest.0) {
                    nearest = Some(found);
                }
            }
            // Lengths are far less than this.
            if nearest.is_some_and(|(score, _)| is_met(score) || !self.has_left(1.0)) {
                break;
            }
        }
        nearest.map(|(_, design)| design)
    }

    /// The arms with each link rounded down or up and longer by so many lengths, and the base rounded, that are within the
    /// limits. A range of bases with none in stock keeps its base.
    fn rounded(&self, best: &Design, longer: usize) -> Vec<[f64; 5]> {
        let specification = self.specification;
        let [low, high] = specification.base;
        let stock = &specification.stock;
        let [l1, l2, l3, l4, base] = best.lengths;
        let [of1, of2, of3, of4] = [l1, l2, l3, l4].map(|length| stock.beside(length, longer));
        let mut bases = stock.bases(base).to_vec();
        bases.retain(|base| (low..=high).contains(base));
        if bases.is_empty() {
            bases.push(base);
        }
        let mut arms = Vec::new();
        for base in bases {
            for [l1, l2] in pairs(&of1, &of2) {
                if specification.symmetric {
                    arms.push([l1, l2, l2, l1, base]);
                } else {
                    let others = pairs(&of3, &of4);
                    arms.extend(others.map(|[l3, l4]| [l1, l2, l3, l4, base]));
                }
            }
        }
        let fits = |&lengths: &[f64; 5]| {
            let arm = Design { lengths, ..*best };
            arm.link_sum() <= specification.link_sum + ROUNDING
                && lengths[..4].iter().all(|&l| l > 0.0)
        };
        arms.retain(fits);
        arms
    }

    /// An arm with the best place of its area, and its score.
    fn placed(&self, lengths: [f64; 5], wanted: f64, seed: u64) -> (f64, Design) {
        let [l1, l2, l3, l4, _] = lengths;
        let sum = (l1 + l2).max(l3 + l4);
        let place = |point: &[f64]| self.place(point).map(|share| share * sum);
        let score = |place, density, floor| match self.specification.objective {
            Objective::Size => self.largest(lengths, place, density, floor),
            Objective::LinkSum(size) | Objective::Dexterity(size) | Objective::Measure(_, size) => {
                let worst = self.worst(lengths, Placed { size, place }, density);
                let merit = match self.specification.objective {
                    Objective::Measure(..) => worst.merit,
                    _ => worst.margin,
                };
                match worst.margin >= 0.0 {
                    true => (merit, Some(size)),
                    false => (NOT_MET + worst.margin, None),
                }
            }
        };
        let is_on_axis = self.specification.symmetric || self.specification.area == Area::Annulus;
        let dimensions = if is_on_axis { 1 } else { 2 };
        let search = |point: &[f64], floor: f64| score(place(point), Density::Search, floor).0;
        let may_go_on = || self.has_left(1.0);
        let place = place(&maximise(dimensions, GENERATIONS, seed, may_go_on, search, |_| ()).0);
        let (score, size) = score(place, Density::Check, f64::NEG_INFINITY);
        let size = size.unwrap_or(wanted);
        let design = self.design(lengths, Placed { size, place });
        // Samples may miss a place that the rounded arm does not reach.
        if is_met(score) && self.prove(&design) != Proof::Proved {
            return (NOT_MET, design);
        }
        // Of arms that meet the requirements, the shortest is wanted.
        let score = match self.specification.objective {
            Objective::LinkSum(_) if score >= 0.0 => -design.link_sum(),
            _ => score,
        };
        (score, design)
    }
}

fn pairs(a: &[f64], b: &[f64]) -> impl Iterator<Item = [f64; 2]> {
    a.iter().flat_map(|&a| b.iter().map(move |&b| [a, b]))
}
