//! Paths of many short lines: the look-ahead sees far enough, and the tool stays near the lines.

use crate::rig::{Rig, with};
use fivebar_firmware::controller::Request;
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::safety::State;
use fivebar_firmware::{MoveKind, Settings};
use proptest::prelude::*;

/// Draws lines from the tool's position on. Returns the points of the reference in each tick [m].
fn draw(settings: &Settings, offsets: &[[f32; 2]], feed: f32) -> (Vec<[f64; 2]>, [f32; 2]) {
    let mut rig = Rig::armed(settings);
    let start = rig.tool_position();
    let mut points = Vec::new();
    let mut next = 0;
    while next < offsets.len() || rig.controller.state() != State::Armed || !rig.planner.is_empty()
    {
        // A host gives some lines in each millisecond.
        if points.len() % 10 == 0 {
            for _ in 0..10 {
                let Some([x, y]) = offsets.get(next) else {
                    break;
                };
                let to = [start[0] + x, start[1] + y];
                match rig.push(next as u32, MoveKind::Line { to, feed }) {
                    Ok(()) => next += 1,
                    Err(error) => {
                        assert_eq!(error.kind, MoveErrorKind::Full);
                        break;
                    }
                }
            }
        }
        rig.tick();
        let status = rig.controller.status();
        assert_eq!(status.fault, None);
        points.push(status.reference.expect("armed").map(f64::from));
        assert!(points.len() < 200_000, "never ends");
    }
    (points, start)
}

/// 0.1 mm lines along an arc: at 0.3 m/s there are 3000 in a second, and a stop takes 15 mm.
#[test]
fn lines_of_a_tenth_of_a_millimetre_are_drawn_at_full_speed() {
    let settings = with(|settings| {
        settings.motion.max_speed = 0.3;
        settings.motion.max_acceleration = 4.0;
        settings.motion.max_jerk = 1000.0;
        settings.motion.corner_tolerance = 5e-5;
    });
    let (radius, lines) = (0.08_f32, 700_u16);
    let offsets: Vec<_> = (1..=lines)
        .map(|line| {
            let (sin, cos) = (f32::from(line) * 1e-4 / radius).sin_cos();
            [-radius * sin, radius * (cos - 1.0)]
        })
        .collect();
    let (points, start) = draw(&settings, &offsets, 0.3);
    let moving = points.windows(2).filter(|pair| pair[0] != pair[1]).count();
    // 70 mm at 0.3 m/s, and 0.3/4 s + 4/1000 s for the beginning and the end.
    let time = moving as f64 * 1e-4;
    let ideal = 0.07 / 0.3 + 0.079;
    let [cx, cy] = [f64::from(start[0]), f64::from(start[1] - radius)];
    for [x, y] in &points {
        let off = ((x - cx).hypot(y - cy) - f64::from(radius)).abs();
        assert!(off < 5e-5, "{off} m off the arc");
    }
    let fastest = points
        .windows(2)
        .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]) * 1e4)
        .fold(0.0, f64::max);
    assert!(fastest > 0.295, "{fastest} m/s");
    // It begins while the queue fills, which costs a tenth of a second or two.
    assert!(time < ideal + 0.15, "{time} s for {ideal} s");
}

/// Half-millimetre lines that bend too much to be joined, and too little to slow the tool: what slows it is
/// that the motion must be able to end at rest within the look-ahead. With 39 planned segments it took 1.08 s.
#[test]
fn lines_of_half_a_millimetre_are_passed_as_fast_as_the_look_ahead_sees() {
    let settings = with(|settings| {
        settings.motion.max_speed = 0.3;
        settings.motion.max_acceleration = 4.0;
        settings.motion.max_jerk = 1000.0;
        settings.motion.corner_tolerance = 2e-6;
    });
    let (mut at, mut direction) = ([0.0_f32; 2], 0.0_f32);
    let offsets: Vec<_> = (0..140)
        .map(|_| {
            direction += 0.02;
            let [x, y] = at;
            at = [x - 5e-4 * direction.sin(), y + 5e-4 * direction.cos()];
            at
        })
        .collect();
    let (points, _) = draw(&settings, &offsets, 0.3);
    let moving = points.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let time = moving as f64 * 1e-4;
    println!("{time} s");
    assert!(time < 0.9, "{time} s");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Also where lines are joined: the distance to the lines as they were asked for, and that of
    /// their points to the motion.
    #[test]
    fn the_tool_stays_within_the_tolerance_of_the_lines_as_asked(
        steps in prop::collection::vec((-1.0..1.0_f32, -4.0..-2.7_f32, 1..12_u8), 2..14),
    ) {
        let tolerance = 5e-5;
        let settings = with(|settings| settings.motion.corner_tolerance = tolerance);
        let mut offsets = Vec::new();
        let (mut at, mut direction) = ([0.0_f32; 2], 0.0_f32);
        for (turn, exponent, count) in steps {
            // A sharp corner, then lines that bend a little.
            direction += turn;
            for _ in 0..count {
                direction += 0.02 * turn;
                let length = 10_f32.powf(exponent);
                at = [at[0] + length * direction.cos(), at[1] + length * direction.sin()];
                offsets.push(at);
            }
        }
        // The arm reaches all of it.
        prop_assume!(offsets.iter().all(|[x, y]| x.hypot(*y) < 0.05));
        let (points, [x, y]) = draw(&settings, &offsets, 0.1);
        let lines: Vec<[f64; 2]> = std::iter::once([0.0; 2])
            .chain(offsets)
            .map(|[dx, dy]| [f64::from(x + dx), f64::from(y + dy)])
            .collect();
        // The status gives positions in single precision.
        let bound = f64::from(tolerance) + 1e-7;
        let mut greatest = 0.0_f64;
        for &point in &points {
            let near = lines.windows(2).map(|ends| distance(point, ends[0], ends[1]));
            greatest = greatest.max(near.fold(f64::MAX, f64::min));
        }
        prop_assert!(greatest <= bound, "{greatest} m off the lines");
        for &corner in &lines {
            let near = points.windows(2).map(|ends| distance(corner, ends[0], ends[1]));
            let missed = near.fold(f64::MAX, f64::min);
            prop_assert!(missed <= bound, "{missed} m from a corner");
        }
    }
}

