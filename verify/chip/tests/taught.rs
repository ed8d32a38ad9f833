//! A taught motion is done again by the production image.

mod bench;

use bench::{Bench, arm_at, robot, settings};
use fivebar_chip::Options;
use fivebar_chip::time::MILLISECOND;
use fivebar_firmware::protocol::{HostCommand, Reply};
use fivebar_firmware::safety::State;
use fivebar_firmware::{Move, MoveKind, TimedCurve, TimedMove};
use fivebar_sim::drive::Drive;
use fivebar_sim::teaching::TaughtPath;

#[test]
fn a_taught_motion_is_done_again_and_ends_where_it_was_taught() {
    let [x, y] = robot().best_point().expect("a point");
    let arm = arm_at([x as f32, y as f32], MILLISECOND);
    let mut driven = Bench::of(arm, Options::default(), Vec::new()).ready();
    driven.arm();
    // Out and back along an arc, smoothly from rest to rest: 1 s.
    let knots: Vec<String> = (0..=50)
        .map(|k| {
            let u = f64::from(k) / 50.0;
            let way = 0.02 * u * u * (3.0 - 2.0 * u);
            format!("[{:.7}, {:.7}]", x - way, y + 5.0 * way * way)
        })
        .collect();
    let text = format!(
        r#"{{"taught_path": 1, "robot": "benchtop", "knot_s": 0.02, "tip_m": [{}]}}"#,
        knots.join(", ")
    );
    let path = TaughtPath::parse(&text).expect("a path");
    let mut drive = Drive::new(&mut driven.client, &|| false);
    let status = drive.fault_free_status().expect("a status");
    let planner = drive.planner(&settings()).expect("a planner");
    let tip = status.tool.expect("a position");
    let moves = path
        .replay(1.0, &planner, tip, status.angle)
        .expect("moves");
    drive
        .follow_armed(&moves, &[], &mut |_, _| (), &mut |_| Ok(true))
        .expect("the motion");
    let status = driven.status();
    assert_eq!((status.state, status.fault), (State::Armed, None));
    let [tx, ty] = status.tool.expect("a position").map(f64::from);
    let off = (tx - (x - 0.02)).hypot(ty - (y + 5.0 * 0.02 * 0.02));
    assert!(off < 2e-4, "{off} m");
}

#[test]
fn moves_that_no_arm_can_do_are_refused_and_it_stays() {
    let [x, y] = robot().best_point().expect("a point").map(|it| it as f32);
    let mut driven = Bench::of(arm_at([x, y], MILLISECOND), Options::default(), Vec::new()).ready();
    driven.arm();
    let before = driven.status().tool;
    let to = [x, y - 0.01];
    let timed = |law: [f32; 4], duration: f32| {
        let curve = TimedCurve::Line {
            start: [x, y],
            tangent: [1.0, 0.0],
        };
        MoveKind::Timed(TimedMove {
            curve,
            law,
            duration,
        })
    };
    let wrong = [
        MoveKind::Line {
            to: [9.0, 9.0],
            feed: 0.1,
        },
        MoveKind::Line { to, feed: -1.0 },
        MoveKind::Line {
            to: [f32::NAN, 0.1],
            feed: 0.1,
        },
        MoveKind::Arc {
            to,
            center: [x, y],
            clockwise: true,
            feed: 0.1,
        },
        MoveKind::Arc {
            to: [x, y],
            center: [x + 2.0, y],
            clockwise: false,
            feed: 0.1,
        },
        MoveKind::Dwell { duration: -1.0 },
        MoveKind::Dwell {
            duration: f32::INFINITY,
        },
        MoveKind::Joint {
            to: [9.0, 9.0],
            speed: 0.5,
        },
        MoveKind::Joint {
            to: [2.0, 1.0],
            speed: 2.0,
        },
        timed([0.0, 1e3, 0.0, 0.0], 0.02),
        timed([0.0, 0.0, 1e4, 0.0], 0.02),
        timed([0.0, 0.0, 0.0, 0.0], -1.0),
        timed([f32::NAN, 0.0, 0.0, 0.0], 0.02),
    ];
    for kind in wrong {
        let (tag, tool) = (1, 0);
        let reply = driven
            .client
            .call(HostCommand::Move(Move { tag, tool, kind }));
        assert!(
            matches!(reply, Ok(Reply::Refused(_))),
            "{kind:?}: {reply:?}"
        );
    }
    let status = driven.status();
    assert_eq!(
        (status.state, status.fault, status.tool),
        (State::Armed, None, before)
    );
}
