//! Stepper motors against closed forms: pull-out torque, natural frequency, stiffness, energy; and an arm that loses
//! steps when its motors are overloaded, and only then.

use fivebar_firmware::Settings;
use fivebar_firmware::drives::StepCommand;
use fivebar_firmware::{ActuatorCommand, ArmCommand};
use fivebar_kinematics::five_bar::{Joint, Pose};
use fivebar_plant::{
    DriverMode, FaultKind, Mismatch, Parameters, Plant, Rotor, Stepper, StepperPlant, Transmission,
    Windings,
};
use nalgebra::Vector2;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const TICK: f64 = 1e-4;
const SUPPLY: f64 = 24.0;

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
    driver: DriverMode::Current,
};
/// Micro-steps per radian at the joint.
const PER_RADIAN: f64 = 200.0 * 16.0 * 4.0 / TAU;

fn parameters(friction: [f64; 2]) -> Parameters {
    let mut parameters = Parameters::from_settings(&Settings::BENCHTOP, SUPPLY).unwrap();
    for motor in &mut parameters.motors {
        [motor.viscous_friction, motor.coulomb_friction] = friction;
    }
    parameters
}

fn pose(parameters: &Parameters) -> Pose<f64> {
    let assembly = Settings::BENCHTOP.assembly();
    let geometry = parameters.arm.geometry();
    geometry.forward(2.2, 0.9, assembly).unwrap()
}

fn arm(parameters: &Parameters, stepper: Stepper) -> StepperPlant {
    let pose = pose(parameters);
    StepperPlant::new(parameters, &[stepper; 2], &Mismatch::NONE, &pose, 1)
}

fn command(steps: [i32; 2]) -> ArmCommand<StepCommand> {
    ArmCommand {
        drives: StepCommand { steps },
        enable: [true; 2],
        brake: false,
        tool: 0,
    }
}

fn angles(plant: &StepperPlant) -> [f64; 2] {
    Joint::ALL.map(|j| plant.angle(j))
}

fn rest(plant: &mut StepperPlant, seconds: f64) {
    for _ in 0..(seconds / TICK) as u32 {
        plant.step(&command([0; 2]), TICK);
    }
}

/// The greatest mean torques over all lags of the rotor behind the field, at a constant speed [rad/s] with this
/// set-point of the current [A]: driving and braking.
fn simulated_pull_out(motor: &Stepper, current: f64, speed: f64) -> [f64; 2] {
    let period = TAU / (motor.periods() * speed);
    let steps = (period / 2e-6).ceil();
    let time = period / steps;
    let periods_to_settle = (8.0 * motor.inductance / motor.resistance / period).ceil() as usize;
    let mean = |lag: f64| {
        let mut windings = Windings::default();
        let mut sum = 0.0;
        for period in 0..=periods_to_settle {
            for k in 0..steps as usize {
                let turned = TAU * k as f64 / steps;
                let rotor = turned / motor.periods();
                let (sin, cos) = (turned + lag).sin_cos();
                let set_point = [current * cos, current * sin];
                windings.step(
                    motor,
                    set_point,
                    &Rotor::new(motor, rotor, speed),
                    SUPPLY,
                    time,
                );
                if period == periods_to_settle {
                    let half_a_step_on = Rotor::new(motor, rotor + 0.5 * speed * time, speed);
                    sum += windings.torque(motor, &half_a_step_on) / steps;
                }
            }
        }
        sum
    };
    let means = (0..64).map(|k| mean(PI * f64::from(k) / 32.0));
    means.fold([0.0, 0.0], |[driving, braking], mean| {
        [mean.max(driving), braking.max(-mean)]
    })
}

