//! What a bench has besides, against closed forms: a pen that sticks and slides, and small pulleys that turn unevenly.

use fivebar_files::robot::Robot;
use fivebar_firmware::ActuatorCommand;
use fivebar_firmware::drives::BrushedCommand;
use fivebar_firmware::settings::ALWAYS;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{Mismatch, PULLEY_TEETH, Parameters, Plant};
use nalgebra::Vector2;

/// The benchtop arm's gear ratio.
const GEAR: f64 = 8.0;

fn frictionless() -> Parameters {
    let mut parameters = Robot::load("benchtop").unwrap().plant_parameters().unwrap();
    for motor in &mut parameters.motors {
        (motor.viscous_friction, motor.coulomb_friction) = (0.0, 0.0);
    }
    parameters
}

fn plant(mismatch: &Mismatch) -> Plant {
    let home = Robot::load("benchtop").unwrap().home_pose().unwrap();
    Plant::new(&frictionless(), mismatch, &home, 1)
}

/// Without power, with the pen down or up.
fn unpowered(is_down: bool) -> ActuatorCommand {
    ActuatorCommand {
        drives: BrushedCommand::default(),
        enable: [false; 2],
        brake: false,
        tool: if is_down { ALWAYS } else { 0 },
    }
}

/// A force below F (1 + s) leaves the tip within the deflection at breakaway, 0.1 mm; a greater one pulls it away, and with the
/// pen up any does.
#[test]
fn a_pen_on_paper_holds_the_tip_up_to_its_breakaway_and_not_beyond() {
    let pen = Mismatch {
        pen_friction: 0.3,
        ..Mismatch::NONE
    };
    for (force, is_down, holds) in [
        (0.10, true, true),
        (-0.17, true, true),
        (0.10, false, false),
        (0.45, true, false),
    ] {
        let mut plant = plant(&pen);
        let start = plant.tool();
        plant.step(&unpowered(is_down), 1e-4);
        // Slowly up to the force, so that the tip does not swing beyond it.
        for step in 0..5000 {
            let share = (f64::from(step) / 2500.0).min(1.0);
            plant.set_tool_force(Vector2::new(0.0, share * force));
            plant.step(&unpowered(is_down), 1e-4);
        }
        let moved = (plant.tool() - start).norm();
        assert_eq!(moved < 1.5e-4, holds, "{force} N: {moved} m");
        assert_eq!(moved > 5e-3, !holds, "{force} N: {moved} m");
    }
}

/// A tip that slides at a speed v loses the work F v: from its kinetic energy ½ m v² it comes to rest after ½ m v²/F.
#[test]
fn a_pen_takes_the_work_of_its_sliding_force() {
    let force = 0.2;
    let mut plant = plant(&Mismatch {
        pen_friction: force,
        ..Mismatch::NONE
    });
    plant.step(&unpowered(true), 1e-4);
    plant.set_tool_force(Vector2::new(0.0, 1.0));
    for _ in 0..300 {
        plant.step(&unpowered(true), 1e-4);
    }
    plant.set_tool_force(Vector2::zeros());
    let lost = |plant: &Plant| plant.drives().unwrap().energy().lost;
    let (before, mut way, mut at) = (lost(&plant), 0.0, plant.tool());
    for _ in 0..100 {
        plant.step(&unpowered(true), 1e-4);
        way += (plant.tool() - at).norm();
        at = plant.tool();
    }
    let work = lost(&plant) - before;
    assert!(way > 1.5e-3, "{way} m");
    assert!(
        (work / (force * way) - 1.0).abs() < 2e-3,
        "{work} J on {way} m"
    );
}

/// The joint is where ψ(θm) = θm + e sin(n θm) + m sin(16 n θm) takes it, and the encoder at the motor shows θm.
#[test]
fn an_uneven_pulley_turns_the_joint_by_its_harmonics_of_the_motors_angle() {
    let (run_out, mesh) = (1.2e-3, 4e-4);
    let mut plant = plant(&Mismatch {
        pulley_run_out: [run_out; 2],
        tooth_mesh: [mesh; 2],
        ..Mismatch::NONE
    });
    let psi = |rotor: f64| {
        let shaft = GEAR * rotor;
        rotor + run_out * shaft.sin() + mesh * (PULLEY_TEETH * shaft).sin()
    };
    let counts_per_radian = {
        let axis = &frictionless().settings.axes[0];
        f64::from(axis.encoder_counts) * GEAR / std::f64::consts::TAU
    };
    let first = plant.sense().counts;
    let rotors = |plant: &Plant| Joint::ALL.map(|joint| plant.rotor_angle(joint));
    let start = rotors(&plant);
    let mut greatest = 0.0_f64;
    let mut moved = 0.0_f64;
    plant.set_tool_force(Vector2::new(0.0, 0.06));
    for _ in 0..4000 {
        plant.step(&unpowered(false), 1e-4);
        let counts = plant.sense().counts;
        for (j, joint) in Joint::ALL.into_iter().enumerate() {
            let rotor = rotors(&plant)[j];
            // Flanks of 2 kHz give by microradians under so small a force.
            let off = psi(rotor) - plant.angle(joint);
            assert!(off.abs() < 2e-5, "{joint}: {off} rad");
            greatest = greatest.max((rotor - plant.angle(joint)).abs());
            moved = moved.max((rotor - start[j]).abs());
            let shown = f64::from(counts[j].wrapping_sub(first[j])) / counts_per_radian;
            assert!((shown - (rotor - start[j])).abs() < 1.1 / counts_per_radian);
        }
    }
    assert!(moved > 0.2 && greatest > 1.3e-3, "{moved} {greatest}");
}
