//! Verification of a whole path, including all points between the samples.
//!
//! Every condition is a clearance, and every clearance has a greatest rate of change along
//! the path: from a point with clearance d, the next d/rate metres are safe. When no step is
//! longer than the least clearance divided by its rate, the whole path is proven, not only
//! its samples.
//!
//! A dyad of lengths a, b whose ends are ρ apart has ρ² = a² + b² + 2ab cos φ, φ the angle
//! between its links, so that |sin φ| ≥ m is an annulus: ρ between √(a² + b² ∓ 2ab√(1−m²)).
//! There are three dyads with an annulus each: leg 1 over |AT|, leg 4 over |EC|, links 2 and 3
//! over |BD|. While all three are kept, working mode and assembly mode are kept too.
//!
//! Rates per metre of the tool, least sines taken over the step: with leg 1's links |BT|
//! and l1, |ṙB| ≤ 1/sin φ1 and |ω2| ≤ 1/(|BT| sin φ1); |ṙC| ≤ 1 + |CT| |ω2|;
//! |ṙD| ≤ |ṙC|/sin φ4; |BD|˙ ≤ |ṙB| + |ṙD|; |ω1| = |ṙB|/l1, |ω4| = |ṙD|/l4. Where the steps that follow are short, those of
//! `near_margin` take their place.

use super::annulus::AnnulusConstraint;
use super::bounds::CurveBounds;
use super::curve::{Curve, CurvePoint};
use super::envelope::Envelope;
use super::error::{ConstraintViolation, PathError};
use super::near_margin::{MotionBounds, Place, least_sine, longest_step};
use super::number::{max, min};
use super::path_segment::PathSegment;
use crate::five_bar::{Joint, Pose, PoseError, Side, Singularity, Workspace, WorkspaceViolation};
use crate::{PlanarVector, Scalar};
use core::f64::consts::{PI, TAU};
use nalgebra::Vector2;

/// The reserve to the joint limits [rad]: without it the steps next to them would become infinitely short.
const RESERVE_ANGLE: f64 = 0.001;

/// After this number of steps a path is refused as too near a singularity.
const STEPS: u32 = 20_000;
/// A step that is a smaller share of its path is found by second-order bounds, so that such steps do not
/// use up their number.
const SHORT: f64 = 1.0 / 4096.0;

/// The angles of the driven joints, tracked over full turns, for the clearance from their
/// limits.
struct JointTracker<S> {
    angles: Option<[S; 2]>,
}

