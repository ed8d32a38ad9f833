//! Timed moves: followed as they are, or refused with the reason.

use crate::rig::{Rig, settings, with};
use fivebar_firmware::controller::{QUEUED_SEGMENTS, Request};
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::ToolOutputSettings;
use fivebar_firmware::{Move, MoveKind, TimedCurve, TimedMove};
use fivebar_kinematics::control::FrictionCompensation;
use fivebar_kinematics::trajectory::TimeLaw;
use nalgebra::Vector2;

/// Pieces of a straight motion of `length` [m] to the right, from rest to rest: the jerk is +j, −j, −j, +j.
fn pieces(rig: &Rig, length: f32, duration: f32) -> Vec<TimedMove> {
    let start = rig.tool_position();
    let t = duration / 4.0;
    let jerk = length / (2.0 * t * t * t);
    let (mut s, mut v, mut a) = (0.0, 0.0, 0.0);
    [jerk, -jerk, -jerk, jerk]
        .map(|j| {
            let piece = TimedMove {
                curve: TimedCurve::Line {
                    start,
                    tangent: [1.0, 0.0],
                },
                law: [s, v, a, j],
                duration: t,
            };
            s += t * (v + t * (a / 2.0 + t * j / 6.0));
            v += t * (a + t * j / 2.0);
            a += t * j;
            piece
        })
        .to_vec()
}

fn timed(piece: TimedMove) -> Move {
    Move {
        tag: 1,
        tool: 0,
        kind: MoveKind::Timed(piece),
    }
}

fn push(rig: &mut Rig, piece: TimedMove) -> Result<(), MoveErrorKind> {
    let pushed = rig.push(1, MoveKind::Timed(piece));
    pushed.map_err(|error| error.kind)
}

#[test]
fn a_timed_motion_is_followed_to_its_end_beyond_the_limits_of_motion() {
    let mut rig = Rig::armed(&settings());
    let [x, y] = rig.tool_position();
    // 30 mm in 0.1 s: at 0.6 m/s twice as fast as [motion] allows.
    for piece in pieces(&rig, 0.03, 0.1) {
        assert_eq!(push(&mut rig, piece), Ok(()));
    }
    let (mut fastest, mut worst) = (0.0_f32, 0.0_f64);
    let mut last = rig.tool_position();
    for _ in 0..1100 {
        let [tx, ty] = rig.bench.tool();
        rig.tick();
        let status = rig.controller.status();
        assert_eq!(status.fault, None);
        if let Some([rx, ry]) = status.reference {
            fastest = fastest.max((rx - last[0]).hypot(ry - last[1]) * 1e4);
            worst = worst.max((tx - f64::from(rx)).hypot(ty - f64::from(ry)));
            last = [rx, ry];
        }
    }
    assert_eq!(rig.controller.state(), State::Armed);
    assert!(fastest > 0.55, "{fastest} m/s");
    assert!(worst < 2e-4, "{worst} m");
    let [ex, ey] = rig.tool_position();
    assert!((ex - x - 0.03).hypot(ey - y) < 1e-5, "{ex}, {ey}");
}

#[test]
fn a_piece_that_does_not_go_on_where_the_last_one_ends_is_refused() {
    let mut rig = Rig::armed(&settings());
    let motion = pieces(&rig, 0.03, 0.1);
    assert_eq!(push(&mut rig, motion[1]), Err(MoveErrorKind::Discontinuous));
    assert_eq!(push(&mut rig, motion[0]), Ok(()));
    for (value, most) in [(0, 1e-5), (1, 0.01), (2, 2.0)] {
        let mut other = motion[1];
        other.law[value] += most;
        assert_eq!(push(&mut rig, other), Err(MoveErrorKind::Discontinuous));
    }
    for (length, taken) in [(1.0002, false), (1.00005, true)] {
        let mut other = motion[1];
        let TimedCurve::Line { tangent, .. } = &mut other.curve else {
            panic!("a line");
        };
        tangent[0] = length;
        assert_eq!(rig.planner.check([0.0; 2], &timed(other)).is_ok(), taken);
    }
    // Other moves wait until the motion has come to rest.
    let to = rig.tool_position();
    let line = rig.push(2, MoveKind::Line { to, feed: 0.1 });
    assert_eq!(line.unwrap_err().kind, MoveErrorKind::Discontinuous);
    assert_eq!(push(&mut rig, motion[1]), Ok(()));
}

#[test]
fn a_motion_beyond_a_limit_of_the_joints_is_refused() {
    let rig = &mut Rig::armed(&settings());
    for (length, duration) in [(0.03, 0.03), (0.12, 0.05)] {
        let refused = pieces(rig, length, duration)
            .into_iter()
            .map(|piece| push(rig, piece))
            .find_map(Result::err);
        assert!(
            matches!(refused, Some(MoveErrorKind::Overload(1 | 4))),
            "{refused:?}"
        );
    }
    // Out of reach.
    let mut far = pieces(rig, 0.0, 0.05)[0];
    far.law = [0.0, 6.0, 0.0, 0.0];
    far.duration = 0.06;
    let refused = push(rig, far).unwrap_err();
    assert!(
        matches!(
            refused,
            MoveErrorKind::LegSingularity(_) | MoveErrorKind::Unreachable
        ),
        "{refused:?}"
    );
}

