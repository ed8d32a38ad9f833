//! What every fault must do, and the arm in motion when one is raised.

use super::{Bench, Driven, arm_at, robot};
use fivebar_chip::time::{MICROSECOND, MILLISECOND, Time};
use fivebar_chip::{Options, Pulses};
use fivebar_firmware::protocol::{HostCommand, Reply};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::ToolOutputSettings;
use fivebar_firmware::{FULL_TOOL, Move, MoveKind, Request};

pub(crate) const TICK: Time = 100 * MICROSECOND;
/// The longest time from a tick's trigger to its outputs here, where the flash never waits.
const RESPONSE: Time = 20 * MICROSECOND;

/// What the table states about an injected fault: the fault, and the latest tick in which it
/// is latched.
pub(crate) fn stated(test: &str) -> (Fault, u64) {
    let table = include_str!("../../../../docs/verify/data/injected_faults.csv");
    let row = table
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>())
        .find(|cells| cells[4] == test)
        .unwrap_or_else(|| panic!("injected_faults.csv has no row of {test}"));
    let number = |cell: &str| cell.split(' ').find_map(|word| word.parse::<u64>().ok());
    let fault = number(row[1]).expect("the number of a fault");
    let fault = Fault::try_from(fault as u8).expect("a known fault");
    (fault, number(row[2]).expect("a count of ticks"))
}

/// One end of a line of 60 mm.
pub(crate) fn tool_at_start() -> [f32; 2] {
    let [x, y] = robot().best_point().expect("a point");
    [x as f32 + 0.03, y as f32]
}

/// The arm there, about to get power.
pub(crate) fn at_the_end(options: Options) -> Bench {
    Bench::of(arm_at(tool_at_start(), MILLISECOND), options, Vec::new())
}

pub(crate) fn offer(driven: &mut Driven, next: Move) {
    let reply = driven.client.call(HostCommand::Move(next));
    assert!(matches!(reply, Ok(Reply::Taken { .. })), "{reply:?}");
}

/// A power: it is switched at once, in the middle of a frame, too.
pub(crate) const POWER: ToolOutputSettings = ToolOutputSettings::Power {
    frequency: 5e3,
    scale_with_speed: false,
};

/// The arm on its way along the line, to and fro, at 0.1 m/s, with its tool on.
pub(crate) fn moving() -> Driven {
    let [x, y] = tool_at_start();
    let mut driven =
        at_the_end(Options::default()).ready_with(|settings| settings.tool_output = POWER);
    driven.arm();
    for tag in 1..=6 {
        let to = [x - 0.06 * [1.0, 0.0][tag as usize % 2], y];
        let kind = MoveKind::Line { to, feed: 0.1 };
        let tool = FULL_TOOL / 2;
        offer(&mut driven, Move { tag, tool, kind });
    }
    driven.run(60 * MILLISECOND);
    assert_eq!(driven.status().state, State::Running);
    assert!(!tool_is_off(&driven));
    driven
}

/// Whether the tool gets nothing.
pub(crate) fn tool_is_off(driven: &Driven) -> bool {
    matches!(
        driven.arm.get().outputs().tool,
        Pulses::Released | Pulses::Level(false)
    )
}

/// Runs until the fault is latched, the host giving signs of life; the ticks that it took.
pub(crate) fn ticks_until_off(driven: &mut Driven, within: u64) -> u64 {
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
    // The tool goes off with the bridges: by the same tick, or before it by a stop. The look at the
    // bridges can come between the tick's two writes. A break input that trips just behind a tick's look at it
    // switches the bridges off at once, and the tool in the next tick.
    driven.run(TICK + RESPONSE);
    let tool = driven.arm.get().tool.last().copied();
    assert!(tool_is_off(driven), "the tool is on: {tool:?}");
    assert!(
        tool.is_none_or(|(at, _)| at <= off_at + TICK + RESPONSE),
        "{tool:?}"
    );
    (off_at - began).div_ceil(TICK)
}

/// Nothing that the host asks for moves the arm; then the fault can be cleared.
pub(crate) fn stays_off_until_cleared(driven: &mut Driven, fault: Fault) {
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
        assert!(driven.is_off() && tool_is_off(driven));
    }
    assert_eq!(driven.arm.get().history.len(), changes);
    driven.request(Request::ClearFault).expect("cleared");
    driven.run(2 * TICK);
    assert!(driven.is_off());
}

/// The arm rests, and the bridges stay on until the fault is cleared.
pub(crate) fn is_held_until_cleared(driven: &mut Driven, fault: Fault) {
    assert!(!driven.is_off() && tool_is_off(driven));
    let at = driven.arm.get().plant().tool();
    driven.run(100 * TICK);
    assert!((driven.arm.get().plant().tool() - at).norm() < 1e-4);
    let status = driven.status();
    assert_eq!((status.state, status.fault), (State::Fault, Some(fault)));
    for request in [Request::Arm, Request::Home, Request::Disarm] {
        assert!(driven.request(request).is_err(), "{request:?}");
    }
    assert!((driven.arm.get().plant().tool() - at).norm() < 1e-4);
    driven.request(Request::ClearFault).expect("cleared");
    driven.run(2 * TICK);
    assert!(driven.is_off());
}
