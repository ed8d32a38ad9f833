//! Random messages of every kind, for property tests.

use crate::moves::a_move;
use crate::sections::{section, section_key};
use fivebar_firmware::controller::{
    self, Excitation, ExcitationEnd, Excited, JointReference, Snapshot,
};
use fivebar_firmware::drives::{BrushedCommand, BrushedSample};
use fivebar_firmware::motion::{
    Fixture, FixtureShape, Impedance, StreamConfig, StreamMode, StreamPoint, StreamPolicy,
};
use fivebar_firmware::planner::{MoveError, MoveErrorKind};
use fivebar_firmware::planner::{StreamError, StreamPhase, StreamProgress, StreamReason};
use fivebar_firmware::protocol::{
    Board, BoardFacts, BoardReport, BoardTest, CommandError, ControllerMessage, FlashTime,
    HostCommand, HostMessage, Identity, Reply, Reset, Sequence, StackUse, StepResult, StreamState,
    TIMING_BINS, Telemetry, TimedSpan, Timing, VERSION,
};
use fivebar_firmware::recorder::{LogConfig, LogPage, LogState};
use fivebar_firmware::safety::{Fault, Limits, State};
use fivebar_firmware::storage::StorageError;
use fivebar_firmware::{ActuatorCommand, Request, SensorSample, Status};
use proptest::prelude::*;

/// Every bit pattern of an `f32`, NaN and infinities included.
pub(crate) fn number() -> impl Strategy<Value = f32> + Clone {
    any::<u32>().prop_map(f32::from_bits)
}

pub(crate) fn pair() -> impl Strategy<Value = [f32; 2]> + Clone {
    [number(), number()]
}

fn sensor_sample() -> impl Strategy<Value = SensorSample> {
    (
        any::<[i32; 2]>(),
        any::<[u16; 2]>(),
        any::<u16>(),
        any::<[[bool; 2]; 2]>(),
        any::<bool>(),
        any::<[bool; 2]>(),
        any::<u32>(),
    )
        .prop_map(
            |(
                counts,
                current,
                bus_voltage,
                [home, index],
                emergency_stop,
                driver_fault,
                missed_ticks,
            )| {
                SensorSample {
                    counts,
                    drives: BrushedSample {
                        current,
                        bus_voltage,
                    },
                    home,
                    index,
                    emergency_stop,
                    driver_fault,
                    missed_ticks,
                }
            },
        )
}

/// Any message of a host.
pub(crate) fn host_message() -> impl Strategy<Value = HostMessage> {
    let command = prop_oneof![
        (any::<u16>(), any::<u32>())
            .prop_map(|(version, session)| HostCommand::Hello { version, session }),
        prop::sample::select(vec![
            HostCommand::Status,
            HostCommand::Snapshot,
            HostCommand::ApplySettings,
            HostCommand::SaveSettings,
            HostCommand::Stack,
            HostCommand::Sample,
            HostCommand::ExcitationEnd,
        ]),
        request().prop_map(HostCommand::Request),
        a_move().prop_map(HostCommand::Move),
        section_key().prop_map(HostCommand::GetSection),
        section().prop_map(HostCommand::SetSection),
        any::<u16>().prop_map(|every| HostCommand::Telemetry { every }),
        sensor_sample().prop_map(HostCommand::Tick),
        any::<(u8, u16, bool)>().prop_map(|(signals, every, powered)| {
            HostCommand::BeginLog(LogConfig {
                signals,
                every,
                powered,
            })
        }),
        any::<u16>().prop_map(|from| HostCommand::ReadLog { from }),
        board_test().prop_map(HostCommand::BoardTest),
        stream_config().prop_map(HostCommand::BeginStream),
        stream_point().prop_map(HostCommand::Point),
        Just(HostCommand::EndStream),
        (any::<u8>(), prop::option::of(fixture()))
            .prop_map(|(place, fixture)| HostCommand::SetFixture { place, fixture }),
    ];
    (any::<u16>(), command).prop_map(|(sequence, command)| HostMessage {
        sequence: Sequence(sequence),
        command,
    })
}

