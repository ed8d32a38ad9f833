//! An arm at rest: how the tick finds that it rests, and the gains that it then has.
//!
//! The rest is looked for where the reference rests, before the tick computes its torques: by the
//! errors and accelerations of the tick before. So a tick along a path does none of this work.

use super::ArmController;
use super::model::Model;
use crate::drives::{Drives, Stage};
use fivebar_kinematics::Scalar;
use fivebar_kinematics::control::Integral;
use fivebar_kinematics::five_bar::Joint;

/// Whether the arm rests.
#[derive(Clone)]
pub(super) struct Rest {
    stage: Stage,
    /// Ticks of this stage for which reference and joints have been at rest.
    still: u32,
    /// Sums of the accelerations demanded in these ticks [rad/s²].
    sums: [f32; 2],
    /// The mean accelerations demanded in the stage before [rad/s²].
    means: [f32; 2],
    /// The accelerations demanded in the tick before [rad/s²].
    pub(super) demanded: [f32; 2],
}

impl Rest {
    pub(super) fn new() -> Self {
        Self {
            stage: Stage::Moves,
            still: 0,
            sums: [0.0; 2],
            means: [0.0; 2],
            demanded: [0.0; 2],
        }
    }

    /// One tick in which the reference rests, after one with these position errors [rad].
    #[inline(always)]
    pub(super) fn look(&mut self, error: [f32; 2], model: &Model) {
        let [axis1, axis4] = &model.axes;
        let [error1, error4] = error;
        let near =
            Scalar::abs(error1) <= axis1.rest_error && Scalar::abs(error4) <= axis4.rest_error;
        if !near {
            return self.move_on();
        }
        let next = match self.stage {
            Stage::Moves | Stage::Crosses => Stage::Settles,
            Stage::Settles => Stage::Rests,
            Stage::Rests => return,
        };
        let ([sum1, sum4], [alpha1, alpha4]) = (&mut self.sums, self.demanded);
        *sum1 += alpha1;
        *sum4 += alpha4;
        self.still += 1;
        if self.still >= model.rest_ticks {
            self.means = self.sums.map(|sum| sum * model.per_rest_tick);
            self.begin(next);
        }
    }

    /// The arm does not rest.
    #[inline(always)]
    pub(super) fn move_on(&mut self) {
        self.begin(Stage::Moves);
    }

    #[inline(always)]
    fn begin(&mut self, stage: Stage) {
        self.stage = stage;
        self.still = 0;
        self.sums = [0.0; 2];
    }
}

impl<D: Drives> ArmController<D> {
    /// Gives a joint the gains of the arm's stage. An arm that settles or begins to rest goes on
    /// with the mean of the accelerations demanded meanwhile: under a load its torque stays.
    #[inline(always)]
    pub(super) fn change_gains(&mut self, joint: Joint) {
        let index = joint.index();
        let Rest { stage, means, .. } = self.rest;
        let Some(axis) = self.model.axes.get_mut(index) else {
            return;
        };
        if axis.stage == stage {
            return;
        }
        axis.select_servo(stage);
        self.drives.select(joint, stage);
        if let (Stage::Settles | Stage::Rests, Some(joint), Some(mean)) =
            (stage, self.joints.get_mut(index), means.get(index))
        {
            joint.integral = Integral(*mean);
        }
    }

    /// Gives the arm the gains of one that crosses a singularity, until it moves or settles again.
    pub(super) fn use_crossing_gains(&mut self) {
        self.rest.begin(Stage::Crosses);
        for axis in &mut self.model.axes {
            axis.cross();
        }
        for joint in Joint::ALL {
            self.drives.select(joint, Stage::Crosses);
        }
    }

    /// Gives an arm that is not driven the gains of one that moves.
    pub(super) fn forget_rest(&mut self) {
        self.rest = Rest::new();
        for (joint, axis) in Joint::ALL.into_iter().zip(&mut self.model.axes) {
            if axis.stage != Stage::Moves {
                axis.select_servo(Stage::Moves);
                self.drives.select(joint, Stage::Moves);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Rest, Stage};
    use crate::Controller;
    use crate::settings::Settings;

    fn controller() -> Controller {
        Controller::new(&Settings::BENCHTOP.check().expect("valid settings"))
    }

    #[test]
    fn an_arm_rests_only_when_both_joints_are_near_their_reference() {
        let model = controller().model;
        let [near1, near4] = model.axes.each_ref().map(|axis| axis.rest_error);
        for (error, rests) in [
            ([near1, -near4], true),
            ([2.0 * near1, 0.0], false),
            ([0.0, -2.0 * near4], false),
        ] {
            let mut rest = Rest::new();
            for _ in 0..2 * model.rest_ticks {
                rest.look(error, &model);
            }
            assert_eq!(rest.stage == Stage::Rests, rests, "{error:?}");
        }
    }

    #[test]
    fn an_arm_that_is_switched_off_in_rest_has_the_gains_of_one_that_moves() {
        let mut controller = controller();
        for axis in &mut controller.model.axes {
            axis.select_servo(Stage::Rests);
        }
        controller.forget_rest();
        let stages = controller.model.axes.each_ref().map(|axis| axis.stage);
        assert!(stages == [Stage::Moves; 2]);
    }
}
