//! An arm at rest: how the tick finds that it rests, and the gains that it then has.
//!
//! The rest is looked for where the reference rests, before the tick computes its torques: by the
//! errors and accelerations of the tick before. So a tick along a path does none of this work.

use super::Controller;
use super::model::Model;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::control::Integral;

/// Whether the arm rests.
pub(super) struct Rest {
    /// Ticks for which reference and joints have been at rest.
    still: u32,
    /// Sums of the accelerations demanded in these ticks [rad/s²].
    sums: [f32; 2],
    /// The accelerations demanded in the tick before [rad/s²].
    pub(super) demanded: [f32; 2],
}

impl Rest {
    pub(super) fn new() -> Self {
        Self {
            still: 0,
            sums: [0.0; 2],
            demanded: [0.0; 2],
        }
    }

    /// One tick in which the reference rests, after one with these position errors [rad].
    #[inline(always)]
    pub(super) fn look(&mut self, error: [f32; 2], model: &Model) {
        let rests = self.still >= model.rest_ticks;
        let [axis1, axis4] = &model.axes;
        let [error1, error4] = error;
        let near = Scalar::abs(error1) <= axis1.rest_error[usize::from(rests)]
            && Scalar::abs(error4) <= axis4.rest_error[usize::from(rests)];
        if !near {
            return self.move_on();
        }
        if rests {
            return;
        }
        if self.still == 0 {
            self.sums = [0.0; 2];
        }
        let ([sum1, sum4], [alpha1, alpha4]) = (&mut self.sums, self.demanded);
        *sum1 += alpha1;
        *sum4 += alpha4;
        self.still += 1;
    }

    /// The arm does not rest.
    #[inline(always)]
    pub(super) fn move_on(&mut self) {
        self.still = 0;
    }
}

impl Controller {
    /// Gives a joint the gains of an arm that rests, or of one that moves. An arm that begins to
    /// rest goes on with the mean of the accelerations demanded meanwhile: under a load its torque
    /// stays.
    #[inline(always)]
    pub(super) fn change_gains(&mut self, index: usize) {
        let rests = self.rest.still >= self.model.rest_ticks;
        let Some(axis) = self.model.axes.get_mut(index) else {
            return;
        };
        if axis.rests == rests {
            return;
        }
        axis.select_servo(rests);
        if let (true, Some(joint), Some(sum)) =
            (rests, self.joints.get_mut(index), self.rest.sums.get(index))
        {
            joint.integral = Integral(sum * self.model.per_rest_tick);
        }
    }

    /// Gives an arm that is not driven the gains of one that moves.
    pub(super) fn forget_rest(&mut self) {
        self.rest = Rest::new();
        for axis in &mut self.model.axes {
            if axis.rests {
                axis.select_servo(false);
            }
        }
    }
}
