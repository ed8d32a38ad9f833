//! Step and direction: stepper motors that make the micro-steps to their set-points.

use super::load_angle::LoadAngle;
use super::resolution::{Fineness, Resolution};
use super::step_loss::StepLoss;
use super::words::SensedWords;
use super::{DriveReport, Drives, Excitation, Excited, JointState, Needs, Stage, UnpoweredPlace};
use crate::drives::{Demand, Motion};
use crate::safety::Fault;
use crate::settings::{AxisSettings, CheckedSettings, FieldLag, HomingMethod, Settings};
use core::f32::consts::TAU;
use fivebar_kinematics::five_bar::Joint;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// The micro-steps that are made so far, and what they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepSample {
    /// Of each joint; they wrap.
    pub steps: [i32; 2],
    /// Of each joint's motor.
    pub resolution: [Resolution; 2],
}

/// The micro-steps to make until the next tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepCommand {
    /// Of each joint, evenly spread over the tick; positive ones turn the motor forwards.
    pub steps: [i32; 2],
}

/// Both stepper drives of an arm whose motors may have encoders.
pub type StepDrives = StepMotors<true>;

/// Both stepper drives of a board that reads no encoders: without the work that only encoders need.
pub type BlindStepDrives = StepMotors<false>;

/// Both stepper drives, whose motors may have encoders or not. Each makes the micro-steps that lead from where its motor is
/// told to be to the set-point, and the lead of its field by the load.
///
/// Without an encoder, the counts of the sample are the micro-steps made: the controller takes the place that the motor
/// is told, less the lead, for the place where it is, and no check sees a motor that has lost steps. The axis settings
/// are those of an encoder with one count a micro-step.
///
/// A hobby servo is such a motor, too: a micro-step is a unit of the timer that makes its pulse, and a pulse is as long as
/// at the home angle, and by the units made longer. Its field has no stiffness that is known, so nothing leads.
///
/// With an encoder, the joint's angle is what it counts, and [`Fault::StepsLost`] ends a motion in which counts and
/// micro-steps part. The angle stays known, also without power.
///
/// A motor without an encoder and without current is where its load, a hand or the driver's reset puts it, so its place is
/// [`UnpoweredPlace::Lost`]. A hobby servo keeps its place: the counts are the pulse, to which the loop in its case
/// returns when power comes. The settings show it by [`HomingMethod::Absolute`].
#[derive(Clone)]
pub struct StepMotors<const ENCODERS: bool> {
    axes: [Axis<ENCODERS>; 2],
    /// The counts show the angles by themselves.
    is_absolute: bool,
}

/// One joint's motor.
#[derive(Clone)]
struct Axis<const ENCODERS: bool> {
    /// Motor turns per radian of the joint, negative if the motor turns against it.
    turns: f32,
    /// The most motor turns in a tick.
    fastest: f32,
    step_loss: StepLoss,
    load_angle: LoadAngle,
    /// Micro-steps made until this tick.
    made: i32,
    /// Of the motor's sample.
    resolution: Resolution,
    fineness: Fineness,
    /// Micro-steps to make until the next one.
    steps: i32,
    /// The fineness of a motor whose counts are its micro-steps.
    counted: Fineness,
}

/// The joints' speeds that steps are made for, over the greatest speed of the settings: what a set-point that has
/// waited for the drives catches up with.
const MARGIN: f32 = 1.5;

impl<const ENCODERS: bool> Drives for StepMotors<ENCODERS> {
    type Sample = StepSample;
    type Command = StepCommand;

    const NEEDS: Needs = Needs::Motion;
    /// From the enable of a driver until its rotor, which jumps to its field, has swung for some periods.
    const WAKE_UP_TIME: f32 = 0.2;

