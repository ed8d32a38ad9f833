//! The tick while homing: each joint by itself follows its search at limited torque.

use super::joint::Joint;
use super::model::{AxisModel, Model};
use super::request::Refusal;
use super::{Controller, Demand};
use crate::homing::{Search, SearchPlan, limited};
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
        let model = &self.model;
        let [joint1, joint4] = &self.joints;
        let [axis1, axis4] = &model.axes;
        let [inertia1, inertia4] = model.nominal_inertia;
        let [search1, search4] = &mut self.searches;
        let [plan1, plan4] = &model.search_plans;
        let [closed1, closed4] = sensed.home;
        let (error1, torque1) = sought(model, joint1, axis1, inertia1, search1, plan1, closed1)?;
        let (error4, torque4) = sought(model, joint4, axis4, inertia4, search4, plan4, closed4)?;
        self.error = [error1, error4];
        if self.model.monitor.lost_its_path(self.error) {
            return Err(Fault::FollowingError);
        }
        let [search1, search4] = &self.searches;
        if let (Some(counts1), Some(counts4)) = (search1.found(), search4.found()) {
            self.finish([counts1, counts4])?;
        }
        Ok([torque1, torque4])
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

/// One joint's tick of the search: its error [rad] and its torque [N·m].
#[inline(always)]
fn sought(
    model: &Model,
    joint: &Joint,
    axis: &AxisModel,
    inertia: f32,
    search: &mut Search,
    plan: &SearchPlan,
    closed: bool,
) -> Result<(f32, f32), Fault> {
    search
        .step(plan, closed, joint.angle(), joint.counts(), model.period)
        .map_err(|_| Fault::Envelope)?;
    let error = search.angle - joint.angle();
    let rate = search.rate - joint.velocity();
    let position_loop = &model.position_loop;
    let alpha = position_loop.acceleration(joint.integral, 0.0, error, rate);
    let demanded = inertia * alpha + axis.friction.torque(search.rate);
    Ok((error, limited(demanded, axis.homing_torque)))
}
