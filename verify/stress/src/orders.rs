//! What happens in a session, one event after the other.

use crate::bytes::Bytes;
use crate::crossing_arm::{CROSSING, cross};
use crate::samples::Hostile;
use crate::sections::{key, section, tool_output};
use crate::stream::StreamRun;
use crate::timed::{TimedRun, Tool};
use fivebar_firmware::controller::{Excitation, Excited};
use fivebar_firmware::protocol::{BoardTest, HostCommand, VERSION};
use fivebar_firmware::recorder::LogConfig;
use fivebar_firmware::{CrossingMove, MoveKind, Request, SensorSample, Settings};
use fivebar_plant::FaultKind;

/// An event of a session.
#[derive(Clone, Debug)]
pub(crate) enum Event {
    /// The host sends this command, with the next number.
    Command(HostCommand),
    /// The host sends a move.
    Move(MoveKind),
    /// The host sends a motion that it has planned.
    Timed(TimedRun),
    /// Set-points are streamed.
    Stream(StreamRun),
    /// The host brings the arm to where a crossing begins, and sends it.
    Crossing(CrossingMove),
    /// The host clears the fault, declares the angles and arms the arm.
    Recover,
    /// Somebody replaces the arm by a sound one at the pose of the start.
    Repair,
    /// The host declares the joints to be where they are.
    DeclareAngles,
    /// The host sends the last frame again.
    Repeat,
    /// The host skips some numbers.
    Skip(u8),
    /// These bytes arrive.
    Garbage(Vec<u8>),
    /// One byte of the next frame arrives changed.
    Corrupt(u8),
    /// Time passes; the host requests the status now and then.
    Wait(u16),
    /// Time passes, and the host is silent.
    Silence(u16),
    /// The samples are not those of the arm for some ticks.
    Hostile(Hostile, u8),
    /// The arm fails in this way.
    Fault(FaultKind),
    /// From now on the planner runs once in this many ticks.
    Planner(u8),
}

/// Whether half of the moves of a session with these flags are motions that the host plans.
pub(crate) fn host_plans(flags: u8) -> bool {
    flags & 0x20 != 0 && flags & 0xc0 != 0
}

/// Whether the arm of a session with these flags can cross a singularity.
pub(crate) fn crosses(flags: u8) -> bool {
    flags & 0xe0 == 0xc0
}

/// The settings of a session with these flags: any tool, and for a host that plans, in two of three
/// cases a lower limit of the joints' speed or acceleration. Else their torques limit every motion.
pub(crate) fn settings(flags: u8) -> Settings {
    let mut settings = Settings {
        tool_output: tool_output(flags >> 2),
        ..Settings::BENCHTOP
    };
    if crosses(flags) {
        cross(&mut settings);
    }
    if host_plans(flags) {
        let [speed, acceleration] = match flags >> 6 {
            1 => [0.15, 1.0],
            2 => [1.0, 0.3],
            _ => [1.0, 1.0],
        };
        for axis in &mut settings.axes {
            axis.max_speed *= speed;
            axis.max_acceleration *= acceleration;
        }
    }
    settings
}

/// The next event of a session with these flags.
pub(crate) fn next(bytes: &mut Bytes<'_>, tool: Tool, flags: u8, settings: &Settings) -> Event {
    match bytes.byte() {
        0..=34 if host_plans(flags) => Event::Timed(TimedRun::from_bytes(bytes)),
        35..=49 if host_plans(flags) => Event::Stream(StreamRun::from_bytes(bytes)),
        0..=29 if crosses(flags) => Event::Crossing(crossing(bytes)),
        0..=89 => Event::Move(motion(bytes, tool)),
        90..=139 => Event::Wait(u16::from(bytes.byte()) * 8),
        140..=159 => Event::Command(HostCommand::Request(request(bytes))),
        160..=181 => Event::Recover,
        182..=185 => Event::DeclareAngles,
        186..=189 => Event::Repair,
        190..=192 => Event::Hostile(Hostile::from_bytes(bytes), bytes.byte()),
        193..=195 => Event::Fault(fault(bytes)),
        196..=201 => Event::Silence(bytes.short() % 3000),
        202..=205 => Event::Repeat,
        206..=207 => Event::Skip(bytes.byte()),
        208..=211 => Event::Garbage((0..bytes.byte()).map(|_| bytes.byte()).collect()),
        212..=213 => Event::Corrupt(bytes.byte()),
        214..=217 => Event::Planner(1 + bytes.byte() % 60),
        218..=237 => Event::Command(HostCommand::SetSection(section(bytes, settings))),
        238..=243 => Event::Command(HostCommand::ApplySettings),
        244..=245 => Event::Command(HostCommand::SaveSettings),
        246 => Event::Command(log_command(bytes)),
        247..=248 => Event::Command(match bytes.byte() % 7 {
            0 => HostCommand::Snapshot,
            1 => HostCommand::Stack,
            2 => HostCommand::Sample,
            3 => HostCommand::ExcitationEnd,
            4 => HostCommand::GetSection(key(bytes)),
            5 => HostCommand::BoardTest(BoardTest::EraseFlash),
            _ => HostCommand::Tick(SensorSample::default()),
        }),
        249..=250 => Event::Command(HostCommand::Telemetry {
            every: bytes.short(),
        }),
        251..=253 => Event::Command(HostCommand::Hello {
            version: if bytes.byte() < 230 { VERSION } else { 0 },
            session: u32::from(bytes.byte() % 4),
        }),
        254..=255 => Event::Command(HostCommand::Status),
    }
}