fn stream_config() -> impl Strategy<Value = StreamConfig> {
    let mode = prop_oneof![
        Just(StreamMode::Tip),
        Just(StreamMode::Joint),
        Just(StreamMode::Free),
        impedance().prop_map(StreamMode::Impedance),
    ];
    (mode, any::<(u32, u16, u16, bool)>()).prop_map(|(mode, (id, period, delay, stops))| {
        StreamConfig {
            id,
            mode,
            period,
            delay,
            policy: if stops {
                StreamPolicy::Stop
            } else {
                StreamPolicy::Limit
            },
        }
    })
}

fn impedance() -> impl Strategy<Value = Impedance> {
    any::<((f32, f32, f32), (f32, f32, f32))>()
        .prop_map(|(stiffness, damping)| Impedance { stiffness, damping })
}

fn fixture() -> impl Strategy<Value = Fixture> {
    (0..6, any::<([f32; 6], f32, f32)>()).prop_map(
        |(kind, ([a, b, c, d, e, f], stiffness, damping))| {
            let (point, normal, radius) = ((a, b), (c, d), e);
            let centre = point;
            let shape = match kind {
                0 => FixtureShape::HalfPlane { point, normal },
                1 => FixtureShape::Box {
                    centre,
                    axis: normal,
                    half: (e, f),
                },
                2 => FixtureShape::Inside { centre, radius },
                3 => FixtureShape::Outside { centre, radius },
                4 => FixtureShape::Line { point, normal },
                _ => FixtureShape::Circle { centre, radius },
            };
            Fixture {
                shape,
                stiffness,
                damping,
            }
        },
    )
}

fn stream_point() -> impl Strategy<Value = StreamPoint> {
    any::<(u32, u32, [f32; 2], [f32; 2], [f32; 2])>().prop_map(
        |(id, due, position, velocity, force)| StreamPoint {
            id,
            due,
            position: position.into(),
            velocity: velocity.into(),
            force: force.into(),
        },
    )
}

fn stream_state() -> impl Strategy<Value = StreamState> {
    let phase = prop::sample::select(vec![
        StreamPhase::Waits,
        StreamPhase::Follows,
        StreamPhase::Starved,
        StreamPhase::Ends,
        StreamPhase::Ended,
    ]);
    let reason = prop::sample::select(vec![
        StreamReason::Asked,
        StreamReason::Stopped,
        StreamReason::Late,
        StreamReason::Number,
        StreamReason::Early,
        StreamReason::Order,
        StreamReason::Full,
        StreamReason::Gap,
        StreamReason::Away(0.25),
        StreamReason::Limit(MoveErrorKind::Overload(4)),
        StreamReason::Silent,
        StreamReason::Force,
    ]);
    let progress = (
        phase,
        prop::option::of(reason),
        any::<(u32, Option<u16>, [u16; 4])>(),
    );
    let progress = progress.prop_map(
        |(phase, reason, (id, last, [late, lost, refused, limited]))| StreamProgress {
            id,
            phase,
            reason,
            last,
            late,
            lost,
            refused,
            limited,
        },
    );
    (progress, any::<(u32, i16, [[f32; 2]; 3])>()).prop_map(
        |(progress, (tick, buffered, [angle, velocity, torque]))| StreamState {
            tick,
            progress,
            buffered,
            angle,
            velocity,
            torque,
        },
    )
}

fn request() -> impl Strategy<Value = Request> {
    prop_oneof![
        prop::sample::select(vec![
            Request::Arm,
            Request::Disarm,
            Request::Home,
            Request::Stop,
            Request::EmergencyStop,
            Request::ClearFault,
        ]),
        pair().prop_map(Request::SetAngles),
        excitation().prop_map(Request::Excite),
    ]
}

fn excitation() -> impl Strategy<Value = Excitation> {
    let of = prop::sample::select(vec![Excited::Voltage, Excited::Current]);
    (any::<u8>(), of, pair(), any::<(u16, u32)>(), pair()).prop_map(
        |(joint, of, [offset, amplitude], (hold, ticks), [current, travel])| Excitation {
            joint,
            of,
            offset,
            amplitude,
            hold,
            ticks,
            current,
            travel,
        },
    )
}

