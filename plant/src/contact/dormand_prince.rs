//! Integration of a hybrid system with adaptive steps and event location.
//!
//! The method is Dormand and Prince's of order 5(4), with its dense output of order 4
//! (Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, II.4–II.6). If a
//! guard holds at the end of a step, the integrator finds the event by bisection on the
//! dense output, ends the step there, and makes the transition.

use nalgebra::SVector;

/// A system with discrete modes: in each mode one law of motion ẋ = f(x) holds, until an
/// event changes the mode.
pub trait HybridSystem<const N: usize> {
    /// ẋ in the present mode.
    fn rates(&self, x: &SVector<f64, N>) -> SVector<f64, N>;
    /// Whether the present mode ends at `x`.
    fn guard(&self, x: &SVector<f64, N>) -> bool;
    /// Changes the mode at `x`, where [`guard`](Self::guard) holds.
    fn transition(&mut self, x: &SVector<f64, N>);
    /// Records the state `x`, `step` [s] after the one before.
    fn record(&mut self, x: &SVector<f64, N>, step: f64);
}

/// The integrator: its error tolerance and its present step size.
#[derive(Clone, Debug)]
pub struct DormandPrince45<const N: usize> {
    /// Greatest error of each component in one step.
    tolerance: SVector<f64, N>,
    /// Size of the next step [s].
    step: f64,
}

/// Least step size [s], even if the error is too great: 10⁻⁵ of a short impact.
const SHORTEST: f64 = 1e-11;
/// Bisections of an event: they find it to 2⁻³² of the step.
const BISECTIONS: u32 = 32;

// The coefficients: rows of the Runge–Kutta matrix, the weights of the solution (B), of its
// error, and of the dense output.
const A2: [f64; 1] = [1.0 / 5.0];
const A3: [f64; 2] = [3.0 / 40.0, 9.0 / 40.0];
const A4: [f64; 3] = [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0];
const A5: [f64; 4] = [
    19372.0 / 6561.0,
    -25360.0 / 2187.0,
    64448.0 / 6561.0,
    -212.0 / 729.0,
];
const A6: [f64; 5] = [
    9017.0 / 3168.0,
    -355.0 / 33.0,
    46732.0 / 5247.0,
    49.0 / 176.0,
    -5103.0 / 18656.0,
];
const B: [f64; 6] = [
    35.0 / 384.0,
    0.0,
    500.0 / 1113.0,
    125.0 / 192.0,
    -2187.0 / 6784.0,
    11.0 / 84.0,
];
const ERROR: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];
const DENSE: [f64; 7] = [
    -12_715_105_075.0 / 11_282_082_432.0,
    0.0,
    87_487_479_700.0 / 32_700_410_799.0,
    -10_690_763_975.0 / 1_880_347_072.0,
    701_980_252_875.0 / 199_316_789_632.0,
    -1_453_857_185.0 / 822_651_844.0,
    69_997_945.0 / 29_380_423.0,
];

/// One step before it is accepted: its first and last state, and the rates of its stages.
struct TrialStep<const N: usize> {
    x0: SVector<f64, N>,
    x1: SVector<f64, N>,
    k: [SVector<f64, N>; 7],
    h: f64,
}

fn sum<const N: usize>(weights: &[f64], k: &[SVector<f64, N>]) -> SVector<f64, N> {
    let mut total = SVector::<f64, N>::zeros();
    for (weight, k) in weights.iter().zip(k) {
        total.axpy(*weight, k, 1.0);
    }
    total
}

impl<const N: usize> TrialStep<N> {
    /// A step of size `h` from `x0`, where the rates are `k1`.
    fn new(
        system: &impl HybridSystem<N>,
        x0: SVector<f64, N>,
        k1: SVector<f64, N>,
        h: f64,
    ) -> Self {
        let mut k = [k1; 7];
        for (stage, weights) in [&A2[..], &A3, &A4, &A5, &A6].into_iter().enumerate() {
            k[stage + 1] = system.rates(&(x0 + sum(weights, &k) * h));
        }
        let x1 = x0 + sum(&B, &k) * h;
        k[6] = system.rates(&x1);
        Self { x0, x1, k, h }
    }

    /// The greatest ratio of error to tolerance over all components.
    fn error(&self, tolerance: &SVector<f64, N>) -> f64 {
        (sum(&ERROR, &self.k) * self.h)
            .component_div(tolerance)
            .amax()
    }

    /// The state at the fraction `s` of the step, by dense output.
    fn at(&self, s: f64) -> SVector<f64, N> {
        let rise = self.x1 - self.x0;
        let bend = self.k[0] * self.h - rise;
        let twist = rise - self.k[6] * self.h - bend;
        let rest = sum(&DENSE, &self.k) * self.h;
        let r = 1.0 - s;
        self.x0 + (rise + (bend + (twist + rest * r) * s) * r) * s
    }

