//! How `fivebar drive` makes the joint angles known: unless they are known, with `--home`, and with `--at`.

use crate::arm;
use fivebar_firmware::ActuatorCommand;
use fivebar_firmware::Request;
use fivebar_firmware::protocol::HostCommand;
use fivebar_firmware::safety::State;
use fivebar_kinematics::five_bar::Joint;
use fivebar_sim::drive::{Drive, DriveError, Homing};
use fivebar_sim::link::{Client, Loopback};
use fivebar_testkit::program;
use std::sync::{Arc, Mutex};

/// A controller with its arm, whose true angles can be seen [rad].
struct Bench {
    client: Client<Loopback>,
    truth: Arc<Mutex<[f64; 2]>>,
}

impl Bench {
    fn new() -> Self {
        let truth = Arc::new(Mutex::new([0.0; 2]));
        let (mut plant, seen) = (arm::plant(), Arc::clone(&truth));
        let period = 1.0 / arm::robot().control.tick_rate;
        let step = move |command: &ActuatorCommand| {
            plant.step(command, period);
            *seen.lock().expect("no panic") = Joint::ALL.map(|j| plant.angle(j));
            plant.sense()
        };
        let line = Loopback::driving(&arm::settings(), Box::new(step)).expect("valid settings");
        let client = Client::open(line).expect("the link works").0;
        Self { client, truth }
    }

    fn home(&mut self, homing: Homing) -> Result<(), DriveError> {
        Drive::new(&mut self.client, &|| false).home(homing)
    }

    fn state(&mut self) -> State {
        self.client.status().expect("the link works").0.state
    }

    fn truth(&self) -> [f64; 2] {
        *self.truth.lock().expect("no panic")
    }

    /// By how much the controller's angles are greater than the true ones [rad].
    fn error(&mut self) -> [f64; 2] {
        let known = self.client.status().expect("the link works").0.angle;
        let truth = self.truth();
        Joint::ALL.map(|j| f64::from(known[j]) - truth[j])
    }

    /// A hand turns the joints to angles that are wrong by this [rad], as far as the controller is told.
    fn at(&mut self, wrong: [f64; 2]) -> Result<(), DriveError> {
        let truth = self.truth();
        let told = Joint::ALL.map(|j| (truth[j] + wrong[j]) as f32);
        self.home(Homing::At(told))
    }
}

#[track_caller]
fn assert_near(error: [f64; 2], expected: [f64; 2]) {
    for j in Joint::ALL {
        assert!((error[j] - expected[j]).abs() < 2e-3, "{error:?} rad");
    }
}

const WRONG: [f64; 2] = [-0.05, 0.04];

#[test]
fn an_arm_that_is_homed_is_homed_again_only_when_it_is_asked_for() {
    let mut bench = Bench::new();
    bench.home(Homing::IfUnknown).expect("homing succeeds");
    assert_near(bench.error(), [0.0; 2]);
    // Angles that are given take the place of those that are known.
    bench.at(WRONG).expect("they are taken");
    assert_near(bench.error(), WRONG);
    bench
        .home(Homing::IfUnknown)
        .expect("nothing is to be done");
    assert_near(bench.error(), WRONG);
    bench.home(Homing::Always).expect("homing succeeds");
    assert_near(bench.error(), [0.0; 2]);
    assert_eq!(bench.state(), State::Stopped);
}

#[test]
fn an_armed_arm_is_switched_off_homed_again_and_left_off() {
    let mut bench = Bench::new();
    bench.home(Homing::IfUnknown).expect("homing succeeds");
    bench.at(WRONG).expect("they are taken");
    let arm = HostCommand::Request(Request::Arm);
    let answer = bench.client.command(arm).expect("the link works");
    answer.expect("it is armed");
    assert_eq!(bench.state(), State::Armed);
    bench.home(Homing::Always).expect("homing succeeds");
    assert_near(bench.error(), [0.0; 2]);
    assert_eq!(bench.state(), State::Stopped);
}

#[test]
fn angles_that_cannot_be_taken_are_refused_and_change_nothing() {
    let mut bench = Bench::new();
    bench.home(Homing::IfUnknown).expect("homing succeeds");
    let outside = bench.home(Homing::At([0.0, 0.0]));
    assert!(
        matches!(outside, Err(DriveError::Refused { .. })),
        "{outside:?}"
    );
    assert_near(bench.error(), [0.0; 2]);
    let arm = HostCommand::Request(Request::Arm);
    let answer = bench.client.command(arm).expect("the link works");
    answer.expect("it is armed");
    let armed = bench.at(WRONG);
    assert!(
        matches!(armed, Err(DriveError::Refused { .. })),
        "{armed:?}"
    );
    assert_near(bench.error(), [0.0; 2]);
}

#[test]
fn homing_and_given_angles_exclude_each_other() {
    let output = program(env!("CARGO_BIN_EXE_fivebar"))
        .args([
            "drive",
            "job.gcode",
            "--port",
            "none",
            "--home",
            "--at",
            "2.2,0.9",
        ])
        .output()
        .expect("it runs");
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(
        message.contains("--home") && message.contains("--at"),
        "{message}"
    );
}
