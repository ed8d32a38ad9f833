//! Crossing a singularity of type 2, from one assembly mode to the other.
//!
//! The host plans the motion. The planner checks it and makes pieces of it: polynomials of the joints' angles
//! and of the torques. They lie in the queue of the path, which is empty meanwhile. After Pagis, Bouton, Briot and Martinet 2015:
//!
//! | \|sin(θ3−θ2)\| of the measured cranks | torque |
//! |---|---|
//! | above 0.5 | computed torque at the measured state |
//! | 0.1 to 0.5 | both, smoothly from one to the other |
//! | below 0.1 | the plan's, and a PID of the cranks: nothing there divides by the sine |
//!
//! The sum passes a filter of the first order, because computed torque beside the zone makes steps of several
//! mN·m of each count of the encoders. Set-point and measured state are taken so much ahead.
//!
//! θ1 and θ4 are the same in both assembly modes, so the mode is that of the plan until the planner finds in the
//! torques whether it is (`planner/crossing_evidence.rs`). In the zone, below 0.2, the arm
//! goes on whatever its cranks' errors are, because it cannot stop there; an arm that stays there is a fault.

use super::ArmController;
use super::model::CROSSING_LAG;
use super::path::{Path, QUEUED_SEGMENTS};
use super::setpoint::Setpoint;
use super::tick::TorqueCommand;
use crate::drives::Drives;
use crate::safety::{Event, Fault, Limits, State};
use fivebar_kinematics::five_bar::PoseError;
use fivebar_kinematics::trajectory::{Curve, TimeLaw, ToolOutput, TrajectorySegment};
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// |sin(θ3−θ2)| of the zone.
pub(crate) const ZONE: f32 = 0.2;
/// |sin(θ3−θ2)| from which on computed torque acts, too.
const COMPUTED: f32 = 0.1;
/// |sin(θ3−θ2)| from which on it acts alone.
pub(crate) const OUTSIDE: f32 = 0.5;
/// The share of the cranks' PID that is left in the singularity. A count of an encoder then gives little torque
/// where momentum alone carries the arm on.
const LEAST_FEEDBACK: f32 = 0.25;
/// The error of a crank with which an arm at the end of its plan may be in the zone [rad].
const RESTING_ERROR: f32 = 0.01;
/// The longest time in the zone, in times of the plan's.
const TIMEOUT_FACTOR: u32 = 2;
/// Time after the plan in which the arm keeps the gains of a crossing [s].
const SETTLING: f32 = 0.02;
/// The longest time after the plan in which the planner confirms the assembly mode, in times of [`SETTLING`].
const CONFIRMED_WITHIN: u32 = 5;

/// The pieces of a plan; each takes two slots of the queue.
pub(crate) const PIECES: usize = QUEUED_SEGMENTS / 2;

/// What the tick must know of a plan besides its pieces. Times are in ticks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CrossingTimes {
    /// The move's tag.
    pub(crate) tag: u32,
    /// Pieces in a tick.
    pub(crate) rate: f32,
    /// The tick in which the arm changes its assembly mode.
    pub(crate) crosses_at: u32,
    /// The ticks in which the plan is near the singularity.
    pub(crate) near: [u32; 2],
    /// The ticks in which it is in the zone.
    pub(crate) in_zone: u32,
}

/// A crossing, and how far it is.
#[derive(Clone)]
pub(super) struct Crossing {
    times: CrossingTimes,
    /// Pieces in a second.
    per_piece: f32,
    /// 1/(l2 l3) [1/m²]: r2 × r3 over its greatest value is sin(θ3−θ2).
    per_longest_cross: f32,
    /// The change of the share of the cranks' PID in a tick: all of it acts where the plan leaves the zone.
    hardening: f32,
    ticks: u32,
    /// Ticks in the zone so far.
    in_zone: u32,
    /// Ticks since the end of the plan, and those in which the arm settles.
    settling: [u32; 2],
    /// The arm has settled behind its plan.
    is_over: bool,
    /// θ1d, θ4d [rad].
    angle: [f32; 2],
    /// The share of the laws' torques that the demanded ones take in a tick.
    smoothing: f32,
    /// The demanded torques [N·m].
    torque: [f32; 2],
}

