//! A specification as a search: candidates, their scores, and the best of them examined closely.

use super::area::{Density, Placed, Samples};
use super::condition::{Condition, condition};
use super::evolution::maximise;
use super::measure::{Measure, Measures, WorstPoints};
use super::proof::{self, Proof};
use super::{Area, Design, Objective, Specification, study};
use nalgebra::Vector2;
use std::sync::atomic::{AtomicU64, Ordering};

/// Generations of the search, and of the second one beside its result with the samples of the check.
pub(super) const GENERATIONS: usize = 120;
const CHECK_GENERATIONS: usize = 40;
/// The share of a budget that the first search may spend.
const SEARCH_SHARE: f64 = 0.7;
/// The width of the second search.
const BESIDE: f64 = 0.04;
/// Bisections of a size or a sum: in the search, and of the result.
const SEARCH_BISECTIONS: u32 = 20;
const CHECK_BISECTIONS: u32 = 30;
/// The greatest share of a leg's sum that a link has.
const LONGEST_SHARE: f64 = 0.98;
/// The sum of links that always suffices if any does, as a multiple of size and base; used where the
/// specification sets no limit.
const AMPLE: f64 = 30.0;
/// Score of a candidate that meets no requirement, below all that do.
pub(super) const NOT_MET: f64 = -1e6;
/// By how much the search requires more 1/κ than asked for: its fewer samples see a little less than those
/// of the check, and just beyond an optimum the area may shrink to half.
const SLACK: f64 = 1e-5;
/// Change of a length for sensitivities, as a share of the links' sum.
const CHANGE: f64 = 1e-5;

/// Whether a candidate with this score meets the requirements.
pub(super) fn is_met(score: f64) -> bool {
    score > 0.5 * NOT_MET
}

/// A search for an arm.
pub(super) struct Problem<'a> {
    pub(super) specification: &'a Specification,
    dexterity: f64,
    search: Samples,
    check: Samples,
    evaluations: AtomicU64,
    /// How often the areas of arms may be examined.
    budget: u64,
}

/// The least of what is required over an area.
#[derive(Clone, Copy, Debug)]
pub(super) struct Worst {
    /// By how much all requirements are met, negative where one is not.
    pub(super) margin: f64,
    /// 1/κ; negative where the arm changes its assembly mode or does not reach.
    pub(super) dexterity: f64,
    /// Of the measure that is sought ([`Measure::merit`]).
    pub(super) merit: f64,
}

impl Worst {
    /// Of no point.
    const NONE: Self = Self {
        margin: f64::INFINITY,
        dexterity: f64::INFINITY,
        merit: f64::INFINITY,
    };

    fn and(self, other: Self) -> Self {
        Self {
            margin: self.margin.min(other.margin),
            dexterity: self.dexterity.min(other.dexterity),
            merit: self.merit.min(other.merit),
        }
    }
}

/// How many samples are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Until {
    All,
    /// Those up to the first at which both assembly modes have failed: the worst that is seen is negative as that of all.
    NotMet,
}

/// The parts of a design that the search varies.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    base: f64,
    /// Cranks l1 and l4 by their leg's sum.
    cranks: [f64; 2],
    /// The legs' sums by the longer one.
    legs: [f64; 2],
    /// The longer leg's sum by the greatest one allowed.
    sum: f64,
    /// The place by the longer leg's sum.
    place: [f64; 2],
}

impl Candidate {
    fn lengths(&self, sum: f64) -> [f64; 5] {
        let [leg1, leg4] = self.legs.map(|share| share * sum);
        let [l1, l4] = [self.cranks[0] * leg1, self.cranks[1] * leg4];
        [l1, leg1 - l1, leg4 - l4, l4, self.base]
    }

    fn place(&self, sum: f64) -> [f64; 2] {
        self.place.map(|share| share * sum)
    }
}

impl<'a> Problem<'a> {
    /// The search for an arm with this least 1/κ.
    pub(super) fn new(specification: &'a Specification, dexterity: f64, budget: u64) -> Self {
        Self {
            specification,
            dexterity,
            search: specification.area.samples(Density::Search),
            check: specification.area.samples(Density::Check),
            evaluations: AtomicU64::new(0),
            budget,
        }
    }

