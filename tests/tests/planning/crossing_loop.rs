//! Crossings in closed loop on the simulated arm: it arrives, or its torque ends.

use crate::crossing::{case, number, pair, robot};
use fivebar_design::crossing::CrossingControl;
use fivebar_files::robot::Robot;
use fivebar_plant::Mismatch;
use fivebar_report::study::crossing::task;
use fivebar_sim::crossing::{CrossingConditions, CrossingRun, follow};
use oorandom::Rand64;
use serde_json::Value;

fn crossed(case: &Value, robot: &Robot, time: f64, conditions: &CrossingConditions) -> CrossingRun {
    let task = task(robot, [pair(&case["start"]), pair(&case["end"])], time).unwrap();
    let plan = task.plan().unwrap();
    follow(robot, &task, &plan, conditions).unwrap()
}

fn allowed(case: &Value) -> Robot {
    robot(case, "[crossing]\nallowed = true\n")
}

#[test]
fn the_arm_reaches_the_other_assembly_mode_under_the_declared_mismatch() {
    for (name, most) in [("short", 2e-4), ("pinched", 6e-4)] {
        let case = case(name);
        let robot = allowed(&case);
        for (mismatch, most) in [(Mismatch::NONE, 2e-5), (Mismatch::default(), most)] {
            let conditions = CrossingConditions {
                mismatch,
                ..CrossingConditions::default()
            };
            let run = crossed(&case, &robot, number(&case["tf"]), &conditions);
            assert_eq!(run.assembly.to_string(), "right", "{name}");
            assert!(run.tip_error < most, "{name}: {} m", run.tip_error);
            assert_eq!(run.saturated_ticks, 0, "{name}");
            assert_eq!(run.unpowered_at, None, "{name}");
        }
    }
}

#[test]
fn the_plan_s_torque_is_continuous_through_the_singularity() {
    // Of the reference, from both sides.
    for (name, expected) in [("short", [0.0426, 0.0274]), ("pinched", [0.0104, -0.0444])] {
        let case = case(name);
        let robot = allowed(&case);
        let ends = [pair(&case["start"]), pair(&case["end"])];
        let task = task(&robot, ends, number(&case["tf"])).unwrap();
        let plan = task.plan().unwrap();
        let period = 1e-4;
        let control = CrossingControl::new(&task, &plan, period).unwrap();
        let at = (plan.t_c / period).round() as usize;
        for tick in at - 200..at + 200 {
            let [before, after] = [tick - 1, tick + 1].map(|tick| control.setpoint(tick).torque);
            for j in 0..2 {
                let step = (after[j] - before[j]).abs();
                assert!(
                    step < 1e-3,
                    "{name}: {step} N·m at {tick}, crossing at {at}"
                );
            }
        }
        for (found, expected) in control.setpoint(at).torque.iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-3,
                "{name}: {found}, {expected}"
            );
        }
    }
}

/// With exact angles, because with whole counts the torque steps with each count.
#[test]
fn the_applied_torque_is_continuous_through_the_singularity() {
    for name in ["short", "pinched"] {
        let case = case(name);
        let robot = allowed(&case);
        let ends = [pair(&case["start"]), pair(&case["end"])];
        let task = task(&robot, ends, number(&case["tf"])).unwrap();
        let plan = task.plan().unwrap();
        for mismatch in [Mismatch::NONE, Mismatch::default()] {
            let conditions = CrossingConditions {
                mismatch,
                exact_angles: true,
                ..CrossingConditions::default()
            };
            let run = follow(&robot, &task, &plan, &conditions).unwrap();
            let at = (plan.t_c / 1e-4).round() as usize;
            for tick in at - 20..at + 20 {
                for j in 0..2 {
                    let step = (run.torque[tick + 1][j] - run.torque[tick - 1][j]).abs();
                    assert!(step < 1e-3, "{name}: {step} N·m at {tick}");
                }
            }
        }
    }
}

/// The first random arms of this seed, so many.
fn random_arms_cross(count: usize, name: &str, most: f64, seed: u128) {
    let mut random = Rand64::new(seed);
    let mut between = |least: f64, greatest: f64| least + (greatest - least) * random.rand_float();
    let case = case(name);
    let robot = allowed(&case);
    let ends = [pair(&case["start"]), pair(&case["end"])];
    let task = task(&robot, ends, number(&case["tf"])).unwrap();
    let plan = task.plan().unwrap();
    for _ in 0..count {
        let mismatch = Mismatch {
            link_mass: between(-0.2, 0.2),
            payload: between(-0.02, 0.03),
            friction: between(-0.5, 0.7),
            ..Mismatch::NONE
        };
        let conditions = CrossingConditions {
            mismatch,
            ..CrossingConditions::default()
        };
        let run = follow(&robot, &task, &plan, &conditions).unwrap();
        assert_eq!(run.assembly.to_string(), "right", "{mismatch:?}");
        assert!(run.tip_error < most, "{} m, {mismatch:?}", run.tip_error);
    }
}

#[test]
fn random_arms_cross_on_a_short_way() {
    random_arms_cross(5, "short", 3e-4, 17);
}

#[test]
fn random_arms_cross_on_a_pinched_way() {
    random_arms_cross(5, "pinched", 8e-4, 18);
}

#[test]
#[ignore = "half a minute: ./ci.sh tables"]
fn whole_table_of_a_hundred_random_arms_that_cross() {
    random_arms_cross(50, "short", 3e-4, 17);
    random_arms_cross(50, "pinched", 8e-4, 18);
}

/// The time for which the plan is in the zone, |sin(θ3−θ2)| < 0.2, and that at which it enters it [s].
fn zone(control: &CrossingControl<'_>, period: f64) -> [f64; 2] {
    let ticks = control.most_in_zone() / 2;
    let sine = |tick: usize| control.setpoint(tick).sine.abs();
    let first = (0..).find(|&tick| sine(tick) < 0.2).unwrap();
    [ticks, first].map(|ticks| period * ticks as f64)
}

#[test]
fn a_stuck_arm_loses_its_torque_in_the_stated_time() {
    let case = case("short");
    let robot = allowed(&case);
    let time = 1.2;
    let ends = [pair(&case["start"]), pair(&case["end"])];
    let task = task(&robot, ends, time).unwrap();
    let control = CrossingControl::new(&task, &task.plan().unwrap(), 1e-4).unwrap();
    let [planned, enters] = zone(&control, 1e-4);
    let with = |drag: f64, drag_below: Option<f64>| {
        let conditions = CrossingConditions {
            mismatch: Mismatch::default(),
            drag,
            drag_below,
            exact_angles: false,
        };
        crossed(&case, &robot, time, &conditions)
    };
    // Blocked in the zone: twice the time that the plan takes there, and a tick.
    let blocked = with(30.0, Some(0.1));
    let at = blocked.unpowered_at.expect("the torque ends");
    assert!(
        (at - enters - 2.0 * planned).abs() < 0.02,
        "{at} s, entered at {enters} s, {planned} s planned"
    );
    assert_eq!(blocked.assembly.to_string(), "left");
    assert_eq!(blocked.torque.last(), Some(&[0.0; 2]));
    // Blocked before it: by the error of the cranks.
    let before = with(30.0, None);
    assert!(before.unpowered_at.expect("the torque ends") < enters);
    // Free: through.
    assert_eq!(with(0.0, None).unpowered_at, None);
}
