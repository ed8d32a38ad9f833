//! The order in which the bridges and the holding brakes take the arm over from each other.
//!
//! A brake takes time to release and to engage. The bridges wake up and hold the arm; then the brakes
//! are released, and motion begins when they are free. Before the bridges go off, the arm comes to
//! rest, and the brakes engage under power. Then the torques fall to zero while the joints are
//! watched: brakes that do not hold the arm are a fault, and the bridges go on to hold it. Drives that follow a
//! motion take whatever torque it needs, so in place of their torques their power is taken, until the end of the test.
//! Without encoders nothing would show that the arm falls, so their brakes are not tested. A power-off
//! fault does not wait for the brakes.
//!
//! Brakes with an engage time of 0 need no order: the bridges go off at once.

use super::ArmController;
use super::setpoint::Setpoint;
use super::time_slices::TIME_SLICES;
use crate::drives::{Drives, Needs, UnpoweredPlace};
use crate::io::{ArmCommand, ArmSample};
use crate::safety::{Event, Fault, State};
use crate::settings::BrakeSettings;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Turns of the brakes in all turns.
const SLICES_OF_BRAKES: u32 = 2;
/// Time in which the torques fall to zero [s].
const FALLING_TIME: f32 = 0.03;
/// Time with no torque in which the brakes must hold the arm [s].
const TESTING_TIME: f32 = 0.05;
/// The farthest that a joint turns under a brake that holds [rad].
const BRAKE_PLAY: f32 = 0.01;

/// Whether a tick has the brakes' turn.
fn is_brakes_turn(ticks: u32) -> bool {
    ticks % (TIME_SLICES / SLICES_OF_BRAKES) == 1
}

/// What the brakes do.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    /// They hold, or begin to: the bridges are off, or not awake yet.
    Engaged,
    /// They release for so many more turns; the bridges hold the arm.
    Releases(u32),
    /// They are free.
    Free,
    /// They engage for so many more turns; the bridges hold the arm.
    Engages(u32),
    /// They hold the arm, which had these angles [rad], with falling torques; so many more turns.
    IsTested(u32, [f32; 2]),
}

/// The brakes of both joints, which have one output.
#[derive(Clone)]
pub(super) struct HoldingBrake {
    phase: Phase,
    /// The share of the torques that the motors give.
    pub(super) share: f32,
    /// The event that waits for the brakes: it switches the bridges off.
    ending: Option<Event>,
    /// What their test has found in the tick before.
    verdict: Option<Verdict>,
    /// Turns that the brakes need.
    release_turns: u32,
    engage_turns: u32,
    /// Turns in which they are tested, and those of them with no torque.
    test_turns: u32,
    no_torque_turns: u32,
    per_falling_turn: f32,
}

impl HoldingBrake {
    pub(super) fn new(settings: &BrakeSettings, tick_rate: f32) -> Self {
        let turns = |time: f32| {
            let exact = time * tick_rate * (SLICES_OF_BRAKES as f32 / TIME_SLICES as f32);
            // `as` cuts: one more turn, and one that has begun.
            if exact > 0.0 { exact as u32 + 2 } else { 0 }
        };
        let (falling, no_torque) = (turns(FALLING_TIME), turns(TESTING_TIME));
        Self {
            phase: Phase::Engaged,
            share: 1.0,
            ending: None,
            verdict: None,
            release_turns: turns(settings.release_time),
            engage_turns: turns(settings.engage_time),
            test_turns: falling + no_torque,
            no_torque_turns: no_torque,
            per_falling_turn: 1.0 / falling as f32,
        }
    }

    /// Whether the brakes are to be engaged.
    #[inline(always)]
    pub(super) fn is_on(&self) -> bool {
        match self.phase {
            Phase::Engaged | Phase::Engages(_) | Phase::IsTested(..) => true,
            Phase::Releases(_) | Phase::Free => false,
        }
    }

    /// Whether the arm may move: the brakes are free, and stay so.
    #[inline(always)]
    pub(super) fn lets_move(&self) -> bool {
        self.phase == Phase::Free && self.ending.is_none()
    }

    /// Whether a crossing may begin: it waits for the bridges to be awake, and for no brakes.
    pub(super) fn lets_cross(&self) -> bool {
        let frees_itself = self.release_turns == 0;
        (frees_itself || self.phase == Phase::Free) && self.ending.is_none()
    }

    /// Whether the bridges go off as soon as the brakes have engaged.
    pub(super) fn is_ending(&self) -> bool {
        self.ending.is_some()
    }

    /// The bridges are off.
    #[inline(always)]
    pub(super) fn lose_power(&mut self) {
        self.phase = Phase::Engaged;
        self.stay_powered();
    }

    /// The bridges stay on, with their whole torques.
    #[inline(always)]
    pub(super) fn stay_powered(&mut self) {
        self.ending = None;
        self.verdict = None;
        self.share = 1.0;
    }

