//! Friction that holds: below breakaway the joint does not creep, at breakaway it slides.

use fivebar_files::robot::Robot;
use fivebar_firmware::ActuatorCommand;
use fivebar_firmware::drives::BrushedCommand;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{Mismatch, Plant};
use std::f64::consts::TAU;

/// Of the benchtop arm: Coulomb friction [N·m], and duty per torque against a standing joint
/// [1/(N·m)].
const COULOMB: f64 = 9e-3;
const DUTY: f64 = 2.3 / (8.0 * 0.0234) / 24.0;
const TICK: f64 = 1e-4;

fn plant(stiction: f64) -> Plant {
    let robot = Robot::load("benchtop").unwrap();
    let mismatch = Mismatch {
        stiction: [stiction; 2],
        ..Mismatch::NONE
    };
    let home = robot.home_pose().unwrap();
    Plant::new(&robot.plant_parameters().unwrap(), &mismatch, &home, 1)
}

/// Pushes joint 1 with this torque [N·m] for one tick, the back-EMF compensated.
fn push(plant: &mut Plant, torque: f64) {
    let emf = 8.0 * 0.0234 * plant.state().v[0].angular / 24.0;
    let command = ActuatorCommand {
        drives: BrushedCommand {
            duty: [(DUTY * torque + emf) as f32, 0.0],
        },
        enable: [true, false],
        brake: false,
        tool: 0,
    };
    plant.step(&command, TICK);
}

#[test]
fn below_breakaway_the_joint_deflects_and_does_not_creep() {
    let run = |stiction| {
        let mut plant = plant(stiction);
        let start = plant.angle(Joint::Joint1);
        let mut angles = Vec::new();
        for tick in 0..20_000 {
            // Pushed on at once, it would overshoot.
            push(&mut plant, -5e-3 * f64::from(tick.min(5000)) / 5000.0);
            angles.push(plant.angle(Joint::Joint1) - start);
        }
        (angles[11_999], angles[19_999])
    };
    let (middle, end) = run(0.5);
    assert!(
        (end - middle).abs() < 1e-10,
        "creeps by {:e} rad",
        end - middle
    );
    // The bristles break away at 1.5 c after 0.5 mrad.
    let register = (DUTY * 5e-3 * 4200.0).round() / 4200.0 / DUTY;
    let deflection = -register / (1.5 * COULOMB) * 5e-4;
    assert!(
        (end - deflection).abs() < 1e-8,
        "{end}, not {deflection} rad"
    );
    // Friction without stiction is smooth at zero speed and lets the joint creep.
    let (middle, end) = run(0.0);
    assert!((end - middle).abs() > 1e-3);
}

#[test]
fn a_torque_that_swings_below_breakaway_moves_the_joint_no_further() {
    let mut plant = plant(0.5);
    let mut after = Vec::new();
    for tick in 0..40_000 {
        let phase = TAU * f64::from(tick) / 4000.0;
        push(&mut plant, -2.5e-3 + 2.5e-3 * phase.cos());
        if tick % 4000 == 0 {
            after.push(plant.angle(Joint::Joint1));
        }
    }
    let (first, last) = (after[1], after.last().unwrap());
    assert!(
        (last - first).abs() < 1e-9,
        "drifts by {:e} rad",
        last - first
    );
}

#[test]
fn the_joint_breaks_away_at_the_stiction_and_then_slides() {
    for stiction in [0.2, 0.5, 1.0] {
        let mut plant = plant(stiction);
        let breakaway = COULOMB * (1.0 + stiction);
        let mut torque = 0.0;
        while plant.state().v[0].angular.abs() < 0.1 {
            torque += 2e-7;
            push(&mut plant, -torque);
            assert!(torque < 2.0 * breakaway, "it does not break away");
        }
        // The register's steps are 0.5 mN·m wide.
        assert!(
            (torque - breakaway).abs() < 0.7e-3,
            "{torque}, not {breakaway} N·m"
        );
        // Less than the stiction keeps it going.
        for _ in 0..2000 {
            push(&mut plant, -0.5 * (COULOMB + breakaway));
        }
        assert!(plant.state().v[0].angular < -0.1);
    }
}
