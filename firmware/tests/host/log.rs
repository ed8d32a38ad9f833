//! The log: chosen signals at the tick rate, read page by page.

use crate::desk::Desk;
use fivebar_firmware::Request;
use fivebar_firmware::controller::{Excitation, Excited};
use fivebar_firmware::protocol::{CommandError, HostCommand, Reply};
use fivebar_firmware::recorder::{LOG_WORDS, LogConfig, LogPage, LogState, PAGE_WORDS, Signals};

fn page(desk: &mut Desk, from: u16) -> LogPage {
    match desk.ask(HostCommand::ReadLog { from }) {
        Reply::Log(page) => page,
        other => panic!("{other:?}"),
    }
}

fn words(desk: &mut Desk) -> (LogPage, Vec<u16>) {
    let first = page(desk, 0);
    let mut words = Vec::new();
    while words.len() < usize::from(first.words) {
        let next = page(desk, words.len() as u16);
        words.extend(next.page.iter().flatten());
    }
    words.truncate(first.words.into());
    (first, words)
}

fn begin(desk: &mut Desk, signals: Signals, every: u16, powered: bool) -> Reply {
    desk.ask(HostCommand::BeginLog(LogConfig {
        signals: signals.bits(),
        every,
        powered,
    }))
}

#[test]
fn a_row_holds_the_chosen_signals_of_its_tick() {
    let mut desk = Desk::greeted();
    desk.tick();
    desk.bench.overlay.home = [false, true];
    desk.bench.stuck = Some([false, true]);
    desk.bench.overlay.emergency_stop = true;
    desk.bench.extra_counts = [i32::from(u16::MAX), 0];
    let sample = desk.bench.sense();
    assert_eq!(begin(&mut desk, Signals::all(), 1, false), Reply::Done);
    desk.tick();
    desk.tick();
    let (page, words) = words(&mut desk);
    assert_eq!(
        (page.state, page.words, page.first_tick),
        (LogState::Recording, 16, 2)
    );
    let inputs = 2 | 4 | 128;
    let row = [
        sample.counts[0] as u16,
        sample.counts[1] as u16,
        sample.drives.current[0],
        sample.drives.current[1],
        0,
        0,
        sample.drives.bus_voltage,
        inputs,
    ];
    assert_eq!(words[..8], row);
    assert_eq!(words[8..], row);
}

#[test]
fn a_log_that_waits_begins_with_the_power_and_shows_the_duty() {
    let mut desk = Desk::greeted();
    desk.tick();
    begin(&mut desk, Signals::TOLD_4 | Signals::COUNTS_4, 3, true);
    for _ in 0..20 {
        desk.tick();
    }
    assert_eq!(page(&mut desk, 0).state, LogState::Waiting);
    let excitation = Excitation {
        joint: 1,
        of: Excited::Voltage,
        offset: -1.2,
        amplitude: 0.0,
        hold: 1,
        ticks: 600,
        current: 1.0,
        travel: 1.0,
    };
    assert_eq!(
        desk.ask(HostCommand::Request(Request::Excite(excitation))),
        Reply::Done
    );
    for _ in 0..300 {
        desk.tick();
    }
    let (first, words) = words(&mut desk);
    assert_eq!((first.state, first.first_tick), (LogState::Recording, 22));
    let rows: Vec<&[u16]> = words.chunks(2).collect();
    assert_eq!(rows.len(), 100);
    let duty = |row: &[u16]| f64::from(row[1] as i16) / 32767.0 * 24.0;
    assert_eq!(duty(rows[0]), 0.0, "the bridges wake up");
    assert!((duty(rows[60]) + 1.2).abs() < 0.002, "{}", duty(rows[60]));
    let turned = (rows[99][0].wrapping_sub(rows[0][0])) as i16;
    assert!(turned < -20, "{turned} counts");
    assert_eq!(
        desk.ask(HostCommand::ExcitationEnd),
        Reply::ExcitationEnd(None)
    );
}

#[test]
fn a_log_ends_with_its_last_whole_row_and_a_new_one_replaces_it() {
    let mut desk = Desk::greeted();
    desk.tick();
    let five = Signals::all() - (Signals::TOLD_1 | Signals::TOLD_4 | Signals::INPUTS);
    begin(&mut desk, five, 1, false);
    for _ in 0..LOG_WORDS / 5 + 2 {
        desk.tick();
    }
    let (full, all) = words(&mut desk);
    assert_eq!(full.state, LogState::Full);
    assert_eq!(all.len(), LOG_WORDS / 5 * 5);
    assert!(all.chunks(5).all(|row| row[2] == 2048 && row[4] == 2400));
    let last = page(&mut desk, full.words - 3);
    assert_eq!(last.page[0][3..], [0; 29]);
    assert_eq!(page(&mut desk, u16::MAX).page, [[0; PAGE_WORDS / 2]; 2]);
    begin(&mut desk, Signals::SENSED_OF_BOTH, 1, false);
    assert_eq!(page(&mut desk, 0).words, 0);
}

#[test]
fn a_log_of_nothing_is_refused_and_the_old_one_stays() {
    let mut desk = Desk::greeted();
    begin(&mut desk, Signals::SENSED_OF_BOTH, 1, false);
    desk.tick();
    let before = page(&mut desk, 0);
    for (signals, every) in [(Signals::empty(), 1), (Signals::all(), 0)] {
        assert_eq!(
            begin(&mut desk, signals, every, false),
            Reply::Refused(CommandError::Log)
        );
    }
    assert_eq!(page(&mut desk, 0), before);
}
