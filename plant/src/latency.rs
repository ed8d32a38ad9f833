//! The latency of the encoders: the angle that is sampled at t is the shaft's at t − T.
//!
//! Between two recorded instants the angle is interpolated by the cubic that has the angles and
//! the speeds at both (Hermite).

use fivebar_kinematics::five_bar::Joint;
use std::collections::VecDeque;

/// The angles of both encoders' shafts, over the gear ratio, at the end of a tick.
#[derive(Clone, Copy, Debug)]
struct Instant {
    time: f64,
    angle: [f64; 2],
    speed: [f64; 2],
}

/// The past of the shafts, as far back as the latencies need.
#[derive(Clone, Debug)]
pub(crate) struct Delay {
    /// T of each encoder [s].
    latency: [f64; 2],
    past: VecDeque<Instant>,
}

impl Delay {
    /// None without latency.
    pub(crate) fn new(latency: [f64; 2]) -> Option<Self> {
        (latency != [0.0; 2]).then(|| Self {
            latency,
            past: VecDeque::new(),
        })
    }

    /// Records the angles [rad] and speeds [rad/s] at `time` [s].
    pub(crate) fn record(&mut self, time: f64, angle: [f64; 2], speed: [f64; 2]) {
        self.past.push_back(Instant { time, angle, speed });
        let [latency1, latency4] = self.latency;
        let oldest = time - latency1.max(latency4);
        while self.past.get(1).is_some_and(|second| second.time <= oldest) {
            self.past.pop_front();
        }
    }

    /// The angle that an encoder, shows at `time` [rad], not before the latest record.
    /// Before the first record the shaft stood still.
    pub(crate) fn angle(&self, joint: Joint, time: f64) -> Option<f64> {
        let time = time - self.latency[joint];
        let after = self.past.partition_point(|instant| instant.time <= time);
        let last = self.past.get(after.saturating_sub(1))?;
        let Some(next) = self.past.get(after).filter(|_| after > 0) else {
            return Some(last.angle[joint]);
        };
        let span = next.time - last.time;
        let u = (time - last.time) / span;
        let (a, b) = (last.angle[joint], next.angle[joint]);
        let (da, db) = (span * last.speed[joint], span * next.speed[joint]);
        let rise = b - a;
        Some(a + u * (da + u * (3.0 * rise - 2.0 * da - db + u * (da + db - 2.0 * rise))))
    }
}
