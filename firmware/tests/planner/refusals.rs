//! What the check of a move gives: where the move ends, or why it is refused and at which point.

use crate::rig::{Rig, START, settings, with};
use fivebar_firmware::planner::{LONGEST, MoveError, MoveErrorKind, Planner};
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::{Settings, ToolOutputSettings};
use fivebar_firmware::{FULL_TOOL, Move, MoveKind, TimedCurve, TimedMove};

/// A point that the tool can reach [m].
const FROM: [f32; 2] = [0.04, 0.2];

fn check_from(from: [f32; 2], settings: &Settings, kind: MoveKind) -> Result<[f32; 2], MoveError> {
    let tool = FULL_TOOL;
    Planner::new(&settings.check().unwrap()).check(from, &Move { tag: 7, tool, kind })
}

fn check(kind: MoveKind) -> Result<[f32; 2], MoveError> {
    check_from(FROM, &settings(), kind)
}

/// A line from [`FROM`] by this displacement [m].
fn line_by([x, y]: [f32; 2]) -> MoveKind {
    let to = [FROM[0] + x, FROM[1] + y];
    MoveKind::Line { to, feed: 0.1 }
}

#[test]
fn a_checked_move_ends_where_it_was_sent_and_a_dwell_where_it_began() {
    let (to, feed) = ([0.05, 0.18], 0.1);
    assert_eq!(check(MoveKind::Line { to, feed }), Ok(to));
    assert_eq!(check(MoveKind::Dwell { duration: 1.0 }), Ok(FROM));
    assert_eq!(check(line_by([0.0, 0.0])), Ok(FROM));
    let arc = MoveKind::Arc {
        to: [0.06, 0.18],
        center: [0.04, 0.18],
        clockwise: true,
        feed: 0.1,
    };
    assert_eq!(check(arc), Ok([0.06, 0.18]));
    let to = START;
    let [x, y] = check(MoveKind::Joint { to, speed: 0.1 }).unwrap();
    // The circles of links 2 and 3, 0.16 m about the ends of the cranks, meet there.
    assert!((x - 0.04322).abs() < 1e-4, "{x}");
    assert!((y - 0.20407).abs() < 1e-4, "{y}");
}

#[test]
fn a_number_that_no_speed_can_have_is_refused_without_a_point() {
    let refused = MoveError {
        tag: 7,
        kind: MoveErrorKind::Number,
        point: None,
    };
    for feed in [0.0, -0.1, f32::NAN, f32::INFINITY] {
        let to = [0.04, 0.19];
        assert_eq!(check(MoveKind::Line { to, feed }), Err(refused), "{feed}");
    }
    for speed in [0.0, -0.1, 1.01, f32::NAN] {
        let kind = MoveKind::Joint { to: START, speed };
        assert_eq!(check(kind), Err(refused), "{speed}");
    }
    let speed = 1.0;
    assert!(check(MoveKind::Joint { to: START, speed }).is_ok());
}

#[test]
fn each_violation_of_the_envelope_has_its_own_kind() {
    for (by, kind) in [
        ([0.3, 0.0], MoveErrorKind::LegSingularity(1)),
        ([-0.3, 0.0], MoveErrorKind::LegSingularity(4)),
        ([0.0, -0.3], MoveErrorKind::JointLimit(1)),
        ([0.115, -0.277], MoveErrorKind::JointLimit(4)),
    ] {
        assert_eq!(check(line_by(by)).unwrap_err().kind, kind, "{by:?}");
    }
    let heavy = with(|settings| {
        settings.payload = 0.5;
        settings.gravity = [0.0, -9.81];
    });
    for (by, joint) in [([-0.277, -0.115], 1), ([0.277, -0.115], 4)] {
        let refused = check_from(FROM, &heavy, line_by(by)).unwrap_err();
        assert_eq!(refused.kind, MoveErrorKind::Torque(joint));
        let kind = check(line_by(by)).unwrap_err().kind;
        assert_ne!(kind, MoveErrorKind::Torque(joint), "without the load");
    }
}

/// Of a joint move, the joint that turns further decides.
#[test]
fn a_move_may_take_a_day_and_no_longer() {
    assert!(check(MoveKind::Dwell { duration: LONGEST }).is_ok());
    let too_long = |result: Result<_, MoveError>| {
        result.is_err_and(|error| error.kind == MoveErrorKind::TooLong)
    };
    let duration = LONGEST + 0.01;
    assert!(too_long(check(MoveKind::Dwell { duration })));

    let joints = joints_at_from();
    let slow = with(|settings| {
        for axis in &mut settings.axes {
            axis.max_speed = 1.0;
        }
    });
    // 0.1 rad at this share of 1 rad/s.
    let share = |days: f32| 0.1 / (days * LONGEST);
    for turned in [[0.1, 0.02], [-0.1, 0.02], [0.02, 0.1], [0.02, -0.1]] {
        let to = [joints[0] + turned[0], joints[1] + turned[1]];
        let check = |speed| check_from(FROM, &slow, MoveKind::Joint { to, speed });
        assert!(check(share(0.9)).is_ok(), "{turned:?}");
        assert!(too_long(check(share(1.1))), "{turned:?}");
    }
}