/// The cranks in one tick of a crossing, as measured. Pairs are of joint 1 and joint 4.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CrossingSample {
    /// The arm moves behind the singularity.
    pub(crate) is_behind: bool,
    /// It has settled behind its plan.
    pub(crate) is_over: bool,
    /// Ticks since the plan's beginning.
    pub(crate) tick: u32,
    /// θ̂ [rad].
    pub(crate) angle: Vector2<f32>,
    /// ω̂ [rad/s].
    pub(crate) velocity: Vector2<f32>,
    /// By the measured currents [N·m].
    pub(crate) torque: Vector2<f32>,
}

impl Crossing {
    /// The share of the feedback at this tick: by the plan's time, because a count of an encoder changes the
    /// sine by hundredths there.
    #[inline(always)]
    fn feedback(&self) -> f32 {
        let away = self.ticks as f32 - self.times.crosses_at as f32;
        let feedback = LEAST_FEEDBACK + self.hardening * Scalar::abs(away);
        if feedback > 1.0 { 1.0 } else { feedback }
    }

    /// No crossing.
    pub(super) fn none() -> Self {
        Self {
            times: CrossingTimes {
                tag: 0,
                rate: 0.0,
                crosses_at: 0,
                near: [0; 2],
                in_zone: 0,
            },
            per_piece: 0.0,
            per_longest_cross: 0.0,
            hardening: 0.0,
            ticks: 0,
            in_zone: 0,
            settling: [0; 2],
            is_over: false,
            angle: [0.0; 2],
            smoothing: 0.0,
            torque: [0.0; 2],
        }
    }
}

/// A place on a plan.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlanPlace {
    joints: [Vector2<f32>; 6],
    u: f32,
    per_piece: f32,
}

impl PlanPlace {
    /// The set-point there.
    pub(super) fn setpoint(&self) -> Setpoint {
        let [angle, omega, alpha] = joints_on(&self.joints, self.u, self.per_piece);
        Setpoint {
            direction: Vector2::units(angle.into()),
            omega: omega.into(),
            alpha: alpha.into(),
        }
    }
}

/// The share of computed torque at a sine above [`COMPUTED`]: smooth at both ends, so that the torque is, too.
#[inline(always)]
fn computed_share(sine: f32) -> f32 {
    let mut share = (sine - COMPUTED) * (1.0 / (OUTSIDE - COMPUTED));
    if share > 1.0 {
        share = 1.0;
    }
    share * share * (3.0 - 2.0 * share)
}

/// Angles [rad], velocities [rad/s] and accelerations [rad/s²] at a share of a piece, of which `per_piece`
/// pass in a second.
#[inline(always)]
fn joints_on(joints: &[Vector2<f32>; 6], u: f32, per_piece: f32) -> [Vector2<f32>; 3] {
    let [c0, c1, c2, c3, c4, c5] = joints;
    // Horner's scheme thrice over.
    let (p, d) = (c5 * u + c4, *c5);
    let (p, d, e) = (p * u + c3, d * u + p, *c5);
    let (p, d, e) = (p * u + c2, d * u + p, e * u + d);
    let (p, d, e) = (p * u + c1, d * u + p, e * u + d);
    let (p, d, e) = (p * u + c0, d * u + p, e * u + d);
    [p, d * per_piece, e * (2.0 * per_piece * per_piece)]
}

/// The polynomials Σ ck u^k of a pair of values, as a segment: u is the share of its piece.
pub(crate) fn polynomials(coefficients: [[f32; 2]; 6]) -> TrajectorySegment<f32> {
    let curve = Curve::Blend {
        coefficients: coefficients.map(Vector2::from),
        inverse_length: 1.0,
    };
    let even = TimeLaw::new(0.0, 1.0, 0.0, 0.0);
    TrajectorySegment::along(curve, even, 1.0, 0, ToolOutput::constant(0.0))
}

/// The coefficients in a slot of the queue.
#[inline(always)]
fn coefficients(path: &Path, slot: usize) -> Option<&[Vector2<f32>; 6]> {
    match path.stored(slot)?.curve()? {
        Curve::Blend { coefficients, .. } => Some(coefficients),
        Curve::Line { .. } | Curve::Arc { .. } => None,
    }
}

impl<D: Drives> ArmController<D> {
    /// Stores a piece of a crossing's plan where the arm is held and has no path: the joints' angles
    /// [rad], and their torques without friction [N·m].
    pub(crate) fn store_crossing(&mut self, piece: usize, plan: [&TrajectorySegment<f32>; 2]) {
        if self.is_free() {
            let [joints, torques] = plan;
            self.path.store(2 * piece, joints);
            self.path.store(2 * piece + 1, torques);
        }
    }

