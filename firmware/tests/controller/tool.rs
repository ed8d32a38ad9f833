//! The tool's output: it changes where a move begins, and every stop and every fault switches it
//! off in the same tick.

use crate::rig::{Rig, settings, with};
use fivebar_firmware::controller::Request;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::ToolOutputSettings;
use fivebar_firmware::{FULL_TOOL, Move, MoveKind};

const SERVO: ToolOutputSettings = ToolOutputSettings::Servo {
    up_width: 1e-3,
    down_width: 1.5e-3,
    frame_rate: 50.0,
    down_time: 0.004,
    up_time: 0.003,
};
/// Shares of 65536: 5 % and 7.5 %.
const UP: u16 = 3277;
const DOWN: u16 = 4915;

/// Half the distance within which a reference counts as unmoved [m]: the rounding of `f32`.
const SAME: f32 = 1e-7;

fn armed(tool_output: ToolOutputSettings) -> Rig {
    Rig::armed(&with(|s| s.tool_output = tool_output))
}

/// Moves by `dx`, `dy` [m] from corner to corner, each with a level of the tool. Returns the
/// corners.
fn push(rig: &mut Rig, moves: &[([f32; 2], u16)], feed: f32) -> Vec<[f32; 2]> {
    let mut corners = vec![rig.tool_position()];
    for (tag, &([dx, dy], tool)) in (1..).zip(moves) {
        let [x, y] = corners[corners.len() - 1];
        let to = [x + dx, y + dy];
        let kind = MoveKind::Line { to, feed };
        rig.planner
            .push(&mut rig.controller, &Move { tag, tool, kind })
            .unwrap();
        corners.push(to);
    }
    corners
}

/// Each tick to the end of the path: where the tool should be [m], and the output.
fn drawn(rig: &mut Rig) -> Vec<([f32; 2], u16)> {
    let mut ticks = Vec::new();
    for _ in 0..30_000 {
        let command = rig.tick();
        let reference = rig.controller.status().reference.unwrap();
        ticks.push((reference, command.tool));
        if rig.planner.is_empty() && rig.controller.state() == State::Armed {
            return ticks;
        }
    }
    panic!("the path does not end");
}

fn distance([x, y]: [f32; 2], [u, v]: [f32; 2]) -> f32 {
    (x - u).hypot(y - v)
}

#[test]
fn a_servo_draws_exactly_the_strokes_asked_for() {
    let mut rig = armed(SERVO);
    let moves = [
        ([-0.004, 0.002], 0),
        ([-0.005, 0.0], FULL_TOOL),
        ([0.0, -0.004], FULL_TOOL),
        ([0.006, 0.001], 0),
        ([0.0, 0.003], FULL_TOOL),
    ];
    let corners = push(&mut rig, &moves, 0.1);
    let ticks = drawn(&mut rig);
    assert!(
        ticks
            .iter()
            .all(|&(_, output)| output == UP || output == DOWN)
    );
    let mut strokes: Vec<&[([f32; 2], u16)]> = ticks
        .chunk_by(|(_, before), (_, after)| before == after)
        .collect();
    assert_eq!(strokes.len(), 4, "up, down, up, down");
    for (stroke, (start, end)) in strokes.iter().zip([(0, 1), (1, 3), (3, 4), (4, 5)]) {
        let (first, _) = stroke[0];
        let (last, _) = stroke[stroke.len() - 1];
        assert!(distance(first, corners[start]) <= SAME, "{first:?}");
        assert!(distance(last, corners[end]) <= SAME, "{last:?}");
    }
    // The arm waits: 4 ms for the tool to come down, 3 ms for it to lift.
    for (stroke, wait) in strokes.drain(1..).zip([40, 30, 40]) {
        let (start, _) = stroke[0];
        let still = stroke
            .iter()
            .take_while(|&&(place, _)| distance(place, start) <= SAME)
            .count();
        assert!((wait..wait + 20).contains(&still), "{still} ticks");
    }
    // The job has left the tool down, and so it stays while a host is there.
    assert_eq!(rig.run(2000).tool, DOWN);
    // It is down already, so the next stroke needs no wait.
    let before = rig.controller.ticks();
    push(&mut rig, &[([0.001, 0.0], FULL_TOOL)], 0.1);
    let ticks = drawn(&mut rig);
    assert!(ticks.iter().all(|&(_, output)| output == DOWN));
    assert!(rig.controller.ticks() - before < 800);
}

