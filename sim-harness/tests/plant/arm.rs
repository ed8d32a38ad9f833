//! The simulated arm: energy, constraints, motors, sensors, faults and brakes; runs with the same
//! seed are equal.

use fivebar_files::robot::Robot;
use fivebar_firmware::ActuatorCommand;
use fivebar_firmware::drives::BrushedCommand;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{FaultKind, Mismatch, PlantFault};
use fivebar_plant::{Loads, Model, Plant, State};
use nalgebra::{Matrix, Vector2};

const TICK: f64 = 1e-4;

fn benchtop() -> Robot {
    Robot::load("benchtop").unwrap()
}

fn plant(seed: u64) -> Plant {
    let robot = benchtop();
    Plant::new(
        &robot.plant_parameters().unwrap(),
        &Mismatch::default(),
        &robot.home_pose().unwrap(),
        seed,
    )
}

fn driven_by(duty: [f32; 2]) -> ActuatorCommand {
    ActuatorCommand {
        drives: BrushedCommand { duty },
        enable: [true; 2],
        brake: false,
        tool: 0,
    }
}

fn largest_gap(model: &Model, state: &State) -> f64 {
    model
        .chain
        .gaps(&state.q)
        .iter()
        .map(Matrix::amax)
        .fold(0.0, f64::max)
}

/// An arm without friction, with open motor terminals, hanging in gravity. It starts at home with
/// an initial velocity.
fn free() -> (Model, State) {
    let robot = benchtop();
    let mut model = Model::new(&robot.plant_parameters().unwrap(), &Mismatch::default());
    model.gravity = Vector2::new(0.0, -9.81);
    for motor in &mut model.motors {
        motor.viscous_friction = 0.0;
        motor.coulomb_friction = 0.0;
    }
    let pose = robot.home_pose().unwrap();
    let rates = robot.geometry.forward_velocities(&pose, -4.0, 2.0).unwrap();
    let state = model.state_at(&pose, rates.omega);
    (model, state)
}

const FREE: Loads = Loads {
    voltage: [None; 2],
    joint_torque: [0.0; 2],
    tool_force: Vector2::new(0.0, 0.0),
};

#[test]
fn a_free_frictionless_arm_keeps_its_energy() {
    let (model, mut state) = free();
    let start = model.energy(&state);
    let (mut kinetic_most, mut kinetic_least) = (0.0_f64, f64::INFINITY);
    for _ in 0..20_000 {
        model.step(&mut state, &FREE, TICK);
        let kinetic = model.kinetic_energy(&state);
        kinetic_most = kinetic_most.max(kinetic);
        kinetic_least = kinetic_least.min(kinetic);
    }
    let drift = (model.energy(&state) - start).abs() / kinetic_most;
    // The arm moves: energy changes between kinetic and potential.
    assert!(kinetic_most > 5.0 * kinetic_least);
    assert!(drift < 1e-6, "relative drift {drift:e}");
}

/// The supplied minus the dissipated power, integrated by the trapezoidal rule with an error of
/// order h², is the change of the stored energy.
#[test]
fn the_supplied_power_equals_the_change_of_energy() {
    let robot = benchtop();
    let model = Model::new(&robot.plant_parameters().unwrap(), &Mismatch::default());
    let mut state = model.state_at(&robot.home_pose().unwrap(), [0.0; 4]);
    let h = 1e-5;
    let winding = |state: &State| -> f64 {
        let stored = |j: usize| 0.5 * model.motors[j].inductance * state.current[j].powi(2);
        stored(0) + stored(1)
    };
    let start = model.energy(&state) + winding(&state);
    let (mut supplied, mut lost) = (0.0, 0.0);
    for step in 0..20_000 {
        let phase = 40.0 * h * f64::from(step);
        let loads = Loads {
            voltage: [Some(-3.0 * phase.sin()), Some(2.0 * phase.cos())],
            joint_torque: [0.0; 2],
            tool_force: Vector2::new(0.5, -0.3),
        };
        let powers = |state: &State| {
            let v = model.tool_velocity(state);
            let mut given = loads.tool_force.dot(&v);
            let mut dissipated = 0.0;
            for (j, link) in [0, 3].into_iter().enumerate() {
                let (motor, current) = (&model.motors[j], state.current[j]);
                let omega = state.v[link].angular;
                given += loads.voltage[j].unwrap() * current;
                dissipated += motor.resistance * current * current - motor.friction(omega) * omega;
            }
            (given, dissipated)
        };
        let before = powers(&state);
        model.step(&mut state, &loads, h);
        let after = powers(&state);
        supplied += 0.5 * h * (before.0 + after.0);
        lost += 0.5 * h * (before.1 + after.1);
    }
    let energy = model.energy(&state) + winding(&state) - start;
    assert!(
        supplied > 0.1 && lost > 0.01,
        "{supplied} J supplied, {lost} J lost"
    );
    assert!(
        (supplied - lost - energy).abs() < 1e-5 * supplied,
        "{supplied} − {lost} ≠ {energy} J"
    );
}