    /// Begins the crossing whose pieces are stored. False if the arm is not held, or has a path.
    pub(crate) fn begin_crossing(&mut self, path_generation: u32, times: &CrossingTimes) -> bool {
        if !self.is_free() || path_generation != self.path_generation {
            return false;
        }
        let tick_rate = self.settings.control.tick_rate;
        let [_, l2, l3, ..] = self.settings.lengths;
        self.crossing = Crossing {
            per_longest_cross: 1.0 / (l2 * l3),
            hardening: (1.0 - LEAST_FEEDBACK) / (0.5 * times.in_zone as f32).max(1.0),
            smoothing: 1.0 / (1.0 + CROSSING_LAG * tick_rate),
            torque: coefficients(&self.path, 1).map_or([0.0; 2], |[torque, ..]| (*torque).into()),
            times: CrossingTimes {
                // The set-point leads by the lag, and what is reported is in this mode, too.
                crosses_at: times.crosses_at
                    + ((self.model.lag + CROSSING_LAG) * tick_rate) as u32
                    + 1,
                ..*times
            },
            per_piece: times.rate * tick_rate,
            settling: [0, (SETTLING * tick_rate) as u32],
            ..Crossing::none()
        };
        self.use_crossing_gains();
        // Armed accepts this event.
        self.dispatch(Event::Cross).is_ok()
    }

    /// What shows the assembly mode.
    pub(crate) fn crossing_sample(&self) -> CrossingSample {
        let Crossing {
            ref times,
            ticks,
            settling: [settled, _],
            is_over,
            ..
        } = self.crossing;
        let current = self.drives.report().current;
        CrossingSample {
            is_behind: ticks >= times.crosses_at && settled == 0,
            is_over,
            tick: ticks,
            angle: self.angles().into(),
            velocity: self.velocities().into(),
            torque: self.drives.torque(current).into(),
        }
    }

    /// Ends a crossing that is over: the arm is held, or it is switched off if its assembly mode is not confirmed.
    pub(crate) fn end_crossing(&mut self, confirmed: bool) {
        if !(self.state == State::Crossing && self.crossing.is_over) {
            return;
        }
        if confirmed {
            // Crossing accepts this event.
            let _ = self.dispatch(Event::Finish);
        } else {
            self.latch_fault(Fault::AssemblyMode);
        }
    }

    fn is_free(&self) -> bool {
        self.state == State::Armed && self.path.is_empty() && self.brake.lets_cross()
    }

    /// The tag of the crossing in progress.
    pub(super) fn crossing_tag(&self) -> Option<u32> {
        (self.state == State::Crossing).then_some(self.crossing.times.tag)
    }

    /// Where the joints should be now: on the plan, the laws' lag ago.
    pub(super) fn crossing_reference(&self) -> PlanPlace {
        let crossing = &self.crossing;
        let lag = (self.model.lag + CROSSING_LAG) * self.settings.control.tick_rate;
        let pieces = crossing.times.rate * (crossing.ticks as f32 - lag).max(0.0);
        let piece = pieces as usize;
        let zero = Vector2::zeros();
        let (joints, u) = match coefficients(&self.path, 2 * piece) {
            Some(joints) => (*joints, pieces - piece as f32),
            None => ([crossing.angle.into(), zero, zero, zero, zero, zero], 0.0),
        };
        PlanPlace {
            joints,
            u,
            per_piece: crossing.per_piece,
        }
    }

