//! A crossing: what is refused, what its monitors tolerate, and how it ends.

use crate::crossing_rig::{PLAN, Rig, START, settings, strong};
use crate::rig::WAKING_TICKS;
use fivebar_firmware::controller::{Request, RequestError};
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::{AxisSettings, Settings};
use fivebar_firmware::{CrossingMove, FULL_TOOL, Status};
use fivebar_kinematics::five_bar::{Joint, Side};
use nalgebra::Vector2;

#[test]
fn cranks_that_follow_cross_with_little_torque_to_the_other_assembly_mode() {
    let mut rig = Rig::crossing();
    assert_eq!(rig.planner.assembly(), Side::Left);
    let mut most = 0.0_f32;
    for tick in 0..3190 {
        let status = rig.follow();
        assert_eq!(status.state, State::Crossing, "{tick}");
        assert_eq!(status.tag, Some(7));
        most = status
            .torque
            .into_iter()
            .fold(most, |most, torque| most.max(torque.abs()));
    }
    // The plan needs 0.087 N·m with friction.
    assert!((0.08..0.12).contains(&most), "{most} N·m");
    for _ in 0..40 {
        rig.follow();
    }
    let status = rig.follow();
    assert_eq!(status.state, State::Armed);
    let [x, y] = status.tool.unwrap();
    let away = (x - PLAN.to[0]).hypot(y - PLAN.to[1]);
    assert!(away < 1e-4, "{away} m");
    // Moves are checked in this mode now.
    assert_eq!(rig.planner.assembly(), Side::Right);
}

#[test]
fn cranks_that_stay_in_the_zone_lose_their_torque_and_their_angles_in_the_stated_time() {
    let mut rig = Rig::crossing();
    for _ in 0..1650 {
        assert_eq!(rig.follow().state, State::Crossing);
    }
    let mut ticks = 0;
    while rig.tick().state == State::Crossing && ticks < 5000 {
        ticks += 1;
    }
    let fault = rig.controller.fault().unwrap();
    assert_eq!(
        (fault.fault, fault.state),
        (Fault::Envelope, State::Crossing)
    );
    let status = rig.controller.status();
    assert!(!status.homed && status.duty == [0.0; 2]);
    // The plan is in the zone for 39 ms, of which 21 are before the singularity: 78 − 21 ms remain.
    assert!((560..590).contains(&ticks), "{ticks} ticks");
}

#[test]
fn cranks_that_stay_outside_the_zone_are_a_following_error() {
    let mut rig = Rig::crossing();
    for _ in 0..300 {
        assert_eq!(rig.follow().state, State::Crossing);
    }
    for _ in 0..3000 {
        rig.tick();
    }
    // In the crossing, not after its end.
    let fault = rig.controller.fault().unwrap();
    assert_eq!(
        (fault.fault, fault.state),
        (Fault::FollowingError, State::Crossing)
    );
    assert!(!rig.controller.status().homed);
}

/// The planner compares the torques; an arm must not wait for it with power.
#[test]
fn an_assembly_mode_that_nobody_confirms_within_a_tenth_of_a_second_is_a_fault() {
    let mut rig = Rig::crossing();
    let mut ticks = 0;
    while rig.controller.state() == State::Crossing && ticks < 10_000 {
        rig.follow_alone();
        ticks += 1;
    }
    // The plan takes 3000 ticks and the filter's lag.
    assert!((4_000..4_030).contains(&ticks), "{ticks} ticks");
    let status = rig.controller.status();
    assert_eq!(status.fault, Some(Fault::AssemblyMode));
    assert!(!status.homed);
}

/// An arm without torque moves on, perhaps through the singularity.
#[test]
fn an_arm_whose_crossing_is_interrupted_must_be_homed_in_its_first_assembly_mode() {
    for ticks in [1, 1_000, 1_700, 3_000] {
        for request in [Request::Disarm, Request::EmergencyStop] {
            let mut rig = Rig::crossing();
            for _ in 0..ticks {
                rig.follow();
            }
            rig.controller.request(request).unwrap();
            assert!(!rig.tick().homed, "{request:?} after {ticks} ticks");
            let _ = rig.controller.request(Request::ClearFault);
            assert_eq!(
                rig.controller.request(Request::Arm),
                Err(RequestError::NotHomed)
            );
            let assembly = rig.controller.planning_snapshot().assembly;
            assert_eq!(assembly, Side::Left);
        }
    }
}

#[test]
fn a_crossing_waits_until_the_bridges_are_awake() {
    let mut rig = Rig::stopped(&settings());
    rig.controller.request(Request::SetAngles(START)).unwrap();
    rig.controller.request(Request::Arm).unwrap();
    rig.push(0, PLAN).unwrap();
    for _ in 1..WAKING_TICKS {
        rig.controller.feed_host_timeout();
        let command = rig.controller.tick(&rig.bench.sense());
        assert!(
            command.brake && command.drives.duty == [0.0; 2],
            "{command:?}"
        );
    }
    rig.tick();
    let command = rig.controller.tick(&rig.bench.sense());
    assert!(!command.brake);
}

