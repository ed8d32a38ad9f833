//! Crossings: motions through a singularity of type 2 that the host has planned.
//!
//! A crossing begins where the arm is held, with the tool up and nothing queued. Its whole path is
//! checked: reach, joints, elbows, where it meets the singularity, and the torques of the arm's equations.
//! These grow as f/sin(θ3−θ2) towards the singularity unless the plan satisfies its condition, f = 0.

use super::crossing_evidence::{CrankMotion, Evidence};
use super::crossing_pieces::ArmOn;
use super::error::LONGEST_CROSSING;
use super::{End, MoveError, MoveErrorKind, Planner};
use crate::controller::{
    ArmController, CROSSING_PIECES, CrossingTimes, OUTSIDE_OF_ZONE, PlanningSnapshot,
    QUEUED_SEGMENTS, ZONE,
};
use crate::drives::Drives;
use crate::motion::{CrossingMove, Move};
use fivebar_kinematics::Scalar;
use fivebar_kinematics::five_bar::{PoseError, Singularity};
use fivebar_kinematics::trajectory::ConstraintViolation;
use nalgebra::Vector2;
use rtic_core::Mutex;

/// The places at which a plan is checked.
const PLACES: u16 = 200;
/// Greatest distance from the place of rest to the beginning of the line [m].
const STEP: f32 = 2e-5;
/// |sin(θ3−θ2)| of the gap, in which torques are interpolated: the equations are 0/0 in its middle.
pub(super) const GAP: f32 = 0.04;
/// The greatest difference between the torques that both sides of the gap expect in its middle [N·m].
const MISMATCH: f32 = 0.02;

/// A plan that was checked, with what follows from its path.
pub(super) struct CheckedCrossing {
    /// The times between which |sin(θ3−θ2)| is below that of computed torque alone [s].
    near: [f32; 2],
    /// The time in the zone [s].
    inside: f32,
    pub(super) gap: Gap,
}

/// The ends of the gap.
pub(super) struct Gap {
    /// [s].
    pub(super) time: [f32; 2],
    /// The torques there without friction [N·m].
    torque: [Vector2<f32>; 2],
    /// Their changes in the time of the gap [N·m].
    change: [Vector2<f32>; 2],
}

/// One place of a plan.
struct Place {
    /// sin(θ3−θ2), positive in the arm's assembly mode.
    sine: f32,
    /// The torques of the arm's equations without friction [N·m].
    torque: Vector2<f32>,
    /// What shows the assembly mode behind the singularity: the squares of the difference of both modes'
    /// torques, and of the friction's, each with the sine as its weight [(N·m)²].
    evidence: Vector2<f32>,
}

impl Gap {
    /// The torques without friction at a time in the gap [N·m].
    pub(super) fn torque_at(&self, time: f32) -> Vector2<f32> {
        let ([begin, end], [p, q], [v, w]) = (self.time, self.torque, self.change);
        let u = (time - begin) / (end - begin);
        let (square, rest) = (u * u, 1.0 - u);
        p + (q - p) * (square * (3.0 - 2.0 * u)) + (v * rest - w * u) * (u * rest)
    }

    /// Whether both sides expect the same torques in the middle.
    fn is_closed(&self) -> bool {
        let ([p, q], [v, w]) = (self.torque, self.change);
        let difference = (p + v * 0.5) - (q - w * 0.5);
        difference.norm() <= MISMATCH
    }
}

/// What is known of a gap's ends from the places beside it: it lies between the last place before it and the
/// first one behind it.
#[derive(Default)]
struct GapEnds {
    /// The torques of the last place [N·m].
    last: Vector2<f32>,
    /// How many places behind the gap were passed, up to 2.
    behind: u8,
}

impl GapEnds {
    /// Notes the torques [N·m] of a place at its time [s], before the gap or behind it.
    fn pass(&mut self, gap: &mut Gap, is_before: bool, time: f32, torque: Vector2<f32>) {
        let Gap {
            time: [begin, end],
            torque: [torque0, torque1],
            change: [change0, change1],
        } = gap;
        match self.behind {
            _ if is_before => (*begin, *change0, *torque0) = (time, torque - self.last, torque),
            0 => (*end, *torque1, self.behind) = (time, torque, 1),
            1 => (*change1, self.behind) = (torque - *torque1, 2),
            _ => {}
        }
        self.last = torque;
    }
}

