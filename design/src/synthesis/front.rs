//! Which least 1/κ each design of a front requires: those with which the designs together dominate the most.
//!
//! A design of value v with 1/κ = k dominates all that have less of both. The designs i = 1…n of a front, k rising and v
//! falling, together dominate Σ vᵢ (kᵢ − kᵢ₋₁), k₀ = 0. How v falls depends on the area and the base: near 1 an area on
//! an arm with coaxial cranks falls as √(1 − k), others as 1 − k. So a few coarse searches show it first. Between them,
//! and beyond the last one, v is taken as a power of r, k = 1 − (1 − k₁) r^1.5.

/// Coarse searches.
const KNOTS: usize = 4;
/// Places of designs.
const PLACES: usize = 600;

/// Designs of a front that may stand there: their least 1/κ with their value, less and less.
struct Curve(Vec<(f64, f64)>);

/// The least 1/κ of the coarse searches for a front from this one on.
pub(super) fn knots(least: f64) -> [f64; KNOTS] {
    std::array::from_fn(|knot| dexterity(least, 1.0 - knot as f64 / KNOTS as f64))
}

/// The least 1/κ of so many designs, the first of them `least`, from the values at the knots; 0 where there is no arm.
pub(super) fn spaced(least: f64, count: usize, values: [f64; KNOTS]) -> Vec<f64> {
    if values.iter().all(|&value| value <= 0.0) {
        let rest = |design: usize| 1.0 - design as f64 / count as f64;
        return (0..count).map(|i| dexterity(least, rest(i))).collect();
    }
    Curve::new(least, values).choice(count)
}

fn dexterity(least: f64, rest: f64) -> f64 {
    1.0 - (1.0 - least) * rest * rest.sqrt()
}

/// The value at a place between knots, or beyond the last one as between those before it.
fn value(values: &[f64; KNOTS], rest: f64) -> f64 {
    let knot = (((1.0 - rest) * KNOTS as f64) as usize).min(KNOTS - 2);
    let [from, to] = [knot, knot + 1].map(|knot| 1.0 - knot as f64 / KNOTS as f64);
    let [first, last] = [values[knot], values[knot + 1]];
    if last <= 0.0 {
        // The front ends before the next knot.
        return first * ((rest - to) / (from - to)).max(0.0);
    }
    first * (rest / from).powf((last / first).ln() / (to / from).ln())
}

impl Curve {
    fn new(least: f64, mut values: [f64; KNOTS]) -> Self {
        // An arm for more dexterity is one for less.
        for knot in (1..KNOTS).rev() {
            values[knot - 1] = values[knot - 1].max(values[knot]);
        }
        let at = |place: usize| {
            let rest = 1.0 - place as f64 / PLACES as f64;
            (dexterity(least, rest), value(&values, rest))
        };
        Self((0..PLACES).map(at).collect())
    }

    /// The choice of so many designs that dominates the most, with the first one: exact, by dynamic programming.
    fn choice(&self, count: usize) -> Vec<f64> {
        let Self(points) = self;
        // The most that a choice dominates whose last design is this one, and the design before it.
        let mut most = vec![f64::NEG_INFINITY; points.len()];
        most[0] = points[0].0 * points[0].1;
        let mut before = Vec::new();
        for _ in 1..count {
            let last = |to: usize| {
                let (k, value) = points[to];
                let with = |from: usize| (most[from] + value * (k - points[from].0), from);
                let better = |a: (f64, usize), b: (f64, usize)| if b.0 > a.0 { b } else { a };
                (0..to).map(with).fold((f64::NEG_INFINITY, 0), better)
            };
            let (next, from): (_, Vec<usize>) = (0..points.len()).map(last).unzip();
            most = next;
            before.push(from);
        }
        let better = |a: usize, b: usize| if most[b] > most[a] { b } else { a };
        let mut chosen = vec![(0..points.len()).fold(0, better)];
        for from in before.iter().rev() {
            chosen.push(from[chosen[chosen.len() - 1]]);
        }
        chosen.iter().rev().map(|&i| points[i].0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{KNOTS, knots, spaced};

    /// What designs with these least 1/κ dominate, where their value is this function of it.
    fn dominated(dexterities: &[f64], value: impl Fn(f64) -> f64) -> f64 {
        let mut below = 0.0;
        let of = |&k: &f64| value(k) * (k - std::mem::replace(&mut below, k));
        dexterities.iter().map(of).sum()
    }

    /// Rules that know nothing of the front: even steps of r to this power.
    fn by_rule(count: usize, power: f64) -> Vec<f64> {
        let rest = |i: usize| 1.0 - i as f64 / count as f64;
        let dexterity = |i: usize| 1.0 - 0.5 * rest(i).powf(power);
        (0..count).map(dexterity).collect()
    }

    #[test]
    fn designs_dominate_more_than_those_of_a_rule_whatever_the_front_is() {
        let fronts: [fn(f64) -> f64; 4] = [
            |k| (1.0 - k).sqrt(),
            |k| 1.0 - k,
            |k| (1.0 - k).powi(3),
            |k| (0.9 - k).max(0.0).powf(0.3),
        ];
        for value in fronts {
            let values = knots(0.5).map(value);
            for count in [2, 5, 30, 100] {
                let ours = spaced(0.5, count, values);
                assert_eq!((ours.len(), ours[0]), (count, 0.5));
                assert!(
                    ours.is_sorted_by(|a, b| a < b) && ours[count - 1] < 1.0,
                    "{ours:?}"
                );
                for power in [1.0, 1.5, 2.0, 3.0] {
                    let (ours, rule) = (
                        dominated(&ours, value),
                        dominated(&by_rule(count, power), value),
                    );
                    assert!(ours > rule - 5e-5, "{count} {power}: {ours} {rule}");
                }
            }
        }
    }

    #[test]
    fn a_front_that_no_coarse_search_has_seen_is_spaced_by_a_rule() {
        for (found, by_rule) in spaced(0.5, 5, [0.0; KNOTS]).iter().zip(by_rule(5, 1.5)) {
            assert!((found - by_rule).abs() < 1e-12, "{found} {by_rule}");
        }
    }
}