impl<S: Scalar> JointTracker<S> {
    /// The clearance of both joints at a pose [rad].
    fn clearance(
        &mut self,
        workspace: &Workspace<S>,
        pose: &Pose<S>,
    ) -> Result<[S; 2], ConstraintViolation> {
        let Some(limits) = &workspace.limits else {
            return Ok([S::from_f64(PI); 2]);
        };
        let seen = [pose.u1.polar_angle(), pose.u4.polar_angle()];
        let [theta1, theta4] = match self.angles {
            None => limits
                .angles_within(seen[0], seen[1])
                .map_err(|error| WorkspaceViolation::Joint(error.joint()))?,
            Some(last) => [unwrap(seen[0], last[0]), unwrap(seen[1], last[1])],
        };
        self.angles = Some([theta1, theta4]);
        let [range1, range4] = limits.ranges();
        let clearance = |angle: S, [least, greatest]: [S; 2], joint| {
            let clearance = min(angle - least, greatest - angle);
            if clearance >= S::from_f64(RESERVE_ANGLE) {
                Ok::<_, ConstraintViolation>(clearance)
            } else {
                Err(WorkspaceViolation::Joint(joint).into())
            }
        };
        Ok([
            clearance(theta1, range1, Joint::Joint1)?,
            clearance(theta4, range4, Joint::Joint4)?,
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
            angle -= turn;
        } else if last - angle > pi {
            angle += turn;
        }
    }
    angle
}

impl<S: Scalar> Envelope<S> {
    /// Steps along a path segment from its start to its end, calls `visit` at every step and
    /// proves that the whole segment is within the workspace. No step changes the sine of a
    /// dyad's angle by more than about a quarter, so quantities that depend on it are well
    /// sampled. `joints` are θ1, θ4 at its start [rad], where the turns that they are in are known, and returned are those
    /// at its end, if the workspace limits them.
    #[expect(
        clippy::too_many_lines,
        reason = "one proof: from the clearances at a place to the step"
    )]
    pub(super) fn verify_path(
        &self,
        segment: &PathSegment<S>,
        joints: Option<[S; 2]>,
        mut visit: impl FnMut(&CurvePoint<S>, &Pose<S>) -> Result<(), ConstraintViolation>,
    ) -> Result<Option<[S; 2]>, PathError<S>> {
        let workspace = &self.workspace;
        let (tool, margin) = (&workspace.tool, workspace.margin);
        let geometry = tool.geometry();
        let [l1, l2, l3, l4, _] = geometry.lengths();
        let reach = tool.reach();
        let offset = tool.offset().length();
        let annulus1 = AnnulusConstraint::new(l1, reach, margin, Singularity::Leg1);
        let annulus4 = AnnulusConstraint::new(l4, l3, margin, Singularity::Leg4);
        let annulus23 = AnnulusConstraint::new(l2, l3, margin, Singularity::Parallel);
        let mut joints = JointTracker { angles: joints };

        let length = segment.length();
        let bounds = CurveBounds::of(segment.curve());
        let pace = bounds.first;
        let path = MotionBounds {
            speed: pace,
            acceleration: bounds.second(),
        };
        let quarter = S::from_f64(0.25);
        // A blend of any length has its greatest curvature in its middle.
        let longest = match segment.curve() {
            Curve::Blend { .. } => length * quarter,
            _ => length,
        };
        let short = length * S::from_f64(SHORT);
        let mut last = S::ZERO;
        let mut s = S::ZERO;
        let mut point = segment.at(s);
        let refuse = |s: S, point: Vector2<S>, violation| PathError {
            fraction: s / length,
            point,
            violation,
        };
        self.check_margin()
            .map_err(|violation| refuse(s, point.position, violation))?;
        for _ in 0..STEPS {
            let here = |violation| refuse(s, point.position, violation);
            let pose = tool
                .inverse(point.position, workspace.mode)
                .map_err(|error| here(error.into()))?;
            let at = point.position.length();
            let ec = (pose.c - geometry.e()).length();
            let bd = (pose.d - pose.b).length();
            let clearance1 = annulus1.clearance(at).map_err(here)?;
            let clearance4 = annulus4.clearance(ec).map_err(here)?;
            let clearance23 = annulus23.clearance(bd).map_err(here)?;
            let [angle1, angle4] = joints.clearance(workspace, &pose).map_err(here)?;
            visit(&point, &pose).map_err(here)?;
            if s >= length {
                return Ok(joints.angles);
            }

            // Half the clearance of the legs, so that their sines stay well above the margin.
            let step = S::HALF * clearance1 / pace;
            let sine1 = annulus1.least_sine(at, step * pace);
            let b = pace / sine1;
            let c = pace + offset * b / reach;
            let step = min(step, S::HALF * clearance4 / c);
            let sine4 = annulus4.least_sine(ec, step * c);
            let d = c / sine4;
            let step = min(step, clearance23 / (b + d));
            let sine23 = annulus23.least_sine(bd, S::ZERO);
            let step = min(step, min(angle1 * l1 / b, angle4 * l4 / d));
            let turn1 = b / l1 + b / reach;
            let turn4 = d / l4 + d / l3;
            let turn23 = b / reach + d / l3;
            let sampled = min(min(sine1 / turn1, sine4 / turn4), sine23 / turn23);
            let mut step = min(min(step, quarter * sampled), longest);
            if step < short {
                let place = Place {
                    tool,
                    pose: &pose,
                    at: point.position,
                    tangent: point.tangent,
                    velocities: tool
                        .inverse_velocities(&pose, point.tangent)
                        .map_err(|error| here(error.into()))?,
                    path,
                    annuli: [&annulus1, &annulus4, &annulus23],
                    joints: [angle1, angle4],
                };
                let allowed = longest_step(max(last, step), |step| place.allows(step));
                step = max(step, min(allowed.unwrap_or(step), longest));
            }
            last = step;
            s = min(s + step, length);
            point = segment.at(s);
        }
        let pose = tool
            .inverse(point.position, workspace.mode)
            .map_err(|error| refuse(s, point.position, error.into()))?;
        let nearest = WorkspaceViolation::Margin(tool.nearest_singularity(&pose).0);
        Err(refuse(s, point.position, nearest.into()))
    }

    /// Steps along a straight joint move, calls `visit` at every step with the share of the
    /// move's angle that each joint turns, and proves that the assembly mode is kept. Returns
    /// the pose at the end.
    #[expect(
        clippy::too_many_lines,
        reason = "one proof: from the clearances at a place to the step"
    )]
    pub(super) fn verify_joint_path(
        &self,
        from: [S; 2],
        to: [S; 2],
        assembly: Side,
        mut visit: impl FnMut([S; 2], &Pose<S>) -> Result<(), ConstraintViolation>,
    ) -> Result<Pose<S>, PathError<S>> {
        let tool = &self.workspace.tool;
        let geometry = tool.geometry();
        let [l1, l2, l3, l4, _] = geometry.lengths();
        let annulus23 =
            AnnulusConstraint::new(l2, l3, self.workspace.margin, Singularity::Parallel);
        let (from, to) = (pair(from), pair(to));
        let displacement = to - from;
        let length = max(displacement.x.abs(), displacement.y.abs());
        let direction = if length > S::ZERO {
            displacement * (S::ONE / length)
        } else {
            Vector2::zeros()
        };
        // |BD| changes by no more than l1|Δθ1| + l4|Δθ4|.
        let rate = max(
            l1 * direction.x.abs() + l4 * direction.y.abs(),
            S::HALF * min(l1, l4),
        );
        let nowhere = |violation| PathError {
            fraction: S::ZERO,
            point: Vector2::zeros(),
            violation,
        };
        if !(is_finite(from) && is_finite(to)) {
            return Err(nowhere(PoseError::NotFinite.into()));
        }
        self.check_margin().map_err(nowhere)?;
        let short = length * S::from_f64(SHORT);
        let mut last_step = S::ZERO;
        let mut s = S::ZERO;
        let mut last = Vector2::zeros();
        for _ in 0..STEPS {
            let fraction = if length > S::ZERO { s / length } else { S::ONE };
            let at = |point| {
                move |violation| PathError {
                    fraction,
                    point,
                    violation,
                }
            };
            let theta = if s >= length {
                to
            } else {
                from + direction * s
            };
            let pose = geometry
                .forward(theta.x, theta.y, assembly)
                .map_err(|error| at(last)(error.into()))?;
            last = tool.point(&pose);
            let bd = (pose.d - pose.b).length();
            let clearance = annulus23.clearance(bd).map_err(at(last))?;
            if let Some(limits) = &self.workspace.limits {
                for (angle, [least, greatest], joint) in [
                    (theta.x, limits.ranges()[0], Joint::Joint1),
                    (theta.y, limits.ranges()[1], Joint::Joint4),
                ] {
                    let allowed = least <= angle && angle <= greatest;
                    if !allowed {
                        return Err(at(last)(WorkspaceViolation::Joint(joint).into()));
                    }
                }
            }
            visit([direction.x, direction.y], &pose).map_err(at(last))?;
            if s >= length {
                return Ok(pose);
            }
            let sine = annulus23.least_sine(bd, S::ZERO);
            let sampled = S::from_f64(0.25) * sine * min(l2, l3) / rate;
            let mut step = min(clearance / rate, sampled);
            if step < short {
                let (b, d) = (direction.x * l1, direction.y * l4);
                let velocity = pose.u4.perpendicular() * d - pose.u1.perpendicular() * b;
                let motion = MotionBounds {
                    speed: rate,
                    acceleration: b * b / l1 + d * d / l4,
                };
                let between = pose.d - pose.b;
                let allowed = longest_step(max(last_step, step), |step| {
                    least_sine(&annulus23, between, velocity, motion, step).is_some()
                });
                step = max(step, min(allowed.unwrap_or(step), sampled));
            }
            last_step = step;
            s = min(s + step, length);
        }
        Err(PathError {
            fraction: s / length,
            point: last,
            violation: WorkspaceViolation::Margin(Singularity::Parallel).into(),
        })
    }

    /// Refuses margins near 0 and near 1: with a margin of 0 the steps would never end.
    fn check_margin(&self) -> Result<(), ConstraintViolation> {
        let margin = self.workspace.margin;
        if S::from_f64(1e-4) <= margin && margin <= S::from_f64(0.9) {
            Ok(())
        } else {
            Err(ConstraintViolation::Limits)
        }
    }
}

fn pair<S: Scalar>([x, y]: [S; 2]) -> Vector2<S> {
    Vector2::new(x, y)
}

/// Whether both components are finite.
fn is_finite<S: Scalar>(v: Vector2<S>) -> bool {
    v.x.is_finite() && v.y.is_finite()
}
