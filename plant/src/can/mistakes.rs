//! Mistakes in the wiring of drives on a bus and in their configuration, and defects of a drive that no scenario file names.

use super::plant::{CanPlant, sender};
use crate::wiring::Wiring;
use fivebar_firmware::drives::can::{Frame, Protocol};
use fivebar_kinematics::five_bar::Joint;
use std::f64::consts::TAU;

impl CanPlant {
    /// Wires the arm and sets its drives up like this, once: what is broken by it stays broken.
    pub fn rewire(&mut self, wiring: &Wiring) {
        self.arm.rewire(wiring);
        self.wiring = *wiring;
        let nodes = self.drives.each_ref().map(|drive| drive.drive.node);
        for j in Joint::ALL {
            let other = 1 - j.index();
            if wiring.nodes_swapped != wiring.node_of_other[j] {
                self.give_node(j, nodes[other]);
            }
            let turns = wiring.zero_shift[j] / TAU * self.drives[j].drive.gear_ratio;
            let counts = (turns * self.counts_per_turn[j]).round() as i32;
            self.zero[j] = self.zero[j].wrapping_sub(counts);
            self.torque_factor[j] *= 1.0 + wiring.torque_constant[j];
            self.arm.faults.cut_off[j] |= wiring.bus_dead[j] || wiring.supply_dead[j];
            self.arm.faults.disconnected[j] |= wiring.motor_dead[j] || wiring.supply_dead[j];
        }
    }

    /// Lets a drive's answers come later by a time between these from now on [s].
    pub fn delay_answers(&mut self, joint: Joint, between: [f64; 2]) {
        self.delay[joint] = between;
    }

    /// Lets a drive leave the mode in which it gives torque, without an error.
    pub fn lose_mode(&mut self, joint: Joint) {
        self.drives[joint].lose_mode();
    }

    /// Gives a drive an error that comes back whenever it is cleared.
    pub fn break_drive(&mut self, joint: Joint) {
        self.drives[joint].break_down();
    }

    /// Lets a drive tell its next answers again and again.
    pub fn repeat_answers(&mut self, joint: Joint) {
        self.repeats[joint] = true;
    }

    /// Gives a drive another number on the bus.
    pub fn give_node(&mut self, joint: Joint, node: u8) {
        self.drives[joint].drive.node = node;
    }

    /// The controller receives a frame of this sender, unless it is lost.
    pub(super) fn receive(&mut self, from: usize, frame: Frame) {
        if self.is_bus_off() {
            return;
        }
        let Some(j) = Joint::ALL.into_iter().find(|&j| sender(j) == from) else {
            return self.received.push(frame);
        };
        if self.is_lost(self.wiring.answers_lost[j]) {
            return;
        }
        let old = self.repeated[j].iter().find(|old| old.id == frame.id);
        match old.copied() {
            Some(old) => self.received.push(old),
            None => {
                if self.repeats[j] {
                    self.repeated[j].push(frame);
                }
                self.received.push(frame);
            }
        }
    }

    /// Whether an order does not reach a drive, or not the mode in which it is.
    pub(super) fn misses_order(&mut self, joint: Joint) -> bool {
        // The controller tells an ODrive its mode before it gives torque. MIT-type drives are told none: in another mode
        // they do not know its frames.
        let is_other_mode = self.wiring.mode_wrong[joint] && self.protocol != Protocol::Odrive;
        is_other_mode || self.is_lost(self.wiring.orders_lost[joint])
    }

    /// Whether this share of the frames has this one.
    fn is_lost(&mut self, share: f64) -> bool {
        share > 0.0 && self.noise.uniform() < share
    }

    /// The torque at a joint over that of its drive's shaft, as the drive takes it.
    pub(super) fn torque_per_drive(&self, joint: Joint) -> f64 {
        self.torque_factor[joint] * self.direction(joint) * self.drives[joint].drive.gear_ratio
    }

    /// −1 for a drive that turns the other way, as its encoder does.
    pub(super) fn direction(&self, joint: Joint) -> f64 {
        if self.wiring.motor_reversed[joint] {
            -1.0
        } else {
            1.0
        }
    }
}
