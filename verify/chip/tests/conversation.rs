//! The whole conversation with the production image: each host command, and what it refuses.

mod bench;

use bench::{Bench, Driven, hear, say, settings};
use fivebar_chip::Options;
use fivebar_chip::time::{MICROSECOND, MILLISECOND};
use fivebar_firmware::controller::RequestError;
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::protocol::{
    CommandError, ControllerMessage, HostCommand, HostMessage, Reply, SectionKey, Sequence,
    VERSION, encode,
};
use fivebar_firmware::safety::State;
use fivebar_firmware::{Move, MoveKind, Request, SensorSample, Settings};

#[test]
fn sequence_and_session_are_checked() {
    let driven = Bench::with(Options::default(), Vec::new(), 0).connect();
    driven.chip().reset(fivebar_chip::ResetCause::Pin);
    driven.chip().run(500 * MILLISECOND).expect("no violation");
    let hello = |version| HostCommand::Hello {
        version,
        session: 9,
    };
    assert_eq!(
        say(&driven, 1, HostCommand::Status),
        [Reply::Refused(CommandError::NoSession)]
    );
    let other = VERSION + 1;
    let refused = say(&driven, 1, hello(other));
    assert_eq!(refused, [Reply::Refused(CommandError::Version(VERSION))]);
    assert!(matches!(
        say(&driven, 5, hello(VERSION))[..],
        [Reply::Hello(_)]
    ));
    let first = say(&driven, 6, HostCommand::Stack);
    let [Reply::Stack(stack)] = first[..] else {
        panic!("{first:?}");
    };
    assert_eq!(stack.size, 16 * 1024);
    assert!(
        (1024..stack.size / 4 * 3).contains(&stack.most),
        "{stack:?}"
    );
    // A repeat gets the stored reply, an old command none, and a gap is refused.
    assert_eq!(say(&driven, 6, HostCommand::Stack), first);
    assert_eq!(say(&driven, 3, HostCommand::Status), []);
    let gap = Reply::Refused(CommandError::OutOfSequence(Sequence(7)));
    assert_eq!(say(&driven, 9, HostCommand::Status), [gap]);
    let tick = HostCommand::Tick(SensorSample::default());
    assert_eq!(
        say(&driven, 7, tick),
        [Reply::Refused(CommandError::Unsupported)]
    );
    let reply = say(&driven, 8, HostCommand::Sample);
    let [Reply::Sample(sample)] = reply[..] else {
        panic!("{reply:?}");
    };
    // The arm rests, its bridges asleep, on a bus of 24 V.
    for code in sample.drives.joints {
        assert!(code.abs_diff(2048) < 20, "{sample:?}");
    }
    let bus = f32::from(sample.drives.both) * Settings::BENCHTOP.protection.bus_voltage_per_code;
    assert!((bus - 24.0).abs() < 0.5, "{sample:?}");
    assert_eq!(
        (sample.home, sample.emergency_stop, sample.driver_fault),
        ([false; 2], false, [false; 2])
    );
}

/// A frame with these bytes as its message: valid up to the message itself.
fn frame_of(message: &[u8]) -> Vec<u8> {
    let mut content = vec![b'H'];
    content.extend(message);
    let crc = content.iter().fold(!0_u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            let out = crc & 1 != 0;
            crc >> 1 ^ if out { 0x82f6_3b78 } else { 0 }
        })
    });
    content.extend((!crc).to_le_bytes());
    let mut frame = vec![0];
    let parts: Vec<_> = content.split(|&byte| byte == 0).collect();
    for part in parts {
        frame.push(part.len() as u8 + 1);
        frame.extend(part);
    }
    frame.push(0);
    frame
}

