//! The bridges wake up before they are driven and before their fault outputs count.

use crate::rig::{Rig, START, WAKING_TICKS, settings};
use fivebar_firmware::controller::Request;
use fivebar_firmware::drives::BrushedCommand;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{ActuatorCommand, MoveKind};

const WAKING: ActuatorCommand = ActuatorCommand {
    drives: BrushedCommand { duty: [0.0; 2] },
    enable: [true; 2],
    brake: true,
    tool: 0,
};

fn homed() -> Rig {
    let mut rig = Rig::new(&settings());
    rig.controller.request(Request::SetAngles(START)).unwrap();
    rig
}

/// Waits until the bridges are awake. Their fault outputs are low meanwhile, as the data sheet
/// allows.
#[track_caller]
fn wakes(rig: &mut Rig) {
    for tick in 0..WAKING_TICKS {
        rig.bench.overlay.driver_fault = [tick > 0; 2];
        assert_eq!(rig.tick(), WAKING, "tick {tick}");
    }
    assert_eq!(rig.controller.fault(), None);
    rig.bench.overlay.driver_fault = [false; 2];
}

#[test]
fn bridges_that_wake_up_are_neither_driven_nor_judged() {
    let mut rig = homed();
    rig.controller.request(Request::Arm).unwrap();
    wakes(&mut rig);
    let command = rig.tick();
    assert_eq!((command.enable, command.brake), ([true; 2], false));
    assert_eq!(rig.controller.state(), State::Armed);
}

#[test]
fn a_bridge_that_reports_a_fault_after_its_wake_up_is_a_driver_fault() {
    let mut rig = homed();
    rig.controller.request(Request::Arm).unwrap();
    wakes(&mut rig);
    rig.bench.overlay.driver_fault = [false, true];
    assert_eq!(rig.tick().enable, [false; 2]);
    assert_eq!(rig.controller.status().fault, Some(Fault::DriverFault));
}

#[test]
fn bridges_wake_up_anew_after_each_sleep() {
    let mut rig = homed();
    for _ in 0..3 {
        rig.controller.request(Request::Arm).unwrap();
        wakes(&mut rig);
        rig.run(50);
        rig.controller.request(Request::Disarm).unwrap();
        assert_eq!(rig.tick().enable, [false; 2]);
    }
    rig.controller.request(Request::Home).unwrap();
    wakes(&mut rig);
    assert_eq!(rig.controller.state(), State::Homing);
}

/// A push moves the arm before the bridges drive. Integrators that ran meanwhile would demand
/// more torque than is needed.
#[test]
fn the_loops_begin_when_the_bridges_are_awake() {
    let mut rig = homed();
    rig.controller.request(Request::Arm).unwrap();
    rig.bench.push = [0.05, -0.05];
    wakes(&mut rig);
    assert_eq!(rig.controller.status().torque, [0.0; 2]);
    rig.bench.push = [0.0; 2];
    for tick in 0..1000 {
        let command = rig.tick();
        for duty in command.drives.duty {
            assert!(duty.abs() < 0.1, "tick {tick}: {duty}");
        }
    }
    assert_eq!(rig.controller.state(), State::Armed);
    for (theta, start) in rig.bench.theta.into_iter().zip(START) {
        assert!((theta - f64::from(start)).abs() < 2e-4, "{theta}");
    }
}

#[test]
fn a_path_begins_when_the_bridges_are_awake() {
    let mut rig = homed();
    rig.controller.request(Request::Arm).unwrap();
    let [x, y] = rig.tool_position();
    let to = [x - 0.02, y];
    rig.push(1, MoveKind::Line { to, feed: 0.1 }).unwrap();
    wakes(&mut rig);
    assert_eq!(rig.controller.state(), State::Armed);
    rig.tick();
    assert_eq!(rig.controller.state(), State::Running);
    rig.run(5000);
    assert_eq!(rig.controller.state(), State::Armed);
    let [tool_x, tool_y] = rig.bench.tool();
    assert!((tool_x - f64::from(x - 0.02)).abs() < 1e-4, "{tool_x}");
    assert!((tool_y - f64::from(y)).abs() < 1e-4, "{tool_y}");
}

#[test]
fn currents_and_voltages_are_judged_while_the_bridges_wake_up() {
    for (current, bus, fault) in [
        (6.5, 24.0, Fault::OverCurrent),
        (0.0, 40.0, Fault::OverVoltage),
    ] {
        let mut rig = homed();
        rig.controller.request(Request::Arm).unwrap();
        rig.run(5);
        rig.bench.current = [0.0, current];
        rig.bench.bus = bus;
        assert_eq!(rig.tick().enable, [false; 2], "{fault:?}");
        assert_eq!(rig.controller.status().fault, Some(fault));
    }
}

/// As when the board finds that the host is gone.
#[test]
fn a_held_fault_that_is_latched_while_the_bridges_wake_up_does_not_drive_them() {
    let mut rig = homed();
    rig.controller.request(Request::Arm).unwrap();
    assert_eq!(rig.tick(), WAKING);
    rig.controller.latch_fault(Fault::CommandTimeout);
    for tick in 1..WAKING_TICKS {
        assert_eq!(rig.tick(), WAKING, "tick {tick}");
    }
    let command = rig.tick();
    assert_eq!((command.enable, command.brake), ([true; 2], false));
}
