//! The joints' speeds, accelerations and torques are within their limits along every path, also
//! close to singularities.

use crate::common::{MIDDLE, V, envelope, run, tool};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Joint, Side, Singularity};
use fivebar_kinematics::trajectory::{
    ConstraintViolation, Envelope, LookaheadPlanner, MotionLimits, PathSegment, Reference, Sense,
    TorqueLimits,
};
use fivebar_testkit::Tally;
use nalgebra::Vector2;
use proptest::prelude::*;

/// Links of a tenth of a kilogram and heavy rotors, gravity in the plane.
pub(crate) fn arm(envelope: &Envelope<f64>) -> Arm<f64> {
    let link = Link {
        mass: 0.1,
        com: V::new(0.11, 0.005),
        inertia: 4e-4,
    };
    let geometry = *envelope.workspace.tool.geometry();
    Arm::new(geometry, [link; 4], 0.1, V::new(0.0, -9.81), [2e-3; 2]).unwrap()
}

/// Joint speeds, accelerations and torques at a reference of the tool.
pub(crate) fn joints(
    envelope: &Envelope<f64>,
    arm: &Arm<f64>,
    (p, v, a): (V, V, V),
) -> [[f64; 2]; 3] {
    let workspace = &envelope.workspace;
    let pose = workspace.tool.inverse(p, workspace.mode).unwrap();
    let velocities = workspace.tool.inverse_velocities(&pose, v).unwrap();
    let accelerations = workspace
        .tool
        .inverse_accelerations(&pose, &velocities, a)
        .unwrap();
    let torque = arm
        .inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros())
        .unwrap();
    let [w1, _, _, w4] = velocities.omega;
    let [a1, _, _, a4] = accelerations.alpha;
    [[w1, w4], [a1, a4], torque]
}

/// A path from the middle in any direction, to just before the point where it is refused.
fn to_the_limit(envelope: &Envelope<f64>, direction: f64, bend: Option<f64>) -> PathSegment<f64> {
    let from = V::new(MIDDLE[0], MIDDLE[1]);
    let reach = |length: f64| {
        let to = from + V::unit(direction) * length;
        match bend {
            None => PathSegment::line(from, to),
            Some(bend) => {
                let chord = to - from;
                let centre = from + chord * 0.5 + chord.perpendicular() * bend;
                PathSegment::arc(from, to, centre, Sense::CounterClockwise, 1e-9)
            }
        }
        .unwrap()
    };
    let (mut good, mut bad) = (1e-3, 0.5);
    for _ in 0..30 {
        let middle = (good + bad) / 2.0;
        match envelope.check(&reach(middle), 1.0) {
            Ok(_) => good = middle,
            Err(_) => bad = middle,
        }
    }
    reach(good)
}

/// The joints' limits alone: those of the tool are wide.
fn bound_by_joints(
    joint_speed: [f64; 2],
    joint_acceleration: [f64; 2],
    torque: Option<[f64; 2]>,
) -> Envelope<f64> {
    let mut envelope = envelope(1e-4);
    let arm = arm(&envelope);
    envelope.workspace.margin = 0.1;
    envelope.tool_motion = MotionLimits {
        speed: 1.0,
        acceleration: 50.0,
        jerk: 5e4,
    };
    envelope.joint_speed = joint_speed;
    envelope.joint_acceleration = joint_acceleration;
    envelope.torque = torque.map(|torque| TorqueLimits { arm, torque });
    envelope
}

/// The greatest speed, acceleration and torque of the joints, as shares of their limits, on the
/// path to the limit and on a straight line back, if that line is accepted.
fn greatest_shares(envelope: &Envelope<f64>, direction: f64, bend: Option<f64>) -> [f64; 3] {
    let arm = arm(envelope);
    let out = to_the_limit(envelope, direction, bend);
    let back = PathSegment::line(out.end(), out.start()).unwrap();
    let mut path = vec![out];
    let returns = envelope.check(&back, 1.0).is_ok();
    assert!(returns || bend.is_some(), "the same line is accepted");
    path.extend(returns.then_some(back));
    let mut greatest = [0.0_f64; 3];
    for trajectory_segment in run(&path, 1.0, envelope) {
        for step in 0..=20 {
            let reference = tool(
                &trajectory_segment,
                trajectory_segment.duration() * f64::from(step) / 20.0,
            );
            let [speed, acceleration, load] = joints(envelope, &arm, reference);
            for joint in 0..2 {
                let torque = envelope.torque.map(|limits| limits.torque[joint]);
                let shares = [
                    speed[joint].abs() / envelope.joint_speed[joint],
                    acceleration[joint].abs() / envelope.joint_acceleration[joint],
                    torque.map_or(0.0, |torque| load[joint].abs() / torque),
                ];
                for (share, greatest) in shares.iter().zip(&mut greatest) {
                    assert!(share.is_finite(), "{shares:?}");
                    *greatest = greatest.max(*share);
                }
            }
        }
    }
    greatest
}

#[test]
fn the_joints_limits_are_made_use_of() {
    for torque in [None, Some([2.0, 2.0])] {
        let envelope = bound_by_joints([2.0, 3.0], [20.0, 30.0], torque);
        for (eighth, bend) in (0..8).flat_map(|eighth| [(eighth, None), (eighth, Some(0.6))]) {
            let direction = f64::from(eighth) * core::f64::consts::FRAC_PI_4;
            let shares = greatest_shares(&envelope, direction, bend);
            assert!(shares.iter().any(|&share| share > 0.4), "{shares:?}");
        }
    }
}

