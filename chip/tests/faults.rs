//! The faults of `docs/faults.md` that a board can meet, raised through its pins and registers
//! while the arm moves: the number, the bridges off within the stated ticks, and nothing that
//! moves until the fault is cleared.

mod bench;

use bench::{Bench, Driven, arm_at, robot};
use fivebar::input::scenario::FaultKind;
use fivebar_chip::Options;
use fivebar_chip::time::{MICROSECOND, MILLISECOND, Time};
use fivebar_firmware::protocol::{HostCommand, Reply};
use fivebar_firmware::safety::{Fault, Response, State};
use fivebar_firmware::{Move, MoveKind, Request};

const TICK: Time = 100 * MICROSECOND;

/// What the document states about an injected fault: the fault, and the latest tick in which it
/// is latched.
fn stated(test: &str) -> (Fault, u64) {
    let document = include_str!("../../docs/faults.md");
    let name = format!("`{test}`");
    let (_, injected) = document
        .split_once("## Injected faults")
        .expect("the table");
    let rows = injected
        .lines()
        .map(|line| line.split('|').map(str::trim).collect::<Vec<_>>());
    let row = rows
        .filter(|cells| cells.len() == 7)
        .find(|cells| cells[5] == name)
        .unwrap_or_else(|| panic!("docs/faults.md has no row of {test}"));
    let number = |cell: &str| cell.split(' ').find_map(|word| word.parse::<u64>().ok());
    let fault = number(row[2]).expect("the number of a fault");
    let fault = Fault::try_from(fault as u8).expect("a known fault");
    (fault, number(row[3]).expect("a count of ticks"))
}

/// The arm on its way along a line of 60 mm, to and fro, at 0.1 m/s.
fn moving() -> Driven {
    let [x, y] = robot().best_point().expect("a point").map(|x| x as f32);
    let arm = arm_at([x + 0.03, y], MILLISECOND);
    let mut driven = Bench::of(arm, Options::default(), Vec::new()).ready();
    driven.arm();
    for tag in 1..=6 {
        let to = [x + 0.03 * [-1.0, 1.0][tag as usize % 2], y];
        let kind = MoveKind::Line { to, feed: 0.1 };
        let reply = driven.client.call(HostCommand::Move(Move { tag, kind }));
        assert!(matches!(reply, Ok(Reply::Taken { .. })), "{reply:?}");
    }
    driven.run(60 * MILLISECOND);
    assert_eq!(driven.status().state, State::Running);
    driven
}

/// Runs until the fault is latched, the host giving signs of life; the ticks that it took.
fn ticks_until_off(driven: &mut Driven, within: u64) -> u64 {
    let began = driven.chip().now();
    while !driven.is_off() {
        let passed = (driven.chip().now() - began) / TICK;
        assert!(passed <= within + 2, "not off after {passed} ticks");
        if passed % 400 == 399 {
            driven.status();
        }
        driven.run(TICK / 2);
    }
    let (off_at, _) = *driven.arm.get().history.last().expect("a change");
    (off_at - began).div_ceil(TICK)
}

/// Nothing that the host asks for moves the arm; then the fault can be cleared.
fn stays_off_until_cleared(driven: &mut Driven, fault: Fault) {
    let status = driven.status();
    assert_eq!((status.state, status.fault), (State::Fault, Some(fault)));
    assert!(driven.is_off_twice());
    let changes = driven.arm.get().history.len();
    for request in [
        Request::Arm,
        Request::Home,
        Request::SetAngles([2.2, 0.9]),
        Request::Stop,
        Request::Disarm,
    ] {
        assert!(driven.request(request).is_err(), "{request:?}");
        driven.run(5 * TICK);
        assert!(driven.is_off());
    }
    assert_eq!(driven.arm.get().history.len(), changes);
    driven.request(Request::ClearFault).expect("cleared");
    driven.run(2 * TICK);
    assert!(driven.is_off());
}

#[track_caller]
fn powers_off(test: &str, fault: FaultKind) -> Driven {
    let (number, within) = stated(test);
    assert_eq!(number.response(), Response::PowerOff);
    let mut driven = moving();
    driven.arm.get().inject(fault);
    driven.chip().pins_changed();
    let ticks = ticks_until_off(&mut driven, within);
    // The samples of a tick are taken up to a tick after the fault begins.
    assert!(ticks <= within + 1, "{ticks} of {within}");
    driven
}

#[test]
fn a_dead_encoder() {
    let mut driven = powers_off("a_dead_encoder", FaultKind::EncoderDead { joint: 0 });
    stays_off_until_cleared(&mut driven, Fault::FollowingError);
}

#[test]
fn a_jumping_encoder() {
    let fault = FaultKind::EncoderJump {
        joint: 1,
        counts: 400,
    };
    let mut driven = powers_off("a_jumping_encoder", fault);
    stays_off_until_cleared(&mut driven, Fault::EncoderJump);
}

#[test]
fn a_stalled_motor() {
    let mut driven = powers_off("a_stalled_motor", FaultKind::MotorStalled { joint: 1 });
    stays_off_until_cleared(&mut driven, Fault::FollowingError);
}

