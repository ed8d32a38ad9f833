//! What controller, planner and session tell each other.

use crate::desk::Desk;
use crate::rig::{Rig, START, settings};
use fivebar_firmware::controller::{Excitation, Excited, ExtraTorque, QueuedSegment, Request};
use fivebar_firmware::protocol::{
    Board, CommandError, HostCommand, Identity, Reply, Reset, Section, VERSION,
};
use fivebar_firmware::safety::{Fault, Limits, State};
use fivebar_firmware::{Move, MoveKind};
use fivebar_kinematics::trajectory::TrajectorySegment;
use nalgebra::Vector2;

#[test]
fn the_room_that_a_host_is_told_is_the_planner_s() {
    let mut desk = Desk::armed();
    for tag in 0..4 {
        match desk.ask(HostCommand::Status) {
            Reply::Status { free, .. } => {
                assert_eq!(usize::from(free), desk.planner.free_slots());
            }
            other => panic!("{other:?}"),
        }
        let kind = MoveKind::Dwell { duration: 0.5 };
        match desk.ask(HostCommand::Move(Move { tag, tool: 0, kind })) {
            Reply::Taken { free } => {
                assert!(free > 1);
                assert_eq!(usize::from(free), desk.planner.free_slots());
            }
            other => panic!("{other:?}"),
        }
    }
}

fn dwell() -> QueuedSegment {
    QueuedSegment {
        segment: TrajectorySegment::rest(Vector2::new(0.04, 0.2), 1.0, 5),
        open: false,
        limits: Limits::empty(),
        extra: ExtraTorque::ZERO,
    }
}

#[test]
fn a_segment_is_taken_in_armed_and_running_and_for_the_present_path_only() {
    let mut rig = Rig::new(&settings());
    let generation = rig.controller.planning_snapshot().path_generation;
    rig.controller.extend_path(generation, &dwell());
    assert_eq!(rig.controller.planning_snapshot().path_left, 0.0);

    let mut rig = Rig::armed(&settings());
    let generation = rig.controller.planning_snapshot().path_generation;
    rig.controller
        .extend_path(generation.wrapping_sub(1), &dwell());
    assert_eq!(rig.controller.planning_snapshot().path_left, 0.0);
    rig.controller.extend_path(generation, &dwell());
    assert_eq!(rig.controller.planning_snapshot().path_left, 1.0);

    // Disarming drops it, and with it whatever was planned to follow.
    rig.controller.request(Request::Disarm).unwrap();
    let after = rig.controller.planning_snapshot();
    assert_eq!((after.state, after.path_left), (State::Stopped, 0.0));
    assert_ne!(after.path_generation, generation);

    // With holding brakes it is dropped at once, too, and nothing follows while they engage.
    let mut braked = settings();
    braked.brake.engage_time = 0.04;
    let mut rig = Rig::armed(&braked);
    rig.run(20);
    rig.controller.request(Request::Disarm).unwrap();
    let waiting = rig.controller.planning_snapshot();
    assert_eq!(waiting.state, State::Armed);
    rig.controller
        .extend_path(waiting.path_generation, &dwell());
    assert_eq!(rig.controller.planning_snapshot().path_left, 0.0);
}

#[test]
fn the_hold_has_the_angles_of_the_arm_in_its_own_turn() {
    let rig = Rig::armed(&settings());
    let (_, joints) = rig.controller.hold_position().unwrap();
    for (joint, start) in joints.into_iter().zip(START) {
        assert!((joint - start).abs() < 1e-4, "{joint} for {start}");
    }
    // The set-point is held while the arm gives way.
    let mut rig = Rig::armed(&settings());
    rig.bench.theta[0] += 2e-3;
    rig.run(2);
    let (_, joints) = rig.controller.hold_position().unwrap();
    assert!((joints[0] - START[0]).abs() < 2e-4, "{}", joints[0]);
    // π and more: the measured turn decides.
    let mut turned = settings();
    turned.axes[0].angle_limits = [2.0, 4.5];
    let mut rig = Rig::new(&turned);
    let far = [3.3, 0.9];
    if rig.controller.request(Request::SetAngles(far)).is_ok() {
        rig.controller.request(Request::Arm).unwrap();
        let (_, joints) = rig.controller.hold_position().unwrap();
        assert!((joints[0] - far[0]).abs() < 1e-4, "{}", joints[0]);
    }
}

/// A change of this mean changes the gains of the loops that assume a constant inertia.
#[test]
fn independent_joints_have_the_mean_inertia_of_the_arm_s_poses() {
    let [inertia1, inertia4] = settings().check().unwrap().nominal_inertia();
    for inertia in [inertia1, inertia4] {
        assert!((inertia - 1.1815e-3).abs() < 2e-6, "{inertia} kg·m²");
    }
}

