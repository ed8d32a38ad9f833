//! What the board measures of itself for `fivebar board-test`.

mod bench;

use bench::{Bench, Driven, save};
use fivebar_chip::Options;
use fivebar_chip::time::{MILLISECOND, SECOND};
use fivebar_firmware::Request;
use fivebar_firmware::protocol::{
    BoardFacts, BoardReport, BoardTest, CommandError, FlashTime, HostCommand, Reply, Reset,
    TimedSpan, Timing,
};
use fivebar_firmware::safety::Fault;

/// Cycles of a millisecond.
const MS: u32 = 168_000;

fn test(driven: &mut Driven, test: BoardTest) -> Reply {
    driven
        .client
        .call(HostCommand::BoardTest(test))
        .expect("the controller answers")
}

fn facts(driven: &mut Driven) -> BoardFacts {
    match test(driven, BoardTest::Facts) {
        Reply::Board(BoardReport::Facts(facts)) => facts,
        other => panic!("{other:?}"),
    }
}

fn timing(driven: &mut Driven, span: TimedSpan) -> Timing {
    match test(driven, BoardTest::Timing(span)) {
        Reply::Board(BoardReport::Timing(timing)) => timing,
        other => panic!("{other:?}"),
    }
}

fn flash(driven: &mut Driven, step: BoardTest) -> FlashTime {
    match test(driven, step) {
        Reply::Board(BoardReport::Flash(time)) => time,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_board_knows_its_crystal_its_flash_and_its_brown_out_level() {
    let mut driven = Driven::new();
    let before = facts(&mut driven);
    assert_eq!(before.core, 168_000_000);
    let crystal = before.crystal.expect("a crystal");
    assert!(crystal.abs_diff(8_000_000) < 20_000, "{crystal}");
    // Five wait states, prefetch and both caches.
    assert_eq!(before.flash_access, 0x705);
    // It is programmed at the first start, and shows at the next one.
    assert_eq!((before.flash_size, before.brown_out), (1024, 3));
    assert_eq!(before.unique_id[0].to_le_bytes(), *b"\x11\x22\x33f");
    assert_eq!(before.hung, None);
    driven.run(SECOND);
    let after = facts(&mut driven);
    let ticks = after.tick - before.tick;
    let cycles = after.cycles.wrapping_sub(before.cycles);
    assert!(cycles.abs_diff(16_800 * ticks) < 16_800, "{cycles} {ticks}");
}

#[test]
fn a_board_without_the_right_crystal_tells_its_frequency() {
    for (crystal, works, expected) in [(10e6, true, Some(10_000_000)), (8e6, false, None)] {
        let options = Options {
            crystal,
            crystal_works: works,
            ..Options::default()
        };
        let mut driven = Bench::with(options, Vec::new(), 0).connect();
        let facts = facts(&mut driven);
        assert_eq!(facts.core, 16_000_000);
        let near = |found: u32| (found + 100_000) / 200_000 * 200_000;
        assert_eq!(facts.crystal.map(near), expected);
    }
}

#[test]
fn the_times_of_ticks_are_counted_and_the_response_holds_the_interrupt() {
    let mut driven = Driven::new();
    driven.arm();
    assert_eq!(test(&mut driven, BoardTest::BeginTiming), Reply::Done);
    let from = driven.status().tick;
    for _ in 0..4 {
        driven.run(50 * MILLISECOND);
        driven.status();
    }
    let ticks = driven.status().tick - from;
    let interrupt = timing(&mut driven, TimedSpan::Interrupt);
    let response = timing(&mut driven, TimedSpan::Response);
    for (timing, span) in [(&interrupt, "interrupt"), (&response, "response")] {
        let mean = timing.mean().expect("ticks") as u32;
        assert!(timing.least <= mean && mean <= timing.greatest, "{span}");
        assert_eq!(timing.bins.iter().sum::<u32>(), timing.ticks, "{span}");
        // The idle task misses a tick only while it is busy for longer.
        assert!(
            timing.ticks > ticks - ticks / 20,
            "{} of {ticks}",
            timing.ticks
        );
    }
    // A conversion takes 3.3 µs.
    assert!(response.least > interrupt.least + 437);
    assert!((437..1680).contains(&(response.greatest - interrupt.greatest)));
}

#[test]
fn the_flash_is_measured_with_the_bridges_off_and_keeps_the_settings() {
    let mut driven = Driven::new();
    save(&mut driven);
    driven.arm();
    let refused = test(&mut driven, BoardTest::EraseFlash);
    assert!(matches!(refused, Reply::Refused(CommandError::Request(_))));
    driven.request(Request::Disarm).expect("disarmed");
    for slow in [false, true] {
        if slow {
            driven.chip().slow_flash();
        }
        let erase = flash(&mut driven, BoardTest::EraseFlash);
        assert_eq!(erase.operations, 2);
        let ms = if slow { 2000 } else { 1000 };
        assert!(erase.longest.abs_diff(ms * MS) < MS, "{}", erase.longest);
        let program = flash(&mut driven, BoardTest::ProgramFlash);
        assert_eq!(program.operations, 256);
        // A tick may run in the midst of it.
        let us = program.longest / 168;
        assert!((16..40).contains(&us), "{us}");
    }
    driven.chip().reset(fivebar_chip::ResetCause::Power);
    driven.reconnect();
    assert_eq!(driven.request(Request::SetAngles([2.2, 0.9])), Ok(()));
    assert_eq!(driven.request(Request::Arm), Ok(()));
}

#[test]
fn a_hang_ends_by_the_watchdog_and_its_time_is_that_of_the_oscillator() {
    for lsi in [17e3, 32e3, 47e3] {
        let options = Options {
            lsi,
            ..Options::default()
        };
        let mut driven = Bench::with(options, Vec::new(), 0).connect();
        driven.request(Request::ClearFault).ok();
        // It gets no reply; the controller that has started anew knows no session.
        let reply = test(&mut driven, BoardTest::Hang);
        assert_eq!(reply, Reply::Refused(CommandError::NoSession));
        assert_eq!(driven.reconnect(), Reset::Watchdog);
        assert_eq!(driven.status().fault, Some(Fault::WatchdogReset));
        let hung = facts(&mut driven).hung.expect("a note");
        let expected = 1600.0 / lsi * 168e6;
        assert!((f64::from(hung) / expected - 1.0).abs() < 0.02, "{hung}");
        driven.chip().reset(fivebar_chip::ResetCause::Power);
        driven.reconnect();
        let facts = facts(&mut driven);
        assert_eq!((facts.hung, facts.brown_out), (None, 0));
    }
}