#[test]
fn malformed_pieces_are_refused() {
    let rig = &mut Rig::armed(&settings());
    let good = pieces(rig, 0.03, 0.1)[0];
    let mut bad = [good; 5];
    bad[0].duration = 0.0;
    (bad[1].law, bad[1].duration) = ([0.0, 0.01, 0.0, 0.0], 0.2);
    bad[2].law[3] = f32::NAN;
    // Backward.
    bad[3].law[3] = -good.law[3];
    bad[4].curve = TimedCurve::Line {
        start: rig.tool_position(),
        tangent: [1.1, 0.0],
    };
    for piece in bad {
        let refused = push(rig, piece).unwrap_err();
        assert_eq!(refused, MoveErrorKind::Number, "{piece:?}");
    }
    assert_eq!(push(rig, good), Ok(()));
}

#[test]
fn a_stop_on_a_timed_motion_stays_on_its_line_and_ends_at_rest() {
    let mut rig = Rig::armed(&settings());
    let [_, y] = rig.tool_position();
    for piece in pieces(&rig, 0.05, 0.24) {
        assert_eq!(push(&mut rig, piece), Ok(()));
    }
    rig.run(1000);
    rig.controller.request(Request::Stop).unwrap();
    for _ in 0..2000 {
        rig.tick();
        let [_, ty] = rig.bench.tool();
        assert!((ty - f64::from(y)).abs() < 1e-4, "{ty}");
    }
    assert_eq!(rig.controller.state(), State::Armed);
    // What comes then begins at rest.
    let again = pieces(&rig, 0.01, 0.1);
    assert_eq!(push(&mut rig, again[0]), Ok(()));
}

/// A timed motion that a stop drops has not ended at rest, and the arm has: what follows begins there.
#[test]
fn after_a_stop_in_a_timed_motion_that_goes_on_any_move_begins_at_rest() {
    for follows_timed in [false, true] {
        let mut rig = Rig::armed(&settings());
        for piece in &pieces(&rig, 0.05, 0.24)[..2] {
            assert_eq!(push(&mut rig, *piece), Ok(()));
        }
        rig.run(300);
        rig.controller.request(Request::Stop).unwrap();
        rig.run(2000);
        assert_eq!(rig.controller.state(), State::Armed);
        let pushed = if follows_timed {
            let again = pieces(&rig, 0.01, 0.1);
            push(&mut rig, again[0])
        } else {
            let [x, y] = rig.tool_position();
            let to = [x + 0.01, y];
            let line = rig.push(2, MoveKind::Line { to, feed: 0.1 });
            line.map_err(|error| error.kind)
        };
        assert_eq!(pushed, Ok(()), "timed: {follows_timed}");
    }
}

/// Offers the piece in each tick until it is taken. Returns the ticks that this took.
fn push_when_free(rig: &mut Rig, piece: TimedMove) -> u32 {
    for ticks in 0..2000 {
        match push(rig, piece) {
            Ok(()) => return ticks,
            Err(refused) => assert_eq!(refused, MoveErrorKind::Full),
        }
        rig.tick();
    }
    panic!("never taken");
}

#[test]
fn a_timed_move_waits_for_the_moves_before_it() {
    let mut rig = Rig::armed(&settings());
    let motion = pieces(&rig, 0.03, 0.1);
    rig.push(1, MoveKind::Dwell { duration: 0.02 }).unwrap();
    assert_eq!(push(&mut rig, motion[0]), Err(MoveErrorKind::Full));
    let ticks = push_when_free(&mut rig, motion[0]);
    assert!((1..300).contains(&ticks), "{ticks} ticks");
}

#[test]
fn a_timed_motion_begins_when_the_tool_has_settled_and_keeps_its_level() {
    let mut rig = with_switch();
    let [x, _] = rig.tool_position();
    let motion = pieces(&rig, 0.03, 0.1);
    assert_eq!(push(&mut rig, motion[0]), Ok(()));
    assert_eq!(push(&mut rig, motion[1]), Ok(()));
    let up = Move {
        tag: 2,
        tool: 0,
        kind: MoveKind::Timed(motion[2]),
    };
    let refused = rig.planner.push(&mut rig.controller, &up).unwrap_err();
    assert_eq!(refused.kind, MoveErrorKind::Discontinuous);
    for piece in &motion[2..] {
        assert_eq!(push(&mut rig, *piece), Ok(()));
    }
    let moved = |rig: &Rig| (rig.controller.status().reference.expect("armed")[0] - x).abs();
    rig.run(480);
    assert!(moved(&rig) < 1e-5, "the tool settles");
    rig.run(1100);
    assert!((moved(&rig) - 0.03).abs() < 1e-5);
    assert_eq!(rig.controller.status().fault, None);
}