#[test]
fn the_loop_stays_closed_to_1e_10_m_at_full_drive() {
    let mut plant = plant(1);
    let mut fastest = 0.0_f64;
    for tick in 0..20_000 {
        let sign = if tick / 700 % 2 == 0 { 1.0 } else { -1.0 };
        plant.step(&driven_by([sign, 0.6 * sign]), TICK);
        assert!(largest_gap(plant.model(), plant.state()) <= 1e-10);
        fastest = fastest.max(plant.state().v[0].angular.abs());
    }
    assert!(
        fastest > 10.0,
        "the arm is too slow for the test: {fastest} rad/s"
    );
}

#[test]
fn halving_the_step_changes_the_motion_by_less_than_ten_nanometres() {
    let robot = benchtop();
    let model = Model::new(&robot.plant_parameters().unwrap(), &Mismatch::default());
    let start = model.state_at(&robot.home_pose().unwrap(), [0.0; 4]);
    let loads = Loads {
        voltage: [Some(-2.0), Some(1.5)],
        joint_torque: [0.0; 2],
        tool_force: Vector2::zeros(),
    };
    let run = |steps: u32, h: f64| {
        let mut state = start;
        for _ in 0..steps {
            model.step(&mut state, &loads, h);
        }
        model.tool(&state)
    };
    let (coarse, fine) = (run(1000, TICK), run(2000, TICK / 2.0));
    assert!((coarse - model.tool(&start)).norm() > 0.01);
    assert!(
        (coarse - fine).norm() < 1e-8,
        "{:e} m",
        (coarse - fine).norm()
    );
}

#[test]
fn the_same_seed_gives_the_same_run_and_another_seed_another() {
    let run = |seed| {
        let mut plant = plant(seed);
        let mut samples = Vec::new();
        for _ in 0..200 {
            samples.push(plant.sense());
            plant.step(&driven_by([0.1, -0.1]), TICK);
        }
        (samples, plant.tool())
    };
    assert_eq!(run(7), run(7));
    assert_ne!(run(7).0, run(8).0);
}

#[test]
fn a_command_takes_effect_one_tick_later() {
    let mut plant = plant(1);
    plant.step(&driven_by([0.5, 0.5]), TICK);
    assert_eq!(plant.state().current, [0.0; 2]);
    plant.step(&ActuatorCommand::default(), TICK);
    assert!(plant.state().current[0] > 1.0);
    plant.step(&ActuatorCommand::default(), TICK);
    assert_eq!(
        plant.state().current,
        [0.0; 2],
        "open terminals carry no current"
    );
}

#[test]
fn a_stalled_motor_settles_at_its_resistive_current() {
    let mut plant = plant(1);
    plant.inject(FaultKind::MotorStalled {
        joint: Joint::Joint1,
    });
    let angle = plant.angle(Joint::Joint1);
    for _ in 0..100 {
        plant.step(&driven_by([0.25, 0.0]), TICK);
    }
    // 24 V · ¼ / 2.3 Ω.
    assert!((plant.state().current[0] - 6.0 / 2.3).abs() < 1e-3);
    assert!((plant.angle(Joint::Joint1) - angle).abs() < 1e-9);
}

#[test]
fn encoder_counts_follow_the_joint_exactly() {
    let axis = benchtop().settings().unwrap().axes[0];
    let counts_per_turn = f64::from(axis.encoder_counts) * f64::from(axis.gear_ratio);
    let mut plant = plant(3);
    let (first, angle) = (plant.sense().counts[0], plant.angle(Joint::Joint1));
    for _ in 0..500 {
        plant.step(&driven_by([-0.1, 0.0]), TICK);
    }
    let counted = plant.sense().counts[0].wrapping_sub(first);
    let turned = (plant.angle(Joint::Joint1) - angle) / std::f64::consts::TAU * counts_per_turn;
    assert!(turned < -1000.0);
    assert!(
        (f64::from(counted) - turned).abs() <= 1.0,
        "{counted} for {turned}"
    );
}

#[test]
fn sensor_codes_match_current_and_bus_voltage() {
    let robot = benchtop();
    let mismatch = Mismatch::NONE;
    let mut plant = Plant::new(
        &robot.plant_parameters().unwrap(),
        &mismatch,
        &robot.home_pose().unwrap(),
        1,
    );
    for _ in 0..100 {
        plant.step(&driven_by([0.2, -0.2]), TICK);
    }
    let settings = robot.settings().unwrap();
    let sample = plant.sense();
    for j in 0..2 {
        let axis = &settings.axes[j];
        let codes = f64::from(sample.drives.current[j]) - f64::from(axis.current_zero_code);
        let current = codes * f64::from(axis.current_per_code);
        let half_code = 0.5001 * f64::from(axis.current_per_code);
        assert!((current - plant.state().current[j]).abs() <= half_code);
        assert!(current.abs() > 0.5);
    }
    let volts =
        f64::from(sample.drives.bus_voltage) * f64::from(settings.protection.bus_voltage_per_code);
    assert!((volts - 24.0).abs() < 0.01);
}

