//! What a drive on a bus tells its own spring and damper while the joint keeps to its motion.
//!
//! Such a drive does not use its encoder's angle r itself, but that of a loop that tracks it, x, with the velocity v:
//!
//! x′ = v + (2/T)(r − x),  v′ = (r − x)/T².
//!
//! In a motion with acceleration α both differ from r and ω. With e = x − r and g = T (v − ω)
//!
//! T e′ = g − 2e,  T g′ = −e − T² α,
//!
//! and where α goes on as α + j t, e and g come to P(α, j) = (−T²α + 2T³j, −2T²α + 3T³j). Both poles are at −1/T, so what is
//! not yet P decays in a time t with M(t) = exp(−t/T) (1 + N t/T), N = (−1 1; −1 1), N² = 0. With α that changes evenly from
//! tick to tick this is exact. A set-point of x and v asks the spring and the damper for no torque.

use super::torque::small_angle;
use fivebar_kinematics::PlanarVector;
use nalgebra::Vector2;

/// Ticks that are kept; a power of two.
const KEPT: usize = 8;

/// The motion of a tick, and the loop's error then.
#[derive(Clone, Copy)]
struct Tick {
    /// The joint's direction.
    direction: Vector2<f32>,
    /// [rad/s].
    omega: f32,
    /// [rad/s²].
    alpha: f32,
    /// e, g [rad].
    error: [f32; 2],
}

/// M of a time.
#[derive(Clone, Copy)]
struct Decay {
    e_of_e: f32,
    e_of_g: f32,
    g_of_g: f32,
}

impl Decay {
    /// After so many T.
    fn after(times: f32) -> Self {
        let left = libm::expf(-times);
        Self {
            e_of_e: left * (1.0 - times),
            e_of_g: left * times,
            g_of_g: left * (1.0 + times),
        }
    }

    #[inline(always)]
    fn of(&self, [e, g]: [f32; 2]) -> [f32; 2] {
        [
            self.e_of_e * e + self.e_of_g * g,
            self.g_of_g * g - self.e_of_g * e,
        ]
    }
}

/// What the loop tells at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tracked {
    /// The newest angle less x [rad].
    pub(super) behind: f32,
    /// v [rad/s].
    pub(super) velocity: f32,
}

/// A drive's tracking loop along the demanded motion of its joint.
#[derive(Clone)]
pub(super) struct EncoderTracking {
    ring: [Tick; KEPT],
    newest: usize,
    /// So many belong to the same motion.
    kept: usize,
    /// T [s], and T².
    lag: f32,
    lag_squared: f32,
    /// 1 over the time between ticks [1/s].
    rate: f32,
    tick: Decay,
    /// The moment that is told lies so many whole ticks before the newest, and this time before that [s].
    ticks_ago: usize,
    rest: f32,
    /// From the tick before that moment to it.
    until: Decay,
}

impl EncoderTracking {
    /// A loop with the poles at −1/`lag` [1/s], asked for the moment `ago` before the newest set-point [s], which is at most
    /// six ticks of `period` [s].
    pub(super) fn new(lag: f32, ago: f32, period: f32) -> Self {
        let ticks_ago = ((ago / period) as usize).min(KEPT - 2);
        let rest = (ago - ticks_ago as f32 * period).min(period);
        Self {
            ring: [Tick {
                direction: Vector2::new(0.0, 0.0),
                omega: 0.0,
                alpha: 0.0,
                error: [0.0; 2],
            }; KEPT],
            newest: 0,
            kept: 0,
            lag,
            lag_squared: lag * lag,
            rate: 1.0 / period,
            tick: Decay::after(period / lag),
            ticks_ago,
            rest,
            until: Decay::after((period - rest) / lag),
        }
    }

    /// The motion that comes next has nothing to do with the one before.
    #[inline(always)]
    pub(super) fn restart(&mut self) {
        self.kept = 0;
    }

    /// P(α, j).
    #[inline(always)]
    fn steady(&self, alpha: f32, jerk: f32) -> [f32; 2] {
        let (by_alpha, by_jerk) = (self.lag_squared * alpha, self.lag_squared * self.lag * jerk);
        [2.0 * by_jerk - by_alpha, 3.0 * by_jerk - 2.0 * by_alpha]
    }

    /// e and g after a part of the tick from `from`, at whose end α is `alpha`.
    #[inline(always)]
    fn later(&self, from: &Tick, decay: &Decay, alpha: f32, jerk: f32) -> [f32; 2] {
        let ([e0, g0], [e1, g1]) = (self.steady(from.alpha, jerk), self.steady(alpha, jerk));
        let [e, g] = from.error;
        let [e, g] = decay.of([e - e0, g - g0]);
        [e1 + e, g1 + g]
    }