/// V₁, the amplitude of the winding's voltage at the field's frequency, is between V and 4V/π of a square wave.
#[test]
fn the_pull_out_torque_is_that_of_the_closed_form() {
    assert!((NEMA17.pull_out_torque(120.0, SUPPLY) - 0.30).abs() < 1e-3);
    let square = 4.0 / PI * SUPPLY;
    for speed in [5.0, 20.0, 40.0, 80.0, 120.0, 200.0, 300.0, 500.0] {
        let [found, braking] = simulated_pull_out(&NEMA17, NEMA17.rated_current, speed);
        let lower = NEMA17.pull_out_torque(speed, SUPPLY);
        let upper = NEMA17.pull_out_torque(speed, square);
        println!("{speed:5} rad/s: {lower:.3} <= {found:.3} <= {upper:.3}, braking {braking:.3}");
        // Where the current and the voltage are limited at once, both together give less than either.
        let least = if speed == 80.0 { 0.95 } else { 0.995 };
        assert!(found > least * lower, "{speed}: {found} {lower}");
        assert!(found < 1.005 * upper, "{speed}: {found} {upper}");
        assert!(braking > 0.995 * found, "{speed}: {braking} {found}");
    }
    // A set-point that is never reached drives the windings by a square wave.
    for speed in [150.0, 300.0, 500.0] {
        let [found, _] = simulated_pull_out(&NEMA17, 1e3, speed);
        let expected = NEMA17.pull_out_torque(speed, square);
        println!("{speed:5} rad/s, square: {found:.4} for {expected:.4}");
        assert!((found / expected - 1.0).abs() < 0.005, "{found} {expected}");
    }
}

#[test]
fn the_line_below_the_pull_out_torque_leaves_most_of_it() {
    for (fastest, supply, least) in [
        (60.0, 24.0, 1.0),
        (140.0, 24.0, 0.94),
        (300.0, 24.0, 0.7),
        (250.0, 48.0, 0.9),
    ] {
        let [rest, slope] = NEMA17.pull_out_line(fastest, supply);
        let mut smallest = f64::INFINITY;
        for k in 0..=1000 {
            let speed = fastest * f64::from(k) / 1000.0;
            let (line, curve) = (
                (rest - slope * speed).min(NEMA17.holding_torque),
                NEMA17.pull_out_torque(speed, supply),
            );
            // Between its 64 speeds the line is above a bent curve by less than this.
            assert!(line <= curve * 1.0005, "{speed} rad/s: {line} {curve}");
            smallest = smallest.min(line / curve);
        }
        println!(
            "{fastest} rad/s, {supply} V: {rest:.3} - {slope:.5} ω, {smallest:.3} of it or more"
        );
        assert!(smallest >= least, "{smallest}");
    }
}

/// α/τ of joint 1 [1/(kg·m²)].
fn mobility(plant: &StepperPlant) -> f64 {
    let (model, state) = (plant.arm().model(), plant.arm().state());
    let zero = Vector2::zeros();
    let [with, without] =
        [1.0, 0.0].map(|torque| model.accelerations(state, [torque, 0.0], zero).0[0].angular);
    with - without
}

#[test]
fn the_rotor_oscillates_about_the_field_at_its_natural_frequency() {
    let mut plant = arm(&parameters([0.0; 2]), NEMA17);
    plant.arm_mut().inject(FaultKind::MotorStalled {
        joint: Joint::Joint4,
    });
    let inertia = 1.0 / mobility(&plant) / NEMA17.gear_ratio.powi(2);
    let expected = NEMA17.natural_frequency(inertia);
    assert!((NEMA17.inertia_at(expected) / inertia - 1.0).abs() < 1e-12);
    let start = plant.angle(Joint::Joint1);
    rest(&mut plant, 0.01);
    let middle = start + 2.0 / PER_RADIAN;
    plant.step(&command([2, 0]), TICK);
    let (mut rises, mut before, mut largest) = (Vec::new(), 0.0, 0.0_f64);
    for tick in 0..3000 {
        plant.step(&command([0; 2]), TICK);
        let x = plant.angle(Joint::Joint1) - middle;
        if before < 0.0 && x >= 0.0 {
            rises.push(f64::from(tick) - x / (x - before));
        }
        if tick > 2000 {
            largest = largest.max(x);
        }
        before = x;
    }
    let periods = (rises.len() - 1) as f64;
    let found = periods / ((rises[rises.len() - 1] - rises[0]) * TICK);
    println!("{found:.2} Hz for {expected:.2} Hz over {periods} periods");
    assert!(periods > 20.0);
    // sin(φ − Nθ) at an amplitude of A: lower by A²/16, here 0.25 %.
    let amplitude = 2.0 / 16.0 * FRAC_PI_2;
    let softened = expected * (1.0 - amplitude * amplitude / 16.0);
    assert!((found / softened - 1.0).abs() < 1e-3, "{found} {softened}");
    // The current loop neither damps nor excites it.
    assert!((largest * PER_RADIAN / 2.0 - 1.0).abs() < 0.02, "{largest}");
}

