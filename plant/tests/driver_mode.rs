//! A stepper on a driver that gives a voltage, as StealthChop does: its currents against the phasors, its energy, and that it
//! slips by itself at speeds at which a driver that gives a current holds it.

use fivebar_firmware::drives::StepCommand;
use fivebar_firmware::{ArmCommand, Settings};
use fivebar_kinematics::five_bar::Pose;
use fivebar_plant::{
    DriverMode, Mismatch, Parameters, Rotor, Stepper, StepperPlant, Transmission, Windings,
};
use nalgebra::Complex;
use std::f64::consts::TAU;

const SUPPLY: f64 = 24.0;
const TICK: f64 = 1e-4;
/// A step of the windings [s].
const STEP: f64 = 5e-6;
/// The inertia of rotor and load at the motor's shaft [kg·m²], and the typical friction there: Coulomb [N·m] and viscous
/// [N·m·s/rad].
const INERTIA: f64 = 66e-6;
const FRICTION: [f64; 2] = [0.005, 1.25e-4];

/// A common NEMA 17 motor with a 1:4 belt.
const NEMA17: Stepper = Stepper {
    steps_per_turn: 200,
    microsteps: 16,
    gear_ratio: 4.0,
    rotor_inertia: 5.4e-6,
    holding_torque: 0.40,
    rated_current: 1.7,
    resistance: 1.5,
    inductance: 2.8e-3,
    detent_torque: 0.0,
    encoder: false,
    driver: DriverMode::Voltage,
};

/// The vector of the currents in the frame of a rotor at constant speed [rad/s], with the voltage of this amplitude [V] ahead
/// of it by `lead` [rad]: i = (U e^(jδ) − j K ω)/(R + j N ω L).
fn phasor(speed: f64, voltage: f64, lead: f64) -> Complex<f64> {
    let reactance = NEMA17.periods() * speed * NEMA17.inductance;
    let back_emf = Complex::i() * (NEMA17.torque_constant() * speed);
    (Complex::from_polar(voltage, lead) - back_emf) / Complex::new(NEMA17.resistance, reactance)
}

/// The lead of the field without load [rad].
fn lead_without_load(speed: f64) -> f64 {
    let inductive = NEMA17.periods() * NEMA17.inductance * NEMA17.rated_current;
    let across = (inductive + NEMA17.torque_constant()) * speed;
    across.atan2(NEMA17.resistance * NEMA17.rated_current)
}

#[test]
fn the_currents_of_a_rotor_at_constant_speed_are_those_of_the_phasors() {
    for speed in [5.0, 20.0, 60.0, 150.0] {
        for (voltage, lead) in [(4.0, 0.3), (12.0, 1.2), (24.0, -0.8)] {
            let mut windings = Windings::default();
            let periods = NEMA17.periods();
            // Twelve time constants of the windings, in steps of 1/2000 of the electrical period at most.
            let time = STEP.min(TAU / (periods * speed) / 2000.0);
            let steps = (12.0 * NEMA17.inductance / NEMA17.resistance / time) as usize;
            let mut last = [0.0; 2];
            for k in 0..steps {
                let angle = speed * time * (k as f64 + 0.5);
                let (sin, cos) = (periods * angle + lead).sin_cos();
                let rotor = Rotor::new(&NEMA17, angle, speed);
                last = windings.phases;
                windings.step_under_voltage(&NEMA17, [voltage * cos, voltage * sin], &rotor, time);
            }
            // The mean of both ends is the current in the middle of the last step.
            let [a, b] = [0, 1].map(|k| 0.5 * (last[k] + windings.phases[k]));
            let turned = periods * speed * time * (steps as f64 - 0.5);
            let found = Complex::new(a, b) * Complex::from_polar(1.0, -turned);
            let expected = phasor(speed, voltage, lead);
            println!("{speed:5} rad/s, {voltage} V at {lead}: {found:.5} for {expected:.5} A");
            let gap = (found - expected).norm();
            assert!(gap < 1e-4 * (1.0 + expected.norm()), "{found} {expected}");
        }
    }
}