/// The motor currents that the reference needs in an assembly mode [A]; beside the singularity, those demanded.
fn currents_in(side: Side, status: &Status) -> [f64; 2] {
    let settings = settings();
    let arm = *settings.check().unwrap().arm();
    let at = status.joint_reference.unwrap();
    let ([theta1, theta4], [omega1, omega4]) = (at.angle, at.velocity);
    let [alpha1, alpha4] = at.acceleration;
    let geometry = arm.geometry();
    let torque = || {
        let pose = geometry.forward(theta1, theta4, side).ok()?;
        if pose.sin32().abs() < 0.15 {
            return None;
        }
        let velocities = geometry.forward_velocities(&pose, omega1, omega4).ok()?;
        let accelerations = geometry.forward_accelerations(&pose, &velocities, alpha1, alpha4);
        arm.inverse_dynamics(&pose, &velocities, &accelerations.ok()?, Vector2::zeros())
            .ok()
    };
    let Some([torque1, torque4]) = torque() else {
        return status.current_demand.map(f64::from);
    };
    [(torque1, omega1, 0), (torque4, omega4, 1)].map(|(torque, omega, j)| {
        let axis = &settings.axes[j];
        let friction = axis.viscous_friction * omega + axis.coulomb_friction * (omega / 0.1).tanh();
        f64::from((torque + friction) / (axis.gear_ratio * axis.torque_constant))
    })
}

#[test]
fn the_currents_behind_the_singularity_tell_the_assembly_mode() {
    for (side, most, fault) in [
        (Side::Right, 0.05, None),
        (Side::Left, f32::INFINITY, Some(Fault::AssemblyMode)),
    ] {
        let mut rig = Rig::crossing_with(&strong());
        for tick in 0.. {
            let status = rig.follow();
            if status.state != State::Crossing {
                break;
            }
            if tick > 1650 {
                rig.bench.current = currents_in(side, &status);
            }
        }
        let [plan, other] = rig.planner.crossing_evidence();
        let ratio = plan / other;
        assert!(ratio < most, "{side}: {ratio}");
        assert!(fault.is_none() || ratio > 20.0, "{side}: {ratio}");
        let status = rig.tick();
        assert_eq!(status.fault, fault, "{side}");
        assert_eq!(status.homed, fault.is_none());
        if fault.is_some() {
            assert_eq!(status.duty, [0.0; 2]);
            assert_eq!(rig.controller.fault().unwrap().state, State::Crossing);
        }
    }
}

/// Constant currents, as of a broken sensor.
#[test]
fn currents_that_fit_neither_assembly_mode_confirm_none() {
    let mut rig = Rig::crossing_with(&strong());
    let status = loop {
        let status = rig.follow();
        rig.bench.current = [1.5, -1.5];
        if status.state != State::Crossing {
            break status;
        }
    };
    assert_eq!(status.fault, Some(Fault::AssemblyMode));
    // The arm is homed again, and what the last crossing showed is forgotten.
    rig.bench.current = [0.0; 2];
    rig.controller.request(Request::ClearFault).unwrap();
    rig.controller.request(Request::SetAngles(START)).unwrap();
    rig.controller.request(Request::Arm).unwrap();
    for _ in 0..100 {
        rig.tick();
    }
    let status = rig.tick();
    assert_eq!((status.state, status.fault), (State::Armed, None));
}

#[test]
fn a_stop_waits_for_the_end_and_an_emergency_stop_does_not() {
    let mut rig = Rig::crossing();
    for tick in 0..3190 {
        if tick == 1600 {
            rig.controller.request(Request::Stop).unwrap();
        }
        assert_eq!(rig.follow().state, State::Crossing);
    }
    let mut rig = Rig::crossing();
    rig.follow();
    rig.controller.request(Request::EmergencyStop).unwrap();
    assert_eq!(rig.follow().fault, Some(Fault::EmergencyStop));
    assert_eq!(rig.controller.status().duty, [0.0; 2]);
}

#[test]
fn nothing_is_pushed_while_an_arm_crosses() {
    let mut rig = Rig::crossing();
    rig.follow();
    assert_eq!(rig.push(0, PLAN), Err(MoveErrorKind::Full));
}