/// Both joints go out and back along a sine, `amplitude` [rad] at `rate` [rad/s], for one period, in ticks of `tick` [s].
/// Each tick's tool.
fn swing_in(plant: &mut StepperPlant, amplitude: f64, rate: f64, tick: f64) -> Vec<Vector2<f64>> {
    let mut made = 0;
    let mut tools = Vec::new();
    for k in 1..=(TAU / rate / tick) as u32 {
        let wanted = amplitude * (1.0 - (rate * f64::from(k) * tick).cos()) / 2.0;
        let steps = (wanted * PER_RADIAN).round() as i32 - made;
        made += steps;
        plant.step(&command([steps, -steps]), tick);
        tools.push(plant.tool());
    }
    plant.step(&command([-made, made]), tick);
    tools
}

fn swing(plant: &mut StepperPlant, amplitude: f64, rate: f64) {
    swing_in(plant, amplitude, rate, TICK);
}

/// Ticks of all rates that controllers have, and of one that no step divides [s].
const TICKS: [f64; 5] = [1e-3, 5e-4, 2e-4, 1e-4, 1.37e-4];

/// The joints follow their fields by a spring of some 100 Hz, and the micro-steps excite it. Half the steps, in both
/// mechanics and windings, make a quarter of the error.
#[test]
fn half_the_steps_place_the_tool_where_it_was() {
    let parameters = parameters([5e-3, 0.02]);
    for tick in TICKS {
        let [coarse, fine] = [
            arm(&parameters, NEMA17),
            arm(&parameters, NEMA17).with_finer_steps(),
        ]
        .map(|mut plant| swing_in(&mut plant, 0.4, 12.0, tick));
        let apart = coarse
            .iter()
            .zip(&fine)
            .map(|(one, other)| (one - other).norm());
        let most = apart.fold(0.0, f64::max);
        println!("ticks of {tick} s: {:.3} µm", 1e6 * most);
        assert!(most < 1e-6, "{most} m in ticks of {tick} s");
    }
}

#[test]
fn energy_is_neither_made_nor_lost() {
    let detents = Stepper {
        detent_torque: 0.02,
        ..NEMA17
    };
    let belt = Transmission {
        stiffness: Some(300.0),
        damping: 0.02,
    };
    let rigid = Transmission::default();
    for (transmission, tick) in TICKS
        .map(|tick| (rigid, tick))
        .into_iter()
        .chain([(belt, TICK)])
    {
        let mut parameters = parameters([5e-3, 0.02]);
        parameters.transmissions = [transmission; 2];
        let mut plant = StepperPlant::new(
            &parameters,
            &[detents; 2],
            &Mismatch::default(),
            &pose(&parameters),
            1,
        );
        let start = plant.stored();
        swing_in(&mut plant, 0.4, 12.0, tick);
        for _ in 0..100 {
            let mut off = command([0; 2]);
            off.enable = [false; 2];
            plant.step(&off, tick);
        }
        let energy = plant.energy();
        let gap = plant.stored() - start - (energy.supplied - energy.lost);
        println!("{gap:.2e} J of {energy:?}");
        assert!(energy.supplied > 1.0);
        // A rotor behind a belt, alone, swings faster.
        let share = if transmission == rigid { 2e-5 } else { 1e-4 };
        assert!(gap.abs() < share * energy.supplied, "{gap} {energy:?}");
    }
}

