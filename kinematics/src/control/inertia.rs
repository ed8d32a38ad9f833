//! An arm that is heavier or lighter than its model, found by the errors of its motion and fed forward.
//!
//! A loop that holds a joint like a spring of ω² and a damper of 2ω per inertia gives way where the model's inertia is too
//! small by the share s: by s φ, with
//!
//! φ″ + 2ω φ′ + ω² φ = αd,
//!
//! where αd is the demanded acceleration. So s follows from errors e and responses φ of both joints:
//!
//! s ← s + μ Tl (φ1 e1 + φ4 e4)/(φ1² + φ4² + c²), |s| ≤ sm,
//!
//! once in a time Tl. Accelerations are demanded 1 + s times. It is the normalised gradient of e² (filtered-x LMS; Widrow, Shur and
//! Shaffer, Asilomar conference 1981). Where e answers s φ by less than a quarter of a period late, e² falls in the mean. The feedback
//! stays as it is, so no s makes its loop unstable.

use crate::Scalar;

/// Rate at which s follows motions with large responses [1/s].
const RATE: f64 = 10.0;
/// c [rad]: a response from which noise and friction tell little.
const SMALL: f64 = 4e-3;
/// sm: a payload or masses that are off by more belong into the model.
const MOST: f64 = 0.5;

/// How the excess of inertia is found. The first value of a pair is of joint 1, the second of joint 4.
///
/// ```
/// use fivebar_kinematics::control::{InertiaAdaptation, InertiaExcess};
///
/// let (omega, period) = (100.0_f64, 1e-3); // rad/s, s
/// let adaptation = InertiaAdaptation::new([omega * omega; 2], period, 1);
/// let mut excess = InertiaExcess::NONE;
/// // Joints 20 % heavier than their model, on springs and dampers of their own, swing at 8 Hz.
/// let mut error = [[0.0; 2]; 2];
/// for tick in 0..2000 {
///     let alpha = 900.0 * (50.0 * period * f64::from(tick)).sin();
///     adaptation.follow(&mut excess, [alpha, -alpha]);
///     adaptation.learn(&mut excess, error.map(|[angle, _]| angle));
///     for ([angle, rate], alpha) in error.iter_mut().zip([alpha, -alpha]) {
///         let push = (0.2 - excess.share()) * alpha;
///         *rate += period * (push - 2.0 * omega * *rate - omega * omega * *angle);
///         *angle += period * *rate;
///     }
/// }
/// assert!((excess.share() - 0.2).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InertiaAdaptation<S> {
    /// 2 ωT and (ωT)² of each joint.
    loops: [[S; 2]; 2],
    /// T² [s²].
    period_squared: S,
    /// μ Tl.
    gain: S,
    /// c² [rad²].
    small_squared: S,
    /// sm.
    most: S,
}

/// The excess of inertia that was found, and the responses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InertiaExcess<S> {
    share: S,
    /// φ and T φ′ of each joint [rad].
    responses: [[S; 2]; 2],
}

impl<S: Scalar> InertiaExcess<S> {
    /// As in the model, at rest.
    pub const NONE: Self = Self {
        share: S::ZERO,
        responses: [[S::ZERO; 2]; 2],
    };

    /// s.
    #[inline(always)]
    pub fn share(&self) -> S {
        self.share
    }

    /// The joints begin at rest. An excess that is not a number is forgotten.
    #[inline(always)]
    pub fn rest(&mut self) {
        self.responses = [[S::ZERO; 2]; 2];
        if !self.share.is_finite() {
            self.share = S::ZERO;
        }
    }
}

impl<S: Scalar> InertiaAdaptation<S> {
    /// For joints that are held by these stiffnesses per inertia, ω² [1/s²], in ticks of `period` T [s], with errors in one of
    /// `every` ticks.
    pub fn new(stiffness: [S; 2], period: S, every: u32) -> Self {
        Self {
            loops: stiffness.map(|square| {
                let turn = square.sqrt() * period;
                [S::TWO * turn, turn * turn]
            }),
            period_squared: period * period,
            gain: S::from_f64(RATE * f64::from(every)) * period,
            small_squared: S::from_f64(SMALL * SMALL),
            most: S::from_f64(MOST),
        }
    }

