//! Timed moves on the production image: motions along each curve, and each reason for which a piece
//! is refused.

mod bench;

use bench::{Bench, arm_at, robot, settings};
use fivebar_chip::Options;
use fivebar_chip::time::MILLISECOND;
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::protocol::{CommandError, HostCommand, Reply};
use fivebar_firmware::{Move, MoveKind, Request, TimedCurve, TimedMove};
use fivebar_sim::drive::Drive;

/// Pieces of a motion of `length` [m] along a curve, from rest to rest: the jerk is +j, −j, −j, +j.
fn pieces(curve: TimedCurve, length: f32, duration: f32) -> [MoveKind; 4] {
    let t = duration / 4.0;
    let jerk = length / (2.0 * t * t * t);
    let (mut s, mut v, mut a) = (0.0, 0.0, 0.0);
    [jerk, -jerk, -jerk, jerk].map(|j| {
        let law = [s, v, a, j];
        s += t * (v + t * (a / 2.0 + t * j / 6.0));
        v += t * (a + t * j / 2.0);
        a += t * j;
        MoveKind::Timed(TimedMove {
            curve,
            law,
            duration: t,
        })
    })
}

#[test]
fn timed_motions_are_driven_and_pieces_beyond_a_limit_are_refused() {
    let [x, y] = robot().best_point().expect("a point").map(|x| x as f32);
    let mut driven = Bench::of(arm_at([x, y], MILLISECOND), Options::default(), Vec::new()).ready();
    driven.arm();
    let line = |start, tangent| TimedCurve::Line { start, tangent };
    let [right, left] = [[1.0, 0.0], [-1.0, 0.0]];
    let to_and_fro = [
        pieces(line([x, y], right), 0.02, 0.2),
        pieces(line([x + 0.02, y], left), 0.02, 0.2),
    ];
    let mut refused = |kind| {
        let next = Move {
            tag: 1,
            tool: 0,
            kind,
        };
        match driven.client.call(HostCommand::Move(next)) {
            Ok(Reply::Refused(CommandError::Move(error))) => Some(error.kind),
            reply => panic!("{reply:?}"),
        }
    };
    let [[_, second, ..], _] = to_and_fro;
    assert_eq!(refused(second), Some(MoveErrorKind::Discontinuous));
    for (length, duration) in [(0.02, 0.02), (1.0, 1.0), (f32::NAN, 0.1)] {
        let [first, ..] = pieces(line([x, y], right), length, duration);
        assert!(refused(first).is_some());
    }
    driven.request(Request::Disarm).expect("disarmed");

    // A quarter of a turn to the left with a radius of 10 mm, and a straight line given as a blend.
    let circle = TimedCurve::Arc {
        start: [x, y],
        tangent: right,
        curvature: 100.0,
    };
    let mut coefficients = [[0.0; 2]; 6];
    coefficients[..2].copy_from_slice(&[[x + 0.01, y + 0.01], [0.01, 0.0]]);
    let blend = TimedCurve::Blend {
        coefficients,
        inverse_length: 100.0,
    };
    let [to, fro] = to_and_fro;
    let turn = pieces(circle, 0.005 * core::f32::consts::PI, 0.2);
    let kinds = [to, fro, turn, pieces(blend, 0.01, 0.2)].concat();
    // Armed anew, the arm may be some counts away.
    let start = MoveKind::Line {
        to: [x, y],
        feed: 0.01,
    };
    let moves: Vec<_> = (1..)
        .zip([start].into_iter().chain(kinds))
        .map(|(tag, kind)| Move { tag, tool: 0, kind })
        .collect();
    let mut drive = Drive::new(&mut driven.client, &|| false);
    let followed = drive.follow(&moves, &settings(), &mut |_, _| ());
    followed.expect("the moves are executed");
    let [end_x, end_y] = driven.status().tool.expect("a position");
    assert!(
        (end_x - x - 0.02).hypot(end_y - y - 0.01) < 5e-4,
        "({end_x}, {end_y}) m"
    );
}