impl Planner {
    /// Accepts a crossing, as [`Planner::push`] does.
    pub(super) fn push_crossing(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        snapshot: &PlanningSnapshot,
        start: End,
        next: &Move,
        plan: &CrossingMove,
    ) -> Result<(), MoveError> {
        let refuse = |kind| MoveError::new(next.tag, kind);
        if snapshot.hold.is_none() || !self.is_empty() || snapshot.path_free < QUEUED_SEGMENTS {
            return Err(refuse(MoveErrorKind::Full));
        }
        let checked = self.check_crossing(next.tag, start.tool, plan)?;
        if next.tool != 0 || self.level != 0 {
            return Err(refuse(MoveErrorKind::Crossing));
        }
        for piece in 0..CROSSING_PIECES {
            let segments = self.crossing_piece(plan, &checked.gap, piece);
            let [joints, torques] = segments.ok_or(refuse(MoveErrorKind::Crossing))?;
            controller.lock(|controller| controller.store_crossing(piece, [&joints, &torques]));
        }
        let ticks = |time: f32| (time * self.tick_rate) as u32;
        let times = CrossingTimes {
            tag: next.tag,
            rate: CROSSING_PIECES as f32 / (plan.duration * self.tick_rate),
            crosses_at: ticks(plan.crosses_at),
            near: checked.near.map(ticks),
            in_zone: ticks(checked.inside),
        };
        let begun = controller
            .lock(|controller| controller.begin_crossing(snapshot.path_generation, &times));
        self.evidence = Evidence::NONE;
        begun.then_some(()).ok_or(refuse(MoveErrorKind::Full))
    }

    /// Checks a crossing from `start` [m].
    ///
    /// # Errors
    /// Why it is refused, and where.
    pub(super) fn check_crossing(
        &self,
        tag: u32,
        start: Vector2<f32>,
        plan: &CrossingMove,
    ) -> Result<CheckedCrossing, MoveError> {
        let refuse = |kind| MoveError::new(tag, kind);
        if !self.crossing_allowed {
            return Err(refuse(MoveErrorKind::CrossingNotAllowed));
        }
        let (duration, crosses_at) = (plan.duration, plan.crosses_at);
        if !(plan.is_finite() && duration > 0.0) {
            return Err(refuse(MoveErrorKind::Number));
        }
        let no_crossing = refuse(MoveErrorKind::Crossing);
        let begins = (Vector2::from(plan.from) - start).norm() <= STEP;
        if !(begins && 0.0 < crosses_at && crosses_at < duration) {
            return Err(no_crossing);
        }
        if duration > LONGEST_CROSSING {
            return Err(refuse(MoveErrorKind::TooLong));
        }
        let step = duration / f32::from(PLACES);
        let mut checked = CheckedCrossing {
            near: [duration, 0.0],
            inside: 0.0,
            gap: Gap {
                time: [0.0, duration],
                torque: [Vector2::zeros(); 2],
                change: [Vector2::zeros(); 2],
            },
        };
        let mut last = 0.0;
        let mut ends = GapEnds::default();
        let mut evidence = Vector2::zeros();
        for place in 0..=PLACES {
            let time = step * f32::from(place);
            let [s, ..] = plan.share(time);
            if !(s + 1e-5 >= last && s <= 1.0 + 1e-5) {
                return Err(no_crossing);
            }
            last = s;
            let place_there = self.check_place(tag, plan, time)?;
            let Place { sine, torque, .. } = place_there;
            evidence += place_there.evidence;
            let (size, moving) = (Scalar::abs(sine), 0 < place && place < PLACES);
            // Beside its time, the singularity has either side of it.
            let beside = Scalar::abs(time - crosses_at) < step;
            if (sine > 0.0) != (time < crosses_at) && !beside {
                return Err(no_crossing);
            }
            if size < self.envelope.workspace.margin && !moving {
                let [end, ..] = plan.motion(time);
                return Err(MoveError {
                    tag,
                    kind: MoveErrorKind::ParallelSingularity,
                    point: Some(end.into()),
                });
            }
            if size < OUTSIDE_OF_ZONE {
                let [first, end] = &mut checked.near;
                *first = first.min(time);
                *end = time + step;
            }
            if size < ZONE {
                checked.inside += step;
            }
            if size >= GAP {
                ends.pass(&mut checked.gap, time < crosses_at, time, torque);
            }
        }
        let Gap { time, change, .. } = &mut checked.gap;
        let [begin, end] = *time;
        // From the time of a place to that of the gap.
        *change = change.map(|change| change * ((end - begin) / step));
        if ends.behind < 2 || begin == 0.0 {
            return Err(no_crossing);
        }
        if !checked.gap.is_closed() {
            return Err(refuse(MoveErrorKind::CrossingCondition));
        }
        // Friction is known badly, so the modes must differ by more.
        let [difference, friction] = evidence.into();
        if difference <= friction {
            return Err(refuse(MoveErrorKind::IndistinctCrossing));
        }
        Ok(checked)
    }