/// The fastest motion that is taken needs all of a joint's torque, and no more.
#[test]
fn a_timed_motion_may_use_all_of_the_torque_and_no_more() {
    let rig = Rig::armed(&settings());
    let start = rig.tool_position();
    let is_taken = |duration: f32| {
        let mut pieces = pieces(&rig, 0.03, duration).into_iter();
        pieces.all(|piece| rig.planner.check(start, &timed(piece)).is_ok())
    };
    let (mut short, mut long) = (0.01_f32, 0.2);
    for _ in 0..20 {
        let middle = 0.5 * (short + long);
        *(if is_taken(middle) {
            &mut long
        } else {
            &mut short
        }) = middle;
    }
    let settings = settings().check().unwrap();
    let (arm, tool) = (settings.arm(), settings.tool());
    let mut most = 0.0_f32;
    for piece in pieces(&rig, 0.03, long) {
        let [s, s_dot, s_ddot, jerk] = piece.law;
        let law = TimeLaw::new(s, s_dot, s_ddot, jerk);
        for step in 0..=100 {
            let now = law.at(piece.duration * step as f32 / 100.0);
            let right = |length: f32| Vector2::new(length, 0.0);
            let at = Vector2::from(start) + right(now.s);
            let pose = tool.inverse(at, settings.working_mode()).unwrap();
            let velocities = tool.inverse_velocities(&pose, right(now.s_dot)).unwrap();
            let accelerations = tool
                .inverse_accelerations(&pose, &velocities, right(now.s_ddot))
                .unwrap();
            let torque = arm
                .inverse_dynamics(&pose, &velocities, &accelerations, right(0.0))
                .unwrap();
            let [speed1, _, _, speed4] = velocities.omega;
            for (joint, speed) in [speed1, speed4].into_iter().enumerate() {
                let axis = &settings.axes[joint];
                let friction = FrictionCompensation::new(
                    axis.viscous_friction,
                    axis.coulomb_friction,
                    settings.control.friction_smoothing,
                );
                let torque = torque[joint] + friction.torque(speed);
                most = most.max(torque.abs() / settings.peak_torque()[joint]);
            }
        }
    }
    assert!((0.99..1.002).contains(&most), "{most}");
}

/// A switch that needs 50 ms.
fn with_switch() -> Rig {
    Rig::armed(&with(|settings| {
        settings.tool_output = ToolOutputSettings::Switch {
            active_low: false,
            down_time: 0.05,
            up_time: 0.05,
        };
    }))
}

/// The rest for the tool and the move itself are taken together or not at all.
#[test]
fn a_timed_move_without_room_for_the_rest_of_its_tool_leaves_no_trace() {
    let mut rig = with_switch();
    let motion = pieces(&rig, 0.03, 0.1);
    let mut still = motion[0];
    still.law = [0.0; 4];
    still.duration = 0.01;
    let up = |kind| Move {
        tag: 7,
        tool: 0,
        kind,
    };
    for _ in 0..QUEUED_SEGMENTS - 1 {
        let rest = up(MoveKind::Timed(still));
        rig.planner.push(&mut rig.controller, &rest).unwrap();
    }
    let before = rig.controller.planning_snapshot();
    assert_eq!(before.path_free, 1);
    assert_eq!(push(&mut rig, motion[0]), Err(MoveErrorKind::Full));
    let after = rig.controller.planning_snapshot();
    assert_eq!((after.path_free, rig.planner.is_empty()), (1, true));
    assert_eq!(after.path_left, before.path_left);
    // With its tool as it is, one place is enough.
    let next = up(MoveKind::Timed(motion[0]));
    assert_eq!(rig.planner.push(&mut rig.controller, &next), Ok(()));
}

/// A line waits for others that go on in its direction. A refused timed move does not end that.
#[test]
fn a_timed_move_that_comes_too_soon_leaves_the_waiting_line_as_it_is() {
    let [mut with, mut without] = [(); 2].map(|()| Rig::armed(&settings()));
    let motion = pieces(&with, 0.03, 0.1);
    let [x, y] = with.tool_position();
    for rig in [&mut with, &mut without] {
        let to = [x + 0.01, y];
        rig.push(1, MoveKind::Line { to, feed: 0.1 }).unwrap();
    }
    assert_eq!(push(&mut with, motion[0]), Err(MoveErrorKind::Full));
    for rig in [&mut with, &mut without] {
        let to = [x + 0.02, y];
        rig.push(2, MoveKind::Line { to, feed: 0.1 }).unwrap();
    }
    for _ in 0..3000 {
        with.tick();
        without.tick();
        let [ours, theirs] = [&with, &without].map(|rig| rig.controller.status());
        assert_eq!((ours.tag, ours.duty), (theirs.tag, theirs.duty));
    }
}