fn log_page() -> impl Strategy<Value = LogPage> {
    let state = prop::sample::select(vec![
        LogState::Empty,
        LogState::Waiting,
        LogState::Recording,
        LogState::Full,
    ]);
    (state, any::<(u16, u32)>(), any::<[[u16; 32]; 2]>()).prop_map(
        |(state, (words, first_tick), page)| LogPage {
            state,
            words,
            first_tick,
            page,
        },
    )
}

fn board_test() -> impl Strategy<Value = BoardTest> {
    prop::sample::select(vec![
        BoardTest::Facts,
        BoardTest::BeginTiming,
        BoardTest::Timing(TimedSpan::Interrupt),
        BoardTest::Timing(TimedSpan::Response),
        BoardTest::EraseFlash,
        BoardTest::ProgramFlash,
        BoardTest::Hang,
    ])
}

fn board_report() -> impl Strategy<Value = BoardReport> {
    let facts = (
        any::<(u32, Option<u32>, u32, u16, u8)>(),
        any::<([u32; 3], u32, u32, Option<u32>)>(),
    );
    prop_oneof![
        facts.prop_map(
            |((core, crystal, flash_access, flash_size, brown_out), rest)| {
                let (unique_id, cycles, tick, hung) = rest;
                BoardReport::Facts(BoardFacts {
                    core,
                    crystal,
                    flash_access,
                    flash_size,
                    brown_out,
                    unique_id,
                    cycles,
                    tick,
                    hung,
                })
            }
        ),
        any::<(u32, u32, u32, u64, [u32; TIMING_BINS])>().prop_map(
            |(ticks, least, greatest, sum, bins)| BoardReport::Timing(Timing {
                ticks,
                least,
                greatest,
                sum,
                bins,
            })
        ),
        any::<(u32, u16)>().prop_map(|(longest, operations)| {
            BoardReport::Flash(FlashTime {
                longest,
                operations,
            })
        }),
    ]
}

fn excitation_end() -> impl Strategy<Value = ExcitationEnd> {
    prop::sample::select(vec![
        ExcitationEnd::Time,
        ExcitationEnd::Travel,
        ExcitationEnd::Current,
    ])
}

fn state() -> impl Strategy<Value = State> {
    prop::sample::select(State::ALL.to_vec())
}

fn fault() -> impl Strategy<Value = Fault> {
    prop::sample::select(Fault::all().collect::<Vec<_>>())
}

fn limits() -> impl Strategy<Value = Limits> {
    prop::sample::select(vec![
        Limits::empty(),
        Limits::TORQUE,
        Limits::VOLTAGE,
        Limits::SPEED,
    ])
}

fn status() -> impl Strategy<Value = Status> {
    let discrete = (
        any::<[u32; 2]>(),
        state(),
        prop::option::of(fault()),
        limits(),
        any::<bool>(),
    );
    let joints =
        [pair(), pair(), pair()].prop_map(|[angle, velocity, acceleration]| JointReference {
            angle,
            velocity,
            acceleration,
        });
    let places = (
        [prop::option::of(pair()), prop::option::of(pair())],
        prop::option::of(joints),
    );
    let rest = (number(), any::<Option<u32>>(), number());
    (discrete, prop::array::uniform6(pair()), places, rest).prop_map(
        |(
            ([tick, missed_ticks], state, fault, limits, homed),
            [angle, velocity, torque, current_demand, current, duty],
            ([tool, reference], joint_reference),
            (bus_voltage, tag, tool_level),
        )| Status {
            tick,
            missed_ticks,
            state,
            fault,
            limits,
            homed,
            angle,
            velocity,
            tool,
            reference,
            joint_reference,
            torque,
            current_demand,
            current,
            duty,
            bus_voltage,
            tag,
            tool_level,
        },
    )
}

fn snapshot() -> impl Strategy<Value = Snapshot> {
    let pairs = prop::array::uniform5(pair());
    (fault(), any::<u32>(), state(), pairs, number()).prop_map(
        |(fault, tick, state, [angle, velocity, error, current, torque], bus_voltage)| Snapshot {
            fault,
            tick,
            state,
            angle,
            velocity,
            error,
            current,
            torque,
            bus_voltage,
        },
    )
}