/// θ1, θ4 with the tool at [`FROM`] [rad].
fn joints_at_from() -> [f32; 2] {
    let checked = settings().check().unwrap();
    let mode = settings().working_mode();
    let pose = checked.tool().inverse(FROM.into(), mode).unwrap();
    [pose.u1, pose.u4].map(|u| u.y.atan2(u.x))
}

#[test]
fn every_refused_move_reads_as_a_sentence_with_its_point() {
    let texts = [
        MoveErrorKind::State(State::Stopping),
        MoveErrorKind::Full,
        MoveErrorKind::Number,
        MoveErrorKind::Arc,
        MoveErrorKind::Unreachable,
        MoveErrorKind::JointLimit(4),
        MoveErrorKind::LegSingularity(1),
        MoveErrorKind::ParallelSingularity,
        MoveErrorKind::Torque(4),
        MoveErrorKind::TooLong,
    ]
    .map(|kind| kind.to_string());
    for (number, text) in texts.iter().enumerate() {
        assert!(text.split(' ').count() > 3, "{text}");
        assert!(!texts[..number].contains(text), "{text}");
    }
    assert_eq!(texts[5], "joint 4 would leave its limits");
    let mut error = MoveError {
        tag: 1,
        kind: MoveErrorKind::Full,
        point: None,
    };
    assert_eq!(error.to_string(), "the queue is full");
    error.point = Some([0.25, -1.5]);
    assert_eq!(
        error.to_string(),
        "the queue is full at (250.000, -1500.000) mm"
    );
}

