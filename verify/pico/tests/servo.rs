//! The image for hobby servos: its pulses, against the desktop's loop and against the emergency stop.

mod bench;

use bench::{Bench, PERIOD, commands, desktop, of};
use fivebar_firmware::Request;
use fivebar_firmware::protocol::{Board, Reset};
use fivebar_firmware::safety::{Fault, State};
use fivebar_pico::{HZ, Pulse};

/// Cycles of a unit of a pulse, half a microsecond.
const UNIT: u64 = 75;
/// The unevenness of a pulse that is allowed: 0.1 µs.
const JITTER: i64 = 15;

#[test]
fn a_job_gives_the_pulses_of_the_loop_in_this_process() {
    let mut bench = Bench::new();
    let settings = bench.settings;
    assert_eq!(bench.identity.board, Board::Rp2350Servo);
    assert_eq!(bench.identity.reset, Reset::Power);
    let job = commands(&bench.robot, 0.03);
    bench.power();
    bench.draw(&job);
    let units = desktop(&settings, &job);
    let pulses = settings.servo_pulses().expect("servos");
    let recorded = std::mem::take(&mut bench.line.chip().wires().pulses);
    // The pulses begin in ticks that are 200 apart; which tick of the desktop's run the first one is in, is sought.
    let measured: [Vec<Pulse>; 2] = [0, 1].map(|joint| of(&recorded, joint));
    let width = |joint: usize, tick: usize| {
        let home = f64::from(pulses[joint].home_width) * HZ as f64;
        let at = units[tick.min(units.len() - 1)][joint];
        home.round() as i64 + i64::from(at) * UNIT as i64
    };
    let agrees = |shift: usize| {
        measured.iter().enumerate().all(|(joint, pulses)| {
            pulses.iter().all(|pulse| {
                let ticks = (pulse.from - measured[0][0].from + PERIOD / 2) / PERIOD;
                let tick = (ticks as usize + shift).saturating_sub(units.len());
                (pulse.cycles as i64 - width(joint, tick)).abs() <= JITTER
            })
        })
    };
    let shift = (0..2 * units.len()).find(|&shift| agrees(shift));
    let [first, other] = [&measured[0], &measured[1]].map(Vec::len);
    println!(
        "{first} and {other} pulses, shift {shift:?} of {} ticks",
        units.len()
    );
    assert!(first > 100 && first.abs_diff(other) <= 1);
    assert!(shift.is_some(), "no shift gives the pulses of this process");
    // It moved: the test would see other units.
    let span = |joint: usize| {
        let widths = measured[joint].iter().map(|pulse| pulse.cycles);
        widths.clone().max().unwrap_or(0) - widths.min().unwrap_or(0)
    };
    assert!(span(0) > 10 * UNIT && span(1) > 10 * UNIT);
    for pulses in &measured {
        for pair in pulses.windows(2) {
            let apart = pair[1].from - pair[0].from;
            assert!(apart + PERIOD / 2 > 200 * PERIOD, "{apart} cycles apart");
        }
    }
    assert_eq!(bench.line.chip().overruns(), 0);
}

#[test]
fn an_emergency_stop_ends_a_pulse_within_its_time_and_none_follows() {
    // At any moment of a pulse, and between two.
    for moment in [0, 1, 2, 100_001, 1_000_000] {
        let mut bench = Bench::new();
        bench.power();
        let mut chip = bench.line.chip();
        while !chip.wires().pulse_lasts(0) {
            chip.run(1).expect("it runs");
        }
        chip.run(moment).expect("it runs");
        let pressed = chip.now();
        chip.press_stop(true);
        chip.run(HZ / 25).expect("it runs");
        let last = chip.wires().last_edge;
        assert!(!chip.wires().pulse_lasts(0) && !chip.wires().pulse_lasts(1));
        // Four clocks, and those of the instruction in which it was pressed; the synchroniser has two more.
        assert!(
            last <= pressed + 6,
            "{moment}: {} cycles after",
            last - pressed
        );
        // Released again, nothing moves until a host asks for it.
        chip.press_stop(false);
        chip.run(HZ / 25).expect("it runs");
        assert_eq!(chip.wires().last_edge, last);
        drop(chip);
        let status = bench.status();
        assert_eq!(status.fault, Some(Fault::EmergencyStop));
        assert_eq!(status.state, State::Fault);
    }
}

#[test]
fn a_press_that_is_over_before_the_next_tick_is_seen() {
    let mut bench = Bench::new();
    bench.power();
    let mut chip = bench.line.chip();
    chip.press_stop(true);
    chip.run(150).expect("it runs");
    chip.press_stop(false);
    chip.run(HZ / 100).expect("it runs");
    drop(chip);
    assert_eq!(bench.status().fault, Some(Fault::EmergencyStop));
}

#[test]
fn a_fault_of_the_processor_ends_the_pulse_at_once_and_the_next_start_reports_it() {
    let mut bench = Bench::new();
    bench.power();
    let mut chip = bench.line.chip();
    while !chip.wires().pulse_lasts(0) {
        chip.run(1).expect("it runs");
    }
    let faulted = chip.now();
    chip.fault();
    chip.run(HZ / 50).expect("it starts again");
    assert!(chip.wires().last_edge < faulted + 200, "within 1.3 µs");
    assert_eq!(chip.resets, 1);
    drop(chip);
    assert_eq!(bench.connect_again().reset, Reset::HardFault);
    assert_eq!(bench.status().fault, Some(Fault::HardFault));
}

#[test]
fn a_core_that_hangs_makes_no_more_pulses_and_is_reset_by_the_watchdog() {
    let mut bench = Bench::new();
    bench.power();
    let mut chip = bench.line.chip();
    chip.hang();
    let hung = chip.now();
    chip.run(HZ / 25).expect("it hangs");
    assert!(
        chip.wires().last_edge < hung + HZ / 300,
        "the last pulse ends by itself"
    );
    chip.run(HZ / 25).expect("it starts again");
    assert_eq!(chip.resets, 1);
    drop(chip);
    assert_eq!(bench.connect_again().reset, Reset::Watchdog);
}

#[test]
fn stored_settings_are_there_after_a_loss_of_power_and_ticks_go_on_while_a_sector_is_erased() {
    let mut bench = Bench::new();
    // Every half is erased once, and so often the flash is busy.
    for _ in 0..3 {
        bench.save();
    }
    let missed = bench.status().missed_ticks;
    assert_eq!(missed, 0);
    bench.line.chip().power_cycle();
    bench.line.chip().run(HZ / 50).expect("it starts");
    assert_eq!(bench.connect_again().reset, Reset::Power);
    let mut read = bench.settings;
    bench.client.read_settings(&mut read).expect("a line");
    assert_eq!(read, bench.settings);
    assert_eq!(bench.status().fault, None);
}

#[test]
fn settings_of_other_motors_are_refused() {
    let mut bench = Bench::new();
    let robot = fivebar_files::robot::Robot::load("benchtop_stepper").expect("a built-in robot");
    let settings = robot.settings().expect("settings");
    let answer = bench.client.write_settings(&settings).expect("a line");
    assert!(answer.is_err());
    assert_eq!(bench.request(Request::Home), Ok(()));
}
