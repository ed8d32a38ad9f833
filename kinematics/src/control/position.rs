//! The position loop of one joint: α = αd + Kd ė + Kp e + ∫ Ki e dt.
//!
//! A torque demanded now acts later, by the lag d of the current loop. So the reference leads
//! by d, and is compared with the joint where it will be by then:
//!
//! θ⁺ = θ̂ + d ω̂ + ½ d² αd, ω⁺ = ω̂ + d αd, e = θd − θ⁺, ė = ωd − ω⁺.
//!
//! Then αd arrives on time, and the prediction adds d Kp to the gain on the velocity. To this
//! law a joint is 1/s² with the lag, because inverse dynamics turns α into torque; the
//! characteristic equation is s² + ((Kd + d Kp) s + Kp) e^(−sd) = 0. With e^(−sd) ≈ 1 − sd it
//! is of second order and its roots are those of s² + 2ζω s + ω² when
//!
//! m = 1 / (1 + 2ζωd + ω²d²), Kp = m ω², Kd = m 2ζω.
//!
//! d = 0 gives the gains of the textbooks, ω² and 2ζω. The error of the true roots is of the
//! order of (ωd)².
//!
//! The integral acts at the rate ωi: Ki = Kp ωi. While the torque is limited, an error that
//! would increase the integral's size is ignored.

use crate::Scalar;

/// The position loop's constants.
///
/// ```
/// use fivebar_kinematics::control::{Integral, PositionLoop};
///
/// // 100 rad/s, critically damped; no lag, no integral action, ticks of 0.1 ms.
/// let (period, gains) = (1e-4, PositionLoop::new(100.0, 1.0, 0.0, 0.0, 1e-4));
/// let (mut angle, mut velocity) = (0.1_f64, 0.0); // rad, rad/s
/// for _ in 0..1000 { // 0.1 s: ten time constants
///     let alpha = gains.acceleration(Integral(0.0), 0.0, -angle, -velocity);
///     angle += period * (velocity + 0.5 * period * alpha);
///     velocity += period * alpha;
/// }
/// // x(t) = 0.1 (1 + ωt) e^(−ωt) is 0.05 mrad.
/// assert!(angle.abs() < 1e-4 && angle > 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionLoop<S> {
    kp: S,
    kd: S,
    ki_period: S,
    lag: S,
    half_lag_squared: S,
}

/// The integral's share of the acceleration demand [rad/s²].
///
/// ```
/// use fivebar_kinematics::control::{Integral, PositionLoop};
///
/// let gains = PositionLoop::new(100.0, 1.0, 0.0, 20.0, 1e-4);
/// let mut integral = Integral(0.0); // rad/s²
/// gains.integrate(&mut integral, 1e-3, false);
/// // Ki T e = ω² ωi T e = 1e4 · 20 · 1e-4 · 1e-3.
/// assert!((integral.0 - 0.02_f64).abs() < 1e-15);
/// // While the torque is limited, the integral does not grow.
/// gains.integrate(&mut integral, 1e-3, true);
/// assert!((integral.0 - 0.02).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integral<S>(pub S);