#[test]
fn messages_that_are_cut_short_or_malformed_are_dropped() {
    let mut driven = Driven::new();
    let settings = settings();
    // On a busy desktop the client may have sent a command twice; the second reply comes now.
    driven.chip().run(50 * MILLISECOND).expect("no violation");
    hear(&driven);
    let sections = SectionKey::ALL.iter().filter_map(|key| key.of(&settings));
    let commands = sections
        .map(HostCommand::SetSection)
        .chain([
            HostCommand::Tick(SensorSample {
                missed_ticks: 1 << 30,
                counts: [-1, i32::MAX],
                ..SensorSample::default()
            }),
            HostCommand::Hello {
                version: VERSION,
                session: u32::MAX,
            },
            HostCommand::Telemetry { every: 3 },
            HostCommand::Request(Request::SetAngles([1.0, 2.0])),
            HostCommand::GetSection(SectionKey::ALL[2]),
        ])
        .chain(
            [
                MoveKind::Arc {
                    to: [0.1, 0.2],
                    center: [0.3, 0.4],
                    clockwise: true,
                    feed: 0.1,
                },
                MoveKind::Dwell { duration: 1.0 },
            ]
            .map(|kind| {
                HostCommand::Move(Move {
                    tag: 300,
                    tool: 0,
                    kind,
                })
            }),
        );
    for command in commands {
        let sequence = Sequence(0x4000);
        let frame = encode(&HostMessage { sequence, command }).expect("a frame");
        // Without the stuffing, the sender and the checksum.
        let mut content = Vec::new();
        let mut at = 1;
        while frame[at] != 0 {
            let end = at + usize::from(frame[at]);
            content.extend(&frame[at + 1..end]);
            at = end;
            if frame[at] != 0 {
                content.push(0);
            }
        }
        let message = &content[1..content.len() - 4];
        let send = |frames: Vec<Vec<u8>>| {
            let bytes = frames.concat();
            driven.chip().send(&bytes);
            let time = bytes.len() as u64 * 10 * MICROSECOND + 20 * MILLISECOND;
            driven.chip().run(time).expect("no violation");
            hear(&driven)
        };
        let cut = (0..message.len()).map(|length| frame_of(&message[..length]));
        assert_eq!(send(cut.collect()), []);
        // A variant that does not exist.
        assert_eq!(send(vec![frame_of(&[&message[..3], &[0x7f]].concat())]), []);
        // Numbers too long. In place of a fraction the bytes are not a number, and may complete
        // a message; then its sequence number is still wrong.
        let long = (3..message.len()).map(|at| frame_of(&[&message[..at], &[0xff; 12]].concat()));
        for answer in send(long.collect()) {
            let is_refused = matches!(
                answer,
                ControllerMessage::Reply {
                    reply: Reply::Refused(CommandError::OutOfSequence(_)),
                    ..
                }
            );
            assert!(is_refused, "{answer:?}");
        }
    }
    assert_eq!(driven.status().fault, None);
    let mut found = settings;
    driven.client.read_settings(&mut found).expect("settings");
    assert_eq!(found, settings);
}

#[test]
fn nothing_moves_without_settings() {
    let mut driven = Bench::with(Options::default(), Vec::new(), 0).connect();
    for request in [Request::Arm, Request::Home] {
        assert_eq!(driven.request(request), Err(CommandError::NoSettings));
    }
}

fn offer(driven: &mut Driven, kind: MoveKind) -> Result<(), MoveErrorKind> {
    let command = HostCommand::Move(Move {
        tag: 1,
        tool: 0,
        kind,
    });
    match driven.client.call(command).expect("an answer") {
        Reply::Taken { .. } => Ok(()),
        Reply::Refused(CommandError::Move(error)) => Err(error.kind),
        other => panic!("{other:?}"),
    }
}

#[test]
fn moves_are_checked_before_they_are_taken() {
    let mut driven = Driven::new();
    let [x, y] = bench::robot()
        .best_point()
        .expect("a point")
        .map(|x| x as f32);
    let feed = 0.2;
    let to_middle = MoveKind::Line { to: [x, y], feed };
    let nowhere = driven.request(Request::SetAngles([f32::NAN, 1.0]));
    assert_eq!(
        nowhere,
        Err(CommandError::Request(RequestError::OutsideLimits))
    );
    let stopped = MoveErrorKind::State(State::Stopped);
    assert_eq!(offer(&mut driven, to_middle), Err(stopped));
    driven.arm();
    assert_eq!(driven.request(Request::Home), Err(state(State::Armed)));
    let line = |to| MoveKind::Line { to, feed };
    assert!(offer(&mut driven, line([3.0, 0.0])).is_err());
    assert_eq!(
        offer(&mut driven, line([f32::NAN, 0.0])),
        Err(MoveErrorKind::Number)
    );
    for to in [
        [0.0, 0.02],
        [0.0, -y],
        [0.3, 0.05],
        [-0.2, 0.1],
        [x, 1.9 * y],
    ] {
        assert!(offer(&mut driven, line(to)).is_err(), "{to:?}");
    }
    let arc = |to, center| MoveKind::Arc {
        to,
        center,
        clockwise: false,
        feed,
    };
    assert!(offer(&mut driven, arc([x, y], [x, y])).is_err());
    let dwell = |duration| MoveKind::Dwell { duration };
    assert_eq!(offer(&mut driven, dwell(-1.0)), Err(MoveErrorKind::Number));
    assert_eq!(offer(&mut driven, dwell(1e9)), Err(MoveErrorKind::TooLong));
    // A joint move, a stop in it, and the rest.
    let angles = driven.status().angle;
    let joint = |by: f32, speed| MoveKind::Joint {
        to: [angles[0] + by, angles[1] - by],
        speed,
    };
    assert!(offer(&mut driven, joint(9.0, 0.5)).is_err());
    assert!(offer(&mut driven, joint(0.1, -0.5)).is_err());
    assert_eq!(offer(&mut driven, joint(0.1, 0.02)), Ok(()));
    assert_eq!(offer(&mut driven, joint(0.0, 0.02)), Ok(()));
    driven.run(60 * MILLISECOND);
    assert_eq!(driven.status().state, State::Running);
    driven.request(Request::Stop).expect("stopped");
    driven.run(10 * MILLISECOND);
    for _ in 0..50 {
        driven.run(20 * MILLISECOND);
        if driven.status().state == State::Armed {
            break;
        }
    }
    assert_eq!(driven.status().state, State::Armed);
    // Many short moves fill the queue; corners are rounded.
    let mut taken = 0;
    let [at_x, at_y] = driven.status().tool.expect("a position");
    while taken < 200 {
        let step = 0.0005 * (taken % 40) as f32;
        let to = [at_x + step, at_y + if taken % 2 == 0 { 0.001 } else { 0.0 }];
        match offer(&mut driven, line(to)) {
            Ok(()) => taken += 1,
            Err(MoveErrorKind::Full) => break,
            Err(error) => panic!("{error:?} after {taken}"),
        }
    }
    assert!(taken > 4, "{taken}");
    driven.run(50 * MILLISECOND);
    driven.request(Request::EmergencyStop).expect("stopped");
    driven.run(MILLISECOND);
    assert!(driven.is_off());
}