#[test]
fn what_is_no_crossing_of_this_arm_is_refused() {
    let forbidden = Settings {
        crossing_allowed: false,
        ..settings()
    };
    let refused = Rig::armed(&forbidden).push(0, PLAN);
    assert_eq!(refused, Err(MoveErrorKind::CrossingNotAllowed));
    let refusal = |tool, plan| Rig::armed(&settings()).push(tool, plan);
    assert_eq!(refusal(FULL_TOOL, PLAN), Err(MoveErrorKind::Crossing));
    let [b0, b1, b2] = PLAN.law;
    let [x, y] = PLAN.from;
    for plan in [
        // Not from where the arm is held.
        CrossingMove {
            from: [x, y + 1e-4],
            ..PLAN
        },
        // Another time of the singularity.
        CrossingMove {
            crosses_at: 0.15,
            ..PLAN
        },
        // It ends before the singularity.
        CrossingMove {
            to: [0.05, 0.08],
            ..PLAN
        },
    ] {
        assert_eq!(refusal(0, plan), Err(MoveErrorKind::Crossing), "{plan:?}");
    }
    // s̈ differs by 3.5 1/s² in the singularity.
    let missed = CrossingMove {
        law: [b0, b1, b2 + 10.0],
        ..PLAN
    };
    assert_eq!(refusal(0, missed), Err(MoveErrorKind::CrossingCondition));
    let fast = CrossingMove {
        duration: 0.03,
        crosses_at: 0.0165,
        ..PLAN
    };
    // Friction hides in which assembly mode a slow arm is.
    for (duration, refused) in [(0.7, false), (0.9, true)] {
        let crosses_at = PLAN.crosses_at * (duration / PLAN.duration);
        let slow = CrossingMove {
            duration,
            crosses_at,
            ..PLAN
        };
        let expected = match refused {
            true => Err(MoveErrorKind::IndistinctCrossing),
            false => Ok(()),
        };
        assert_eq!(refusal(0, slow), expected, "{duration} s");
    }
    assert!(matches!(refusal(0, fast), Err(MoveErrorKind::Overload(_))));
}

#[test]
fn a_crossing_waits_for_free_brakes_and_an_arm_that_is_switched_off_has_none() {
    let mut braked = settings();
    braked.brake.engage_time = 0.04;
    braked.brake.release_time = 0.05;
    let mut rig = Rig::armed(&braked);
    assert_eq!(rig.push(0, PLAN), Err(MoveErrorKind::Full));
    for _ in 0..540 {
        rig.follow();
    }
    rig.controller.request(Request::Disarm).unwrap();
    assert!(rig.push(0, PLAN).is_err());
    rig.controller.request(Request::Arm).unwrap();
    for _ in 0..540 {
        rig.follow();
    }
    assert_eq!(rig.push(0, PLAN), Ok(()));
}

#[test]
fn a_plan_with_a_value_that_is_no_number_is_refused_as_one() {
    let nan = f32::NAN;
    let [x, _] = PLAN.from;
    let [b0, b1, _] = PLAN.law;
    for plan in [
        CrossingMove {
            from: [x, nan],
            ..PLAN
        },
        CrossingMove {
            to: [nan, 0.012],
            ..PLAN
        },
        CrossingMove {
            law: [b0, b1, nan],
            ..PLAN
        },
        CrossingMove {
            duration: f32::INFINITY,
            ..PLAN
        },
        CrossingMove {
            crosses_at: nan,
            ..PLAN
        },
        CrossingMove {
            duration: 0.0,
            ..PLAN
        },
    ] {
        let refused = Rig::armed(&settings()).push(0, plan);
        assert_eq!(refused, Err(MoveErrorKind::Number), "{plan:?}");
    }
}

#[test]
fn a_crossing_keeps_each_joints_limits_of_speed_acceleration_and_torque() {
    let refused = |joint: Joint, change: fn(&mut AxisSettings)| {
        let mut weak = settings();
        change(&mut weak.axes[joint]);
        Rig::armed(&weak).push(0, PLAN)
    };
    // The plan needs 2.7 and 7.1 rad/s.
    assert_eq!(refused(Joint::Joint1, |axis| axis.max_speed = 2.9), Ok(()));
    let slow = refused(Joint::Joint1, |axis| axis.max_speed = 2.5);
    assert_eq!(slow, Err(MoveErrorKind::Overload(1)));
    assert_eq!(refused(Joint::Joint4, |axis| axis.max_speed = 7.3), Ok(()));
    let slow = refused(Joint::Joint4, |axis| axis.max_speed = 6.8);
    assert_eq!(slow, Err(MoveErrorKind::Overload(4)));
    let gentle = refused(Joint::Joint4, |axis| axis.max_acceleration = 60.0);
    assert_eq!(gentle, Err(MoveErrorKind::Overload(4)));
    // Friction is a part of the torques: it alone is too much for a weak motor.
    let stiff = refused(Joint::Joint4, |axis| axis.viscous_friction = 0.2);
    assert_eq!(stiff, Err(MoveErrorKind::Overload(4)));
}

#[test]
fn a_crossing_of_more_than_four_seconds_is_too_long() {
    for (duration, refused) in [(3.9, false), (4.1, true)] {
        let crosses_at = PLAN.crosses_at * (duration / PLAN.duration);
        let slow = CrossingMove {
            duration,
            crosses_at,
            ..PLAN
        };
        let answer = Rig::armed(&settings()).push(0, slow);
        assert_eq!(answer == Err(MoveErrorKind::TooLong), refused, "{answer:?}");
    }
}