    pub(super) fn evaluations(&self) -> u64 {
        self.evaluations.load(Ordering::Relaxed)
    }

    /// Whether this share of the budget is not spent yet.
    pub(super) fn has_left(&self, share: f64) -> bool {
        self.evaluations() as f64 <= share * self.budget as f64
    }

    /// The best design that the search finds, with its score; without one, how far its best candidate falls short,
    /// below 0. `record` receives the candidates that meet the requirements.
    pub(super) fn solve(
        &self,
        seed: u64,
        record: &mut dyn FnMut(&[study::Candidate]),
    ) -> (f64, Option<Design>) {
        let dimensions = self.dimensions();
        let score =
            |point: &[f64], density, floor| self.scale(&self.candidate(point), density, floor).0;
        let (near, _) = maximise(
            dimensions,
            GENERATIONS,
            seed,
            || self.has_left(SEARCH_SHARE),
            |point, floor| score(point, Density::Search, floor),
            |scored| {
                self.record(
                    scored.iter().map(|(point, score)| (&**point, *score)),
                    record,
                );
            },
        );
        let beside = |point: &[f64]| -> Vec<f64> {
            let steps = near.iter().zip(point);
            steps
                .map(|(near, x)| (near + BESIDE * (x - 0.5)).clamp(0.0, 1.0))
                .collect()
        };
        let (point, _) = maximise(
            dimensions,
            CHECK_GENERATIONS,
            seed,
            || self.has_left(1.0),
            |point, floor| score(&beside(point), Density::Check, floor),
            |scored| {
                let points: Vec<_> = scored.iter().map(|(point, _)| beside(point)).collect();
                let scores = scored.iter().map(|(_, score)| *score);
                self.record(points.iter().map(|point| &**point).zip(scores), record);
            },
        );
        let point = beside(&point);
        let candidate = self.candidate(&point);
        match self.scale(&candidate, Density::Check, f64::NEG_INFINITY) {
            (score, Some((sum, size))) => {
                let (lengths, place) = (candidate.lengths(sum), candidate.place(sum));
                (score, Some(self.design(lengths, Placed { size, place })))
            }
            (score, None) => (score - NOT_MET, None),
        }
    }

    /// The value of the best arm that a coarse search finds: what is sought, or the inverse of what is to be small; 0 without one.
    pub(super) fn coarse_value(&self, seed: u64, generations: usize) -> f64 {
        let (_, score) = maximise(
            self.dimensions(),
            generations,
            seed,
            || self.has_left(1.0),
            |point, floor| {
                let candidate = self.candidate(point);
                self.scale(&candidate, Density::Search, floor).0
            },
            |_| (),
        );
        match score {
            score if !is_met(score) => 0.0,
            score if score < 0.0 => -1.0 / score,
            score => score,
        }
    }

    /// How many numbers the search varies.
    fn dimensions(&self) -> usize {
        let legs = if self.specification.symmetric { 3 } else { 6 };
        legs + usize::from(self.seeks_sum())
    }

    /// Gives the candidates that meet the requirements to `record`.
    fn record<'p>(
        &self,
        scored: impl Iterator<Item = (&'p [f64], f64)>,
        record: &mut dyn FnMut(&[study::Candidate]),
    ) {
        let candidates: Vec<_> = scored
            .filter(|(_, score)| is_met(*score))
            .map(|(point, score)| {
                let candidate = self.candidate(point);
                let (sum, size) = self.scaled(&candidate, score);
                study::Candidate {
                    lengths: candidate.lengths(sum),
                    size,
                    place: candidate.place(sum),
                    score,
                }
            })
            .collect();
        record(&candidates);
    }

    /// The links' sum and the area's size [m] of a candidate with this score.
    fn scaled(&self, candidate: &Candidate, score: f64) -> (f64, f64) {
        let half_base = 0.5 * candidate.base;
        match self.specification.objective {
            Objective::Size => (candidate.sum * self.longest(candidate.base), score),
            Objective::LinkSum(size) => (-score - half_base, size),
            Objective::Dexterity(size) | Objective::Measure(_, size) => {
                (candidate.sum * self.longest(candidate.base), size)
            }
        }
    }

