//! Differential evolution in the unit cube: each generation mixes every candidate with one of the
//! best and with the difference of two others, and keeps the better of both.
//!
//! A trial that is worse than the candidate that it would replace needs no exact score: `score` gets that candidate's
//! score as a floor, and may answer −∞ below it.
//!
//! All random numbers are drawn before the scores are computed, in parallel: the result depends on the
//! seed alone.

use super::problem::is_met;
use crate::Noise;
use rayon::prelude::*;

/// Candidates for each dimension.
const CANDIDATES: usize = 16;
/// The share of the population whose members count as the best.
const BEST: f64 = 0.15;
/// The share of a candidate's numbers that are mixed.
const CROSSOVER: f64 = 0.9;
/// The least and greatest weight of a difference.
const WEIGHT: [f64; 2] = [0.4, 0.9];
/// The search ends where the scores of all candidates, which meet the requirements, agree to this share.
const AGREEMENT: f64 = 1e-7;

/// The point of the unit cube with the greatest score that was found within `generations`. `observe` receives the
/// points of each generation with their scores. No generation begins when `may_go_on` denies it.
pub(super) fn maximise(
    dimensions: usize,
    generations: usize,
    seed: u64,
    may_go_on: impl Fn() -> bool,
    score: impl Fn(&[f64], f64) -> f64 + Sync,
    mut observe: impl FnMut(&[(Vec<f64>, f64)]),
) -> (Vec<f64>, f64) {
    let mut noise = Noise::new(seed);
    let count = CANDIDATES * dimensions.max(2);
    let points: Vec<Vec<f64>> = (0..count)
        .map(|_| (0..dimensions).map(|_| noise.uniform()).collect())
        .collect();
    let mut population: Vec<(Vec<f64>, f64)> = points
        .into_par_iter()
        .map(|point| {
            let score = score(&point, f64::NEG_INFINITY);
            (point, score)
        })
        .collect();
    observe(&population);
    let sort = |population: &mut Vec<(Vec<f64>, f64)>| {
        population.sort_by(|a, b| b.1.total_cmp(&a.1));
    };
    sort(&mut population);
    for _ in 0..generations {
        if !may_go_on() {
            break;
        }
        let trials: Vec<Vec<f64>> = (0..count)
            .map(|index| trial(&population, index, &mut noise))
            .collect();
        let scored: Vec<(Vec<f64>, f64)> = trials
            .into_par_iter()
            .zip(&population)
            .map(|(point, (_, floor))| {
                let score = score(&point, *floor);
                (point, score)
            })
            .collect();
        observe(&scored);
        for (old, new) in population.iter_mut().zip(scored) {
            if new.1 >= old.1 {
                *old = new;
            }
        }
        sort(&mut population);
        let (best, worst) = (population[0].1, population[count - 1].1);
        if is_met(best) && best - worst <= AGREEMENT * best.abs() {
            break;
        }
    }
    population.swap_remove(0)
}

fn trial(population: &[(Vec<f64>, f64)], index: usize, noise: &mut Noise) -> Vec<f64> {
    let count = population.len();
    let mut any = |of: usize| ((noise.uniform() * of as f64) as usize).min(of - 1);
    let best = &population[any((BEST * count as f64).ceil() as usize)].0;
    let (a, b) = (&population[any(count)].0, &population[any(count)].0);
    let own = &population[index].0;
    let always = any(own.len());
    let weight = WEIGHT[0] + (WEIGHT[1] - WEIGHT[0]) * noise.uniform();
    (0..own.len())
        .map(|i| {
            if noise.uniform() > CROSSOVER && i != always {
                return own[i];
            }
            let mixed = own[i] + weight * (best[i] - own[i]) + weight * (a[i] - b[i]);
            // Onto the boundary, where constraints on lengths often hold.
            mixed.clamp(0.0, 1.0)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::problem::NOT_MET;
    use super::maximise;

    #[test]
    fn it_finds_a_peak_on_a_face_of_the_cube() {
        let score =
            |x: &[f64], _: f64| -(x[0] + 0.2).powi(2) - (x[1] - 0.3).powi(2) - (x[2] - x[1]).abs();
        let (point, _) = maximise(3, 300, 1, || true, score, |_| ());
        for (found, expected) in point.iter().zip([0.0, 0.3, 0.3]) {
            assert!((found - expected).abs() < 1e-3, "{point:?}");
        }
    }

    #[test]
    fn it_goes_on_while_all_candidates_fall_short_by_nearly_the_same() {
        let score = |x: &[f64], _: f64| {
            let off = (x[0] - 0.3).abs() + (x[1] - 0.6).abs();
            if off < 1e-4 {
                1.0 - off
            } else {
                NOT_MET - 0.05 * off
            }
        };
        let (point, found) = maximise(2, 100, 1, || true, score, |_| ());
        assert!(found > 0.0, "{point:?} {found}");
    }

    #[test]
    fn the_result_is_that_of_the_seed_on_any_number_of_threads() {
        let score = |x: &[f64], _: f64| -x.iter().map(|x| (x - 0.4).powi(2)).sum::<f64>();
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.unwrap()
                .install(|| maximise(4, 40, 7, || true, score, |_| ()))
        };
        assert_eq!(on(1), on(3));
        assert_ne!(on(1), maximise(4, 40, 8, || true, score, |_| ()));
    }
}