    fn new(settings: &CheckedSettings) -> Self {
        let ([axis1, axis4], [field1, field4]) = (&settings.axes, &settings.belts);
        let [lag1, lag4] = settings.field_lags;
        let tick_rate = settings.control.tick_rate;
        Self {
            axes: [
                Axis::new(axis1, field1.stiffness, lag1, tick_rate),
                Axis::new(axis4, field4.stiffness, lag4, tick_rate),
            ],
            is_absolute: settings.home_reference.method == HomingMethod::Absolute,
        }
    }

    /// The steps of a tick end at its end.
    fn lag(settings: &Settings, _: Stage) -> f32 {
        1.0 / settings.control.tick_rate
    }

    fn keep_heat(&mut self, _: &Settings, _: &Self, _: &Settings) {}

    fn select(&mut self, _: Joint, _: Stage) {}

    #[inline(always)]
    fn sense(&mut self, sample: &StepSample) {
        let StepSample { steps, resolution } = *sample;
        for ((axis, made), resolution) in self.axes.iter_mut().zip(steps).zip(resolution) {
            axis.made = made;
            if ENCODERS && resolution != axis.resolution {
                axis.take(resolution);
            }
        }
    }

    /// Without an encoder, the micro-steps made less those of the lead.
    #[inline(always)]
    fn counts(&self, [counts1, counts4]: [i32; 2]) -> [i32; 2] {
        let [axis1, axis4] = &self.axes;
        [axis1.counts(counts1), axis4.counts(counts4)]
    }

    fn drive_fault(&self) -> Option<Fault> {
        None
    }

    fn supply_fault(&self) -> Option<Fault> {
        None
    }

    /// Steps that a motor has lost, as its encoder shows.
    #[inline(always)]
    fn contradiction(&mut self, joints: [JointState; 2]) -> Option<Fault> {
        let [axis1, axis4] = &mut self.axes;
        let [joint1, joint4] = joints.map(|joint| joint.counts);
        // Both, in every tick.
        let faults = [axis1.fault(joint1), axis4.fault(joint4)];
        faults.into_iter().flatten().next()
    }

    #[inline(always)]
    fn drive(&mut self, demand: &Demand) -> bool {
        let [axis1, axis4] = &mut self.axes;
        let [counted1, counted4] = demand.counted;
        let Motion {
            direction: [direction1, direction4],
            velocity: [omega1, omega4],
            ..
        } = demand.motion;
        // The torque of another motion is that of a loop, which sees each micro-step.
        let loads = demand
            .torque
            .map(|torque| demand.keeps_to_motion.then_some(torque));
        let [load1, load4] = loads;
        let limited1 = axis1.drive(counted1, direction1, omega1, load1);
        let limited4 = axis4.drive(counted4, direction4, omega4, load4);
        limited1 || limited4
    }

    #[inline(always)]
    fn sensed_words(&self, sample: &StepSample) -> SensedWords {
        SensedWords {
            joints: sample.steps.map(|steps| steps as u16),
            both: 0,
        }
    }

    #[inline(always)]
    fn told_words(&self, command: &StepCommand) -> [u16; 2] {
        command.steps.map(|steps| steps as u16)
    }

    #[inline(always)]
    fn command(&self) -> StepCommand {
        StepCommand {
            steps: self.axes.each_ref().map(|axis| axis.steps),
        }
    }

    /// Steps are whole numbers.
    fn is_finite(&self) -> bool {
        true
    }

    fn rest(&mut self, _: &StepSample) {
        for axis in &mut self.axes {
            axis.step_loss.rest();
        }
    }

    /// Nothing is judged yet.
    fn wake(&mut self, counts: [i32; 2]) {
        for (axis, counts) in self.axes.iter_mut().zip(counts) {
            axis.fault(counts);
        }
    }

    fn unpowered_place(&self) -> UnpoweredPlace {
        let [axis1, axis4] = &self.axes;
        if self.is_absolute || axis1.has_encoder() && axis4.has_encoder() {
            UnpoweredPlace::Kept
        } else {
            UnpoweredPlace::Lost
        }
    }