    #[inline(always)]
    fn ago(&self, ticks: usize) -> Tick {
        let oldest = self.kept.saturating_sub(1);
        let ticks = if ticks < oldest { ticks } else { oldest };
        self.ring[(self.newest + KEPT - ticks) % KEPT]
    }

    /// Takes the motion of this tick, and tells what the drive's loop does at its moment.
    #[inline(always)]
    pub(super) fn follow(&mut self, direction: Vector2<f32>, omega: f32, alpha: f32) -> Tracked {
        let error = if self.kept == 0 {
            self.steady(alpha, 0.0)
        } else {
            let last = self.ago(0);
            let jerk = (alpha - last.alpha) * self.rate;
            self.later(&last, &self.tick, alpha, jerk)
        };
        self.newest = (self.newest + 1) % KEPT;
        if self.kept < KEPT {
            self.kept += 1;
        }
        self.ring[self.newest] = Tick {
            direction,
            omega,
            alpha,
            error,
        };
        // The moment lies between these two.
        let (from, to) = (self.ago(self.ticks_ago + 1), self.ago(self.ticks_ago));
        let (rest, jerk) = (self.rest, (to.alpha - from.alpha) * self.rate);
        let [e, g] = self.later(&from, &self.until, to.alpha - rest * jerk, jerk);
        let since = small_angle(to.direction.cross_z(direction));
        let before = rest * (to.omega - rest * (0.5 * to.alpha - rest * jerk * (1.0 / 6.0)));
        Tracked {
            behind: since + before - e,
            velocity: to.omega - rest * (to.alpha - 0.5 * rest * jerk) + g / self.lag,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The swing r(t) = A sin(w t) with its first three derivatives.
    fn swing(time: f64) -> [f64; 3] {
        let (amplitude, rate) = (0.3, 40.0);
        let (sin, cos) = (rate * time).sin_cos();
        let of = amplitude * rate;
        [amplitude * sin, of * cos, -of * rate * sin]
    }

    /// x and v of the loop at this time, by small steps of its equations from rest in the swing's steady state long before.
    fn by_small_steps(lag: f64, time: f64) -> [f64; 2] {
        let (mut now, step) = (time - 20.0 * lag, lag * 1e-4);
        let [mut x, mut v, _] = swing(now);
        while now < time {
            let [r, ..] = swing(now + 0.5 * step);
            let half = [
                x + 0.5 * step * (v + 2.0 / lag * (r - x)),
                v + 0.5 * step * (r - x) / (lag * lag),
            ];
            x += step * (half[1] + 2.0 / lag * (r - half[0]));
            v += step * (r - half[0]) / (lag * lag);
            now += step;
        }
        [x, v]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        /// Against the loop's own equations, at any rate of ticks and any moment.
        #[test]
        fn the_loop_is_told_as_it_is(
            lag in 3e-4..2e-3_f64, period in 4e-4..1e-3_f64, share in 0.0..1.0_f64, ticks in 100..200_u32,
        ) {
            let ago = share * 6.0 * period;
            let mut tracking = EncoderTracking::new(lag as f32, ago as f32, period as f32);
            let mut told = Tracked { behind: 0.0, velocity: 0.0 };
            for tick in 0..=ticks {
                let [angle, omega, alpha] = swing(f64::from(tick) * period);
                told = tracking.follow(Vector2::unit(angle as f32), omega as f32, alpha as f32);
            }
            let now = f64::from(ticks) * period;
            let [x, v] = by_small_steps(lag, now - ago);
            let [r, ..] = swing(now);
            // A chord of α over a tick misses at most A w⁴ h²/8 of it, 96 rad/s² here.
            prop_assert!((r - f64::from(told.behind) - x).abs() < 3e-5, "{} for {}", told.behind, r - x);
            prop_assert!((f64::from(told.velocity) - v).abs() < 0.03, "{} for {v}", told.velocity);
        }
    }

    #[test]
    fn at_rest_and_at_an_even_speed_the_loop_is_right() {
        let mut tracking = EncoderTracking::new(1e-3, 1.5e-3, 1e-3);
        for tick in 0..50_u16 {
            let angle = 2e-3 * f32::from(tick);
            let told = tracking.follow(Vector2::unit(angle), 2.0, 0.0);
            if tick > 8 {
                assert!((told.behind - 3e-3).abs() < 1e-6, "{told:?}");
                assert!((told.velocity - 2.0).abs() < 1e-6, "{told:?}");
            }
        }
        tracking.restart();
        let told = tracking.follow(Vector2::unit(1.0), 0.0, 0.0);
        assert_eq!((told.behind, told.velocity), (0.0, 0.0));
    }
}
