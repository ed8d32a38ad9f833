//! Random jobs on random arms with steppers: the motion by the motors' torque against the best constant acceleration.
//!
//! Masses with inertias, friction and supply of the simulated arm are each 15 % above or below the file's. The motion by
//! torque knows the file only. Its rival is searched on that very arm: the greatest acceleration of the tool with which
//! it loses no step, with the jerk that changes it within a swing of the motors, or at once.

use crate::steppers::{resized, run};
use fivebar_design::Noise;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_plant::FaultKind;
use fivebar_sim::simulation::Record;
use std::fmt::Write as _;

/// Accelerations between which the search begins [m/s²].
const ACCELERATIONS: [f64; 2] = [4.0, 400.0];
/// Halvings of their logarithm: to 4 %, 2 % of the time.
const HALVINGS: u32 = 7;

/// One job on one arm.
struct Trial {
    /// Times in motion by torque and by the best constant acceleration [s].
    times: [f64; 2],
    /// That acceleration [m/s²].
    acceleration: f64,
    /// Full steps lost by the motion by torque.
    lost: [i64; 2],
}

/// Steppers turn an arm of this size with this share of their pull-out torque.
fn arm(size: f64, gear_ratio: f64, share: f64) -> Robot {
    let mut robot = resized(size, gear_ratio);
    for actuator in robot.actuators.iter_mut().flatten() {
        if let Some(stepper) = &mut actuator.stepper {
            stepper.torque_share = share;
        }
    }
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

/// The shortest time of a constant acceleration, and that acceleration.
fn rival(scenario: &Scenario) -> [f64; 2] {
    let swing = scenario.robot.swing_period().expect("steppers");
    let mut best = [f64::INFINITY, 0.0];
    for changes_in in [swing, 1e-3] {
        let with = |acceleration: f64| {
            let mut scenario = scenario.clone();
            let motion = &mut scenario.robot.motion;
            motion.max_acceleration = acceleration;
            motion.max_jerk = acceleration / changes_in;
            without_loss(&scenario)
        };
        let [mut good, mut bad] = ACCELERATIONS;
        let Some(mut time) = with(good) else { continue };
        for _ in 0..HALVINGS {
            let middle = (good * bad).sqrt();
            match with(middle) {
                Some(found) => (good, time) = (middle, found),
                None => bad = middle,
            }
        }
        if time < best[0] {
            best = [time, good];
        }
    }
    best
}

fn trial(noise: &mut Noise, size: f64, gear_ratio: f64) -> Trial {
    let text = drawing(noise, size);
    let mut off = || if noise.integer() < 0 { -0.15 } else { 0.15 };
    let (mass, friction, supply) = (off(), off(), off());
    let scenario = |share: f64| {
        let mut robot = arm(size, gear_ratio, share);
        robot.motion.max_speed = 5.0;
        let mut scenario = Scenario::new("random", robot, "random.gcode", text.clone());
        (scenario.mismatch.link_mass, scenario.mismatch.friction) = (mass, friction);
        let volts = 24.0 * (1.0 + supply);
        scenario
            .initial_faults
            .push(FaultKind::BusVoltage { volts });
        scenario
    };
    let mut by_torque = scenario(0.6);
    by_torque.time_optimal = Some(0.7);
    let (summary, record) = run(&by_torque);
    assert!(record.faults.is_empty(), "{:?}", record.faults);
    // No limit of the torque holds the rival back.
    let [time, acceleration] = rival(&scenario(2.0));
    Trial {
        times: [in_motion(&record), time],
        acceleration,
        lost: summary.lost_steps.expect("steppers"),
    }
}

/// This many jobs on each of this many random arms; each is printed as a row of a table.
fn campaign(seed: u64, arms: u64, jobs: u64) -> Vec<Trial> {
    let mut noise = Noise::new(seed);
    let mut trials = Vec::new();
    for number in 1..=arms {
        let (size, gear_ratio) = loop {
            let size = 0.7 + 0.7 * noise.uniform();
            let gear_ratio = (20.0 + 40.0 * noise.uniform()).round() / 10.0;
            if arm(size, gear_ratio, 0.6)
                .inertia_ratio()
                .is_some_and(|ratio| ratio < 30.0)
            {
                break (size, gear_ratio);
            }
        };
        for _ in 0..jobs {
            let trial = trial(&mut noise, size, gear_ratio);
            let ([ours, rivals], [lost1, lost4]) = (trial.times, trial.lost);
            println!(
                "| {number} | {size:.2} | {gear_ratio:.1} | {ours:.3} | {rivals:.3} | {:.0} | {:.2} | {lost1}, {lost4} |",
                trial.acceleration,
                ours / rivals
            );
            trials.push(trial);
        }
    }
    trials
}

#[test]
#[ignore = "minutes an arm: scripts/soak.sh steppers"]
fn many_random_arms_lose_no_step_and_are_faster_than_a_constant_acceleration() {
    let number = |name| std::env::var(name).ok().and_then(|text| text.parse().ok());
    let [seed, arms, jobs] =
        ["STEPPERS_SEED", "STEPPERS_ARMS", "STEPPERS_JOBS"].map(|name| number(name).unwrap_or(1));
    let trials = campaign(seed, arms, jobs);
    let mut ratios: Vec<f64> = trials.iter().map(|it| it.times[0] / it.times[1]).collect();
    ratios.sort_by(f64::total_cmp);
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    println!(
        "{} jobs: ratio {:.2} to {:.2}, mean {mean:.2}, median {:.2}; {} of them at most 0.7",
        ratios.len(),
        ratios[0],
        ratios[ratios.len() - 1],
        ratios[ratios.len() / 2],
        ratios.iter().filter(|&&ratio| ratio <= 0.7).count(),
    );
    assert!(trials.iter().all(|trial| trial.lost == [0, 0]));
}
