//! Cogging, torque ripple and the supply's resistance against their closed forms.

use fivebar_files::robot::Robot;
use fivebar_firmware::ActuatorCommand;
use fivebar_firmware::drives::BrushedCommand;
use fivebar_kinematics::five_bar::{Joint, Pose};
use fivebar_plant::{FaultKind, Mismatch, Parameters, Plant, RipplePeriods};
use std::f64::consts::{PI, TAU};

/// Of the benchtop arm: gear ratio, torque constant at the joint [N·m/A], winding [Ω], bus [V].
const GEAR: f64 = 8.0;
const CONSTANT: f64 = 8.0 * 0.0234;
const RESISTANCE: f64 = 2.3;
const BUS: f64 = 24.0;

/// Periods of cogging per turn of the joint.
const PERIODS: f64 = RipplePeriods::BRUSHED.cogging * GEAR;

fn frictionless() -> Parameters {
    let mut parameters = Robot::load("benchtop").unwrap().plant_parameters().unwrap();
    for motor in &mut parameters.motors {
        motor.viscous_friction = 0.0;
        motor.coulomb_friction = 0.0;
    }
    parameters
}

/// The pose at these angles [rad].
fn pose_at(parameters: &Parameters, [theta1, theta4]: [f64; 2]) -> Pose<f64> {
    let home = Robot::load("benchtop").unwrap().home_pose().unwrap();
    let geometry = parameters.arm.geometry();
    geometry.forward(theta1, theta4, home.assembly()).unwrap()
}

/// The arm at these angles [rad].
fn plant_at(parameters: &Parameters, mismatch: &Mismatch, angles: [f64; 2]) -> Plant {
    Plant::new(parameters, mismatch, &pose_at(parameters, angles), 1)
}

fn driven_by(duty: [f32; 2], enable: [bool; 2]) -> ActuatorCommand {
    ActuatorCommand {
        drives: BrushedCommand { duty },
        enable,
        brake: false,
        tool: 0,
    }
}

/// Near a position of rest, N n θ = π (2 m + 1), the torque is −C N n δ: along each eigenvector of the
/// inertia matrix, which here comes from the controller's model, the arm oscillates at
/// ω² = C N n/m.
#[test]
fn cogging_holds_the_arm_in_its_positions_of_rest_with_its_frequency() {
    let parameters = frictionless();
    let cogging = 5e-3;
    let mismatch = Mismatch {
        cogging: [cogging; 2],
        ..Mismatch::NONE
    };
    let rest =
        [2.3, 0.7].map(|near: f64| (2.0 * (near * PERIODS / TAU).round() + 1.0) * PI / PERIODS);
    let start = [rest[0] + 1e-5, rest[1] - 3e-5];
    let mut plant = plant_at(&parameters, &mismatch, start);
    let eigen = parameters
        .arm
        .mass_matrix(&pose_at(&parameters, rest))
        .unwrap()
        .symmetric_eigen();
    let modes: Vec<f64> = eigen
        .eigenvalues
        .iter()
        .map(|m| (cogging * PERIODS / m).sqrt())
        .collect();
    assert!((modes[0] - modes[1]).abs() > 0.02 * modes[0]);
    let off = driven_by([0.0; 2], [false; 2]);
    for step in 1..=3000 {
        plant.step(&off, 1e-4);
        let time = 1e-4 * f64::from(step);
        for (mode, omega) in modes.iter().enumerate() {
            let column = eigen.eigenvectors.column(mode);
            let along = |angles: [f64; 2]| {
                column[0] * (angles[0] - rest[0]) + column[1] * (angles[1] - rest[1])
            };
            let found = along([plant.angle(Joint::Joint1), plant.angle(Joint::Joint4)]);
            let expected = along(start) * (omega * time).cos();
            assert!(
                (found - expected).abs() < 1e-8,
                "{found}, not {expected} at {time} s"
            );
        }
    }
}

