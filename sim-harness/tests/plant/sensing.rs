//! Encoders with a side, errors and latency; home switches, lengths and torque constants that
//! differ from the file.

use fivebar_files::robot::Robot;
use fivebar_firmware::ActuatorCommand;
use fivebar_firmware::drives::BrushedCommand;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{EncoderSide, Harmonic, Harmonics, Mismatch, Parameters, Plant};
use std::f64::consts::TAU;

const TICK: f64 = 1e-4;
/// Of the benchtop arm.
const GEAR: f64 = 8.0;
const COUNTS: f64 = 16384.0;

fn parameters() -> Parameters {
    Robot::load("benchtop").unwrap().plant_parameters().unwrap()
}

fn plant_of(parameters: &Parameters, mismatch: &Mismatch) -> Plant {
    let home = Robot::load("benchtop").unwrap().home_pose().unwrap();
    Plant::new(parameters, mismatch, &home, 3)
}

fn driven_by(duty: [f32; 2]) -> ActuatorCommand {
    ActuatorCommand {
        drives: BrushedCommand { duty },
        enable: [true; 2],
        brake: false,
        tool: 0,
    }
}

fn harmonics(terms: &[(u32, f64, f64)]) -> Harmonics {
    let terms: Vec<_> = terms
        .iter()
        .map(|&(harmonic, amplitude, phase)| Harmonic {
            harmonic,
            amplitude,
            phase,
        })
        .collect();
    Harmonics::new(&terms).unwrap()
}

#[test]
fn the_measured_angle_of_the_encoders_shaft_has_the_known_and_the_unknown_harmonics() {
    for (side, gear, ratio) in [
        (EncoderSide::Motor, GEAR, GEAR),
        (EncoderSide::Joint, GEAR, 1.0),
        // A motor that turns against its joint.
        (EncoderSide::Motor, -GEAR, -GEAR),
        (EncoderSide::Joint, -GEAR, 1.0),
    ] {
        let mut parameters = parameters();
        parameters.motors[0].gear_ratio = gear;
        parameters.settings.axes[0].gear_ratio = gear as f32;
        let exact = parameters.clone();
        parameters.encoders[0].side = side;
        parameters.encoders[0].error = harmonics(&[(1, 8e-3, 0.3), (2, -3e-3, 1.1)]);
        let mismatch = Mismatch {
            encoder_error: [harmonics(&[(4, 2e-3, -0.7)]), Harmonics::NONE],
            ..Mismatch::NONE
        };
        let (mut plant, mut ideal) = (
            plant_of(&parameters, &mismatch),
            plant_of(&exact, &Mismatch::NONE),
        );
        let duty = -0.06 * gear.signum() as f32;
        let home = ratio * f64::from(parameters.settings.axes[0].home_angle);
        let error = |shaft: f64| {
            8e-3 * (shaft + 0.3).sin() - 3e-3 * (2.0 * shaft + 1.1).sin()
                + 2e-3 * (4.0 * shaft - 0.7).sin()
        };
        let mut greatest = 0.0_f64;
        for _ in 0..1500 {
            plant.step(&driven_by([duty, 0.0]), TICK);
            ideal.step(&driven_by([duty, 0.0]), TICK);
            assert_eq!(plant.state(), ideal.state());
            let shaft = ratio * plant.angle(Joint::Joint1);
            // Counts per turn of the joint, in turns of the encoder's shaft, from home.
            let expected = (error(shaft) - error(home)) / TAU * COUNTS * gear / ratio;
            let [found, other] = [0, 1].map(|j| {
                let counts = [plant.sense().counts[j], ideal.sense().counts[j]];
                f64::from(counts[0].wrapping_sub(counts[1]))
            });
            assert!(
                (found - expected).abs() <= 1.0,
                "{found} counts, not {expected}"
            );
            assert_eq!(other, 0.0);
            greatest = greatest.max(found.abs());
        }
        assert!(greatest > 20.0, "{greatest} counts");
    }
}

#[test]
fn behind_a_spring_the_encoder_sees_its_own_side() {
    for side in [EncoderSide::Motor, EncoderSide::Joint] {
        let mut parameters = parameters();
        parameters.encoders[0].side = side;
        parameters.transmissions[0].stiffness = Some(100.0);
        let mut plant = plant_of(&parameters, &Mismatch::NONE);
        let start = (plant.sense().counts[0], plant.angle(Joint::Joint1));
        let mut greatest = 0.0_f64;
        for _ in 0..300 {
            plant.step(&driven_by([-0.1, 0.0]), TICK);
            let seen = match side {
                EncoderSide::Motor => plant.rotor_angle(Joint::Joint1),
                EncoderSide::Joint => plant.angle(Joint::Joint1),
            };
            let counted = plant.sense().counts[0].wrapping_sub(start.0);
            let turned = (seen - start.1) / TAU * COUNTS * GEAR;
            assert!((f64::from(counted) - turned).abs() <= 1.0);
            greatest =
                greatest.max((plant.rotor_angle(Joint::Joint1) - plant.angle(Joint::Joint1)).abs());
        }
        // The twist is many counts of 48 µrad.
        assert!(greatest > 1e-3, "{greatest} rad");
    }
}

