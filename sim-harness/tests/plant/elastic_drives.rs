//! Drives with stiffness, damping and backlash against their closed forms.

use fivebar_files::robot::Robot;
use fivebar_firmware::ActuatorCommand;
use fivebar_firmware::drives::BrushedCommand;
use fivebar_kinematics::five_bar::{Joint, Pose};
use fivebar_plant::{FaultKind, Mismatch, Parameters, Plant};
use nalgebra::{Matrix2, Vector2};
use std::f64::consts::TAU;

const TICK: f64 = 1e-5;
/// The benchtop rotor's inertia at its joint [kg·m²].
const ROTOR: f64 = 64e-6;

/// The benchtop arm without friction, in the middle of its workspace.
fn frictionless() -> (Parameters, Pose<f64>) {
    let robot = Robot::load("benchtop").unwrap();
    let mut parameters = robot.plant_parameters().unwrap();
    for motor in &mut parameters.motors {
        motor.viscous_friction = 0.0;
        motor.coulomb_friction = 0.0;
    }
    let pose = parameters
        .arm
        .geometry()
        .forward(2.3, 0.7, robot.home_pose().unwrap().assembly());
    (parameters, pose.unwrap())
}

/// The bridges are off, so that the motors do not brake.
const OFF: ActuatorCommand = ActuatorCommand {
    drives: BrushedCommand { duty: [0.0; 2] },
    enable: [false; 2],
    brake: false,
    tool: 0,
};

/// Frequency [Hz] and damping ratio of an oscillation about zero, from the times of its upward
/// crossings and from the peaks between them.
fn oscillation(samples: &[f64]) -> (f64, f64) {
    let mut crossings = Vec::new();
    let mut peaks = vec![0.0_f64];
    for (i, pair) in samples.windows(2).enumerate() {
        if pair[0] < 0.0 && pair[1] >= 0.0 {
            crossings.push(i as f64 + pair[0] / (pair[0] - pair[1]));
            peaks.push(0.0);
        }
        let last = peaks.last_mut().unwrap();
        *last = last.max(pair[1]);
    }
    let cycles = crossings.len() - 1;
    assert!(cycles >= 8, "only {cycles} cycles");
    let frequency = cycles as f64 / (crossings[cycles] - crossings[0]) / TICK;
    // The peaks after the first and the last but one crossing.
    let decrement = (peaks[1] / peaks[cycles]).ln() / (cycles as f64 - 1.0);
    (
        frequency,
        decrement / (decrement * decrement + TAU * TAU).sqrt(),
    )
}

#[test]
fn a_rotor_on_a_held_joint_oscillates_at_the_root_of_k_over_j_with_its_damping_ratio() {
    let (parameters, pose) = frictionless();
    for (stiffness, ratio) in [(300.0, 0.01), (2500.0, 0.01), (5000.0, 0.05)] {
        let damping = 2.0 * ratio * f64::sqrt(stiffness * ROTOR);
        let mismatch = Mismatch {
            stiffness: Some([stiffness; 2]),
            drive_damping: [damping; 2],
            ..Mismatch::NONE
        };
        let mut plant = Plant::new(&parameters, &mismatch, &pose, 1);
        plant.inject(FaultKind::MotorStalled {
            joint: Joint::Joint1,
        });
        let pulse = ActuatorCommand {
            drives: BrushedCommand { duty: [0.2, 0.0] },
            enable: [true, false],
            ..OFF
        };
        for _ in 0..20 {
            plant.step(&pulse, TICK);
        }
        plant.step(&OFF, TICK);
        let mut twist = Vec::new();
        for _ in 0..4000 {
            plant.step(&OFF, TICK);
            twist.push(plant.rotor_angle(Joint::Joint1) - plant.angle(Joint::Joint1));
        }
        let (frequency, found) = oscillation(&twist);
        let natural = (stiffness / ROTOR).sqrt() / TAU;
        let damped = natural * (1.0 - ratio * ratio).sqrt();
        assert!(
            (frequency / damped - 1.0).abs() < 1e-4,
            "{frequency} Hz, not {damped} Hz"
        );
        assert!((found / ratio - 1.0).abs() < 0.01, "{found}, not {ratio}");
    }
}

