//! Random sessions keep the rules of every tick, and reach what the rules are about.

use fivebar_stress::{KINDS, Report, bytes_of, run};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn any_session_keeps_the_rules(bytes in prop::collection::vec(any::<u8>(), 1..300)) {
        if let Err(violation) = run(&bytes) {
            return Err(TestCaseError::fail(violation.to_string()));
        }
    }
}

/// The bytes of a session whose host plans half of its motions itself, on one of three arms.
fn of_planning_host(mut bytes: Vec<u8>, arm: u8) -> Vec<u8> {
    if let Some(flags) = bytes.first_mut() {
        *flags = *flags & 0x1f | 0x20 | (1 + arm % 3) << 6;
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn any_session_of_a_host_that_plans_keeps_the_rules(
        bytes in prop::collection::vec(any::<u8>(), 1..300),
        arm: u8,
    ) {
        if let Err(violation) = run(&of_planning_host(bytes, arm)) {
            return Err(TestCaseError::fail(violation.to_string()));
        }
    }
}

/// Timed moves and streams are taken and followed up to the limits of the joints; others are refused.
#[test]
fn timed_moves_and_streams_of_fixed_seeds_reach_the_limits_of_the_joints() {
    let mut sum = Report::default();
    for seed in 0..48 {
        match run(&of_planning_host(bytes_of(seed, 300), seed as u8)) {
            Ok(report) => sum = sum.plus(report),
            Err(violation) => panic!("seed {seed}: {violation}"),
        }
    }
    let Report {
        timed: [taken, refused],
        reached,
        ..
    } = sum;
    assert!(taken > 100 && refused > 50, "{sum:?}");
    for (kind, times) in KINDS.into_iter().zip(sum.kinds) {
        assert!(times > 0 || !OF_PLANNERS.contains(&kind), "{kind}: {sum:?}");
    }
    assert!(reached.timed > 5_000 && sum.streamed > 5_000, "{sum:?}");
    assert!(
        reached.joint_speed > 0.97 && reached.joint_acceleration > 0.9 && reached.torque > 0.97,
        "{sum:?}"
    );
}

/// The bytes of a session whose arm can cross a singularity.
fn of_crossing_arm(mut bytes: Vec<u8>) -> Vec<u8> {
    if let Some(flags) = bytes.first_mut() {
        *flags = *flags & 0x1f | 0xc0;
    }
    bytes
}

/// The commands of a host that plans.
const OF_PLANNERS: [&str; 4] = ["Timed", "BeginStream", "Point", "EndStream"];

/// A command that no session gives is checked by none.
#[test]
fn sessions_of_fixed_seeds_give_every_command_cross_and_leave_a_way_out() {
    let mut sum = Report::default();
    for seed in 0..48 {
        match run(&of_crossing_arm(bytes_of(seed, 300))) {
            Ok(report) => sum = sum.plus(report),
            Err(violation) => panic!("seed {seed}: {violation}"),
        }
    }
    for (kind, times) in KINDS.into_iter().zip(sum.kinds) {
        assert!(times > 0 || OF_PLANNERS.contains(&kind), "{kind}: {sum:?}");
    }
    let [to_motion, to_reason] = sum.ways_out;
    assert!(sum.crossings > 5 && to_motion > 2 * to_reason, "{sum:?}");
}

/// The same seeds in every run: they show that sessions do more than to be refused.
#[test]
fn sessions_of_fixed_seeds_move_the_arm_near_its_limits_and_raise_faults() {
    let mut sum = Report::default();
    for seed in 0..16 {
        match run(&bytes_of(seed, 300)) {
            Ok(report) => sum = sum.plus(report),
            Err(violation) => panic!("seed {seed}: {violation}"),
        }
    }
    let Report {
        moves: [moves, refused_moves],
        commands: [done, refused],
        faults,
        reached,
        ..
    } = sum;
    assert!(sum.powered > sum.ticks / 20, "{sum:?}");
    assert!(moves > 20 && refused_moves > 50, "{sum:?}");
    assert!(done > 500 && refused > 100 && faults > 2, "{sum:?}");
    assert!(reached.ticks > 5_000, "{sum:?}");
    assert!(
        reached.speed > 0.9 && reached.acceleration > 0.9 && reached.jerk > 0.8,
        "{sum:?}"
    );
}

/// Seeds of sessions that once broke a rule.
#[test]
fn a_refused_dwell_leaves_no_trace_and_an_arm_may_rest_with_a_straight_leg() {
    for seed in [2142, 2623] {
        if let Err(violation) = run(&bytes_of(seed, 600)) {
            panic!("seed {seed}: {violation}");
        }
    }
}