proptest! {
    #[test]
    fn joint_limits_hold_along_every_motion(
        direction in -3.2..3.2_f64,
        bend in prop::option::of(0.3..2.0_f64),
        joint_speed in prop::array::uniform2(0.3..6.0_f64),
        joint_acceleration in prop::array::uniform2(5.0..100.0_f64),
        torque in prop::option::of(prop::array::uniform2(1.5..4.0_f64)),
    ) {
        let envelope = bound_by_joints(joint_speed, joint_acceleration, torque);
        let shares = greatest_shares(&envelope, direction, bend);
        prop_assert!(shares.iter().all(|&share| share <= 1.0), "{shares:?}");
        // The arm moves.
        prop_assert!(shares.iter().any(|&share| share > 0.05), "{shares:?}");
    }
}

#[test]
fn joint_moves_run_from_rest_to_rest_and_arrive_together() {
    let accepted = Tally::default();
    let mut envelope = envelope(0.0);
    envelope.joint_speed = [3.0, 5.0];
    envelope.joint_acceleration = [40.0, 20.0];
    let start = prop::array::uniform2(1.15..1.5_f64);
    let turn = prop::array::uniform2(-0.4..0.4_f64);
    proptest!(|(start in start, turn in turn, share in 0.05..1.0_f64)| {
        let from = [std::f64::consts::PI - start[0], start[1]];
        let to = [from[0] + turn[0], from[1] + turn[1]];
        // Some of these moves pass B, C and D in line.
        let checked = envelope.check_joint_move(from, to, Side::Left, share);
        if !accepted.count(checked.is_ok()) {
            return Ok(());
        }
        let (limits, _) = checked.unwrap();
        let mut lookahead = LookaheadPlanner::<f64, 8>::new();
        lookahead.push_joint(from, to, limits, 7).unwrap();
        let mut last = (from, [0.0; 2], [0.0; 2]);
        while let Some(trajectory_segment) = lookahead.next_segment() {
            prop_assert_eq!(trajectory_segment.tag(), 7);
            for step in 0..=20 {
                let t = trajectory_segment.duration() * f64::from(step) / 20.0;
                let Reference::Joint { angles, rates, accelerations } = trajectory_segment.evaluate(t) else {
                    panic!("a joint move moves the joints");
                };
                for joint in 0..2 {
                    if step == 0 {
                        prop_assert!((angles[joint] - last.0[joint]).abs() < 1e-8);
                        prop_assert!((rates[joint] - last.1[joint]).abs() < 1e-7);
                        prop_assert!((accelerations[joint] - last.2[joint]).abs() < 1e-5);
                    }
                    prop_assert!(rates[joint].abs() <= share * envelope.joint_speed[joint]);
                    prop_assert!(accelerations[joint].abs() <= envelope.joint_acceleration[joint]);
                    // They stay on the straight line between the ends, so they arrive together.
                    let gone = [angles[0] - from[0], angles[1] - from[1]];
                    prop_assert!((gone[0] * turn[1] - gone[1] * turn[0]).abs() < 1e-12);
                }
                last = (angles, rates, accelerations);
            }
        }
        for ((angle, rate), to) in last.0.iter().zip(last.1).zip(to) {
            prop_assert!((angle - to).abs() < 1e-8 && rate.abs() < 1e-9);
        }
    });
    accepted.assert_accepted(0.7);
}

#[test]
fn near_a_singularity_the_path_slows_down() {
    let mut envelope = envelope::<f64>(0.0);
    envelope.workspace.margin = 0.02;
    envelope.joint_speed = [2.0; 2];
    // Two lines of equal length, one in the middle, one that ends near the straight leg.
    let limit = |from: [f64; 2], to: [f64; 2]| {
        let line = PathSegment::line(V::new(from[0], from[1]), V::new(to[0], to[1])).unwrap();
        envelope.check(&line, 1.0).unwrap().speed
    };
    let open = limit([MIDDLE[0], 0.30], [MIDDLE[0], 0.32]);
    let far = limit([MIDDLE[0], 0.4185], [MIDDLE[0], 0.4385]);
    assert!(open > 0.2 && far < 0.25 * open, "{open} m/s and {far} m/s");
}

#[test]
fn a_torque_too_small_to_hold_the_arm_is_refused() {
    let mut envelope = envelope::<f64>(0.0);
    let arm = arm(&envelope);
    envelope.torque = Some(TorqueLimits {
        arm,
        torque: [1.0, 0.01],
    });
    let from = V::new(MIDDLE[0], MIDDLE[1]);
    let line = PathSegment::line(from, from + V::new(0.01, 0.0)).unwrap();
    assert_eq!(
        envelope.check(&line, 0.1).unwrap_err().violation,
        ConstraintViolation::Torque(Joint::Joint4)
    );
}

#[test]
fn a_joint_move_may_change_the_working_mode_but_not_the_assembly() {
    let envelope = envelope::<f64>(0.0);
    let workspace = &envelope.workspace;
    // Leg 1 turns through the pose with A–B–C straight; leg 4 rests.
    let start = workspace
        .tool
        .inverse(V::new(0.02, 0.38), workspace.mode)
        .unwrap();
    let [theta1, .., theta4] = start.angles();
    let to = [theta1 - 0.9, theta4];
    let side = start.assembly();
    let (_, end) = envelope
        .check_joint_move([theta1, theta4], to, side, 1.0)
        .unwrap();
    assert_ne!(end.working_mode(), start.working_mode());
    assert_eq!(end.assembly(), side);
    // A move that continues through the type 2 singularity is refused.
    let refusal = envelope
        .check_joint_move([theta1, theta4], [theta1 + 2.5, theta4], side, 1.0)
        .unwrap_err();
    let parallel = fivebar_kinematics::five_bar::WorkspaceViolation::Margin(Singularity::Parallel);
    assert_eq!(refusal.violation, ConstraintViolation::Workspace(parallel));
    assert!(refusal.fraction > 0.0 && refusal.fraction < 1.0);
}
