//! Streams that limits do not end: the arm goes towards points that it cannot reach, or not so fast, and comes back to the
//! host's motion.

use crate::host::{MS, Motion, Streaming};
use crate::rig::{START, settings, with};
use fivebar_firmware::motion::StreamMode;
use fivebar_firmware::planner::{MoveErrorKind, StreamPhase, StreamReason};
use fivebar_firmware::settings::Settings;

/// The delay of the streams [ms].
const DELAY: u32 = 25;

/// What the arm did with a motion.
struct Seen {
    stream: Streaming,
    /// The limits that it met.
    kinds: Vec<MoveErrorKind>,
    /// The host's position and the arm's set-point in each millisecond, of the joints or of the tip.
    way: Vec<([f64; 2], [f64; 2])>,
}

impl Seen {
    /// How far the arm is from the host's motion in the last milliseconds, at most [m or rad].
    fn off(&self, last: usize) -> f64 {
        let tail = &self.way[self.way.len() - last..];
        tail.iter()
            .map(|([x, y], [ax, ay])| (x - ax).hypot(y - ay))
            .fold(0.0, f64::max)
    }
}

fn followed(settings: &Settings, mode: StreamMode, motion: Motion<'_>, ms: u32) -> Seen {
    let mut stream = Streaming::limited(settings, mode, DELAY);
    let (mut kinds, mut way) = (Vec::new(), Vec::new());
    for now in 0..ms {
        let point = stream.point(motion, now);
        stream.give(point);
        if let Some(StreamReason::Limit(kind)) = stream.progress().reason
            && kinds.last() != Some(&kind)
        {
            kinds.push(kind);
        }
        assert_eq!(stream.phase(), StreamPhase::Follows, "{now} ms");
        stream.ticks(MS);
        let status = stream.rig.controller.status();
        assert_eq!(status.fault, None, "{now} ms");
        let arm = match mode {
            StreamMode::Joint => status.joint_reference.map(|joints| joints.angle),
            _ => status.reference,
        };
        let [host, _] = motion(f64::from((now + 1).saturating_sub(DELAY)) * 1e-3);
        way.push((host, arm.expect("a set-point").map(f64::from)));
    }
    Seen { stream, kinds, way }
}

/// From 0 to 1 in a second, at rest at both ends: value and rate.
fn smooth(time: f64) -> [f64; 2] {
    let u = time.clamp(0.0, 1.0);
    [u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u)]
}

/// Out by `far` in a second, back in the next one, then at rest.
fn out_and_back(from: [f64; 2], far: [f64; 2]) -> impl Fn(f64) -> [[f64; 2]; 2] {
    move |time| {
        let ([out, rate], [back, slower]) = (smooth(time), smooth(time - 1.0));
        let (share, speed) = (out - back, rate - slower);
        [
            [0, 1].map(|axis| from[axis] + share * far[axis]),
            far.map(|far| speed * far),
        ]
    }
}

#[test]
fn the_tip_stays_within_a_singularity_and_comes_back_to_the_hosts_motion() {
    let from = Streaming::begin(StreamMode::Tip, DELAY).rig.tool_position();
    let motion = out_and_back(from.map(f64::from), [0.0, 0.2]);
    let seen = followed(&settings(), StreamMode::Tip, &motion, 2_600);
    assert!(
        seen.kinds.contains(&MoveErrorKind::LegSingularity(1)),
        "{:?}",
        seen.kinds
    );
    let limited = seen.stream.progress().limited;
    assert!((200..2_500).contains(&limited), "{limited}");
    // It went as far as it may, which is most of the way to where a leg is straight.
    let highest = seen.way.iter().map(|(_, [_, y])| *y).fold(0.0, f64::max);
    assert!(highest - f64::from(from[1]) > 0.02, "{highest} {from:?}");
    assert!(seen.off(100) < 2e-6, "{}", seen.off(100));
}

#[test]
fn a_joint_stays_within_its_angles_and_comes_back_to_the_hosts_motion() {
    let narrow = with(|settings| settings.axes[0].angle_limits = [START[0] - 0.2, START[0] + 0.2]);
    let motion = out_and_back(START.map(f64::from), [0.5, 0.1]);
    let seen = followed(&narrow, StreamMode::Joint, &motion, 2_600);
    assert!(
        seen.kinds.contains(&MoveErrorKind::JointLimit(1)),
        "{:?}",
        seen.kinds
    );
    let most = seen
        .way
        .iter()
        .map(|(_, [theta1, _])| *theta1)
        .fold(0.0, f64::max);
    let limit = f64::from(START[0]) + 0.2;
    assert!((limit - 0.02..limit).contains(&most), "{most} of {limit}");
    assert!(seen.off(100) < 2e-5, "{}", seen.off(100));
}

#[test]
fn a_host_that_jumps_is_caught_up_with() {
    let [x, y] = Streaming::begin(StreamMode::Tip, DELAY)
        .rig
        .tool_position()
        .map(f64::from);
    let motion = move |time: f64| {
        let way = if time < 0.1 { 0.0 } else { -0.03 };
        [[x + way, y], [0.0; 2]]
    };
    let seen = followed(&settings(), StreamMode::Tip, &motion, 600);
    assert!(seen.stream.progress().limited > 10);
    // As soon as moves would be there, and not much beyond.
    let late = seen
        .way
        .iter()
        .position(|([host, _], [arm, _])| *host < x - 0.02 && (host - arm).abs() < 1e-4);
    let late = late.expect("it gets there");
    assert!((125..425).contains(&late), "{late} ms");
    let beyond = seen
        .way
        .iter()
        .map(|(_, [arm, _])| x - 0.03 - arm)
        .fold(0.0, f64::max);
    assert!(beyond < 2e-3, "{beyond} m");
    assert!(seen.off(50) < 2e-6, "{}", seen.off(50));
}

#[test]
fn a_stream_that_limits_do_not_end_still_starves_and_is_led_back_by_points_elsewhere() {
    let [x, y] = Streaming::begin(StreamMode::Tip, DELAY)
        .rig
        .tool_position()
        .map(f64::from);
    let motion = out_and_back([x, y], [0.0, 0.2]);
    // The host falls silent while the arm is at the limit.
    let mut seen = followed(&settings(), StreamMode::Tip, &motion, 900);
    for _ in 0..100 * MS {
        seen.stream.rig.controller.feed_host_timeout();
        seen.stream.tick();
    }
    assert_eq!(seen.stream.phase(), StreamPhase::Starved);
    let rest = move |_: f64| [[x, y], [0.0; 2]];
    for _ in 0..600 {
        let now = seen.stream.now();
        let point = seen.stream.point(&rest, now);
        seen.stream.give(point);
        seen.stream.ticks(MS);
    }
    assert_eq!(seen.stream.phase(), StreamPhase::Follows);
    let arm = seen.stream.rig.controller.status().reference;
    let [ax, ay] = arm.expect("a set-point").map(f64::from);
    assert!((ax - x).hypot(ay - y) < 2e-6, "{ax} {ay}");
}
