//! Stiffness and damping of belts from the simulated arm, whose equations are not those of the search.

use fivebar_design::Noise;
use fivebar_design::identification::{BeltArm, BeltLog, FoundBelt, identify_belt};
use fivebar_files::robot::{Actuator, Robot};
use fivebar_firmware::drives::BrushedCommand;
use fivebar_firmware::io::ActuatorCommand;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{Mismatch, Plant};
use nalgebra::Matrix2;
use std::f64::consts::TAU;

const PERIOD: f64 = 1e-4;
const ROWS: usize = 3000;

/// What a log of a joint tells, of an arm with these belts [N·m/rad] and dampings [N·m·s/rad] whose file has others.
fn found(joint: Joint, belts: [f64; 2], damping: [f64; 2], file: [f64; 2]) -> Option<FoundBelt> {
    let robot = Robot::load("benchtop_belt").unwrap();
    let parameters = robot.plant_parameters().unwrap();
    let pose = robot
        .geometry
        .forward(2.4, 0.9, robot.home_pose().unwrap().assembly())
        .unwrap();
    let mismatch = Mismatch {
        stiffness: Some(belts),
        drive_damping: damping,
        friction: 0.0,
        link_mass: 0.0,
        payload: 0.0,
        ..Mismatch::default()
    };
    let mut plant = Plant::new(&parameters, &mismatch, &pose, 1);
    let drives = robot.drives().unwrap();
    let drive = &drives[joint];
    let mut noise = Noise::new(7);
    let (mut angle, mut torque) = (Vec::new(), Vec::new());
    let (mut first, mut volts) = (None, 0.0);
    let zero = plant.sense().drives.current.map(f64::from)[joint.index()];
    for tick in 0..ROWS {
        let sample = plant.sense();
        let counts = sample.counts[joint];
        let turned = counts.wrapping_sub(*first.get_or_insert(counts));
        angle.push(f64::from(turned) * TAU / (f64::from(drive.encoder_counts) * drive.gear_ratio));
        let current = (f64::from(sample.drives.current[joint]) - zero) * per_code(&robot, joint);
        torque.push(current * per_ampere(drive));
        if tick % 2 == 0 {
            volts = 0.4 + if noise.uniform() < 0.5 { 2.0 } else { -2.0 };
        }
        let mut duty = [0.0; 2];
        duty[joint.index()] = (volts / robot.supply.voltage) as f32;
        let command = ActuatorCommand {
            drives: BrushedCommand { duty },
            enable: [true; 2],
            brake: true,
            tool: 0,
        };
        plant.step(&command, PERIOD);
    }
    let arm = robot.arm().unwrap();
    let rotors = arm.rotor_inertia();
    let shorted = drives.map(|d| per_ampere(&d).powi(2) / d.resistance);
    let known = BeltArm {
        links: arm.mass_matrix(&pose).unwrap() - Matrix2::from_diagonal(&rotors.into()),
        rotors,
        friction: drives.map(|d| d.viscous_friction),
        stiffness: file,
        damping: [8e-3; 2],
        shorted,
        encoder_at_joint: [false; 2],
    };
    let log = BeltLog {
        joint,
        period: PERIOD,
        angle: &angle,
        torque: &torque,
        time_constant: drive.inductance / drive.resistance,
        latency: drive.encoder_latency,
    };
    identify_belt(&known, &log)
}

/// Torque at the joint per current [N·m/A].
fn per_ampere(drive: &Actuator) -> f64 {
    drive.gear_ratio * drive.torque_constant
}

/// A code of the current's sensor [A].
fn per_code(robot: &Robot, joint: Joint) -> f64 {
    f64::from(robot.settings().unwrap().axes[joint].current_per_code)
}

#[test]
fn stiffness_and_damping_of_belts_are_found() {
    let cases = [
        (300.0, 0.03, 300.0),
        (330.0, 0.01, 300.0),
        (700.0, 0.01, 900.0),
        (1250.0, 0.02, 1000.0),
        (2500.0, 0.005, 2500.0),
        (5000.0, 0.01, 4500.0),
        // Loose ones.
        (500.0, 0.01, 2500.0),
        (1000.0, 0.01, 5000.0),
    ];
    for (index, (stiffness, ratio, file)) in cases.into_iter().enumerate() {
        let joint = Joint::ALL[index % 2];
        let damping = 2.0 * ratio * f64::sqrt(stiffness * 61e-6);
        let mut belts = [file; 2];
        belts[joint.index()] = stiffness;
        let found = found(joint, belts, [damping; 2], [file; 2]).expect("it shows");
        println!("{stiffness} {damping} of {file}, {joint}: {found:?}");
        let [k, d] = [found.stiffness[0] / stiffness, found.damping[0] / damping];
        assert!((k - 1.0).abs() < 0.005, "{found:?}");
        assert!((d - 1.0).abs() < 0.1, "{found:?}");
    }
}

#[test]
fn a_broken_belt_shows_none() {
    assert_eq!(
        found(Joint::Joint1, [1.0, 2500.0], [1e-6; 2], [2500.0; 2]),
        None
    );
}
