//! Steps next to the margin and to joint limits, by bounds of second order.
//!
//! A bound of a rate that holds along the margin multiplies the worst cases of three dyads. Where the tool is far beside C
//! that is thousands of times the real rate, and a clearance divided by it leaves steps of nanometres. Here the rates are
//! those of the pose, and only their change is bounded: over a step of length h a quantity x with |x″| ≤ M stays
//! between x + min(0, x′h − ½Mh²) and x + max(0, x′h + ½Mh²).
//!
//! The distance ρ between the ends of a dyad, one of which moves against the other with speed v and
//! acceleration a by path length, has |ρ″| ≤ v²/ρ + a. Its links of lengths l move their common joint with
//! |ω|l ≤ v/sin φ and |α|l ≤ (a + Σ ω²l)/sin φ, the least sine taken over the step.

use super::annulus::AnnulusConstraint;
use super::number::{max, min};
use crate::five_bar::{Pose, Tool, Velocities};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The longest step is looked for among so many, each half of the one before.
const TRIES: u32 = 6;

/// A step that `allows` holds of, from four times the `last` one down.
pub(super) fn longest_step<S: Scalar>(last: S, allows: impl Fn(S) -> bool) -> Option<S> {
    let mut step = last * S::from_f64(4.0);
    for _ in 0..TRIES {
        if allows(step) {
            return Some(step);
        }
        step *= S::HALF;
    }
    None
}

/// Bounds of a motion over a step, by path length.
#[derive(Clone, Copy)]
pub(super) struct MotionBounds<S> {
    /// [m/m], or [m/rad] on a joint move.
    pub(super) speed: S,
    /// [m/m²], or [m/rad²] on a joint move.
    pub(super) acceleration: S,
}

/// The least |sin φ| of a dyad over a step of length `step`, if the step keeps its margin. One end is `between` from
/// the other [m] and moves against it with `velocity` at the start.
pub(super) fn least_sine<S: Scalar>(
    annulus: &AnnulusConstraint<S>,
    between: Vector2<S>,
    velocity: Vector2<S>,
    motion: MotionBounds<S>,
    step: S,
) -> Option<S> {
    let distance = between.length();
    let change = between.dot(&velocity) / distance * step;
    let closest = max(annulus.nearest(), distance - motion.speed * step);
    let second = motion.speed * motion.speed / closest + motion.acceleration;
    let bend = S::HALF * second * (step * step);
    let ends = [
        distance + min(S::ZERO, change - bend),
        distance + max(S::ZERO, change + bend),
    ];
    annulus.least_sine_within(ends)
}

/// Bounds over a step of the motion of the links of a dyad, of which an end moves.
struct Links<S> {
    lengths: [S; 2],
    /// |ω|l of each link.
    speeds: [S; 2],
    /// The greatest |α|l of both.
    tangential: S,
}

impl<S: Scalar> Links<S> {
    /// `omega` are the links' turns at the start [rad/m].
    fn new(end: MotionBounds<S>, sine: S, lengths: [S; 2], omega: [S; 2], step: S) -> Self {
        let mut links = Self {
            lengths,
            speeds: [end.speed / sine; 2],
            tangential: S::ZERO,
        };
        // The speeds bound the accelerations, and these the speeds' change: twice is nearly all.
        for _ in 0..2 {
            let [first, second] = links.centripetal();
            links.tangential = (end.acceleration + first + second) / sine;
            for ((speed, length), omega) in links.speeds.iter_mut().zip(lengths).zip(omega) {
                *speed = min(*speed, omega.abs() * length + links.tangential * step);
            }
        }
        links
    }

    /// ω²l of each link.
    fn centripetal(&self) -> [S; 2] {
        let [v1, v2] = self.speeds;
        let [l1, l2] = self.lengths;
        [v1 * v1 / l1, v2 * v2 / l2]
    }

    /// The greatest acceleration of the joint between the links.
    fn acceleration(&self) -> S {
        self.tangential + self.centripetal()[0]
    }

    /// Whether the first link turns by no more than `clearance` [rad], and the dyad's angle by no more
    /// than a quarter of its sine.
    fn turn_little(&self, step: S, clearance: S, sine: S) -> bool {
        let [v1, v2] = self.speeds;
        let [l1, l2] = self.lengths;
        let turn = v1 / l1 * step;
        turn <= clearance && turn + v2 / l2 * step <= S::from_f64(0.25) * sine
    }
}

/// A place on a path of the tool, from which a step is to be made.
pub(super) struct Place<'a, S> {
    pub(super) tool: &'a Tool<S>,
    pub(super) pose: &'a Pose<S>,
    /// Position and tangent of the tool.
    pub(super) at: Vector2<S>,
    pub(super) tangent: Vector2<S>,
    /// By path length, at the place.
    pub(super) velocities: Velocities<S>,
    /// Bounds of the whole path.
    pub(super) path: MotionBounds<S>,
    /// Of leg 1, leg 4, and links 2 and 3.
    pub(super) annuli: [&'a AnnulusConstraint<S>; 3],
    /// The joints' clearances from their limits [rad].
    pub(super) joints: [S; 2],
}

impl<S: Scalar> Place<'_, S> {
    /// Whether a step of this length [m] is proven to keep the margin and the joint limits.
    #[inline(never)]
    pub(super) fn allows(&self, step: S) -> bool {
        self.proven(step).is_some()
    }

    fn proven(&self, step: S) -> Option<()> {
        let (pose, path) = (self.pose, self.path);
        let geometry = self.tool.geometry();
        let [l1, _, l3, l4, _] = geometry.lengths();
        let [annulus1, annulus4, annulus23] = self.annuli;
        let [omega1, omega2, omega3, omega4] = self.velocities.omega;

        let sine1 = least_sine(annulus1, self.at, self.tangent, path, step)?;
        let lengths1 = [l1, self.tool.reach()];
        let leg1 = Links::new(path, sine1, lengths1, [omega1, omega2], step);

        // C turns with link 2 about the tool.
        let turn2 = leg1.speeds[1] / lengths1[1];
        let offset = self.tool.offset().length();
        let second = offset * (leg1.tangential / lengths1[1] + turn2 * turn2);
        let acceleration = path.acceleration + second;
        let c = MotionBounds {
            speed: min(
                path.speed + offset * turn2,
                self.velocities.c.length() + acceleration * step,
            ),
            acceleration,
        };
        let ec = pose.c - geometry.e();
        let sine4 = least_sine(annulus4, ec, self.velocities.c, c, step)?;
        let leg4 = Links::new(c, sine4, [l4, l3], [omega4, omega3], step);

        let bd_velocity =
            pose.u4.perpendicular() * (omega4 * l4) - pose.u1.perpendicular() * (omega1 * l1);
        let acceleration = leg1.acceleration() + leg4.acceleration();
        let bd = MotionBounds {
            speed: min(
                leg1.speeds[0] + leg4.speeds[0],
                bd_velocity.length() + acceleration * step,
            ),
            acceleration,
        };
        let sine23 = least_sine(annulus23, pose.d - pose.b, bd_velocity, bd, step)?;

        let [clearance1, clearance4] = self.joints;
        let turn23 = (turn2 + leg4.speeds[1] / l3) * step;
        (leg1.turn_little(step, clearance1, sine1)
            && leg4.turn_little(step, clearance4, sine4)
            && turn23 <= S::from_f64(0.25) * sine23)
            .then_some(())
    }
}
