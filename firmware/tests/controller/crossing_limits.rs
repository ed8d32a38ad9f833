//! The joint limits while the arm crosses a singularity.

use crate::crossing_rig::{PLAN, Rig, START, settings};
use fivebar_firmware::planner::Planner;
use fivebar_firmware::safety::{Fault, State};

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
