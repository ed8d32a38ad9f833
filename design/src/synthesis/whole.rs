//! The nearest arms with lengths in whole millimetres, and the best of them.

use super::area::{Density, Placed};
use super::evolution::maximise;
use super::problem::{NOT_MET, Problem};
use super::{Area, Design, Objective};

/// Generations of the search for a place.
const GENERATIONS: usize = 40;
/// By how much links become longer where no rounded arm meets the requirements [mm].
const MOST_LONGER: u8 = 2;
/// Millimetres in a metre.
const MILLI: f64 = 1e3;
/// A length this near to a whole millimetre is one [mm].
const ROUNDING: f64 = 1e-6;

impl Problem<'_> {
    /// Of the arms whose lengths are those of `best`, each rounded up or down, the best one that meets
    /// the requirements, with the best place of the area; if none meets them, of arms a millimetre or
    /// two longer; else the one nearest to it.
    pub(super) fn in_whole_millimetres(&self, best: &Design, seed: u64) -> Design {
        let mut nearest = (f64::NEG_INFINITY, *best);
        for longer in 0..=MOST_LONGER {
            for lengths in self.rounded(best, f64::from(longer)) {
                let found = self.placed(lengths, best.size, seed);
                if found.0 > nearest.0 {
                    nearest = found;
                }
            }
            // Lengths are far less than this.
            if nearest.0 > 0.5 * NOT_MET {
                break;
            }
        }
        nearest.1
    }

    /// The arms with each link rounded down or up and `longer` [mm], and the base rounded, that are within the limits. A range of bases
    /// without a whole millimetre keeps its base.
    fn rounded(&self, best: &Design, longer: f64) -> Vec<[f64; 5]> {
        let specification = self.specification;
        let [low, high] = specification.base;
        let from = |length: f64, longer: f64| {
            let down = (length * MILLI + ROUNDING).floor() + longer;
            [down / MILLI, (down + 1.0) / MILLI]
        };
        let steps = |length: f64| from(length, longer);
        let [l1, l2, l3, l4, base] = best.lengths;
        let mut bases = from(base, 0.0).to_vec();
        bases.retain(|base| (low..=high).contains(base));
        if bases.is_empty() {
            bases.push(base);
        }
        let mut arms = Vec::new();
        for base in bases {
            for [l1, l2] in pairs(steps(l1), steps(l2)) {
                if specification.symmetric {
                    arms.push([l1, l2, l2, l1, base]);
                } else {
                    let others = pairs(steps(l3), steps(l4));
                    arms.extend(others.map(|[l3, l4]| [l1, l2, l3, l4, base]));
                }
            }
        }
        let slack = ROUNDING / MILLI;
        let fits = |&lengths: &[f64; 5]| {
            let arm = Design { lengths, ..*best };
            arm.link_sum() <= specification.link_sum + slack
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
        let place = place(&maximise(dimensions, GENERATIONS, seed, search, |_| ()).0);
        let (score, size) = score(place, Density::Check, f64::NEG_INFINITY);
        let size = size.unwrap_or(wanted);
        let design = self.design(lengths, Placed { size, place });
        // Of arms that meet the requirements, the shortest is wanted.
        let score = match self.specification.objective {
            Objective::LinkSum(_) if score >= 0.0 => -design.link_sum(),
            _ => score,
        };
        (score, design)
    }
}

fn pairs([a, b]: [f64; 2], [c, d]: [f64; 2]) -> impl Iterator<Item = [f64; 2]> {
    [[a, c], [a, d], [b, c], [b, d]].into_iter()
}
