//! The emulated boards for steppers and for drives on a CAN bus: micro-steps and frames have the bits of this process in
//! each tick, and a tick takes as many instructions as committed.

use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::Settings;
use fivebar_firmware::drives::StepDrives;
use fivebar_firmware::drives::can::BusDrives;
use fivebar_firmware::settings::HomingMethod;
use fivebar_kinematics::five_bar::{Joint, Pose};
use fivebar_plant::{CanPlant, FaultKind, Mismatch, PlantFault, StepperPlant};
use fivebar_sim::link::{EmulatedDrives, Emulator, Instructions, Lockstep, LockstepError};
use fivebar_sim::simulation::{Record, Simulate, SimulatedDrives, Simulation, fault_name};
use std::collections::BTreeMap;

/// Fewest, mean and most instructions of a tick with a kind of drives, as last committed.
const COMMITTED: &str = include_str!("../data/emulated_ticks.json");
/// The share by which another compiler's counts may differ from the committed ones.
const TOLERANCE: f64 = 0.1;

/// The demonstration on a built-in robot whose file has other text in some places.
fn demonstration<const N: usize>(robot: &str, replaced: [[&str; 2]; N]) -> Scenario {
    let mut text = BuiltIn::find(robot)
        .expect("a built-in robot")
        .text
        .to_owned();
    for [old, new] in replaced {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    let robot = Robot::parse("arm.toml", &text).expect("a robot");
    let mut scenario = Scenario::demonstration(robot);
    scenario.fit().expect("a scale");
    scenario
}

/// The pose 0.01 rad before both home switches, so that homing is short; at home if the arm is homed by hand.
fn near_home(scenario: &Scenario) -> Pose<f64> {
    let settings = scenario.robot.settings().expect("settings");
    let off = match settings.home_reference.method {
        HomingMethod::Given => [0.0; 2],
        _ => [-0.01, 0.01],
    };
    scenario.robot.pose_near_home(off).expect("a pose")
}

fn on_steppers(scenario: &Scenario) -> StepperPlant {
    let robot = &scenario.robot;
    let (parameters, motors) = (robot.plant_parameters(), robot.steppers());
    let (parameters, motors) = (parameters.expect("masses"), motors.expect("steppers"));
    StepperPlant::new(
        &parameters,
        &motors,
        &Mismatch::default(),
        &near_home(scenario),
        7,
    )
}

fn on_a_bus(scenario: &Scenario) -> CanPlant {
    let robot = &scenario.robot;
    let (parameters, bus) = (robot.plant_parameters(), robot.can_bus());
    let (parameters, bus) = (parameters.expect("masses"), bus.expect("a bus"));
    CanPlant::new(
        &parameters,
        bus,
        &Mismatch::default(),
        &near_home(scenario),
        7,
    )
}

fn board<I: EmulatedDrives>() -> Emulator {
    Emulator::start(&I::built_image()).expect("an emulated board")
}

/// The first moves on the emulated board, compared with a twin of other settings if any.
fn run<I: EmulatedDrives + SimulatedDrives>(
    scenario: &Scenario,
    arm: I::Arm,
    twin: impl FnOnce(&mut Settings),
) -> (Lockstep<Emulator, I>, Record) {
    let settings = scenario.robot.settings().expect("settings");
    let mut other = settings;
    twin(&mut other);
    let begun = Lockstep::<_, I>::begin(board::<I>(), &settings, &other);
    let (mut lockstep, identity) = begun.expect("a start");
    assert_eq!(identity.board, I::BOARD);
    let job = scenario.job().expect("a job");
    let moves = scenario.first_moves(&job, 2).expect("moves");
    let rate = scenario.robot.control.tick_rate;
    let simulation = Simulation::new(&mut lockstep, arm, rate);
    let record = simulation.run(&moves, &scenario.faults, &mut |_| ());
    (lockstep, record.expect("a run"))
}

/// The same with this fault in the job, if any: all bits are equal, and this fault ends the job.
fn is_exact<I: EmulatedDrives + SimulatedDrives>(
    (name, interrupt): (&str, &str),
    mut scenario: Scenario,
    arm: impl FnOnce(&Scenario) -> I::Arm,
    fault: Option<(FaultKind, &str)>,
) {
    let faults = fault.map(|(kind, _)| PlantFault { at: 0.2, kind });
    scenario.faults.extend(faults);
    let arm = arm(&scenario);
    let (lockstep, record) = run::<I>(&scenario, arm, |_| ());
    assert_eq!(lockstep.first_difference(), None, "{name}");
    let (ticks, Instructions { min, max, total }) = (lockstep.ticks(), lockstep.instructions());
    let mean = total as f64 / ticks as f64;
    println!("{name}: {ticks} ticks of {min} to {max} instructions, {mean:.0} in the mean");
    let faults: Vec<_> = record
        .faults
        .iter()
        .map(|(_, it)| fault_name(*it))
        .collect();
    let expected = fault.map(|(_, name)| name);
    assert_eq!(faults, Vec::from_iter(expected), "{name}");
    assert!(record.job_time > Some(0.2), "{name}: {:?}", record.job_time);
    assert!(
        max <= longest_interrupt(interrupt),
        "{name}: the worst tick: {max}"
    );
    let committed: BTreeMap<String, [f64; 3]> = serde_json::from_str(COMMITTED).expect("a table");
    if let Some(committed) = committed.get(name) {
        for (now, then) in [min.into(), mean, max.into()].into_iter().zip(committed) {
            assert!(
                (now - then).abs() <= TOLERANCE * then,
                "{name}: {now:.0} instructions, committed {then}; if that is right, write it into \
                 tests/data/emulated_ticks.json"
            );
        }
    } else {
        assert!(
            fault.is_some(),
            "tests/data/emulated_ticks.json has no {name}"
        );
    }
}

/// The proved bound of the tick's interrupt of an image for the arm [instructions], see `docs/verify/bounds.md`: no tick of a run
/// takes more.
fn longest_interrupt(row: &str) -> u32 {
    let figures = include_str!("../../verify/bounds/figures.txt");
    let row = figures.lines().find_map(|line| line.strip_prefix(row));
    let figure = row.and_then(|row| row.split_whitespace().next()?.parse().ok());
    figure.expect("the interrupt's instructions")
}

/// The rows of the images for the arm.
const STEPS: &str = "stm32f405_stepper: TIM4";
const BUS: &str = "stm32f405_can: TIM5";

/// So that the fields lead by whole micro-steps.
const UPRIGHT: [&str; 2] = ["gravity = [0.0, 0.0]", "gravity = [0.0, -9.81]"];
const BRAKES: [&str; 2] = [
    "torque_share = 0.6",
    "torque_share = 0.6\nbrake_torque = 2.0",
];
/// So that homing is short.
const SOON_HOMED: [&str; 2] = ["[limits]", "[homing]\nback_off = 0.01\n\n[limits]"];
const HOMED_BY_HAND: [&str; 2] = ["[limits]", "[homing]\nmethod = \"given\"\n\n[limits]"];
const ODRIVE: [&str; 2] = ["protocol = \"odrive\"", "protocol = \"odrive\""];
const WITH_ENCODERS: [&str; 2] = [
    "kind = \"stepper\"",
    "kind = \"stepper\"\nencoder_counts = 4000",
];
const MIT: [&str; 2] = [
    "protocol = \"odrive\"",
    "protocol = \"mit\"\nposition_range = 12.5\nvelocity_range = 640.0\ntorque_range = 2.0",
];

#[test]
fn micro_steps_have_the_bits_of_this_process() {
    let scenario = demonstration(
        "benchtop_stepper",
        [UPRIGHT, BRAKES, WITH_ENCODERS, SOON_HOMED],
    );
    is_exact::<StepDrives>(("steppers", STEPS), scenario, on_steppers, None);
}

#[test]
fn steps_that_are_lost_are_found_with_the_bits_of_this_process() {
    let scenario = demonstration("benchtop_stepper", [HOMED_BY_HAND, WITH_ENCODERS]);
    let kind = FaultKind::StepLost {
        joint: Joint::Joint1,
        steps: 64,
    };
    is_exact::<StepDrives>(
        ("lost steps", STEPS),
        scenario,
        on_steppers,
        Some((kind, "steps lost")),
    );
}

#[test]
fn frames_of_both_protocols_have_the_bits_of_this_process() {
    for (name, change) in [("ODrive", ODRIVE), ("MIT-type", MIT)] {
        is_exact::<BusDrives>((name, BUS), demonstration("leg", [change]), on_a_bus, None);
    }
}

#[test]
fn faults_of_the_bus_are_found_with_the_bits_of_this_process() {
    let silent = FaultKind::CanSilent {
        joint: Joint::Joint4,
    };
    for (name, change) in [("ODrive", ODRIVE), ("MIT-type", MIT)] {
        for (kind, fault) in [(silent, "drive silent"), (FaultKind::CanBusOff, "bus off")] {
            let name = format!("{name}, {fault}");
            let fault = Some((kind, fault));
            is_exact::<BusDrives>(
                (&name, BUS),
                demonstration("leg", [change]),
                on_a_bus,
                fault,
            );
        }
    }
}

/// In the tick of the first difference only what goes to the drives differs.
#[test]
fn a_lead_and_a_stiffness_changed_on_one_side_are_found() {
    let scenario = demonstration("benchtop_stepper", [HOMED_BY_HAND]);
    let (lockstep, _) = run::<StepDrives>(&scenario, on_steppers(&scenario), |twin| {
        twin.belts[0].stiffness *= 1.05;
    });
    let difference = lockstep.first_difference().expect("other bits");
    assert_eq!(difference.field, "micro-steps", "{difference}");

    let scenario = demonstration("leg", []);
    let (lockstep, _) = run::<BusDrives>(&scenario, on_a_bus(&scenario), |twin| {
        twin.axes[0].inductance *= 1.01;
    });
    let difference = lockstep.first_difference().expect("other bits");
    assert_eq!(difference.field, "frames of the bus", "{difference}");
}

#[test]
fn a_board_for_other_motors_is_refused_with_the_image_that_fits() {
    let robot = Robot::load("benchtop_stepper").expect("a built-in robot");
    let settings = robot.settings().expect("settings");
    let begun = Lockstep::<_, StepDrives>::begin(board::<BusDrives>(), &settings, &settings);
    let refused = begun.err().expect("other motors").to_string();
    assert!(refused.contains("is for drives on a CAN bus"), "{refused}");
    assert!(refused.contains("image `qemu_stepper`"), "{refused}");
    let production = Emulator::start(&Emulator::built_image("stm32f405_stepper"));
    let line = production.expect("an emulated board");
    let begun = Lockstep::<_, StepDrives>::begin(line, &settings, &settings);
    let refused = begun.err().expect("its own ticks");
    assert!(
        matches!(refused, LockstepError::OwnClock("qemu_stepper")),
        "{refused}"
    );
}