/// The lead of an independent model in which the voltage was regulated.
#[test]
fn without_load_the_regulated_voltage_gives_the_rated_current_along_the_rotor() {
    for (speed, told) in [(5.0, 0.75), (10.0, 1.08), (40.0, 1.44)] {
        let lead = lead_without_load(speed);
        let current = phasor(speed, NEMA17.regulated_voltage(speed), lead);
        println!("{speed} rad/s: {lead:.3} rad ahead, {current:.4} A");
        assert!((lead - told).abs() < 0.01, "{lead}");
        assert!((current.re - NEMA17.rated_current).abs() < 1e-12);
        assert!(current.im.abs() < 1e-12);
    }
}

/// How far the field is ahead of the rotor [rad], least and greatest in the last 0.3 s.
type Leads = [f64; 2];

/// Turns a rotor up to this speed [rad/s] within 300 rad/s², and on at it for six seconds in all. The leads, or the time at
/// which it slipped by a period of the field [s].
fn turn(driver: DriverMode, speed: f64) -> Result<Leads, f64> {
    let motor = Stepper { driver, ..NEMA17 };
    let mut windings = Windings {
        phases: [motor.rated_current, 0.0],
    };
    let [mut field, mut field_speed, mut angle, mut rotor_speed] = [0.0_f64; 4];
    let mut leads = [f64::INFINITY, f64::NEG_INFINITY];
    for k in 0..(6.0 / STEP) as u32 {
        field_speed = (field_speed + 300.0 * STEP).min(speed);
        field += motor.periods() * field_speed * STEP;
        let along = |length: f64| [length * field.cos(), length * field.sin()];
        let rotor = Rotor::new(&motor, angle + 0.5 * rotor_speed * STEP, rotor_speed);
        match driver {
            DriverMode::Voltage => {
                let voltage = motor.regulated_voltage(field_speed).min(SUPPLY);
                windings.step_under_voltage(&motor, along(voltage), &rotor, STEP);
            }
            DriverMode::Current => {
                windings.step(&motor, along(motor.rated_current), &rotor, SUPPLY, STEP);
            }
        }
        let [coulomb, viscous] = FRICTION;
        let friction = coulomb * (rotor_speed / 0.1).tanh() + viscous * rotor_speed;
        rotor_speed += (windings.torque(&motor, &rotor) - friction) / INERTIA * STEP;
        angle += rotor_speed * STEP;
        let lead = field - motor.periods() * angle;
        if lead.abs() > TAU {
            return Err(f64::from(k) * STEP);
        }
        if f64::from(k) * STEP > 5.7 {
            leads = [leads[0].min(lead), leads[1].max(lead)];
        }
    }
    Ok(leads)
}

/// An independent model slips from 20 to 120 rad/s. At both ends the swing here grows too, and ends just before the rotor slips.
#[test]
fn a_voltage_lets_a_rotor_swing_until_it_slips_between_20_and_120_rad_per_second_and_a_current_does_not()
 {
    for speed in [5.0, 10.0, 20.0, 25.0, 30.0, 50.0, 80.0, 100.0, 120.0, 140.0] {
        let under_voltage = turn(DriverMode::Voltage, speed);
        let [least, greatest] = turn(DriverMode::Current, speed).unwrap();
        println!(
            "{speed:5} rad/s: voltage {under_voltage:.3?}, current {least:.3} to {greatest:.3}"
        );
        assert!(greatest - least < 0.01, "{speed}: {least} to {greatest}");
        match (speed, under_voltage) {
            (25.0..=100.0, Err(_)) => {}
            (20.0 | 120.0, Ok([least, greatest])) => assert!(greatest - least > 2.0, "{speed}"),
            (140.0, Ok([least, greatest])) => assert!(greatest - least < 1.0, "{speed}"),
            (..=10.0, Ok([least, greatest])) => {
                assert!(greatest - least < 1e-3, "{speed}");
                // Friction adds a little to the lead that the field has without load.
                let loaded = least - lead_without_load(speed);
                assert!((0.0..0.02).contains(&loaded), "{loaded}");
            }
            (speed, other) => panic!("{speed} rad/s: {other:?}"),
        }
    }
}

