//! The tick while homing: each joint searches for its own switch, stop or index pulse, at limited
//! torque; or the angles are known without a motion.

use super::ArmController;
use super::homing_state::{HomingConfig, HomingState, limited};
use super::index_check::Landmarks;
use super::joint::Joint;
use super::model::{AxisModel, Model};
use super::setpoint::Setpoint;
use super::tick::TorqueCommand;
use crate::drives::{Drives, Needs, UnpoweredPlace};
use crate::io::ArmSample;
use crate::safety::{Event, Fault, Limits};
use crate::settings::{AxisSettings, HomingMethod};
use core::f32::consts::TAU;
use fivebar_kinematics::five_bar::Pose;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

impl<D: Drives> ArmController<D> {
    /// Entry of Homing: both joints start their search at their present angles, unless their counts
    /// at the home angles are known.
    pub(super) fn start_homing(&mut self) {
        self.homed = false;
        self.homed_by_index = false;
        self.homing = match self.settings.home_reference.method {
            HomingMethod::Switch | HomingMethod::Index | HomingMethod::HardStop => {
                self.angles().map(HomingState::new)
            }
            HomingMethod::Given => self
                .joints
                .each_ref()
                .map(|joint| HomingState::known(joint.angle(), joint.counts())),
            HomingMethod::Absolute => {
                let ([joint1, joint4], [axis1, axis4]) = (&self.joints, &self.settings.axes);
                [(joint1, axis1), (joint4, axis4)].map(|(joint, axis)| {
                    HomingState::known(joint.angle(), home_counts(axis, joint.counts()))
                })
            }
        };
    }

    /// One tick of homing: the torques; none if it has ended homing.
    #[inline(always)]
    pub(super) fn home(
        &mut self,
        sample: &ArmSample<D::Sample>,
    ) -> Result<Option<TorqueCommand>, Fault> {
        if self.host_timed_out() {
            return Err(Fault::CommandTimeout);
        }
        let moves = self.brake.lets_move();
        let Model {
            axes: [axis1, axis4],
            nominal_inertia: [inertia1, inertia4],
            home_gravity: [gravity1, gravity4],
            homing_configs: [config1, config4],
            period,
            ..
        } = &self.model;
        let [joint1, joint4] = &self.joints;
        let [state1, state4] = &mut self.homing;
        let ([closed1, closed4], [index1, index4]) = (sample.home, sample.index);
        let [current1, current4] = self.drives.report().current;
        let read = |closed, index, current| {
            moves.then_some(Landmark {
                closed,
                index,
                current,
            })
        };
        let searched1 = SearchedJoint {
            joint: joint1,
            axis: axis1,
            inertia: *inertia1,
            gravity: *gravity1,
            config: config1,
        };
        let searched4 = SearchedJoint {
            joint: joint4,
            axis: axis4,
            inertia: *inertia4,
            gravity: *gravity4,
            config: config4,
        };
        let (error1, torque1) = searched1.step(*period, state1, read(closed1, index1, current1))?;
        let (error4, torque4) = searched4.step(*period, state4, read(closed4, index4, current4))?;
        if let Needs::Motion = D::NEEDS {
            let [state1, state4] = &self.homing;
            self.setpoint = Setpoint {
                direction: Vector2::units([state1.angle, state4.angle]),
                omega: [state1.rate, state4.rate],
                alpha: [0.0; 2],
            };
        }
        self.error = [error1, error4];
        let [most1, most4] = self.model.homing_error;
        if Scalar::abs(error1) > most1 || Scalar::abs(error4) > most4 {
            return Err(Fault::FollowingError);
        }
        if moves && self.homing.iter().all(|state| state.found().is_some()) {
            if self.drives.unpowered_place() == UnpoweredPlace::Lost {
                return self.hold_when_homed().map(Some);
            }
            if !self.brake.takes_time() {
                self.finish_homing()?;
                return Ok(None);
            }
            // Homing accepts this event.
            let _ = self.switch_off(Event::Homed);
        }
        Ok(Some(TorqueCommand {
            torque: [torque1, torque4],
            limits: Limits::empty(),
        }))
    }

    /// Ends homing of an arm that only power keeps where it is: as soon as it rests it is held there, armed.
    fn hold_when_homed(&mut self) -> Result<TorqueCommand, Fault> {
        if self.homing.iter().all(|state| state.rate == 0.0) {
            self.hold_where_found()?;
            // Homing accepts this event.
            let _ = self.dispatch(Event::Finish);
        }
        Ok(TorqueCommand {
            torque: [0.0; 2],
            limits: Limits::empty(),
        })
    }

    /// The set-point of an arm that is homed, and held where it is.
    pub(super) fn hold_where_found(&mut self) -> Result<(), Fault> {
        let pose = self.use_found_angles()?;
        self.homed = true;
        self.mode = self.settings.working_mode();
        self.setpoint = Setpoint::hold([pose.u1, pose.u4]);
        Ok(())
    }