#[test]
fn a_disconnected_motor() {
    let fault = FaultKind::MotorDisconnected { joint: 0 };
    let mut driven = powers_off("a_disconnected_motor", fault);
    stays_off_until_cleared(&mut driven, Fault::FollowingError);
}

#[test]
fn a_current_sensor_far_off() {
    for joint in 0..2 {
        let fault = FaultKind::CurrentOffset {
            joint,
            amperes: 7.0,
        };
        let mut driven = powers_off("a_current_sensor_far_off", fault);
        stays_off_until_cleared(&mut driven, Fault::OverCurrent);
    }
}

#[test]
fn a_sagging_bus() {
    let mut driven = powers_off("a_sagging_bus", FaultKind::BusVoltage { volts: 12.0 });
    stays_off_until_cleared(&mut driven, Fault::UnderVoltage);
}

#[test]
fn a_pumped_up_bus() {
    let mut driven = powers_off("a_pumped_up_bus", FaultKind::BusVoltage { volts: 34.0 });
    stays_off_until_cleared(&mut driven, Fault::OverVoltage);
}

#[test]
fn a_bridge_that_gives_up() {
    for joint in 0..2 {
        let fault = FaultKind::DriverFault { joint };
        let mut driven = powers_off("a_bridge_that_gives_up", fault);
        stays_off_until_cleared(&mut driven, Fault::DriverFault);
    }
}

#[test]
fn a_pressed_emergency_stop() {
    let (number, within) = stated("a_pressed_emergency_stop");
    let mut driven = moving();
    driven.arm.get().press_stop(true);
    driven.chip().pins_changed();
    assert!(driven.is_off(), "by the timer, without the program");
    driven.run((within + 1) * TICK);
    assert_eq!(driven.status().fault, Some(number));
    driven.arm.get().press_stop(false);
    stays_off_until_cleared(&mut driven, number);
}

#[test]
fn late_ticks() {
    let (number, _) = stated("late_ticks");
    let mut driven = moving();
    driven.chip().stall(4 * TICK);
    driven.run(6 * TICK);
    assert!(driven.is_off());
    stays_off_until_cleared(&mut driven, number);
}

#[test]
fn a_few_late_ticks() {
    let mut driven = moving();
    let before = driven.status().missed_ticks;
    for _ in 0..4 {
        driven.chip().stall(2 * TICK);
        driven.run(20 * TICK);
    }
    let status = driven.status();
    assert_eq!(status.fault, None);
    assert!(
        status.missed_ticks - before >= 4,
        "{}",
        status.missed_ticks - before
    );
}

#[test]
fn a_silent_host() {
    let (number, within) = stated("a_silent_host");
    let mut driven = moving();
    // At rest 1200 ticks after the fault, and held: the bridges stay on.
    driven.run((within + 1200) * TICK);
    assert!(!driven.is_off());
    let at = driven.arm.get().plant().tool();
    driven.run(100 * TICK);
    assert!((driven.arm.get().plant().tool() - at).norm() < 1e-4);
    let status = driven.status();
    assert_eq!((status.state, status.fault), (State::Fault, Some(number)));
    assert!(driven.request(Request::Arm).is_err());
    driven.request(Request::ClearFault).expect("cleared");
    driven.run(2 * TICK);
    assert!(driven.is_off());
}

/// Homes with this fault, until it ends the search.
fn search(test: &str, fault: FaultKind) {
    let (number, within) = stated(test);
    let [x, y] = robot().best_point().expect("a point").map(|x| x as f32);
    let arm = arm_at([x + 0.03, y], MILLISECOND);
    let bench = Bench::of(arm, Options::default(), Vec::new());
    // Faster than usual and in a narrow range, as the document's.
    let mut driven = bench.ready_with(|settings| {
        settings.homing.speed = 3.0;
        settings.homing.back_off = 0.02;
        settings.axes[0].angle_limits = [2.1, 2.3];
    });
    driven.arm.get().inject(fault);
    driven.request(Request::Home).expect("homing");
    driven.run(5 * MILLISECOND);
    assert!(!driven.is_off());
    ticks_until_off(&mut driven, within);
    stays_off_until_cleared(&mut driven, number);
}

#[test]
fn a_switch_stuck_closed() {
    let pressed = true;
    search(
        "a_switch_stuck_closed",
        FaultKind::SwitchStuck { joint: 0, pressed },
    );
}

#[test]
fn a_switch_stuck_open() {
    let pressed = false;
    search(
        "a_switch_stuck_open",
        FaultKind::SwitchStuck { joint: 0, pressed },
    );
}

/// A line whose every `nth` byte arrives changed, and one with garbage between the frames.
#[test]
fn corrupt_frames_and_garbage() {
    let mut driven = moving();
    for round in 0..20_u8 {
        driven.chip().send(&[round, 0x5a, 0, 7, round ^ 0xff, 0, 0]);
        driven.status();
    }
    let status = driven.status();
    assert_eq!((status.state, status.fault), (State::Running, None));
}
