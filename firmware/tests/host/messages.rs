//! Random messages of every kind, for property tests.

use fivebar_firmware::controller::{self, JointReference, Snapshot};
use fivebar_firmware::planner::{MoveError, MoveErrorKind};
use fivebar_firmware::protocol::{
    Board, CommandError, ControllerMessage, HostCommand, HostMessage, Identity, Reply, Reset,
    Section, SectionKey, Sequence, StackUse, StepResult, Telemetry, VERSION,
};
use fivebar_firmware::safety::{Fault, Limits, State};
use fivebar_firmware::settings::{
    AxisSettings, ControlSettings, HomingSettings, LinkSettings, MotionSettings,
    ProtectionSettings, ToolOutputSettings,
};
use fivebar_firmware::storage::StorageError;
use fivebar_firmware::{ActuatorCommand, Move, MoveKind, Request, SensorSample, Status};
use proptest::prelude::*;

/// Every bit pattern of an `f32`, NaN and infinities included.
fn number() -> impl Strategy<Value = f32> + Clone {
    any::<u32>().prop_map(f32::from_bits)
}

fn pair() -> impl Strategy<Value = [f32; 2]> + Clone {
    [number(), number()]
}

/// Any kind of move, with numbers from this strategy.
pub(crate) fn move_kind(
    number: impl Strategy<Value = f32> + Clone + 'static,
) -> impl Strategy<Value = MoveKind> {
    let pair = [number.clone(), number.clone()];
    prop_oneof![
        (pair.clone(), number.clone()).prop_map(|(to, feed)| MoveKind::Line { to, feed }),
        (pair.clone(), pair.clone(), any::<bool>(), number.clone()).prop_map(
            |(to, center, clockwise, feed)| MoveKind::Arc {
                to,
                center,
                clockwise,
                feed,
            }
        ),
        number
            .clone()
            .prop_map(|duration| MoveKind::Dwell { duration }),
        (pair, number).prop_map(|(to, speed)| MoveKind::Joint { to, speed }),
    ]
}

fn a_move() -> impl Strategy<Value = Move> {
    (any::<u32>(), any::<u16>(), move_kind(number())).prop_map(|(tag, tool, kind)| Move {
        tag,
        tool,
        kind,
    })
}

fn sensor_sample() -> impl Strategy<Value = SensorSample> {
    (
        any::<[i32; 2]>(),
        any::<[u16; 2]>(),
        any::<u16>(),
        any::<[bool; 2]>(),
        any::<bool>(),
        any::<[bool; 2]>(),
        any::<u32>(),
    )
        .prop_map(
            |(counts, current, bus_voltage, home, emergency_stop, driver_fault, missed_ticks)| {
                SensorSample {
                    counts,
                    current,
                    bus_voltage,
                    home,
                    emergency_stop,
                    driver_fault,
                    missed_ticks,
                }
            },
        )
}

fn section_key() -> impl Strategy<Value = SectionKey> {
    prop_oneof![
        prop::sample::select(SectionKey::ALL.to_vec()),
        any::<u8>().prop_map(SectionKey::Link),
        any::<u8>().prop_map(SectionKey::Axis),
    ]
}

fn axis() -> impl Strategy<Value = AxisSettings> {
    (
        prop::array::uniform16(number()),
        any::<u32>(),
        any::<u16>(),
        any::<bool>(),
    )
        .prop_map(
            |(v, encoder_counts, current_zero_code, home_forward)| AxisSettings {
                gear_ratio: v[0],
                rotor_inertia: v[1],
                torque_constant: v[2],
                resistance: v[3],
                inductance: v[4],
                viscous_friction: v[5],
                coulomb_friction: v[6],
                encoder_counts,
                encoder_latency: v[6] * 0.5,
                home_angle: v[7],
                home_forward,
                angle_limits: [v[8], v[9]],
                max_speed: v[10],
                max_acceleration: v[11],
                peak_current: v[12],
                continuous_current: v[13],
                thermal_time_constant: v[14],
                current_per_code: v[15],
                current_zero_code,
            },
        )
}