#[test]
fn paths_are_checked_against_reach_and_singularities() {
    let bench = Bench::with(Options::default(), Vec::new(), 0);
    let mut driven = bench.ready_with(|settings| {
        for axis in &mut settings.axes {
            axis.angle_limits = [-6.0, 6.0];
        }
        settings.motion.singularity_margin = 0.02;
    });
    driven.arm();
    let [x, y] = bench::robot()
        .best_point()
        .expect("a point")
        .map(|x| x as f32);
    let mut found = Vec::new();
    for to in [
        [3.0, 0.0],
        [x, 3.0],
        [x, -y],
        [x, 0.0],
        [x, 1.2 * y],
        [x, 1.4 * y],
        [x, 1.6 * y],
        [x + 0.1, y],
        [x - 0.1, y],
        [x + 0.15, 0.5 * y],
        [x - 0.15, 0.5 * y],
        [f32::INFINITY, y],
    ] {
        let command = MoveKind::Line { to, feed: 0.2 };
        if let Err(error) = offer(&mut driven, command) {
            found.push(error);
        } else {
            driven.request(Request::EmergencyStop).expect("stopped");
            driven.request(Request::ClearFault).expect("cleared");
            driven.arm();
        }
    }
    assert!(found.contains(&MoveErrorKind::Number), "{found:?}");
    let singular = |error: &MoveErrorKind| {
        matches!(
            error,
            MoveErrorKind::LegSingularity(_) | MoveErrorKind::ParallelSingularity
        )
    };
    assert!(found.iter().any(singular), "{found:?}");
}

#[test]
fn requests_are_refused_in_the_wrong_state() {
    let mut driven = Driven::new();
    for request in [Request::Stop, Request::Disarm, Request::ClearFault] {
        let before = driven.status();
        let _ = driven.request(request);
        assert_eq!(driven.status().state, before.state, "{request:?}");
    }
    let reply = driven
        .client
        .call(HostCommand::Snapshot)
        .expect("an answer");
    assert_eq!(reply, Reply::Snapshot(None));
    driven.request(Request::Home).expect("homing");
    driven.run(30 * MILLISECOND);
    let homing = state(State::Homing);
    for request in [Request::Arm, Request::Home, Request::SetAngles([1.0, 2.0])] {
        assert_eq!(driven.request(request), Err(homing), "{request:?}");
    }
    let save = driven
        .client
        .command(HostCommand::SaveSettings)
        .expect("an answer");
    assert_eq!(save, Err(homing));
    let apply = driven
        .client
        .command(HostCommand::ApplySettings)
        .expect("an answer");
    assert_eq!(apply, Err(homing));
    driven.request(Request::Stop).expect("stopped");
    driven.run(5 * MILLISECOND);
    assert!(driven.is_off());
    driven.arm();
    let armed = state(State::Armed);
    for request in [Request::Home, Request::SetAngles([1.0, 2.0])] {
        assert_eq!(driven.request(request), Err(armed), "{request:?}");
    }
    driven.request(Request::Disarm).expect("disarmed");
}

fn state(state: State) -> CommandError {
    CommandError::Request(RequestError::State(state))
}
