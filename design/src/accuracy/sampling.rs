//! Monte Carlo sampling on all cores. The results do not depend on the number of cores.
//!
//! The samples are drawn in blocks. Each block has its own stream of pseudo-random numbers,
//! from the seed and the block's number; the blocks are summed in their order.

use crate::Noise;
use crate::noise::stream;
use rayon::prelude::*;

/// Samples in a block.
const BLOCK: usize = 4096;

/// Number and seed of the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// The number of samples.
    pub samples: usize,
    /// Any number; the same number gives the same samples.
    pub seed: u64,
}

/// Called with the number of samples of each block of at most 4096 when it is finished.
pub type Progress<'a> = &'a (dyn Fn(u64) + Sync);

/// Statistics that are accumulated over samples.
pub(super) trait Accumulator: Default + Send {
    /// The values of one sample.
    type Values;

    /// Adds a sample.
    fn add(&mut self, values: &Self::Values);
    /// Counts a sample that could not be assembled.
    fn fail(&mut self);
    /// The statistics of both sets of samples together (Chan's update, exact up to rounding).
    #[must_use]
    fn merge(self, other: &Self) -> Self;
}

/// Means and covariances over samples of N results.
#[derive(Clone, Debug, PartialEq)]
pub struct Moments<const N: usize> {
    /// Number of samples with results.
    pub count: usize,
    /// Number of samples that could not be assembled.
    pub failed: usize,
    /// The means.
    pub mean: [f64; N],
    /// Σ (x − mean)(y − mean).
    products: [[f64; N]; N],
    /// The largest |x|.
    pub largest: [f64; N],
}

impl<const N: usize> Default for Moments<N> {
    fn default() -> Self {
        Self {
            count: 0,
            failed: 0,
            mean: [0.0; N],
            products: [[0.0; N]; N],
            largest: [0.0; N],
        }
    }
}

impl<const N: usize> Accumulator for Moments<N> {
    type Values = [f64; N];

    fn add(&mut self, values: &[f64; N]) {
        self.count += 1;
        let before: [f64; N] = core::array::from_fn(|i| values[i] - self.mean[i]);
        for i in 0..N {
            self.mean[i] += before[i] / self.count as f64;
            self.largest[i] = self.largest[i].max(values[i].abs());
        }
        let after: [f64; N] = core::array::from_fn(|i| values[i] - self.mean[i]);
        for (row, before) in self.products.iter_mut().zip(before) {
            for (product, after) in row.iter_mut().zip(after) {
                *product += before * after;
            }
        }
    }

    fn fail(&mut self) {
        self.failed += 1;
    }

    fn merge(mut self, other: &Self) -> Self {
        self.failed += other.failed;
        if other.count == 0 {
            return self;
        }
        let (n, m) = (self.count as f64, other.count as f64);
        let shift: [f64; N] = core::array::from_fn(|i| other.mean[i] - self.mean[i]);
        for i in 0..N {
            for j in 0..N {
                self.products[i][j] += other.products[i][j] + shift[i] * shift[j] * n * m / (n + m);
            }
            self.largest[i] = self.largest[i].max(other.largest[i]);
        }
        for (mean, shift) in self.mean.iter_mut().zip(shift) {
            *mean += shift * m / (n + m);
        }
        self.count += other.count;
        self
    }
}

/// Two kinds of results of the same samples.
impl<A: Accumulator, B: Accumulator> Accumulator for (A, B) {
    type Values = (A::Values, B::Values);

    fn add(&mut self, (a, b): &Self::Values) {
        self.0.add(a);
        self.1.add(b);
    }

    fn fail(&mut self) {
        self.0.fail();
        self.1.fail();
    }

    fn merge(self, other: &Self) -> Self {
        (self.0.merge(&other.0), self.1.merge(&other.1))
    }
}

impl<const N: usize> Moments<N> {
    /// The covariance of results `i` and `j`.
    pub fn covariance(&self, i: usize, j: usize) -> f64 {
        if self.count > 1 {
            self.products[i][j] / (self.count - 1) as f64
        } else {
            0.0
        }
    }

    /// The standard deviation of result `i`.
    pub fn deviation(&self, i: usize) -> f64 {
        self.covariance(i, i).sqrt()
    }

    /// √⟨x²⟩ of result `i`.
    pub fn rms(&self, i: usize) -> f64 {
        let count = self.count.max(1) as f64;
        (self.products[i][i] / count + self.mean[i] * self.mean[i]).sqrt()
    }

    /// All of it as numbers, for other processes.
    pub(super) fn write(&self, numbers: &mut Vec<f64>) {
        numbers.extend([self.count as f64, self.failed as f64]);
        numbers.extend(self.mean);
        numbers.extend(self.products.iter().flatten());
        numbers.extend(self.largest);
    }

    /// Takes what [`Moments::write`] wrote; none if the numbers end too early.
    pub(super) fn read(numbers: &mut impl Iterator<Item = f64>) -> Option<Self> {
        // Counts of samples are exact as `f64`.
        let [count, failed] = [numbers.next()?, numbers.next()?].map(|count| count as usize);
        let mut row = || {
            let mut row = [0.0; N];
            for number in &mut row {
                *number = numbers.next()?;
            }
            Some(row)
        };
        let mean = row()?;
        let mut products = [[0.0; N]; N];
        for product in &mut products {
            *product = row()?;
        }
        let largest = row()?;
        Some(Self {
            count,
            failed,
            mean,
            products,
            largest,
        })
    }