    /// The greatest sum of the links beside a base [m].
    fn longest(&self, base: f64) -> f64 {
        let ample = match self.specification.objective {
            Objective::Size => f64::INFINITY,
            Objective::LinkSum(size) | Objective::Dexterity(size) | Objective::Measure(_, size) => {
                AMPLE * (size + base)
            }
        };
        self.specification.link_sum.min(ample) - 0.5 * base
    }

    /// A design with the worst points of its area.
    pub(super) fn design(&self, lengths: [f64; 5], placed: Placed) -> Design {
        let tolerance = self.specification.tolerance;
        let worst = self.worst(lengths, placed, Density::Check);
        let (dexterity, by_dexterity) = self.lowest(lengths, placed, |here| here.dexterity.abs());
        let [torque, speed, stiffness, error] = Measure::ALL
            .map(|measure| self.lowest(lengths, placed, |here| measure.merit(here, tolerance)));
        // Negative where the arm changes its assembly mode or does not reach, which but one of the measures may have seen.
        let is_reached = [torque.0, speed.0, stiffness.0, error.0]
            .iter()
            .all(|merit| merit.is_finite());
        let reached = if is_reached { 1.0 } else { -1.0 };
        Design {
            lengths,
            size: placed.size,
            place: placed.place,
            dexterity: worst.dexterity.min(dexterity).min(reached),
            measures: Measures::of_merits([torque.0, speed.0, stiffness.0, error.0]),
            worst_points: WorstPoints {
                dexterity: by_dexterity,
                torque: torque.1,
                speed: speed.1,
                stiffness: stiffness.1,
                error: error.1,
            },
            load: self.load(lengths, placed, Density::Check),
        }
    }

    /// The lowest value in an area, −∞ where the arm does not reach, and where it is, as C from A [m].
    fn lowest(
        &self,
        lengths: [f64; 5],
        area: Placed,
        value: impl Fn(&Condition) -> f64,
    ) -> (f64, [f64; 2]) {
        let middle = Vector2::new(0.5 * lengths[4], 0.0);
        let point = |sample| middle + self.check.at(sample, area);
        let value_at = |sample| match condition(lengths, point(sample)) {
            Ok(here) => value(&here),
            Err(_) => f64::NEG_INFINITY,
        };
        let mut lowest = (f64::INFINITY, [0.0; 2]);
        for start in self.check.lowest(lengths[4], value_at) {
            let sample = self.check.lowest_near(Density::Check, start, value_at);
            let value = value_at(sample);
            if value < lowest.0 {
                lowest = (value, point(sample).into());
            }
        }
        lowest
    }

    /// The measure that is sought, if it is one.
    fn measure(&self) -> Option<Measure> {
        match self.specification.objective {
            Objective::Measure(measure, _) => Some(measure),
            _ => None,
        }
    }

    /// Whether the links' sum is one of the numbers that the search varies: the longest arm need not be the best.
    fn seeks_sum(&self) -> bool {
        self.measure().is_some() || self.specification.payload.is_some()
    }

    fn candidate(&self, point: &[f64]) -> Candidate {
        let (sum, point) = match (self.seeks_sum(), point.split_last()) {
            (true, Some((&sum, point))) => (sum, point),
            _ => (1.0, point),
        };
        let [low, high] = self.specification.base;
        let crank = |x: f64| 1.0 - LONGEST_SHARE + x * (2.0 * LONGEST_SHARE - 1.0);
        let base = low + point[0] * (high - low);
        let place = self.place(&point[2..]);
        let Some(&[crank4, ratio]) = point.get(4..) else {
            return Candidate {
                base,
                cranks: [crank(point[1]); 2],
                legs: [1.0; 2],
                sum,
                place,
            };
        };
        let ratio = 4.0_f64.powf(ratio - 0.5);
        Candidate {
            base,
            cranks: [crank(point[1]), crank(crank4)],
            legs: [(1.0 / ratio).min(1.0), ratio.min(1.0)],
            sum,
            place,
        }
    }

    /// The place by the legs' sum, of numbers 0…1. Areas lie in front of the base, a ring about its
    /// middle, the area of a symmetric arm on its axis.
    pub(super) fn place(&self, point: &[f64]) -> [f64; 2] {
        let both = |x: f64| 2.0 * x - 1.0;
        match (&self.specification.area, point) {
            (Area::Annulus, &[y, ..]) => [0.0, y],
            (_, &[y, x, ..]) => [both(x), y],
            (_, &[y]) => [0.0, y],
            _ => [0.0; 2],
        }
    }

