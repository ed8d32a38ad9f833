//! Random jobs on random arms with steppers: the motion by the motors' torque against the best constant acceleration.
//!
//! Masses with inertias, friction and supply of the simulated arm are each 15 % above or below the file's, other ones in
//! each job. The motion by torque knows the file only. Its rival is what a builder sets for an arm: the greatest
//! acceleration of the tool with which none of the jobs loses a step, found by search, with the jerk that changes it
//! within a swing of the motors, or at once.

use crate::steppers::{resized, run};
use fivebar_design::Noise;
use fivebar_files::robot::{Drive, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_plant::FaultKind;
use fivebar_sim::simulation::Record;
use rayon::prelude::*;
use std::fmt::Write as _;

/// Share of the pull-out torque that the motion by torque takes: that of a robot file that has none.
const SHARE: f64 = 0.6;
/// So large a share that no limit of the torque holds the rival back.
const NO_LIMIT: f64 = 10.0;
/// Accelerations between which the rival is searched [m/s²].
const ACCELERATIONS: [f64; 2] = [4.0, 400.0];
/// Halvings of their logarithm: to 4 %, 2 % of the time.
const HALVINGS: u32 = 7;
/// By how much a number of the simulated arm is off.
const OFF: f64 = 0.15;

/// An arm with its jobs.
struct Arm {
    number: u64,
    size: f64,
    gear_ratio: f64,
    jobs: Vec<Job>,
}

/// A drawing, and how far masses, friction and supply of the simulated arm are off.
struct Job {
    text: String,
    off: [f64; 3],
}

/// Constant accelerations with which jobs lose no step.
#[derive(Clone, Copy)]
struct Rival {
    /// Time in motion, all jobs together [s].
    time: f64,
    /// [m/s²].
    acceleration: f64,
}

impl Arm {
    /// An arm of random size and gear ratio, whose links a time-optimal plan takes, with random jobs.
    fn random(seed: u64, number: u64, jobs: u64) -> Self {
        let mut noise = Noise::new(1000 * seed + number);
        let (size, gear_ratio) = loop {
            let size = 0.7 + 0.7 * noise.uniform();
            let gear_ratio = (20.0 + 40.0 * noise.uniform()).round() / 10.0;
            let robot = robot(size, gear_ratio, SHARE);
            if robot.inertia_ratio().is_some_and(|ratio| ratio < 30.0) {
                break (size, gear_ratio);
            }
        };
        let jobs = (0..jobs).map(|_| Job::random(&mut noise, size)).collect();
        Self {
            number,
            size,
            gear_ratio,
            jobs,
        }
    }

    /// A job with this share of the pull-out torque.
    fn scenario(&self, job: &Job, share: f64) -> Scenario {
        let robot = robot(self.size, self.gear_ratio, share);
        let mut scenario = Scenario::new("random", robot, "random.gcode", job.text.clone());
        let [mass, friction, supply] = job.off;
        (scenario.mismatch.link_mass, scenario.mismatch.friction) = (mass, friction);
        let volts = scenario.robot.supply.voltage * (1.0 + supply);
        scenario
            .initial_faults
            .push(FaultKind::BusVoltage { volts });
        scenario
    }

    /// The times in motion by torque [s], and the full steps lost, of each job.
    fn by_torque(&self) -> Vec<(f64, [i64; 2])> {
        let run = |job| {
            let mut scenario = self.scenario(job, SHARE);
            scenario.time_optimal = Some(SHARE);
            let (summary, record) = run(&scenario);
            let lost = summary.lost_steps.expect("steppers");
            if lost != [0, 0] || !record.faults.is_empty() {
                let (arm, faults) = (self.number, &record.faults);
                println!(
                    "arm {arm}, off {:?}: {lost:?} {faults:?}\n{}",
                    job.off, job.text
                );
            }
            (in_motion(&record), lost)
        };
        self.jobs.iter().map(run).collect()
    }

    /// The shortest time of all these jobs with one acceleration.
    fn rival(&self, jobs: &[Job]) -> Rival {
        let scenarios: Vec<Scenario> = jobs
            .iter()
            .map(|job| self.scenario(job, NO_LIMIT))
            .collect();
        let swing = scenarios[0].robot.swing_period().expect("steppers");
        // The job that lost a step last is tried first.
        let mut order: Vec<usize> = (0..jobs.len()).collect();
        let mut best = Rival {
            time: f64::INFINITY,
            acceleration: 0.0,
        };
        for changes_in in [swing, 1e-3] {
            let mut with = |acceleration: f64| {
                let mut total = 0.0;
                for place in 0..order.len() {
                    let mut scenario = scenarios[order[place]].clone();
                    let motion = &mut scenario.robot.motion;
                    motion.max_acceleration = acceleration;
                    motion.max_jerk = acceleration / changes_in;
                    let Some(time) = without_loss(&scenario) else {
                        order[..=place].rotate_right(1);
                        return None;
                    };
                    total += time;
                }
                Some(total)
            };
            let [mut good, mut bad] = ACCELERATIONS;
            for _ in 0..HALVINGS {
                let middle = (good * bad).sqrt();
                let Some(time) = with(middle) else {
                    bad = middle;
                    continue;
                };
                good = middle;
                if time < best.time {
                    best = Rival {
                        time,
                        acceleration: middle,
                    };
                }
            }
        }
        best
    }
}

impl Job {
    fn random(noise: &mut Noise, size: f64) -> Self {
        let text = drawing(noise, size);
        let mut off = || if noise.integer() < 0 { -OFF } else { OFF };
        let off = [off(), off(), off()];
        Self { text, off }
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

/// A closed line through random points, in millimetres, as fast as the arm can.
fn drawing(noise: &mut Noise, size: f64) -> String {
    let mut point = || [(); 2].map(|()| 100.0 * size * (noise.uniform() - 0.5));
    let mut text = "G21 G90 F300000\nG0 X0 Y0\n".to_owned();
    for _ in 0..6 {
        let [x, y] = point();
        writeln!(text, "G1 X{x:.2} Y{y:.2}").expect("a string");
    }
    text + "G1 X0 Y0\nM2\n"
}

/// The time from the first to the last motion of the job [s].
fn in_motion(record: &Record) -> f64 {
    let samples = record.trace.samples();
    let mut moving = samples
        .iter()
        .filter(|it| it.reference_velocity != [0.0; 2]);
    let first = moving.next().expect("it moves");
    moving.next_back().unwrap_or(first).time - first.time
}

/// The time in motion [s] with no step lost; none with one.
fn without_loss(scenario: &Scenario) -> Option<f64> {
    let (summary, record) = run(scenario);
    let is_whole = summary.lost_steps == Some([0, 0]) && record.faults.is_empty();
    is_whole.then(|| in_motion(&record))
}

/// This many random arms with this many jobs each.
fn arms() -> (u64, Vec<Arm>) {
    let number = |name| std::env::var(name).ok().and_then(|text| text.parse().ok());
    let [seed, arms, jobs] =
        ["STEPPERS_SEED", "STEPPERS_ARMS", "STEPPERS_JOBS"].map(|name| number(name).unwrap_or(1));
    let arms = (1..=arms).map(|number| Arm::random(seed, number, jobs));
    (seed, arms.collect())
}

#[test]
#[ignore = "minutes: scripts/soak.sh steppers"]
fn many_random_arms_lose_no_step() {
    let (seed, arms) = arms();
    let lost: Vec<[i64; 2]> = arms
        .par_iter()
        .flat_map_iter(Arm::by_torque)
        .map(|(_, lost)| lost)
        .collect();
    let whole = lost.iter().filter(|lost| **lost == [0, 0]).count();
    println!("seed {seed}: {whole} of {} jobs lost no step", lost.len());
    assert_eq!(whole, lost.len());
}

#[test]
#[ignore = "minutes: scripts/soak.sh stepper-rivals"]
fn many_random_arms_against_the_best_constant_acceleration() {
    let (seed, arms) = arms();
    arms.par_iter().for_each(|arm| {
        let ours = arm.by_torque();
        let time: f64 = ours.iter().map(|(time, _)| time).sum();
        let lost = ours.iter().filter(|(_, lost)| *lost != [0, 0]).count();
        let rival = arm.rival(&arm.jobs);
        let own = arm.rival(&arm.jobs[..1]);
        println!(
            "| {seed} | {} | {:.2} | {:.1} | {time:.3} | {:.3} | {:.0} | {:.2} | {:.0} | {:.2} | {lost} |",
            arm.number,
            arm.size,
            arm.gear_ratio,
            rival.time,
            rival.acceleration,
            time / rival.time,
            own.acceleration,
            ours[0].0 / own.time,
        );
    });
}
