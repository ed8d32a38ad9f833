//! Motors and belts of an arm on a CAN bus against closed forms, and its energy: cogging, torque ripple, and a spring between
//! rotor and joint.

use fivebar_firmware::Settings;
use fivebar_firmware::drives::can::mit::{self, Ranges};
use fivebar_firmware::drives::can::{Frame, Protocol, odrive};
use fivebar_kinematics::five_bar::{Joint, Pose};
use fivebar_plant::{CanDrive, CanPlant, FaultKind, Mismatch, Parameters, RipplePeriods};
use std::f64::consts::PI;

const TICK: f64 = 1e-3;
const GEAR: f64 = 3.0;
const ROTOR: f64 = 3e-5;
const NODES: [u8; 2] = [1, 2];
const RANGES: Ranges = Ranges {
    position: 12.5,
    velocity: 100.0,
    torque: 2.0,
};
const PROTOCOLS: [Protocol; 2] = [Protocol::Odrive, Protocol::Mit(RANGES)];

/// An arm with joints of this Coulomb friction [N·m], and no other.
fn parameters(coulomb_friction: f64) -> Parameters {
    let mut settings = Settings::BENCHTOP;
    for axis in &mut settings.axes {
        axis.gear_ratio = GEAR as f32;
        axis.rotor_inertia = ROTOR as f32;
    }
    let mut parameters = Parameters::from_settings(&settings, 24.0).unwrap();
    for motor in &mut parameters.motors {
        (motor.viscous_friction, motor.coulomb_friction) = (0.0, coulomb_friction);
    }
    parameters
}

fn pose_at([theta1, theta4]: [f64; 2]) -> Pose<f64> {
    let geometry = parameters(0.0).arm.geometry().to_owned();
    let assembly = Settings::BENCHTOP.assembly();
    geometry.forward(theta1, theta4, assembly).unwrap()
}

fn arm(protocol: Protocol, friction: f64, mismatch: &Mismatch, angles: [f64; 2]) -> CanPlant {
    let drive = |node| CanDrive {
        node,
        gear_ratio: GEAR,
        rotor_inertia: ROTOR,
        peak_torque: 1.0,
        lag: 3e-4,
        watchdog: 2e-3,
    };
    let bus = (protocol, NODES.map(drive));
    CanPlant::new(&parameters(friction), bus, mismatch, &pose_at(angles), 1)
}

/// The frames of torques at the shafts [N·m].
fn torques(protocol: Protocol, torque: [f32; 2]) -> [Frame; 2] {
    [0, 1].map(|j| match protocol {
        Protocol::Odrive => odrive::set_input(NODES[j], 0.0, 0.0, torque[j]),
        Protocol::Mit(ranges) => {
            let command = mit::Command {
                torque: torque[j],
                ..mit::Command::default()
            };
            Frame::new(NODES[j].into(), command.encode(&ranges))
        }
    })
}

/// Lets drives follow torques, which are 0 until then.
fn start(plant: &mut CanPlant, protocol: Protocol) {
    let orders = match protocol {
        Protocol::Odrive => vec![
            NODES.map(odrive::set_mode),
            NODES.map(|node| odrive::set_position_gain(node, 0.0)),
            NODES.map(|node| odrive::set_velocity_gain(node, 0.0)),
            NODES.map(|node| odrive::set_axis_state(node, odrive::CLOSED_LOOP)),
        ],
        Protocol::Mit(_) => vec![NODES.map(|node| mit::enable(node, true))],
    };
    for frames in orders {
        plant.step(&frames, false, 0, TICK);
    }
    for _ in 0..20 {
        plant.step(&torques(protocol, [0.0; 2]), false, 0, TICK);
    }
}

/// Near a position of rest, Nc n θ = π (2 m + 1), the torque is −C Nc n δ: along each eigenvector of the inertia matrix, which
/// here comes from the controller's model, an unpowered arm oscillates at ω² = C Nc n/m.
#[test]
fn cogging_holds_an_unpowered_arm_in_its_positions_of_rest_with_its_frequency() {
    let cogging = 0.03;
    let mismatch = Mismatch {
        cogging: [cogging; 2],
        ..Mismatch::NONE
    };
    let periods = RipplePeriods::OUTRUNNER.cogging * GEAR;
    let rest = [2.3, 0.7]
        .map(|near: f64| (2.0 * (near * periods / (2.0 * PI)).round() + 1.0) * PI / periods);
    let start = [rest[0] + 1e-5, rest[1] - 3e-5];
    let mass = parameters(0.0).arm.mass_matrix(&pose_at(rest)).unwrap();
    let eigen = mass.symmetric_eigen();
    for protocol in PROTOCOLS {
        let mut plant = arm(protocol, 0.0, &mismatch, start);
        for step in 1..=400 {
            plant.step(&[], false, 0, TICK);
            let time = TICK * f64::from(step);
            for (mode, m) in eigen.eigenvalues.iter().enumerate() {
                let column = eigen.eigenvectors.column(mode);
                let along = |angles: [f64; 2]| {
                    column[0] * (angles[0] - rest[0]) + column[1] * (angles[1] - rest[1])
                };
                let found = along(Joint::ALL.map(|j| plant.angle(j)));
                let omega = (cogging * periods / m).sqrt();
                let expected = along(start) * (omega * time).cos();
                assert!(
                    (found - expected).abs() < 1e-8,
                    "{found}, not {expected} at {time} s"
                );
            }
        }
    }
}