    /// What the test of the brakes has found in the tick before, once.
    #[inline(always)]
    pub(super) fn take_verdict(&mut self) -> Option<Verdict> {
        self.verdict.take()
    }

    /// The bridges are awake: releases the brakes.
    pub(super) fn release(&mut self) {
        self.phase = if self.release_turns == 0 {
            Phase::Free
        } else {
            Phase::Releases(self.release_turns)
        };
    }

    /// Engages the brakes, for another turn. True when they hold.
    fn engage(&mut self) -> bool {
        match self.phase {
            Phase::Releases(_) | Phase::Free => self.phase = Phase::Engages(self.engage_turns),
            Phase::Engages(turns) => self.phase = Phase::Engages(turns.saturating_sub(1)),
            Phase::Engaged | Phase::IsTested(..) => {}
        }
        matches!(
            self.phase,
            Phase::Engages(0) | Phase::Engaged | Phase::IsTested(..)
        )
    }

    /// Whether the arm is switched off only when its brakes have engaged.
    pub(super) fn takes_time(&self) -> bool {
        self.engage_turns > 0
    }

    /// Whether the brakes are about to be free, in a tick of an arm without a position to hold.
    pub(super) fn still_releases(&mut self, ticks: u32) -> bool {
        if is_brakes_turn(ticks) {
            self.count_release();
        }
        matches!(self.phase, Phase::Releases(_))
    }

    /// Engages the brakes, in a tick of an arm without a position to hold. True when they hold.
    pub(super) fn engages(&mut self, ticks: u32) -> bool {
        !self.takes_time() || is_brakes_turn(ticks) && self.engage()
    }

    /// Goes on to release the brakes.
    fn count_release(&mut self) {
        if let Phase::Releases(turns) = self.phase {
            self.phase = match turns {
                0 => Phase::Free,
                _ => Phase::Releases(turns - 1),
            };
        }
    }

    /// One turn of the test of brakes that hold a resting arm with these angles [rad], before this event.
    fn test(&mut self, angles: [f32; 2], event: Event) {
        let Phase::IsTested(turns, before) = self.phase else {
            self.phase = Phase::IsTested(self.test_turns, angles);
            return;
        };
        let ([angle1, angle4], [before1, before4]) = (angles, before);
        if Scalar::abs(angle1 - before1) > BRAKE_PLAY || Scalar::abs(angle4 - before4) > BRAKE_PLAY
        {
            self.verdict = Some(Verdict::Fails);
            return;
        }
        if turns == 0 {
            self.verdict = Some(Verdict::Holds(event));
            return;
        }
        let falling = turns.saturating_sub(self.no_torque_turns);
        self.share = falling as f32 * self.per_falling_turn;
        self.phase = Phase::IsTested(turns - 1, before);
    }

    /// Takes the drives' power in the next tick, if the test is where no torque is left.
    fn go_on_without_power(&mut self) {
        let is_tested = matches!(self.phase, Phase::IsTested(..));
        if is_tested && self.share <= 0.0 && self.verdict.is_none() {
            self.verdict = Some(Verdict::Unpowered);
        }
    }
}

/// What the test of the brakes finds.
#[derive(Clone, Copy)]
pub(super) enum Verdict {
    /// Nothing yet: the next tick takes the drives' power.
    Unpowered,
    /// They hold the arm: this event switches the bridges off.
    Holds(Event),
    /// They do not.
    Fails,
}

impl<D: Drives> ArmController<D> {
    /// Whether the bridges hold the arm until the brakes do. While they wake up, the brakes hold still.
    fn waits_for_brake(&self) -> bool {
        self.brake.takes_time()
            && self.waking == 0
            && match self.state {
                State::Armed
                | State::Running
                | State::Stopping
                | State::Compliant
                | State::Homing => true,
                State::Fault => self.controlled_stop,
                State::Stopped | State::Exciting | State::Crossing => false,
            }
    }

    /// Gives an event that switches the bridges off to the state machine: at once, or when the brakes
    /// have engaged. An arm that moves along its path stops first.
    ///
    /// # Errors
    /// The present state, unchanged, if it does not accept the event.
    // Inlined, so that each event compiles to its own case: a tick calls it, or waits for it.
    #[inline(always)]
    pub(super) fn switch_off(&mut self, event: Event) -> Result<(), State> {
        if !self.waits_for_brake() {
            return self.dispatch(event);
        }
        self.state.after(event).ok_or(self.state)?;
        match self.state {
            // Both accept this event.
            State::Running | State::Compliant => self.dispatch(Event::Stop)?,
            // A path that waits for the brakes is not begun.
            State::Armed => self.forget_path(),
            State::Stopping
            | State::Homing
            | State::Fault
            | State::Stopped
            | State::Exciting
            | State::Crossing => {}
        }
        self.brake.ending = Some(event);
        Ok(())
    }

