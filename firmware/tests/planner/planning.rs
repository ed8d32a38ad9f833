//! A move is either followed completely, or refused with the reason and the point.

use crate::rig::{Rig, settings, with};
use fivebar_firmware::MoveKind;
use fivebar_firmware::controller::Request;
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::safety::{Limits, State};
use fivebar_kinematics::five_bar::{Side, WorkingMode};
use proptest::prelude::*;
use std::f32::consts::TAU;

/// Runs to the end of the path. Returns the greatest distance of the tool from its reference [m].
#[track_caller]
fn finish(rig: &mut Rig) -> f64 {
    let mut worst = 0.0_f64;
    for _ in 0..200_000 {
        let [tx, ty] = rig.bench.tool();
        rig.tick();
        let status = rig.controller.status();
        match (status.state, status.reference) {
            (State::Running, Some([x, y])) => {
                worst = worst.max((tx - f64::from(x)).hypot(ty - f64::from(y)));
            }
            (State::Armed, _) if rig.planner.is_empty() => return worst,
            (State::Armed, _) => {}
            _ => panic!("{:?}", rig.controller.fault()),
        }
    }
    panic!("never ends");
}

#[test]
fn a_polygon_of_many_short_lines_flows_through_the_queue() {
    let mut rig = Rig::armed(&settings());
    let [x, y] = rig.tool_position();
    let (radius, corners) = (0.02_f32, 120_u32);
    let started = rig.controller.status().tick;
    let mut corner = 1;
    while corner <= corners {
        let (sin, cos) = (TAU * corner as f32 / corners as f32).sin_cos();
        let to = [x - radius + radius * cos, y + radius * sin];
        match rig.push(corner, MoveKind::Line { to, feed: 0.1 }) {
            Ok(()) => corner += 1,
            Err(error) => {
                assert_eq!(error.kind, MoveErrorKind::Full);
                rig.tick();
                assert!(rig.controller.fault().is_none());
            }
        }
    }
    let worst = finish(&mut rig);
    assert!(worst < 3e-5, "{worst} m");
    let [tx, ty] = rig.bench.tool();
    assert!((tx - f64::from(x)).hypot(ty - f64::from(y)) < 5e-5);
    // 126 mm at 0.1 m/s: the arm rounds the corners and does not stop there.
    let taken = f64::from(rig.controller.status().tick - started) * 1e-4;
    assert!(taken < 2.0, "{taken} s");
}

/// The queue is full and holds less path than a stop needs.
#[test]
fn a_circle_of_lines_of_a_twentieth_of_a_millimetre_is_drawn_to_its_end() {
    let mut rig = Rig::armed(&settings());
    let [x, y] = rig.tool_position();
    let (radius, corners) = (0.002_f32, 250_u32);
    for corner in 1..=corners {
        let (sin, cos) = (TAU * corner as f32 / corners as f32).sin_cos();
        let to = [x - radius + radius * cos, y + radius * sin];
        while let Err(error) = rig.push(corner, MoveKind::Line { to, feed: 0.07 }) {
            assert_eq!(
                error.kind,
                MoveErrorKind::Full,
                "{:?}",
                rig.controller.fault()
            );
            rig.tick();
        }
    }
    let worst = finish(&mut rig);
    assert!(worst < 3e-5, "{worst} m");
}

