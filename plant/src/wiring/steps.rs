//! The wires between a board that makes steps, or pulses of servos, and what turns by them.

use super::{Wiring, exchange};
use fivebar_kinematics::five_bar::Joint;

/// The wires with their mistakes. A board counts the steps that it makes, whatever becomes of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct StepWires {
    wiring: Wiring,
    /// Steps that the board has made for each joint.
    ordered: [i64; 2],
    /// Steps that have reached each motor, and how far it turned by them, in the robot file's steps; since the wiring is
    /// as it is.
    received: [i64; 2],
    turned: [i64; 2],
}

impl StepWires {
    /// Wires them like this from now on.
    pub(crate) fn rewire(&mut self, wiring: &Wiring) {
        self.wiring = *wiring;
        (self.received, self.turned) = ([0; 2], [0; 2]);
    }

    /// By how many steps of the robot file each motor turns when the board makes these for the joints.
    pub(crate) fn turn(&mut self, ordered: [i32; 2]) -> [i32; 2] {
        let received = exchange(ordered, self.wiring.motors_swapped);
        Joint::ALL.map(|j| {
            self.ordered[j] += i64::from(ordered[j]);
            self.received[j] += i64::from(received[j]);
            let turned = self.received[j] as f64 / self.wiring.microsteps[j];
            let turned = match self.wiring.motor_reversed[j] {
                true => -turned.round() as i64,
                false => turned.round() as i64,
            };
            (turned - std::mem::replace(&mut self.turned[j], turned)) as i32
        })
    }

    /// Which motors get power when the board enables these.
    pub(crate) fn enabled(&self, enable: [bool; 2]) -> [bool; 2] {
        let enable = exchange(enable, self.wiring.motors_swapped);
        Joint::ALL.map(|j| {
            let enable = enable[j] != self.wiring.enable_inverted[j];
            enable && !self.wiring.enable_dead[j] && !self.wiring.signal_dead[j]
        })
    }

    /// The board's count of its steps, which has 32 bits.
    pub(crate) fn counted(&self) -> [i32; 2] {
        self.ordered.map(|steps| steps as i32)
    }

    /// What a driver makes of its current's set-points for both phases [A].
    #[inline]
    pub(crate) fn phases(&self, joint: Joint, [a, b]: [f64; 2]) -> [f64; 2] {
        let share = self.wiring.current_share[joint];
        let [a, b] = [share * a, share * b];
        if self.wiring.phases_crossed[joint] {
            // Both phases get half of the difference of both bridges, in opposite directions.
            let half = 0.5 * (a - b);
            return [half, -half];
        }
        [a, b]
    }

    /// The supply's voltage over that of the robot file.
    pub(crate) fn supply_share(&self) -> f64 {
        self.wiring.supply_share
    }
}

#[cfg(test)]
mod tests {
    use super::StepWires;
    use crate::wiring::Wiring;

    #[test]
    fn parts_of_steps_are_kept_and_the_board_counts_its_own() {
        let mut wires = StepWires::default();
        assert_eq!(wires.turn([5, -5]), [5, -5]);
        wires.rewire(&Wiring {
            microsteps: [4.0, 0.5],
            motor_reversed: [false, true],
            ..Wiring::default()
        });
        let mut turned = [0, 0];
        for _ in 0..40 {
            let [one, other] = wires.turn([3, 1]);
            turned = [turned[0] + one, turned[1] + other];
        }
        assert_eq!(turned, [30, -80]);
        assert_eq!(wires.counted(), [125, 35]);
    }
}