#[test]
fn steps_are_lost_in_fours_when_the_motors_are_overloaded_and_never_otherwise() {
    let parameters = parameters([5e-3, 0.02]);
    let mut gentle = arm(&parameters, NEMA17);
    swing(&mut gentle, 0.5, 12.0);
    rest(&mut gentle, 0.2);
    assert_eq!(gentle.lost_steps(), [0; 2]);
    let gap = angles(&gentle)[0] - pose(&parameters).angles()[0];
    // Friction holds the rotor off its field: 0.02 N·m over the stiffness.
    let stiffness = 16.0 * 50.0 * NEMA17.holding_torque;
    assert!(gap.abs() < 0.02 / stiffness * 1.1, "{gap}");

    let mut hasty = arm(&parameters, NEMA17);
    swing(&mut hasty, 0.5, 90.0);
    rest(&mut hasty, 0.5);
    let [lost1, lost4] = hasty.lost_steps();
    println!("lost {lost1} and {lost4} full steps");
    assert!(lost1 != 0 && lost4 != 0);
    assert_eq!([lost1 % 4, lost4 % 4], [0; 2]);
    // What is lost is where the joint is: both rest on full turns of the field.
    let moved = angles(&hasty)[0] - pose(&parameters).angles()[0];
    let expected = lost1 as f64 * 16.0 / PER_RADIAN;
    println!("{moved} for {expected} rad");
    assert!((moved - expected).abs() < 0.02 / stiffness * 1.1);

    // The same motion with more current in it is made: the supply and the torque are what was missing.
    let strong = Stepper {
        holding_torque: 1.5,
        ..NEMA17
    };
    let mut strong = StepperPlant::new(
        &Parameters {
            bus_voltage: 96.0,
            ..parameters.clone()
        },
        &[strong; 2],
        &Mismatch::NONE,
        &pose(&parameters),
        1,
    );
    swing(&mut strong, 0.5, 90.0);
    rest(&mut strong, 0.2);
    assert_eq!(strong.lost_steps(), [0; 2]);
}

#[test]
fn micro_steps_place_the_joint_and_a_load_moves_it_by_the_stiffness() {
    let mut plant = arm(&parameters([0.3, 0.0]), NEMA17);
    let start = angles(&plant);
    let field = NEMA17.field(-3) - NEMA17.field(0);
    assert!((field - (TAU - 3.0 / 16.0 * FRAC_PI_2)).abs() < 1e-12);
    for steps in [[5, -3], [1, 0], [-20, 17]] {
        plant.step(&command(steps), TICK);
    }
    rest(&mut plant, 0.5);
    let [moved1, moved4] = [0, 1].map(|j| (angles(&plant)[j] - start[j]) * PER_RADIAN);
    assert!((moved1 + 14.0).abs() < 1e-3, "{moved1}");
    assert!((moved4 - 14.0).abs() < 1e-3, "{moved4}");
    assert_eq!(plant.sense().drives.steps, [-14, 14]);
    assert_eq!(plant.sense().counts, [-14, 14]);

    let deflection = |plant: &mut StepperPlant| {
        let (before, tool) = (angles(plant), plant.tool());
        let force = Vector2::new(0.3, 0.2);
        plant.arm_mut().set_tool_force(force);
        rest(plant, 0.5);
        let after = angles(plant);
        let squared = |j: usize| (after[j] - before[j]).powi(2);
        let work = force.dot(&(plant.tool() - tool));
        plant.arm_mut().set_tool_force(Vector2::zeros());
        rest(plant, 0.5);
        // k (Δθ1² + Δθ4²) = F·Δx.
        work / (squared(0) + squared(1))
    };
    let expected = NEMA17.gear_ratio.powi(2) * NEMA17.periods() * NEMA17.holding_torque;
    let full = deflection(&mut plant);
    assert!((full / expected - 1.0).abs() < 0.01, "{full} {expected}");
    let weak = Stepper {
        holding_torque: 0.5 * NEMA17.holding_torque,
        rated_current: 0.5 * NEMA17.rated_current,
        ..NEMA17
    };
    let mut plant = arm(&parameters([0.3, 0.0]), weak);
    let half = deflection(&mut plant);
    assert!((half / full - 0.5).abs() < 0.01, "{half} {full}");

    // A rotor that its load holds more than half a full step off its field has lost none.
    let mut most = 0.0_f64;
    for force in 1..30 {
        let force = Vector2::new(0.3, 0.2) * f64::from(force);
        plant.arm_mut().set_tool_force(force);
        rest(&mut plant, 0.2);
        let off = |j: usize| (angles(&plant)[j] - start[j]) * PER_RADIAN;
        most = most.max(off(0).abs()).max(off(1).abs());
        if most > 9.0 {
            break;
        }
    }
    assert!((9.0..16.0).contains(&most), "{most}");
    assert_eq!(plant.lost_steps(), [0; 2]);
}