impl<S: Scalar> PositionLoop<S> {
    /// A loop of the bandwidth ω [rad/s] and damping ratio ζ behind the lag d [s], with
    /// the integral rate ωi [rad/s] at the tick period T [s].
    pub fn new(bandwidth: S, damping: S, lag: S, integral_rate: S, period: S) -> Self {
        let square = bandwidth * bandwidth;
        let twice = S::TWO * damping * bandwidth;
        let m = S::ONE / (S::ONE + twice * lag + square * lag * lag);
        let kp = m * square;
        Self {
            kp,
            kd: m * twice,
            ki_period: kp * integral_rate * period,
            lag,
            half_lag_squared: S::HALF * lag * lag,
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

    /// d, by which the reference leads [s].
    #[inline]
    pub fn lag(&self) -> S {
        self.lag
    }

    /// θ⁺ [rad] and ω⁺ [rad/s]: the joint when the torque acts, while it accelerates by
    /// `alpha` [rad/s²].
    #[inline(always)]
    pub fn predict(&self, theta: S, omega: S, alpha: S) -> (S, S) {
        (
            theta + self.lag * omega + self.half_lag_squared * alpha,
            omega + self.lag * alpha,
        )
    }

    /// The demanded acceleration [rad/s²] for the desired one `alpha` [rad/s²], the error
    /// e [rad] and its rate ė [rad/s].
    #[inline(always)]
    pub fn acceleration(&self, integral: Integral<S>, alpha: S, error: S, error_rate: S) -> S {
        alpha + self.kd * error_rate + self.kp * error + integral.0
    }

    /// Takes one tick's error [rad] into the integral. `limited` means that the torque was
    /// limited; the integral then only takes in what brings it nearer to zero.
    #[inline(always)]
    pub fn integrate(&self, integral: &mut Integral<S>, error: S, limited: bool) {
        let step = self.ki_period * error;
        if limited && integral.0 * step >= S::ZERO {
            return;
        }
        integral.0 += step;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const T: f64 = 1e-4;

    /// A unit double integrator whose acceleration acts `lag` ticks late.
    fn run(gains: &PositionLoop<f64>, lag: usize, disturbance: f64, limit: f64) -> [f64; 4000] {
        let (mut x, mut v, mut integral) = (1.0, 0.0, Integral(0.0));
        let mut line = [0.0_f64; 64];
        core::array::from_fn(|k| {
            let (x_then, v_then) = gains.predict(x, v, 0.0);
            let demand = gains.acceleration(integral, 0.0, -x_then, -v_then);
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
        let gains = PositionLoop::new(200.0, 0.7, 0.0, 0.0, T);
        assert_eq!(gains.kp(), 200.0 * 200.0);
        assert_eq!(gains.kd(), 2.0 * 0.7 * 200.0);
    }

    #[test]
    fn a_limited_torque_lets_the_integral_only_shrink() {
        let gains = PositionLoop::new(200.0, 0.7, 0.0, 50.0, T);
        let after = |integral, error, limited| {
            let mut integral = Integral(integral);
            gains.integrate(&mut integral, error, limited);
            integral.0
        };
        let step = after(0.0, 1.0, false);
        assert!(step > 0.0);
        // Integrals both smaller and larger than the step.
        for size in [0.1 * step, 10.0 * step] {
            for sign in [1.0, -1.0] {
                let start = sign * size;
                assert_eq!(after(start, sign, true), start, "it would grow");
                assert_eq!(after(start, -sign, true), start - sign * step);
                assert_eq!(after(start, sign, false), start + sign * step);
            }
        }
    }

    proptest! {
        #[test]
        fn closed_loop_poles_lie_where_asked(
            bandwidth in 50.0..400.0_f64,
            damping in 0.4..0.95_f64,
            product in 0.0..0.15_f64,
        ) {
            let lag = product / bandwidth;
            let gains = PositionLoop::new(bandwidth, damping, lag, 0.0, T);
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
                let kd = gains.kd() + lag * gains.kp();
                let pd = [kd * s[0] + gains.kp(), kd * s[1]];
                let (ss, late) = (mul(s, s), mul(pd, delay));
                let f = [ss[0] + late[0], ss[1] + late[1]];
                let inner = [kd - lag * pd[0], -lag * pd[1]];
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
            let gains = PositionLoop::new(200.0, damping, lag, 0.0, T);
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
            &PositionLoop::new(200.0, 1.0, 0.0, 50.0, T),
            0,
            50.0,
            f64::MAX,
        );
        let without = run(
            &PositionLoop::new(200.0, 1.0, 0.0, 0.0, T),
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
        let gains = PositionLoop::new(200.0, 1.0, 0.0, 40.0, T);
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

    #[test]
    fn a_leading_reference_is_followed_without_lag() {
        // A joint that accelerates as its reference did one lag ago follows it exactly.
        let gains = PositionLoop::new(200.0, 1.0, 5.0 * T, 0.0, T);
        let (theta, omega) = (|t: f64| t * t * t, |t: f64| 3.0 * t * t);
        let t = 0.3;
        let lead = t + gains.lag();
        let (then, rate) = gains.predict(theta(t), omega(t), 6.0 * lead);
        // What the prediction misses is the change of α over the lag: ½ d² · 6d.
        assert!((theta(lead) - then).abs() < 4.0 * libm::pow(gains.lag(), 3.0));
        assert!((omega(lead) - rate).abs() < 4.0 * libm::pow(gains.lag(), 2.0));
    }
}
