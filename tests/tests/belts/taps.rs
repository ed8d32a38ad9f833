//! A tap at the tool, and how the arm yields to a force of any frequency, both in simulation.

use crate::pushed::{benchtop, pushed};
use fivebar_design::servo::Servo;
use fivebar_files::robot::Robot;
use fivebar_kinematics::five_bar::Pose;
use nalgebra::{Matrix2, Vector2};
use num_complex::Complex;
use std::f64::consts::{PI, TAU};

/// A line to a place where the arm rests for a while after it has begun.
const RESTING: &str = "G21 G90\nM3\nG1 X0.5 F600\nG4 S1.5\nG1 X0.6\n";

/// How long the tip is farther than a tenth of its greatest deviation after a tap [s], by a half-sine of 5 N in 5 ms,
/// of an arm that rests, whose run begins so long after power-up [s].
fn decay(robot: &Robot, begun: f64, direction: Vector2<f64>) -> f64 {
    const REST: f64 = 1.0;
    let tap = |time: f64| {
        let share = (time - begun - REST) / 5e-3;
        let pushes = (0.0..1.0).contains(&share);
        direction
            * if pushes {
                5.0 * (PI * share).sin()
            } else {
                0.0
            }
    };
    let (samples, _) = pushed(robot, RESTING, &tap);
    let tip = |time: f64| {
        let at = samples.partition_point(|sample| sample.time < time);
        samples[at..]
            .iter()
            .take_while(move |sample| sample.time < time + 0.4)
    };
    let before = Vector2::from(tip(REST - 0.01).next().expect("a sample").tool);
    let away = |tool: [f64; 2]| (Vector2::from(tool) - before).norm();
    let greatest = tip(REST)
        .map(|sample| away(sample.tool))
        .fold(0.0, f64::max);
    assert!(greatest > 1e-4, "{greatest} m");
    let late = tip(REST).filter(|sample| away(sample.tool) > 0.1 * greatest);
    late.last().expect("it yields").time - REST
}

/// The period is that of the loop's bandwidth. The belts swing with a shorter one.
#[test]
fn a_tap_decays_to_a_tenth_within_three_periods_of_the_loop() {
    taps_decay(&[700.0]);
}

#[test]
#[ignore = "half a minute: ./ci.sh tables"]
fn whole_table_of_belts_on_which_a_tap_decays() {
    taps_decay(&[300.0, 700.0, 1250.0, 2500.0, 5000.0]);
}

fn taps_decay(belts: &[f64]) {
    for &stiffness in belts {
        let robot = benchtop(stiffness);
        let period = TAU / robot.gains().feedback_bandwidth();
        let documented = if stiffness < 500.0 { 0.13 } else { 0.05 };
        // Homing takes as long in every run.
        let (_, begun) = pushed(&robot, RESTING, &|_| Vector2::zeros());
        for turn in [0.0, 0.25, 0.5, 0.75] {
            let direction = Vector2::new((PI * turn).cos(), (PI * turn).sin());
            let time = decay(&robot, begun, direction);
            println!("{stiffness} N·m/rad: {time:.4} s, period {period:.4} s");
            assert!(
                time < documented && documented < 3.0 * period,
                "{stiffness} {turn}: {time} s, {period} s"
            );
        }
    }
}

/// The poses of a 5 × 5 grid over the joints' limits that are clear of singularities, with the arm's loop there.
fn grid(robot: &Robot) -> Vec<(Pose<f64>, Servo)> {
    let home = robot.home_pose().expect("a home");
    let arm = robot.arm().expect("masses");
    let drives = robot.servos().expect("masses")[0].1.drives;
    let at = |[low, high]: [f64; 2], i: u32| low + (high - low) * f64::from(i) / 4.0;
    let [range1, range4] = robot.limits.angle;
    let poses = (0..25).filter_map(|i| {
        let (theta1, theta4) = (at(range1, i / 5), at(range4, i % 5));
        let pose = arm
            .geometry()
            .forward(theta1, theta4, home.assembly())
            .ok()?;
        let clear = pose.working_mode() == robot.working_mode()
            && pose.nearest_singularity().1 >= robot.limits.singularity_margin;
        clear.then_some(pose)
    });
    let servo = |pose: Pose<f64>| {
        let mass: Matrix2<f64> = arm.mass_matrix(&pose).expect("clear");
        (
            pose,
            Servo::new(mass, drives, 1.0 / robot.control.tick_rate),
        )
    };
    poses.map(servo).collect()
}

