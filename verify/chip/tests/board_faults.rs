//! Faults of the board's drivers, each raised through pins, registers and time.

mod bench;

use bench::{Bench, Driven, hear, image, save, say, settings, tell, used_flash};
use fivebar_chip::time::{MICROSECOND, MILLISECOND, SECOND};
use fivebar_chip::{FlashEvent, Options, ResetCause};
use fivebar_firmware::Request;
use fivebar_firmware::protocol::{
    ControllerMessage, HostCommand, HostMessage, Reply, Reset, Sequence, VERSION, encode,
};
use fivebar_firmware::safety::{Fault, State};
use fivebar_kinematics::five_bar::Joint;

/// A tick.
const TICK: u64 = 100 * MICROSECOND;

#[test]
fn a_held_emergency_stop_is_a_fault_and_the_tick_goes_on() {
    let mut driven = Driven::new();
    driven.arm();
    for _ in 0..2 {
        driven.arm.get().press_stop(true);
        driven.chip().pins_changed();
        assert!(driven.is_off(), "the timer switches off at once");
        driven.run(2 * TICK);
        let status = driven.status();
        assert_eq!(status.fault, Some(Fault::EmergencyStop));
        driven.run(200 * MILLISECOND);
        let later = driven.status();
        assert!(
            later.tick - status.tick > 1990,
            "{}",
            later.tick - status.tick
        );
        assert_eq!(driven.chip().resets().len(), 1, "the watchdog is fed");
        assert!(driven.is_off_twice());
        // Cleared while pressed, it is raised again at once.
        driven.request(Request::ClearFault).expect("cleared");
        driven.run(2 * TICK);
        assert_eq!(driven.status().fault, Some(Fault::EmergencyStop));
        driven.arm.get().press_stop(false);
        driven.chip().pins_changed();
        driven.run(5 * TICK);
        assert!(driven.is_off_twice(), "released, and not cleared");
        driven.request(Request::ClearFault).expect("cleared");
        driven.arm();
    }
}

#[test]
fn settings_are_saved_to_a_used_flash_again_and_again() {
    let mut driven = Bench::with(Options::default(), used_flash(), 0).ready();
    for _ in 0..4 {
        assert_eq!(save(&mut driven), Reply::Done);
    }
    let events = driven.chip().flash_events();
    assert!(
        events
            .iter()
            .any(|event| matches!(event, FlashEvent::Erase { .. }))
    );
    driven.chip().reset(ResetCause::Power);
    assert_eq!(driven.reconnect(), Reset::Power);
    assert_eq!(driven.status().fault, None);
    let mut read = settings();
    read.lengths[0] = 0.0;
    driven.client.read_settings(&mut read).expect("settings");
    assert_eq!(read, settings());
}

#[test]
fn the_watchdog_waits_for_an_erase_and_watches_again_afterwards() {
    for lsi in [17e3, 47e3] {
        let options = Options {
            lsi,
            ..Options::default()
        };
        let mut driven = Bench::with(options, used_flash(), 0).ready();
        driven.chip().slow_flash();
        assert_eq!(save(&mut driven), Reply::Done);
        assert_eq!(driven.chip().resets().len(), 1, "at {lsi} Hz");
        driven.run(20 * MILLISECOND);
        driven.chip().hang();
        driven.run(110 * MILLISECOND);
        assert_eq!(driven.chip().resets().len(), 2, "at {lsi} Hz");
    }
}

#[test]
fn a_stack_overflow_switches_the_bridges_off_and_is_reported() {
    // The stack ends in the frame of the exception, or in what the handler pushes.
    for left in [0, 8, 32, 64, 104, 160] {
        let mut driven = Driven::new();
        driven.arm();
        driven.chip().leave_stack(left);
        driven.run(2 * TICK);
        assert!(driven.is_off(), "{left} bytes");
        assert!(!driven.chip().is_locked_up(), "{left} bytes");
        assert_eq!(driven.reconnect(), Reset::HardFault, "{left} bytes");
    }
}

#[test]
fn the_image_logs_the_length_of_the_tick() {
    assert!(
        image()
            .symbol("the tick: {=u32} cycles, at most {=u32}")
            .is_some()
    );
}

#[test]
fn a_log_that_no_probe_reads_does_not_stop_the_tick() {
    let mut driven = Driven::new();
    // A probe sets the channel to block when it is full, and goes away.
    let (control, _) = image()
        .symbol("_SEGGER_RTT")
        .expect("the log's control block");
    driven.chip().write_ram_word(control + 24 + 20, 2);
    for _ in 0..40 {
        driven.arm();
        driven.request(Request::Disarm).expect("disarmed");
    }
    driven.run(SECOND);
    assert_eq!(driven.chip().resets().len(), 1);
    assert_eq!(driven.status().fault, None);
}

