//! Stops by pin and by host, and faults of drivers and drives.

use super::arm::Connected;
use super::images::{Arm, Description};
use fivebar_chip::time::{MICROSECOND, MILLISECOND, Time};
use fivebar_chip::{Output, Pin};
use fivebar_firmware::Request;
use fivebar_firmware::drives::can::Frame;
use fivebar_firmware::safety::{Fault, State};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::FaultKind;

/// Fault outputs of both drivers.
const FAULT_OUTPUTS: [Pin; 2] = [Pin(1, 0), Pin(1, 1)];

impl Description {
    /// A tick that reads what has changed, and the next one at the latest; on a bus, with its frames.
    fn next_tick(&self) -> Time {
        match self.off_level {
            Some(_) => 2 * self.tick,
            None => 3 * self.tick,
        }
    }
}

/// Presses one contact; the timer that it stops has low outputs at once.
fn press(arm: &Connected, contact: usize, level: Option<bool>) {
    let image = arm.unit.image;
    arm.unit.record.force(image.stops[contact], level);
    arm.unit.chip().pins_changed();
    if image.stops_by_timer {
        let outputs = arm.unit.outputs();
        let both = image.stops.len() == 1;
        for joint in (0..2).filter(|&joint| both || joint == contact) {
            assert_ne!(outputs.steps[joint], Some(true));
            let off = |output: &Output| *output == Output::Idle(false);
            assert!(!both || outputs.pwm.iter().all(off), "{:?}", outputs.pwm);
        }
    }
}

fn release(arm: &Connected, contact: usize) {
    arm.unit.record.release(arm.unit.image.stops[contact]);
    arm.unit.chip().pins_changed();
    arm.run(5 * arm.unit.image.tick);
}

/// Pressed, and with a broken wire; as long as it is pressed, the fault comes again.
pub(crate) fn each_contact_of_the_emergency_stop_ends_power(image: &'static Description) {
    let mut arm = Connected::moving(image);
    for contact in 0..image.stops.len() {
        for level in [Some(true), None] {
            press(&arm, contact, level);
            arm.is_off_after(image.next_tick());
            assert_eq!(arm.status().fault, Some(Fault::EmergencyStop));
            arm.request(Request::ClearFault);
            arm.run(3 * image.tick);
            assert_eq!(arm.status().fault, Some(Fault::EmergencyStop), "cleared");
            release(&arm, contact);
            arm.works_again_after(Fault::EmergencyStop);
        }
    }
}

/// A press that ends before the next tick could read it, of each contact and again.
pub(crate) fn a_short_press_of_the_emergency_stop_is_latched(image: &'static Description) {
    let mut arm = Connected::moving(image);
    for contact in (0..image.stops.len()).cycle().take(2 * image.stops.len()) {
        press(&arm, contact, Some(true));
        arm.run(MICROSECOND);
        release(&arm, contact);
        arm.is_off_after(image.next_tick());
        arm.works_again_after(Fault::EmergencyStop);
    }
}

/// The session is late by 8 ms, as when the planner works.
pub(crate) fn the_hosts_emergency_stop_does_not_wait_for_the_session(image: &'static Description) {
    let mut arm = Connected::moving(image);
    arm.run(image.tick / 3);
    let arrives = arm.send(Request::EmergencyStop);
    let held = arm.unit.chip().hold_back(8 * MILLISECOND);
    held.expect("no violation");
    let late = arrives + image.next_tick();
    assert!(late < arm.unit.now());
    arm.nothing_reaches_a_joint_from(late);
    arm.is_off_after(0);
    arm.works_again_after(Fault::EmergencyStop);
}

pub(crate) fn a_fault_output_of_either_driver_ends_power(image: &'static Description) {
    let mut arm = Connected::moving(image);
    for pin in FAULT_OUTPUTS {
        // Low, and the wire off.
        for level in [Some(false), None] {
            arm.unit.record.force(pin, level);
            arm.is_off_after(image.next_tick());
            arm.unit.record.release(pin);
            arm.works_again_after(Fault::DriverFault);
        }
    }
}

/// Arms, lets this happen while the drives wake up, and expects the fault: nothing pushed, and the brake stayed engaged.
fn fault_while_waking(arm: &mut Connected, fault: Fault, happens: impl FnOnce(&Connected)) {
    let image = arm.unit.image;
    let angles = arm.angles();
    arm.request(Request::SetAngles(angles));
    let from = arm.unit.now();
    arm.request(Request::Arm);
    happens(arm);
    arm.is_off_after(image.wake + 10 * image.tick);
    assert_eq!(arm.unit.brake(from), [], "the brake");
    let status = arm.status();
    assert_eq!((status.state, status.fault), (State::Fault, Some(fault)));
}

/// While a driver wakes up its fault output means nothing; afterwards it does.
pub(crate) fn a_fault_output_of_either_driver_that_stays_ends_the_waking(
    image: &'static Description,
) {
    let mut arm = Connected::new(image);
    for pin in FAULT_OUTPUTS {
        fault_while_waking(&mut arm, Fault::DriverFault, |arm| {
            arm.unit.record.force(pin, Some(false));
        });
        arm.unit.record.release(pin);
        arm.works_again_after(Fault::DriverFault);
        arm.finish();
        arm.request(Request::Disarm);
        arm.run(250 * MILLISECOND);
    }
}

/// A drive on the bus sends a heartbeat with an error.
fn send_error(arm: &Connected, node: u16) {
    let Arm::Bus(bus) = &arm.unit.arm else {
        panic!("no bus");
    };
    let heartbeat = Frame::new(node << 5 | 0x01, [0x40, 0, 0, 0, 1, 0, 0, 0]);
    bus.get().plant_mut().disturb_with(heartbeat);
}

pub(crate) fn an_error_of_either_drive_ends_power(image: &'static Description) {
    let mut arm = Connected::moving(image);
    for node in [1, 2] {
        send_error(&arm, node);
        arm.is_off_after(image.next_tick());
        arm.works_again_after(Fault::DriveError);
    }
}

pub(crate) fn an_error_of_either_drive_ends_the_waking(image: &'static Description) {
    let mut arm = Connected::new(image);
    for node in [1, 2] {
        fault_while_waking(&mut arm, Fault::DriveError, |arm| {
            arm.run(8 * image.tick);
            send_error(arm, node);
            arm.is_off_after(image.next_tick());
        });
        arm.works_again_after(Fault::DriveError);
        arm.finish();
        arm.request(Request::Disarm);
        arm.run(250 * MILLISECOND);
    }
}

pub(crate) fn silence_of_either_drive_ends_the_waking(image: &'static Description) {
    for joint in Joint::ALL {
        let mut arm = Connected::new(image);
        fault_while_waking(&mut arm, Fault::DriveSilent, |arm| {
            arm.run(8 * image.tick);
            let Arm::Bus(bus) = &arm.unit.arm else {
                panic!("no bus");
            };
            bus.get()
                .plant_mut()
                .arm_mut()
                .inject(FaultKind::CanSilent { joint });
            arm.is_off_after(image.next_tick());
        });
    }
}