#[test]
fn a_latency_shifts_the_counts_in_time() {
    let ticks = 4.5;
    let mut parameters = parameters();
    parameters.encoders[0].latency = 1.5 * TICK;
    let mismatch = Mismatch {
        encoder_latency: [3.0 * TICK, 0.0],
        ..Mismatch::NONE
    };
    let mut plant = plant_of(&parameters, &mismatch);
    let start = plant.sense().counts;
    let (mut angles, mut fine) = (vec![plant.angle(Joint::Joint1)], Vec::new());
    for tick in 0..400 {
        let duty = if tick / 60 % 2 == 0 { -0.4 } else { 0.35 };
        plant.step(&driven_by([duty, 0.05]), TICK);
        angles.push(plant.angle(Joint::Joint1));
        let counts = plant.sense().counts;
        fine.push(f64::from(counts[0].wrapping_sub(start[0])));
        // The other encoder has none.
        let turned = (plant.angle(Joint::Joint4) - 20_f64.to_radians()) / TAU * COUNTS * GEAR;
        let counted = f64::from(counts[1].wrapping_sub(start[1]));
        assert!((counted - turned).abs() <= 1.1, "{counted}, not {turned}");
    }
    let mut fastest = 0.0_f64;
    for (k, counted) in fine.iter().enumerate().skip(10) {
        // Cubic interpolation between the four ticks around k + 1 − 4.5.
        let i = k + 1 - 5;
        let [a, b, c, d] = [angles[i - 1], angles[i], angles[i + 1], angles[i + 2]];
        let then = (9.0 * (b + c) - a - d) / 16.0;
        let turned = (then - angles[0]) / TAU * COUNTS * GEAR;
        assert!((counted - turned).abs() <= 1.1, "{counted}, not {turned}");
        fastest = fastest.max((angles[k + 1] - then).abs() / (ticks * TICK));
    }
    assert!(fastest > 2.0, "{fastest} rad/s");
}

#[test]
fn the_home_switch_closes_at_the_joint_angle_with_its_error() {
    let error = [0.02, -0.015];
    let mismatch = Mismatch {
        home_error: error,
        stiffness: Some([200.0; 2]),
        ..Mismatch::NONE
    };
    let robot = Robot::load("benchtop").unwrap();
    let parameters = parameters();
    let start = robot.pose_near_home([-0.1, 0.1]).unwrap();
    let mut plant = Plant::new(&parameters, &mismatch, &start, 1);
    let mut closed = [None; 2];
    for _ in 0..2000 {
        plant.step(&driven_by([0.05, -0.05]), TICK);
        let sample = plant.sense();
        for (j, closed) in Joint::ALL.into_iter().zip(&mut closed) {
            if sample.home[j] && closed.is_none() {
                *closed = Some(plant.angle(j));
            }
        }
    }
    for joint in Joint::ALL {
        let at = closed[joint].unwrap() - robot.home[joint];
        assert!((at - error[joint]).abs() < 1e-3, "{joint}: {at}");
    }
}

#[test]
fn the_arm_is_built_with_the_changed_lengths() {
    let mismatch = Mismatch {
        link_length: [1e-4, -2e-4, 3e-4, -4e-4],
        base_length: 5e-4,
        ..Mismatch::NONE
    };
    let parameters = parameters();
    let [l1, l2, l3, l4, base] = parameters.arm.geometry().lengths();
    let lengths = [l1 + 1e-4, l2 - 2e-4, l3 + 3e-4, l4 - 4e-4, base + 5e-4];
    let mut plant = plant_of(&parameters, &mismatch);
    for _ in 0..500 {
        plant.step(&driven_by([-0.05, 0.05]), TICK);
    }
    let changed = fivebar_kinematics::five_bar::Geometry::new(lengths).unwrap();
    let home = Robot::load("benchtop").unwrap().home_pose().unwrap();
    let pose = |geometry: &fivebar_kinematics::five_bar::Geometry<f64>| {
        geometry
            .forward(
                plant.angle(Joint::Joint1),
                plant.angle(Joint::Joint4),
                home.assembly(),
            )
            .unwrap()
            .c
    };
    let off = (plant.tool() - pose(&changed)).norm();
    assert!(off < 1e-9, "{off} m");
    assert!((plant.tool() - pose(parameters.arm.geometry())).norm() > 1e-4);
}

#[test]
fn another_torque_constant_changes_torque_and_back_emf_alike() {
    let mismatch = Mismatch {
        torque_constant: [0.1, -0.2],
        ..Mismatch::NONE
    };
    let plant = plant_of(&parameters(), &mismatch);
    for (motor, constant) in plant
        .model()
        .motors
        .iter()
        .zip([0.0234 * 1.1, 0.0234 * 0.8])
    {
        assert!((motor.torque(2.0) - 16.0 * constant).abs() < 1e-12);
        // At the no-load speed nothing changes the current.
        assert!(motor.current_rate(8.0 * constant * 30.0, 0.0, 30.0).abs() < 1e-9);
    }
}
