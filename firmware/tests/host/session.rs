//! A session executes each command once, whatever happens to it on the line.

use crate::desk::{Desk, HELLO, read};
use crate::nor::Nor;
use crate::rig;
use fivebar_firmware::controller;
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::protocol::{
    CommandError, ControllerMessage, HostCommand, Identity, Reply, Section, SectionKey, Sequence,
    VERSION,
};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::{BoardLimits, SettingsError};
use fivebar_firmware::storage::{SettingsStorage, StorageError};
use fivebar_firmware::{Move, MoveKind, Request, ToldSample};

fn dwell(tag: u32) -> HostCommand {
    HostCommand::Move(Move {
        tag,
        tool: 0,
        kind: MoveKind::Dwell { duration: 0.5 },
    })
}

fn refused(reply: &Reply) -> Option<CommandError> {
    match *reply {
        Reply::Refused(error) => Some(error),
        _ => None,
    }
}

#[test]
fn before_a_hello_only_an_emergency_stop_is_executed() {
    let mut desk = Desk::new();
    for command in [
        HostCommand::Status,
        dwell(1),
        HostCommand::Request(Request::Arm),
    ] {
        let reply = desk.ask(command);
        assert_eq!(refused(&reply), Some(CommandError::NoSession));
    }
    desk.ask(HostCommand::Request(Request::EmergencyStop));
    desk.controller.tick(&desk.bench.sense());
    assert_eq!(desk.controller.status().fault, Some(Fault::EmergencyStop));
}

#[test]
fn a_host_of_another_version_gets_ours_and_changes_nothing() {
    let mut desk = Desk::greeted();
    let stranger = HostCommand::Hello {
        version: VERSION + 1,
        session: 9,
    };
    let reply = desk.reply_to(Sequence(77), stranger).expect("an answer");
    assert_eq!(refused(&reply), Some(CommandError::Version(VERSION)));
    assert!(matches!(
        desk.ask(HostCommand::Status),
        Reply::Status { .. }
    ));
}

#[test]
fn a_repeated_command_gets_the_same_reply_and_is_executed_once() {
    let mut desk = Desk::armed();
    let free = desk.planner.free_slots();
    let next = desk.last.next();
    let first = desk.send(next, dwell(1));
    let again = desk.send(next, dwell(1));
    assert_eq!(first, again);
    assert_eq!(desk.planner.free_slots(), free - 1);

    // A repeated `Tick` runs one tick only.
    desk.last = next;
    let before = desk.controller.ticks();
    let next = desk.last.next();
    let tick = HostCommand::Tick(desk.bench.sense());
    assert_eq!(desk.send(next, tick), desk.send(next, tick));
    assert_eq!(desk.controller.ticks(), before + 1);
}

#[test]
fn a_board_with_sensors_of_its_own_takes_no_tick_from_a_host() {
    let mut desk = Desk::armed();
    desk.board.sample = Some(ToldSample::default());
    let before = desk.controller.ticks();
    let tick = HostCommand::Tick(desk.bench.sense());
    assert_eq!(desk.ask(tick), Reply::Refused(CommandError::Unsupported));
    assert_eq!(desk.controller.ticks(), before);
    desk.board.sample = None;
    desk.tick();
    assert_eq!(desk.controller.ticks(), before + 1);
}

#[test]
fn old_commands_are_dropped_and_early_ones_refused_with_the_next_number() {
    let mut desk = Desk::armed();
    let free = desk.planner.free_slots();
    for behind in 1..20 {
        let late = Sequence(desk.last.0.wrapping_sub(behind));
        assert_eq!(desk.send(late, dwell(1)), None);
    }
    let early = desk.last.next().next();
    let reply = desk.reply_to(early, dwell(1)).expect("an answer");
    assert_eq!(
        refused(&reply),
        Some(CommandError::OutOfSequence(desk.last.next()))
    );
    assert_eq!(desk.planner.free_slots(), free);
}