    /// One tick of a crossing: the torques.
    // As homing: a call takes instructions of every other tick.
    #[inline(always)]
    pub(super) fn cross(&mut self) -> Result<TorqueCommand, Fault> {
        let planned = self.advance_crossing();
        self.setpoint_history.keep(&self.setpoint);
        let Self {
            crossing, model, ..
        } = self;
        let [joint1, joint4] = &mut self.joints;
        let [axis1, axis4] = &model.axes;
        let (loop1, loop4) = (&axis1.servo.position_loop, &axis4.servo.position_loop);
        let ([omega1d, omega4d], [alpha1d, alpha4d]) = (self.setpoint.omega, self.setpoint.alpha);
        let (theta1, omega1) = loop1.predict(joint1.angle(), joint1.velocity(), alpha1d);
        let (theta4, omega4) = loop4.predict(joint4.angle(), joint4.velocity(), alpha4d);
        let [angle1, angle4] = crossing.angle;
        let (error1, error4) = (angle1 - theta1, angle4 - theta4);
        self.error = [error1, error4];
        let feedback1 = loop1.acceleration(joint1.integral, 0.0, error1, omega1d - omega1);
        let feedback4 = loop4.acceleration(joint4.integral, 0.0, error4, omega4d - omega4);

        let [u1, u4] = Vector2::units([theta1, theta4]);
        let links = match model.tool.geometry().links(u1, u4, model.assembly) {
            Ok(links) => Some(links),
            Err(PoseError::NotFinite) => return Err(Fault::NotANumber),
            // B and D are farther apart than links 2 and 3 reach, or they meet.
            Err(_) => {
                let [first, last] = crossing.times.near;
                if crossing.ticks < first || crossing.ticks > last {
                    return Err(Fault::EncoderDisagreement);
                }
                None
            }
        };
        let sine = links.map_or(0.0, |links| {
            Scalar::abs(links.cross) * crossing.per_longest_cross
        });
        let inside = sine < ZONE;
        let far = Scalar::abs(error1) > RESTING_ERROR || Scalar::abs(error4) > RESTING_ERROR;
        if inside {
            crossing.in_zone += 1;
            if far && crossing.in_zone > TIMEOUT_FACTOR * crossing.times.in_zone {
                return Err(Fault::Envelope);
            }
        } else {
            crossing.in_zone = 0;
            if model.monitor.following_error_exceeded([error1, error4]) {
                return Err(Fault::FollowingError);
            }
        }
        if model.monitor.outside([joint1.angle(), joint4.angle()]) {
            return Err(Fault::Envelope);
        }

        // The cranks alone are held, with a constant inertia.
        let ([planned1, planned4], [inertia1, inertia4]) = (planned, model.nominal_inertia);
        let feedback = crossing.feedback();
        let mut torque1 = planned1 + feedback * (inertia1 * feedback1);
        let mut torque4 = planned4 + feedback * (inertia4 * feedback4);
        if let (true, Some(links)) = (sine > COMPUTED, &links) {
            let alpha = [alpha1d + feedback1, alpha4d + feedback4];
            let [computed1, computed4] = model.equations.torques(links, [omega1, omega4], alpha);
            let share = computed_share(sine);
            torque1 += share * (computed1 - torque1);
            torque4 += share * (computed4 - torque4);
        }
        torque1 += axis1.friction.torque(omega1d);
        torque4 += axis4.friction.torque(omega4d);
        let [last1, last4] = crossing.torque;
        let demanded = [
            last1 + crossing.smoothing * (torque1 - last1),
            last4 + crossing.smoothing * (torque4 - last4),
        ];
        let (torque, limited) = model.torque_limit.apply(demanded);
        crossing.torque = torque;
        loop1.integrate(&mut joint1.integral, error1, limited);
        loop4.integrate(&mut joint4.integral, error4, limited);
        let [settled, settling] = crossing.settling;
        if settled > CONFIRMED_WITHIN * settling {
            return Err(Fault::AssemblyMode);
        }
        crossing.is_over = settled > settling && !(inside && far);
        Ok(TorqueCommand {
            torque,
            limits: Limits::empty().with(Limits::TORQUE, limited),
        })
    }

    /// Advances the set-point by a tick. Returns the plan's torques without friction [N·m].
    #[inline(always)]
    fn advance_crossing(&mut self) -> [f32; 2] {
        let Self {
            crossing,
            model,
            setpoint,
            path,
            ..
        } = self;
        crossing.ticks = crossing.ticks.wrapping_add(1);
        if crossing.ticks == crossing.times.crosses_at {
            model.assembly = model.assembly.opposite();
        }
        let pieces = crossing.times.rate * crossing.ticks as f32;
        let piece = pieces as usize;
        let (Some(joints), Some(torques)) = (
            coefficients(path, 2 * piece),
            coefficients(path, 2 * piece + 1),
        ) else {
            // The plan is over.
            let [settled, _] = &mut crossing.settling;
            *settled += 1;
            setpoint.direction = Vector2::units(crossing.angle);
            setpoint.rest();
            return [0.0; 2];
        };
        let u = pieces - piece as f32;
        let [angle, omega, alpha] = joints_on(joints, u, crossing.per_piece);
        crossing.angle = angle.into();
        setpoint.omega = omega.into();
        setpoint.alpha = alpha.into();
        let [c0, c1, c2, c3, ..] = torques;
        (((c3 * u + c2) * u + c1) * u + c0).into()
    }
}
