//! Energy with all effects on, and the determinism of such an arm.

use fivebar_files::robot::Robot;
use fivebar_firmware::ActuatorCommand;
use fivebar_firmware::drives::BrushedCommand;
use fivebar_firmware::settings::ALWAYS;
use fivebar_plant::{Harmonic, Harmonics, Mismatch, PULLEY_TEETH, Plant};
use nalgebra::Vector2;
use proptest::prelude::*;

/// Every effect, strongly.
fn everything() -> Mismatch {
    let eccentric = Harmonic {
        harmonic: 1,
        amplitude: 8e-3,
        phase: 0.4,
    };
    Mismatch {
        link_length: [1e-4, -1e-4, 5e-5, 2e-4],
        base_length: -1e-4,
        home_error: [1e-3, -1e-3],
        torque_constant: [0.05, -0.05],
        torque_ripple: [0.05, 0.03],
        cogging: [5e-3, 8e-3],
        stiffness: Some([2500.0, 700.0]),
        drive_damping: [0.02, 0.01],
        backlash: [5e-4, 1e-3],
        pulley_run_out: [1.2e-3, 1e-3],
        tooth_mesh: [4e-4, 3e-4],
        stiction: [0.5, 0.3],
        encoder_error: [Harmonics::new(&[eccentric]).unwrap(); 2],
        encoder_latency: [1e-4, 2.5e-4],
        supply_resistance: 0.3,
        pen_friction: 0.4,
        ..Mismatch::default()
    }
}

fn plant(gravity: bool) -> Plant {
    let text = include_str!("../../../host/files/robots/benchtop.toml");
    let text = text.replace(
        "gravity = [0.0, 0.0]",
        if gravity {
            "gravity = [0.0, -9.81]"
        } else {
            "gravity = [0.0, 0.0]"
        },
    );
    let robot = Robot::parse("arm.toml", &text).unwrap();
    let parameters = robot.plant_parameters().unwrap();
    Plant::new(&parameters, &everything(), &robot.home_pose().unwrap(), 5)
}

/// Swings both joints, with times at rest, times with open bridges and times with the pen up.
fn command(time: f64) -> ActuatorCommand {
    let swing = |frequency: f64, phase: f64| (frequency * time + phase).sin() as f32;
    let pause = (time % 0.5) > 0.4;
    let size = if pause { 0.0 } else { 1.0 };
    ActuatorCommand {
        drives: BrushedCommand {
            duty: [
                size * (0.12 * swing(40.0, 0.0) + 0.05 * swing(900.0, 1.0)),
                size * (-0.15 * swing(31.0, 0.5) + 0.05 * swing(1300.0, 0.0)),
            ],
        },
        enable: [(time % 0.3) > 0.01, true],
        brake: false,
        tool: if (time % 0.7) > 0.3 { ALWAYS } else { 0 },
    }
}

#[test]
fn the_energy_balance_closes_with_all_effects_on() {
    for gravity in [false, true] {
        let mut plant = plant(gravity);
        plant.set_tool_force(Vector2::new(0.2, -0.1));
        let stored = |plant: &Plant| {
            let drives = plant.drives().unwrap();
            drives.stored(plant.model(), plant.state())
        };
        let start = stored(&plant);
        let h = 1e-5;
        let mut worst = 0.0_f64;
        for step in 0..200_000 {
            plant.step(&command(h * f64::from(step)), h);
            if step % 1000 == 0 {
                let energy = plant.drives().unwrap().energy();
                let off = stored(&plant) - start - (energy.supplied - energy.lost);
                worst = worst.max(off.abs());
            }
        }
        let energy = plant.drives().unwrap().energy();
        assert!(energy.supplied > 1.0 && energy.lost > 1.0, "{energy:?}");
        assert!(
            worst < 1e-6 * energy.supplied,
            "{worst:e} J of {} J",
            energy.supplied
        );
    }
}

#[test]
fn an_arm_with_all_effects_is_deterministic_and_its_chain_stays_closed() {
    let run = || {
        let mut plant = plant(true);
        let mut samples = Vec::new();
        for tick in 0..3000 {
            plant.step(&command(1e-4 * f64::from(tick)), 1e-4);
            samples.push(plant.sense());
        }
        for gap in plant.model().chain.gaps(&plant.state().q) {
            assert!(gap.amax() <= 1e-10);
        }
        (samples, *plant.state(), *plant.drives().unwrap().state())
    };
    assert_eq!(run(), run());
}

