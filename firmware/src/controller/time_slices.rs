//! What ticks do in turns, each at its end one part of it.
//!
//! Motors warm within seconds, a host is silent for tenths of a second, and a change of state or of
//! gains may come some ticks later. So each of these is done in one of eight or sixteen
//! ticks, and the longest tick holds one of them.

use super::ArmController;
use super::encoder::Scale;
use super::joint::Joint;
use super::model::AxisModel;
use crate::drives::{Drives, WATCHED_EVERY};
use crate::io::ArmSample;
use crate::safety::{Limits, State};
use fivebar_kinematics::five_bar::Joint as Driven;

/// Ticks in which each turn comes once; what concerns the path comes twice.
pub(super) const TIME_SLICES: u32 = WATCHED_EVERY;

/// Ticks from a fault on the path to the beginning of the stop, at most.
pub(super) const REACTION: u32 = TIME_SLICES / 2 + 2;

const _: () = assert!(REACTION <= crate::safety::NOTICED_WITHIN + 1);

impl<D: Drives> ArmController<D> {
    /// This tick's turn.
    #[inline(always)]
    pub(super) fn run_time_slice(&mut self, sample: &ArmSample<D::Sample>) {
        match self.ticks % TIME_SLICES {
            0 => {
                self.watch_motor(Driven::Joint1);
                self.compare_pulse(0);
            }
            8 => {
                self.watch_motor(Driven::Joint4);
                self.compare_pulse(1);
            }
            1 | 9 => self.end_path(),
            2 => self.change_gains(Driven::Joint1),
            10 => self.change_gains(Driven::Joint4),
            3 | 11 => {
                self.correct_encoder(0, Joint::set_scale);
                self.learn_inertia();
            }
            4 | 12 => {
                self.pending_stop = self.stopping_fault();
                self.turn_brake();
            }
            5 | 13 => self.begin_pending_stop(),
            6 | 14 => self.latch_pending_stop(),
            7 => {
                self.correct_encoder(1, Joint::set_scale);
                self.compare_switch(0, sample);
            }
            15 => {
                self.correct_encoder(1, Joint::set_scale);
                self.compare_switch(1, sample);
            }
            // There is no other number, so the machine code has no comparison for it.
            _ => {}
        }
    }

    /// Keeps the motors' heat, and the correction of the encoders, in a tick without power.
    pub(super) fn cool(&mut self) {
        match self.ticks % TIME_SLICES {
            0 => self.warm(Driven::Joint1),
            8 => self.warm(Driven::Joint4),
            3 | 11 => self.correct_encoder(0, Joint::shift_to_scale),
            7 | 15 => self.correct_encoder(1, Joint::shift_to_scale),
            _ => {}
        }
    }

    /// Corrects an encoder with a known error where it is now.
    #[inline(always)]
    fn correct_encoder(
        &mut self,
        index: usize,
        set: impl FnOnce(&mut Joint, &mut AxisModel, Scale),
    ) {
        let (Some(Some(encoder)), Some(joint), Some(axis)) = (
            self.encoders.get_mut(index),
            self.joints.get_mut(index),
            self.model.axes.get_mut(index),
        ) else {
            return;
        };
        if let Some(scale) = encoder.scale(joint.turned()) {
            set(joint, axis, scale);
        }
    }

    /// Lets the drives learn the arm's inertia by the errors of this tick.
    #[inline(always)]
    fn learn_inertia(&mut self) {
        if !self.limits.contains(Limits::TORQUE) {
            self.drives.learn_inertia(self.error);
        }
    }

    /// Looks for a joint's loop that oscillates, and for a motor that is too hot: the next tick switches it off.
    #[inline(always)]
    fn watch_motor(&mut self, joint: Driven) {
        if let Some(fault) = self.drives.watch_loop(joint) {
            self.pending_off = Some(fault);
        }
        self.warm(joint);
    }

    /// Advances a motor's heat by all turns at its current. The next tick switches off a motor that
    /// is too hot.
    #[inline(always)]
    fn warm(&mut self, joint: Driven) {
        if let Some(fault) = self.drives.watch_heat(joint) {
            self.pending_off = Some(fault);
        }
    }

    /// Ends a path or a stop where this tick has reached its end. An arm that comes to rest needs no
    /// stop.
    #[inline(always)]
    fn end_path(&mut self) {
        if self.at_rest {
            self.at_rest = false;
            self.pending_stop = None;
            self.come_to_rest();
        }
    }

    /// Begins the stop for that fault, and switches the tool off.
    #[inline(always)]
    fn begin_pending_stop(&mut self) {
        if self.pending_stop.is_some() && self.moves() {
            self.path.brake();
        }
    }

    /// Latches the fault, unless the arm has been stopped since.
    #[inline(always)]
    fn latch_pending_stop(&mut self) {
        if let (Some(fault), true) = (self.pending_stop.take(), self.moves()) {
            self.latch_stop(fault);
        }
    }

    /// Whether the arm moves on a path, or gives way.
    #[inline(always)]
    pub(super) fn moves(&self) -> bool {
        match self.state {
            State::Running | State::Stopping | State::Compliant => true,
            State::Stopped
            | State::Homing
            | State::Exciting
            | State::Crossing
            | State::Armed
            | State::Fault => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::safety::Fault;
    use crate::settings::Settings;
    use crate::{Controller, SensorSample};
    use fivebar_kinematics::five_bar::Joint;

    /// The turns of so many ticks, with this current set-point [A] of one joint.
    fn run(controller: &mut Controller, joint: Joint, ticks: u32, demand: impl Fn(u32) -> f32) {
        for tick in 0..ticks {
            controller.ticks = tick;
            *controller.drives.demand_mut(joint) = demand(tick);
            controller.run_time_slice(&SensorSample::default());
        }
    }

    #[test]
    fn a_constant_current_is_no_oscillation_however_great() {
        for joint in Joint::ALL {
            let mut controller = Controller::new(&Settings::BENCHTOP.check().unwrap());
            run(&mut controller, joint, 16_000, |_| 4.0);
            assert_eq!(controller.pending_off, None, "{joint}");
        }
    }

    #[test]
    fn the_oscillation_of_either_joint_is_found_and_forgotten_with_the_power() {
        for joint in Joint::ALL {
            let mut controller = Controller::new(&Settings::BENCHTOP.check().unwrap());
            let swings = |tick| if tick / 8 % 2 == 0 { 4.0 } else { -4.0 };
            run(&mut controller, joint, 16_000, swings);
            let found = controller.pending_off.take();
            assert_eq!(found, Some(Fault::Oscillation), "{joint}");
            controller.drives.release();
            run(&mut controller, joint, 160, |_| 0.0);
            assert_eq!(controller.pending_off, None, "{joint}");
        }
    }
}
