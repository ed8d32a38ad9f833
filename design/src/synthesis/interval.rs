//! Intervals that contain every value their operands allow: each operation rounds outwards.

/// Numbers from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Interval {
    pub(super) fn new(a: f64, b: f64) -> Self {
        Self {
            low: a.min(b),
            high: a.max(b),
        }
    }

    /// The interval of these bounds, which are rounded to nearest.
    fn outwards(low: f64, high: f64) -> Self {
        Self {
            low: low.next_down(),
            high: high.next_up(),
        }
    }

    pub(super) fn add(self, other: Self) -> Self {
        Self::outwards(self.low + other.low, self.high + other.high)
    }

    pub(super) fn sub(self, other: Self) -> Self {
        Self::outwards(self.low - other.high, self.high - other.low)
    }

    pub(super) fn mul(self, other: Self) -> Self {
        let products = [
            self.low * other.low,
            self.low * other.high,
            self.high * other.low,
            self.high * other.high,
        ];
        Self::outwards(
            products.into_iter().fold(f64::INFINITY, f64::min),
            products.into_iter().fold(f64::NEG_INFINITY, f64::max),
        )
    }

    /// Divided by an interval of positive numbers.
    pub(super) fn per(self, positive: Self) -> Self {
        debug_assert!(positive.low > 0.0);
        self.mul(Self::outwards(1.0 / positive.high, 1.0 / positive.low))
    }

    pub(super) fn square(self) -> Self {
        let (a, b) = (self.low * self.low, self.high * self.high);
        let contains_zero = self.low <= 0.0 && self.high >= 0.0;
        let square = Self::outwards(a.min(b), a.max(b));
        Self {
            low: if contains_zero {
                0.0
            } else {
                square.low.max(0.0)
            },
            ..square
        }
    }

    /// The square root of its numbers that have one.
    pub(super) fn sqrt(self) -> Self {
        let root = Self::outwards(self.low.max(0.0).sqrt(), self.high.max(0.0).sqrt());
        Self {
            low: root.low.max(0.0),
            ..root
        }
    }

    /// Whether all its numbers are positive; none if it contains 0.
    pub(super) fn sign(self) -> Option<bool> {
        if self.low > 0.0 {
            Some(true)
        } else if self.high < 0.0 {
            Some(false)
        } else {
            None
        }
    }

    pub(super) fn width(self) -> f64 {
        self.high - self.low
    }

    pub(super) fn middle(self) -> f64 {
        0.5 * (self.low + self.high)
    }
}

impl From<f64> for Interval {
    fn from(number: f64) -> Self {
        Self::new(number, number)
    }
}

#[cfg(test)]
mod tests {
    use super::Interval;
    use crate::Noise;

    #[test]
    fn every_operation_contains_the_results_of_its_numbers() {
        let mut noise = Noise::new(3);
        for _ in 0..10_000 {
            let mut interval = || Interval::new(noise.normal(), noise.normal());
            let (a, b) = (interval(), interval());
            let mut within = |i: Interval| i.low + (i.high - i.low) * noise.uniform();
            let (x, y) = (within(a), within(b));
            let contains = |i: Interval, number: f64| i.low <= number && number <= i.high;
            assert!(contains(a.add(b), x + y));
            assert!(contains(a.sub(b), x - y));
            assert!(contains(a.mul(b), x * y));
            assert!(contains(a.square(), x * x));
            assert!(contains(a.square().sqrt(), x.abs()));
            let positive = b.square().add(0.1.into());
            assert!(contains(a.per(positive), x / (y * y + 0.1)));
        }
    }

    #[test]
    fn a_sum_that_is_rounded_still_contains_the_exact_one() {
        let sum = Interval::from(1.0).add(1e-20.into());
        assert!(sum.low <= 1.0 && sum.high > 1.0);
        assert_eq!(Interval::new(-1.0, 2.0).square().low, 0.0);
        assert_eq!(Interval::new(-1.0, 2.0).sign(), None);
    }
}
