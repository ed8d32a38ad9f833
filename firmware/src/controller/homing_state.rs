//! Homing to switches or stops: each joint searches for its own, both at the same time.
//!
//! A joint approaches until its switch closes, backs off until the switch is open and `back_off`
//! further, and creeps back at an eighth of the speed. The counts at which the switch closes then
//! belong to the home angle. A joint that starts on its switch begins by backing off: from anywhere in its
//! range behind the home angle. The search fails if the joint passes its whole range without finding the
//! switch, or cannot leave it.
//!
//! A switch counts as closed, or as open, when it has read so for a number of ticks in a
//! row: a disturbance does not end a phase, and a contact that bounces does not begin the next
//! one too early. The counts are those of the first of these ticks, so the filter adds no error
//! to the home angle. A contact that bounces open for longer than one tick is found later, after
//! the last of its gaps: at the creeping speed, 0.09 rad/s on the benchtop arm, bounces of 1 ms
//! are 0.09 mrad.
//!
//! A hard stop takes the place of a switch: it counts as closed while the motor takes nearly the
//! homing current and the joint stands still. The reference then waits where the joint is, so that
//! nothing builds up against the stop, and the joint leaves the stop in the end. A stop that is
//! felt before the joint has come back to it is an obstacle, and the search fails.
//!
//! With an index pulse the switch only says in which turn of the encoder the joint is: the joint
//! creeps away from the closed switch, away from what lies behind it, until the first pulse. Its
//! counts in the first tick of the pulse belong to the home angle, so a switch that closes somewhat
//! earlier or later does not change it. If a pulse comes too near to the switch, or no sooner than
//! a turn later, the switch cannot tell which of two pulses it is, and the search fails.

use crate::safety::Fault;
use crate::settings::{AxisSettings, CREEP, HomingMethod, INDEX_MARGIN, INDEX_SAMPLES, Settings};
use HomingError::{IndexAmbiguous, IndexNotFound, SwitchNotFound};
use core::f32::consts::TAU;
use fivebar_kinematics::Scalar;

/// Share of the homing current at which a stop is felt.
const STOP_SHARE: f32 = 0.9;
/// Share of the creeping speed below which a joint stands still at a stop.
const STANDSTILL_SHARE: f32 = 0.5;

/// A home switch without its bounces and disturbances.
#[derive(Clone, Copy, Debug)]
struct Debounced {
    closed: bool,
    /// Ticks in a row in which the switch has read the other state.
    differing: u8,
    /// The joint's counts in the first of them.
    counts: i32,
}

impl Debounced {
    const OPEN: Self = Self {
        closed: false,
        differing: 0,
        counts: 0,
    };

    /// Takes one tick's reading, and the joint's counts in this tick; so many equal ones are believed.
    fn read(&mut self, closed: bool, counts: i32, samples: u8) {
        if closed == self.closed {
            self.differing = 0;
            return;
        }
        if self.differing == 0 {
            self.counts = counts;
        }
        self.differing += 1;
        if self.differing >= samples {
            self.closed = closed;
            self.differing = 0;
        }
    }
}

/// How a stop is felt.
#[derive(Clone, Copy, Debug)]
pub(super) struct StopDetection {
    /// Least motor current [A].
    current: f32,
    /// Greatest speed of the joint [rad/s].
    speed: f32,
}

impl StopDetection {
    /// Whether a joint with this motor current [A] and speed [rad/s] is felt to stand at a stop.
    #[inline(always)]
    pub(super) fn is_felt(&self, current: f32, velocity: f32) -> bool {
        Scalar::abs(current) >= self.current && Scalar::abs(velocity) <= self.speed
    }
}

/// The constants of one joint's search.
#[derive(Clone, Copy, Debug)]
pub(super) struct HomingConfig {
    /// Towards the switch, signed [rad/s].
    speed: f32,
    /// [rad].
    back_off: f32,
    /// The farthest that it backs off while its switch stays closed [rad]: four times `back_off`, and what its range
    /// has behind the home angle.
    leave: f32,
    /// The longest approach [rad]: the joint's range and an allowance for overrun.
    range: f32,
    /// Greatest change of the reference's speed [rad/s²].
    acceleration: f32,
    /// Ticks in a row after which a switch or a stop is believed.
    samples: u8,
    /// In place of a switch.
    pub(super) stop: Option<StopDetection>,
    /// From one index pulse to the next [rad], if one is sought.
    index: Option<f32>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Approach {
        from: f32,
    },
    BackOff {
        from: f32,
    },
    Creep {
        from: f32,
    },
    /// Creep away from the switch, to the index pulse.
    Index {
        from: f32,
    },
    /// From a stop, at these counts.
    Leave {
        from: f32,
        counts: i32,
    },
    Found {
        counts: i32,
    },
}

/// The search of one joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct HomingState {
    phase: Phase,
    switch: Debounced,
    /// Reference of the joint's angle [rad], from an unknown origin, and speed [rad/s].
    pub(super) angle: f32,
    pub(super) rate: f32,
}

/// Why a search failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum HomingError {
    /// The joint went as far as it may and did not find its switch.
    SwitchNotFound,
    /// No index pulse came within a turn of the encoder.
    IndexNotFound,
    /// The index pulse is so near to the switch that it could be that of the next turn.
    IndexAmbiguous,
}

impl From<HomingError> for Fault {
    fn from(error: HomingError) -> Self {
        match error {
            HomingError::SwitchNotFound => Self::Envelope,
            HomingError::IndexNotFound => Self::IndexNotFound,
            HomingError::IndexAmbiguous => Self::IndexAmbiguous,
        }
    }
}