/// Any section.
pub(crate) fn section() -> impl Strategy<Value = Section> {
    prop_oneof![
        prop::array::uniform5(number()).prop_map(Section::Lengths),
        (any::<u8>(), number(), pair(), number()).prop_map(|(index, mass, com, inertia)| {
            Section::Link(index, LinkSettings { mass, com, inertia })
        }),
        number().prop_map(Section::Payload),
        pair().prop_map(Section::Gravity),
        pair().prop_map(Section::ToolOffset),
        any::<[bool; 2]>().prop_map(Section::Elbows),
        (any::<u8>(), axis()).prop_map(|(index, axis)| Section::Axis(index, axis)),
        (prop::array::uniform7(number()), any::<bool>()).prop_map(|(v, computed_torque)| {
            Section::Control(ControlSettings {
                tick_rate: v[0],
                bandwidth: v[1],
                damping: v[2],
                integral_rate: v[3],
                observer_bandwidth: v[4],
                current_bandwidth: v[5],
                friction_smoothing: v[6],
                computed_torque,
            })
        }),
        prop::array::uniform5(number()).prop_map(|v| {
            Section::Motion(MotionSettings {
                max_speed: v[0],
                max_acceleration: v[1],
                max_jerk: v[2],
                corner_tolerance: v[3],
                singularity_margin: v[4],
            })
        }),
        prop::array::uniform7(number()).prop_map(|v| {
            Section::Protection(ProtectionSettings {
                following_error: v[0],
                over_speed: v[1],
                over_current: v[2],
                bus_voltage: [v[3], v[4]],
                bus_voltage_per_code: v[5],
                command_timeout: v[6],
            })
        }),
        any::<bool>().prop_map(Section::Assembly),
        prop::array::uniform3(number()).prop_map(|v| {
            Section::Homing(HomingSettings {
                speed: v[0],
                back_off: v[1],
                current: v[2],
            })
        }),
        tool_output().prop_map(Section::ToolOutput),
    ]
}

fn tool_output() -> impl Strategy<Value = ToolOutputSettings> {
    prop_oneof![
        Just(ToolOutputSettings::None),
        prop::array::uniform5(number()).prop_map(|v| ToolOutputSettings::Servo {
            up_width: v[0],
            down_width: v[1],
            frame_rate: v[2],
            down_time: v[3],
            up_time: v[4],
        }),
        (any::<bool>(), pair()).prop_map(|(active_low, v)| ToolOutputSettings::Switch {
            active_low,
            down_time: v[0],
            up_time: v[1],
        }),
        (number(), any::<bool>()).prop_map(|(frequency, scale_with_speed)| {
            ToolOutputSettings::Power {
                frequency,
                scale_with_speed,
            }
        }),
    ]
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
        ]),
        request().prop_map(HostCommand::Request),
        a_move().prop_map(HostCommand::Move),
        section_key().prop_map(HostCommand::GetSection),
        section().prop_map(HostCommand::SetSection),
        any::<u16>().prop_map(|every| HostCommand::Telemetry { every }),
        sensor_sample().prop_map(HostCommand::Tick),
    ];
    (any::<u16>(), command).prop_map(|(sequence, command)| HostMessage {
        sequence: Sequence(sequence),
        command,
    })
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
    ]
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
                duty: status.duty,
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
        ]),
    ]
}

/// Any message of a controller.
pub(crate) fn controller_message() -> impl Strategy<Value = ControllerMessage> {
    let identity = (
        prop::sample::select(vec![Board::Desktop, Board::Emulated, Board::Stm32f405]),
        prop::sample::select(vec![
            Reset::Power,
            Reset::Software,
            Reset::Watchdog,
            Reset::Panic,
            Reset::HardFault,
            Reset::BrownOut,
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
        (status(), any::<u8>()).prop_map(|(status, room)| Reply::Status { status, room }),
        prop::option::of(snapshot()).prop_map(Reply::Snapshot),
        any::<u8>().prop_map(|room| Reply::Taken { room }),
        section().prop_map(Reply::Section),
        step_result().prop_map(Reply::StepResult),
        any::<[u32; 2]>().prop_map(|[most, size]| Reply::Stack(StackUse { most, size })),
    ];
    prop_oneof![
        (any::<u16>(), reply).prop_map(|(sequence, reply)| ControllerMessage::Reply {
            sequence: Sequence(sequence),
            reply,
        }),
        (any::<u32>(), status()).prop_map(|(number, status)| {
            ControllerMessage::Telemetry(Telemetry { number, status })
        }),
    ]
}
