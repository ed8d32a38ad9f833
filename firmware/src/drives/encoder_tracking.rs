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

/// The loop's equations over a tick in which α changes evenly.
struct Equations {
    /// T [s].
    lag: f32,
    /// [s].
    period: f32,
}

impl Equations {
    /// P(α, j).
    fn steady(&self, alpha: f32, jerk: f32) -> [f32; 2] {
        let squared = self.lag * self.lag;
        let (by_alpha, by_jerk) = (squared * alpha, squared * self.lag * jerk);
        [2.0 * by_jerk - by_alpha, 3.0 * by_jerk - 2.0 * by_alpha]
    }

    /// e and g after this time of a tick [s]: P + M (what they were before less P).
    fn after(&self, time: f32, [e, g]: [f32; 2], [alpha0, alpha1]: [f32; 2]) -> [f32; 2] {
        let jerk = (alpha1 - alpha0) / self.period;
        let [e0, g0] = self.steady(alpha0, jerk);
        let [e1, g1] = self.steady(alpha0 + time * jerk, jerk);
        let (times, left) = (time / self.lag, libm::expf(-time / self.lag));
        let (e, g) = (e - e0, g - g0);
        [
            e1 + left * (e + times * (g - e)),
            g1 + left * (g + times * (g - e)),
        ]
    }

    /// r less x, and v less ω, so long before a tick's end, of which ω is that of the end.
    fn told(&self, rest: f32, error: [f32; 2], [alpha0, alpha1]: [f32; 2]) -> [f32; 2] {
        let [e, g] = self.after(self.period - rest, error, [alpha0, alpha1]);
        let jerk = (alpha1 - alpha0) / self.period;
        [
            -rest * rest * (0.5 * alpha1 - rest * jerk * (1.0 / 6.0)) - e,
            -rest * (alpha1 - 0.5 * rest * jerk) + g / self.lag,
        ]
    }
}

/// A sum of e and g at a tick's begin and of α there and at its end.
#[derive(Clone, Copy)]
struct Row([f32; 4]);

impl Row {
    /// The two sums that a function is which has no other terms.
    fn pair_of(function: impl Fn([f32; 2], [f32; 2]) -> [f32; 2]) -> [Self; 2] {
        let units = [
            function([1.0, 0.0], [0.0; 2]),
            function([0.0, 1.0], [0.0; 2]),
            function([0.0; 2], [1.0, 0.0]),
            function([0.0; 2], [0.0, 1.0]),
        ];
        [Self(units.map(|[of, _]| of)), Self(units.map(|[_, of]| of))]
    }

    #[inline(always)]
    fn of(&self, [e, g]: [f32; 2], [alpha0, alpha1]: [f32; 2]) -> f32 {
        let Self([by_e, by_g, by_alpha0, by_alpha1]) = self;
        by_e * e + by_g * g + (by_alpha0 * alpha0 + by_alpha1 * alpha1)
    }
}

/// What the loop tells at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tracked {
    /// x less the joint's angle [rad].
    pub(super) ahead: f32,
    /// v [rad/s].
    pub(super) velocity: f32,
}

/// The tracking loop of one drive.
#[derive(Clone)]
struct Loop {
    ring: [Tick; KEPT],
    /// e and g a tick later.
    next: [Row; 2],
    /// The moment that is told lies so many whole ticks before the newest, and this time before that [s].
    ticks_ago: usize,
    rest: f32,
    /// r less x and v less ω then.
    told: [Row; 2],
    /// e and g per α where it goes on as it is [s²].
    steady: [f32; 2],
}

/// The tracking loops of both drives along the demanded motion of their joints.
#[derive(Clone)]
pub(super) struct EncoderTracking {
    loops: [Loop; 2],
    newest: usize,
    /// So many ticks belong to the same motion.
    kept: usize,
}

/// A joint's direction, where it is; and its demanded motion: direction, ω [rad/s] and α [rad/s²].
pub(super) type Motion = (Vector2<f32>, Vector2<f32>, f32, f32);

impl Loop {
    fn new(lag: f32, ago: f32, period: f32) -> Self {
        let equations = Equations { lag, period };
        let ticks_ago = ((ago / period) as usize).min(KEPT - 2);
        let rest = (ago - ticks_ago as f32 * period).min(period);
        Self {
            ring: [Tick {
                direction: Vector2::new(0.0, 0.0),
                omega: 0.0,
                alpha: 0.0,
                error: [0.0; 2],
            }; KEPT],
            next: Row::pair_of(|error, alphas| equations.after(period, error, alphas)),
            ticks_ago,
            rest,
            told: Row::pair_of(|error, alphas| equations.told(rest, error, alphas)),
            steady: equations.steady(1.0, 0.0),
        }
    }