/// With x = θm − θ, the free arm has ẍ = −(I/Jm + M⁻¹)(k x + d ẋ) for small x, where M is the arm's
/// inertia matrix without rotors, here from the controller's model. Along each eigenvector of M it
/// oscillates at ω² = k (1/Jm + 1/m) with the damping ratio d ω/(2 k).
#[test]
fn the_free_arm_oscillates_at_the_eigenfrequencies_of_both_inertias() {
    let (mut parameters, pose) = frictionless();
    let inertia = parameters.arm.mass_matrix(&pose).unwrap() - Matrix2::identity() * ROTOR;
    // Rotors as heavy as the links, so that both count.
    for motor in &mut parameters.motors {
        motor.rotor_inertia *= 20.0;
    }
    let rotor = 20.0 * ROTOR;
    let eigen = inertia.symmetric_eigen();
    let (stiffness, damping) = (2500.0, 0.02);
    let mismatch = Mismatch {
        stiffness: Some([stiffness; 2]),
        drive_damping: [damping; 2],
        ..Mismatch::NONE
    };
    let mut plant = Plant::new(&parameters, &mismatch, &pose, 1);
    let pulse = ActuatorCommand {
        drives: BrushedCommand { duty: [0.1, 0.05] },
        enable: [true; 2],
        ..OFF
    };
    for _ in 0..10 {
        plant.step(&pulse, TICK);
    }
    plant.step(&OFF, TICK);
    let mut twists = Vec::new();
    for _ in 0..4000 {
        plant.step(&OFF, TICK);
        let twist = Joint::ALL.map(|joint| plant.rotor_angle(joint) - plant.angle(joint));
        twists.push(Vector2::from(twist));
    }
    let frequencies = [0, 1].map(|mode| {
        let along: Vec<f64> = twists
            .iter()
            .map(|x| eigen.eigenvectors.column(mode).dot(x))
            .collect();
        let natural = (stiffness * (1.0 / rotor + 1.0 / eigen.eigenvalues[mode])).sqrt();
        let ratio = 0.5 * damping * natural / stiffness;
        let (frequency, found) = oscillation(&along);
        let damped = natural * (1.0 - ratio * ratio).sqrt() / TAU;
        assert!(
            (frequency / damped - 1.0).abs() < 1e-4,
            "{frequency} Hz, not {damped} Hz"
        );
        assert!((found / ratio - 1.0).abs() < 0.01, "{found}, not {ratio}");
        frequency
    });
    // With a held joint both would be at √(k/Jm).
    let held = (stiffness / rotor).sqrt() / TAU;
    assert!(frequencies.iter().all(|&f| f > 1.2 * held));
    assert!((frequencies[0] - frequencies[1]).abs() > 1.0);
}

/// Against a held joint, a motor torque τ turns the rotor by g/2 + τ/k, forwards and backwards.
#[test]
fn against_a_held_joint_the_rotor_turns_by_the_gap_and_the_deflection() {
    let (parameters, pose) = frictionless();
    let gap = 2e-3;
    // Without a stiffness the flanks have that of a rotor at 2 kHz.
    let flanks = ROTOR * (TAU * 2e3_f64).powi(2);
    for (given, stiffness) in [(Some([900.0; 2]), 900.0), (None, flanks)] {
        let mismatch = Mismatch {
            stiffness: given,
            backlash: [gap; 2],
            drive_damping: given.map_or([0.0; 2], |_| [0.1; 2]),
            ..Mismatch::NONE
        };
        let mut plant = Plant::new(&parameters, &mismatch, &pose, 1);
        plant.inject(FaultKind::MotorStalled {
            joint: Joint::Joint4,
        });
        for sign in [1.0_f32, -1.0, 1.0] {
            let push = ActuatorCommand {
                drives: BrushedCommand {
                    duty: [0.0, 0.1 * sign],
                },
                enable: [false, true],
                ..OFF
            };
            for _ in 0..3000 {
                plant.step(&push, 1e-4);
            }
            let twist = plant.rotor_angle(Joint::Joint4) - plant.angle(Joint::Joint4);
            let torque = 8.0 * 0.0234 * 2.4 / 2.3;
            let expected = f64::from(sign) * (0.5 * gap + torque / stiffness);
            assert!(
                (twist - expected).abs() < 1e-9,
                "{twist} rad, not {expected} rad"
            );
        }
    }
}

/// A joint that friction stops at once follows a slow rotor of amplitude A with the amplitude
/// A − g/2, and stands still while the rotor crosses the gap.
#[test]
fn a_slow_joint_follows_its_rotor_with_half_the_gap_less() {
    let (mut parameters, pose) = frictionless();
    for motor in &mut parameters.motors {
        motor.coulomb_friction = 0.1;
    }
    let gap = 0.02;
    let mismatch = Mismatch {
        backlash: [gap; 2],
        ..Mismatch::NONE
    };
    let mut plant = Plant::new(&parameters, &mismatch, &pose, 1);
    let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    let mut standing = 0.0_f64;
    let mut from = (0.0, 0.0);
    for tick in 0..60_000 {
        let time = 1e-4 * f64::from(tick);
        let push = ActuatorCommand {
            drives: BrushedCommand {
                duty: [0.09 * (TAU * 0.5 * time).sin() as f32, 0.0],
            },
            enable: [true, false],
            ..OFF
        };
        plant.step(&push, 1e-4);
        let angles = [plant.rotor_angle(Joint::Joint1), plant.angle(Joint::Joint1)];
        if time > 2.0 {
            for ([least, most], angle) in ranges.iter_mut().zip(angles) {
                *least = least.min(angle);
                *most = most.max(angle);
            }
            let twist = angles[0] - angles[1];
            if twist.abs() < 0.45 * gap {
                standing = standing.max((angles[1] - from.1).abs());
            } else {
                from = (angles[0], angles[1]);
            }
        }
    }
    let [rotor, joint] = ranges.map(|[least, most]| 0.5 * (most - least));
    assert!(joint > 5.0 * gap, "{joint} rad");
    assert!(
        (rotor - joint - 0.5 * gap).abs() < 0.01 * gap,
        "{rotor} − {joint} rad, not {}",
        0.5 * gap
    );
    assert!(standing < 0.02 * gap, "{standing} rad in the gap");
}
