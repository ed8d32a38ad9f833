//! Every kind of path and of move on the production image: what is driven to its end, and each
//! reason for which a move or a request is refused.

mod bench;

use bench::raised::{at_the_end, tool_at_start};
use bench::{Bench, Driven, arm_at, hear, robot, say, settings, tell};
use fivebar_chip::Options;
use fivebar_chip::time::MILLISECOND;
use fivebar_firmware::controller::RequestError;
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::protocol::{
    CommandError, ControllerMessage, HostCommand, Reply, Section, SectionKey, VERSION,
};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{Move, MoveKind, Request, Settings};
use fivebar_sim::drive::Drive;

/// Drives the moves to their end; the tool is then at this point.
fn drives(driven: &mut Driven, settings: &Settings, kinds: &[MoveKind], end: [f32; 2]) {
    let moves: Vec<_> = (1..)
        .zip(kinds)
        .map(|(tag, &kind)| Move { tag, tool: 0, kind })
        .collect();
    let mut drive = Drive::new(&mut driven.client, &|| false);
    let followed = drive.follow(&moves, settings, &mut |_, _| ());
    followed.expect("the moves are executed");
    let tool = driven.status().tool.expect("a position");
    for (at, end) in tool.iter().zip(end) {
        assert!((at - end).abs() < 5e-4, "{tool:?}, not {end:?}");
    }
}

#[test]
fn circles_corners_dwells_and_joint_moves_are_driven() {
    let [x, y] = robot().best_point().expect("a point").map(|x| x as f32);
    let arm = arm_at([x, y], MILLISECOND);
    let mut driven = Bench::of(arm, Options::default(), Vec::new()).ready();
    let angles = driven.arm();
    driven.request(Request::Disarm).expect("disarmed");
    let feed = 0.25;
    let line = |to| MoveKind::Line { to, feed };
    let arc = |to, center, clockwise| MoveKind::Arc {
        to,
        center,
        clockwise,
        feed,
    };
    let at = |dx: f32, dy: f32| [x + dx, y + dy];
    let mut kinds = vec![
        line(at(0.0, 0.0)),
        arc(at(0.0, 0.0), at(0.01, 0.0), true),
        arc(at(0.0, 0.0), at(0.0, -0.008), false),
        arc(at(0.02, 0.0), at(0.01, 0.0), false),
        arc(at(0.01, 0.01), at(0.01, 0.0), false),
        // A tangent, a sharp corner, a reversal, nowhere.
        line(at(0.0, 0.01)),
        line(at(0.0, -0.01)),
        line(at(0.0, 0.01)),
        line(at(0.0, 0.01)),
        MoveKind::Dwell { duration: 0.015 },
        MoveKind::Dwell { duration: 0.0 },
        arc(at(-0.01, 0.0), at(-0.01, 0.01), true),
    ];
    // Short moves at growing speeds, with corners of all angles.
    for number in 0..24_u8 {
        let turn = 0.7 * f32::from(number);
        let length = 0.0004 * f32::from(number);
        let feed = 0.01 * f32::from(1 + number);
        let to = at(-0.01 + length * turn.cos(), length * turn.sin());
        kinds.push(MoveKind::Line { to, feed });
    }
    let joint = |by: f32, speed| MoveKind::Joint {
        to: [angles[0] + by, angles[1] + by],
        speed,
    };
    // Faster than the arm may go.
    for by in [0.03, -0.03] {
        kinds.push(MoveKind::Line {
            to: at(by, 0.0),
            feed: 9.0,
        });
        kinds.push(MoveKind::Arc {
            to: at(0.0, 0.0),
            center: at(0.5 * by, 0.0),
            clockwise: by > 0.0,
            feed: 9.0,
        });
    }
    kinds.extend([
        joint(0.05, 0.03),
        joint(-0.05, 0.05),
        joint(0.0, 1.0),
        line(at(0.0, 0.0)),
    ]);
    drives(&mut driven, &settings(), &kinds, [x, y]);
    assert_eq!(driven.status().fault, None);
}