/// Against a held joint the spring shows the motor's torque: k (1 + r sin N n θm) i + C sin N n θm.
#[test]
fn torque_ripple_and_cogging_follow_the_angle_of_the_rotor() {
    let parameters = frictionless();
    let (ripple, cogging, stiffness) = (0.05, 4e-3, 40.0);
    let mismatch = Mismatch {
        torque_ripple: [0.0, ripple],
        cogging: [0.0, cogging],
        stiffness: Some([stiffness; 2]),
        drive_damping: [0.05; 2],
        ..Mismatch::NONE
    };
    let mut least_and_most = [f64::INFINITY, f64::NEG_INFINITY];
    for place in 0..12 {
        let angles = [2.3, 0.7 + f64::from(place) * TAU / PERIODS / 12.0];
        let mut plant = plant_at(&parameters, &mismatch, angles);
        plant.inject(FaultKind::MotorStalled {
            joint: Joint::Joint4,
        });
        let duty = if place % 2 == 0 { 0.1 } else { -0.05 };
        for _ in 0..5000 {
            plant.step(&driven_by([0.0, duty], [false, true]), 1e-4);
        }
        let rotor = plant.rotor_angle(Joint::Joint4);
        let current = f64::from(duty) * BUS / RESISTANCE;
        let sine = (PERIODS * rotor).sin();
        let expected = CONSTANT * (1.0 + ripple * sine) * current + cogging * sine;
        let found = stiffness * (rotor - plant.angle(Joint::Joint4));
        assert!(
            (found - expected).abs() < 1e-7,
            "{found}, not {expected} N·m"
        );
        let [least, most] = &mut least_and_most;
        *least = least.min(sine);
        *most = most.max(sine);
    }
    assert!(least_and_most[0] < -0.7 && least_and_most[1] > 0.7);
}

/// Two stalled motors are resistors: V = V₀ − Rs (d₁² + d₄²) V/R.
#[test]
fn the_bus_sags_by_the_resistance_of_the_supply() {
    let parameters = frictionless();
    let resistance = 0.5;
    let mismatch = Mismatch {
        supply_resistance: resistance,
        ..Mismatch::NONE
    };
    for (duty, enable) in [([0.4, -0.3], [true; 2]), ([0.45, 0.7], [true, false])] {
        let mut plant = plant_at(&parameters, &mismatch, [2.3, 0.7]);
        plant.inject(FaultKind::MotorStalled {
            joint: Joint::Joint1,
        });
        plant.inject(FaultKind::MotorStalled {
            joint: Joint::Joint4,
        });
        for _ in 0..200 {
            plant.step(&driven_by(duty, enable), 1e-4);
        }
        // The register holds whole steps of the duty.
        let held = duty.map(|d: f32| (f64::from(d) * 4200.0).round() / 4200.0);
        let load: f64 = (0..2)
            .filter(|&j| enable[j])
            .map(|j| held[j] * held[j] / RESISTANCE)
            .sum();
        let expected = BUS / (1.0 + resistance * load);
        assert!(expected < BUS - 0.5);
        assert!((plant.bus_voltage() - expected).abs() < 1e-6);
        let code = f64::from(plant.sense().drives.bus_voltage) * parameters.volts_per_code;
        assert!((code - expected).abs() <= 0.5 * parameters.volts_per_code + 1e-9);
        let current = plant.state().current[0];
        assert!((current - held[0] * expected / RESISTANCE).abs() < 1e-6);
    }
}

#[test]
fn a_braking_motor_raises_the_bus_and_gives_energy_back() {
    let parameters = frictionless();
    let resistance = 2.0;
    let mismatch = Mismatch {
        supply_resistance: resistance,
        ..Mismatch::NONE
    };
    let mut plant = plant_at(&parameters, &mismatch, [2.3, 0.7]);
    let drive = |plant: &mut Plant, duty: f32, ticks| {
        for _ in 0..ticks {
            plant.step(&driven_by([-duty, 0.0], [true, false]), 1e-4);
        }
    };
    drive(&mut plant, 0.4, 120);
    let speed = plant.state().v[0].angular;
    assert!(plant.bus_voltage() < BUS);
    // The current turns round within a few time constants of the winding, a tick each.
    drive(&mut plant, 0.02, 8);
    let before = plant.drives().unwrap().energy();
    drive(&mut plant, 0.02, 12);
    let current = plant.state().current[0];
    let register = (0.02 * 4200.0_f64).round() / 4200.0;
    let expected = BUS - resistance * -register * current;
    assert!((plant.bus_voltage() - expected).abs() < 1e-9);
    assert!(
        current > 0.0 && speed < -3.0,
        "{current} A at {speed} rad/s"
    );
    assert!(plant.bus_voltage() > BUS + 0.002);
    assert!(plant.drives().unwrap().energy().supplied < before.supplied);
}
