//! A stream of set-points from a program to a controller: when each point is due, its velocity, and how the stream goes on after
//! a pause of the program.
//!
//! Points are due in ticks of the controller, one period after the other. So the computer's clock does not matter, nor how
//! evenly the program gives its points, as long as each comes within the delay.

mod approach;
mod pacer;

use approach::Approach;
use fivebar_firmware::motion::{
    FIXTURES, Fixture, StreamConfig, StreamMode, StreamPoint, StreamPolicy,
};
use pacer::Pacer;

/// The number of points for which the controller has room in a delay.
const MOST_PERIODS: f64 = 26.0;
/// The shortest default delay [s]: a program on a computer with other work gives its points by so much too late.
const USUAL_DELAY: f64 = 0.04;
/// The longest delay that a controller takes [s].
const LONGEST_DELAY: f64 = 0.2;

/// What a program wants of a stream.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamOptions {
    /// What its points say.
    pub mode: StreamMode,
    /// Points per second [1/s].
    pub rate: f64,
    /// The time from a point to the arm's being there [s]; none: 40 ms or three periods, if there is room for that.
    pub delay: Option<f64>,
    /// What becomes of it with a point beyond a limit.
    pub policy: StreamPolicy,
    /// Walls and guides of a stream with an impedance.
    pub fixtures: [Option<Fixture>; FIXTURES],
}

/// A set-point of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetPoint {
    /// θ1, θ4 [rad] or x, y [m].
    pub position: [f64; 2],
    /// Its velocity [rad/s or m/s]; none: by the points before and behind it.
    pub velocity: Option<[f64; 2]>,
    /// A force of the tool on what it touches [N], or torques of the joints [N·m]: what the motors give besides those of the motion.
    pub force: [f64; 2],
}

impl SetPoint {
    /// A position [rad or m] alone.
    pub fn at(position: [f64; 2]) -> Self {
        Self {
            position,
            velocity: None,
            force: [0.0; 2],
        }
    }
}

impl StreamOptions {
    /// How the stream begins at a controller of this tick rate [Hz].
    pub fn config(&self, id: u32, tick_rate: f64) -> StreamConfig {
        let period = (tick_rate / self.rate)
            .round()
            .clamp(1.0, f64::from(u16::MAX));
        let usual = (USUAL_DELAY * tick_rate).max(3.0 * period);
        let wanted = self.delay.map(|delay| delay * tick_rate);
        let delay = wanted.unwrap_or_else(|| {
            usual
                .min(MOST_PERIODS * period)
                .min(LONGEST_DELAY * tick_rate)
        });
        StreamConfig {
            id,
            mode: self.mode,
            period: period as u16,
            delay: delay.round().clamp(0.0, f64::from(u16::MAX)) as u16,
            policy: self.policy,
        }
    }
}

/// Makes a controller's points of a program's.
#[derive(Clone, Debug)]
pub struct Streamer {
    config: StreamConfig,
    tick_rate: f64,
    pacer: Pacer,
    /// The number of the point made last.
    n: u16,
    /// The point before the one that waits for its velocity.
    before: Option<[f64; 2]>,
    /// The point that waits for the next one.
    waiting: Option<SetPoint>,
    approach: Option<Approach>,
}

impl Streamer {
    /// For a stream that begins now, in this tick of a controller with this tick rate [Hz].
    pub fn new(config: StreamConfig, tick_rate: f64, tick: u32) -> Self {
        Self {
            config,
            tick_rate,
            pacer: Pacer::new(&config, tick),
            n: 0,
            before: None,
            waiting: None,
            approach: None,
        }
    }

    /// How the stream has begun.
    pub fn config(&self) -> &StreamConfig {
        &self.config
    }

    /// Whether a point may be made in this tick: the points before last longer than the delay otherwise.
    pub fn is_due(&self, tick: u32) -> bool {
        self.pacer.is_due(tick)
    }

    /// Takes the program's next point; returns the number and the point that goes to the controller in this tick. None for the
    /// first point, which waits for the second.
    pub fn push(&mut self, next: SetPoint, tick: u32) -> Option<(u16, StreamPoint)> {
        let point = self.waiting.replace(next)?;
        let before = self
            .before
            .replace(point.position)
            .unwrap_or(point.position);
        let twice = 2.0 * self.period();
        let velocity = point
            .velocity
            .unwrap_or_else(|| slope(before, next.position, twice));
        Some(self.make(&point, velocity, tick))
    }

    /// The last point, which waits for none behind it.
    pub fn last(&mut self, tick: u32) -> Option<(u16, StreamPoint)> {
        let point = self.waiting.take()?;
        let before = self.before.unwrap_or(point.position);
        let velocity = point
            .velocity
            .unwrap_or_else(|| slope(before, point.position, self.period()));
        Some(self.make(&point, velocity, tick))
    }

    /// Goes on from this place at rest [rad or m], where the arm is after a pause of the program, in this tick.
    pub fn go_on_from(&mut self, rest: [f64; 2], tick: u32) {
        self.pacer = Pacer::new(&self.config, tick);
        self.approach = Some(Approach::from(rest));
    }

    fn make(&mut self, given: &SetPoint, velocity: [f64; 2], tick: u32) -> (u16, StreamPoint) {
        let (period, position) = (self.period(), given.position);
        let (position, velocity) = match &mut self.approach {
            None => (position, velocity),
            Some(approach) => {
                let blended = approach.blend(position, velocity);
                if approach.is_over_after(period) {
                    self.approach = None;
                }
                blended
            }
        };
        // The point is due in a whole tick: it is where the motion is then.
        let (due, later) = self.pacer.next(tick);
        let later = later / self.tick_rate;
        self.n = self.n.wrapping_add(1);
        let point = StreamPoint {
            id: self.config.id,
            due,
            position: [0, 1]
                .map(|k| (position[k] + later * velocity[k]) as f32)
                .into(),
            velocity: velocity.map(|value| value as f32).into(),
            force: given.force.map(|value| value as f32).into(),
        };
        (self.n, point)
    }

    /// [s].
    fn period(&self) -> f64 {
        f64::from(self.config.period) / self.tick_rate
    }
}

fn slope(from: [f64; 2], to: [f64; 2], time: f64) -> [f64; 2] {
    [0, 1].map(|k| (to[k] - from[k]) / time)
}

#[cfg(test)]
mod tests;
