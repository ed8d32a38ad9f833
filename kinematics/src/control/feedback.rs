//! The position loop of one joint: α = αd + Kd ė + Kp e + ∫ Ki e dt.
//!
//! Inverse dynamics turns α into torque, so to this law each joint is 1/s² behind the lag
//! d of the current loop, and its characteristic equation is
//! s² + (Kd s + Kp) e^(−sd) = 0. With e^(−sd) ≈ 1 − sd this is of second order and its
//! roots are those of s² + 2ζω s + ω² when
//!
//! m = 1 / (1 + 2ζωd + ω²d²), Kp = m ω², Kd = m (2ζω + ω²d).
//!
//! d = 0 gives the textbook's ω² and 2ζω. The error of the true roots is of the order of
//! (ωd)².
//!
//! The integral acts at the rate ωi: Ki = Kp ωi. While the torque is limited it is only
//! allowed to unwind: an error that would wind it further is not taken in.

use crate::Scalar;

/// Gains of the position loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedbackGains<S> {
    kp: S,
    kd: S,
    ki_period: S,
}

/// The integral's share of the acceleration demand [rad/s²].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integral<S>(pub S);

impl<S: Scalar> FeedbackGains<S> {
    /// Gains for the bandwidth ω [rad/s] and damping ratio ζ behind a lag [s], with the
    /// integral rate ωi [rad/s] at the tick period T [s].
    pub fn new(bandwidth: S, damping: S, lag: S, integral_rate: S, period: S) -> Self {
        let square = bandwidth * bandwidth;
        let twice = S::TWO * damping * bandwidth;
        let m = S::ONE / (S::ONE + twice * lag + square * lag * lag);
        let kp = m * square;
        Self {
            kp,
            kd: m * (twice + square * lag),
            ki_period: kp * integral_rate * period,
        }
    }

    /// Kp [1/s²].
    #[inline]
    pub fn kp(&self) -> S {
        self.kp
    }

    /// Kd [1/s].
    #[inline]
    pub fn kd(&self) -> S {
        self.kd
    }

    /// The demanded acceleration [rad/s²] for the desired one `alpha` [rad/s²], the error
    /// e = θd − θ [rad] and its rate ė = ωd − ω [rad/s].
    #[inline]
    pub fn acceleration(&self, integral: Integral<S>, alpha: S, error: S, error_rate: S) -> S {
        alpha + self.kd * error_rate + self.kp * error + integral.0
    }