    /// The fraction of the step at which the guard begins to hold.
    fn event(&self, system: &impl HybridSystem<N>) -> f64 {
        let (mut before, mut after) = (0.0, 1.0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (before + after);
            if system.guard(&self.at(middle)) {
                after = middle;
            } else {
                before = middle;
            }
        }
        after
    }
}

impl<const N: usize> DormandPrince45<N> {
    /// An integrator with this greatest error per step, in each component.
    pub fn new(tolerance: SVector<f64, N>) -> Self {
        Self {
            tolerance,
            step: f64::INFINITY,
        }
    }

    /// Integrates the system over `time` [s].
    pub fn advance(
        &mut self,
        system: &mut impl HybridSystem<N>,
        x: &mut SVector<f64, N>,
        time: f64,
    ) {
        let mut left = time;
        let mut k1 = system.rates(x);
        while left > 0.0 {
            let h = self.step.min(left);
            let trial = TrialStep::new(system, *x, k1, h);
            let error = trial.error(&self.tolerance);
            // This comparison is false for NaN, so that a NaN cannot repeat the step for ever.
            if error > 1.0 && h > SHORTEST {
                self.step = (h * factor(error)).max(SHORTEST);
                continue;
            }
            let is_last = h >= left;
            if system.guard(&trial.x1) {
                let fraction = trial.event(system);
                *x = trial.at(fraction);
                system.record(x, fraction * h);
                system.transition(x);
                k1 = system.rates(x);
                left = if is_last && fraction >= 1.0 {
                    0.0
                } else {
                    left - fraction * h
                };
            } else {
                *x = trial.x1;
                system.record(x, h);
                k1 = trial.k[6];
                left = if is_last { 0.0 } else { left - h };
                // The last step is short only because the time ends: it must not shorten
                // the next.
                if !is_last || factor(error) * h > self.step || self.step.is_infinite() {
                    self.step = h * factor(error);
                }
            }
        }
    }
}

/// Ratio of the next step size to this one.
fn factor(error: f64) -> f64 {
    if error.is_nan() {
        return 1.0;
    }
    (0.9 * libm::pow(error, -0.2)).clamp(0.2, 5.0)
}

#[cfg(test)]
mod tests {
    use super::{DormandPrince45, HybridSystem};
    use nalgebra::{SVector, Vector2};

    /// A ball under a gravity of 10 m/s², thrown up at 5 m/s. State: height and speed. In
    /// mode 1, while it falls, its height changes at half its speed; in mode 2 it rests.
    #[derive(Default)]
    struct Ball {
        mode: u32,
        recorded: f64,
    }

    impl HybridSystem<2> for Ball {
        fn rates(&self, x: &Vector2<f64>) -> Vector2<f64> {
            match self.mode {
                0 => Vector2::new(x.y, -10.0),
                1 => Vector2::new(0.5 * x.y, -10.0),
                _ => Vector2::zeros(),
            }
        }
        fn guard(&self, x: &Vector2<f64>) -> bool {
            match self.mode {
                0 => x.y < 0.0,
                1 => x.x < 0.0,
                _ => false,
            }
        }
        fn transition(&mut self, _: &Vector2<f64>) {
            self.mode += 1;
        }
        fn record(&mut self, _: &Vector2<f64>, step: f64) {
            self.recorded += step;
        }
    }

    #[test]
    fn finds_the_instants_at_which_the_mode_changes() {
        let mut ball = Ball::default();
        let mut x = Vector2::new(0.0, 5.0);
        let mut method = DormandPrince45::new(Vector2::repeat(1e-10));
        // Up for 0.5 s to 1.25 m; down by 2.5 t².
        let fall = 0.5_f64.sqrt();
        method.advance(&mut ball, &mut x, 0.5 + fall - 1e-6);
        assert_eq!(ball.mode, 1);
        method.advance(&mut ball, &mut x, 2e-6);
        assert_eq!(ball.mode, 2);
        assert!((ball.recorded - (0.5 + fall + 1e-6)).abs() < 1e-12);
        assert!((x - Vector2::new(0.0, -10.0 * fall)).amax() < 1e-8, "{x}");
    }

    struct Oscillator;

    impl HybridSystem<2> for Oscillator {
        fn rates(&self, x: &Vector2<f64>) -> Vector2<f64> {
            Vector2::new(x.y, -x.x)
        }
        fn guard(&self, _: &SVector<f64, 2>) -> bool {
            false
        }
        fn transition(&mut self, _: &SVector<f64, 2>) {}
        fn record(&mut self, _: &SVector<f64, 2>, _: f64) {}
    }

    #[test]
    fn its_error_is_of_the_order_of_the_tolerance() {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let mut x = Vector2::new(1.0, 0.0);
            DormandPrince45::new(Vector2::repeat(tolerance)).advance(&mut Oscillator, &mut x, 20.0);
            let error = (x - Vector2::new(20.0_f64.cos(), -20.0_f64.sin())).amax();
            assert!(error < 200.0 * tolerance, "{error:e} for {tolerance:e}");
            assert!(error > 0.0);
        }
    }
}
