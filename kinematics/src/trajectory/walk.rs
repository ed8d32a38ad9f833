//! Walking a path so that nothing slips between the samples.
//!
//! Every condition is a distance to keep, and every distance has a greatest rate along
//! the path: from a place with room d, the next d/rate metres are safe. So a walk whose
//! steps are never longer than the least room over its rate has proven all of the path,
//! not its samples.
//!
//! A dyad of lengths a, b whose ends are ρ apart has ρ² = a² + b² + 2ab cos φ, φ the angle
//! between its links, so that |sin φ| ≥ m is the ring of ρ between √(a² + b² ∓ 2ab√(1−m²)).
//! Three dyads, three rings: leg 1 over |AT|, leg 4 over |EC|, links 2 and 3 over |BD|,
//! and where these are kept, the working mode and the assembly are kept too.
//!
//! Rates per metre of the tool, least sines taken over the step: with leg 1's links |BT|
//! and l1, |ṙB| ≤ 1/sin φ1 and |ω2| ≤ 1/(|BT| sin φ1); |ṙC| ≤ 1 + |CT| |ω2|;
//! |ṙD| ≤ |ṙC|/sin φ4; |BD|˙ ≤ |ṙB| + |ṙD|; |ω1| = |ṙB|/l1, |ω4| = |ṙD|/l4.

use super::bounds::CurveBounds;
use super::curve::{Curve, CurvePoint};
use super::envelope::Envelope;
use super::number::{max, min};
use super::refusal::{Obstacle, Refusal};
use super::segment::Segment;
use crate::five_bar::{Joint, Outside, Pose, PoseError, Side, Singularity, Workspace};
use crate::{PlanarVector, Scalar};
use core::f64::consts::{PI, TAU};
use nalgebra::Vector2;

/// The margin is kept with one hundredth of itself to spare, and joint limits with a
/// thousandth of a radian: nearer, steps would become too short to end.
const SPARE_SHARE: f64 = 0.01;
const SPARE_ANGLE: f64 = 0.001;

/// Steps after which a path is refused as too near to its nearest singularity. Only one
/// that runs along the margin for long, within little more than its spare, takes as many.
const STEPS: u32 = 20_000;

/// The distances between a dyad's ends that keep it from being straight or folded.
#[derive(Clone, Copy)]
struct Ring<S> {
    /// a² + b² and 2ab [m²].
    sum: S,
    product: S,
    /// Edges of the margin, and of the margin with its spare [m].
    margin: [S; 2],
    spare: [S; 2],
    singularity: Singularity,
}

impl<S: Scalar> Ring<S> {
    fn new(a: S, b: S, margin: S, singularity: Singularity) -> Self {
        let sum = a * a + b * b;
        let product = S::TWO * a * b;
        let edges = |margin: S| {
            let cos = max(S::ONE - margin * margin, S::ZERO).sqrt();
            [sum - product * cos, sum + product * cos].map(S::sqrt)
        };
        Self {
            sum,
            product,
            margin: edges(margin),
            spare: edges(margin * S::from_f64(1.0 + SPARE_SHARE)),
            singularity,
        }
    }

    /// How far `distance` is from the edges [m].
    fn room(&self, distance: S) -> Result<S, Obstacle> {
        let [near, far] = self.margin;
        let [spare_near, spare_far] = self.spare;
        if spare_near <= distance && distance <= spare_far {
            Ok(min(distance - near, far - distance))
        } else {
            Err(Obstacle::Outside(Outside::Margin(self.singularity)))
        }
    }

    /// The least |sin φ| while `distance` changes by no more than `change` [m]: φ is
    /// monotone in the distance, so it is at one end.
    fn least_sine(&self, distance: S, change: S) -> S {
        let sine = |distance: S| {
            let cos = (distance * distance - self.sum) / self.product;
            max(S::ONE - cos * cos, S::ZERO).sqrt()
        };
        min(sine(distance - change), sine(distance + change))
    }
}

/// The driven joints' angles, followed from turn to turn, and the room to their limits.
struct JointWalk<S> {
    angles: Option<[S; 2]>,
}