    /// Takes one tick's error [rad] into the integral. `limited` tells that the demand
    /// was cut; the integral then only takes in what brings it nearer to zero.
    #[inline]
    pub fn integrate(&self, integral: &mut Integral<S>, error: S, limited: bool) {
        if !limited || integral.0 * error < S::ZERO {
            integral.0 = integral.0 + self.ki_period * error;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const T: f64 = 1e-4;

    /// A unit double integrator whose acceleration acts `lag` ticks late.
    fn run(gains: &FeedbackGains<f64>, lag: usize, disturbance: f64, limit: f64) -> [f64; 4000] {
        let (mut x, mut v, mut integral) = (1.0, 0.0, Integral(0.0));
        let mut line = [0.0_f64; 64];
        core::array::from_fn(|k| {
            let demand = gains.acceleration(integral, 0.0, -x, -v);
            let cut = demand.clamp(-limit, limit);
            gains.integrate(&mut integral, -x, cut != demand);
            line[k % 64] = cut;
            let acting = if k >= lag { line[(k - lag) % 64] } else { 0.0 } + disturbance;
            x += T * (v + 0.5 * T * acting);
            v += T * acting;
            x
        })
    }

    #[test]
    fn without_lag_the_gains_are_the_textbooks() {
        let gains = FeedbackGains::new(200.0, 0.7, 0.0, 0.0, T);
        assert_eq!(gains.kp(), 200.0 * 200.0);
        assert_eq!(gains.kd(), 2.0 * 0.7 * 200.0);
    }

    proptest! {
        #[test]
        fn closed_loop_poles_lie_where_asked(
            bandwidth in 50.0..400.0_f64,
            damping in 0.4..0.95_f64,
            product in 0.0..0.15_f64,
        ) {
            let lag = product / bandwidth;
            let gains = FeedbackGains::new(bandwidth, damping, lag, 0.0, T);
            // Newton's method on s² + (Kd s + Kp) e^(−sd) from the wanted pole.
            let wanted = [
                -damping * bandwidth,
                bandwidth * libm::sqrt(1.0 - damping * damping),
            ];
            let mul = |a: [f64; 2], b: [f64; 2]| {
                [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
            };
            let mut s = wanted;
            for _ in 0..30 {
                let scale = libm::exp(-s[0] * lag);
                let delay = [scale * libm::cos(s[1] * lag), -scale * libm::sin(s[1] * lag)];
                let pd = [gains.kd() * s[0] + gains.kp(), gains.kd() * s[1]];
                let (ss, late) = (mul(s, s), mul(pd, delay));
                let f = [ss[0] + late[0], ss[1] + late[1]];
                let inner = [gains.kd() - lag * pd[0], -lag * pd[1]];
                let slope = mul(inner, delay);
                let df = [2.0 * s[0] + slope[0], 2.0 * s[1] + slope[1]];
                let norm = df[0] * df[0] + df[1] * df[1];
                let step = mul(f, [df[0] / norm, -df[1] / norm]);
                s = [s[0] - step[0], s[1] - step[1]];
            }
            let off = libm::hypot(s[0] - wanted[0], s[1] - wanted[1]) / bandwidth;
            prop_assert!(off <= 1.5 * product * product + 1e-9, "{off} at ωd = {product}");
        }
    }

    #[test]
    fn a_loop_designed_with_its_lag_overshoots_as_damping_says() {
        let damping = 0.6;
        let overshoot = |lag: f64| {
            let gains = FeedbackGains::new(200.0, damping, lag, 0.0, T);
            -run(&gains, 10, 0.0, f64::MAX)
                .iter()
                .fold(0.0_f64, |m, &x| m.min(x))
        };
        let expected =
            libm::exp(-core::f64::consts::PI * damping / libm::sqrt(1.0 - damping * damping));
        // Ten ticks late, and half a tick for the hold.
        let aware = overshoot(10.5 * T);
        assert!((aware - expected).abs() < 0.01, "{aware} for {expected}");
        let unaware = overshoot(0.0);
        assert!(
            (unaware - expected).abs() > 0.02,
            "{unaware} for {expected}"
        );
    }

    #[test]
    fn integral_action_removes_a_constant_disturbance() {
        let with = run(
            &FeedbackGains::new(200.0, 1.0, 0.0, 50.0, T),
            0,
            50.0,
            f64::MAX,
        );
        let without = run(
            &FeedbackGains::new(200.0, 1.0, 0.0, 0.0, T),
            0,
            50.0,
            f64::MAX,
        );
        assert!((without[3999] - 50.0 / 4e4).abs() < 1e-5);
        assert!(with[3999].abs() < 2e-6, "{}", with[3999]);
    }

    #[test]
    fn integral_does_not_wind_up_while_limited() {
        // A demand far beyond the limit for a long time, then release: no large overshoot.
        let gains = FeedbackGains::new(200.0, 1.0, 0.0, 40.0, T);
        let mut integral = Integral(0.0);
        for _ in 0..10_000 {
            gains.integrate(&mut integral, 0.1, true);
        }
        assert_eq!(integral, Integral(0.0));
        integral = Integral(3.0);
        gains.integrate(&mut integral, -0.1, true);
        assert!(integral.0 < 3.0);
        integral = Integral(3.0);
        gains.integrate(&mut integral, 0.1, true);
        assert_eq!(integral.0, 3.0);
    }
}
