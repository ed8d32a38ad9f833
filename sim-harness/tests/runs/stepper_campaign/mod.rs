//! Random jobs on random arms with steppers: the motion by the motors' torque against the best constant acceleration.
//!
//! The simulated arm is not the file's: masses with inertias, and friction, are each 15 % above or below, the torque of
//! each motor is 10 % above or below, other ones in each job; the supply is 15 % below. Nothing else is off: a payload is
//! the file's. The motion by torque knows the file only.
//!
//! A job is drawn if it loses no step and each rotor stays within a full step of its set-point.

mod rival;
mod tables;

use crate::steppers::resized;
use fivebar_design::Noise;
use fivebar_files::robot::{Drive, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::Settings;
use fivebar_firmware::drives::StepDrives;
use fivebar_firmware::settings::FieldLag;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{FaultKind, Mismatch};
use fivebar_sim::link::InProcess;
use fivebar_sim::simulation::Simulate;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Share of the pull-out torque that the motion by torque takes: that of a robot file that has none.
const SHARE: f64 = 0.6;
/// By how much masses and friction are off, as shares.
const MASS: f64 = 0.15;
/// By how much the torque of a motor is off.
const TORQUE: f64 = 0.10;
/// By how much the supply is off.
const SUPPLY: f64 = -0.15;
/// How far a rotor may be from its set-point [full steps]; it slips at two.
const FARTHEST: f64 = 1.0;

/// An arm.
#[derive(Clone, Copy, Debug)]
struct Arm {
    number: u64,
    size: f64,
    gear_ratio: f64,
}

/// A drawing, and the simulated arm that draws it.
struct Job {
    text: String,
    mismatch: Mismatch,
}

/// What became of a job.
#[derive(Clone, Copy, Debug)]
struct Outcome {
    /// From the first to the last motion [s].
    time: f64,
    /// Full steps lost.
    lost: [i64; 2],
    /// The farthest that a rotor was from its set-point [full steps].
    farthest: f64,
    has_fault: bool,
}

impl Arm {
    /// Number 0 is the built-in arm; another one has a random size and gear ratio, with links that a time-optimal plan
    /// takes.
    fn new(seed: u64, number: u64) -> Self {
        let mut noise = Noise::new(1000 * seed + number);
        let (mut size, mut gear_ratio) = (1.0, 4.0);
        let mut is_taken = number == 0;
        while !is_taken {
            size = 0.7 + 0.7 * noise.uniform();
            gear_ratio = (20.0 + 40.0 * noise.uniform()).round() / 10.0;
            let ratio = robot(size, gear_ratio, SHARE).inertia_ratio();
            is_taken = ratio.is_some_and(|ratio| ratio < 30.0);
        }
        Self {
            number,
            size,
            gear_ratio,
        }
    }

    /// Jobs for it, other ones for each seed.
    fn jobs(&self, seed: u64, count: u64) -> Vec<Job> {
        let mut noise = Noise::new(1_000_000 + 1000 * seed + self.number);
        let jobs = (0..count).map(|_| Job::random(&mut noise, self.size));
        jobs.collect()
    }

    /// A job on the simulated arm that is off, with this share of the pull-out torque.
    fn scenario(&self, job: &Job, share: f64) -> Scenario {
        let robot = robot(self.size, self.gear_ratio, share);
        let mut scenario = Scenario::new("random", robot, "random.gcode", job.text.clone());
        scenario.mismatch = job.mismatch;
        let volts = scenario.robot.supply.voltage * (1.0 + SUPPLY);
        let low = FaultKind::BusVoltage { volts };
        scenario.initial_faults.push(low);
        scenario
    }

    /// A job by the motors' torque, with this share of it, by a field that leads by the load and, if `leads_by_lag`, by the
    /// lag above the speed that the supply follows.
    fn by_torque(&self, job: &Job, share: f64, leads_by_lag: bool) -> Outcome {
        let mut scenario = self.scenario(job, share);
        scenario.time_optimal = Some(share);
        Outcome::of(&scenario, |settings| {
            if !leads_by_lag {
                settings.field_lags = [FieldLag::NONE; 2];
            }
        })
    }
}

impl Job {
    /// A closed line through random points, as fast as the arm can, and an arm that is off.
    fn random(noise: &mut Noise, size: f64) -> Self {
        let mut point = || [(); 2].map(|()| 100.0 * size * (noise.uniform() - 0.5));
        let mut text = "G21 G90 F300000\nG0 X0 Y0\n".to_owned();
        for _ in 0..6 {
            let [x, y] = point();
            writeln!(text, "G1 X{x:.2} Y{y:.2}").expect("a string");
        }
        text += "G1 X0 Y0\nM2\n";
        let mut off = |most: f64| if noise.integer() < 0 { -most } else { most };
        let mismatch = Mismatch {
            link_mass: off(MASS),
            friction: off(MASS),
            torque_constant: [off(TORQUE), off(TORQUE)],
            ..Mismatch::NONE
        };
        Self { text, mismatch }
    }
}

impl Outcome {
    /// Of a run whose controller has its settings changed.
    fn of(scenario: &Scenario, change: impl Fn(&mut Settings)) -> Self {
        let mut settings = scenario.robot.settings().expect("masses");
        change(&mut settings);
        let mut target = InProcess::<StepDrives>::new(&settings).expect("settings");
        let moves = scenario.run_moves(&scenario.job().expect("a job"));
        let moves = moves.expect("a plan");
        let run = scenario.run_on(&mut target, &moves, &mut |_| ());
        let (summary, record) = run.expect("a run");
        let motors = scenario.robot.steppers().expect("steppers");
        let samples = record.trace.samples();
        let far = samples.iter().flat_map(|sample| {
            Joint::ALL.map(|j| {
                let steps = motors[j].gear_ratio * f64::from(motors[j].steps_per_turn) / TAU;
                steps * (sample.angle[j] - sample.reference_angle[j]).abs()
            })
        });
        let mut moving = samples
            .iter()
            .filter(|it| it.reference_velocity != [0.0; 2]);
        let first = moving.next().expect("it moves");
        Self {
            time: moving.next_back().unwrap_or(first).time - first.time,
            lost: summary.lost_steps.expect("steppers"),
            farthest: far.fold(0.0, f64::max),
            has_fault: !record.faults.is_empty(),
        }
    }

    fn loses_steps(&self) -> bool {
        self.lost != [0, 0] || self.has_fault
    }

    fn is_drawn(&self) -> bool {
        !self.loses_steps() && self.farthest <= FARTHEST
    }
}

/// Steppers turn an arm of this size with this share of their pull-out torque, and nothing else limits it.
fn robot(size: f64, gear_ratio: f64, share: f64) -> Robot {
    let mut robot = resized(size, gear_ratio);
    for actuator in robot.actuators.iter_mut().flatten() {
        if let Drive::Stepper(stepper) = &mut actuator.drive {
            stepper.torque_share = share;
        }
    }
    robot.limits.max_acceleration = [1e4; 2];
    robot.motion.max_speed = 5.0;
    robot
}