#[test]
fn an_arm_with_independent_joints_and_a_tool_beside_its_end_is_driven() {
    let change = |settings: &mut Settings| {
        settings.control.computed_torque = false;
        settings.protection.following_error = 0.2;
        settings.tool_offset = [0.02, -0.01];
    };
    let mut driven = at_the_end(Options::default()).ready_with(change);
    driven.arm();
    let [x, y] = driven.status().tool.expect("a position");
    driven.request(Request::Disarm).expect("disarmed");
    let to = [x - 0.02, y - 0.005];
    let line = MoveKind::Line { to, feed: 0.1 };
    let arc = MoveKind::Arc {
        to,
        center: [x - 0.02, y],
        clockwise: false,
        feed: 0.1,
    };
    let mut changed = settings();
    change(&mut changed);
    drives(&mut driven, &changed, &[line, arc], to);
}

fn refuses(driven: &mut Driven, kind: MoveKind) -> MoveErrorKind {
    let reply = driven
        .client
        .call(HostCommand::Move(Move {
            tag: 9,
            tool: 0,
            kind,
        }))
        .expect("an answer");
    match reply {
        Reply::Refused(CommandError::Move(error)) => {
            assert_eq!(error.tag, 9);
            error.kind
        }
        other => panic!("{kind:?}: {other:?}"),
    }
}

#[test]
fn each_reason_to_refuse_a_move() {
    let mut driven = at_the_end(Options::default()).ready();
    let [x, y] = tool_at_start();
    let line = |to, feed| MoveKind::Line { to, feed };
    let stopped = refuses(&mut driven, line([x, y], 0.1));
    assert_eq!(stopped, MoveErrorKind::State(State::Stopped));
    let angles = driven.arm();
    let arc = |to, center| MoveKind::Arc {
        to,
        center,
        clockwise: true,
        feed: 0.1,
    };
    let joint = |to, speed| MoveKind::Joint { to, speed };
    let dwell = |duration| MoveKind::Dwell { duration };
    for (kind, error) in [
        (line([x, 0.1], 0.0), MoveErrorKind::Number),
        (line([x, 0.1], f32::NAN), MoveErrorKind::Number),
        (line([x, f32::INFINITY], 0.1), MoveErrorKind::Number),
        (line([x, y - 0.01], 1e-9), MoveErrorKind::TooLong),
        (arc([x - 0.02, y], [x, y]), MoveErrorKind::Arc),
        (arc([x - 0.02, y], [x - 0.015, y]), MoveErrorKind::Arc),
        (arc([x - 0.02, y], [f32::NAN, y]), MoveErrorKind::Number),
        (joint(angles, 0.0), MoveErrorKind::Number),
        (joint(angles, 1.5), MoveErrorKind::Number),
        (joint([9.0, angles[1]], 0.5), MoveErrorKind::JointLimit(1)),
        (joint([angles[0], 9.0], 0.5), MoveErrorKind::JointLimit(4)),
        (joint([f32::NAN, 1.0], 0.5), MoveErrorKind::Number),
        (
            joint([1.160, 1.982], 0.5),
            MoveErrorKind::ParallelSingularity,
        ),
        (dwell(f32::NAN), MoveErrorKind::Number),
        (dwell(86_401.0), MoveErrorKind::TooLong),
        (line([0.05, 0.50], 0.1), MoveErrorKind::LegSingularity(1)),
    ] {
        let found = refuses(&mut driven, kind);
        assert_eq!(found, error, "{kind:?}");
    }
    // Circles too large for the arm, from all sides.
    for radius in [0.05, 0.2, -0.05, -0.2] {
        for center in [[x + radius, y], [x, y + radius]] {
            let kind = arc([x, y], center);
            let call = HostCommand::Move(Move {
                tag: 1,
                tool: 0,
                kind,
            });
            let reply = driven.client.call(call).expect("an answer");
            let is_refused = matches!(reply, Reply::Refused(CommandError::Move(_)));
            assert!(is_refused, "{center:?}: {reply:?}");
        }
    }
    assert_eq!(driven.status().fault, None);
}