    /// The arm is to be held, not switched off: what waits for the brakes is dropped, and they are
    /// released.
    pub(super) fn stay_armed(&mut self) {
        if self.state == State::Armed && self.brake.is_ending() {
            self.brake.stay_powered();
            self.brake.release();
        }
    }

    /// The brakes' turn, in which an arm that nobody commands is switched off.
    #[inline(always)]
    pub(super) fn turn_brake(&mut self) {
        match self.brake.ending {
            Some(event) => self.end_under_brake(event),
            None if self.abandoned() => self.abandon(),
            None => self.brake.count_release(),
        }
    }

    /// Nobody commands the arm: switches it off.
    #[cold]
    #[inline(never)]
    fn abandon(&mut self) {
        // A silent host is a fault long before, which drops a path that waits and stops an arm that moves.
        if self.moves() {
            return;
        }
        let failed = self.latched.as_ref().map(|latched| latched.fault) == Some(Fault::BrakeFailed);
        if failed || !self.waits_for_brake() {
            self.pending_off = Some(Fault::CommandTimeout);
        } else {
            self.brake.ending = Some(Event::Fault);
        }
    }

    /// One turn of an arm that is to be switched off.
    #[cold]
    #[inline(never)]
    fn end_under_brake(&mut self, event: Event) {
        let rests = match self.state {
            State::Armed => true,
            State::Fault => !self.moves_under_fault(),
            State::Homing => self.homing.iter().all(|state| state.rate == 0.0),
            State::Running | State::Stopping | State::Compliant => false,
            State::Stopped | State::Exciting | State::Crossing => {
                return self.brake.stay_powered();
            }
        };
        if !rests || !self.brake.engage() {
            return;
        }
        let follows_motion = matches!(D::NEEDS, Needs::Motion);
        if follows_motion && self.drives.unpowered_place() == UnpoweredPlace::Lost {
            self.brake.verdict = Some(Verdict::Holds(event));
            return;
        }
        self.brake.test(self.angles(), event);
        if follows_motion {
            self.brake.go_on_without_power();
        }
    }

    /// The tick after the test of the brakes, or one of the test without power: it has no reference, and no turn
    /// but that of the brakes. Arms that the brakes do not hold keep the duties of the tick before.
    #[cold]
    #[inline(never)]
    pub(super) fn end_test(
        &mut self,
        verdict: Verdict,
        sample: &ArmSample<D::Sample>,
    ) -> ArmCommand<D::Command> {
        let event = match verdict {
            Verdict::Holds(event) => event,
            Verdict::Unpowered => {
                self.release_loops();
                self.drives.rest(&sample.drives);
                if is_brakes_turn(self.ticks) {
                    self.turn_brake();
                }
                self.brake.go_on_without_power();
                return self.off();
            }
            Verdict::Fails => {
                self.hold_without_brake();
                return ArmCommand {
                    drives: self.drives.command(),
                    enable: [true; 2],
                    brake: self.brake.is_on(),
                    tool: self.path.tool_output(),
                };
            }
        };
        let ended = match event {
            Event::Homed => self.finish_homing(),
            Event::Fault => Err(Fault::CommandTimeout),
            // The state accepts it: it did when it was given.
            event => self.dispatch(event).map_err(|_| Fault::CommandTimeout),
        };
        match ended {
            Ok(()) => self.unpowered(),
            Err(fault) => self.power_off(fault),
        }
        self.off()
    }

    /// The brakes do not hold the arm: the bridges do, until the emergency stop. An arm whose angles
    /// are not known can only be switched off.
    #[cold]
    fn hold_without_brake(&mut self) {
        self.brake.phase = Phase::Engages(0);
        self.brake.stay_powered();
        match self.state {
            State::Armed | State::Fault => {
                if let Needs::Motion = D::NEEDS {
                    // Where the motor takes the falling rotor up: a jump to where it was could lose it.
                    self.setpoint = Setpoint::hold(Vector2::units(self.counted()));
                }
                self.begin_controlled_stop(Fault::BrakeFailed);
            }
            State::Homing => match self.hold_where_found() {
                Ok(()) => self.begin_controlled_stop(Fault::BrakeFailed),
                Err(_) => self.pending_off = Some(Fault::BrakeFailed),
            },
            // They are not ended under the brakes.
            State::Stopped
            | State::Running
            | State::Stopping
            | State::Exciting
            | State::Crossing
            | State::Compliant => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_power_the_brakes_are_engaged_and_nothing_waits_for_them() {
        let settings = BrakeSettings {
            engage_time: 0.04,
            release_time: 0.05,
        };
        let mut brake = HoldingBrake::new(&settings, 1e4);
        brake.phase = Phase::Free;
        brake.ending = Some(Event::Disarm);
        brake.verdict = Some(Verdict::Fails);
        brake.share = 0.5;
        brake.lose_power();
        assert!(brake.is_on() && !brake.lets_move());
        assert!(!brake.is_ending() && brake.take_verdict().is_none());
        assert_eq!(brake.share, 1.0);
    }
}
