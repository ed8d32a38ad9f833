//! Homing from wherever an arm may stand: each joint finds its home angle.

use crate::readme_accuracy::{BRAKES, UPRIGHT};
use crate::servo_loop::changed;
use fivebar_files::robot::Robot;
use fivebar_firmware::controller::Request;
use fivebar_firmware::safety::State;
use fivebar_firmware::{Controller, settings::CheckedSettings};
use fivebar_kinematics::five_bar::{Joint, Pose};
use fivebar_plant::{Mismatch, Parameters, Plant};
use oorandom::Rand64;
use std::f64::consts::TAU;

/// |sin(θ3−θ2)| below which the couplers push the cranks.
const CLEAR: f64 = 0.1;
/// Longest homing [s].
const LONGEST: f64 = 30.0;

struct Arm {
    robot: Robot,
    settings: CheckedSettings,
    parameters: Parameters,
}

impl Arm {
    fn new(robot: Robot) -> Self {
        let settings = robot.settings().expect("it has masses");
        Self {
            settings: settings.check().expect("valid settings"),
            parameters: robot.plant_parameters().expect("it has masses"),
            robot,
        }
    }

    /// A pose with random angles within the joint limits.
    fn random_pose(&self, random: &mut Rand64) -> Pose<f64> {
        let side = self
            .robot
            .pose_near_home([0.0; 2])
            .expect("a home pose")
            .assembly();
        loop {
            let [theta1, theta4] = self.settings.axes.map(|axis| {
                let [low, high] = axis.angle_limits.map(f64::from);
                low + (high - low) * random.rand_float()
            });
            if let Ok(pose) = self.robot.geometry.forward(theta1, theta4, side)
                && pose.sin32().abs() > CLEAR
            {
                return pose;
            }
        }
    }

    /// Whether both cranks can turn from a pose to home, at the same speed, clear of singularities of type 2.
    fn way_is_clear(&self, pose: &Pose<f64>) -> bool {
        let [theta1, _, _, theta4] = pose.angles();
        let homes = self.settings.axes.map(|axis| f64::from(axis.home_angle));
        let turns = [(theta1, homes[0]), (theta4, homes[1])]
            .map(|(from, to)| (from, to + ((from - to) / TAU).round() * TAU - from));
        (0..=400).all(|step| {
            let turned = f64::from(step) * 0.01;
            let [theta1, theta4] = turns.map(|(from, to)| from + to.clamp(-turned, turned));
            let pose = self.robot.geometry.forward(theta1, theta4, pose.assembly());
            pose.is_ok_and(|pose| pose.sin32().abs() > CLEAR)
        })
    }

    /// Homes the arm from a pose: how far each joint's angle is off then [rad].
    fn home_from(&self, pose: &Pose<f64>, seed: u64) -> Result<[f64; 2], String> {
        let mut controller = Controller::new(&self.settings);
        let mut plant = Plant::new(&self.parameters, &Mismatch::default(), pose, seed);
        let rate = self.robot.control.tick_rate;
        let mut tick = |controller: &mut Controller| {
            controller.feed_host_timeout();
            let command = controller.tick(&plant.sense());
            plant.step(&command, 1.0 / rate);
        };
        for _ in 0..100 {
            tick(&mut controller);
        }
        let begun = controller.request(Request::Home);
        begun.map_err(|error| error.to_string())?;
        for _ in 0..(LONGEST * rate) as u64 {
            if controller.state() != State::Homing {
                break;
            }
            tick(&mut controller);
        }
        let status = controller.status();
        if !status.homed {
            assert_eq!(status.state, State::Fault);
            return Err(status
                .fault
                .map_or("none".to_owned(), |fault| format!("{fault:?}")));
        }
        Ok(Joint::ALL.map(|joint| f64::from(status.angle[joint]) - plant.angle(joint)))
    }
}

/// Homes an arm from random poses.
fn homes_from_anywhere(robot: Robot, poses: u64) {
    let arm = Arm::new(robot);
    let mut failed = Vec::new();
    for seed in 0..poses {
        let pose = arm.random_pose(&mut Rand64::new(seed.into()));
        let angles = pose.angles();
        match arm.home_from(&pose, seed) {
            Ok(off) if off.iter().all(|off| off.abs() < 1e-3) => {}
            // Couplers that fold onto each other on the way push the cranks.
            Err(fault) if fault == "FollowingError" && !arm.way_is_clear(&pose) => {}
            other => failed.push(format!(
                "{seed}: {:.3} {:.3}: {other:?}",
                angles[0], angles[3]
            )),
        }
    }
    let name = &arm.robot.name;
    assert!(
        failed.is_empty(),
        "{name}: {} of {poses}\n{}",
        failed.len(),
        failed.join("\n")
    );
}

#[test]
fn the_benchtop_arm_homes_from_anywhere_within_its_joint_limits() {
    homes_from_anywhere(Robot::load("benchtop").expect("it is built in"), 12);
}

/// An upright arm with brakes at this rate of the ticks.
fn upright(rate: &str) -> Arm {
    let control = format!("[control]\ntick_rate = {rate}\n\n[limits]");
    Arm::new(changed(
        "benchtop",
        &[UPRIGHT, BRAKES, ("[limits]", &control)],
    ))
}

/// At slow ticks an integral alone would let the arm sag further than [protection] allows, when its brakes release it.
#[test]
fn an_upright_arm_with_brakes_homes_at_every_rate_of_the_ticks() {
    for rate in ["1e3", "2e3", "5e3", "1e4"] {
        let arm = upright(rate);
        let home = arm.robot.home_pose().expect("a home pose");
        let off = arm.home_from(&home, 1);
        assert!(
            off.as_ref()
                .is_ok_and(|off| off.iter().all(|off| off.abs() < 2e-3)),
            "{rate} Hz: {off:?}"
        );
        homes_from_anywhere(arm.robot, 6);
    }
}

/// Without gravity in the torque the arm falls further until the loop holds it.
#[test]
fn brakes_that_release_a_known_arm_at_its_home_angles_do_not_let_it_sag() {
    let arm = upright("1e3");
    let home = arm.robot.home_pose().expect("a home pose");
    let mut controller = Controller::new(&arm.settings);
    let mut plant = Plant::new(&arm.parameters, &Mismatch::NONE, &home, 1);
    let mut moving = 0;
    controller.request(Request::Home).expect("it is stopped");
    for tick in 0..1000 {
        controller.feed_host_timeout();
        let command = controller.tick(&plant.sense());
        plant.step(&command, 1e-3);
        let turned = (plant.angle(Joint::Joint1) - home.angles()[0]).abs();
        assert!(turned < 1.5e-3, "{turned} rad in tick {tick}");
        moving += u32::from(turned > 1e-4);
        if moving == 10 {
            return;
        }
    }
    panic!("the brakes never release it");
}

#[test]
#[ignore = "some seconds: ./ci.sh tables"]
fn whole_table_of_forty_poses_from_which_the_benchtop_arm_homes() {
    homes_from_anywhere(Robot::load("benchtop").expect("it is built in"), 40);
}