    /// The score of a candidate, with its links' sum and its area's size [m] where it meets the
    /// requirements; −∞ if the score is below the floor.
    fn scale(
        &self,
        candidate: &Candidate,
        density: Density,
        floor: f64,
    ) -> (f64, Option<(f64, f64)>) {
        let half_base = 0.5 * candidate.base;
        let placed = |sum: f64, size: f64| {
            let place = candidate.place(sum);
            (candidate.lengths(sum), Placed { size, place })
        };
        let margin = |sum: f64, size: f64| {
            let (lengths, placed) = placed(sum, size);
            self.worst(lengths, placed, density).margin
        };
        let is_met = |sum: f64, size: f64| {
            let (lengths, placed) = placed(sum, size);
            self.is_met(lengths, placed, density)
        };
        let most = candidate.sum * self.longest(candidate.base);
        if most <= 0.0 {
            return (NOT_MET - 1.0 + most, None);
        }
        match self.specification.objective {
            Objective::Size => {
                let place = candidate.place(most);
                let (score, size) = self.largest(candidate.lengths(most), place, density, floor);
                (score, size.map(|size| (most, size)))
            }
            Objective::LinkSum(size) => {
                let longest = -floor - half_base;
                if longest <= 0.0 || (longest < most && !is_met(longest, size)) {
                    return (f64::NEG_INFINITY, None);
                }
                let short = margin(most, size);
                if short < 0.0 {
                    return (NOT_MET + short, None);
                }
                let sum = bisected([most, 0.0], density, |sum| is_met(sum, size));
                (-sum - half_base, Some((sum, size)))
            }
            Objective::Dexterity(size) => match margin(most, size) {
                margin if margin >= 0.0 => (margin, Some((most, size))),
                margin => (NOT_MET + margin, None),
            },
            Objective::Measure(_, size) => {
                let place = candidate.place(most);
                let placed = Placed { size, place };
                let worst = self.worst(candidate.lengths(most), placed, density);
                match worst.margin >= 0.0 {
                    true => (worst.merit, Some((most, size))),
                    false => (NOT_MET + worst.margin, None),
                }
            }
        }
    }

    /// The score and the size of the largest area of an arm at a place; −∞ if it is smaller than the floor.
    pub(super) fn largest(
        &self,
        lengths: [f64; 5],
        place: [f64; 2],
        density: Density,
        floor: f64,
    ) -> (f64, Option<f64>) {
        let is_met = |size: f64| self.is_met(lengths, Placed { size, place }, density);
        // One look rejects most trials. Those that pass are bisected from 0 all the same: near an optimum the samples
        // of a few sizes miss what those of others see.
        if floor > 0.0 && !is_met(floor) {
            return (f64::NEG_INFINITY, None);
        }
        let short = self
            .worst(lengths, Placed { size: 0.0, place }, density)
            .margin;
        if short < 0.0 {
            return (NOT_MET + short, None);
        }
        let reach = 2.0 * (lengths[0] + lengths[1]);
        let size = bisected([0.0, reach], density, is_met);
        (size, Some(size))
    }

    /// The least of what is required over the area's samples. The arm stays in one assembly mode: that
    /// in which it meets more.
    pub(super) fn worst(&self, lengths: [f64; 5], area: Placed, density: Density) -> Worst {
        let worst = self.worst_by(self.measure(), lengths, area, density, Until::All);
        self.with_payload(worst, lengths, area, density)
    }

    /// Whether all requirements are met over the area's samples: whether the margin of [`Problem::worst`] is not
    /// negative.
    pub(super) fn is_met(&self, lengths: [f64; 5], area: Placed, density: Density) -> bool {
        let worst = self.worst_by(None, lengths, area, density, Until::NotMet);
        self.with_payload(worst, lengths, area, density).margin >= 0.0
    }

    pub(super) fn samples(&self, density: Density) -> &Samples {
        match density {
            Density::Search => &self.search,
            Density::Check => &self.check,
        }
    }