#[test]
fn without_current_the_joints_are_as_free_as_those_of_brushed_motors_that_are_off() {
    let mut parameters = parameters([5e-3, 0.02]);
    for motor in &mut parameters.motors {
        (motor.gear_ratio, motor.rotor_inertia) = (NEMA17.gear_ratio, NEMA17.rotor_inertia);
    }
    let pose = pose(&parameters);
    let mut steppers = arm(&parameters, NEMA17);
    let mut brushed = Plant::new(&parameters, &Mismatch::NONE, &pose, 1);
    rest(&mut steppers, 0.01);
    let mut off = command([0; 2]);
    off.enable = [false; 2];
    let released = ActuatorCommand::default();
    for plant in [steppers.arm_mut(), &mut brushed] {
        plant.set_tool_force(Vector2::new(1.0, 0.5));
    }
    for _ in 0..1000 {
        steppers.step(&off, TICK);
        brushed.step(&released, TICK);
    }
    let moved = (brushed.angle(Joint::Joint1) - pose.angles()[0]).abs();
    assert!(moved > 0.05, "{moved}");
    for j in Joint::ALL {
        let gap = steppers.angle(j) - brushed.angle(j);
        assert!(gap.abs() < 0.01 * moved, "{gap} of {moved}");
    }
    // Full current catches them: the field is where it was, the rotor as many fours of full steps away.
    steppers.arm_mut().set_tool_force(Vector2::zeros());
    rest(&mut steppers, 0.3);
    let [lost1, _] = steppers.lost_steps();
    assert!(lost1 != 0 && lost1 % 4 == 0, "{lost1}");
}

#[test]
fn pulses_that_a_driver_misses_leave_its_joint_behind_the_steps_made() {
    let parameters = parameters([0.3, 0.0]);
    let encoder = Stepper {
        encoder: true,
        ..NEMA17
    };
    let mut plant = arm(&parameters, encoder);
    rest(&mut plant, 0.01);
    let (start, counts) = (angles(&plant), plant.sense().counts);
    plant.arm_mut().inject(FaultKind::StepLost {
        joint: Joint::Joint1,
        steps: 3,
    });
    for _ in 0..100 {
        plant.step(&command([-1, 1]), TICK);
        rest(&mut plant, 5e-4);
    }
    rest(&mut plant, 0.5);
    assert_eq!(plant.lost_steps(), [3, 0]);
    assert_eq!(plant.sense().drives.steps, [-100, 100]);
    let turned = angles(&plant)[0] - start[0];
    assert!((turned + 52.0 / PER_RADIAN).abs() < 1e-6, "{turned}");
    // The encoder sees it.
    let per_radian = f64::from(Settings::BENCHTOP.axes[0].encoder_counts)
        * f64::from(Settings::BENCHTOP.axes[0].gear_ratio)
        / TAU;
    let counted = plant.sense().counts[0].wrapping_sub(counts[0]);
    assert!((f64::from(counted) - turned * per_radian).abs() <= 1.0);
}

#[test]
fn a_motor_with_an_open_phase_has_no_current_where_its_field_is_that_phases_alone() {
    let mut plant = arm(&parameters([0.3, 0.0]), NEMA17);
    plant.arm_mut().inject(FaultKind::PhaseOpen {
        joint: Joint::Joint1,
    });
    rest(&mut plant, 0.02);
    let rated = |current: f64| (current - NEMA17.rated_current).abs() < 0.01;
    assert!(
        plant.current().into_iter().all(rated),
        "{:?}",
        plant.current()
    );
    // A full step on, the field is the other phase's.
    for _ in 0..16 {
        plant.step(&command([1, 1]), TICK);
    }
    rest(&mut plant, 0.1);
    let [open, whole] = plant.current();
    assert!(open.abs() < 0.01 && rated(whole), "{open} {whole}");
}

#[test]
fn the_home_switch_closes_at_its_angle() {
    let mut plant = arm(&parameters([5e-3, 0.02]), NEMA17);
    let home = f64::from(Settings::BENCHTOP.axes[0].home_angle);
    let mut pressed_at = None;
    for _ in 0..4000 {
        plant.step(&command([1, 0]), TICK);
        if plant.sense().home[0] {
            pressed_at = Some(plant.angle(Joint::Joint1));
            break;
        }
    }
    let step = 1.0 / PER_RADIAN;
    assert!((pressed_at.unwrap() - home).abs() < 2.0 * step);
    assert_eq!(plant.lost_steps(), [0; 2]);
}
