//! Tolerance allocation: the cheapest choice of tolerance classes that keeps the scatter
//! within a bound everywhere.
//!
//! To first order the variance at a position is Σ wi si², wi the squared sensitivity to
//! dimension i there and si the standard deviation of its class. The choice is found
//! exactly, by depth-first search that leaves a branch as soon as it cannot be cheaper than
//! the best found, or cannot meet the bound even with the finest classes for the rest.

/// A class of tolerance: how precisely a dimension is made, and at what cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToleranceClass {
    /// The standard deviation of the dimension, in its unit.
    pub deviation: f64,
    /// The cost of making one dimension so.
    pub cost: f64,
}

/// The cheapest choice.
#[derive(Clone, Debug, PartialEq)]
pub struct Allocation {
    /// For each dimension the index of its class.
    pub choice: Vec<usize>,
    /// The total cost.
    pub cost: f64,
    /// The largest variance at any position.
    pub worst_variance: f64,
}

struct BranchAndBound<'a> {
    /// wi at each position (row).
    weights: &'a [Vec<f64>],
    classes: &'a [Vec<ToleranceClass>],
    limit: f64,
    /// For dimension i.. on: the least variance at each position, and the least cost.
    least_variance: Vec<Vec<f64>>,
    least_cost: Vec<f64>,
    best: Option<Allocation>,
}

/// Chooses a class for every dimension so that Σ wi si² ≤ `limit` at every position, at the
/// least cost; none where even the finest classes exceed it.
///
/// `weights` has a row for each position with an entry for each dimension, `classes` a list
/// for each dimension.
///
/// # Panics
/// Where a row of `weights` is shorter than `classes`.
///
/// ```
/// use fivebar_design::accuracy::allocation::{ToleranceClass, allocate};
///
/// // Two lengths of equal influence; 20 µm at a cost of 1, or 10 µm at a cost of 3.
/// let classes = [(20e-6, 1.0), (10e-6, 3.0)];
/// let classes = classes.map(|(deviation, cost)| ToleranceClass { deviation, cost }).to_vec();
/// let classes = [classes.clone(), classes];
/// let weights = [vec![1.0, 1.0]];
/// // √(20² + 10²) = 22.4 µm are allowed, √(20² + 20²) = 28.3 µm are not.
/// let best = allocate(&weights, &classes, (25e-6_f64).powi(2)).ok_or("no choice")?;
/// assert_eq!(best.cost, 4.0);
/// assert!(allocate(&weights, &classes, (10e-6_f64).powi(2)).is_none());
/// # Ok::<(), &str>(())
/// ```
pub fn allocate(
    weights: &[Vec<f64>],
    classes: &[Vec<ToleranceClass>],
    limit: f64,
) -> Option<Allocation> {
    let dimensions = classes.len();
    let mut least_variance = vec![vec![0.0; weights.len()]; dimensions + 1];
    let mut least_cost = vec![0.0; dimensions + 1];
    for i in (0..dimensions).rev() {
        let finest = classes[i]
            .iter()
            .map(|c| c.deviation)
            .fold(f64::INFINITY, f64::min);
        let cheapest = classes[i]
            .iter()
            .map(|c| c.cost)
            .fold(f64::INFINITY, f64::min);
        least_cost[i] = least_cost[i + 1] + cheapest;
        for (position, row) in weights.iter().enumerate() {
            least_variance[i][position] =
                least_variance[i + 1][position] + row[i] * finest * finest;
        }
    }
    let mut search = BranchAndBound {
        weights,
        classes,
        limit,
        least_variance,
        least_cost,
        best: None,
    };
    search.descend(
        &mut Vec::with_capacity(dimensions),
        0.0,
        &vec![0.0; weights.len()],
    );
    search.best
}

impl BranchAndBound<'_> {
    fn descend(&mut self, choice: &mut Vec<usize>, cost: f64, variance: &[f64]) {
        let dimension = choice.len();
        let infeasible = variance
            .iter()
            .zip(&self.least_variance[dimension])
            .any(|(so_far, rest)| so_far + rest > self.limit);
        let too_expensive = |best: &Allocation| cost + self.least_cost[dimension] >= best.cost;
        if infeasible || self.best.as_ref().is_some_and(too_expensive) {
            return;
        }
        if dimension == self.classes.len() {
            self.best = Some(Allocation {
                choice: choice.clone(),
                cost,
                worst_variance: variance.iter().copied().fold(0.0, f64::max),
            });
            return;
        }
        for index in 0..self.classes[dimension].len() {
            let class = self.classes[dimension][index];
            let square = class.deviation * class.deviation;
            let with: Vec<f64> = variance
                .iter()
                .zip(self.weights)
                .map(|(so_far, row)| so_far + row[dimension] * square)
                .collect();
            choice.push(index);
            self.descend(choice, cost + class.cost, &with);
            choice.pop();
        }
    }
}
