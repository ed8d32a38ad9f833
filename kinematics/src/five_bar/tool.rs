//! A tool that is not at C: a point T fixed to link 2, at any angle.
//!
//! With the offset (along, left) in link 2's frame, rT = rC + along u2 + left n2. A, B, T
//! is then a dyad of lengths l1 and |BT|, so that leg 1 is solved by T itself, and leg 4
//! by the C that follows. Its branch and its singularity are the dyad's: `elbow1` is
//! `Left` where AB×BT > 0, and type 1 is where A, B, T are in line.

use super::dyad::Dyad;
use super::inverse::{Leg4, refusal1};
use super::motion::per_sine;
use super::{
    Accelerations, Geometry, GeometryError, Links, PartialRates, Pose, PoseError, Side,
    Singularity, Velocities, WorkingMode,
};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// An arm with its tool point T.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side, Tool, WorkingMode};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// // A pen 30 mm beyond C and 10 mm to the left of link 2.
/// let tool = Tool::new(geometry, Vector2::new(0.03, 0.01))?;
/// let target = Vector2::new(0.06, 0.20);
/// let pose = tool.inverse(target, WorkingMode::new(Side::Right, Side::Left))?;
/// assert!((tool.point(&pose) - target).norm() < 1e-15);
/// assert!(((pose.c - target).norm() - tool.offset().norm()).abs() < 1e-15);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tool<S> {
    geometry: Geometry<S>,
    /// T from C in link 2's frame [m].
    offset: Vector2<S>,
    /// A–B–T.
    leg1: Dyad<S>,
    /// 1/|BT| [1/m].
    per_reach: S,
    /// Direction of B→T in link 2's frame.
    lean: Vector2<S>,
    /// C from T as a share of |BT|, along B→T and to its left; none where T is C.
    to_c: Option<Vector2<S>>,
}

impl Tool<f32> {
    /// Without links: what a constant holds until the arm is known. Its answers mean nothing.
    pub const NONE: Self = Self {
        geometry: Geometry::<f32>::NONE,
        offset: Vector2::new(0.0, 0.0),
        leg1: Dyad::<f32>::NONE,
        per_reach: 0.0,
        lean: Vector2::new(0.0, 0.0),
        to_c: None,
    };
}

impl<S: Scalar> Tool<S> {
    /// The tool at `offset` [m] from C, along link 2 and to its left; zero is C itself.
    ///
    /// # Errors
    /// `ToolOffset` if it is not finite or puts T on B.
    pub fn new(geometry: Geometry<S>, offset: Vector2<S>) -> Result<Self, GeometryError> {
        let bt = Vector2::new(geometry.l2(), S::ZERO) + offset;
        let reach = bt.length();
        let per_reach = S::ONE / reach;
        if !(reach.is_finite() && per_reach.is_finite()) {
            return Err(GeometryError::ToolOffset);
        }
        let lean = bt * per_reach;
        let to_c = -Vector2::new(lean.dot(&offset), lean.cross_z(offset));
        Ok(Self {
            geometry,
            offset,
            leg1: Dyad::new(geometry.l1(), reach),
            per_reach,
            lean,
            to_c: (offset != Vector2::zeros()).then_some(to_c * per_reach),
        })
    }

    /// The arm's lengths.
    #[inline]
    pub fn geometry(&self) -> &Geometry<S> {
        &self.geometry
    }

    /// T from C, along link 2 and to its left [m].
    #[inline]
    pub fn offset(&self) -> Vector2<S> {
        self.offset
    }

    /// |BT| [m]: the second length of leg 1's dyad.
    #[inline]
    pub fn reach(&self) -> S {
        self.leg1.far()
    }

    /// A–B–T.
    #[inline]
    pub(super) fn leg1(&self) -> &Dyad<S> {
        &self.leg1
    }

    /// C from T as a share of |BT|, along B→T and to its left; none where T is C.
    #[inline]
    pub(super) fn c_from_tool(&self) -> Option<Vector2<S>> {
        self.to_c
    }

    /// T [m].
    #[inline]
    pub fn point(&self, pose: &Pose<S>) -> Vector2<S> {
        pose.c + self.offset.to_base_frame(pose.u2)
    }

    /// B to T of these links [m].
    #[inline(always)]
    pub fn from_b(&self, links: &Links<S>) -> Vector2<S> {
        let [_, per_l2, ..] = self.geometry.per_length();
        links.bc + self.offset.to_base_frame(links.bc * per_l2)
    }

    /// ∂rT/∂θ1 = r1⊥ + ω21 BT⊥ and ∂rT/∂θ4 = ω24 BT⊥ [m]: the columns of the tool's Jacobian.
    #[inline(always)]
    pub fn jacobian_of(&self, links: &Links<S>, rates: &PartialRates<S>) -> [Vector2<S>; 2] {
        let turned = self.from_b(links).perpendicular();
        let [omega21, omega24] = rates.link2;
        [
            links.ab.perpendicular() + turned * omega21,
            turned * omega24,
        ]
    }