impl<S: Scalar> JointWalk<S> {
    /// The room of both joints at a pose [rad].
    fn room(&mut self, workspace: &Workspace<S>, pose: &Pose<S>) -> Result<[S; 2], Obstacle> {
        let Some(limits) = &workspace.limits else {
            return Ok([S::from_f64(PI); 2]);
        };
        let seen = [pose.u1.polar_angle(), pose.u4.polar_angle()];
        let [theta1, theta4] = match self.angles {
            None => limits
                .admit(seen[0], seen[1])
                .map_err(|joint| Obstacle::Outside(Outside::Joint(joint)))?,
            Some(last) => [unwrap(seen[0], last[0]), unwrap(seen[1], last[1])],
        };
        self.angles = Some([theta1, theta4]);
        let [range1, range4] = limits.ranges();
        let room = |angle: S, [least, greatest]: [S; 2], joint| {
            let room = min(angle - least, greatest - angle);
            if room >= S::from_f64(SPARE_ANGLE) {
                Ok(room)
            } else {
                Err(Obstacle::Outside(Outside::Joint(joint)))
            }
        };
        Ok([
            room(theta1, range1, Joint::Joint1)?,
            room(theta4, range4, Joint::Joint4)?,
        ])
    }
}

/// `angle` on the turn that is nearest to `last` [rad].
fn unwrap<S: Scalar>(angle: S, last: S) -> S {
    let (pi, turn) = (S::from_f64(PI), S::from_f64(TAU));
    let mut angle = angle;
    // Joint limits span three turns at most.
    for _ in 0..3 {
        if angle - last > pi {
            angle = angle - turn;
        } else if last - angle > pi {
            angle = angle + turn;
        }
    }
    angle
}

impl<S: Scalar> Envelope<S> {
    /// Walk a segment from its start to its end, `visit` every step, and prove the whole
    /// of it to be within the workspace. No step changes the sine of a dyad's angle by
    /// more than about a quarter, so that what depends on it is well sampled.
    pub(super) fn walk(
        &self,
        segment: &Segment<S>,
        mut visit: impl FnMut(&CurvePoint<S>, &Pose<S>) -> Result<(), Obstacle>,
    ) -> Result<(), Refusal<S>> {
        let workspace = &self.workspace;
        let (tool, margin) = (&workspace.tool, workspace.margin);
        let geometry = tool.geometry();
        let [l1, l2, l3, l4, _] = geometry.lengths();
        let reach = tool.reach();
        let offset = tool.offset().length();
        let ring1 = Ring::new(l1, reach, margin, Singularity::Leg1);
        let ring4 = Ring::new(l4, l3, margin, Singularity::Leg4);
        let ring23 = Ring::new(l2, l3, margin, Singularity::Parallel);
        let mut joints = JointWalk { angles: None };

        let length = segment.length();
        let pace = max(CurveBounds::of(segment.curve()).first, S::ONE);
        let quarter = S::from_f64(0.25);
        // A blend bends most in its middle, however short it is.
        let longest = match segment.curve() {
            Curve::Blend { .. } => length * quarter,
            _ => length,
        };
        let mut s = S::ZERO;
        let mut point = segment.at(s);
        let refuse = |s: S, point: Vector2<S>, obstacle| Refusal {
            fraction: s / length,
            point,
            obstacle,
        };
        self.check_margin()
            .map_err(|obstacle| refuse(s, point.position, obstacle))?;
        for _ in 0..STEPS {
            let here = |obstacle| refuse(s, point.position, obstacle);
            let pose = tool
                .inverse(point.position, workspace.mode)
                .map_err(|error| here(Obstacle::Outside(Outside::Pose(error))))?;
            let at = point.position.length();
            let ec = (pose.c - geometry.e()).length();
            let bd = (pose.d - pose.b).length();
            let room1 = ring1.room(at).map_err(here)?;
            let room4 = ring4.room(ec).map_err(here)?;
            let room23 = ring23.room(bd).map_err(here)?;
            let [angle1, angle4] = joints.room(workspace, &pose).map_err(here)?;
            visit(&point, &pose).map_err(here)?;
            if s >= length {
                return Ok(());
            }

            // Half the room of the legs, so that their sines stay well above the margin.
            let step = S::HALF * room1 / pace;
            let sine1 = ring1.least_sine(at, step * pace);
            let b = pace / sine1;
            let c = pace + offset * b / reach;
            let step = min(step, S::HALF * room4 / c);
            let sine4 = ring4.least_sine(ec, step * c);
            let d = c / sine4;
            let step = min(step, room23 / (b + d));
            let sine23 = ring23.least_sine(bd, S::ZERO);
            let step = min(step, min(angle1 * l1 / b, angle4 * l4 / d));
            let turn1 = b / l1 + b / reach;
            let turn4 = d / l4 + d / l3;
            let turn23 = b / reach + d / l3;
            let sampled = min(min(sine1 / turn1, sine4 / turn4), sine23 / turn23);
            let step = min(min(step, quarter * sampled), longest);
            s = min(s + step, length);
            point = segment.at(s);
        }
        let pose = tool
            .inverse(point.position, workspace.mode)
            .map_err(|error| refuse(s, point.position, Obstacle::Outside(Outside::Pose(error))))?;
        let nearest = Outside::Margin(tool.nearest_singularity(&pose).0);
        Err(refuse(s, point.position, Obstacle::Outside(nearest)))
    }

