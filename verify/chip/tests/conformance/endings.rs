//! Ways in which a program ends, each in motion: power, brake and tool go, and the restart says why.

use super::arm::{Connected, stored};
use super::images::{Description, Event, Signal, Unit};
use super::order::START;
use fivebar_chip::time::{MICROSECOND, MILLISECOND, Time};
use fivebar_chip::{DriveKind, Output, ResetCause};
use fivebar_firmware::Request;
use fivebar_firmware::protocol::Reset;
use fivebar_firmware::safety::Fault;

/// The watchdog's time at its oscillator's nominal frequency, 50 ms, and some ticks.
const BITTEN: Time = 54 * MILLISECOND;
/// An address in RAM that no program here uses.
const UNUSED: u32 = 0x2001_f000;

/// The program ends in motion: no joint has power when this image must have taken it away, and it restarts.
#[track_caller]
fn ends(
    image: &'static Description,
    within: Time,
    end: impl FnOnce(&Unit),
    reason: Reset,
    fault: Fault,
) {
    let mut arm = Connected::moving(image);
    let from = arm.unit.now();
    end(&arm.unit);
    arm.is_off_after(within);
    if reason != Reset::Watchdog {
        says_so_before_its_reset(&arm, from);
    }
    arm.has_restarted(reason, fault);
}

/// The program itself takes the power: it does not leave that to the reset behind it, which may come late, or to the
/// drives' own watchdogs.
#[track_caller]
fn says_so_before_its_reset(arm: &Connected, from: Time) {
    let (reset, _) = *arm.unit.chip().resets().last().expect("a reset");
    let image = arm.unit.image;
    if image.drives == DriveKind::OnBus {
        let events = arm.unit.events(from);
        let last = |joint| {
            let told = events.iter().filter(move |event| event.1 == joint);
            told.filter(|event| event.2 == Signal::Power(false)).count()
        };
        assert!(last(0) > 0 && last(1) > 0, "a last frame to each drive");
        return;
    }
    let record = arm.unit.record.get();
    let mut before = record.changes.iter().rev();
    let last = before.find(|change| change.0 < reset);
    let (_, outputs) = last.expect("changes");
    assert_eq!(outputs.sleep, [image.off_level; 2], "the pins of power");
    let off = |output: &Output| !matches!(output, Output::Pwm { .. });
    assert!(outputs.pwm.iter().all(off), "{:?}", outputs.pwm);
}

pub(crate) fn a_panic_ends_power_and_restarts(image: &'static Description) {
    let panic = |unit: &Unit| {
        let (handler, _) = image
            .program()
            .symbol("rust_begin_unwind")
            .expect("a handler");
        unit.chip().go_on_at(handler);
    };
    ends(image, image.off_within, panic, Reset::Panic, Fault::Panic);
}

pub(crate) fn an_undefined_instruction_ends_power_and_restarts(image: &'static Description) {
    let undefined = |unit: &Unit| {
        unit.chip().write_ram_word(UNUSED, 0xde00_de00);
        unit.chip().go_on_at(UNUSED);
    };
    ends(
        image,
        image.off_within,
        undefined,
        Reset::HardFault,
        Fault::HardFault,
    );
}

/// The next exception is the tick's.
pub(crate) fn a_stack_at_its_end_ends_power_and_restarts(image: &'static Description) {
    let overflow = |unit: &Unit| unit.chip().leave_stack(64);
    let within = image.tick + image.off_within;
    ends(image, within, overflow, Reset::HardFault, Fault::HardFault);
}

pub(crate) fn an_interrupt_that_nothing_handles_ends_power_and_restarts(
    image: &'static Description,
) {
    let raise = |unit: &Unit| unit.chip().raise_interrupt(0);
    ends(
        image,
        image.off_within,
        raise,
        Reset::HardFault,
        Fault::HardFault,
    );
}

/// The crystal fails at so many instants within a tick, from its beginning to its end.
const INSTANTS: Time = 12;
/// Of drives on pins, from the failure until they have no power: the block of code that the handler interrupts, the
/// handler's entry, and fewer than 100 cycles of the internal oscillator until the pins are off, 62.5 ns each.
const NMI_WITHIN: Time = 10 * MICROSECOND;

/// Runs on to an instant of a tick.
fn run_to(arm: &Connected, instant: Time) {
    let mut chip = arm.unit.chip();
    let mut in_tick = || {
        chip.run_into_tick()?;
        let began = chip.now();
        chip.run_below_the_interrupts()?;
        let length = chip.now() - began;
        chip.run_into_tick()?;
        chip.run(length * instant / (INSTANTS - 1))
    };
    in_tick().expect("no violation");
}