    /// The responses a tick later, with these demanded accelerations αd in it [rad/s²].
    #[inline(always)]
    pub fn follow(&self, excess: &mut InertiaExcess<S>, alpha: [S; 2]) {
        let ([loop1, loop4], [alpha1, alpha4]) = (&self.loops, alpha);
        let [response1, response4] = excess.responses;
        let square = self.period_squared;
        excess.responses = [
            later(response1, loop1, square * alpha1),
            later(response4, loop4, square * alpha4),
        ];
    }

    /// Takes these errors of the joints into account, demanded less true angle [rad].
    #[inline(always)]
    pub fn learn(&self, excess: &mut InertiaExcess<S>, [error1, error4]: [S; 2]) {
        let [[angle1, _], [angle4, _]] = excess.responses;
        let told = angle1 * error1 + angle4 * error4;
        let size = angle1 * angle1 + angle4 * angle4 + self.small_squared;
        let share = excess.share + self.gain * told / size;
        excess.share = if share > self.most {
            self.most
        } else if share < -self.most {
            -self.most
        } else {
            share
        };
    }
}

/// φ and T φ′ a tick later, with T² αd.
#[inline(always)]
fn later<S: Scalar>([angle, step]: [S; 2], [damper, spring]: &[S; 2], pushed: S) -> [S; 2] {
    let step = step - *damper * step - *spring * angle + pushed;
    [angle + step, step]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const T: f64 = 1e-3;
    const EVERY: u32 = 8;

    /// s after this time, of joints whose inertia is off by `excess` and whose errors come from a loop of another
    /// stiffness than the one that is taken for it.
    fn found(excess: f64, stiffness: f64, swing: f64, seconds: f64) -> f64 {
        let (assumed, omega) = (1e4_f64, (1e4 * stiffness).sqrt());
        let adaptation = InertiaAdaptation::new([assumed; 2], T, EVERY);
        let mut state = InertiaExcess::NONE;
        let mut error = [[0.0; 2]; 2];
        for tick in 0..(seconds / T) as u32 {
            let time = T * f64::from(tick);
            let alpha = [
                900.0 * libm::sin(swing * time),
                600.0 * libm::cos(0.7 * swing * time),
            ];
            adaptation.follow(&mut state, alpha);
            if tick % EVERY == 0 {
                adaptation.learn(&mut state, error.map(|[angle, _]| angle));
            }
            for ([angle, rate], alpha) in error.iter_mut().zip(alpha) {
                let push = (excess - state.share()) * alpha;
                *rate += T * (push - 2.0 * omega * *rate - omega * omega * *angle);
                *angle += T * *rate;
            }
        }
        state.share()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn the_excess_is_found_by_a_loop_that_is_known_within_a_factor_of_two(
            excess in -0.45..0.45_f64, stiffness in 0.5..2.0_f64, swing in 20.0..150.0_f64,
        ) {
            let share = found(excess, stiffness, swing, 4.0);
            prop_assert!((share - excess).abs() < 0.01, "{share} for {excess}");
        }

        #[test]
        fn what_is_found_stays_within_its_bounds_whatever_the_errors_are(
            errors in proptest::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, -1e3..1e3_f64), 1..300),
        ) {
            let adaptation = InertiaAdaptation::new([1e4; 2], T, 1);
            let mut state = InertiaExcess::NONE;
            for (error1, error4, alpha) in errors {
                adaptation.follow(&mut state, [alpha, -alpha]);
                adaptation.learn(&mut state, [error1, error4]);
                prop_assert!(state.share().abs() <= MOST);
            }
        }
    }

    #[test]
    fn an_arm_as_its_model_has_it_and_an_arm_at_rest_change_nothing() {
        assert!(found(0.0, 1.3, 60.0, 2.0).abs() < 1e-12);
        let adaptation = InertiaAdaptation::new([1e4; 2], T, 1);
        let mut state = InertiaExcess::NONE;
        for _ in 0..1000 {
            adaptation.follow(&mut state, [0.0; 2]);
            adaptation.learn(&mut state, [5e-3, -2e-3]);
        }
        assert_eq!(state, InertiaExcess::NONE);
    }

    #[test]
    fn an_error_that_is_not_a_number_is_forgotten_at_rest() {
        let adaptation = InertiaAdaptation::new([1e4; 2], T, 1);
        let mut state = InertiaExcess::NONE;
        adaptation.follow(&mut state, [f64::NAN, 1.0]);
        adaptation.learn(&mut state, [1e-3; 2]);
        state.rest();
        assert_eq!(state, InertiaExcess::NONE);
    }
}