/// A line that waited for the next one until few are left would be seen too late.
#[test]
fn a_line_at_the_end_of_a_path_is_planned_long_before_the_arm_comes_there() {
    let settings = with(|settings| {
        settings.motion.max_speed = 0.2;
        settings.motion.max_acceleration = 2.0;
    });
    // A polygon whose sides are too unlike to be joined, and a long line that goes on from it.
    let (mut at, mut direction) = ([0.0_f32; 2], 0.0_f32);
    let mut offsets = Vec::new();
    for side in 0..31_u8 {
        let length = if side == 30 { 0.03 } else { 4e-4 };
        at = [
            at[0] + length * direction.cos(),
            at[1] + length * direction.sin(),
        ];
        direction += 0.05;
        offsets.push(at);
    }
    let (points, _) = draw(&settings, &offsets, 0.2);
    let speeds: Vec<_> = points
        .windows(2)
        .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]) * 1e4)
        .collect();
    let moving = speeds.iter().filter(|speed| **speed > 0.0).count();
    // With the line seen when few others are left it takes 0.68 s.
    assert!(moving < 6500, "{moving} ticks");
}

/// Lines to and fro on one straight line: one line in place of two would leave out the turn.
#[test]
fn a_line_that_turns_back_is_not_joined_with_the_one_before() {
    let settings = with(|_| {});
    for ends in [[4e-3, 1e-3], [4e-3, -4e-3], [-2e-3, 3e-3]] {
        let offsets = ends.map(|x| [x, 0.0]);
        let (points, [x, _]) = draw(&settings, &offsets, 0.05);
        for end in ends {
            let end = f64::from(x + end);
            let missed = points.iter().map(|point| (point[0] - end).abs());
            let missed = missed.fold(f64::MAX, f64::min);
            assert!(missed < 1e-4, "{ends:?}: {missed} m from an end");
        }
    }
}

/// From a point to the line between two others [m].
fn distance([x, y]: [f64; 2], [ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> f64 {
    let (dx, dy) = (bx - ax, by - ay);
    let square = dx * dx + dy * dy;
    let share = if square > 0.0 {
        (((x - ax) * dx + (y - ay) * dy) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (x - ax - share * dx).hypot(y - ay - share * dy)
}

/// A joined line uses a share of the corner tolerance, and the corners of lines beside it have the rest. A corner of
/// two arcs has all of it.
#[test]
fn a_corner_of_arcs_behind_joined_lines_has_the_whole_tolerance() {
    let tolerance = 3e-4_f32;
    let settings = with(|settings| settings.motion.corner_tolerance = tolerance);
    // The distance [m] of the motion from the corner of two half circles behind a line that is bent by this [m].
    let cut = |bend: f32| {
        let mut rig = Rig::armed(&settings);
        let [x, y] = rig.tool_position();
        let corner = [x - 0.01, y + 0.01];
        let arc = |to, center, clockwise| MoveKind::Arc {
            to,
            center,
            clockwise,
            feed: 0.1,
        };
        let line = |to| MoveKind::Line { to, feed: 0.1 };
        for kind in [
            line([x - 0.005, y + bend]),
            line([x - 0.01, y]),
            arc(corner, [x - 0.01, y + 0.005], false),
            arc([x - 0.02, y + 0.01], [x - 0.015, y + 0.01], false),
        ] {
            rig.push(1, kind).unwrap();
        }
        let mut nearest = f32::MAX;
        while rig.controller.state() != State::Armed || !rig.planner.is_empty() {
            rig.tick();
            let status = rig.controller.status();
            assert_eq!(status.fault, None);
            let [rx, ry] = status.reference.expect("armed");
            nearest = nearest.min((rx - corner[0]).hypot(ry - corner[1]));
        }
        nearest
    };
    let [straight, bent] = [0.0, 0.19 * tolerance].map(cut);
    assert!(straight > 0.5 * tolerance, "{straight} m");
    assert!(
        (bent - straight).abs() < 0.03 * straight,
        "{bent} m, not {straight} m"
    );
}

/// The latest line waits for one that goes on. What drops the path drops it, too.
#[test]
fn an_arm_that_is_disarmed_and_armed_again_does_not_draw_the_line_that_waited() {
    let mut rig = Rig::armed(&with(|_| {}));
    let start = rig.tool_position();
    let [x, y] = start;
    let to = [x + 0.01, y + 0.01];
    rig.push(1, MoveKind::Line { to, feed: 0.1 }).unwrap();
    // The planner does not run in between, so it learns of it by the path's generation alone.
    rig.controller.request(Request::Disarm).unwrap();
    rig.tick_alone();
    rig.controller.request(Request::Arm).unwrap();
    rig.run(2000);
    assert_eq!(rig.controller.state(), State::Armed);
    assert!(rig.planner.is_empty());
    let [ex, ey] = rig.tool_position();
    assert!(
        (ex - x).hypot(ey - y) < 1e-4,
        "[{ex}, {ey}] m, not {start:?}"
    );
}