    fn is_ready(&self) -> bool {
        true
    }

    #[inline(always)]
    fn release(&mut self) {
        for axis in &mut self.axes {
            axis.steps = 0;
        }
    }

    fn watch_heat(&mut self, _: Joint) -> Option<Fault> {
        None
    }

    fn watch_loop(&mut self, _: Joint) -> Option<Fault> {
        None
    }

    /// A driver tells nothing of its motor.
    fn report(&self) -> DriveReport {
        DriveReport::default()
    }

    /// Not known: a stepper takes the torque that its load needs, up to its pull-out torque.
    fn torque(&self, _: [f32; 2]) -> [f32; 2] {
        [0.0; 2]
    }

    fn admits(_: &Settings, _: &Excitation) -> bool {
        false
    }

    fn excite(&mut self, _: Joint, _: Excited, _: f32, _: f32) {}
}

impl<const ENCODERS: bool> Axis<ENCODERS> {
    fn new(axis: &AxisSettings, stiffness: f32, lag: FieldLag, tick_rate: f32) -> Self {
        let turns = axis.gear_ratio * (1.0 / TAU);
        let fastest = MARGIN * axis.max_speed * Scalar::abs(turns) / tick_rate;
        let counted = Fineness::new(Resolution::of_turn(axis.encoder_counts), fastest);
        Self {
            turns,
            fastest,
            step_loss: StepLoss::new(axis.encoder_counts, tick_rate),
            load_angle: LoadAngle::new(axis.gear_ratio, stiffness, lag),
            made: 0,
            resolution: Resolution::default(),
            fineness: counted,
            steps: 0,
            counted,
        }
    }

    /// The sample has another resolution than the one before.
    fn take(&mut self, resolution: Resolution) {
        self.resolution = resolution;
        self.fineness = if self.has_encoder() {
            Fineness::new(resolution, self.fastest)
        } else {
            self.counted
        };
    }

    #[inline(always)]
    fn has_encoder(&self) -> bool {
        ENCODERS && self.resolution.full_steps > 0
    }

    /// Where the micro-steps are the counts, none is lost.
    #[inline(always)]
    fn fault(&mut self, counts: i32) -> Option<Fault> {
        if !self.has_encoder() {
            return None;
        }
        let told = self.made.wrapping_sub(self.load_angle.made());
        self.step_loss.fault(counts, told, &self.fineness)
    }

    #[inline(always)]
    fn counts(&self, counts: i32) -> i32 {
        if self.has_encoder() {
            counts
        } else {
            counts.wrapping_sub(self.load_angle.made())
        }
    }

    /// n = (θd − θ) N/2π + d + l − l₀, rounded, of the set-point θd at the end of the tick, the counted angle θ, the rotor's
    /// distance d before where it is told to be, and the field's lead l for the load [N·m] at this speed, which was l₀ before. What rounding leaves is in the
    /// next tick's difference. True if the speed limits them.
    #[inline(always)]
    fn drive(
        &mut self,
        counted: f32,
        set_point: [f32; 2],
        velocity: f32,
        load: Option<f32>,
    ) -> bool {
        if ENCODERS && velocity != 0.0 {
            self.step_loss.moves();
        }
        let gap = Vector2::unit(counted).cross_z(set_point.into());
        let lead = self.load_angle.wanted(load, velocity, &self.fineness);
        let led = lead - self.load_angle.made() as f32;
        let mut micro_steps = gap * self.turns * self.fineness.per_turn;
        if self.has_encoder() {
            micro_steps += self.step_loss.ahead();
        }
        let (steps, limited) = whole(micro_steps + led, self.fineness.most);
        self.load_angle.make(whole(lead, i32::MAX).0);
        self.steps = steps;
        limited
    }
}

