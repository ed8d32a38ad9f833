//! What a motion along the path demands of the joints and drives.
//!
//! With x = ṡ² and u = s̈ along C(s), q′ and q″ by the inverse solution with ṙC = C′, r̈C = C″:
//!
//! q̇ = q′ √x, q̈ = q′ u + q″ x,
//! τ = a u + b x + c + d √x,
//! a = M q′, b = M q″ + h(q, q′) without gravity, c = gravity + Coulomb · sign q′,
//! d = viscous · q′.

use super::path::PathPoint;
use fivebar_kinematics::dynamics::{Arm, BaseParameterModel, ModelError};
use fivebar_kinematics::five_bar::{Links, PoseError, Tool, WorkingMode};
use nalgebra::Vector2;

/// A drive as a plan sees it; the default has no friction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlannedDrive {
    /// Viscous friction at the joint [N·m·s/rad].
    pub viscous: f64,
    /// Coulomb friction at the joint [N·m].
    pub coulomb: f64,
    /// K, torque at the joint per current, and back-EMF per joint speed [N·m/A, V·s/rad].
    pub torque_constant: f64,
    /// R, resistance of the winding [Ω].
    pub resistance: f64,
}

/// An arm in one working mode, with its drives.
#[derive(Clone, Debug)]
pub struct DrivenArm {
    tool: Tool<f64>,
    mode: WorkingMode,
    model: BaseParameterModel<f64>,
    weightless: BaseParameterModel<f64>,
    drives: [PlannedDrive; 2],
}

/// The coefficients at one point of a path; pairs are of joint 1 and joint 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    /// u(θ1), u(θ4).
    pub direction: [Vector2<f64>; 2],
    /// q′.
    pub q1: [f64; 2],
    /// q″.
    pub q2: [f64; 2],
    /// C′.
    pub tangent: Vector2<f64>,
    /// C″.
    pub curvature: Vector2<f64>,
    /// a.
    pub a: [f64; 2],
    /// b.
    pub b: [f64; 2],
    /// Gravity's part of c.
    pub gravity: [f64; 2],
    /// Coulomb friction's part of c.
    pub coulomb: [f64; 2],
    /// d.
    pub d: [f64; 2],
    /// sin(θ3−θ2).
    pub sin32: f64,
}

impl DrivenArm {
    /// An arm whose tip is the tool's point.
    ///
    /// # Errors
    /// None for an arm that exists; it is made once more without gravity.
    pub fn new(
        arm: &Arm<f64>,
        tool: Tool<f64>,
        mode: WorkingMode,
        drives: [PlannedDrive; 2],
    ) -> Result<Self, ModelError> {
        let (links, payload) = (*arm.links(), arm.payload());
        let (geometry, rotors) = (*arm.geometry(), arm.rotor_inertia());
        let weightless = Arm::new(geometry, links, payload, Vector2::zeros(), rotors)?;
        Ok(Self {
            tool,
            mode,
            model: BaseParameterModel::new(arm),
            weightless: BaseParameterModel::new(&weightless),
            drives,
        })
    }

    /// The same arm in another working mode.
    #[must_use]
    pub fn in_mode(&self, mode: WorkingMode) -> Self {
        Self {
            mode,
            ..self.clone()
        }
    }

    /// The drives.
    pub fn drives(&self) -> &[PlannedDrive; 2] {
        &self.drives
    }

    /// The coefficients at a point of the path.
    ///
    /// # Errors
    /// The arm cannot reach the point, or is in a singularity there.
    pub fn demand(&self, point: &PathPoint) -> Result<Demand, PoseError> {
        let pose = self.tool.inverse(point.c, self.mode)?;
        let first = self.tool.inverse_velocities(&pose, point.tangent)?;
        let second = self
            .tool
            .inverse_accelerations(&pose, &first, point.curvature)?;
        let links = Links::of(&pose, self.tool.geometry());
        let ([q11, _, _, q14], [q21, _, _, q24]) = (first.omega, second.alpha);
        let (q1, q2) = ([q11, q14], [q21, q24]);
        let rest = [0.0; 2];
        let gravity = self.model.torques(&links, rest, rest);
        let part = |of: fn(&PlannedDrive) -> f64| [of(&self.drives[0]), of(&self.drives[1])];
        let (coulomb, viscous) = (part(|drive| drive.coulomb), part(|drive| drive.viscous));
        Ok(Demand {
            direction: [pose.u1, pose.u4],
            q1,
            q2,
            tangent: point.tangent,
            curvature: point.curvature,
            a: self.weightless.torques(&links, rest, q1),
            b: self.weightless.torques(&links, q1, q2),
            gravity,
            coulomb: [0, 1].map(|j| coulomb[j] * sign(q1[j])),
            d: [0, 1].map(|j| viscous[j] * q1[j]),
            sin32: pose.sin32(),
        })
    }
}

/// −1, 0 or 1: a joint at rest has no Coulomb friction to overcome.
fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

impl Demand {
    /// The demand at a share of a cell, by the parabolas through its start, middle and end; with the
    /// Coulomb friction of the middle.
    pub(super) fn between([start, middle, end]: [&Self; 3], share: f64) -> Self {
        let p = (1.0 - share) * (1.0 - 2.0 * share);
        let (q, r) = (4.0 * share * (1.0 - share), share * (2.0 * share - 1.0));
        let mean = |a: f64, b: f64, c: f64| p * a + q * b + r * c;
        let pair = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
            [mean(a[0], b[0], c[0]), mean(a[1], b[1], c[1])]
        };
        let vector = |a: Vector2<f64>, b: Vector2<f64>, c: Vector2<f64>| {
            Vector2::new(mean(a.x, b.x, c.x), mean(a.y, b.y, c.y))
        };
        let direction =
            |k: usize| vector(start.direction[k], middle.direction[k], end.direction[k]);
        Self {
            direction: [direction(0), direction(1)],
            q1: pair(start.q1, middle.q1, end.q1),
            q2: pair(start.q2, middle.q2, end.q2),
            tangent: vector(start.tangent, middle.tangent, end.tangent),
            curvature: vector(start.curvature, middle.curvature, end.curvature),
            a: pair(start.a, middle.a, end.a),
            b: pair(start.b, middle.b, end.b),
            gravity: pair(start.gravity, middle.gravity, end.gravity),
            coulomb: middle.coulomb,
            d: pair(start.d, middle.d, end.d),
            sin32: mean(start.sin32, middle.sin32, end.sin32),
        }
    }

    /// c.
    pub fn c(&self) -> [f64; 2] {
        [0, 1].map(|j| self.gravity[j] + self.coulomb[j])
    }

    /// The torque of each joint [N·m] at x = ṡ² and u = s̈.
    pub fn torque(&self, x: f64, u: f64) -> [f64; 2] {
        let (root, c) = (x.max(0.0).sqrt(), self.c());
        [0, 1].map(|j| self.a[j] * u + self.b[j] * x + c[j] + self.d[j] * root)
    }
}
