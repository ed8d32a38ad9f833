//! The arm follows a stream as it follows the same motion by timed pieces.

use crate::host::{MS, Motion, Streaming, sine};
use crate::rig::{Rig, settings};
use fivebar_firmware::motion::StreamMode;
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::planner::StreamPhase;
use fivebar_firmware::{Move, MoveKind, TimedCurve, TimedMove};

/// The delay of the streams [ms].
const DELAY: u32 = 25;
/// The lag of the drives, which the set-point of a tick leads by [s].
const LAG: f64 = 1.0 / 3500.0;
/// The time for which each motion is followed [ms].
const TIME: u32 = 1500;

/// The greatest distance of the arm's tool from a motion [m]: `tick` runs a tick and returns the time on the motion then [s],
/// if it has begun.
fn tip_error(
    motion: Motion<'_>,
    mut tick: impl FnMut() -> (Option<f64>, [f64; 2]),
    ticks: u32,
) -> f64 {
    (0..ticks).fold(0.0, |worst: f64, _| match tick() {
        (Some(time), [x, y]) if time > 0.0 => {
            let [[xd, yd], _] = motion(time - LAG);
            worst.max((x - xd).hypot(y - yd))
        }
        _ => worst,
    })
}

/// The tip error along a motion by timed pieces of 10 ms.
fn error_by_timed_pieces(motion: Motion<'_>) -> f64 {
    let mut rig = Rig::armed(&settings());
    let mut next = 0;
    let mut begun = None;
    let tick = || {
        while let Ok(()) = push(&mut rig, &piece(motion, next)) {
            next += 1;
        }
        rig.tick();
        if rig.controller.state() == fivebar_firmware::safety::State::Running {
            begun = begun.or(Some(rig.controller.ticks()));
        }
        let since = begun.map(|begun| f64::from(rig.controller.ticks() - begun) * 1e-4);
        (since, rig.bench.tool())
    };
    tip_error(motion, tick, TIME * MS)
}

fn push(rig: &mut Rig, piece: &TimedMove) -> Result<(), ()> {
    let (tag, tool, kind) = (0, 0, MoveKind::Timed(*piece));
    match rig
        .planner
        .push(&mut rig.controller, &Move { tag, tool, kind })
    {
        Ok(()) => Ok(()),
        Err(error) if error.kind == MoveErrorKind::Full => Err(()),
        Err(error) => panic!("{error:?}"),
    }
}

/// The n-th piece of 10 ms.
fn piece(motion: Motion<'_>, n: u32) -> TimedMove {
    let time = 0.01;
    let begin = f64::from(n) * time;
    let [[p, v], [q, w]] = [begin, begin + time].map(motion);
    let coefficients: [[f64; 2]; 4] = [
        p,
        [0, 1].map(|k| v[k] * time),
        [0, 1].map(|k| 3.0 * (q[k] - p[k]) - (2.0 * v[k] + w[k]) * time),
        [0, 1].map(|k| 2.0 * (p[k] - q[k]) + (v[k] + w[k]) * time),
    ];
    let [c0, c1, c2, c3] = coefficients.map(|c| c.map(|value| value as f32));
    // Longer than the piece at the greatest speed.
    let length = 0.002_f32;
    TimedMove {
        curve: TimedCurve::Blend {
            coefficients: [c0, c1, c2, c3, [0.0; 2], [0.0; 2]],
            inverse_length: 1.0 / length,
        },
        law: [0.0, length / time as f32, 0.0, 0.0],
        duration: time as f32,
    }
}

/// The next of a row of pseudo-random numbers below `below`.
fn random(state: &mut u32, below: u32) -> u32 {
    *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    (*state >> 8) % below
}

#[test]
fn jitter_and_losses_within_the_delay_leave_the_tool_where_timed_pieces_have_it() {
    let mut stream = Streaming::begin(StreamMode::Tip, DELAY);
    let motion = sine(stream.rig.tool_position());
    let mut seed = 7;
    let mut ms = 0;
    let begun = stream.begun;
    let tick = || {
        if (stream.rig.controller.ticks() - begun).is_multiple_of(MS) {
            let point = stream.point(&motion, ms);
            ms += 1;
            // Up to 20 ms late, 1 % lost.
            let after = random(&mut seed, 20 * MS + 1);
            if random(&mut seed, 100) > 0 {
                stream.send(point, after);
            }
        }
        stream.tick();
        let since = f64::from(stream.rig.controller.ticks() - begun) * 1e-4;
        let time = since - f64::from(DELAY) * 1e-3;
        (Some(time), stream.rig.bench.tool())
    };
    let streamed = tip_error(&motion, tick, TIME * MS);
    let progress = stream.progress();
    assert_eq!(progress.phase, StreamPhase::Follows);
    assert!(
        (5..40).contains(&progress.lost) && progress.refused == 0,
        "{progress:?}"
    );
    assert_eq!(progress.late, 0);
    let timed = error_by_timed_pieces(&motion);
    assert!(
        (streamed - timed).abs() < 5e-6 && timed > 1e-6,
        "{streamed} {timed}"
    );
}

#[test]
fn the_lag_is_the_delay_in_both_modes_and_for_every_period() {
    for (mode, period) in [
        (StreamMode::Tip, 1),
        (StreamMode::Joint, 1),
        (StreamMode::Tip, 10),
        (StreamMode::Joint, 10),
    ] {
        let delay = 2 * period + 23;
        let mut stream = Streaming::paced(mode, period, delay);
        let tool = sine(stream.rig.tool_position());
        let turn = sine(crate::rig::START);
        let motion: Motion<'_> = match mode {
            StreamMode::Tip | StreamMode::Free | StreamMode::Impedance(_) => &tool,
            StreamMode::Joint => &turn,
        };
        let (mut worst, mut fastest) = (0.0_f64, 0.0_f64);
        for ms in (0..600).step_by(period as usize) {
            let point = stream.point(motion, ms);
            stream.give(point);
            for tick in 1..=period * MS {
                stream.tick();
                let status = stream.rig.controller.status();
                let time = f64::from(ms) * 1e-3 + f64::from(tick) * 1e-4 - f64::from(delay) * 1e-3;
                if time < 0.001 {
                    continue;
                }
                let [[at, _], [rate, _]] = motion(time - LAG);
                let found = match mode {
                    StreamMode::Tip | StreamMode::Free | StreamMode::Impedance(_) => {
                        status.reference.expect("a reference")[0]
                    }
                    StreamMode::Joint => status.joint_reference.expect("a reference").angle[0],
                };
                worst = worst.max((f64::from(found) - at).abs());
                fastest = fastest.max(rate.abs());
            }
        }
        assert_eq!(stream.progress().reason, None);
        // Less than the way of a tick.
        assert!(
            worst < 0.5 * fastest * 1e-4,
            "{mode:?} {period}: {worst} at {fastest}"
        );
    }
}

/// The first point is reached when it is due, though ticks pass while its piece is made: the next one may be due a tick later.
#[test]
fn the_first_point_is_reached_when_it_is_due() {
    let mut stream = Streaming::begin(StreamMode::Tip, DELAY);
    let motion = sine(stream.rig.tool_position());
    let (n, first) = stream.point(&motion, 0);
    stream.rig.take_point_interrupted(n, &first);
    let passed = stream.rig.controller.ticks() - stream.begun;
    assert!(passed > 3, "{passed} ticks");
    let (n, mut next) = stream.point(&motion, 0);
    next.due = first.due + 1;
    stream.give((n, next));
    let progress = stream.progress();
    assert_eq!((progress.last, progress.reason), (Some(n), None));
}