#[test]
fn a_load_too_heavy_for_the_motors_is_refused() {
    let mut driven = at_the_end(Options::default()).ready_with(|settings| {
        settings.gravity = [0.0, -9.81];
        settings.payload = 0.12;
    });
    driven.arm();
    let [_, y] = tool_at_start();
    let mut found = Vec::new();
    for end in [[0.15, y], [0.2, 0.1], [-0.1, 0.1], [0.2, 0.05]] {
        let kind = MoveKind::Line { to: end, feed: 0.1 };
        let call = HostCommand::Move(Move {
            tag: 1,
            tool: 0,
            kind,
        });
        if let Reply::Refused(CommandError::Move(error)) =
            driven.client.call(call).expect("an answer")
        {
            found.push(error.kind);
        }
    }
    assert!(!found.is_empty());
    assert_eq!(driven.status().fault, None);
}

#[test]
fn each_reason_to_refuse_a_request() {
    let mut driven = at_the_end(Options::default()).ready();
    let refused = |error| Err(CommandError::Request(error));
    assert_eq!(
        driven.request(Request::Arm),
        refused(RequestError::NotHomed)
    );
    for (angles, error) in [
        ([0.5, 0.9], RequestError::OutsideLimits),
        ([f32::INFINITY, 0.9], RequestError::OutsideLimits),
        // B meets D.
        ([1.160, 1.982], RequestError::NearSingularity),
    ] {
        let found = driven.request(Request::SetAngles(angles));
        assert_eq!(found, refused(error), "{angles:?}");
    }
    driven.arm();
    let [x, y] = tool_at_start();
    let kind = MoveKind::Line {
        to: [x - 0.06, y],
        feed: 0.1,
    };
    let call = HostCommand::Move(Move {
        tag: 1,
        tool: 0,
        kind,
    });
    let taken = driven.client.call(call).expect("an answer");
    assert!(matches!(taken, Reply::Taken { .. }), "{taken:?}");
    // The host is silent: the arm is held, and the fault cannot be cleared while it moves.
    driven.run(110 * MILLISECOND);
    assert_eq!(driven.status().fault, Some(Fault::CommandTimeout));
    let moving = driven.request(Request::ClearFault);
    assert_eq!(moving, refused(RequestError::Moving));
    driven.run(200 * MILLISECOND);
    driven.request(Request::ClearFault).expect("cleared");
}

#[test]
fn sections_telemetry_and_an_emergency_stop_without_a_session() {
    let driven = at_the_end(Options::default()).ready();
    driven.chip().reset(fivebar_chip::ResetCause::Power);
    driven.chip().run(100 * MILLISECOND).expect("no violation");
    let stop = HostCommand::Request(Request::EmergencyStop);
    assert_eq!(
        say(&driven, 900, stop),
        [Reply::Refused(CommandError::NoSession)]
    );
    let hello = HostCommand::Hello {
        version: VERSION,
        session: 77,
    };
    assert!(matches!(say(&driven, 1, hello)[..], [Reply::Hello(_)]));
    let status = say(&driven, 2, HostCommand::Status);
    let [Reply::Status { status, .. }] = status[..] else {
        panic!("{status:?}");
    };
    assert_eq!(status.fault, Some(Fault::EmergencyStop));
    let none = [Reply::Refused(CommandError::NoSection)];
    let [link, axis] = [SectionKey::Link(4), SectionKey::Axis(2)];
    assert_eq!(say(&driven, 3, HostCommand::GetSection(link)), none);
    assert_eq!(say(&driven, 4, HostCommand::GetSection(axis)), none);
    let settings = settings();
    let link = Section::Link(9, settings.links[0]);
    let axis = Section::Axis(9, settings.axes[0]);
    assert_eq!(say(&driven, 5, HostCommand::SetSection(link)), none);
    assert_eq!(say(&driven, 6, HostCommand::SetSection(axis)), none);
    // A sample every 50 ticks, of 2 ms each; then none.
    tell(&driven, 7, HostCommand::Telemetry { every: 50 });
    driven.chip().run(500 * MILLISECOND).expect("no violation");
    let samples = hear(&driven).into_iter();
    let samples = samples
        .filter(|message| matches!(message, ControllerMessage::Telemetry(_)))
        .count();
    assert!((100..108).contains(&samples), "{samples}");
    tell(&driven, 8, HostCommand::Telemetry { every: 0 });
    hear(&driven);
    driven.chip().run(50 * MILLISECOND).expect("no violation");
    assert_eq!(hear(&driven), []);
}