    /// Checks a plan at a time [s].
    fn check_place(&self, tag: u32, plan: &CrossingMove, time: f32) -> Result<Place, MoveError> {
        let [position, ..] = plan.motion(time);
        let workspace = &self.envelope.workspace;
        let here = |kind: MoveErrorKind| MoveError {
            tag,
            kind,
            point: Some(position.into()),
        };
        let failed = |error: PoseError| here(ConstraintViolation::from(error).into());
        let arm = self.arm_on(plan, time).map_err(failed)?;
        let pose = &arm.pose;
        let elbows = [
            (pose.sin21(), Singularity::Leg1),
            (pose.sin34(), Singularity::Leg4),
        ];
        for (sine, leg) in elbows {
            if Scalar::abs(sine) < workspace.margin {
                return Err(here(leg.into()));
            }
        }
        let [theta1, _, _, theta4] = pose.angles();
        if let Some(limits) = workspace.limits {
            let inside = limits.angles_within(theta1, theta4);
            inside.map_err(|error| here(MoveErrorKind::joint_limit(error.joint())))?;
        }
        let ([w1, _, _, w4], [a1, _, _, a4]) = (arm.velocities.omega, arm.accelerations.alpha);
        let sine = Scalar::abs(pose.sin32());
        let torque = match sine >= GAP {
            true => self.torque_of(&arm).map_err(failed)?,
            false => Vector2::zeros(),
        };
        let joints = torque.iter().zip([(w1, a1), (w4, a4)]).enumerate();
        for (j, (torque, (speed, acceleration))) in joints {
            let friction = self
                .friction
                .get(j)
                .map_or(0.0, |joint| joint.torque(speed));
            let within = |value: f32, limits: [f32; 2]| {
                limits
                    .get(j)
                    .is_some_and(|&most| Scalar::abs(value) <= most)
            };
            let kept = within(speed, self.envelope.joint_speed)
                && within(acceleration, self.envelope.joint_acceleration)
                && within(torque + friction, self.peak_torque);
            if !kept {
                return Err(here(MoveErrorKind::Overload(if j == 0 { 1 } else { 4 })));
            }
        }
        let behind = time > plan.crosses_at && sine >= GAP;
        let evidence = match behind {
            true => self.evidence_of(&arm, torque).map_err(failed)?,
            false => Vector2::zeros(),
        };
        let own = pose.assembly() == self.assembly;
        Ok(Place {
            sine: if own { sine } else { -sine },
            torque,
            evidence,
        })
    }

    /// [`Place::evidence`] of the arm where it needs these torques [N·m].
    fn evidence_of(&self, arm: &ArmOn, torque: Vector2<f32>) -> Result<Vector2<f32>, PoseError> {
        let [theta1, _, _, theta4] = arm.pose.angles();
        let ([w1, _, _, w4], [a1, _, _, a4]) = (arm.velocities.omega, arm.accelerations.alpha);
        let motion = CrankMotion {
            angle: Vector2::new(theta1, theta4),
            velocity: Vector2::new(w1, w4),
            acceleration: Vector2::new(a1, a4),
        };
        let (sine, other) = self.needed_in(arm.pose.assembly().opposite(), &motion)?;
        let [friction1, friction4] = &self.friction;
        let friction = Vector2::new(friction1.torque(w1), friction4.torque(w4));
        let squares = [torque - other, friction].map(|torque| (torque * sine).norm_squared());
        Ok(squares.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a gap is closed that begins with a torque and its change, and ends with others [N·m].
    fn is_closed(torque: [f32; 2], change: [f32; 2]) -> bool {
        let only = |value: f32| Vector2::new(0.0, value);
        Gap {
            time: [0.0, 1.0],
            torque: torque.map(only),
            change: change.map(only),
        }
        .is_closed()
    }

    #[test]
    fn a_gap_is_closed_if_both_sides_go_on_to_the_same_torque() {
        assert!(is_closed([0.1, 0.3], [0.2, 0.2]));
        assert!(is_closed([0.1, 0.3], [0.2, 0.17]));
        assert!(!is_closed([0.1, 0.3], [0.2, 0.14]));
        assert!(!is_closed([0.1, 0.3], [0.0, 0.2]));
    }
}