    /// As [`Problem::worst`], with this measure in place of the one that is sought.
    fn worst_by(
        &self,
        measure: Option<Measure>,
        lengths: [f64; 5],
        area: Placed,
        density: Density,
        until: Until,
    ) -> Worst {
        self.evaluations.fetch_add(1, Ordering::Relaxed);
        let samples = self.samples(density);
        let required = self.dexterity
            + match density {
                Density::Search => SLACK,
                Density::Check => 0.0,
            };
        let base = lengths[4];
        let middle = Vector2::new(0.5 * base, 0.0);
        let tolerance = self.specification.tolerance;
        let at = |sample: [f64; 2]| match condition(lengths, middle + samples.at(sample, area)) {
            Ok(here) => [1.0, -1.0].map(|sign| {
                let cranks = self.specification.cranks;
                let by_cranks = cranks.map_or(f64::INFINITY, |range| range.margin(&here));
                let merit = measure.map(|measure| measure.merit(&here, tolerance));
                let dexterity = sign * here.dexterity;
                let sine = (sign * here.sine).min(here.elbow_sine);
                let by_sine = match self.specification.sine {
                    0.0 => f64::INFINITY,
                    least => sine - least,
                };
                let margin = (dexterity - required).min(by_sine).min(by_cranks);
                Worst {
                    margin,
                    dexterity,
                    merit: merit.unwrap_or(f64::INFINITY),
                }
            }),
            Err(beyond) => {
                [Worst {
                    margin: -required.max(self.specification.sine) - beyond,
                    dexterity: -beyond,
                    merit: f64::NEG_INFINITY,
                }; 2]
            }
        };
        // Where the margin is the least, and where the merit is.
        let mut worst = [([[0.0; 2]; 2], Worst::NONE); 2];
        for &sample in samples.points(base) {
            for ((places, worst), here) in worst.iter_mut().zip(at(sample)) {
                if here.margin < worst.margin {
                    places[0] = sample;
                }
                if here.merit < worst.merit {
                    places[1] = sample;
                }
                *worst = worst.and(here);
            }
            let is_refused = || worst.iter().all(|(_, worst)| worst.margin < 0.0);
            if until == Until::NotMet && is_refused() {
                break;
            }
        }
        let mode = usize::from(worst[0].1.margin < worst[1].1.margin);
        let (places, worst) = worst[mode];
        if worst.margin < 0.0 {
            return worst;
        }
        let lowest = samples.lowest_near(density, places[0], |sample| at(sample)[mode].margin);
        let worst = worst.and(at(lowest)[mode]);
        if measure.is_none() {
            return worst;
        }
        let lowest = samples.lowest_near(density, places[1], |sample| at(sample)[mode].merit);
        worst.and(at(lowest)[mode])
    }

    /// The loss of 1/κ at the worst point per length [1/m].
    pub(super) fn sensitivity(&self, design: &Design) -> [f64; 5] {
        let placed = Placed {
            size: design.size,
            place: design.place,
        };
        let change = CHANGE * design.link_sum();
        std::array::from_fn(|index| {
            let losses = [change, -change].map(|change| {
                let mut lengths = design.lengths;
                // A base of 0 can only grow.
                lengths[index] = (lengths[index] + change).abs();
                design.dexterity - self.worst(lengths, placed, Density::Check).dexterity
            });
            losses[0].max(losses[1]) / change
        })
    }

    pub(super) fn prove(&self, design: &Design) -> Proof {
        let placed = Placed {
            size: design.size,
            place: design.place,
        };
        let Specification { area, cranks, .. } = self.specification;
        proof::prove(design.lengths, area, placed, *cranks)
    }
}

/// The last value towards `to`, from one that is allowed, that is allowed too.
fn bisected([from, to]: [f64; 2], density: Density, allowed: impl Fn(f64) -> bool) -> f64 {
    let steps = match density {
        Density::Search => SEARCH_BISECTIONS,
        Density::Check => CHECK_BISECTIONS,
    };
    let (mut good, mut bad) = (from, to);
    for _ in 0..steps {
        let middle = 0.5 * (good + bad);
        match allowed(middle) {
            true => good = middle,
            false => bad = middle,
        }
    }
    good
}