    /// The relative sampling error of a standard deviation: 1/√(2n) for normal results.
    pub fn relative_error(&self) -> f64 {
        relative_error(self.count)
    }
}

fn relative_error(count: usize) -> f64 {
    1.0 / (2.0 * count.max(1) as f64).sqrt()
}

/// Means and standard deviations over samples of any number of results.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Deviations {
    /// Number of samples with results.
    pub count: usize,
    /// Number of samples that could not be assembled.
    pub failed: usize,
    /// The means.
    pub mean: Vec<f64>,
    /// Σ (x − mean)².
    squares: Vec<f64>,
}

impl Accumulator for Deviations {
    type Values = Vec<f64>;

    fn add(&mut self, values: &Vec<f64>) {
        self.mean.resize(values.len(), 0.0);
        self.squares.resize(values.len(), 0.0);
        self.count += 1;
        let sums = self.mean.iter_mut().zip(&mut self.squares);
        for ((mean, square), value) in sums.zip(values) {
            let before = value - *mean;
            *mean += before / self.count as f64;
            *square += before * (value - *mean);
        }
    }

    fn fail(&mut self) {
        self.failed += 1;
    }

    fn merge(mut self, other: &Self) -> Self {
        self.failed += other.failed;
        self.mean.resize(other.mean.len().max(self.mean.len()), 0.0);
        self.squares.resize(self.mean.len(), 0.0);
        let (n, m) = (self.count as f64, other.count as f64);
        for (i, (mean, square)) in other.mean.iter().zip(&other.squares).enumerate() {
            let shift = mean - self.mean[i];
            self.squares[i] += square + shift * shift * n * m / (n + m);
            self.mean[i] += shift * m / (n + m);
        }
        self.count += other.count;
        self
    }
}

impl Deviations {
    /// The standard deviation of result `i`; zero if no sample has results.
    pub fn deviation(&self, i: usize) -> f64 {
        let degrees = self.count.saturating_sub(1).max(1) as f64;
        let square = self.squares.get(i).copied().unwrap_or(0.0);
        (square / degrees).sqrt()
    }

    /// The relative sampling error of a standard deviation, for normal results.
    pub fn relative_error(&self) -> f64 {
        relative_error(self.count)
    }
}

impl Sampling {
    /// The number of blocks of samples.
    pub fn blocks(self) -> usize {
        self.samples.div_ceil(BLOCK)
    }
}

/// Accumulates samples of `draw`, which returns none if a sample cannot be assembled. Calls
/// `progress` with the number of samples in each block that is finished.
pub(super) fn sample<M: Accumulator>(
    sampling: Sampling,
    progress: Progress<'_>,
    draw: impl Fn(&mut Noise) -> Option<M::Values> + Sync,
) -> M {
    let sums: Vec<M> = (0..sampling.blocks())
        .into_par_iter()
        .map(|block| sample_block(sampling, block, progress, &draw))
        .collect();
    sums.iter().fold(M::default(), M::merge)
}

/// Accumulates the samples of one block.
pub(super) fn sample_block<M: Accumulator>(
    sampling: Sampling,
    block: usize,
    progress: Progress<'_>,
    draw: impl Fn(&mut Noise) -> Option<M::Values>,
) -> M {
    let size = BLOCK.min(sampling.samples - block * BLOCK);
    let mut noise = Noise::new(stream(sampling.seed, block as u64));
    let mut sums = M::default();
    for _ in 0..size {
        match draw(&mut noise) {
            Some(values) => sums.add(&values),
            None => sums.fail(),
        }
    }
    progress(size as u64);
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scatter(samples: usize, threads: usize) -> Moments<2> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let sampling = Sampling { samples, seed: 7 };
        pool.build().unwrap().install(|| {
            sample(sampling, &|_| (), |noise| {
                let x = 3.0 + 2.0 * noise.normal();
                Some([x, 0.5 * x + noise.normal()])
            })
        })
    }

    #[test]
    fn the_same_seed_gives_the_same_bits_on_any_number_of_threads() {
        assert_eq!(scatter(20_000, 1), scatter(20_000, 3));
    }

    #[test]
    fn deviations_agree_with_moments_over_several_blocks() {
        let moments = scatter(20_000, 2);
        let sampling = Sampling {
            samples: 20_000,
            seed: 7,
        };
        let spread: Deviations = sample(sampling, &|_| (), |noise| {
            let x = 3.0 + 2.0 * noise.normal();
            Some(vec![x, 0.5 * x + noise.normal()])
        });
        for i in 0..2 {
            assert!((spread.mean[i] - moments.mean[i]).abs() < 1e-12);
            assert!((spread.deviation(i) / moments.deviation(i) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn moments_are_those_of_the_sampled_distribution() {
        let moments = scatter(100_000, 2);
        assert_eq!(moments.count, 100_000);
        let error = 4.0 * moments.relative_error();
        assert!((moments.mean[0] - 3.0).abs() < 4.0 * 2.0 / 100_000_f64.sqrt());
        assert!((moments.deviation(0) / 2.0 - 1.0).abs() < error);
        assert!((moments.deviation(1) / 2_f64.sqrt() - 1.0).abs() < error);
        assert!((moments.covariance(0, 1) / 2.0 - 1.0).abs() < 2.0 * error);
        assert!((moments.rms(0) / 13_f64.sqrt() - 1.0).abs() < error);
    }
}
