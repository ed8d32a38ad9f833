//! Whether the controller tells in which assembly mode the arm is behind a singularity, on the simulated arm.

use crate::crossing::{case, number};
use crate::crossing_arm::{Arm, Ending, cross};
use crate::crossing_controller::allowed;
use fivebar_firmware::safety::Fault;
use fivebar_plant::Mismatch;
use oorandom::Rand64;
use serde_json::Value;

impl Ending {
    /// The other assembly mode, and known to be.
    fn assert_crossed(&self) {
        assert!(
            self.fault.is_none() && self.homed && self.powered,
            "{self:?}"
        );
        assert!(self.sine < 0.0 && !self.saturated, "{self:?}");
        assert!(self.tip_error < 1.5e-3 && self.ratio < 0.15, "{self:?}");
    }

    /// The first assembly mode, and known not to be the other one.
    fn assert_caught(&self) {
        assert_eq!(self.fault, Some(Fault::AssemblyMode), "{self:?}");
        assert!(!self.homed && !self.powered && self.sine > 0.0, "{self:?}");
        assert!(self.ratio > 1.0, "{self:?}");
    }
}

fn run(case: &Value, mismatch: Mismatch, hinder: impl FnMut(&mut Arm, f64)) -> Ending {
    cross(case, allowed(case), mismatch, hinder)
}

/// Puts the links into the first assembly mode once, behind the singularity of a case.
fn falls_back(case: &Value) -> impl FnMut(&mut Arm, f64) {
    let t_c = number(&case["tc"]);
    let mut fallen = false;
    move |arm, time| {
        if !fallen && time > t_c && arm.sine() < -0.05 {
            fallen = true;
            arm.fall_back();
        }
    }
}

/// Random arms, as the reference's: of masses, payload and friction, with the declared mismatch of the sensors.
fn random_arms(count: usize, seed: u128) -> impl Iterator<Item = Mismatch> {
    let mut random = Rand64::new(seed);
    let mut between = move |least: f64, most: f64| least + (most - least) * random.rand_float();
    (0..count).map(move |_| Mismatch {
        link_mass: between(-0.2, 0.2),
        payload: between(-0.02, 0.03),
        friction: between(-0.5, 0.7),
        ..Mismatch::default()
    })
}

/// A crossing of each of these arms, and one that falls back. Returns the greatest ratio of the former, the least
/// one of the latter, and the greatest error of the tip [m].
fn try_arms(name: &str, arms: impl Iterator<Item = Mismatch>) -> (f32, f32, f64) {
    let case = case(name);
    let mut found = (0.0_f32, f32::INFINITY, 0.0_f64);
    for mismatch in arms {
        let crossed = run(&case, mismatch, |_, _| ());
        crossed.assert_crossed();
        let fallen = run(&case, mismatch, falls_back(&case));
        fallen.assert_caught();
        let (right, wrong, tip) = found;
        found = (
            right.max(crossed.ratio),
            wrong.min(fallen.ratio),
            tip.max(crossed.tip_error),
        );
    }
    found
}

/// With the declared mismatch on one way, and with a random one on the other.
#[test]
fn right_crossings_are_confirmed_and_wrong_ones_caught() {
    try_arms("short", [Mismatch::default()].into_iter());
    try_arms("pinched", random_arms(1, 17));
}

#[test]
#[ignore = "ten seconds: ./ci.sh tables"]
fn whole_table_of_arms_whose_crossings_are_confirmed_or_caught() {
    for name in ["short", "pinched"] {
        let stated = [Mismatch::NONE, Mismatch::default()].into_iter();
        try_arms(name, stated.chain(random_arms(5, 17)));
    }
}

#[test]
fn an_arm_that_a_wall_sends_back_is_caught() {
    for mismatch in [Mismatch::NONE, Mismatch::default()] {
        run(&case("short"), mismatch, |arm, _| arm.bounce()).assert_caught();
    }
}

/// The slowest crossing that is not refused.
#[test]
fn slow_crossings_are_told_apart_too() {
    let mut case = case("short");
    let (time, t_c) = (number(&case["tf"]), number(&case["tc"]));
    case["tf"] = 0.8.into();
    case["tc"] = (0.8 * t_c / time).into();
    for mismatch in [Mismatch::NONE, Mismatch::default()] {
        run(&case, mismatch, |_, _| ()).assert_crossed();
        run(&case, mismatch, falls_back(&case)).assert_caught();
    }
}

/// `cargo test -p fivebar-tests --test planning a_hundred -- --ignored --nocapture`; docs/design/time-optimal.md has its
/// figures.
#[test]
#[ignore = "takes a minute"]
fn a_hundred_random_arms_cross_by_the_controller() {
    for name in ["short", "pinched"] {
        let (right, wrong, tip) = try_arms(name, random_arms(100, 18));
        println!(
            "{name}: crossed {right:.3} at most, fallen back {wrong:.1} at least, tip {tip:.5} m"
        );
    }
}