#[test]
fn an_emergency_stop_is_executed_whatever_its_number() {
    for offset in [0u16, 1, 2, 100, 0x8000, 0xffff] {
        let mut desk = Desk::armed();
        let number = Sequence(desk.last.0.wrapping_add(offset));
        desk.send(number, HostCommand::Request(Request::EmergencyStop));
        let command = desk.controller.tick(&desk.bench.sense());
        assert_eq!(desk.controller.status().fault, Some(Fault::EmergencyStop));
        assert_eq!(
            (command.drives.duty, command.enable),
            ([0.0; 2], [false; 2])
        );
    }
}

#[test]
fn a_repeated_hello_changes_nothing_and_a_new_one_begins_a_session() {
    let mut desk = Desk::new();
    let first = desk.ask(HELLO);
    assert_eq!(desk.reply_to(desk.last, HELLO), Some(first));
    desk.ask(HostCommand::Telemetry { every: 1 });
    let late = Sequence(desk.last.0.wrapping_sub(1));
    assert_eq!(desk.send(late, HELLO), None, "one that took its time");
    desk.tick();
    assert!(
        desk.session
            .telemetry(&mut desk.controller, &desk.planner)
            .is_some()
    );

    desk.last = Sequence(500);
    let other = HostCommand::Hello {
        version: VERSION,
        session: 2,
    };
    assert!(matches!(desk.ask(other), Reply::Hello(Identity { .. })));
    desk.tick();
    assert!(
        desk.session
            .telemetry(&mut desk.controller, &desk.planner)
            .is_none()
    );
}

#[test]
fn telemetry_comes_at_its_rate_and_skipped_samples_leave_a_gap() {
    let mut desk = Desk::greeted();
    assert_eq!(desk.ask(HostCommand::Telemetry { every: 10 }), Reply::Done);
    let mut numbers = Vec::new();
    for tick in 1..=100 {
        desk.tick();
        // From tick 41 to 70 the line is busy.
        if (41..=70).contains(&tick) {
            continue;
        }
        let Some(frame) = desk.session.telemetry(&mut desk.controller, &desk.planner) else {
            continue;
        };
        match read(&frame) {
            ControllerMessage::Telemetry(sample) => {
                numbers.push((tick, sample.number, sample.status.tick));
            }
            other => panic!("{other:?}"),
        }
    }
    let expected = [10, 20, 30, 40].map(|tick| (tick, tick / 10 - 1, tick));
    assert_eq!(numbers[..4], expected);
    assert_eq!(
        numbers[4..],
        [(71, 6, 71), (80, 7, 80), (90, 8, 90), (100, 9, 100)]
    );
}

#[test]
fn settings_travel_whole_by_their_sections() {
    let mut desk = Desk::greeted();
    let mut copy = rig::settings();
    copy.payload = 7.0;
    copy.axes[1].resistance = 7.0;
    for key in SectionKey::ALL {
        match desk.ask(HostCommand::GetSection(key)) {
            Reply::Section(section) => section.put(&mut copy).expect("a known section"),
            other => panic!("{key:?}: {other:?}"),
        }
    }
    assert_eq!(copy, rig::settings());

    for key in [
        SectionKey::Link(4),
        SectionKey::Axis(2),
        SectionKey::Axis(255),
    ] {
        let reply = desk.ask(HostCommand::GetSection(key));
        assert_eq!(refused(&reply), Some(CommandError::NoSection));
    }
}

#[test]
fn settings_are_used_when_applied_and_kept_when_saved() {
    let mut desk = Desk::greeted();
    desk.tick();
    desk.ask(HostCommand::SetSection(Section::Payload(0.02)));
    assert_eq!(*desk.controller.settings(), rig::settings());
    assert_eq!(desk.ask(HostCommand::ApplySettings), Reply::Done);
    assert_eq!(desk.controller.settings().payload, 0.02);
    assert!(!desk.controller.status().homed);
    assert!(desk.board.saved.is_empty());
    assert_eq!(desk.ask(HostCommand::SaveSettings), Reply::Done);
    assert_eq!(desk.board.saved, [*desk.controller.settings()]);

    desk.board.flash = Err(StorageError::Flash);
    let reply = desk.ask(HostCommand::SaveSettings);
    assert_eq!(
        refused(&reply),
        Some(CommandError::Storage(StorageError::Flash))
    );
}

