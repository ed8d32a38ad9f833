//! Faults injected into the arm and its line. Each function is a test by its name, once with a
//! controller in this process and once on the emulated board; `docs/verify/data/injected_faults.csv` states what it
//! must lead to, and within how many ticks.

use crate::bench::{Bench, Stated, stated};
use fivebar_firmware::Request;
use fivebar_firmware::controller::RequestError;
use fivebar_firmware::protocol::{CommandError, HostCommand};
use fivebar_firmware::safety::{Response, State};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::FaultKind;
use fivebar_sim::link::FaultRates;
use std::io::{Read, Write};

/// Makes tests of the functions below, each with the line that `$line` starts.
macro_rules! test_every_injected_fault {
    ($line:path: $($name:ident),* $(,)?) => {
        $(
            #[test]
            fn $name() {
                crate::injected_faults::$name($line());
            }
        )*
    };
    ($line:path) => {
        $crate::injected_faults::test_every_injected_fault!(
            $line:
            dropped_frames,
            repeated_frames,
            reordered_frames,
            corrupt_frames,
            garbage_between_frames,
            a_dead_encoder,
            a_jumping_encoder,
            a_switch_stuck_closed,
            a_switch_stuck_open,
            a_switch_stuck_in_motion,
            a_stalled_motor,
            a_disconnected_motor,
            a_dead_current_sensor,
            a_reversed_current_sensor,
            a_current_sensor_somewhat_off,
            a_current_sensor_far_off,
            a_sagging_bus,
            a_pumped_up_bus,
            a_bridge_that_gives_up,
            a_fault_output_without_its_wire,
            a_pressed_emergency_stop,
            a_silent_host,
            a_few_late_ticks,
            late_ticks,
        );
    };
}
pub(crate) use test_every_injected_fault;

/// A fault is injected in motion; the arm is off in time, stays off, and the fault can be cleared.
#[track_caller]
fn powers_off<L: Read + Write>(line: L, test: &str, fault: FaultKind) -> Bench<L> {
    let mut bench = Bench::moving(line);
    bench.inject(fault);
    bench.powers_off(stated(test));
    bench
}

pub(crate) fn a_dead_encoder(line: impl Read + Write) {
    let mut bench = powers_off(
        line,
        "a_dead_encoder",
        FaultKind::EncoderDead {
            joint: Joint::Joint1,
        },
    );
    // The joint has turned unseen.
    let error = bench.is_refused(HostCommand::Request(Request::Arm));
    assert_eq!(error, CommandError::Request(RequestError::NotHomed));
}

pub(crate) fn a_jumping_encoder(line: impl Read + Write) {
    let jump = FaultKind::EncoderJump {
        joint: Joint::Joint4,
        counts: 400,
    };
    let mut bench = powers_off(line, "a_jumping_encoder", jump);
    // The joint's angle is unknown.
    let error = bench.is_refused(HostCommand::Request(Request::Arm));
    assert_eq!(error, CommandError::Request(RequestError::NotHomed));
}

pub(crate) fn a_switch_stuck_in_motion(line: impl Read + Write) {
    let switch = FaultKind::SwitchStuck {
        joint: Joint::Joint4,
        pressed: true,
    };
    let mut bench = powers_off(line, "a_switch_stuck_in_motion", switch);
    // Either the switch or the counts are wrong.
    let error = bench.is_refused(HostCommand::Request(Request::Arm));
    assert_eq!(error, CommandError::Request(RequestError::NotHomed));
}

pub(crate) fn a_stalled_motor(line: impl Read + Write) {
    powers_off(
        line,
        "a_stalled_motor",
        FaultKind::MotorStalled {
            joint: Joint::Joint4,
        },
    );
}

pub(crate) fn a_disconnected_motor(line: impl Read + Write) {
    let lead = FaultKind::MotorDisconnected {
        joint: Joint::Joint1,
    };
    powers_off(line, "a_disconnected_motor", lead);
}

pub(crate) fn a_dead_current_sensor(line: impl Read + Write) {
    let dead = FaultKind::CurrentDead {
        joint: Joint::Joint4,
    };
    powers_off(line, "a_dead_current_sensor", dead);
}

pub(crate) fn a_reversed_current_sensor(line: impl Read + Write) {
    let reversed = FaultKind::CurrentGain {
        joint: Joint::Joint1,
        gain: -1.0,
    };
    powers_off(line, "a_reversed_current_sensor", reversed);
}

/// The position loop's integral compensates for it.
pub(crate) fn a_current_sensor_somewhat_off(line: impl Read + Write) {
    let mut bench = Bench::moving(line);
    bench.inject(FaultKind::CurrentOffset {
        joint: Joint::Joint1,
        amperes: 0.1,
    });
    for _ in 0..500 {
        let result = bench.tick();
        assert_eq!((result.state, result.fault), (State::Running, None));
    }
    bench.is_moving();
}

pub(crate) fn a_current_sensor_far_off(line: impl Read + Write) {
    let offset = FaultKind::CurrentOffset {
        joint: Joint::Joint1,
        amperes: 7.0,
    };
    powers_off(line, "a_current_sensor_far_off", offset);
}

pub(crate) fn a_sagging_bus(line: impl Read + Write) {
    let sag = FaultKind::BusVoltage { volts: 12.0 };
    let mut bench = powers_off(line, "a_sagging_bus", sag);
    // If the arm is armed again on the same bus, the fault is raised at once.
    bench.is_done(HostCommand::Request(Request::Arm));
    bench.powers_off(stated("a_sagging_bus"));
}

pub(crate) fn a_pumped_up_bus(line: impl Read + Write) {
    let pumped = FaultKind::BusVoltage { volts: 34.0 };
    powers_off(line, "a_pumped_up_bus", pumped);
}

