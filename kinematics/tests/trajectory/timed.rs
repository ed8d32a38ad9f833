//! The check of segments whose time law was made elsewhere: what is refused, why and where.

use crate::common::{MIDDLE, V, envelope, tool};
use crate::loads::{arm, joints};
use fivebar_kinematics::control::FrictionCompensation;
use fivebar_kinematics::five_bar::Joint;
use fivebar_kinematics::trajectory::{
    ConstraintViolation, Curve, Envelope, PathError, TimeLaw, ToolOutput, TorqueLimits,
    TrajectorySegment,
};

/// Much friction, so that its sign shows: 0.1 N·m·s/rad and 0.2 N·m.
fn friction() -> [FrictionCompensation<f64>; 2] {
    [FrictionCompensation::new(0.1, 0.2, 0.01); 2]
}

/// A straight curve through the middle, whose length is 0 there.
fn line(direction: f64) -> Curve<f64> {
    Curve::Line {
        start: V::new(MIDDLE[0], MIDDLE[1]),
        tangent: V::new(direction.cos(), direction.sin()),
    }
}

fn segment(curve: Curve<f64>, law: [f64; 4], duration: f64) -> TrajectorySegment<f64> {
    let [s, s_dot, s_ddot, jerk] = law;
    let law = TimeLaw::new(s, s_dot, s_ddot, jerk);
    TrajectorySegment::along(curve, law, duration, 1, ToolOutput::constant(0.0))
}

fn check(envelope: &Envelope<f64>, segment: &TrajectorySegment<f64>) -> Result<(), PathError<f64>> {
    envelope.check_timed(segment, &friction()).map(|_| ())
}

fn violation(
    envelope: &Envelope<f64>,
    segment: &TrajectorySegment<f64>,
) -> Option<ConstraintViolation> {
    check(envelope, segment).err().map(|error| error.violation)
}

/// Speeds up to the end, where every figure of the joints is greatest.
const FASTER: [f64; 4] = [0.0, 0.1, 2.0, 400.0];

/// The size of each joint's speed, acceleration and torque with friction, at its greatest, and the
/// time of it.
fn greatest(motion: &TrajectorySegment<f64>) -> [[(f64, f64); 2]; 3] {
    let open = envelope::<f64>(5e-5);
    let arm = arm(&open);
    let mut greatest = [[(0.0, 0.0); 2]; 3];
    for step in 0..=400 {
        let time = motion.duration() * f64::from(step) / 400.0;
        let [speed, acceleration, torque] = joints(&open, &arm, tool(motion, time));
        let torque = [0, 1].map(|j| torque[j] + friction()[j].torque(speed[j]));
        for (kind, values) in [speed, acceleration, torque].into_iter().enumerate() {
            for joint in 0..2 {
                if values[joint].abs() > greatest[kind][joint].0 {
                    greatest[kind][joint] = (values[joint].abs(), time);
                }
            }
        }
    }
    greatest
}

#[test]
fn each_limit_of_each_joint_holds_for_the_motion_itself() {
    for direction in [0.3, 1.9, 3.6, 5.2] {
        let motion = segment(line(direction), FASTER, 0.04);
        for (kind, greatest) in greatest(&motion).into_iter().enumerate() {
            for (number, joint) in [Joint::Joint1, Joint::Joint4].into_iter().enumerate() {
                let limited = |share: f64| {
                    let mut envelope = envelope::<f64>(5e-5);
                    let arm = arm(&envelope);
                    let mut torque = [1e3; 2];
                    let value = share * greatest[number].0;
                    match kind {
                        0 => envelope.joint_speed[number] = value,
                        1 => envelope.joint_acceleration[number] = value,
                        _ => torque[number] = value,
                    }
                    envelope.torque = Some(TorqueLimits { arm, torque });
                    violation(&envelope, &motion)
                };
                let named = match kind {
                    0 => ConstraintViolation::JointSpeed(joint),
                    1 => ConstraintViolation::JointAcceleration(joint),
                    _ => ConstraintViolation::MotionTorque(joint),
                };
                assert_eq!(limited(1.01), None, "{named:?}");
                assert_eq!(limited(0.98), Some(named));
            }
        }
    }
}

/// A circle of this radius [m] through the middle.
fn circle(radius: f64) -> Curve<f64> {
    Curve::Arc {
        start: V::new(MIDDLE[0], MIDDLE[1]),
        tangent: V::new(1.0, 0.0),
        curvature: 1.0 / radius,
    }
}

/// The joints' accelerations and torques are greatest between the places at which they are checked.
#[test]
fn what_passes_a_limit_between_two_places_is_rounding() {
    for (curve, law, duration) in [
        // The acceleration swings within 4 ms.
        (line(0.3), [0.0, 0.2, 60.0, -3e4], 0.004),
        // Up to 1.4 rad in the 0.25 ms between two places.
        (circle(2e-5), [0.0, 0.11, 0.0, 0.0], 0.004),
        (circle(3e-4), [0.0, 0.3, 0.0, 0.0], 0.02),
        (circle(1e-3), [0.0, 0.3, 5.0, 0.0], 0.02),
    ] {
        let motion = segment(curve, law, duration);
        let [_, acceleration, torque] = greatest(&motion);
        for (number, joint) in [Joint::Joint1, Joint::Joint4].into_iter().enumerate() {
            let mut limited = envelope::<f64>(5e-5);
            limited.joint_speed = [1e3; 2];
            limited.joint_acceleration = [1e9; 2];
            limited.joint_acceleration[number] = 0.998 * acceleration[number].0;
            let named = Some(ConstraintViolation::JointAcceleration(joint));
            assert_eq!(
                violation(&limited, &motion),
                named,
                "{law:?} {acceleration:?}"
            );
            limited.joint_acceleration = [1e9; 2];
            let arm = arm(&limited);
            let mut limits = [1e6; 2];
            limits[number] = 0.998 * torque[number].0;
            let torque = limits;
            limited.torque = Some(TorqueLimits { arm, torque });
            let named = Some(ConstraintViolation::MotionTorque(joint));
            assert_eq!(violation(&limited, &motion), named, "{law:?}");
        }
    }
}