#[test]
fn a_host_that_falls_silent_has_the_tool_lifted_and_it_stays_up() {
    let mut rig = armed(SERVO);
    push(&mut rig, &[([0.001, 0.0], FULL_TOOL)], 0.1);
    drawn(&mut rig);
    let silence = (0..2000)
        .take_while(|_| rig.tick_alone().tool == DOWN)
        .count();
    // 0.1 s, or some ticks less.
    assert!((988..=1000).contains(&silence), "{silence} ticks");
    assert_eq!(rig.run(100).tool, UP);
    // The planner knows: the next stroke waits for the tool to come down.
    push(&mut rig, &[([0.001, 0.0], FULL_TOOL)], 0.1);
    let ticks = drawn(&mut rig);
    let still = ticks
        .iter()
        .skip_while(|&&(_, output)| output == UP)
        .take_while(|&&(place, _)| distance(place, ticks[0].0) <= SAME)
        .count();
    assert!((40..60).contains(&still), "{still} ticks");
}

/// A power changes in motion, where the arm is at the corner.
#[test]
fn a_power_changes_at_its_corner_without_a_stop() {
    for scale_with_speed in [false, true] {
        let mut rig = armed(ToolOutputSettings::Power {
            frequency: 5e3,
            scale_with_speed,
        });
        let level = 40_000;
        // Corners of 20° are rounded within 50 µm.
        let moves = [
            ([-0.015, 0.0], 0),
            ([-0.0094, 0.0034], level),
            ([-0.015, 0.0], 0),
        ];
        let corners = push(&mut rig, &moves, 0.1);
        let ticks = drawn(&mut rig);
        let on = ticks
            .chunk_by(|a, b| (a.1 > 0) == (b.1 > 0))
            .find(|chunk| chunk[0].1 > 0)
            .unwrap();
        // A tick is 10 µm at full speed. The output is delayed by 3 ticks, the lag is 2.86.
        let (first, last) = (on[0].0, on[on.len() - 1].0);
        assert!(distance(first, corners[1]) <= 6.2e-5, "{first:?}");
        assert!(distance(last, corners[2]) <= 6.2e-5, "{last:?}");
        let slowest = on
            .windows(2)
            .map(|pair| distance(pair[0].0, pair[1].0) * 1e4)
            .fold(f32::INFINITY, f32::min);
        assert!(slowest > 0.02, "{slowest} m/s");
        let steady = |&(_, output): &([f32; 2], u16)| output == level;
        assert!(scale_with_speed || on.iter().all(steady));
    }
}

/// On a straight path, where no corner is rounded, the tool is at the corner to a tick: the
/// reference leads the arm by 2.86 ticks, and the output is delayed by 3.
#[test]
fn the_output_is_delayed_by_the_arms_lag() {
    let mut rig = armed(ToolOutputSettings::Power {
        frequency: 5e3,
        scale_with_speed: false,
    });
    let corners = push(
        &mut rig,
        &[([-0.015, 0.0], 0), ([-0.01, 0.0], FULL_TOOL)],
        0.1,
    );
    let ticks = drawn(&mut rig);
    let (first, _) = ticks.iter().find(|&&(_, output)| output > 0).unwrap();
    assert!(
        (0.0..=1.2e-5).contains(&(corners[1][0] - first[0])),
        "{first:?}"
    );
}