    /// Ends homing. The angles are absolute from now on, if a pose on the branch of the settings has
    /// them.
    pub(super) fn finish_homing(&mut self) -> Result<(), Fault> {
        self.use_found_angles()?;
        self.homed = true;
        // Homing accepts this event.
        let _ = self.dispatch(Event::Homed);
        Ok(())
    }

    /// Counts the joints' angles from where they were found. Returns the arm's pose.
    fn use_found_angles(&mut self) -> Result<Pose<f32>, Fault> {
        let [state1, state4] = &self.homing;
        let (Some(counts1), Some(counts4)) = (state1.found(), state4.found()) else {
            return Err(Fault::Envelope);
        };
        for ((((joint, axis), encoder), settings), counts) in self
            .joints
            .iter_mut()
            .zip(&self.model.axes)
            .zip(&mut self.encoders)
            .zip(&self.settings.axes)
            .zip([counts1, counts4])
        {
            joint.set_origin(axis, counts, settings.home_angle);
            if let Some(encoder) = encoder {
                encoder.set_origin(settings.home_angle, encoder.shown_at_home);
            }
        }
        self.homed_by_index = self.settings.home_reference.method == HomingMethod::Index;
        self.landmarks.iter_mut().for_each(Landmarks::forget_pulses);
        let [u1, u4] = self.angles().map(Vector2::unit);
        let tool = &self.model.tool;
        let pose = tool
            .geometry()
            .forward_from_directions(u1, u4, self.model.assembly)
            .map_err(|_| Fault::EncoderDisagreement)?;
        if tool.working_mode(&pose) != self.settings.working_mode() {
            return Err(Fault::EncoderDisagreement);
        }
        Ok(pose)
    }
}

/// The counts of an absolute encoder at the home angle: 0, or so many whole turns of the joint that `now`
/// is nearest to the middle of its range.
fn home_counts(axis: &AxisSettings, now: i32) -> i32 {
    let per_turn = axis.encoder_counts as f32 * axis.gear_ratio;
    let [low, high] = axis.angle_limits;
    let middle = 0.5 * (low + high) - axis.home_angle;
    let turns = now as f32 / per_turn - middle / TAU;
    // `as` saturates, and cuts towards 0.
    let whole = (turns + if turns < 0.0 { -0.5 } else { 0.5 }) as i32;
    (whole as f32 * per_turn) as i32
}

/// What shows a joint its home angle.
struct Landmark {
    /// Its switch is pressed.
    closed: bool,
    /// Its encoder shows its index.
    index: bool,
    /// Its motor's current [A], which shows a stop.
    current: f32,
}

/// A joint that looks for its home angle.
struct SearchedJoint<'a> {
    joint: &'a Joint,
    axis: &'a AxisModel,
    /// About which it is driven [kg·m²].
    inertia: f32,
    /// The torque that holds it at its home angle [N·m]: about what gravity takes where it begins, when the brakes
    /// release it.
    gravity: f32,
    config: &'a HomingConfig,
}

impl SearchedJoint<'_> {
    /// One tick of the search, with what shows the home angle: the joint's error [rad] and its torque [N·m].
    /// Without it the joint comes to rest. `period` is that of the tick [s].
    #[inline(always)]
    fn step(
        &self,
        period: f32,
        state: &mut HomingState,
        read: Option<Landmark>,
    ) -> Result<(f32, f32), Fault> {
        let Self {
            joint,
            axis,
            inertia,
            gravity,
            config,
        } = self;
        if let Some(read) = read {
            let closed = match &config.stop {
                None if state.seeks_index() => read.index,
                None => read.closed,
                Some(stop) => stop.is_felt(read.current, joint.velocity()),
            };
            state
                .step(config, closed, joint.angle(), joint.counts(), period)
                .map_err(Fault::from)?;
        } else {
            state.advance(0.0, config, period);
        }
        let error = state.angle - joint.angle();
        let rate = state.rate - joint.velocity();
        let alpha = axis
            .servo
            .position_loop
            .acceleration(joint.integral, 0.0, error, rate);
        let demanded = inertia * alpha + gravity + axis.friction.torque(state.rate);
        Ok((error, limited(demanded, axis.homing_torque)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn an_absolute_encoder_is_taken_in_the_turn_nearest_to_the_middle_of_the_range(
            low in -9.0..9.0_f32,
            width in 1.0..6.0_f32,
            home in -3.0..3.0_f32,
            gear in prop_oneof![Just(30.0_f32), Just(-30.0)],
            now in -100_000..100_000,
        ) {
            let [mut axis, _] = Settings::BENCHTOP.axes;
            (axis.gear_ratio, axis.home_angle) = (gear, home);
            axis.angle_limits = [low, low + width];
            let per_turn = axis.encoder_counts as f32 * gear;
            let counts = home_counts(&axis, now);
            let turns = counts as f32 / per_turn;
            prop_assert!((turns - turns.round()).abs() < 1e-3, "{turns} turns");
            let angle = home + TAU * (now - counts) as f32 / per_turn;
            let away = angle - (low + 0.5 * width);
            prop_assert!(away.abs() < 0.5 * TAU + 0.01, "{away} rad from the middle");
        }
    }
}
