use super::{PathQueue, RAPID, Shares, divided, way_back};
use fivebar_firmware::{FULL_TOOL, Move, MoveKind, TimedCurve, TimedMove};

fn line(to: [f32; 2]) -> Move {
    let kind = MoveKind::Line { to, feed: 10.0 };
    Move {
        tag: 0,
        tool: 7,
        kind,
    }
}

fn arc(to: [f32; 2], center: [f32; 2]) -> Move {
    let kind = MoveKind::Arc {
        to,
        center,
        clockwise: false,
        feed: 10.0,
    };
    Move {
        tag: 0,
        tool: 7,
        kind,
    }
}

fn rest(queue: &mut PathQueue) -> Vec<MoveKind> {
    let mut kinds = Vec::new();
    while let Some(next) = queue.next() {
        assert_eq!(next.tool, 7);
        kinds.push(next.kind);
        queue.accept();
    }
    kinds
}

#[test]
fn after_a_stop_the_rest_of_the_path_waits_from_its_place() {
    let moves = [line([0.1, 0.0]), line([0.1, 0.1]), line([0.0, 0.1])];
    let mut queue = PathQueue::default();
    queue.push(&moves);
    queue.accept();
    queue.accept();
    queue.progress(2);
    let place = [0.1, 0.04];
    queue.resume_from(place, way_back([0.1, 0.05], place, 0.3));
    assert!(!queue.is_accepted());
    // Back to where the stop began, with the tool up.
    let back = queue.next().unwrap();
    let (to, feed) = ([0.1, 0.04], 0.3);
    assert_eq!((back.tool, back.kind), (0, MoveKind::Line { to, feed }));
    queue.accept();
    assert_eq!(rest(&mut queue), [moves[1].kind, moves[2].kind]);
}

#[test]
fn a_move_that_was_done_when_the_arm_came_to_rest_is_not_repeated() {
    let moves = [line([0.1, 0.0]), line([0.1, 0.1])];
    let mut queue = PathQueue::default();
    queue.push(&moves);
    queue.accept();
    let place = [0.1, 0.0];
    queue.resume_from(place, way_back(place, place, 0.3));
    assert_eq!(rest(&mut queue), [moves[1].kind]);
}

#[test]
fn a_full_circle_is_two_half_circles_and_goes_on_from_its_place() {
    let circle = arc([0.1, 0.0], [0.0, 0.0]);
    let halves = divided(Some([0.1, 0.0]), &[circle]);
    let [MoveKind::Arc { to, .. }, MoveKind::Arc { to: end, .. }] =
        [halves[0].kind, halves[1].kind]
    else {
        panic!("{halves:?}");
    };
    assert!((to[0] + 0.1).abs() < 1e-7 && to[1].abs() < 1e-7, "{to:?}");
    assert_eq!(end, [0.1, 0.0]);
    let mut queue = PathQueue::default();
    queue.push(&halves);
    queue.accept();
    queue.accept();
    queue.progress(2);
    // Beside the arc, where a corner was rounded: a short line leads back to it.
    queue.resume_from([0.0, -0.1001], None);
    let kinds = rest(&mut queue);
    let MoveKind::Line { to, .. } = kinds[0] else {
        panic!("{kinds:?}");
    };
    assert!(to[0].abs() < 1e-7 && (to[1] + 0.1).abs() < 1e-7, "{to:?}");
    assert_eq!(kinds[1..], [halves[1].kind]);
}

#[test]
fn the_share_of_the_feed_applies_to_moves_that_wait_and_keeps_their_tags() {
    let mut queue = PathQueue::default();
    queue.push(&[
        Move {
            tag: 9,
            ..line([0.1, 0.0])
        },
        line([0.1, 0.1]),
    ]);
    queue.accept();
    queue.set_shares(Shares {
        feed: 0.5,
        ..Shares::WHOLE
    });
    let to = [0.1, 0.1];
    assert_eq!(queue.next().unwrap().kind, MoveKind::Line { to, feed: 5.0 });
    assert_eq!(queue.present(), Some(9));
    queue.set_shares(Shares {
        feed: 7.0,
        rapid: 3.0,
        power: 0.0,
    });
    let limited = Shares {
        feed: 2.0,
        rapid: 1.0,
        power: 0.1,
    };
    assert_eq!(queue.shares(), limited);
    queue.resume_from([0.05, 0.0], None);
    assert_eq!((queue.present(), queue.next().unwrap().tag), (Some(9), 3));
}

#[test]
fn a_timed_motion_keeps_its_share_of_the_speed_until_it_begins_at_rest() {
    let timed = |law| {
        let curve = TimedCurve::Line {
            start: [0.0; 2],
            tangent: [1.0, 0.0],
        };
        let duration = 0.004;
        let kind = MoveKind::Timed(TimedMove {
            curve,
            law,
            duration,
        });
        Move {
            kind,
            ..line([0.0; 2])
        }
    };
    let mut queue = PathQueue::default();
    let rest = timed([0.0, 0.0, 8.0, 0.0]);
    queue.push(&[rest, timed([0.0, 1.0, 8.0, 16.0]), rest]);
    queue.accept();
    queue.set_shares(Shares {
        feed: 0.5,
        ..Shares::WHOLE
    });
    let mut given = || {
        let Some(MoveKind::Timed(timed)) = queue.next().map(|next| next.kind) else {
            panic!("a timed move");
        };
        queue.accept();
        (timed.law, timed.duration)
    };
    assert_eq!(given(), ([0.0, 1.0, 8.0, 16.0], 0.004));
    assert_eq!(given(), ([0.0, 0.0, 2.0, 0.0], 0.008));
}

#[test]
fn rapid_moves_and_the_tools_power_have_shares_of_their_own() {
    let rapid = Move {
        tag: RAPID,
        tool: 0,
        ..line([0.1, 0.0])
    };
    let stroke = Move {
        tool: 40_000,
        ..line([0.1, 0.1])
    };
    let mut queue = PathQueue::default();
    queue.push(&[rapid, stroke]);
    queue.set_shares(Shares {
        feed: 0.5,
        rapid: 0.25,
        power: 1.2,
    });
    let to = [0.1, 0.0];
    assert_eq!(queue.next().unwrap().kind, MoveKind::Line { to, feed: 2.5 });
    queue.accept();
    let next = queue.next().unwrap();
    let to = [0.1, 0.1];
    assert_eq!(next.kind, MoveKind::Line { to, feed: 5.0 });
    assert_eq!(next.tool, 48_000);
    queue.set_shares(Shares {
        power: 2.0,
        ..Shares::WHOLE
    });
    assert_eq!(queue.next().unwrap().tool, FULL_TOOL);
}

#[test]
fn the_slowest_moves_are_divided_into_few_pieces() {
    for feed in [1e-6, 1e-30] {
        let to = [0.1, 0.0];
        let slow = Move {
            kind: MoveKind::Line { to, feed },
            ..line(to)
        };
        assert_eq!(divided(Some([0.0; 2]), &[slow]).len(), 1000);
    }
}