fn arm(driver: DriverMode, transmission: Transmission) -> StepperPlant {
    let mut parameters = Parameters::from_settings(&Settings::BENCHTOP, SUPPLY).unwrap();
    for motor in &mut parameters.motors {
        [motor.viscous_friction, motor.coulomb_friction] = [2e-3, 0.02];
    }
    parameters.transmissions = [transmission; 2];
    let pose: Pose<f64> = parameters
        .arm
        .geometry()
        .forward(2.2, 0.9, Settings::BENCHTOP.assembly())
        .unwrap();
    let motor = Stepper { driver, ..NEMA17 };
    StepperPlant::new(&parameters, &[motor; 2], &Mismatch::NONE, &pose, 1)
}

/// Both joints go to and fro together, by 0.9 rad to either side at this speed of the motors [rad/s] within 1000 rad/s², for
/// `seconds`, and stop.
fn sway(plant: &mut StepperPlant, speed: f64, seconds: f64) {
    let per_radian = 200.0 * 16.0 / TAU;
    let mut command = ArmCommand {
        drives: StepCommand { steps: [0; 2] },
        enable: [true; 2],
        brake: false,
        tool: 0,
    };
    let [mut field, mut field_speed, mut wanted_speed] = [0.0, 0.0, speed];
    let mut made = 0;
    for k in 0..((seconds + 0.5) / TICK) as u32 {
        if f64::from(k) * TICK >= seconds {
            wanted_speed = 0.0;
        } else if field > 0.9 * NEMA17.gear_ratio {
            wanted_speed = -speed;
        } else if field < -0.9 * NEMA17.gear_ratio {
            wanted_speed = speed;
        }
        let most = 1000.0 * TICK;
        field_speed += (wanted_speed - field_speed).clamp(-most, most);
        field += field_speed * TICK;
        let steps = (field * per_radian).round() as i32 - made;
        made += steps;
        command.drives.steps = [steps; 2];
        plant.step(&command, TICK);
    }
}

#[test]
fn an_arm_on_voltages_loses_steps_in_motions_in_which_one_on_currents_loses_none() {
    for speed in [10.0, 30.0] {
        let [currents, voltages] = [DriverMode::Current, DriverMode::Voltage].map(|driver| {
            let mut plant = arm(driver, Transmission::default());
            sway(&mut plant, speed, 2.0);
            plant.lost_steps()
        });
        println!("{speed} rad/s: {currents:?} on currents, {voltages:?} on voltages");
        assert_eq!(currents, [0; 2]);

        match speed {
            10.0 => assert_eq!(voltages, [0; 2]),
            _ => assert!(voltages != [0; 2] && voltages.iter().all(|lost| lost % 4 == 0)),
        }
    }
}

#[test]
fn energy_is_neither_made_nor_lost_under_a_voltage() {
    let belt = Transmission {
        stiffness: Some(300.0),
        damping: 0.02,
    };
    for (transmission, share) in [(Transmission::default(), 2e-5), (belt, 1e-4)] {
        let mut plant = arm(DriverMode::Voltage, transmission);
        let start = plant.stored();
        sway(&mut plant, 10.0, 0.5);
        let energy = plant.energy();
        let gap = plant.stored() - start - (energy.supplied - energy.lost);
        println!("{gap:.2e} J of {energy:?}");
        assert!(energy.supplied > 1.0);
        assert!(gap.abs() < share * energy.supplied, "{gap} {energy:?}");
        assert_eq!(plant.lost_steps(), [0; 2]);
    }
}