/// The greatest compliance of the tip over all frequencies and directions [m/N], from its answers to a push of one
/// tick along x and one along y. A slow line keeps the arm from resting.
fn greatest_compliance(robot: &Robot, pose: &Pose<f64>, tick: f64) -> f64 {
    const FORCE: f64 = 50.0;
    const WINDOW: f64 = 0.6;
    let mut robot = robot.clone();
    let angles = pose.angles();
    robot.home = [angles[0], angles[3]];
    // It is at a limit of a joint.
    robot.limits.angle = [[-6.2, 6.2]; 2];
    robot.limits.singularity_margin = 0.02;
    for drive in robot.actuators.as_mut().expect("drives") {
        drive.encoder_counts = 1 << 19;
        drive.coulomb_friction = 0.0;
    }
    let job = "G21 G90\nM3\nG1 X0.4 F12\n";
    let (still, begun) = pushed(&robot, job, &|_| Vector2::zeros());
    let pushes = [(0.4, Vector2::x()), (0.4 + WINDOW, Vector2::y())];
    let push = |time: f64| {
        let acts = |at: f64| (time - begun - at).abs() < 0.5 * tick;
        let acting = pushes.iter().filter(|(at, _)| acts(*at));
        acting.map(|(_, direction)| direction * FORCE).sum()
    };
    let (moved, _) = pushed(&robot, job, &push);
    let answers = pushes.map(|(at, _)| {
        let window = |time: f64| (at - 0.5 * tick..at + WINDOW).contains(&time);
        let pairs = still
            .iter()
            .zip(&moved)
            .filter(|(sample, _)| window(sample.time));
        let moved = |(still, moved): (&_, &_)| -> Vector2<f64> { tool(moved) - tool(still) };
        pairs.map(moved).collect::<Vec<_>>()
    });
    let omegas = (0..200).map(|i| 30.0 * (0.5 * PI / tick / 30.0).powf(f64::from(i) / 199.0));
    let compliance = |omega: f64| {
        let columns = answers.each_ref().map(|answer| {
            let terms = answer
                .iter()
                .enumerate()
                .map(|(k, moved)| moved.map(|x| Complex::from_polar(x, -omega * tick * k as f64)));
            terms.sum::<Vector2<Complex<f64>>>() / Complex::new(FORCE, 0.0)
        });
        Matrix2::from_columns(&columns).singular_values().max()
    };
    omegas.map(compliance).fold(0.0, f64::max)
}

fn tool(sample: &fivebar_sim::simulation::Sample) -> Vector2<f64> {
    sample.tool.into()
}

/// At every so many poses of the grid, the simulated arm's and the computed one.
fn assert_peaks(stiffness: f64, every: usize) {
    let robot = benchtop(stiffness);
    let gains = robot.gains();
    let belts = gains.belts.expect("the law of belts");
    let tick = 1.0 / robot.control.tick_rate;
    let tool = robot.tool_on_link().expect("a tool");
    let poses = grid(&robot);
    assert!(poses.len() > 12, "{}", poses.len());
    let mut most = 0.0_f64;
    for (pose, servo) in poses.iter().step_by(every) {
        let jacobian = tool.jacobian(pose).expect("clear").matrix();
        let held = belts.map(|belt| belt.bandwidth * belt.bandwidth);
        let held = servo.mass_matrix * Matrix2::from_diagonal(&held.into());
        let springs = Matrix2::identity() / stiffness + held.try_inverse().expect("masses");
        let fixed = (jacobian * springs * jacobian.transpose())
            .singular_values()
            .max();
        let peak = greatest_compliance(&robot, pose, tick) / fixed;
        let computed = servo.disturbance_peak(&servo.law(&gains), &jacobian);
        println!("{:?}: {peak:.3}, computed {computed:.3}", pose.angles());
        assert!(peak <= 2.0, "{stiffness}, {pose:?}: {peak}");
        assert!(
            (peak / computed - 1.0).abs() < 0.1,
            "{stiffness}, {pose:?}: {peak}, {computed}"
        );
        most = most.max(peak);
    }
    println!(
        "{stiffness} N·m/rad: {most:.2} at one in {every} of {} poses",
        poses.len()
    );
}

#[test]
fn the_simulated_arm_yields_to_no_frequency_by_more_than_twice_its_static_compliance() {
    assert_peaks(700.0, 8);
}

#[test]
#[ignore = "a minute: ./ci.sh tables"]
fn whole_table_of_poses_at_which_the_simulated_arm_yields_as_computed() {
    assert_peaks(700.0, 1);
}

#[test]
#[ignore = "a minute for each belt"]
fn simulated_arms_on_all_belts_yield_to_no_frequency_by_more_than_twice_their_static_compliance() {
    for stiffness in [300.0, 1250.0, 2500.0, 5000.0] {
        assert_peaks(stiffness, 1);
    }
}