#[test]
fn a_bridge_is_given_its_time_to_wake() {
    let mut driven = Bench::with(Options::default(), Vec::new(), MILLISECOND).ready();
    for _ in 0..3 {
        driven.arm();
        driven.run(20 * MILLISECOND);
        let status = driven.status();
        assert_eq!((status.state, status.fault), (State::Armed, None));
        driven.request(Request::Disarm).expect("disarmed");
    }
    // Nothing was driven hard when the bridges woke.
    let strongest = driven
        .arm
        .get()
        .history
        .iter()
        .fold(0.0_f32, |most, (_, acting)| {
            acting
                .drives
                .duty
                .iter()
                .fold(most, |most, duty| most.max(duty.abs()))
        });
    assert!(strongest < 0.1, "{strongest}");
}

#[test]
fn the_host_hears_of_a_crystal_that_dies() {
    let mut driven = Driven::new();
    driven.arm();
    driven.chip().crystal_fails();
    driven.run(10 * MICROSECOND);
    assert!(driven.is_off());
    let asleep = driven.arm.get().outputs().sleep;
    // The pins are inputs now: pull-downs put the bridges to sleep, and no tick wakes them.
    assert_eq!(asleep, [None; 2], "by the NMI, before the next tick");
    // A tick now takes ten times as long.
    driven.run(30 * TICK);
    let status = driven.status();
    assert_eq!(status.fault, Some(Fault::ClockFailure));
    driven.run(300 * MILLISECOND);
    assert!(driven.status().tick > status.tick);
    assert_eq!(driven.chip().resets().len(), 1);
    for request in [Request::Arm, Request::Home] {
        assert!(driven.request(request).is_err());
    }
    driven.request(Request::ClearFault).expect("cleared");
    driven.run(30 * TICK);
    assert_eq!(driven.status().fault, Some(Fault::ClockFailure));
    assert!(driven.is_off());
}

#[test]
fn the_host_hears_of_a_crystal_that_does_not_start() {
    let options = Options {
        crystal_works: false,
        ..Options::default()
    };
    let mut driven = Bench::with(options, Vec::new(), 0).connect();
    assert_eq!(driven.status().fault, Some(Fault::ClockFailure));
    assert!(driven.request(Request::Arm).is_err());
    let before = driven.status().tick;
    driven.run(300 * MILLISECOND);
    let ticks = driven.status().tick - before;
    assert!(
        (298..310).contains(&ticks),
        "a tick each millisecond: {ticks}"
    );
    assert_eq!(driven.chip().resets().len(), 1);
}

#[test]
fn a_crystal_of_another_frequency_is_a_clock_failure() {
    for crystal in [4e6, 7e6, 10e6, 20e6, 24e6, 25e6] {
        let options = Options {
            crystal,
            ..Options::default()
        };
        let mut driven = Bench::with(options, Vec::new(), 0).connect();
        assert_eq!(
            driven.status().fault,
            Some(Fault::ClockFailure),
            "{crystal}"
        );
        driven.request(Request::ClearFault).expect("cleared");
        driven.run(30 * TICK);
        assert_eq!(
            driven.status().fault,
            Some(Fault::ClockFailure),
            "{crystal}"
        );
        assert!(driven.request(Request::Arm).is_err());
    }
}

#[test]
fn the_crystal_is_taken_as_right_by_every_internal_oscillator_in_tolerance() {
    for crystal in [8e6, 12e6, 16e6] {
        for tolerance in [0.92, 1.0, 1.045] {
            let options = Options {
                crystal,
                hsi: 16e6 * tolerance,
                ..Options::default()
            };
            let mut driven = Bench::with(options, Vec::new(), 0).connect();
            assert_eq!(driven.status().fault, None, "{crystal} Hz, {tolerance}");
        }
    }
}