/// The program goes on with the internal oscillator, and reports what happened. A tick then takes ten times as long, so
/// that it is not the tick that has taken the power; nor does a tick that the handler interrupts give it back.
pub(crate) fn a_crystal_that_fails_ends_power_by_the_nmi(image: &'static Description) {
    for instant in 0..INSTANTS {
        let mut arm = Connected::moving(image);
        run_to(&arm, instant);
        let failed = arm.unit.now();
        arm.unit.chip().crystal_fails();
        arm.is_off_after(image.off_level.map_or(image.off_within, |_| NMI_WITHIN));
        let powers = |event: &Event| event.2 == Signal::Power(true);
        assert_eq!(arm.unit.events(failed).iter().find(|it| powers(it)), None);
        assert_eq!(arm.status().fault, Some(Fault::ClockFailure));
        assert!(arm.ask(Request::Arm).is_err());
        arm.run(100 * MILLISECOND);
        assert_eq!(arm.unit.chip().resets().len(), 1, "the watchdog is fed");
    }
}

/// The divider of the serial line, the last of the peripherals that the handler changes. In the block of code in which the
/// line gets its clock the divider may be set, too, as the compiler has it.
const DIVIDER: u32 = 0x4001_1008;

/// The handler runs within the start, which goes on to set up what it has set: from when the serial line has its clock
/// until the first tick.
pub(crate) fn a_crystal_that_fails_during_the_start_is_a_clock_failure(
    image: &'static Description,
) {
    let is_clocked = |unit: &Unit| unit.chip().register(DIVIDER).is_ok();
    let look = 100 * MICROSECOND;
    let unit = image.unit(stored(image));
    while !is_clocked(&unit) {
        unit.run(look);
    }
    let before = unit.now() - look;
    let clocked = || {
        let unit = image.unit(stored(image));
        unit.run(before);
        while !is_clocked(&unit) {
            unit.run(1);
        }
        unit
    };
    let unit = clocked();
    let from = unit.now();
    unit.chip().run_into_tick().expect("no violation");
    let length = unit.now() - from;
    for part in 0..4 {
        let unit = clocked();
        unit.run(length * part / 4);
        unit.chip().crystal_fails();
        unit.run(START);
        let mut arm = Connected::to(unit);
        assert_eq!(arm.status().fault, Some(Fault::ClockFailure), "part {part}");
        arm.request(Request::ClearFault);
        arm.run(20 * image.tick);
        assert_eq!(arm.status().fault, Some(Fault::ClockFailure), "cleared");
        arm.nothing_reaches_a_joint_from(0);
    }
}

pub(crate) fn the_watchdog_ends_a_program_that_hangs(image: &'static Description) {
    let hang = |unit: &Unit| unit.chip().hang();
    ends(image, BITTEN, hang, Reset::Watchdog, Fault::WatchdogReset);
}

pub(crate) fn the_watchdog_ends_a_program_without_ticks(image: &'static Description) {
    let stop = |unit: &Unit| unit.chip().disable_interrupt(image.tick_interrupt);
    ends(image, BITTEN, stop, Reset::Watchdog, Fault::WatchdogReset);
}

/// An endless loop below the interrupts: the ticks go on, and the arm moves on until it has no host.
pub(crate) fn the_watchdog_ends_a_program_whose_session_hangs(image: &'static Description) {
    let hang = |unit: &Unit| {
        let held = unit.chip().hold_back(MICROSECOND);
        held.expect("no violation");
        unit.chip().write_ram_word(UNUSED, 0xe7fe_e7fe);
        unit.chip().go_on_at(UNUSED);
    };
    ends(image, BITTEN, hang, Reset::Watchdog, Fault::WatchdogReset);
}

/// Until the watchdog resets the chip no push reaches a joint: of steppers no step, of bridges no duty, and drives on a bus
/// get no frame but those that wait in the mailboxes.
fn halts(image: &'static Description, stop_watchdog: bool) {
    let mut arm = Connected::moving(image);
    if stop_watchdog {
        // When it connects, while the program runs.
        arm.unit.chip().debugger_stops_watchdogs();
        arm.run(3 * image.tick);
    }
    let halted = arm.unit.now();
    arm.unit.chip().halt_core();
    let last = match image.drives {
        DriveKind::OnBus => 500 * MICROSECOND,
        DriveKind::Brushed | DriveKind::Steppers => 1,
    };
    arm.run(last);
    let from = arm.unit.now();
    arm.run(25 * MILLISECOND);
    assert!(arm.unit.chip().is_core_halted());
    arm.nothing_reaches_a_joint_from(from);
    match image.drives {
        DriveKind::OnBus => {
            assert_eq!(arm.unit.is_powered(), [false; 2], "the drives' watchdogs");
        }
        // A tick that began in the halt would be the first thing that the program goes on with.
        DriveKind::Steppers => assert!(arm.unit.chip().tick_began() <= halted),
        DriveKind::Brushed => {}
    }
    let passed = arm.unit.now() - halted;
    arm.is_off_after(BITTEN - passed);
    let (_, cause) = *arm.unit.chip().resets().last().expect("a reset");
    assert_eq!(cause, ResetCause::Watchdog);
    arm.has_restarted(Reset::Watchdog, Fault::WatchdogReset);
}

pub(crate) fn a_debugger_that_halts_the_core_ends_the_motion(image: &'static Description) {
    halts(image, false);
}

pub(crate) fn the_watchdog_ends_a_halt_though_a_debugger_has_stopped_it(
    image: &'static Description,
) {
    halts(image, true);
}
