//! By how much the field of a stepper leads its rotor.
//!
//! τ/G = T sin δ and k = G² N T, so sin δ = τ G N/k.
//!
//! τ is the joint's torque, G the gear ratio, T the holding torque, N a quarter of the full steps in a turn, δ the field's
//! electric angle before the rotor, k the field's stiffness as a spring at the joint. δ is 2 δ/π full steps.
//!
//! A field that is at the set-point leaves its rotor behind by its load, and every change of the load makes the rotor
//! swing. A field that leads by the load's angle has its rotor at the set-point. The load is what the motion needs by
//! the arm's model: nothing that the rotor does is fed back.
//!
//! The currents must follow the micro-steps. Above the speed at which the supply is too low for that, the rotor lags
//! behind by more than its load. The settings know by how much a rotor without load lags at each speed
//! ([`FieldLag`]), and the field leads by that as well.

use super::resolution::Fineness;
use crate::settings::FieldLag;
use core::f32::consts::PI;
use fivebar_kinematics::Scalar;

/// The greatest sin δ: near 1 the field gives hardly more torque for more lead.
const MOST: f32 = 0.9;

/// The lead of one joint's motor.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoadAngle {
    /// G/k [rad/(N·m)]; 0 of a field without a known stiffness, which does not lead.
    compliance: f32,
    /// Of the rotor behind its field, at the joint's speed.
    lag: FieldLag,
    /// Whether the motor turns against its joint.
    is_reversed: bool,
    /// What of the micro-steps made is lead.
    made: i32,
}

impl LoadAngle {
    /// None yet, of a motor with this gear ratio, stiffness of its field at the joint [N·m/rad] (0: not known) and lag.
    pub(super) fn new(gear_ratio: f32, stiffness: f32, lag: FieldLag) -> Self {
        Self {
            compliance: if stiffness > 0.0 {
                gear_ratio / stiffness
            } else {
                0.0
            },
            lag,
            is_reversed: gear_ratio < 0.0,
            made: 0,
        }
    }

    /// What of the micro-steps made is lead.
    #[inline(always)]
    pub(super) fn made(self) -> i32 {
        self.made
    }

    /// The micro-steps by which the field should lead for this torque [N·m] at the joint's speed [rad/s]: as before, for no torque
    /// and for one that is not a number.
    #[inline(always)]
    pub(super) fn wanted(&self, torque: Option<f32>, speed: f32, fineness: &Fineness) -> f32 {
        let Some(torque) = torque.filter(|torque| Scalar::is_finite(*torque)) else {
            return self.made as f32;
        };
        let sine = (torque * self.compliance * fineness.periods).clamp(-MOST, MOST);
        let lag = self.lag.at(if self.is_reversed { -speed } else { speed });
        (arcsine(sine) + lag) * (2.0 / PI) * fineness.per_full_step
    }

    /// The field leads by so many micro-steps.
    #[inline(always)]
    pub(super) fn make(&mut self, micro_steps: i32) {
        self.made = micro_steps;
    }
}

/// arcsin x by the first terms of its series: too small by 0.3 % at 0.7, by 3 % at 0.9 [rad].
#[inline(always)]
fn arcsine(x: f32) -> f32 {
    let square = x * x;
    x * (1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0 + square * (15.0 / 336.0))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drives::Resolution;

    fn nema17() -> Fineness {
        let resolution = Resolution {
            full_steps: 200,
            microsteps: 16,
        };
        Fineness::new(resolution, 0.0)
    }

    #[test]
    fn a_field_that_leads_gives_the_torque() {
        for gear_ratio in [4.0_f32, -3.0] {
            let holding = 0.4;
            let stiffness = gear_ratio * gear_ratio * 50.0 * holding;
            let lead = LoadAngle::new(gear_ratio, stiffness, FieldLag::NONE);
            for (share, within) in [
                (-0.9_f32, 2e-2),
                (-0.3, 1e-5),
                (0.0, 0.0),
                (1e-3, 1e-5),
                (0.6, 1e-3),
            ] {
                let torque = share * holding * gear_ratio;
                let micro_steps = lead.wanted(Some(torque), 0.0, &nema17());
                // N times the motor's angle.
                let electric = 50.0 * micro_steps * core::f32::consts::TAU / 3200.0;
                let given = gear_ratio * holding * electric.sin();
                let error = (given - torque).abs();
                assert!(error <= within * torque.abs(), "{given} for {torque} N·m");
            }
        }
    }

    #[test]
    fn the_lead_stays_within_three_quarters_of_a_full_step_and_without_a_torque_as_it_is() {
        let mut lead = LoadAngle::new(4.0, 320.0, FieldLag::NONE);
        for torque in [1e3, f32::MAX] {
            assert!((11.0..12.0).contains(&lead.wanted(Some(torque), 0.0, &nema17())));
            assert!((-12.0..-11.0).contains(&lead.wanted(Some(-torque), 0.0, &nema17())));
        }
        lead.make(7);
        for torque in [None, Some(f32::NAN), Some(f32::INFINITY)] {
            assert_eq!(lead.wanted(torque, 30.0, &nema17()), 7.0);
        }
        let unknown = LoadAngle::new(4.0, 0.0, FieldLag::NONE);
        assert_eq!(unknown.wanted(Some(1.0), 0.0, &nema17()), 0.0);
    }

    #[test]
    fn a_field_leads_by_the_lag_at_its_speed_in_the_direction_in_which_its_motor_turns() {
        let lag = FieldLag {
            from: 14.0,
            slope: 0.09,
            bend: 0.0,
        };
        // 0.54 rad at 20 rad/s, in full steps of π/2 and 16 micro-steps.
        let expected = 0.54 * 16.0 / core::f32::consts::FRAC_PI_2;
        for (gear_ratio, speed, sign) in [
            (4.0, 20.0, 1.0),
            (4.0, -20.0, -1.0),
            (-4.0, 20.0, -1.0),
            (4.0, 14.0, 0.0),
        ] {
            let lead = LoadAngle::new(gear_ratio, 320.0, lag);
            let wanted = lead.wanted(Some(0.0), speed, &nema17());
            assert!((wanted - sign * expected).abs() < 1e-4, "{wanted}");
        }
    }
}