#[test]
fn a_frame_that_follows_a_long_one_is_sent() {
    let mut driven = Driven::new();
    driven.arm();
    driven.request(Request::EmergencyStop).expect("stopped");
    // Another session, in which each command is sent once, however slow this computer is.
    let hello = HostCommand::Hello {
        version: VERSION,
        session: 9,
    };
    say(&driven, 0, hello);
    tell(&driven, 1, HostCommand::Telemetry { every: 100 });
    hear(&driven);
    let (mut numbers, mut replies) = (Vec::new(), 0);
    // Two commands at once: the second reply waits while the first one is sent.
    for sequence in (2..52).step_by(2) {
        let frames = [sequence, sequence + 1].map(|number| {
            let (sequence, command) = (Sequence(number), HostCommand::Snapshot);
            let message: HostMessage = HostMessage { sequence, command };
            encode(&message).expect("a frame")
        });
        let mut chip = driven.chip();
        chip.send(&frames.concat());
        while !chip.is_sending() {
            chip.run(10 * MICROSECOND).expect("no violation");
        }
        // As if the first one were of the greatest length, 256 bytes.
        chip.prolong_sending(256 * 10 * MICROSECOND - 800 * MICROSECOND);
        chip.run(20 * MILLISECOND).expect("no violation");
    }
    for message in hear(&driven) {
        match message {
            ControllerMessage::Telemetry(sample) => numbers.push(sample.number),
            ControllerMessage::Stream(state) => panic!("{state:?}"),
            ControllerMessage::Reply { reply, .. } => {
                assert!(matches!(reply, Reply::Snapshot(Some(_))), "{reply:?}");
                replies += 1;
            }
        }
    }
    assert_eq!(replies, 50);
    assert!(numbers.len() > 10, "{}", numbers.len());
    let gap = numbers.windows(2).find(|pair| pair[1] != pair[0] + 1);
    assert_eq!(gap, None);
}

#[test]
fn a_disturbance_of_an_encoders_lines_counts_nothing() {
    let mut driven = Driven::new();
    driven.arm();
    driven.run(10 * MILLISECOND);
    let before = driven.status().angle;
    for _ in 0..100 {
        for joint in Joint::ALL {
            driven.arm.get().disturb_encoder(joint, MICROSECOND / 2);
        }
        driven.run(TICK);
    }
    let added = driven.arm.get().added();
    assert_eq!(added, [0; 2]);
    let after = driven.status().angle;
    assert!((after[0] - before[0]).abs() < 2e-3, "{before:?} {after:?}");
    // A level that lasts as long as at the greatest speed counts.
    for joint in Joint::ALL {
        let level = MICROSECOND * 2 / 3;
        driven.arm.get().disturb_encoder(joint, level);
    }
    driven.run(2 * TICK);
    let added = driven.arm.get().added();
    assert_eq!(added, [1; 2]);
}

#[test]
fn one_sample_of_a_home_switch_decides_nothing() {
    let mut driven = Driven::new();
    driven.request(Request::Home).expect("homing");
    for _ in 0..3000 {
        driven.run(MILLISECOND);
        for joint in Joint::ALL {
            driven.arm.get().chatter(joint);
        }
        let status = driven.status();
        assert_eq!(status.fault, None);
        if status.homed {
            break;
        }
    }
    let status = driven.status();
    for joint in Joint::ALL {
        let error = f64::from(status.angle[joint]) - driven.arm.get().plant().angle(joint);
        assert!(error.abs() < 2e-3, "{joint}: {error}");
    }
}

#[test]
fn the_watchdog_bites_in_time_whatever_its_oscillator() {
    for lsi in [17e3, 32e3, 47e3] {
        let options = Options {
            lsi,
            ..Options::default()
        };
        let mut driven = Bench::with(options, Vec::new(), 0).ready();
        driven.arm();
        driven.run(500 * MILLISECOND);
        assert_eq!(
            driven.chip().resets().len(),
            1,
            "not while all is well, at {lsi} Hz"
        );
        let hung = driven.chip().now();
        driven.chip().hang();
        driven.run(SECOND);
        let (at, cause) = driven.chip().resets()[1];
        assert_eq!(cause, ResetCause::Watchdog);
        assert!(at - hung < 100 * MILLISECOND, "{} at {lsi} Hz", at - hung);
        assert!(driven.is_off());
        assert_eq!(driven.reconnect(), Reset::Watchdog);
        assert_eq!(driven.status().fault, Some(Fault::WatchdogReset));
    }
}

#[test]
fn the_watchdog_bites_before_its_first_refresh_too() {
    let bench = Bench::with(Options::default(), Vec::new(), 0);
    let mut chip = bench.line.chip();
    while !chip.watchdog_runs() {
        chip.run(10 * MICROSECOND).expect("a sound start");
    }
    chip.hang();
    chip.run(SECOND).expect("time passes");
    assert_eq!(
        chip.resets().last().map(|&(_, cause)| cause),
        Some(ResetCause::Watchdog)
    );
}

#[test]
fn a_low_supply_resets_the_chip() {
    let mut driven = Driven::new();
    driven.arm();
    driven.chip().supply_falls(2.6);
    driven.run(TICK);
    assert!(driven.is_off());
    assert_eq!(driven.reconnect(), Reset::BrownOut);
}