fn step_result() -> impl Strategy<Value = StepResult> {
    (status(), any::<[bool; 3]>(), any::<u16>(), any::<u32>()).prop_map(
        |(status, on, tool, instructions)| {
            let [enable1, enable4, brake] = on;
            let command = ActuatorCommand {
                drives: BrushedCommand { duty: status.duty },
                enable: [enable1, enable4],
                brake,
                tool,
            };
            StepResult::new(command, &status, instructions)
        },
    )
}

fn move_error() -> impl Strategy<Value = MoveError> {
    let kind = prop_oneof![
        state().prop_map(MoveErrorKind::State),
        Just(MoveErrorKind::Full),
        any::<u8>().prop_map(MoveErrorKind::Torque),
        Just(MoveErrorKind::TooLong),
    ];
    (any::<u32>(), kind, prop::option::of(pair())).prop_map(|(tag, kind, point)| MoveError {
        tag,
        kind,
        point,
    })
}

fn command_error() -> impl Strategy<Value = CommandError> {
    prop_oneof![
        any::<u16>().prop_map(CommandError::Version),
        any::<u16>().prop_map(|next| CommandError::OutOfSequence(Sequence(next))),
        state().prop_map(|state| CommandError::Request(controller::RequestError::State(state))),
        move_error().prop_map(CommandError::Move),
        prop::sample::select(vec![
            CommandError::NoSession,
            CommandError::Unsupported,
            CommandError::Request(controller::RequestError::NotHomed),
            CommandError::Request(controller::RequestError::Moving),
            CommandError::NoSettings,
            CommandError::NoSection,
            CommandError::Settings,
            CommandError::Storage(StorageError::Blank),
            CommandError::Storage(StorageError::Range),
            CommandError::Log,
            CommandError::Stream(StreamError::Rate),
            CommandError::Request(controller::RequestError::Excitation),
        ]),
    ]
}

/// Any message of a controller.
pub(crate) fn controller_message() -> impl Strategy<Value = ControllerMessage> {
    let identity = (
        prop::sample::select(vec![
            Board::Desktop,
            Board::Emulated,
            Board::Stm32f405,
            Board::Stm32f405Stepper,
            Board::Stm32f405Can,
            Board::Rp2350Servo,
            Board::Rp2350Stepper,
        ]),
        prop::sample::select(vec![
            Reset::Power,
            Reset::Software,
            Reset::Watchdog,
            Reset::Panic,
            Reset::HardFault,
            Reset::BrownOut,
            Reset::Pin,
            Reset::Unknown,
        ]),
        any::<[u8; 3]>(),
    )
        .prop_map(|(board, reset, firmware)| Identity {
            version: VERSION,
            board,
            firmware,
            reset,
        });
    let reply = prop_oneof![
        command_error().prop_map(Reply::Refused),
        Just(Reply::Done),
        identity.prop_map(Reply::Hello),
        (status(), any::<u8>()).prop_map(|(status, free)| Reply::Status { status, free }),
        prop::option::of(snapshot()).prop_map(Reply::Snapshot),
        any::<u8>().prop_map(|free| Reply::Taken { free }),
        section().prop_map(Reply::Section),
        step_result().prop_map(Reply::StepResult),
        any::<[u32; 2]>().prop_map(|[most, size]| Reply::Stack(StackUse { most, size })),
        sensor_sample().prop_map(|sample| Reply::Sample(sample.with_drives(sample.drives.into()))),
        log_page().prop_map(Reply::Log),
        prop::option::of(excitation_end()).prop_map(Reply::ExcitationEnd),
        board_report().prop_map(Reply::Board),
    ];
    prop_oneof![
        // Replies have the most variants.
        8 => (any::<u16>(), reply).prop_map(|(sequence, reply)| ControllerMessage::Reply {
            sequence: Sequence(sequence),
            reply,
        }),
        1 => (any::<u32>(), status()).prop_map(|(number, status)| {
            ControllerMessage::Telemetry(Telemetry { number, status })
        }),
        1 => stream_state().prop_map(ControllerMessage::Stream),
    ]
}