/// 32 rad in all are more than the places allow.
#[test]
fn a_motion_that_turns_too_often_to_be_checked_is_refused() {
    let mut open = envelope::<f64>(5e-5);
    open.joint_speed = [1e3; 2];
    open.joint_acceleration = [1e12; 2];
    for (radius, refused) in [(1.7e-5, false), (1.5e-5, true), (1e-7, true)] {
        let motion = segment(circle(radius), [0.0, 0.5, 0.0, 0.0], 1e-3);
        let found = violation(&open, &motion);
        let expected = refused.then_some(ConstraintViolation::Limits);
        assert_eq!(found, expected, "{radius} m");
    }
}

#[test]
fn a_violation_is_reported_at_its_place() {
    let motion = segment(line(0.3), [0.0, 0.1, 0.0, 600.0], 0.04);
    let [[(speed, time), _], ..] = greatest(&motion);
    assert_eq!(time, 0.04, "it gets faster");
    let mut limited = envelope::<f64>(5e-5);
    // At half of the greatest speed, in the midst of the motion.
    limited.joint_speed[0] = 0.5 * speed;
    let error = check(&limited, &motion).unwrap_err();
    let at = error.fraction * motion.duration();
    assert!((0.005..0.035).contains(&at), "{at} s");
    // The first of the places, 0.25 ms apart, at which it is too fast.
    let speed_at = |time: f64| joints(&limited, &arm(&limited), tool(&motion, time))[0][0].abs();
    assert!(speed_at(at) > 0.5 * speed && speed_at(at - 2.5e-4) <= 0.5 * speed);
    let (position, ..) = tool(&motion, at);
    assert!((error.point - position).norm() < 1e-12);
    // At the end only, which lies between two of the places.
    let motion = segment(line(0.3), FASTER, 0.0401);
    let [[(speed, _), _], ..] = greatest(&motion);
    limited.joint_speed[0] = 0.998 * speed;
    assert_eq!(check(&limited, &motion).unwrap_err().fraction, 1.0);
}

#[test]
fn a_segment_that_is_no_motion_forward_is_refused() {
    let open = envelope::<f64>(5e-5);
    let steady = [0.0, 0.1, 0.0, 0.0];
    for (law, duration) in [
        (steady, 0.0),
        (steady, -0.01),
        ([f64::NAN, 0.1, 0.0, 0.0], 0.01),
        ([0.0, f64::NAN, 0.0, 0.0], 0.01),
        ([f64::INFINITY, 0.1, 0.0, 0.0], 0.01),
        ([0.0, -0.1, 0.0, 0.0], 0.01),
        // Back in its midst, forward as a whole.
        ([0.0, 0.2, -60.0, 6000.0], 0.025),
        // The longest segment lasts 64 ms.
        (steady, 0.0645),
    ] {
        let found = violation(&open, &segment(line(0.0), law, duration));
        assert_eq!(found, Some(ConstraintViolation::Limits), "{law:?}");
    }
    for (law, duration) in [(steady, 1e-4), (steady, 0.01), (steady, 0.0635)] {
        assert_eq!(violation(&open, &segment(line(0.0), law, duration)), None);
    }
}

#[test]
fn the_way_that_is_covered_is_within_reach_and_no_other() {
    let open = envelope::<f64>(5e-5);
    // The straight curve begins far outside; its part from 1 m on is near the middle.
    let far = Curve::Line {
        start: V::new(MIDDLE[0] - 1.0, MIDDLE[1]),
        tangent: V::new(1.0, 0.0),
    };
    assert_eq!(
        violation(&open, &segment(far, [1.0, 0.1, 0.0, 0.0], 0.05)),
        None
    );
    assert!(violation(&open, &segment(far, [0.0, 0.1, 0.0, 0.0], 0.05)).is_some());
    // 0.4 m through places out of reach, from one within it.
    assert!(violation(&open, &segment(far, [1.0, 8.0, 0.0, 0.0], 0.05)).is_some());
}

#[test]
fn a_part_of_a_blend_is_followed_within_its_length_only() {
    let open = envelope::<f64>(5e-5);
    let length = 0.01;
    let mut coefficients = [V::zeros(); 6];
    coefficients[0] = V::new(MIDDLE[0], MIDDLE[1]);
    coefficients[1] = V::new(length, 0.0);
    let blend = |inverse_length| Curve::Blend {
        coefficients,
        inverse_length,
    };
    let part = |from: f64, to: f64| {
        let law = [from, (to - from) / 0.05, 0.0, 0.0];
        violation(&open, &segment(blend(1.0 / length), law, 0.05))
    };
    for (from, to) in [(0.0, length), (0.003, 0.006), (0.0, 0.002), (0.008, length)] {
        assert_eq!(part(from, to), None, "{from} m to {to} m");
    }
    for (from, to) in [
        (-0.001, 0.005),
        (0.005, 0.011),
        (-0.001, 0.011),
        (0.012, 0.013),
    ] {
        assert_eq!(part(from, to), Some(ConstraintViolation::Limits));
    }
    let endless = segment(blend(0.0), [0.0, 0.1, 0.0, 0.0], 0.05);
    assert_eq!(
        violation(&open, &endless),
        Some(ConstraintViolation::Limits)
    );
}