    /// Walk a straight joint move, `visit` every step with the share of the move's
    /// angle that each joint turns, and prove the assembly to be kept. Gives the
    /// pose at the end.
    pub(super) fn walk_joints(
        &self,
        from: [S; 2],
        to: [S; 2],
        assembly: Side,
        mut visit: impl FnMut([S; 2], &Pose<S>) -> Result<(), Obstacle>,
    ) -> Result<Pose<S>, Refusal<S>> {
        let tool = &self.workspace.tool;
        let geometry = tool.geometry();
        let [l1, l2, l3, l4, _] = geometry.lengths();
        let ring23 = Ring::new(l2, l3, self.workspace.margin, Singularity::Parallel);
        let (from, to) = (pair(from), pair(to));
        let way = to - from;
        let length = max(way.x.abs(), way.y.abs());
        let direction = if length > S::ZERO {
            way * (S::ONE / length)
        } else {
            Vector2::zeros()
        };
        // |BD| changes by no more than l1|Δθ1| + l4|Δθ4|.
        let rate = max(
            l1 * direction.x.abs() + l4 * direction.y.abs(),
            S::HALF * min(l1, l4),
        );
        let nowhere = |obstacle| Refusal {
            fraction: S::ZERO,
            point: Vector2::zeros(),
            obstacle,
        };
        if !(is_finite(from) && is_finite(to)) {
            return Err(nowhere(Obstacle::Outside(Outside::Pose(
                PoseError::NotFinite,
            ))));
        }
        self.check_margin().map_err(nowhere)?;
        let mut s = S::ZERO;
        let mut last = Vector2::zeros();
        for _ in 0..STEPS {
            let fraction = if length > S::ZERO { s / length } else { S::ONE };
            let at = |point| {
                move |obstacle| Refusal {
                    fraction,
                    point,
                    obstacle,
                }
            };
            let theta = if s >= length {
                to
            } else {
                from + direction * s
            };
            let pose = geometry
                .forward(theta.x, theta.y, assembly)
                .map_err(|error| at(last)(Obstacle::Outside(Outside::Pose(error))))?;
            last = tool.point(&pose);
            let bd = (pose.d - pose.b).length();
            let room = ring23.room(bd).map_err(at(last))?;
            if let Some(limits) = &self.workspace.limits {
                for (angle, [least, greatest], joint) in [
                    (theta.x, limits.ranges()[0], Joint::Joint1),
                    (theta.y, limits.ranges()[1], Joint::Joint4),
                ] {
                    let allowed = least <= angle && angle <= greatest;
                    if !allowed {
                        return Err(at(last)(Obstacle::Outside(Outside::Joint(joint))));
                    }
                }
            }
            visit([direction.x, direction.y], &pose).map_err(at(last))?;
            if s >= length {
                return Ok(pose);
            }
            let sine = ring23.least_sine(bd, S::ZERO);
            let sampled = S::from_f64(0.25) * sine * min(l2, l3) / rate;
            s = min(s + min(room / rate, sampled), length);
        }
        Err(Refusal {
            fraction: s / length,
            point: last,
            obstacle: Obstacle::Outside(Outside::Margin(Singularity::Parallel)),
        })
    }

    /// A margin of 0 could be walked up to for ever.
    fn check_margin(&self) -> Result<(), Obstacle> {
        let margin = self.workspace.margin;
        if S::from_f64(1e-4) <= margin && margin <= S::from_f64(0.9) {
            Ok(())
        } else {
            Err(Obstacle::Limits)
        }
    }
}

fn pair<S: Scalar>([x, y]: [S; 2]) -> Vector2<S> {
    Vector2::new(x, y)
}

/// A vector with nothing in it that is infinite or not a number.
fn is_finite<S: Scalar>(v: Vector2<S>) -> bool {
    v.x.is_finite() && v.y.is_finite()
}