    /// ṙT = ṙC + ω2 t⊥ [m/s], t = rT − rC.
    #[inline]
    pub fn velocity(&self, pose: &Pose<S>, velocities: &Velocities<S>) -> Vector2<S> {
        let [_, omega2, ..] = velocities.omega;
        velocities.c + self.offset.to_base_frame(pose.u2).perpendicular() * omega2
    }

    /// r̈T = r̈C + α2 t⊥ − ω2² t [m/s²].
    #[inline]
    pub fn acceleration(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        accelerations: &Accelerations<S>,
    ) -> Vector2<S> {
        let [_, omega2, ..] = velocities.omega;
        let [_, alpha2, ..] = accelerations.alpha;
        let t = self.offset.to_base_frame(pose.u2);
        accelerations.c + t.perpendicular() * alpha2 - t * (omega2 * omega2)
    }

    /// The inverse branch: which way each elbow turns, leg 1 being A–B–T.
    #[inline]
    pub fn working_mode(&self, pose: &Pose<S>) -> WorkingMode {
        let [sine1, sine4] = self.elbow_sines(pose);
        WorkingMode::new(Side::of(sine1), Side::of(sine4))
    }

    /// Sines of the angles at B, from A–B to B–T, and at D: zero at type 1, positive where
    /// the elbow turns left.
    #[inline(always)]
    pub fn elbow_sines(&self, pose: &Pose<S>) -> [S; 2] {
        [pose.u1.cross_z(self.direction(pose)), pose.sin34()]
    }

    /// The pose that holds T at `t` [m].
    ///
    /// # Errors
    /// As [`Geometry::inverse`], leg 1 being A–B–T.
    #[inline]
    pub fn inverse(&self, t: Vector2<S>, mode: WorkingMode) -> Result<Pose<S>, PoseError> {
        let geometry = &self.geometry;
        let [per_l1, ..] = geometry.per_length();
        let leg1 = self.leg1.solve_precisely(t, mode.elbow1.opposite());
        let b = Dyad::joint_of(leg1).map_err(refusal1)?;
        // B→T turned back by the lean is link 2's own direction.
        let back = Vector2::new(self.lean.x, -self.lean.y);
        let u2 = back.to_base_frame((t - b) * self.per_reach);
        let c = b + u2 * geometry.l2();
        let Leg4 { d, u3, u4 } = geometry.leg4_to(c, mode.elbow4)?;
        Ok(Pose {
            u1: b * per_l1,
            u2,
            u3,
            u4,
            b,
            c,
            d,
        })
    }

    /// All velocities from the tool's, ṙT [m/s].
    ///
    /// # Errors
    /// `Singular` at type 1, naming the leg.
    #[inline]
    pub fn inverse_velocities(
        &self,
        pose: &Pose<S>,
        t_velocity: Vector2<S>,
    ) -> Result<Velocities<S>, PoseError> {
        let [per_l1, ..] = self.geometry.per_length();
        let ut = self.direction(pose);
        let per_sin = per_sine(pose.u1.cross_z(ut), Singularity::Leg1)?;
        let omega1 = t_velocity.dot(&ut) * (per_l1 * per_sin);
        let omega2 = -t_velocity.dot(&pose.u1) * (self.per_reach * per_sin);
        let c_velocity = t_velocity - self.offset.to_base_frame(pose.u2).perpendicular() * omega2;
        let [omega3, omega4] = self.geometry.leg4_velocities(pose, c_velocity)?;
        Ok(Velocities {
            omega: [omega1, omega2, omega3, omega4],
            c: c_velocity,
        })
    }

    /// All accelerations from the tool's, r̈T [m/s²].
    ///
    /// # Errors
    /// `Singular` at type 1, naming the leg.
    #[inline]
    pub fn inverse_accelerations(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        t_acceleration: Vector2<S>,
    ) -> Result<Accelerations<S>, PoseError> {
        let geometry = &self.geometry;
        let [per_l1, ..] = geometry.per_length();
        let [omega1, omega2, ..] = velocities.omega;
        let ut = self.direction(pose);
        let per_sin = per_sine(pose.u1.cross_z(ut), Singularity::Leg1)?;
        let a = t_acceleration
            + pose.u1 * (geometry.l1() * omega1 * omega1)
            + ut * (self.reach() * omega2 * omega2);
        let alpha1 = a.dot(&ut) * (per_l1 * per_sin);
        let alpha2 = -a.dot(&pose.u1) * (self.per_reach * per_sin);
        let t = self.offset.to_base_frame(pose.u2);
        let c_acceleration = t_acceleration - t.perpendicular() * alpha2 + t * (omega2 * omega2);
        let [alpha3, alpha4] = geometry.leg4_accelerations(pose, velocities, c_acceleration)?;
        Ok(Accelerations {
            alpha: [alpha1, alpha2, alpha3, alpha4],
            c: c_acceleration,
        })
    }

    /// Unit vector from B to T.
    #[inline(always)]
    fn direction(&self, pose: &Pose<S>) -> Vector2<S> {
        self.lean.to_base_frame(pose.u2)
    }
}
