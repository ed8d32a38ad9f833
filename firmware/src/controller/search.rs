//! The tick while homing: each joint by itself follows its search at limited torque.

use super::request::Refusal;
use super::{Controller, Demand};
use crate::homing::Search;
use crate::io::Sensed;
use crate::safety::{Event, Fault, Limits};
use fivebar_kinematics::Vec2;

impl Controller {
    /// Begins to look for the switches.
    pub(super) fn home(&mut self) -> Result<(), Refusal> {
        self.apply(Event::Home)?;
        self.homed = false;
        self.searches = self.angles().map(Search::new);
        Ok(())
    }

    /// One tick of the search: the torques, or `None` when it has ended.
    pub(super) fn search(&mut self, sensed: &Sensed) -> Option<Demand> {
        match self.seek(sensed) {
            Ok(torque) => Some(Demand {
                torque,
                limits: Limits::NONE,
            }),
            Err(fault) => {
                self.latch(fault);
                None
            }
        }
    }

    fn seek(&mut self, sensed: &Sensed) -> Result<[f32; 2], Fault> {
        if self.is_unheard() {
            return Err(Fault::CommandTimeout);
        }
        let mut torque = [0.0; 2];
        let model = &self.model;
        let joints = self.joints.iter_mut().zip(&model.axes);
        let searches = self.searches.iter_mut().zip(&model.search_plans);
        let inputs = sensed.home.into_iter().zip(model.nominal_inertia);
        let outputs = torque.iter_mut().zip(&mut self.error);
        for ((((joint, axis), (search, plan)), (closed, inertia)), (torque, error)) in
            joints.zip(searches).zip(inputs).zip(outputs)
        {
            search
                .step(plan, closed, joint.angle(), joint.counts(), model.period)
                .map_err(|_| Fault::Envelope)?;
            *error = search.angle - joint.angle();
            let rate = search.rate - joint.velocity();
            let alpha = model
                .position_loop
                .acceleration(joint.integral, 0.0, *error, rate);
            let demanded = inertia * alpha + axis.friction.torque(search.rate);
            *torque = limited(demanded, axis.homing_torque);
        }
        if self.model.monitor.lost_its_path(self.error) {
            return Err(Fault::FollowingError);
        }
        let [search1, search4] = &self.searches;
        if let (Some(counts1), Some(counts4)) = (search1.found(), search4.found()) {
            self.finish([counts1, counts4])?;
        }
        Ok(torque)
    }

    /// Both switches are found: the angles are absolute from now on, if they belong to an
    /// arm on the branch of the settings.
    fn finish(&mut self, counts: [i32; 2]) -> Result<(), Fault> {
        for (((joint, axis), settings), counts) in self
            .joints
            .iter_mut()
            .zip(&self.model.axes)
            .zip(&self.settings.axes)
            .zip(counts)
        {
            joint.set_origin(axis, counts, settings.home_angle);
        }
        let [u1, u4] = self.angles().map(Vec2::unit);
        let geometry = self.model.tool.geometry();
        let pose = geometry
            .forward_from_directions(u1, u4, self.model.assembly)
            .map_err(|_| Fault::EncoderDisagreement)?;
        if pose.working_mode() != self.settings.working_mode() {
            return Err(Fault::EncoderDisagreement);
        }
        self.homed = true;
        self.happen(Event::Homed);
        Ok(())
    }
}

/// `value` brought within ±`limit`; NaN stays NaN.
fn limited(value: f32, limit: f32) -> f32 {
    if value > limit {
        limit
    } else if value < -limit {
        -limit
    } else {
        value
    }
}