#[test]
fn invalid_settings_are_refused_as_a_whole() {
    let mut desk = Desk::greeted();
    desk.ask(HostCommand::SetSection(Section::Payload(0.02)));
    desk.ask(HostCommand::SetSection(Section::Lengths([f32::NAN; 5])));
    let reply = desk.ask(HostCommand::ApplySettings);
    assert_eq!(refused(&reply), Some(CommandError::Settings));
    assert_eq!(*desk.controller.settings(), rig::settings());
}

/// Its bridges may be on.
#[test]
fn settings_are_neither_applied_nor_saved_under_a_fault() {
    let mut desk = Desk::armed();
    desk.controller.latch_fault(Fault::CommandTimeout);
    let fault = CommandError::Request(controller::RequestError::State(State::Fault));
    for command in [HostCommand::ApplySettings, HostCommand::SaveSettings] {
        let reply = desk.ask(command);
        assert_eq!(refused(&reply), Some(fault));
    }
    assert!(desk.board.saved.is_empty() && desk.board.used == 0);
}

#[test]
fn settings_are_neither_applied_nor_saved_while_the_bridges_are_on() {
    let mut desk = Desk::armed();
    let armed = CommandError::Request(controller::RequestError::State(State::Armed));
    for command in [HostCommand::ApplySettings, HostCommand::SaveSettings] {
        let reply = desk.ask(command);
        assert_eq!(refused(&reply), Some(armed));
    }
    assert!(desk.board.saved.is_empty());
    assert_eq!(desk.controller.state(), State::Armed);
}

#[test]
fn nothing_moves_on_default_settings() {
    let mut desk = Desk::without_settings();
    desk.tick();
    desk.ask(HostCommand::Request(Request::SetAngles(rig::START)));
    for request in [Request::Arm, Request::Home] {
        let reply = desk.ask(HostCommand::Request(request));
        assert_eq!(refused(&reply), Some(CommandError::NoSettings));
        assert_eq!(desk.controller.state(), State::Stopped);
    }
    let reply = desk.ask(HostCommand::SaveSettings);
    assert_eq!(refused(&reply), Some(CommandError::NoSettings));

    assert_eq!(desk.ask(HostCommand::ApplySettings), Reply::Done);
    desk.tick();
    desk.ask(HostCommand::Request(Request::SetAngles(rig::START)));
    assert_eq!(desk.ask(HostCommand::Request(Request::Arm)), Reply::Done);
}

/// Lines around a square at the arm's position, again and again.
fn line(desk: &Desk, tag: u32) -> HostCommand {
    let [x, y] = desk.start;
    let to = match tag % 4 {
        0 => [x, y],
        1 => [x + 0.01, y],
        2 => [x + 0.01, y + 0.01],
        _ => [x, y + 0.01],
    };
    HostCommand::Move(Move {
        tag,
        tool: 0,
        kind: MoveKind::Line { to, feed: 0.1 },
    })
}