#[test]
fn a_move_that_is_refused_for_its_numbers_leaves_tool_and_queue_as_they_were() {
    let settings = with(|s| {
        s.tool_output = ToolOutputSettings::Switch {
            active_low: false,
            down_time: 0.01,
            up_time: 0.01,
        };
    });
    let dwell = |duration| MoveKind::Dwell { duration };
    let numbers = [-1.0, -1e34, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for kind in numbers.map(dwell) {
        let mut rig = Rig::armed(&settings);
        let from = rig.tool_position();
        let next = Move {
            tag: 1,
            tool: FULL_TOOL,
            kind,
        };
        let refused = MoveErrorKind::Number;
        let checked = rig.planner.check(from, &next);
        assert_eq!(
            checked.map_err(|error| error.kind),
            Err(refused),
            "{kind:?}"
        );
        let before = rig.planner.free_slots();
        let pushed = rig.push(1, kind);
        assert_eq!(pushed.map_err(|error| error.kind), Err(refused), "{kind:?}");
        assert_eq!(rig.planner.free_slots(), before);
        assert!(rig.planner.is_empty());
        let off = settings.tool_output.off();
        assert!((0..500).all(|_| rig.tick().tool == off), "{kind:?}");
        assert_eq!(rig.controller.state(), State::Armed);
    }
    assert_eq!(check(dwell(0.0)), Ok(FROM));
}

#[test]
fn moves_one_behind_the_other_are_checked_from_where_the_one_before_ends() {
    let mut planner = Planner::new(&settings().check().unwrap());
    let line = |tag, [x, y]: [f32; 2]| Move {
        tag,
        tool: FULL_TOOL,
        kind: MoveKind::Line {
            to: [x, y],
            feed: 0.1,
        },
    };
    let there_and_back = [line(1, [0.05, 0.18]), line(2, FROM)];
    assert_eq!(planner.check_all(FROM, &there_and_back), Ok(()));
    let beyond = [
        line(1, [0.05, 0.18]),
        line(2, [0.34, 0.18]),
        line(3, [9.0, 9.0]),
    ];
    let refused = planner.check_all(FROM, &beyond).unwrap_err();
    assert_eq!(
        (refused.tag, refused.kind),
        (2, MoveErrorKind::LegSingularity(1))
    );
    // An arc of this centre begins at the end of the first line only.
    let arc = MoveKind::Arc {
        to: [0.05, 0.16],
        center: [0.05, 0.17],
        clockwise: true,
        feed: 0.1,
    };
    let arc = Move {
        kind: arc,
        ..line(2, FROM)
    };
    assert_eq!(
        planner.check_all(FROM, &[line(1, [0.05, 0.18]), arc]),
        Ok(())
    );
    assert!(planner.check_all(FROM, &[arc]).is_err());
}

/// Both cranks of this arm turn with the tool about the base, and their limits are nearly two turns apart.
#[test]
#[expect(clippy::too_many_lines, reason = "a list of cases")]
fn a_path_that_winds_a_joint_out_of_limits_wider_than_a_turn_is_refused() {
    let settings = with(|s| {
        s.lengths = [0.1, 0.16, 0.16, 0.1, 0.02];
        for axis in &mut s.axes {
            axis.angle_limits = [-6.2, 6.2];
        }
    });
    let mut planner = Planner::new(&settings.check().unwrap());
    let from = [0.01, 0.18];
    let circle = |tag, clockwise| Move {
        tag,
        tool: FULL_TOOL,
        kind: MoveKind::Arc {
            to: from,
            center: [0.01, 0.0],
            clockwise,
            feed: 0.1,
        },
    };
    let half = |tag, to, clockwise| Move {
        kind: MoveKind::Arc {
            to,
            center: [0.01, 0.0],
            clockwise,
            feed: 0.1,
        },
        ..circle(tag, clockwise)
    };
    // The circle clockwise, in pieces of less than 64 ms.
    let timed = |tag| {
        let (pieces, length) = (60_u8, core::f32::consts::TAU * 0.18);
        let piece = length / f32::from(pieces);
        let moves = (0..pieces).map(move |number| Move {
            kind: MoveKind::Timed(TimedMove {
                curve: TimedCurve::Arc {
                    start: from,
                    tangent: [1.0, 0.0],
                    curvature: -1.0 / 0.18,
                },
                law: [f32::from(number) * piece, 0.3, 0.0, 0.0],
                duration: piece / 0.3,
            }),
            ..circle(tag, true)
        });
        moves.collect::<Vec<_>>()
    };
    let turn = core::f32::consts::TAU;
    let pose = Planner::new(&settings.check().unwrap())
        .workspace()
        .tool
        .inverse(from.into(), settings.working_mode());
    let [theta1, _, _, theta4] = pose.unwrap().angles();
    // So slow that 0.05 rad take half a day, and a turn more too long.
    let joint_move = |tag, by: f32| Move {
        kind: MoveKind::Joint {
            to: [theta1 + by, theta4 + by],
            speed: 0.1 / (LONGEST * settings.axes[0].max_speed),
        },
        ..circle(tag, true)
    };
    let refused_at = |planner: &mut Planner, joints, moves: &[Move]| {
        let refused = planner.check_all_from(from, joints, moves).err()?;
        Some((refused.tag, refused.kind))
    };
    let joints = Some([theta1, theta4]);
    let before = Some([theta1 - turn, theta4 - turn]);
    let of_joint = |tag, joint| Some((tag, MoveErrorKind::JointLimit(joint)));
    let there = [0.01, -0.18];
    for (joints, moves, refused) in [
        // A turn clockwise is within the limits; the second one is not, wherever the moves part it.
        (joints, [circle(1, true), circle(2, false)], None),
        (joints, [circle(1, true), circle(2, true)], of_joint(2, 4)),
        (None, [circle(1, true), circle(2, true)], of_joint(2, 4)),
        (joints, [circle(1, false), circle(2, false)], of_joint(1, 1)),
        // The same place of the tool, a turn before.
        (before, [circle(1, false), circle(2, true)], None),
        (before, [circle(1, true), circle(2, true)], of_joint(1, 4)),
        (joints, [half(1, there, true), half(2, from, true)], None),
        (
            joints,
            [circle(1, true), half(2, there, true)],
            of_joint(2, 4),
        ),
        // A joint goes on in the turn in which the path has left it.
        (joints, [circle(1, true), joint_move(2, 0.05 - turn)], None),
        (before, [circle(1, false), joint_move(2, 0.05)], None),
    ] {
        assert_eq!(refused_at(&mut planner, joints, &moves), refused);
    }
    for (moves, refused) in [
        ([vec![circle(1, true)], timed(2)], of_joint(2, 4)),
        ([timed(1), vec![circle(2, true)]], of_joint(2, 4)),
        ([timed(1), vec![circle(2, false)]], None),
    ] {
        let found = refused_at(&mut planner, joints, &moves.concat());
        assert_eq!(found, refused);
    }
}

#[test]
fn a_checked_move_of_the_joints_keeps_their_limits_and_speeds() {
    let planner = Planner::new(&settings().check().unwrap());
    let by = |turn1: f32, turn4: f32| [START[0] + turn1, START[1] + turn4];
    assert_eq!(planner.check_joints(START, by(0.1, -0.1), 0.5), Ok(()));
    for (to, speed, kind) in [
        (by(1.5, 0.0), 0.5, MoveErrorKind::JointLimit(1)),
        (by(0.0, -1.5), 0.5, MoveErrorKind::JointLimit(4)),
        (by(0.1, -0.1), 1.5, MoveErrorKind::Number),
    ] {
        let refused = planner.check_joints(START, to, speed).unwrap_err();
        assert_eq!(refused.kind, kind);
    }
}