/// Four segments of lines that short end at rest, or are shorter than a stop.
#[test]
fn lines_of_hundredths_of_a_millimetre_do_not_outrun_the_planner() {
    for at_once in [true, false] {
        let mut rig = Rig::armed(&settings());
        let [x, y] = rig.tool_position();
        let ends = [1e-5, 1e-4, 0.0, 8e-5, 2e-5, 3e-4, 0.0];
        for (tag, end) in (1..).zip(ends) {
            let to = [x + end, y];
            rig.push(tag, MoveKind::Line { to, feed: 0.07 }).unwrap();
            if !at_once {
                rig.tick();
            }
        }
        let worst = finish(&mut rig);
        assert!(worst < 3e-5, "{worst} m");
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 24,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Lines from a micrometre to a centimetre, at corners of any angle, handed over at once
    /// or one by one: the planner accepts each length, and the arm follows its reference.
    #[test]
    fn lines_of_any_length_follow_each_other(
        lines in prop::collection::vec(
            (-6.0..-2.0_f32, 0.0..TAU, prop_oneof![Just(0), 0..200_u32]),
            2..60,
        ),
        feed in 0.005..0.3_f32,
    ) {
        let mut rig = Rig::armed(&settings());
        let [x, y] = rig.tool_position();
        let mut place = [x, y];
        for (tag, (exponent, direction, ticks)) in (1..).zip(lines) {
            let (sin, cos) = direction.sin_cos();
            let length = 10_f32.powf(exponent);
            let to = [place[0] + length * cos, place[1] + length * sin];
            let strays = (to[0] - x).hypot(to[1] - y) > 0.02;
            place = if strays { [x, y] } else { to };
            while let Err(error) = rig.push(tag, MoveKind::Line { to: place, feed }) {
                prop_assert_eq!(error.kind, MoveErrorKind::Full, "{:?}", rig.controller.fault());
                rig.tick();
            }
            for _ in 0..ticks {
                rig.tick();
            }
        }
        let worst = finish(&mut rig);
        prop_assert!(worst < 3e-5, "{worst} m");
    }
}

/// The tick has priority: on a board it can run between any two of the planner's accesses to the
/// controller.
#[test]
fn ticks_between_the_segments_of_a_move_raise_no_fault() {
    // From rest, in the last segment of the move before, and at all times between.
    for ticks in (0..3_000).step_by(50) {
        let mut rig = Rig::armed(&settings());
        let [x, y] = rig.tool_position();
        for (tag, end) in (1..).zip([0.01, 0.0, 0.01]) {
            let to = [x - end, y];
            rig.push(tag, MoveKind::Line { to, feed: 0.1 }).unwrap();
            rig.run_interrupted(ticks);
        }
        for _ in 0..20_000 {
            rig.run_interrupted(1);
            assert_eq!(rig.controller.fault(), None, "after {ticks} ticks");
        }
        assert!(rig.planner.is_empty() && rig.controller.state() == State::Armed);
        assert!((rig.bench.tool()[0] - f64::from(x - 0.01)).abs() < 5e-5);
    }
}

/// At slow ticks the controller wants more path before it begins than a planner in time hands it out.
#[test]
fn a_move_begins_whatever_the_length_of_its_parts_and_the_rate_of_the_ticks() {
    for tick_rate in [500.0, 1e3, 2e3, 1e4] {
        for thousandths in 20..1000 {
            let mut rig = Rig::armed(&with(|settings| {
                let control = &mut settings.control;
                let slower = tick_rate / control.tick_rate;
                for rate in [
                    &mut control.bandwidth,
                    &mut control.integral_rate,
                    &mut control.observer_bandwidth,
                    &mut control.current_bandwidth,
                    &mut control.tick_rate,
                ] {
                    *rate *= slower;
                }
            }));
            let speed = thousandths as f32 * 1e-3;
            let to = [2.0, 1.0];
            rig.push(1, MoveKind::Joint { to, speed }).unwrap();
            let begun = (0..50).any(|_| {
                rig.tick();
                rig.controller.state() == State::Running
            });
            assert!(begun, "at {speed} of the speed and {tick_rate} Hz");
        }
    }
}

#[test]
fn lines_arcs_dwells_and_joint_moves_follow_each_other() {
    let mut rig = Rig::armed(&settings());
    let [x, y] = rig.tool_position();
    let home = rig.controller.status().angle;
    let moves = [
        MoveKind::Line {
            to: [x - 0.02, y],
            feed: 0.1,
        },
        MoveKind::Arc {
            to: [x, y],
            center: [x - 0.01, y],
            clockwise: true,
            feed: 0.1,
        },
        MoveKind::Dwell { duration: 0.05 },
        MoveKind::Arc {
            to: [x, y],
            center: [x, y + 0.01],
            clockwise: false,
            feed: 0.1,
        },
        MoveKind::Joint {
            to: [2.0, 1.0],
            speed: 0.1,
        },
        MoveKind::Joint {
            to: home,
            speed: 0.2,
        },
        MoveKind::Line {
            to: [x, y + 0.01],
            feed: 0.05,
        },
    ];
    for (tag, kind) in (1..).zip(moves) {
        rig.push(tag, kind).unwrap();
    }
    let worst = finish(&mut rig);
    assert!(worst < 3e-5, "{worst} m");
    let [tx, ty] = rig.bench.tool();
    assert!((tx - f64::from(x)).hypot(ty - f64::from(y + 0.01)) < 5e-5);
}

#[test]
#[expect(clippy::too_many_lines, reason = "a list of cases")]
fn a_move_that_cannot_be_done_is_refused_with_reason_and_point() {
    let mut rig = Rig::armed(&settings());
    let [x, y] = rig.tool_position();
    let error = rig
        .push(
            11,
            MoveKind::Line {
                to: [x, y + 1.0],
                feed: 0.1,
            },
        )
        .unwrap_err();
    assert_eq!(error.tag, 11);
    let [px, py] = error.point.unwrap();
    assert!((px - x).abs() < 1e-4 && py > y && py < 0.27, "({px}, {py})");
    assert!(
        matches!(
            error.kind,
            MoveErrorKind::LegSingularity(_)
                | MoveErrorKind::Unreachable
                | MoveErrorKind::JointLimit(_)
        ),
        "{error}"
    );
    let kind_of = |rig: &mut Rig, kind| rig.push(1, kind).unwrap_err().kind;
    let to = [x, y + 0.01];
    for feed in [0.0, -0.1, f32::NAN, f32::INFINITY] {
        assert_eq!(
            kind_of(&mut rig, MoveKind::Line { to, feed }),
            MoveErrorKind::Number,
            "{feed}"
        );
    }
    let to = [f32::NAN, y];
    assert_eq!(
        kind_of(&mut rig, MoveKind::Line { to, feed: 0.1 }),
        MoveErrorKind::Number
    );
    let arc = MoveKind::Arc {
        to: [x + 0.01, y],
        center: [x, y + 0.02],
        clockwise: true,
        feed: 0.1,
    };
    assert_eq!(kind_of(&mut rig, arc), MoveErrorKind::Arc);
    let joint = |to| MoveKind::Joint { to, speed: 0.1 };
    assert_eq!(
        kind_of(&mut rig, joint([4.0, 0.9])),
        MoveErrorKind::JointLimit(1)
    );
    assert_eq!(
        kind_of(&mut rig, joint([f32::NAN, 0.9])),
        MoveErrorKind::Number
    );
    for speed in [0.0, -0.1, 1.1, f32::NAN] {
        let kind = MoveKind::Joint {
            to: [2.1, 0.9],
            speed,
        };
        assert_eq!(kind_of(&mut rig, kind), MoveErrorKind::Number, "{speed}");
    }
    // These would take more than a day.
    for kind in [
        MoveKind::Line {
            to: [x, y + 0.01],
            feed: 1e-7,
        },
        MoveKind::Dwell { duration: 86_500.0 },
        MoveKind::Joint {
            to: [2.1, 0.9],
            speed: 1e-8,
        },
    ] {
        assert_eq!(kind_of(&mut rig, kind), MoveErrorKind::TooLong, "{kind:?}");
    }
    for duration in [f32::NAN, f32::INFINITY] {
        assert_eq!(
            kind_of(&mut rig, MoveKind::Dwell { duration }),
            MoveErrorKind::Number
        );
    }
    // The arm and the end of the queue have not moved.
    rig.run(100);
    assert_eq!(rig.controller.state(), State::Armed);
    rig.push(
        2,
        MoveKind::Line {
            to: [x, y + 0.01],
            feed: 0.1,
        },
    )
    .unwrap();
    finish(&mut rig);
    assert!((rig.bench.tool()[1] - f64::from(y + 0.01)).abs() < 5e-5);
}

#[test]
fn a_move_that_asks_for_too_much_speed_is_slowed_and_reported() {
    let mut rig = Rig::armed(&settings());
    let [x, y] = rig.tool_position();
    rig.push(
        1,
        MoveKind::Line {
            to: [x - 0.02, y],
            feed: 0.1,
        },
    )
    .unwrap();
    rig.push(
        2,
        MoveKind::Line {
            to: [x, y],
            feed: 5.0,
        },
    )
    .unwrap();
    let mut limited = [false; 2];
    while rig.controller.state() != State::Armed || !rig.planner.is_empty() {
        rig.tick();
        let status = rig.controller.status();
        match status.tag {
            Some(1) => limited[0] |= status.limits.contains(Limits::SPEED),
            Some(2) => limited[1] |= status.limits.contains(Limits::SPEED),
            _ => {}
        }
    }
    assert_eq!(limited, [false, true]);
}

#[test]
fn a_joint_move_through_a_straight_leg_changes_the_working_mode() {
    let mut rig = Rig::armed(&settings());
    let before = rig.controller.working_mode();
    assert_eq!(before, WorkingMode::new(Side::Right, Side::Left));
    // Joint 1 turns link 1 until the elbow of leg 1 is on the other side.
    let to = [0.65, 0.9];
    rig.push(1, MoveKind::Joint { to, speed: 0.1 }).unwrap();
    finish(&mut rig);
    let after = rig.controller.working_mode();
    assert_eq!(after, WorkingMode::new(Side::Left, Side::Left));
    // The tool is moved in the new mode.
    let [x, y] = rig.tool_position();
    rig.push(
        2,
        MoveKind::Line {
            to: [x + 0.005, y + 0.005],
            feed: 0.05,
        },
    )
    .unwrap();
    let worst = finish(&mut rig);
    assert!(worst < 3e-5, "{worst} m");
    assert_eq!(rig.controller.working_mode(), after);
}

#[test]
fn moves_are_taken_only_by_an_armed_arm() {
    let mut rig = Rig::new(&settings());
    let dwell = MoveKind::Dwell { duration: 0.1 };
    let kind_of = |rig: &mut Rig| rig.push(5, dwell).unwrap_err().kind;
    assert_eq!(kind_of(&mut rig), MoveErrorKind::State(State::Stopped));
    rig.controller.request(Request::Home).unwrap();
    assert_eq!(kind_of(&mut rig), MoveErrorKind::State(State::Homing));
}

#[test]
fn a_disarmed_arm_drops_its_queue() {
    let mut rig = Rig::armed(&settings());
    let [x, y] = rig.tool_position();
    rig.push(
        1,
        MoveKind::Line {
            to: [x - 0.05, y],
            feed: 0.1,
        },
    )
    .unwrap();
    rig.run(1000);
    rig.controller.request(Request::Disarm).unwrap();
    assert_eq!(rig.run(1).enable, [false; 2]);
    rig.run(3000);
    rig.controller.request(Request::Arm).unwrap();
    let held = rig.bench.tool();
    rig.run(3000);
    assert_eq!(rig.controller.state(), State::Armed);
    assert!((rig.bench.tool()[0] - held[0]).abs() < 1e-4);
    assert!(rig.planner.is_empty());
}