fn log_command(bytes: &mut Bytes<'_>) -> HostCommand {
    match bytes.byte() % 3 {
        0 => HostCommand::ReadLog {
            from: bytes.short(),
        },
        _ => HostCommand::BeginLog(LogConfig {
            signals: bytes.byte(),
            every: bytes.short() % 8,
            powered: bytes.flag(),
        }),
    }
}

/// Three of four are the planned one; the others have another number.
fn crossing(bytes: &mut Bytes<'_>) -> CrossingMove {
    let mut plan = CROSSING;
    let which = bytes.byte();
    let [b0, _, b2] = &mut plan.law;
    let numbers = [
        &mut plan.from[0],
        &mut plan.to[1],
        &mut plan.duration,
        &mut plan.crosses_at,
        b0,
        b2,
    ];
    if let Some(number) = numbers.into_iter().nth(usize::from(which % 24)) {
        *number = match bytes.byte() {
            0..=31 => f32::from_bits(bytes.word()),
            _ => *number * bytes.within(0.9, 1.1),
        };
    }
    plan
}

fn request(bytes: &mut Bytes<'_>) -> Request {
    match bytes.byte() {
        0..=79 => Request::Arm,
        80..=99 => Request::Disarm,
        100..=114 => Request::Home,
        115..=119 => Request::Excite(excitation(bytes)),
        120..=159 => Request::Stop,
        160..=179 => Request::EmergencyStop,
        180..=239 => Request::ClearFault,
        240..=255 => Request::SetAngles(bytes.pair(-4.0, 4.0)),
    }
}

/// Half of these are within their bounds on an arm as strong as the benchtop arm.
fn excitation(bytes: &mut Bytes<'_>) -> Excitation {
    let of = match bytes.byte() {
        0..=127 => Excited::Voltage,
        128..=255 => Excited::Current,
    };
    let [offset, amplitude] = bytes.pair(-1.0, 1.0);
    let [current, travel] = bytes.pair(0.0, 2.5);
    Excitation {
        joint: bytes.byte() % 2,
        of,
        offset,
        amplitude,
        hold: bytes.byte().into(),
        ticks: 10 * u32::from(bytes.byte()),
        current,
        travel,
    }
}

/// Most moves are short ones from `tool`; some go far, and some have any number.
fn motion(bytes: &mut Bytes<'_>, [x, y]: Tool) -> MoveKind {
    let kind = bytes.byte();
    let reach = match bytes.byte() {
        0..=79 => 0.005,
        80..=159 => 0.02,
        160..=239 => 0.06,
        240..=255 => 0.3,
    };
    let near = |bytes: &mut Bytes<'_>| {
        let [dx, dy] = bytes.pair(-reach, reach);
        [x + dx, y + dy]
    };
    let to = near(bytes);
    match kind {
        0..=139 => MoveKind::Line {
            to,
            feed: bytes.number(0.0, 0.4),
        },
        140..=199 => arc(bytes, [x, y], to),
        200..=219 => MoveKind::Dwell {
            duration: bytes.number(0.0, 0.05),
        },
        220..=255 => MoveKind::Joint {
            to: [bytes.number(1.2, 3.4), bytes.number(-0.3, 1.9)],
            speed: bytes.number(0.0, 1.0),
        },
    }
}

/// An arc around a centre that is mostly as far from both ends.
fn arc(bytes: &mut Bytes<'_>, [x, y]: Tool, to: [f32; 2]) -> MoveKind {
    let [dx, dy] = [0.5 * (to[0] - x), 0.5 * (to[1] - y)];
    let aside = bytes.within(-2.0, 2.0);
    let center = if bytes.byte() < 240 {
        [x + dx - aside * dy, y + dy + aside * dx]
    } else {
        bytes.pair(-0.3, 0.3)
    };
    MoveKind::Arc {
        to: if bytes.byte() < 240 { to } else { [x, y] },
        center,
        clockwise: bytes.flag(),
        feed: bytes.number(0.0, 0.4),
    }
}

fn fault(bytes: &mut Bytes<'_>) -> FaultKind {
    let joint = bytes.joint();
    match bytes.byte() % 10 {
        0 => FaultKind::EncoderDead { joint },
        1 => FaultKind::EncoderJump {
            joint,
            counts: i32::from(bytes.short()) - 32768,
        },
        2 => FaultKind::SwitchStuck {
            joint,
            pressed: bytes.flag(),
        },
        3 => FaultKind::MotorDisconnected { joint },
        4 => FaultKind::MotorStalled { joint },
        5 => FaultKind::CurrentOffset {
            joint,
            amperes: f64::from(bytes.within(-8.0, 8.0)),
        },
        6 => FaultKind::BusVoltage {
            volts: f64::from(bytes.within(0.0, 60.0)),
        },
        7 => FaultKind::DriverFault { joint },
        8 => FaultKind::EmergencyStop,
        _ => FaultKind::TicksMissed {
            ticks: u32::from(bytes.byte() % 8),
        },
    }
}