#[test]
fn a_session_begins_with_the_settings_in_use_whatever_the_one_before_has_drafted() {
    let mut desk = Desk::greeted();
    let in_use = *desk.controller.settings();
    let draft = HostCommand::SetSection(Section::Payload(0.123));
    assert_eq!(desk.ask(draft), Reply::Done);
    let version = VERSION;
    let hello = HostCommand::Hello {
        version,
        session: 2,
    };
    assert!(matches!(desk.ask(hello), Reply::Hello(_)));
    assert_eq!(desk.ask(HostCommand::ApplySettings), Reply::Done);
    assert_eq!(*desk.controller.settings(), in_use);
}

#[test]
fn a_board_that_gets_its_samples_from_the_host_has_none_of_its_own() {
    let refused = Reply::Refused(CommandError::Unsupported);
    assert_eq!(Desk::armed().ask(HostCommand::Sample), refused);
}

#[test]
fn a_controller_gives_the_version_of_its_library() {
    let [major, minor, patch] = Identity::new(Board::Desktop, Reset::Power).firmware;
    assert_eq!(
        format!("{major}.{minor}.{patch}"),
        env!("CARGO_PKG_VERSION")
    );
}

#[test]
fn applied_settings_are_the_planners_and_the_boards_too() {
    let mut desk = Desk::greeted();
    desk.tick();
    let mut axis = settings().axes[0];
    axis.angle_limits = [2.0, 2.4];
    desk.ask(HostCommand::SetSection(Section::Axis(0, axis)));
    assert_eq!(desk.board.used, 0);
    assert_eq!(desk.ask(HostCommand::ApplySettings), Reply::Done);
    assert_eq!(desk.board.used, 1);
    desk.tick();
    for request in [Request::SetAngles(START), Request::Arm] {
        assert_eq!(desk.ask(HostCommand::Request(request)), Reply::Done);
    }
    let to = |theta1| {
        let kind = MoveKind::Joint {
            to: [theta1, START[1]],
            speed: 0.1,
        };
        HostCommand::Move(Move {
            tag: 1,
            tool: 0,
            kind,
        })
    };
    assert!(matches!(desk.ask(to(2.5)), Reply::Refused(_)));
    assert!(matches!(desk.ask(to(2.3)), Reply::Taken { .. }));
}

#[test]
fn telemetry_goes_on_after_settings_have_set_the_ticks_to_zero() {
    let mut desk = Desk::greeted();
    assert_eq!(desk.ask(HostCommand::Telemetry { every: 10 }), Reply::Done);
    let run = |desk: &mut Desk, ticks| {
        let due = (0..ticks).filter(|_| {
            desk.tick();
            desk.session
                .telemetry(&mut desk.controller, &desk.planner)
                .is_some()
        });
        due.count()
    };
    assert_eq!(run(&mut desk, 100), 10);
    assert_eq!(desk.ask(HostCommand::ApplySettings), Reply::Done);
    assert!(
        desk.session
            .telemetry(&mut desk.controller, &desk.planner)
            .is_none()
    );
    assert_eq!(run(&mut desk, 100), 10);
}

#[test]
fn no_motor_is_excited_on_default_settings() {
    let mut desk = Desk::without_settings();
    desk.tick();
    let excite = HostCommand::Request(Request::Excite(Excitation {
        joint: 0,
        of: Excited::Voltage,
        offset: 0.5,
        amplitude: 0.0,
        hold: 1,
        ticks: 10,
        current: 1.0,
        travel: 0.1,
    }));
    let refused = Reply::Refused(CommandError::NoSettings);
    assert_eq!(desk.ask(excite), refused);
    assert_eq!(desk.controller.state(), State::Stopped);
    assert_eq!(desk.ask(HostCommand::ApplySettings), Reply::Done);
    desk.tick();
    assert_eq!(desk.ask(excite), Reply::Done);
}

#[test]
fn a_hot_motor_stays_hot_when_a_host_applies_settings() {
    let mut desk = Desk::greeted();
    // 3 A for 3 s, where 1.3 A are allowed; then the current's zero is measured.
    for tick in 0..32_500 {
        let mut sample = desk.bench.sense();
        if tick < 30_000 {
            sample.drives.current[1] += 768;
        }
        desk.controller.tick(&sample);
    }
    assert_eq!(desk.ask(HostCommand::ApplySettings), Reply::Done);
    desk.tick();
    for request in [Request::SetAngles(START), Request::Arm] {
        assert_eq!(desk.ask(HostCommand::Request(request)), Reply::Done);
    }
    for _ in 0..50 {
        desk.tick();
    }
    let status = desk.controller.status();
    assert_eq!(status.fault, Some(Fault::OverTemperature));
}