/// Against a held joint the belt shows the motor's torque: n τ (1 + r sin Nr n θm) + C sin Nc n θm.
#[test]
fn torque_ripple_and_cogging_follow_the_angle_of_the_rotor_behind_its_belt() {
    let (ripple, cogging, stiffness) = (0.05, 0.03, 400.0);
    let mismatch = Mismatch {
        torque_ripple: [0.0, ripple],
        cogging: [0.0, cogging],
        stiffness: Some([stiffness; 2]),
        drive_damping: [0.3; 2],
        ..Mismatch::NONE
    };
    let per_joint_turn = [
        RipplePeriods::OUTRUNNER.torque,
        RipplePeriods::OUTRUNNER.cogging,
    ]
    .map(|periods| periods * GEAR);
    for protocol in PROTOCOLS {
        let mut least_and_most = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for place in 0..8 {
            let angles = [2.3, 0.7 + 0.021 * f64::from(place)];
            let mut plant = arm(protocol, 0.0, &mismatch, angles);
            start(&mut plant, protocol);
            plant.arm_mut().inject(FaultKind::MotorStalled {
                joint: Joint::Joint4,
            });
            for _ in 0..500 {
                plant.step(&torques(protocol, [0.0, 0.25]), false, 0, TICK);
            }
            let rotor = plant.arm().rotor_angle(Joint::Joint4);
            let sine = per_joint_turn.map(|periods| (periods * rotor).sin());
            let driven = plant.torque()[1];
            let expected = driven * (1.0 + ripple * sine[0]) + cogging * sine[1];
            let found = stiffness * (rotor - plant.angle(Joint::Joint4));
            assert!(
                (driven / (GEAR * 0.25) - 1.0).abs() < 3e-3 && (found - expected).abs() < 1e-6,
                "{protocol:?}: {found}, not {expected} N·m"
            );
            for ([least, most], sine) in least_and_most.iter_mut().zip(sine) {
                *least = least.min(sine);
                *most = most.max(sine);
            }
        }
        for [least, most] in least_and_most {
            assert!(least < -0.6 && most > 0.6, "{least_and_most:?}");
        }
    }
}

/// What the motors give their rotors is stored in arm, rotors, belts and magnets, or lost in friction, belts and flanks.
#[test]
fn the_energy_balance_closes_with_all_effects_of_motors_and_belts() {
    let mismatch = Mismatch {
        torque_ripple: [0.05, 0.03],
        cogging: [0.03, 0.05],
        stiffness: Some([900.0, 400.0]),
        drive_damping: [0.02, 0.01],
        backlash: [5e-4, 1e-3],
        stiction: [0.5, 0.3],
        ..Mismatch::default()
    };
    let h = 1e-4;
    for protocol in PROTOCOLS {
        let mut plant = arm(protocol, 9e-3, &mismatch, [2.2, 0.9]);
        start(&mut plant, protocol);
        let balance = |plant: &CanPlant| {
            let drives = plant.arm().drives().unwrap();
            let stored = drives.stored(plant.arm().model(), plant.arm().state());
            let energy = drives.energy();
            stored - (energy.supplied - energy.lost) - drives.motor_work()
        };
        let begun = balance(&plant);
        let (mut worst, mut moved) = (0.0_f64, 0.0_f64);
        for step in 0..20_000 {
            let time = h * f64::from(step);
            let swing = |rate: f64| (rate * time).sin() as f32;
            let torque = [0.12 * swing(40.0), -0.1 * swing(31.0)];
            // Frames of a millisecond, steps of a tenth of it.
            let frames = torques(protocol, torque);
            let sent = if step % 10 == 0 { &frames[..] } else { &[] };
            plant.step(sent, false, 0, h);
            worst = worst.max((balance(&plant) - begun).abs());
            moved = moved.max((plant.angle(Joint::Joint1) - 2.2).abs());
        }
        let drives = plant.arm().drives().unwrap();
        let (lost, work) = (drives.energy().lost, drives.motor_work());
        assert!(
            moved > 0.05 && lost > 0.05 && work > 0.05,
            "{moved} {lost} {work}"
        );
        assert!(worst < 1e-4 * work, "{worst:e} J of {work} J");
    }
}