impl HomingConfig {
    pub(super) fn new(axis: &AxisSettings, settings: &Settings) -> Self {
        let homing = &settings.homing;
        let method = settings.home_reference.method;
        let [low, high] = axis.angle_limits;
        let speed = if axis.home_forward {
            homing.speed
        } else {
            -homing.speed
        };
        let behind = if axis.home_forward {
            high - axis.home_angle
        } else {
            axis.home_angle - low
        };
        Self {
            speed,
            back_off: homing.back_off,
            leave: 4.0 * homing.back_off + behind.max(0.0),
            range: high - low + 2.0 * homing.back_off,
            // The first approach reaches its speed in 0.1 s.
            acceleration: 10.0 * homing.speed,
            samples: settings.home_reference.samples,
            stop: (method == HomingMethod::HardStop).then_some(StopDetection {
                current: STOP_SHARE * homing.current,
                speed: STANDSTILL_SHARE * CREEP * homing.speed,
            }),
            index: (method == HomingMethod::Index)
                .then(|| TAU * axis.index_counts as f32 / axis.counts_per_turn()),
        }
    }
}

impl HomingState {
    /// A search that begins at `angle` [rad]. If the switch is closed already, it begins to back
    /// off as soon as the switch is believed.
    pub(super) fn new(angle: f32) -> Self {
        Self {
            phase: Phase::Approach { from: angle },
            switch: Debounced::OPEN,
            angle,
            rate: 0.0,
        }
    }

    /// A search that has ended: the joint at `angle` [rad] has these counts at its home angle.
    pub(super) fn known(angle: f32, counts: i32) -> Self {
        Self {
            phase: Phase::Found { counts },
            ..Self::new(angle)
        }
    }

    /// The counts at the home angle, once found.
    pub(super) fn found(&self) -> Option<i32> {
        match self.phase {
            Phase::Found { counts } => Some(counts),
            Phase::Approach { .. }
            | Phase::BackOff { .. }
            | Phase::Creep { .. }
            | Phase::Index { .. }
            | Phase::Leave { .. } => None,
        }
    }

    /// Whether the joint seeks its index pulse, and its switch no longer matters.
    #[inline(always)]
    pub(super) fn seeks_index(&self) -> bool {
        matches!(self.phase, Phase::Index { .. })
    }

    /// The reference rests where the joint does, at a stop.
    #[inline(always)]
    fn rest_at(&mut self, angle: f32) {
        self.angle = angle;
        self.rate = 0.0;
    }

    /// One tick of `period` [s], with what the switch reads, or the index while the joint seeks it,
    /// the measured angle [rad] and its counts.
    pub(super) fn step(
        &mut self,
        config: &HomingConfig,
        closed: bool,
        angle: f32,
        counts: i32,
        period: f32,
    ) -> Result<(), HomingError> {
        let was_closed = self.switch.closed;
        let samples = if self.seeks_index() {
            INDEX_SAMPLES
        } else {
            config.samples
        };
        self.switch.read(closed, counts, samples);
        let Debounced { closed, counts, .. } = self.switch;
        let gone = |from: f32| Scalar::abs(angle - from);
        let wanted = match self.phase {
            Phase::Approach { from } => {
                if closed {
                    if config.stop.is_some() {
                        self.rest_at(angle);
                    }
                    self.phase = Phase::BackOff { from: angle };
                } else if gone(from) > config.range {
                    return Err(SwitchNotFound);
                }
                config.speed
            }
            Phase::BackOff { from } => {
                if closed && gone(from) > config.leave {
                    return Err(SwitchNotFound);
                }
                if !closed && gone(from) >= config.back_off {
                    self.phase = Phase::Creep { from: angle };
                }
                -config.speed
            }
            Phase::Creep { from } => {
                if closed {
                    if config.index.is_some() {
                        self.phase = Phase::Index { from: angle };
                    } else if config.stop.is_none() {
                        self.phase = Phase::Found { counts };
                    } else if gone(from) < 0.5 * config.back_off {
                        return Err(SwitchNotFound);
                    } else {
                        self.rest_at(angle);
                        self.phase = Phase::Leave {
                            from: angle,
                            counts,
                        };
                    }
                } else if gone(from) > 6.0 * config.back_off {
                    return Err(SwitchNotFound);
                }
                CREEP * config.speed
            }
            Phase::Index { from } => {
                let turns = gone(from) / config.index.unwrap_or(0.0);
                if closed && !was_closed {
                    if !(INDEX_MARGIN..=1.0 - INDEX_MARGIN).contains(&turns) {
                        return Err(IndexAmbiguous);
                    }
                    self.phase = Phase::Found { counts };
                } else if turns > 1.0 + INDEX_MARGIN || gone(from) > config.range {
                    return Err(IndexNotFound);
                }
                -CREEP * config.speed
            }
            Phase::Leave { from, counts } => {
                if gone(from) >= config.back_off {
                    self.phase = Phase::Found { counts };
                }
                -CREEP * config.speed
            }
            Phase::Found { .. } => 0.0,
        };
        self.advance(wanted, config, period);
        Ok(())
    }

    /// Advances the reference by one tick of `period` [s], towards this speed [rad/s].
    #[inline(always)]
    pub(super) fn advance(&mut self, wanted: f32, config: &HomingConfig, period: f32) {
        let most = config.acceleration * period;
        self.rate += limited(wanted - self.rate, most);
        self.angle += self.rate * period;
    }
}

/// `value` brought within ±`limit`; NaN stays NaN.
#[inline(always)]
pub(super) fn limited(value: f32, limit: f32) -> f32 {
    if Scalar::abs(value) > limit {
        if value > 0.0 { limit } else { -limit }
    } else {
        value
    }
}

#[cfg(test)]
mod tests;