    /// The error of the next tick, behind the one at this place.
    #[inline(always)]
    fn error(&self, last: usize, alpha: f32) -> [f32; 2] {
        let last = &self.ring[last];
        let alphas = [last.alpha, alpha];
        let [e, g] = &self.next;
        [e.of(last.error, alphas), g.of(last.error, alphas)]
    }

    /// What the loop tells; the tick of so many ticks ago is at `place`.
    #[inline(always)]
    fn tracked(&self, here: Vector2<f32>, place: impl Fn(usize) -> usize) -> Tracked {
        // The moment lies between these two.
        let from = &self.ring[place(self.ticks_ago + 1)];
        let to = &self.ring[place(self.ticks_ago)];
        let alphas = [from.alpha, to.alpha];
        let [behind, faster] = &self.told;
        let there = small_angle(here.cross_z(to.direction));
        Tracked {
            ahead: there - self.rest * to.omega - behind.of(from.error, alphas),
            velocity: to.omega + faster.of(from.error, alphas),
        }
    }
}

impl EncoderTracking {
    /// Loops with the poles at −1/`lag` [1/s], asked for the moment `ago` before the newest set-point [s], which is at most
    /// six ticks of `period` [s].
    pub(super) fn new([lag1, lag4]: [f32; 2], [ago1, ago4]: [f32; 2], period: f32) -> Self {
        Self {
            loops: [Loop::new(lag1, ago1, period), Loop::new(lag4, ago4, period)],
            newest: 0,
            kept: 0,
        }
    }

    /// The motion that comes next has nothing to do with the one before.
    #[inline(always)]
    pub(super) fn restart(&mut self) {
        self.kept = 0;
    }

    /// Takes the motion of this tick, and tells what the drives' loops do at their moments.
    #[inline(always)]
    pub(super) fn follow(&mut self, motions: [Motion; 2]) -> [Tracked; 2] {
        let [loop1, loop4] = &mut self.loops;
        let [
            (here1, direction1, omega1, alpha1),
            (here4, direction4, omega4, alpha4),
        ] = motions;
        let (error1, error4) = if self.kept == 0 {
            (
                loop1.steady.map(|per_alpha| per_alpha * alpha1),
                loop4.steady.map(|per_alpha| per_alpha * alpha4),
            )
        } else {
            let last = self.newest % KEPT;
            (loop1.error(last, alpha1), loop4.error(last, alpha4))
        };
        self.newest = (self.newest + 1) % KEPT;
        let oldest = self.kept;
        if self.kept < KEPT - 1 {
            self.kept += 1;
        }
        let newest = self.newest;
        loop1.ring[newest] = Tick {
            direction: direction1,
            omega: omega1,
            alpha: alpha1,
            error: error1,
        };
        loop4.ring[newest] = Tick {
            direction: direction4,
            omega: omega4,
            alpha: alpha4,
            error: error4,
        };
        // Or the first one of this motion.
        let place = |ticks: usize| {
            let ticks = if ticks < oldest { ticks } else { oldest };
            (newest + KEPT - ticks) % KEPT
        };
        [loop1.tracked(here1, place), loop4.tracked(here4, place)]
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
            let mut tracking = EncoderTracking::new([lag as f32; 2], [ago as f32; 2], period as f32);
            let mut told = Tracked { ahead: 0.0, velocity: 0.0 };
            for tick in 0..=ticks {
                let [angle, omega, alpha] = swing(f64::from(tick) * period);
                let here = Vector2::unit(angle as f32);
                told = tracking.follow([(here, here, omega as f32, alpha as f32); 2])[1];
            }
            let now = f64::from(ticks) * period;
            let [x, v] = by_small_steps(lag, now - ago);
            let [r, ..] = swing(now);
            // A chord of α over a tick misses at most A w⁴ h²/8 of it, 96 rad/s² here.
            prop_assert!((r + f64::from(told.ahead) - x).abs() < 3e-5, "{} for {}", told.ahead, x - r);
            prop_assert!((f64::from(told.velocity) - v).abs() < 0.03, "{} for {v}", told.velocity);
        }
    }

    #[test]
    fn at_rest_and_at_an_even_speed_the_loop_is_right() {
        let mut tracking = EncoderTracking::new([1e-3; 2], [1.5e-3; 2], 1e-3);
        for tick in 0..50_u16 {
            let angle = 2e-3 * f32::from(tick);
            let here = Vector2::unit(angle);
            let [told, _] = tracking.follow([(here, here, 2.0, 0.0); 2]);
            if tick > 8 {
                assert!((told.ahead + 3e-3).abs() < 1e-6, "{told:?}");
                assert!((told.velocity - 2.0).abs() < 1e-6, "{told:?}");
            }
        }
        tracking.restart();
        let here = Vector2::unit(1.0);
        let [told, _] = tracking.follow([(here, here, 0.0, 0.0); 2]);
        assert_eq!((told.ahead, told.velocity), (0.0, 0.0));
    }
}