/// The longest delay is 7 ticks. The current loop lags by 7.1 ticks at 1400 rad/s and by 10 at
/// 1000 rad/s; a tick is 10 µm. The segments behind the one that changes the output are alike.
#[test]
fn the_longest_delay_hands_on_each_change_of_the_output() {
    for (bandwidth, late) in [(1400.0, 1.2e-5), (1000.0, 3.2e-5)] {
        let mut rig = Rig::armed(&with(|s| {
            s.tool_output = ToolOutputSettings::Power {
                frequency: 5e3,
                scale_with_speed: false,
            };
            s.control.current_bandwidth = bandwidth;
            s.control.bandwidth = 0.1 * bandwidth;
            s.control.observer_bandwidth = 0.8 * bandwidth;
            s.control.integral_rate = 0.02 * bandwidth;
        }));
        let levels = [0, FULL_TOOL, 20_000, 0, FULL_TOOL];
        let corners = push(&mut rig, &levels.map(|level| ([-0.005, 0.0], level)), 0.1);
        let mut ticks = drawn(&mut rig);
        ticks.dedup_by_key(|(_, output)| *output);
        // Off, on at each corner, and off after the path.
        assert_eq!(ticks.len(), levels.len() + 1, "{ticks:?}");
        for (change, corner) in ticks[1..levels.len()].iter().zip(&corners[1..]) {
            assert!(distance(change.0, *corner) < late, "{change:?}");
        }
    }
}

/// The rest lasts for the delay of 3 ticks and four more.
#[test]
fn a_switch_that_settles_at_once_changes_while_the_arm_rests() {
    let mut rig = armed(ToolOutputSettings::Switch {
        active_low: false,
        down_time: 0.0,
        up_time: 0.0,
    });
    push(
        &mut rig,
        &[([-0.01, 0.0], 0), ([-0.01, 0.0], FULL_TOOL)],
        0.1,
    );
    let mut rest = Vec::new();
    let mut began = false;
    while rig.controller.state() != State::Armed || !began {
        let command = rig.tick();
        let reference = rig.controller.status().joint_reference.unwrap();
        let rests = reference.velocity == [0.0; 2];
        began |= !rests;
        if began && rests && rig.controller.state() == State::Running {
            rest.push(command.tool > 0);
        }
    }
    assert!((6..=12).contains(&rest.len()), "{rest:?}");
    assert!(!rest[0] && rest[rest.len() - 1], "{rest:?}");
}

#[test]
fn a_power_that_follows_the_speed_is_off_at_rest_and_any_power_is_off_after_the_path() {
    for scale_with_speed in [false, true] {
        let mut rig = armed(ToolOutputSettings::Power {
            frequency: 5e3,
            scale_with_speed,
        });
        push(&mut rig, &[([-0.02, 0.0], FULL_TOOL)], 0.1);
        let ticks = drawn(&mut rig);
        for pair in ticks.windows(2) {
            let speed = distance(pair[0].0, pair[1].0) * 1e4;
            let share = f32::from(pair[1].1) / f32::from(FULL_TOOL);
            if scale_with_speed {
                assert!((share - speed / 0.1).abs() < 0.02, "{share} at {speed} m/s");
            }
        }
        let (_, last) = ticks[ticks.len() - 1];
        assert_eq!((last, rig.run(1).tool), (0, 0));
    }
}

/// What ends a job, and the fault that is latched then.
type End = (fn(&mut Rig), Option<Fault>);

const ENDS: [End; 11] = [
    (
        |rig| rig.bench.overlay.emergency_stop = true,
        Some(Fault::EmergencyStop),
    ),
    (
        |rig| rig.controller.request(Request::EmergencyStop).unwrap(),
        Some(Fault::EmergencyStop),
    ),
    (
        |rig| rig.bench.overlay.driver_fault = [true, false],
        Some(Fault::DriverFault),
    ),
    (
        |rig| rig.bench.overlay.missed_ticks = 3,
        Some(Fault::TickOverrun),
    ),
    (
        |rig| rig.bench.extra_counts = [0, 300],
        Some(Fault::EncoderJump),
    ),
    (|rig| rig.bench.bus = 12.0, Some(Fault::UnderVoltage)),
    (
        |rig| rig.bench.current = [0.0, 6.5],
        Some(Fault::OverCurrent),
    ),
    (
        |rig| rig.controller.latch_fault(Fault::CommandTimeout),
        Some(Fault::CommandTimeout),
    ),
    (
        |rig| rig.controller.latch_fault(Fault::QueueUnderrun),
        Some(Fault::QueueUnderrun),
    ),
    (|rig| rig.controller.request(Request::Stop).unwrap(), None),
    (|rig| rig.controller.request(Request::Disarm).unwrap(), None),
];