#[test]
fn injected_faults_occur_at_their_time() {
    let at = |kind| PlantFault { at: 0.01, kind };
    let mut plant = plant(5);
    plant.schedule_faults(&[
        at(FaultKind::EncoderDead {
            joint: Joint::Joint1,
        }),
        at(FaultKind::EncoderJump {
            joint: Joint::Joint4,
            counts: 5000,
        }),
        at(FaultKind::SwitchStuck {
            joint: Joint::Joint1,
            pressed: true,
        }),
        at(FaultKind::CurrentOffset {
            joint: Joint::Joint4,
            amperes: 0.5,
        }),
        at(FaultKind::BusVoltage { volts: 12.0 }),
        at(FaultKind::EmergencyStop),
    ]);
    let run = |plant: &mut Plant, ticks| {
        for _ in 0..ticks {
            plant.step(&driven_by([-0.1, 0.1]), TICK);
        }
        plant.sense()
    };
    let before = run(&mut plant, 99);
    assert_eq!((before.home, before.emergency_stop), ([false; 2], false));
    let angle = plant.angle(Joint::Joint1);
    let after = run(&mut plant, 3);
    let later = run(&mut plant, 50);
    assert_eq!(after.counts[0], later.counts[0]);
    assert_ne!(plant.angle(Joint::Joint1), angle);
    assert!(after.counts[1].wrapping_sub(before.counts[1]) > 4900);
    assert!(after.home[0] && after.emergency_stop);
    assert!(
        (f64::from(after.drives.bus_voltage) / f64::from(before.drives.bus_voltage) - 0.5).abs()
            < 0.01
    );
    assert!(f64::from(later.drives.current[1]) > 2048.0 + 0.4 / (16.0 / 4096.0));
    assert_eq!(
        plant.state().current,
        [0.0; 2],
        "the emergency stop cuts the bridges"
    );
}

#[test]
fn brakes_hold_the_unpowered_arm_against_gravity_and_stop_its_motion() {
    let text = include_str!("../../../host/files/robots/usp_2dof.toml")
        .replace("[0.0, 0.0]\nbase", "[0.0, -9.81]\nbase");
    let robot = Robot::parse("hanging", &text).unwrap();
    let home = robot.home_pose().unwrap();
    let mut plant = Plant::new(
        &robot.plant_parameters().unwrap(),
        &Mismatch::NONE,
        &home,
        1,
    );
    let engaged = ActuatorCommand {
        brake: true,
        tool: 0,
        ..ActuatorCommand::default()
    };
    let start = plant.tool();
    let run = |plant: &mut Plant, command: &ActuatorCommand, ticks| {
        for _ in 0..ticks {
            plant.step(command, TICK);
        }
    };
    run(&mut plant, &engaged, 1000);
    assert!((plant.tool() - start).norm() < 1e-7, "the arm sags");
    run(&mut plant, &ActuatorCommand::default(), 400);
    let speed = plant.state().v[0].angular;
    assert!(speed.abs() > 1.0, "the released arm falls");
    // 2 N·m stop about 3e-3 kg·m² at this speed within milliseconds.
    run(&mut plant, &engaged, 300);
    let caught = plant.tool();
    run(&mut plant, &engaged, 1000);
    assert!(
        (plant.tool() - caught).norm() < 1e-7,
        "the stopped arm moves"
    );
    assert!(largest_gap(plant.model(), plant.state()) <= 1e-10);
}

#[test]
fn a_coupling_that_slips_turns_the_joint_less_than_the_motor() {
    let robot = benchtop();
    let home = robot.home_pose().unwrap();
    let mut plant = Plant::new(
        &robot.plant_parameters().unwrap(),
        &Mismatch::NONE,
        &home,
        1,
    );
    let before = plant.sense().counts[0];
    plant.inject(FaultKind::CouplingSlips {
        joint: Joint::Joint1,
        share: 0.1,
    });
    assert_eq!(plant.sense().counts[0], before, "it has not turned yet");
    let [theta1, _, _, theta4] = home.angles();
    let moved = robot
        .geometry
        .forward(theta1 - 0.3, theta4 + 0.3, home.assembly());
    let moved = moved.unwrap();
    plant.hold_by_hand(&moved, TICK);
    let turned = f64::from(plant.sense().counts[0].wrapping_sub(before));
    let expected = -0.3 / 0.9 * 8.0 * 16384.0 / std::f64::consts::TAU;
    assert!((turned - expected).abs() < 2.0, "{turned} for {expected}");
}