/// The nearest whole number of steps, within ±`most`; true if that limits it. Of what is not a number, none.
#[inline(always)]
fn whole(steps: f32, most: i32) -> (i32, bool) {
    // `as` saturates, and cuts towards 0.
    let rounded = (steps + if steps < 0.0 { -0.5 } else { 0.5 }) as i32;
    // `clamp` could panic.
    let limited = rounded.max(-most).min(most);
    (limited, limited != rounded)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::BeltSettings;

    fn demand(counted: f32, wanted: f32) -> Demand {
        let direction = Vector2::unit(wanted).into();
        Demand {
            torque: [0.0; 2],
            keeps_to_motion: true,
            velocity: [0.0; 2],
            counted: [counted; 2],
            motion: Motion {
                direction: [direction; 2],
                velocity: [0.0; 2],
                acceleration: [0.0; 2],
            },
        }
    }

    /// What drives sense that have made these micro-steps.
    fn made(steps: [i32; 2]) -> StepSample {
        let nema17 = Resolution {
            full_steps: 200,
            microsteps: 16,
        };
        StepSample {
            steps,
            resolution: [nema17; 2],
        }
    }

    #[test]
    fn the_log_tells_the_steps_that_are_made_and_those_to_make() {
        let drives = StepDrives::new(&Settings::BENCHTOP.check().expect("settings"));
        let words = drives.sensed_words(&made([65_537, -2]));
        assert_eq!((words.joints, words.both), ([1, 0xFFFE], 0));
        let told = drives.told_words(&StepCommand { steps: [3, -1] });
        assert_eq!(told, [3, 0xFFFF]);
    }

    #[test]
    fn steps_follow_the_set_point_to_half_a_step_and_never_drift() {
        let mut settings = Settings::BENCHTOP;
        for axis in &mut settings.axes {
            (axis.encoder_counts, axis.gear_ratio) = (3200, 4.0);
        }
        settings.axes[1].gear_ratio = -4.0;
        let settings = settings.check().expect("settings");
        let mut drives = StepDrives::new(&settings);
        let step = TAU / 12_800.0;
        let mut total = [0_i32; 2];
        for tick in 0..200_000_u32 {
            let wanted = 1.2 * (tick as f32 * 5e-4).sin();
            let at = [total[0] as f32 * step, total[1] as f32 * -step];
            drives.sense(&made(total));
            let mut demand = demand(0.0, wanted);
            demand.counted = at;
            assert!(!drives.drive(&demand), "tick {tick}");
            for (total, steps) in total.iter_mut().zip(drives.command().steps) {
                *total += steps;
            }
            for at in [total[0] as f32 * step, total[1] as f32 * -step] {
                assert!(
                    (at - wanted).abs() < 0.51 * step,
                    "tick {tick}: {at} for {wanted}"
                );
            }
        }
    }

    /// A field of 320 N·m/rad at the joint holds 0.4 N·m at the motor, 1.6 N·m at the joint.
    #[test]
    fn a_loaded_rotor_is_at_the_set_point_with_its_field_ahead_of_it() {
        let mut settings = Settings::BENCHTOP;
        for (axis, belt) in settings.axes.iter_mut().zip(&mut settings.belts) {
            (axis.encoder_counts, axis.gear_ratio) = (3200, 4.0);
            *belt = BeltSettings::spring(320.0);
        }
        let settings = settings.check().expect("settings");
        let step = TAU / 12_800.0;
        for encoder in [false, true] {
            let mut drives = StepDrives::new(&settings);
            let (mut total, mut load) = ([0_i32; 2], [0.0_f32; 2]);
            for tick in 0..20_000_u32 {
                // An encoder counts the rotor, which its load holds back.
                let rotors = [0, 1].map(|j: usize| {
                    let held_back = (load[j] / 1.6).asin() / 50.0 / TAU * 3200.0;
                    total[j] as f32 - held_back
                });
                let sample = if encoder {
                    made(total)
                } else {
                    StepSample {
                        steps: total,
                        ..StepSample::default()
                    }
                };
                drives.sense(&sample);
                let counts = drives.counts(if encoder {
                    rotors.map(|rotor| rotor.round() as i32)
                } else {
                    total
                });
                let joint = |counts| JointState {
                    counts,
                    velocity: 0.0,
                    error: 0.0,
                };
                assert_eq!(drives.contradiction(counts.map(joint)), None);
                let angle = tick as f32 * 5e-4;
                let wanted = 1.2 * (angle.sin());
                load = [angle.sin(), -0.9 * angle.cos()];
                let mut demand = demand(0.0, wanted);
                demand.counted = counts.map(|counts| counts as f32 * step);
                demand.torque = load;
                demand.motion.velocity = [1.0; 2];
                drives.drive(&demand);
                for (total, steps) in total.iter_mut().zip(drives.command().steps) {
                    *total += steps;
                }
                for j in [0, 1] {
                    let held_back = (load[j] / 1.6).asin() / 50.0 / TAU * 3200.0;
                    let rotor = (total[j] as f32 - held_back) * step;
                    // The second rotor's load begins with 0.9 N·m, at once: until the swing is calm, an encoder's mean takes it in.
                    if tick > 100 {
                        assert!(
                            (rotor - wanted).abs() < 0.55 * step,
                            "{encoder} {tick}: {rotor} for {wanted}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_load_that_no_motion_needs_changes_no_lead() {
        let mut settings = Settings::BENCHTOP;
        settings.belts = [BeltSettings::spring(320.0); 2];
        let mut drives = StepDrives::new(&settings.check().expect("settings"));
        drives.sense(&StepSample::default());
        let mut demand = demand(0.0, 0.0);
        demand.torque = [0.5; 2];
        demand.keeps_to_motion = false;
        drives.drive(&demand);
        assert_eq!(drives.command(), StepCommand::default());
        demand.keeps_to_motion = true;
        drives.drive(&demand);
        assert_ne!(drives.command(), StepCommand::default());
    }

    #[test]
    fn without_an_encoder_a_turn_has_the_micro_steps_of_the_settings() {
        for counts in [3200, 6400, 51_200, 102_400, 768, 3210] {
            let turn = Fineness::new(Resolution::of_turn(counts), 0.0).per_turn;
            assert_eq!(turn, counts as f32);
        }
        assert_eq!(
            Fineness::new(Resolution::of_turn(65_537), 0.0).per_turn,
            0.0
        );
        let mut settings = Settings::BENCHTOP;
        for axis in &mut settings.axes {
            (axis.encoder_counts, axis.gear_ratio) = (3200, 4.0);
        }
        let mut drives = StepDrives::new(&settings.check().expect("settings"));
        drives.sense(&StepSample::default());
        drives.drive(&demand(0.0, 1e-3));
        // 1e-3 · 12800/2π = 2.04.
        assert_eq!(drives.command().steps, [2; 2]);
    }

    #[test]
    fn more_steps_than_a_motor_can_make_are_limited_and_what_is_no_number_is_no_step() {
        let mut drives = StepDrives::new(&Settings::BENCHTOP.check().expect("settings"));
        drives.sense(&made([0; 2]));
        assert!(drives.drive(&demand(0.0, 1.0)));
        let [most, _] = drives.command().steps;
        let axis = &Settings::BENCHTOP.axes[0];
        let fastest = axis.max_speed * 3200.0 * axis.gear_ratio / TAU * 1e-4;
        assert!((1.5 * fastest..1.5 * fastest + 1.0).contains(&(most as f32)));
        assert!(!drives.drive(&demand(f32::NAN, 0.0)));
        assert_eq!(drives.command().steps, [0; 2]);
        drives.drive(&demand(0.0, 0.01));
        drives.release();
        assert_eq!(drives.command(), StepCommand::default());
    }
}
