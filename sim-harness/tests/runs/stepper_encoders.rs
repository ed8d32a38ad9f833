//! Steppers with encoders: steps that are lost are a fault, and the arm's place stays known.

use crate::steppers::{benchtop, run};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::controller::Request;
use fivebar_firmware::drives::StepDrives;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{Move, Status};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{FaultKind, Mismatch, PlantFault, StepperPlant};
use fivebar_sim::link::{InProcess, Target};
use fivebar_sim::simulation::Simulate;
use std::collections::VecDeque;
use std::f64::consts::TAU;

const PERIOD: f64 = 1e-4;
/// A full step at the joint [rad].
const FULL_STEP: f64 = TAU / 800.0;

/// The demonstration on motors with these encoders.
fn demonstration(encoder: &str) -> Scenario {
    let keys = format!("kind = \"stepper\"\n{encoder}");
    Scenario::demonstration(benchtop(|text| text.replace("kind = \"stepper\"", &keys)))
}

#[test]
fn encoders_at_motor_or_joint_change_nothing_while_no_step_is_lost() {
    for encoder in [
        "encoder_counts = 4000",
        "encoder_counts = 4096\nencoder_side = \"joint\"",
    ] {
        let (summary, record) = run(&demonstration(encoder));
        assert_eq!(summary.lost_steps, Some([0, 0]));
        assert!(record.faults.is_empty(), "{:?}", record.faults);
        let error = summary.tip_error;
        assert!(error.rms_m < 0.12e-3 && error.max_m < 0.6e-3, "{error:?}");
    }
}

#[test]
fn an_overload_is_noticed_by_the_encoders() {
    for share in [1.3, 0.6] {
        let mut scenario = demonstration("encoder_counts = 4000");
        scenario.robot = benchtop(|text| {
            let keys = "kind = \"stepper\"\nencoder_counts = 4000";
            text.replace("kind = \"stepper\"", keys)
                .replace("torque_share = 0.6", &format!("torque_share = {share:?}"))
        });
        scenario.time_optimal = Some(0.7);
        let (summary, _) = run(&scenario);
        let noticed: &[&str] = if share > 1.0 { &["steps lost"] } else { &[] };
        assert_eq!(summary.faults, noticed, "{share}: {:?}", summary.lost_steps);
    }
}

#[test]
fn an_encoder_that_fails_stops_the_arm() {
    let joint = Joint::Joint1;
    for (kind, fault) in [
        (FaultKind::EncoderDead { joint }, "steps lost"),
        (FaultKind::EncoderGain { joint, gain: 0.5 }, "steps lost"),
        (
            FaultKind::EncoderJump { joint, counts: 900 },
            "encoder jump",
        ),
    ] {
        let mut scenario = demonstration("encoder_counts = 4000");
        scenario.faults.push(PlantFault { at: 0.5, kind });
        let (summary, _) = run(&scenario);
        assert_eq!(summary.faults, [fault], "{kind:?}");
    }
}

/// A controller with its arm, which go on behind a fault.
struct Bench {
    target: InProcess<StepDrives>,
    plant: StepperPlant,
    status: Status,
}

impl Bench {
    /// Homed and armed.
    fn new(scenario: &Scenario) -> Self {
        let robot = &scenario.robot;
        let (parameters, motors) = (robot.plant_parameters().unwrap(), robot.steppers().unwrap());
        let pose = robot.home_pose().unwrap();
        let mut plant = StepperPlant::new(&parameters, &motors, &Mismatch::NONE, &pose, 1);
        let mut target = InProcess::new(&robot.settings().unwrap()).unwrap();
        let (_, status) = target.tick(&plant.sense()).unwrap();
        let mut bench = Self {
            target,
            plant,
            status,
        };
        bench.request(Request::Home);
        bench.run_until(|status| status.homed && status.state == State::Stopped);
        bench.request(Request::Arm);
        bench
    }

    fn request(&mut self, request: Request) {
        self.target.request(request).unwrap();
    }

    fn tick(&mut self) {
        let (command, status) = self.target.tick(&self.plant.sense()).unwrap();
        self.status = status;
        self.plant.step(&command, PERIOD);
    }

    fn run_until(&mut self, is_reached: impl Fn(&Status) -> bool) {
        for _ in 0..600_000 {
            self.tick();
            if is_reached(&self.status) {
                return;
            }
        }
        panic!("{:?}", self.status);
    }

    /// One tick of these moves; true at their end and at a fault.
    fn advance(&mut self, moves: &mut VecDeque<Move>) -> bool {
        while let Some(next) = moves.front()
            && self.status.fault.is_none()
            && self.target.offer(next).unwrap()
        {
            moves.pop_front();
        }
        self.tick();
        self.status.fault.is_some() || (moves.is_empty() && self.target.is_idle())
    }

    /// By how much the controller's angles are off [rad].
    fn gap(&self) -> f64 {
        let gap = |j| (f64::from(self.status.angle[j]) - self.plant.angle(j)).abs();
        gap(Joint::Joint1).max(gap(Joint::Joint4))
    }
}

