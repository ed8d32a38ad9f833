//! The joint limits while the arm crosses a singularity.

use crate::crossing_rig::{PLAN, Rig, START, settings};
use fivebar_firmware::planner::Planner;
use fivebar_firmware::safety::{Fault, State};
use fivebar_kinematics::five_bar::Joint;

/// The planner has checked the plan; the monitor looks where the cranks are, in each tick.
#[test]
fn a_crank_behind_a_joint_limit_while_it_crosses_has_left_the_envelope() {
    let mut rig = Rig::crossing();
    let mut ranges = START.map(|angle| [angle; 2]);
    while rig.controller.state() == State::Crossing {
        if let Some(joints) = rig.follow().joint_reference {
            for ([low, high], angle) in ranges.iter_mut().zip(joints.angle) {
                (*low, *high) = (low.min(angle), high.max(angle));
            }
        }
    }
    let mut passed = 0;
    for joint in 0..2 {
        for (side, end) in ranges[joint].into_iter().enumerate() {
            let start = START[joint];
            if (end - start).abs() < 0.1 {
                continue;
            }
            let mut narrow = settings();
            let limit = 0.5 * (start + end);
            narrow.axes[joint].angle_limits[side] = limit;
            let mut rig = Rig::armed(&narrow);
            // A planner that does not know of the limit.
            rig.planner = Planner::new(&settings().check().unwrap());
            rig.push(0, PLAN).unwrap();
            while rig.controller.state() == State::Crossing {
                rig.follow();
            }
            let fault = rig.controller.status().fault;
            assert_eq!(fault, Some(Fault::Envelope), "joint {joint}, side {side}");
            // In the tick that passes it, and not only behind the crossing.
            let beyond = rig.bench.theta[joint] - f64::from(limit);
            assert!(
                beyond.abs() < 0.05,
                "{beyond} rad beyond, joint {joint}, side {side}"
            );
            passed += 1;
        }
    }
    assert!(passed >= 2, "{ranges:?}");
}

/// The distance of the cranks' ends [m]; the couplers reach 0.24 m.
fn span([theta1, theta4]: [f64; 2]) -> f64 {
    let x = 0.08 + 0.1 * (theta4.cos() - theta1.cos());
    let y = 0.1 * (theta4.sin() - theta1.sin());
    x.hypot(y)
}

/// The cranks move apart by 0.4 rad each, with 5 rad/s, from this tick on.
fn apart_from(tick: u32) -> Rig {
    let mut tolerant = settings();
    tolerant.protection.following_error = 0.5;
    let mut rig = Rig::crossing_with(&tolerant);
    let mut most = 0.0_f64;
    for now in 0..3300 {
        if rig.controller.state() != State::Crossing {
            break;
        }
        let off = (5e-4 * f64::from(now) - 5e-4 * f64::from(tick)).clamp(0.0, 0.4);
        let rate = if off > 0.0 && off < 0.4 { 5.0 } else { 0.0 };
        rig.follow_off([off, -off], [rate, -rate]);
        most = most.max(span(rig.bench.theta));
    }
    // The laws look ahead, by the lag.
    assert!(most > 0.235, "{most} m");
    rig
}

/// Where the plan is far from the singularity, such angles are an error of an encoder.
#[test]
fn cranks_farther_apart_than_the_couplers_reach_disagree_unless_the_plan_is_near_the_singularity() {
    for (tick, within) in [(600, 900), (1450, 2200), (2200, 2900)] {
        let rig = apart_from(tick);
        let fault = rig.controller.fault().unwrap();
        assert_eq!(fault.fault, Fault::EncoderDisagreement, "from {tick}");
        let lasted = fault.tick;
        assert!(lasted < within, "from {tick}: {lasted}");
    }
}

/// The cranks follow their reference up to the singularity; then one goes on, and the other keeps the couplers stretched.
fn stretched_by(joint: Joint) -> (Rig, u32) {
    let mut rig = Rig::crossing();
    for _ in 0..1650 {
        assert_eq!(rig.follow().state, State::Crossing);
    }
    for tick in 0..2000 {
        let before = rig.bench.theta;
        rig.follow();
        let mut theta = rig.bench.theta;
        theta[joint] = before[joint];
        for _ in 0..20 {
            let mut beside = theta;
            beside[joint] += 1e-6;
            let slope = (span(beside) - span(theta)) * 1e6;
            theta[joint] -= ((span(theta) - 0.239_9) / slope).clamp(-1e-2, 1e-2);
        }
        rig.bench.theta = theta;
        if rig.controller.state() != State::Crossing {
            return (rig, tick);
        }
    }
    (rig, 2000)
}

#[test]
fn one_crank_alone_can_keep_an_arm_too_long_in_the_zone() {
    for joint in Joint::ALL {
        let (rig, ticks) = stretched_by(joint);
        let fault = rig.controller.fault().map(|fault| fault.fault);
        assert_eq!(fault, Some(Fault::Envelope), "{joint} after {ticks}");
    }
}

#[test]
fn an_arm_beside_the_end_of_its_crossing_has_crossed_whenever_the_planner_looks() {
    let mut rig = Rig::crossing();
    for tick in 0..3600_u32 {
        // 0.012 rad behind the plan, which takes 3000 ticks.
        let off = (1.2e-4 * (f64::from(tick) - 3020.0)).clamp(0.0, 0.012);
        if tick < 3500 {
            rig.controller.feed_host_timeout();
            if tick < 3020 {
                rig.follow();
                continue;
            }
            let status = rig.follow_alone_off([off, -off], [0.0; 2]);
            assert_eq!(status.state, State::Crossing, "{tick}: {:?}", status.fault);
        } else {
            rig.follow_off([off, -off], [0.0; 2]);
        }
    }
    assert_eq!(rig.controller.state(), State::Armed);
}
