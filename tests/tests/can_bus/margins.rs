//! The margin of the position loop through the bus, from the frequency response of the sampled loop: the controller's law
//! as equations, the drive's loops and delays as transfer functions.

use fivebar_design::servo::BusServo;
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_firmware::drives::can::sensed_after;
use fivebar_firmware::drives::{DriveStiffness, Drives, Stage, TorqueDrives};
use nalgebra::{Complex, Matrix2};
use std::f64::consts::PI;

/// By equations of one joint: the least distance of the open loop from −1 with the arm's inertia off by this factor, and with the drives' spring and
/// damper or without.
fn modulus(robot: &Robot, inertia: f64, with_spring: bool) -> f64 {
    let settings = robot.settings().unwrap().check().unwrap();
    let control = robot.control;
    let period = 1.0 / control.tick_rate;
    let (protocol, drives) = robot.can_bus().unwrap();
    let sensed = f64::from(sensed_after(&protocol, drives.map(|drive| drive.node))[0]);
    let latency = period - sensed;
    let lag = f64::from(TorqueDrives::lag(&settings, Stage::Moves)) + latency;
    let (omega, zeta) = (control.bandwidth, control.damping);
    let m = 1.0 / (1.0 + 2.0 * zeta * omega * lag + (omega * lag).powi(2));
    let (kp, kd) = (m * omega * omega, m * 2.0 * zeta * omega);
    let p = (-control.observer_bandwidth * period).exp();
    let (g1, g2) = (1.0 - p * p, (1.0 - p).powi(2) / period);
    let [spring, _] = DriveStiffness::of(&settings);
    let per_inertia = |value: f32| f64::from(value) / f64::from(settings.nominal_inertia()[0]);
    let (stiffness, damping) = (per_inertia(spring.stiffness), per_inertia(spring.damping));
    let lag_of_drive = drives[0].lag;
    let one = Complex::from(1.0);
    // From the demanded acceleration to the angle, so long after the torque's arrival.
    let joint = |s: Complex<f64>, delay: f64| {
        let current = one / (one + s * lag_of_drive);
        let tracked = one / (one + s * lag_of_drive).powi(2);
        let spring = (stiffness + s * damping * tracked) * current;
        let spring = if with_spring {
            spring
        } else {
            Complex::from(0.0)
        };
        current * (-s * delay).exp() / (s * s * inertia + spring)
    };
    let points = (1..4000).map(|i| f64::from(i) / 4000.0 * PI / period);
    points
        .map(|omega| {
            let z = Complex::new(0.0, omega * period).exp();
            // x = A x z⁻¹ + g (θ − first row of A x z⁻¹): two equations.
            let (a, b) = ((one - g1) / z, (one - g1) * period / z);
            let (c, d) = (Complex::from(-g2) / z, (one - g2 * period) / z);
            let determinant = (one - a) * (one - d) - b * c;
            let angle = ((one - d) * g1 + b * g2) / determinant;
            let speed = (c * g1 + (one - a) * g2) / determinant;
            let ahead = angle + speed * lag;
            let integral = ahead * kp * control.integral_rate * period / (z - one);
            let law = ahead * kp + speed * kd + integral;
            // The held torque, with the frequencies that the sampling folds onto this one.
            let arm: Complex<f64> = (-8..=8)
                .map(|fold| {
                    let s = Complex::new(0.0, omega + 2.0 * PI * f64::from(fold) / period);
                    (one - one / z) / (s * period) * joint(s, 0.2e-3 + latency)
                })
                .sum();
            (one + law * arm).norm()
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn the_loop_through_the_bus_keeps_its_margin_with_and_without_the_drives_spring() {
    let leg = Robot::load("leg").unwrap();
    // The arm's inertia as a share of the model's, and the margins without and with the spring.
    for (inertia, margins) in [
        (0.7, [0.45, 0.78]),
        (1.0, [0.57, 0.80]),
        (1.5, [0.66, 0.83]),
    ] {
        for (with_spring, least) in [false, true].into_iter().zip(margins) {
            let margin = modulus(&leg, inertia, with_spring);
            assert!(margin > least, "{inertia}, {with_spring}: {margin}");
        }
    }
}

/// The slower a drive's current loop, the softer is the spring that leaves the loop a margin.
#[test]
fn slower_drives_get_softer_springs_and_keep_a_margin() {
    for (bandwidth, least) in [
        (2000.0, 0.58),
        (1500.0, 0.47),
        (1000.0, 0.41),
        (700.0, 0.36),
    ] {
        let text = BuiltIn::find("leg").unwrap().text;
        let slower = text.replace("= 3000.0", &format!("= {bandwidth:?}"));
        let leg = Robot::parse("leg.toml", &slower).unwrap();
        let margin = modulus(&leg, 0.7, true);
        assert!(margin > least, "{bandwidth} rad/s: {margin}");
    }
}

/// The study's loop of two joints, for an arm of which no joint moves the other.
#[test]
fn the_study_of_margins_agrees_with_the_equations_of_one_joint() {
    let leg = BuiltIn::find("leg").unwrap().text;
    let mit = leg.replace(
        "protocol = \"odrive\"",
        "protocol = \"mit\"\nposition_range = 12.5\nvelocity_range = 640.0\ntorque_range = 2.0",
    );
    for (name, text) in [("leg", leg), ("mit", mit.as_str())] {
        let leg = Robot::parse(name, text).unwrap();
        let gains = leg.gains();
        let servos = leg.bus_servos().unwrap().unwrap().servos;
        let (_, mut servo) = servos[0];
        let [mut first, _] = servo.drives;
        first.drive.viscous_friction = 0.0;
        first.arrival = 0.2e-3;
        servo.drives = [first; 2];
        let settings = leg.settings().unwrap().check().unwrap();
        let inertia = f64::from(settings.nominal_inertia()[0]);
        servo.mass_matrix = Matrix2::from_diagonal_element(inertia);
        let law = servo.law(&gains);
        for factor in [0.7, 1.0, 1.5] {
            let mut arm = servo;
            arm.mass_matrix *= factor;
            let margins = BusServo::margins(&arm.loci(&law)).unwrap();
            let by_one = modulus(&leg, factor, true);
            assert!(
                (margins.modulus - by_one).abs() < 3e-3,
                "{name}, {factor}: {} for {by_one}",
                margins.modulus
            );
        }
    }
}

/// Springs four times as stiff, with dampers twice as strong, swing where the arm is lightest: of the range of inertias, by
/// Nyquist's criterion at all poses. Those in use do not.
#[test]
fn stiffer_springs_would_swing_in_some_pose_of_a_lighter_arm() {
    let text = BuiltIn::find("leg").unwrap().text;
    let leg = Robot::parse("leg.toml", &text.replace("= 3000.0", "= 1000.0")).unwrap();
    let found = leg.bus_servos().unwrap().unwrap();
    let swings = |times: f64| {
        let arms = found.servos.iter().zip(&found.unlike);
        let unstable = arms.flat_map(|((_, servo), unlike)| {
            let law = servo.law(&leg.gains());
            unlike.map(|mut arm| {
                for drive in &mut arm.drives {
                    drive.stiffness *= times * times;
                    drive.damping *= times;
                }
                BusServo::margins(&arm.loci(&law)).is_none()
            })
        });
        unstable.filter(|unstable| *unstable).count()
    };
    assert_eq!(swings(1.0), 0);
    assert!(swings(2.0) > 0);
}