#[test]
fn steps_that_a_driver_misses_are_a_fault_within_two_and_the_arm_goes_on_without_homing() {
    for (joint, counts) in [
        (Joint::Joint1, 1600),
        (Joint::Joint4, 4000),
        (Joint::Joint4, 16_384),
    ] {
        let scenario = demonstration(&format!("encoder_counts = {counts}"));
        let moves = scenario.run_moves(&scenario.job().unwrap()).unwrap();
        let mut bench = Bench::new(&scenario);
        let mut job = VecDeque::from(moves.clone());
        // It misses all pulses in one direction.
        let speed = |status: &Status| {
            status
                .joint_reference
                .map_or(0.0, |it| it.velocity[joint].abs())
        };
        while speed(&bench.status) < 1.5 {
            assert!(!bench.advance(&mut job), "{:?}", bench.status.fault);
        }
        let steps = 2;
        let missed = FaultKind::StepLost { joint, steps };
        bench.plant.arm_mut().inject(missed);
        // In the tick in which it is raised, the joint is off by two full steps at most.
        let (mut off, mut wanted) = (0.0, 0.0);
        while bench.status.fault.is_none() {
            off = (bench.plant.angle(joint) - wanted).abs() / FULL_STEP;
            assert!(!bench.advance(&mut job) || bench.status.fault.is_some());
            let reference = bench.status.joint_reference;
            wanted = reference.map_or(wanted, |it| f64::from(it.angle[joint]));
        }
        assert_eq!(bench.status.fault, Some(Fault::StepsLost), "{joint}");
        assert!((0.8..2.0).contains(&off), "{off} full steps");

        // Without power it comes to rest; its place is known to some counts.
        let fine = 3.0 * TAU / (4.0 * f64::from(counts));
        for _ in 0..3000 {
            bench.tick();
        }
        assert!(bench.plant.current().iter().all(|&current| current < 1e-6));
        assert!(bench.gap() < fine, "{} rad", bench.gap());
        bench.request(Request::ClearFault);
        bench.request(Request::Arm);
        bench.run_until(|status| status.state == State::Armed);
        let mut job = VecDeque::from(moves);
        while !bench.advance(&mut job) {}
        assert_eq!(bench.status.fault, None, "{joint}");
        for _ in 0..3000 {
            bench.tick();
        }
        assert!(
            bench.status.homed && bench.gap() < fine,
            "{} rad",
            bench.gap()
        );
        // And it is where it should be, but for micro-steps and what friction holds.
        let reference = bench.status.joint_reference.unwrap().angle;
        for j in Joint::ALL {
            let off = (bench.plant.angle(j) - f64::from(reference[j])).abs();
            assert!(off < 0.8 * FULL_STEP, "{} full steps", off / FULL_STEP);
        }
    }
}

#[test]
fn a_step_that_a_driver_misses_is_made_good_at_the_next_rest() {
    for joint in Joint::ALL {
        let scenario = demonstration("encoder_counts = 4000");
        let mut moves = VecDeque::from(scenario.run_moves(&scenario.job().unwrap()).unwrap());
        let mut bench = Bench::new(&scenario);
        let reference = |status: &Status| status.joint_reference.map(|it| it.angle[joint].into());
        let (mut farthest, mut is_missed) = (0.0_f64, false);
        while !bench.advance(&mut moves) {
            let speed = bench
                .status
                .joint_reference
                .map_or(0.0, |it| it.velocity[joint].abs());
            if speed > 0.4 && !is_missed {
                let missed = FaultKind::StepLost { joint, steps: 1 };
                bench.plant.arm_mut().inject(missed);
                is_missed = true;
            }
            let wanted = reference(&bench.status).unwrap_or(bench.plant.angle(joint));
            farthest = farthest.max((bench.plant.angle(joint) - wanted).abs());
        }
        let farthest = farthest / FULL_STEP;
        assert!(farthest > 0.8, "{joint}: {farthest} full steps");
        for _ in 0..5000 {
            bench.tick();
        }
        assert_eq!(bench.status.fault, None, "{joint}");
        let wanted = bench.status.reference.expect("a pose").map(f64::from);
        let off = (bench.plant.tool() - nalgebra::Vector2::from(wanted)).norm();
        assert!(off < 0.2e-3, "{joint}: {off} m at the tool");
    }
}

#[test]
fn brakes_that_fail_under_an_upright_arm_are_found_and_its_steppers_hold_it() {
    let keys = "kind = \"stepper\"\nencoder_counts = 4000\nbrake_torque = 2.0\nbrake_engage_time = 0.03\n\
                brake_release_time = 0.03";
    let robot = benchtop(|text| {
        text.replace("kind = \"stepper\"", keys)
            .replace("gravity = [0.0, 0.0]", "gravity = [0.0, -9.81]")
    });
    for fails in [false, true] {
        let mut bench = Bench::new(&Scenario::demonstration(robot.clone()));
        bench.run_until(|status| status.state == State::Armed);
        for _ in 0..5000 {
            bench.tick();
        }
        let before = Joint::ALL.map(|joint| bench.plant.angle(joint));
        if fails {
            for joint in Joint::ALL {
                let fault = FaultKind::BrakeFails { joint };
                bench.plant.arm_mut().inject(fault);
            }
        }
        bench.request(Request::Disarm);
        bench.run_until(|status| status.state != State::Armed);
        for _ in 0..5000 {
            bench.tick();
        }
        let fell = Joint::ALL.map(|joint| (bench.plant.angle(joint) - before[joint]).abs());
        let farthest = fell[0].max(fell[1]);
        let expected = fails.then_some(Fault::BrakeFailed);
        assert_eq!(bench.status.fault, expected, "it fell {farthest} rad");
        // Held where it was found to fall, or by the brakes.
        assert!(farthest < if fails { 0.06 } else { 2e-3 }, "{farthest} rad");
        assert!(bench.status.homed && bench.gap() < 4e-3, "{}", bench.gap());
    }
}
