//! The kinds of commands, so that a test can ask whether sessions give all of them. A new command of
//! the firmware does not compile here until it has a kind.

use fivebar_firmware::protocol::HostCommand;
use fivebar_firmware::{MoveKind, Request};

/// The names of the kinds.
pub const KINDS: [&str; 32] = [
    "Hello",
    "Status",
    "Snapshot",
    "GetSection",
    "SetSection",
    "ApplySettings",
    "SaveSettings",
    "Telemetry",
    "Tick",
    "Stack",
    "Sample",
    "BeginLog",
    "ReadLog",
    "ExcitationEnd",
    "Arm",
    "Disarm",
    "Home",
    "SetAngles",
    "Stop",
    "EmergencyStop",
    "ClearFault",
    "Excite",
    "Line",
    "Arc",
    "Dwell",
    "Joint",
    "Timed",
    "Crossing",
    "BoardTest",
    "BeginStream",
    "Point",
    "EndStream",
];

/// The place of a command's kind in [`KINDS`].
pub(crate) fn kind_of(command: &HostCommand) -> usize {
    match command {
        HostCommand::Hello { .. } => 0,
        HostCommand::Status => 1,
        HostCommand::Snapshot => 2,
        HostCommand::GetSection(_) => 3,
        HostCommand::SetSection(_) => 4,
        HostCommand::ApplySettings => 5,
        HostCommand::SaveSettings => 6,
        HostCommand::Telemetry { .. } => 7,
        HostCommand::Tick(_) => 8,
        HostCommand::Stack => 9,
        HostCommand::Sample => 10,
        HostCommand::BeginLog(_) => 11,
        HostCommand::ReadLog { .. } => 12,
        HostCommand::ExcitationEnd => 13,
        HostCommand::Request(request) => match request {
            Request::Arm => 14,
            Request::Disarm => 15,
            Request::Home => 16,
            Request::SetAngles(_) => 17,
            Request::Stop => 18,
            Request::EmergencyStop => 19,
            Request::ClearFault => 20,
            Request::Excite(_) => 21,
        },
        HostCommand::Move(next) => match next.kind {
            MoveKind::Line { .. } => 22,
            MoveKind::Arc { .. } => 23,
            MoveKind::Dwell { .. } => 24,
            MoveKind::Joint { .. } => 25,
            MoveKind::Timed(_) => 26,
            MoveKind::Crossing(_) => 27,
        },
        HostCommand::BoardTest(_) => 28,
        // Walls are set where a stream begins.
        HostCommand::BeginStream(_) | HostCommand::SetFixture { .. } => 29,
        HostCommand::Point(_) => 30,
        HostCommand::EndStream => 31,
    }
}
