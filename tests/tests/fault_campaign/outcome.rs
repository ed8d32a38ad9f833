//! What came of a trial, by the arm itself, and the bounds on it.

use fivebar_firmware::controller::RequestError;
use fivebar_firmware::safety::{self, Response};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::Plant;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// The window of the RMS current [s], and the parts into which it is divided.
const WINDOW: f64 = 2.0;
const PARTS: usize = 100;
/// The parts over which the current is compared with its bound: 0.1 s, because it may alternate.
const SHORT: usize = 5;
/// The bound, as a share of the continuous current, and the longest time above it [s].
const MOST_CURRENT: f64 = 2.0;
const LONGEST: f64 = 2.0;
/// Time after a latched fault in which an unpowered arm coasts and a held one comes to rest [s].
pub(crate) const COASTING: f64 = 0.5;
/// A joint faster than this moves [rad/s].
const MOVING: f64 = 0.1;

/// What the controller did about the fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Found {
    /// It latched a fault.
    Latched(safety::Fault),
    /// It refused a request.
    Refused(RequestError),
}

/// What came of a trial.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outcome {
    pub(crate) found: Option<Found>,
    /// Time from the fault until it was found [s].
    pub(crate) after: f64,
    /// How far a joint was off its reference, or off its place without one, until then [rad].
    pub(crate) off: f64,
    /// The greatest speed of a joint then [rad/s], and of any time as a share of its limit.
    pub(crate) speed: f64,
    pub(crate) speed_share: f64,
    /// The greatest RMS current of a motor over 2 s, as a share of its continuous current.
    pub(crate) current_share: f64,
    /// The longest time for which a motor was above twice its continuous current [s].
    pub(crate) overloaded: f64,
    /// Whether a bridge had power under a fault that switches off.
    pub(crate) powered: bool,
    /// Whether a joint moved when the coasting after the latched fault was over.
    pub(crate) moved: bool,
    /// Whether the arm fell then: it moved unpowered.
    pub(crate) fell: bool,
}

impl Outcome {
    /// Whether a motor was above twice its continuous current for more than 2 s, a joint above its speed
    /// limit by half, or anything drove the arm after a latched fault.
    pub(crate) fn is_broken(&self) -> bool {
        self.overloaded > LONGEST || self.speed_share > 1.5 || self.powered || self.moved
    }
}

/// Measures the arm tick by tick, from the fault on.
pub(crate) struct Measure {
    pub(crate) outcome: Outcome,
    /// The last references of the joints; without one, their angles at the fault [rad].
    wanted: [f64; 2],
    continuous: [f64; 2],
    limit: [f64; 2],
    /// Ticks in a part of the window, in this part, and since the latched fault.
    part: u32,
    ticks: u32,
    /// Means of the squared currents over the last parts, and the sum of this part [A²].
    past: VecDeque<[f64; 2]>,
    squares: [f64; 2],
    /// The time for which each motor has been above the bound [s].
    overloaded: [f64; 2],
}

/// What the measure needs to know of a tick.
pub(crate) struct Seen<'a> {
    pub(crate) plant: &'a Plant,
    /// Time since the fault [s].
    pub(crate) time: f64,
    /// Time since a fault was latched after it [s], and the fault that is latched.
    pub(crate) latched: Option<(f64, safety::Fault)>,
    pub(crate) enabled: bool,
    pub(crate) reference: Option<[f32; 2]>,
}

impl Measure {
    pub(crate) fn new(plant: &Plant, continuous: [f64; 2], limit: [f64; 2], period: f64) -> Self {
        Self {
            outcome: Outcome::default(),
            wanted: Joint::ALL.map(|joint| plant.angle(joint)),
            continuous,
            limit,
            part: (WINDOW / PARTS as f64 / period).round() as u32,
            ticks: 0,
            past: VecDeque::from([[0.0; 2]; PARTS]),
            squares: [0.0; 2],
            overloaded: [0.0; 2],
        }
    }

    /// The controller found the fault in this tick.
    pub(crate) fn found(&mut self, found: Found, time: f64) {
        if self.outcome.found.is_none() {
            self.outcome.found = Some(found);
            self.outcome.after = time;
        }
    }

    pub(crate) fn tick(&mut self, seen: &Seen<'_>) {
        if let Some(reference) = seen.reference {
            self.wanted = reference.map(f64::from);
        }
        let state = seen.plant.state();
        let speed = [0, 3].map(|link: usize| state.v[link].angular.abs());
        let fastest = speed[0].max(speed[1]);
        let outcome = &mut self.outcome;
        for (speed, limit) in speed.into_iter().zip(self.limit) {
            outcome.speed_share = outcome.speed_share.max(speed / limit);
        }
        for (squares, current) in self.squares.iter_mut().zip(state.current) {
            *squares += current * current;
        }
        if outcome.found.is_none() || outcome.after == seen.time {
            outcome.speed = fastest;
            for j in Joint::ALL {
                let off = seen.plant.angle(j) - self.wanted[j];
                // References are within a turn.
                let off = off - (off / TAU).round() * TAU;
                outcome.off = outcome.off.max(off.abs());
            }
        }
        self.ticks += 1;
        if self.ticks == self.part {
            self.end_part();
        }
        let outcome = &mut self.outcome;
        if let Some((since, fault)) = seen.latched {
            let off = fault.response() == Response::PowerOff;
            outcome.powered |= off && seen.enabled;
            let moves = since > COASTING && fastest > MOVING;
            outcome.moved |= moves && seen.enabled;
            outcome.fell |= moves && !seen.enabled;
        }
    }

    /// Judges the currents at the end of a part of the window.
    fn end_part(&mut self) {
        self.past.pop_front();
        self.past
            .push_back(self.squares.map(|sum| sum / f64::from(self.part)));
        (self.ticks, self.squares) = (0, [0.0; 2]);
        let outcome = &mut self.outcome;
        for j in 0..2 {
            // The RMS over the last parts, as a share of the continuous current.
            let share = |parts: usize| {
                let last = self.past.iter().skip(PARTS - parts);
                let mean = last.map(|part| part[j]).sum::<f64>() / parts as f64;
                mean.sqrt() / self.continuous[j]
            };
            outcome.current_share = outcome.current_share.max(share(PARTS));
            if share(SHORT) > MOST_CURRENT {
                self.overloaded[j] += WINDOW / PARTS as f64;
            } else {
                self.overloaded[j] = 0.0;
            }
            outcome.overloaded = outcome.overloaded.max(self.overloaded[j]);
        }
    }
}