#[test]
fn moves_flow_as_room_allows_and_all_are_followed() {
    let mut desk = Desk::armed();
    let mut tag = 1;
    let mut waited = 0;
    while tag <= 120 {
        match desk.ask(line(&desk, tag)) {
            Reply::Taken { .. } => tag += 1,
            Reply::Refused(CommandError::Move(error)) => {
                assert_eq!((error.kind, error.tag), (MoveErrorKind::Full, tag));
                (0..100).for_each(|_| desk.tick());
                waited += 1;
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(waited > 10, "the queue was never full");
    let mut tags = Vec::new();
    while desk.controller.state() != State::Armed {
        desk.ask(HostCommand::Status);
        (0..100).for_each(|_| desk.tick());
        tags.extend(desk.controller.status().tag);
    }
    tags.dedup();
    assert!(tags.is_sorted() && tags.last() == Some(&120), "{tags:?}");
    for (tool, start) in desk.bench.tool().into_iter().zip(desk.start) {
        assert!((tool - f64::from(start)).abs() < 2e-4, "{tool} for {start}");
    }
}

#[test]
fn a_host_that_falls_silent_stops_the_arm_on_its_path() {
    let mut desk = Desk::armed();
    for tag in 1..8 {
        assert!(matches!(desk.ask(line(&desk, tag)), Reply::Taken { .. }));
    }
    (0..990).for_each(|_| desk.tick());
    assert_eq!(desk.controller.state(), State::Running);
    (0..2000).for_each(|_| desk.tick());
    assert_eq!(desk.controller.status().fault, Some(Fault::CommandTimeout));
    let rest = desk.bench.theta;
    (0..2000).for_each(|_| desk.tick());
    // It settles within a few counts when it begins to rest.
    for (theta, rest) in desk.bench.theta.into_iter().zip(rest) {
        assert!(
            (theta - rest).abs() < 8e-4,
            "still turns: {theta} after {rest}"
        );
    }
    assert_eq!(
        refused(&desk.ask(line(&desk, 8))).map(|error| matches!(error, CommandError::Move(_))),
        Some(true)
    );
}

#[test]
fn a_corrupt_settings_page_is_a_fault_and_nothing_moves_until_settings_are_given() {
    let mut flash = Nor::blank();
    let end = u32::try_from(flash.bytes.len()).expect("small");
    let mut storage = SettingsStorage::new(&mut flash, 0..end).expect("four sectors");
    storage.save(&rig::settings()).expect("a working flash");
    flash.bytes.iter_mut().for_each(|byte| *byte ^= 0x10);
    let mut storage = SettingsStorage::new(&mut flash, 0..end).expect("four sectors");
    let loaded = storage.load();
    assert_eq!(loaded, Err(StorageError::Corrupt));

    // The start of a board with this flash.
    let mut desk = Desk::without_settings();
    desk.controller.latch_fault(Fault::SettingsCorrupt);
    desk.tick();
    let status = desk.controller.status();
    assert_eq!(status.fault.map(Fault::number), Some(18));
    for _ in 0..100 {
        desk.tick();
        assert_eq!(desk.controller.status().duty, [0.0; 2]);
        for request in [Request::Arm, Request::Home] {
            assert!(refused(&desk.ask(HostCommand::Request(request))).is_some());
        }
    }
    assert_eq!(
        desk.ask(HostCommand::Request(Request::ClearFault)),
        Reply::Done
    );
    let reply = desk.ask(HostCommand::Request(Request::Home));
    assert_eq!(refused(&reply), Some(CommandError::NoSettings));
    assert_eq!(desk.ask(HostCommand::ApplySettings), Reply::Done);
    desk.tick();
    assert_eq!(desk.ask(HostCommand::Request(Request::Home)), Reply::Done);
}

#[test]
fn settings_beyond_the_bounds_of_the_board_are_refused() {
    let mut desk = Desk::greeted();
    let settings = rig::settings();
    let limits = BoardLimits::STM32F405;
    desk.board.limits = Some(limits);
    let (mut slow, mut fast) = (settings, settings);
    slow.control.tick_rate *= 0.5;
    // 65 536 counts a turn: 143.8 rad/s are 1 499 900 counts/s, 143.9 are 1 500 900.
    fast.protection.over_speed = 143.8;
    assert_eq!(limits.check(&fast), Ok(()));
    fast.protection.over_speed = 143.9;
    for (settings, error, text) in [
        (
            slow,
            SettingsError::BoardTickRate(10_000),
            "control.tick_rate must be 10000 Hz",
        ),
        (
            fast,
            SettingsError::BoardCountRate(1_500_000),
            "protection.over_speed must give at most 1500000 encoder counts/s",
        ),
    ] {
        assert_eq!(limits.check(&settings), Err(error));
        assert!(error.to_string().contains(text), "{error}");
        desk.ask(HostCommand::SetSection(Section::Control(settings.control)));
        let protection = Section::Protection(settings.protection);
        desk.ask(HostCommand::SetSection(protection));
        let reply = desk.ask(HostCommand::ApplySettings);
        assert_eq!(refused(&reply), Some(CommandError::Settings));
    }
    assert_eq!(*desk.controller.settings(), settings);
}
