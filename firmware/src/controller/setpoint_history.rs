//! The set-points of the last ticks: what the joints should be doing now.
//!
//! A set-point leads the joints by the lag d, from the sample of their angles until the torque acts on it. So the
//! joints of this sample belong to the set-point of d ago. With it the observer gets the acceleration of the moment
//! that it observes, and the joints are predicted by the motion that lies between both moments:
//!
//! θ⁺ = θ̂ + d (ω̂ − ωd(t)) + θd(t + d) − θd(t),  ω⁺ = ω̂ + ωd(t + d) − ωd(t).

use super::setpoint::Setpoint;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::Joint;
use nalgebra::Vector2;

/// Set-points that are kept; a power of two, so that an index needs no comparison. A longer lag takes the oldest one.
const KEPT: usize = 32;

/// The last set-points.
#[derive(Clone)]
pub(super) struct SetpointHistory {
    ring: [Setpoint; KEPT],
    /// Of joints behind belts, at each of them.
    belted: [Belted; KEPT],
    /// Where the newest one is.
    newest: usize,
    /// So many, with it, belong to the same motion.
    kept: usize,
}

/// What is kept of joints behind belts.
#[derive(Clone, Copy)]
pub(super) struct Belted {
    /// What each encoder leads its joint by, at the set-point [rad].
    pub(super) lead: [f32; 2],
    /// What was demanded beyond the torque that is fed forward [N·m].
    pub(super) demand: [f32; 2],
}

impl Belted {
    const NONE: Self = Self {
        lead: [0.0; 2],
        demand: [0.0; 2],
    };
}

/// The motion of one joint between the moment of this sample and that of the set-point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Between {
    /// θd(t + d) − θd(t) [rad].
    pub(super) angle: f32,
    /// ωd(t) [rad/s].
    pub(super) omega: f32,
}

/// The age of the set-point that belongs to a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Age {
    /// Whole ticks, at most as many as are kept.
    ticks: usize,
    /// The rest [s], from 0 to a tick.
    rest: f32,
}

impl Age {
    /// Of the newest set-point. The crossing of a singularity works with it.
    pub(super) const NEWEST: Self = Self {
        ticks: 0,
        rest: 0.0,
    };

    /// Of a lag [s] in ticks of this period [s].
    pub(super) fn new(lag: f32, period: f32) -> Self {
        let ticks = ((lag / period) as usize).min(KEPT - 2);
        Self {
            ticks,
            rest: lag - ticks as f32 * period,
        }
    }
}

/// A small angle from its sine.
#[inline(always)]
pub(super) fn small_angle(sine: f32) -> f32 {
    sine + sine * sine * sine * (1.0 / 6.0)
}

impl SetpointHistory {
    /// None yet.
    pub(super) fn none() -> Self {
        Self {
            ring: [Setpoint::hold([Vector2::zeros(); 2]); KEPT],
            belted: [Belted::NONE; KEPT],
            newest: 0,
            kept: 0,
        }
    }

    /// The joints rest at the set-point that is kept next, and have rested there.
    #[inline(always)]
    pub(super) fn restart(&mut self) {
        self.kept = 0;
    }

    /// Keeps the set-point of this tick.
    #[inline(always)]
    pub(super) fn keep(&mut self, setpoint: &Setpoint) {
        self.newest = (self.newest + 1) % KEPT;
        if self.kept < KEPT - 1 {
            self.kept += 1;
        }
        if let Some(kept) = self.ring.get_mut(self.newest) {
            *kept = *setpoint;
        }
    }

    /// Whether the newest set-point is the first one of a motion.
    #[inline(always)]
    pub(super) fn begins(&self) -> bool {
        self.kept == 1
    }

    /// Keeps this with the newest set-point.
    #[inline(always)]
    pub(super) fn keep_belted(&mut self, belted: Belted) {
        if let Some(newest) = self.belted.get_mut(self.newest) {
            *newest = belted;
        }
    }

    /// The lead of a joint's encoder so long ago [rad], to the tick, before this tick's is kept.
    #[inline(always)]
    pub(super) fn lead(&self, joint: Joint, age: &Age) -> f32 {
        let leads = self.belted(age.ticks.max(1)).lead;
        leads.get(joint.index()).copied().unwrap_or(0.0)
    }

    /// The demand of so many ticks before that of the last one [N·m].
    #[inline(always)]
    pub(super) fn demand(&self, ticks: usize) -> [f32; 2] {
        self.belted(ticks + 1).demand
    }

    /// What was kept so many ticks before the newest set-point; nothing before this motion.
    #[inline(always)]
    fn belted(&self, ticks: usize) -> Belted {
        if ticks >= self.kept {
            return Belted::NONE;
        }
        let kept = self.belted.get((self.newest + KEPT - ticks) % KEPT);
        kept.copied().unwrap_or(Belted::NONE)
    }