/// The tool comes down, draws 0.2 mm and lifts. Something ends the job in every tick of it: in
/// that tick the tool is up, and it stays up, also after the arm is armed again.
#[test]
fn whatever_ends_a_job_lifts_the_tool_in_its_tick() {
    let start = || {
        let mut rig = armed(SERVO);
        push(&mut rig, &[([2e-4, 0.0], FULL_TOOL), ([2e-4, 0.0], 0)], 0.1);
        rig
    };
    let ticks = drawn(&mut start());
    let down = ticks
        .iter()
        .position(|&(_, output)| output == DOWN)
        .unwrap();
    let up = ticks
        .iter()
        .rposition(|&(_, output)| output == DOWN)
        .unwrap();
    for last in down.saturating_sub(5)..up + 60 {
        for (n, (end, fault)) in ENDS.into_iter().enumerate() {
            // Every end in every seventh tick, and some end in each.
            if (last + n) % 7 > 1 {
                continue;
            }
            let mut rig = start();
            rig.run(last as u32);
            end(&mut rig);
            for tick in 0..20 {
                let output = rig.tick().tool;
                assert_eq!(output, UP, "end {n} after {last} ticks, then tick {tick}");
                rig.bench.overlay.missed_ticks = 0;
            }
            assert_eq!(rig.controller.status().fault, fault, "end {n}");
            rig.run(1300);
            rig.bench.overlay = Default::default();
            (rig.bench.bus, rig.bench.current) = (24.0, [0.0; 2]);
            let _ = rig.controller.request(Request::ClearFault);
            let _ = rig.controller.request(Request::Arm);
            for _ in 0..40 {
                assert_eq!(rig.tick().tool, UP, "end {n}, armed again");
            }
        }
    }
}

/// The list is that of the faults themselves, so a new one is tried, too.
#[test]
fn every_fault_lifts_the_tool_in_its_tick() {
    for fault in Fault::all() {
        let mut rig = armed(SERVO);
        push(&mut rig, &[([-0.02, 0.0], FULL_TOOL)], 0.1);
        let drawing = (rig.run(1000).tool, rig.controller.state());
        assert_eq!(drawing, (DOWN, State::Running));
        rig.controller.latch_fault(fault);
        for _ in 0..20 {
            assert_eq!(rig.tick().tool, UP, "{fault:?}");
        }
        assert_eq!(rig.controller.status().fault, Some(fault));
    }
}

/// The level is followed and reported without an output, too.
#[test]
fn without_an_output_the_motion_is_the_same_and_the_level_is_reported() {
    let run = |levels: [u16; 3]| {
        let mut rig = Rig::armed(&settings());
        let moves = [[-0.01, 0.0], [0.0, 0.01], [0.01, 0.0]];
        let moves: Vec<_> = moves.into_iter().zip(levels).collect();
        push(&mut rig, &moves, 0.1);
        drawn(&mut rig)
    };
    let (plain, levels) = (run([0; 3]), run([0, FULL_TOOL, 9]));
    assert_eq!(plain.len(), levels.len());
    assert!(plain.iter().zip(&levels).all(|(a, b)| a.0 == b.0));
    let outputs: Vec<u16> = levels
        .chunk_by(|a, b| a.1 == b.1)
        .map(|chunk| chunk[0].1)
        .collect();
    // Behind the path's end it is off.
    assert_eq!(outputs, [0, FULL_TOOL, 9, 0]);
}