pub(crate) fn a_bridge_that_gives_up(line: impl Read + Write) {
    let driver = FaultKind::DriverFault {
        joint: Joint::Joint4,
    };
    powers_off(line, "a_bridge_that_gives_up", driver);
}

pub(crate) fn a_fault_output_without_its_wire(line: impl Read + Write) {
    let open = FaultKind::DriverFaultOpen {
        joint: Joint::Joint1,
    };
    powers_off(line, "a_fault_output_without_its_wire", open);
}

pub(crate) fn a_pressed_emergency_stop(line: impl Read + Write) {
    let stated = stated("a_pressed_emergency_stop");
    let mut bench = Bench::moving(line);
    bench.inject(FaultKind::EmergencyStop);
    let result = bench.faults(stated);
    bench.stays_off(result);
    // If the fault is cleared while the button is still pressed, the next tick raises it again.
    bench.is_done(HostCommand::Request(Request::ClearFault));
    let result = bench.faults(stated);
    bench.stays_off(result);
}

/// Homing with a switch that does not change, faster than usual and in a narrow range, so that
/// the emulator's search is short.
fn searches<L: Read + Write>(line: L, pressed: bool, stated: Stated) -> Bench<L> {
    let mut bench = Bench::with(line, FaultRates::default(), |settings| {
        settings.homing.speed = 3.0;
        settings.homing.back_off = 0.02;
        settings.axes[0].angle_limits = [2.1, 2.3];
    });
    bench.inject(FaultKind::SwitchStuck {
        joint: Joint::Joint1,
        pressed,
    });
    bench.is_done(HostCommand::Request(Request::Home));
    bench.powers_off(stated);
    bench
}

pub(crate) fn a_switch_stuck_closed(line: impl Read + Write) {
    let mut bench = searches(line, true, stated("a_switch_stuck_closed"));
    let error = bench.is_refused(HostCommand::Request(Request::Arm));
    assert_eq!(error, CommandError::Request(RequestError::NotHomed));
}

pub(crate) fn a_switch_stuck_open(line: impl Read + Write) {
    let mut bench = searches(line, false, stated("a_switch_stuck_open"));
    let error = bench.is_refused(HostCommand::Request(Request::Arm));
    assert_eq!(error, CommandError::Request(RequestError::NotHomed));
}

/// The arm stops on its path and is held there.
pub(crate) fn a_silent_host(line: impl Read + Write) {
    let stated = stated("a_silent_host");
    assert_eq!(stated.fault.response(), Response::ControlledStop);
    let mut bench = Bench::moving(line);
    let path = bench.plant.tool().y;
    bench.status();
    bench.host_talks = false;
    bench.faults(stated);
    let still_moves = bench.is_refused(HostCommand::Request(Request::ClearFault));
    assert_eq!(still_moves, CommandError::Request(RequestError::Moving));
    for _ in 0..stated.at_rest.expect("a controlled stop") {
        let result = bench.tick();
        assert_eq!(result.command.enable, [true; 2]);
        let off = (bench.plant.tool().y - path).abs();
        assert!(off < 3e-5, "{off} m off the line");
    }
    bench.stays_held();
    bench.is_cleared();
}

/// Two missed ticks in a row are counted and raise no fault.
pub(crate) fn a_few_late_ticks(line: impl Read + Write) {
    let mut bench = Bench::moving(line);
    for _ in 0..3 {
        bench.inject(FaultKind::TicksMissed { ticks: 2 });
        for _ in 0..10 {
            assert_eq!(bench.tick().fault, None);
        }
    }
    for _ in 0..100 {
        assert_eq!(bench.tick().fault, None);
    }
    assert_eq!(bench.status().missed_ticks, 6);
    bench.is_moving();
}

pub(crate) fn late_ticks(line: impl Read + Write) {
    let stated = stated("late_ticks");
    let mut bench = Bench::moving(line);
    bench.inject(FaultKind::TicksMissed { ticks: 3 });
    // The ticks after this one are missed; the arm moves on meanwhile.
    assert_eq!(bench.tick().fault, None);
    bench.powers_off(stated);
    assert_eq!(bench.status().missed_ticks, 3);
}

/// The protocol corrects the faults of the line: every bit of each reply is as without them, and
/// the arm does not stop.
#[track_caller]
fn is_repaired(line: impl Read + Write, repeats: bool, set: fn(&mut FaultRates)) {
    let mut rates = FaultRates::default();
    set(&mut rates);
    let mut bench = Bench::moving_on(line, rates);
    bench.is_moving();
    let injected = bench.board.line().injected();
    assert!(injected > 10, "{injected} injected faults prove little");
    // A command whose frame or reply is lost is sent again, and that is counted.
    assert!(bench.board.repeats() > 0 || !repeats);
    println!(
        "{injected} injected faults, {} repeats",
        bench.board.repeats()
    );
}

pub(crate) fn dropped_frames(line: impl Read + Write) {
    is_repaired(line, true, |rates| rates.dropped = 0.03);
}

pub(crate) fn repeated_frames(line: impl Read + Write) {
    is_repaired(line, false, |rates| rates.repeated = 0.1);
}

pub(crate) fn reordered_frames(line: impl Read + Write) {
    is_repaired(line, true, |rates| rates.reordered = 0.03);
}

pub(crate) fn corrupt_frames(line: impl Read + Write) {
    is_repaired(line, true, |rates| rates.corrupt = 0.03);
}

pub(crate) fn garbage_between_frames(line: impl Read + Write) {
    is_repaired(line, false, |rates| rates.garbage = 0.1);
}