    /// α of a joint so long ago [rad/s²], before this tick's set-point is kept.
    #[inline(always)]
    pub(super) fn alpha(&self, joint: Joint, age: &Age) -> f32 {
        let kept = self.ago(age.ticks.saturating_sub(1));
        kept.and_then(|kept| kept.alpha.get(joint.index()))
            .copied()
            .unwrap_or(0.0)
    }

    /// The set-point of so many ticks before the newest one, or the first one of this motion; none before it.
    #[inline(always)]
    fn ago(&self, ticks: usize) -> Option<&Setpoint> {
        // The first one that is kept counts itself.
        let most = self.kept.checked_sub(1)?;
        let ticks = if ticks < most { ticks } else { most };
        self.ring.get((self.newest + KEPT - ticks) % KEPT)
    }

    /// What lies between a joint's set-point of so long ago and the newest one.
    #[inline(always)]
    pub(super) fn between(&self, joint: Joint, age: &Age) -> Between {
        let (Some(now), Some((direction, omega, alpha))) = (
            self.ago(0).and_then(|it| it.direction.get(joint.index())),
            self.ago(age.ticks).and_then(|it| it.of(joint)),
        ) else {
            return Between {
                angle: 0.0,
                omega: 0.0,
            };
        };
        let turned = small_angle(direction.cross_z(*now));
        let rest = age.rest;
        Between {
            angle: turned + rest * (omega - 0.5 * rest * alpha),
            omega: omega - rest * alpha,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PERIOD: f32 = 1e-4;

    /// Angle, velocity and acceleration of a swing at this time [s].
    fn swing(time: f32) -> [f32; 3] {
        let (amplitude, rate) = (0.3, 40.0);
        let (sin, cos) = (rate * time).sin_cos();
        let of = amplitude * rate;
        [amplitude * sin, of * cos, -of * rate * sin]
    }

    /// Joint 1 swings, and joint 4 swings the other way, for so many ticks.
    fn swung(ticks: usize) -> SetpointHistory {
        let mut past = SetpointHistory::none();
        for tick in 0..ticks {
            let [angle, omega, alpha] = swing(tick as f32 * PERIOD);
            past.keep(&Setpoint {
                direction: [angle, -angle].map(Vector2::unit),
                omega: [omega, -omega],
                alpha: [alpha, -alpha],
            });
        }
        past
    }

    proptest! {
        #[test]
        fn what_lies_between_is_the_motion_of_the_lag(lag in 1e-4..3e-3_f32, ticks in 40..2000_usize) {
            let past = swung(ticks);
            let age = Age::new(lag, PERIOD);
            let now = (ticks - 1) as f32 * PERIOD;
            let ([newest, ..], [angle, omega, _]) = (swing(now), swing(now - lag));
            for (joint, sign) in [(Joint::Joint1, 1.0), (Joint::Joint4, -1.0)] {
                let between = past.between(joint, &age);
                let turned = sign * (newest - angle);
                prop_assert!((between.angle - turned).abs() < 2e-6, "{} for {turned}", between.angle);
                prop_assert!((between.omega - sign * omega).abs() < 2e-3, "{}", between.omega);
            }
        }

        #[test]
        fn the_observer_gets_the_acceleration_of_the_next_sample(lag in 2e-4..3e-3_f32, ticks in 40..2000_usize) {
            let past = swung(ticks);
            // The next sample is a tick after the newest set-point was kept.
            let at = ticks as f32 * PERIOD - lag;
            let [_, _, alpha] = swing(at);
            let found = past.alpha(Joint::Joint1, &Age::new(lag, PERIOD));
            // Within a tick: 0.3 rad · (40 rad/s)³ · 0.1 ms.
            prop_assert!((found - alpha).abs() < 2.5, "{found} for {alpha}");
        }
    }

    #[test]
    fn nothing_lies_between_set_points_of_before_a_restart() {
        let mut past = swung(100);
        past.restart();
        let age = Age::new(1e-3, PERIOD);
        let still =
            |past: &SetpointHistory| Joint::ALL.map(|joint| past.alpha(joint, &age)) == [0.0; 2];
        assert!(still(&past), "before a set-point is kept");
        let rest = Setpoint::hold([1.0, 2.0].map(Vector2::unit));
        past.keep(&rest);
        let nothing = Between {
            angle: 0.0,
            omega: 0.0,
        };
        assert_eq!(
            Joint::ALL.map(|joint| past.between(joint, &age)),
            [nothing; 2]
        );
        assert_eq!(Joint::ALL.map(|joint| past.alpha(joint, &age)), [0.0; 2]);
        past.keep(&Setpoint {
            omega: [1.0, -1.0],
            ..rest
        });
        assert_eq!(past.between(Joint::Joint1, &age), nothing);
    }

    #[test]
    fn a_lag_longer_than_what_is_kept_goes_on_from_the_oldest_one() {
        let age = Age::new(0.05, PERIOD);
        assert_eq!(age.ticks, KEPT - 2);
        assert!((age.ticks as f32 * PERIOD + age.rest - 0.05).abs() < 1e-6);
    }
}