/// The steps that the plant chooses within a tick resolve springs, bristles and gaps: a tenth of
/// them moves the tip by less than the arm's error of microns.
#[test]
fn a_tenth_of_the_step_changes_the_motion_of_such_an_arm_little() {
    let ticks = 3000;
    let coarse = {
        let mut plant = plant(false);
        for tick in 0..ticks {
            plant.step(&command(1e-4 * f64::from(tick)), 1e-4);
        }
        plant
    };
    let mut fine = plant(false);
    let mut before = ActuatorCommand::default();
    for tick in 0..ticks {
        // The bridges apply the outputs of the step before: the new ones come last.
        for _ in 0..9 {
            fine.step(&before, 1e-5);
        }
        before = command(1e-4 * f64::from(tick));
        fine.step(&before, 1e-5);
    }
    let apart = (coarse.tool() - fine.tool()).norm();
    let moved = (coarse.tool() - plant(false).tool()).norm();
    assert!(moved > 0.005, "{moved} m");
    assert!(apart < 5e-7, "{apart:e} m");
}

/// From nothing to the greatest that a scenario may state, evenly in the logarithm.
fn up_to(most: f64) -> impl Strategy<Value = [f64; 2]> {
    let one = move || {
        prop_oneof![
            Just(0.0),
            (-9.0..0.0_f64).prop_map(move |e| most * 10_f64.powf(e)),
            Just(most)
        ]
    };
    [one(), one()]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Whatever a scenario may state, the steps resolve it: the state stays finite, no energy
    /// appears, and the loop stays closed.
    #[test]
    fn every_valid_mismatch_can_be_simulated(
        stiffness in prop::option::of([1e-3..1.0_f64, 1e-3..1.0_f64]),
        damping in up_to(1.0),
        backlash in up_to(0.1),
        stiction in up_to(10.0),
        ripple in up_to(0.9),
        cogging in up_to(10.0),
        resistance in up_to(100.0),
        latency in up_to(0.1),
        uneven in up_to(1.0),
        pen in up_to(10.0),
    ) {
        let robot = Robot::load("benchtop").unwrap();
        let parameters = robot.plant_parameters().unwrap();
        let motor = &parameters.motors[0];
        let drawn = Mismatch {
            stiffness: stiffness.map(|both| both.map(|share| share.powi(2) * motor.stiffest_drive())),
            drive_damping: damping.map(|share| share * motor.most_drive_damping()),
            backlash,
            stiction,
            torque_ripple: ripple,
            cogging,
            supply_resistance: resistance[0],
            encoder_latency: latency,
            pulley_run_out: uneven.map(|share| share * 0.25 / motor.gear_ratio),
            tooth_mesh: uneven.map(|share| share * 0.25 / (PULLEY_TEETH * motor.gear_ratio)),
            pen_friction: pen[0],
            ..Mismatch::default()
        };
        prop_assume!(drawn.check().is_ok() && drawn.check_for(&parameters).is_ok());
        let mut plant = Plant::new(&parameters, &drawn, &robot.home_pose().unwrap(), 1);
        let stored = |plant: &Plant| {
            plant.drives().map_or(0.0, |drives| drives.stored(plant.model(), plant.state()))
        };
        let start = stored(&plant);
        for tick in 0..60 {
            plant.step(&command(0.005 * f64::from(tick)), 1e-4);
            plant.sense();
        }
        let tool = plant.tool();
        prop_assert!(tool.x.is_finite() && tool.norm() < 1.0, "{tool:?}");
        for gap in plant.model().chain.gaps(&plant.state().q) {
            prop_assert!(gap.amax() <= 1e-10);
        }
        if let Some(drives) = plant.drives() {
            let energy = drives.energy();
            let off = stored(&plant) - start - (energy.supplied - energy.lost);
            let scale = energy.supplied.abs() + energy.lost.abs() + stored(&plant).abs();
            prop_assert!(off.abs() < 0.02 * scale + 1e-6, "{off:e} J of {energy:?}");
        }
    }
}
