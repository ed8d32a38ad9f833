//! Walls before the limits of an arm that a hand leads: a spring and a damper before each.
//!
//! Each wall has a coordinate c(θ1, θ4), which is to stay above a limit c0, with the gradient g = ∂c/∂θ:
//!
//! | limit | c | g1, g4 |
//! |---|---|---|
//! | angle of joint j | −\|θj − middle\| | ∓1 at joint j |
//! | type 2: B, C, D in line | −\|p\|/(l2 l3), p = r2·r3 | ∓BD·r1⊥, ±BD·r4⊥ |
//! | type 1 of leg 1, A–B–T | s r1×BT/(l1 \|BT\|) | s r1·BT (ω21 − 1, ω24) |
//! | type 1 of leg 4, E–D–C | s r4×r3/(l4 l3) | s r4·r3 (ω31, ω34 − 1) |
//!
//! s = ±1 is the side of the leg's elbow. At type 2 the cosine is taken, because |BD| is smooth there in the joints and the
//! sine is not. With the depth d = c0 − c > 0 the torque is g (K d − B ċ)/|g|², where that pushes and does not pull: for a wall
//! across the joints' plane, K is its stiffness [N·m/rad] and B its damping [N·m·s/rad].

use crate::five_bar::{Links, PartialRates, Side, Tool, WorkingMode};
use crate::{PlanarVector, Scalar};

/// A gradient's square below this one is taken for it: no wall there has a direction.
const LEAST_SQUARE: f64 = 1e-4;

/// What walls are before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallLimits<S> {
    /// Least and greatest angle of each joint [rad], where its wall begins.
    pub angles: [[S; 2]; 2],
    /// |sin| at the elbows and at C where the walls begin.
    pub sine: S,
    /// Stiffness [N·m/rad].
    pub stiffness: S,
    /// Damping [N·m·s/rad].
    pub damping: S,
}

/// The walls of an arm.
///
/// ```
/// use fivebar_kinematics::PlanarVector;
/// use fivebar_kinematics::control::{WallLimits, Walls};
/// use fivebar_kinematics::five_bar::{Geometry, Side, Tool};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let tool = Tool::new(geometry, Vector2::zeros())?;
/// let limits = WallLimits {
///     angles: [[0.6, 3.6], [-0.4, 2.5]], // rad
///     sine: 0.3,
///     stiffness: 20.0, // N·m/rad
///     damping: 0.1,    // N·m·s/rad
/// };
/// let walls = Walls::new(&tool, &limits);
/// let push = |angles: [f64; 2], omega| {
///     let [u1, u4] = Vector2::units(angles);
///     let links = geometry.links(u1, u4, Side::Left).unwrap();
///     let mode = tool.working_mode(&geometry.pose(&links));
///     walls.push(&tool, mode, &links, angles, omega)
/// };
/// // Nothing pushes where no wall is near.
/// assert_eq!(push([2.2, 0.9], [1.0, -1.0]).spring, [0.0; 2]);
/// // Joint 4 is 0.01 rad behind its wall.
/// let [torque1, torque4] = push([2.2, -0.41], [0.0; 2]).spring;
/// assert!(torque1 == 0.0 && (torque4 - 0.2).abs() < 1e-12);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walls<S> {
    /// The middle of each joint's range, and half of it [rad].
    middle: [S; 2],
    reach: [S; 2],
    sine: S,
    /// The cosine with that sine.
    cosine: S,
    /// 1/(l1 |BT|), 1/(l4 l3), 1/(l2 l3) [1/m²].
    per_area: [S; 3],
    stiffness: S,
    damping: S,
}

/// What the walls do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPush<S> {
    /// τ1, τ4 of the springs [N·m].
    pub spring: [S; 2],
    /// τ1, τ4 of the dampers [N·m].
    pub damper: [S; 2],
    /// How the links turn there.
    pub rates: PartialRates<S>,
    /// The working mode that the arm is in.
    pub mode: WorkingMode,
}

impl<S: Scalar> Walls<S> {
    /// The walls of an arm with this tool.
    pub fn new(tool: &Tool<S>, limits: &WallLimits<S>) -> Self {
        let geometry = tool.geometry();
        let area = |first: S, second: S| S::ONE / (first * second);
        let sine = limits.sine;
        Self {
            middle: limits.angles.map(|[low, high]| S::HALF * (low + high)),
            reach: limits.angles.map(|[low, high]| S::HALF * (high - low)),
            sine,
            cosine: (S::ONE - sine * sine).sqrt(),
            per_area: [
                area(geometry.l1(), tool.reach()),
                area(geometry.l4(), geometry.l3()),
                area(geometry.l2(), geometry.l3()),
            ],
            stiffness: limits.stiffness,
            damping: limits.damping,
        }
    }

    /// What they do to an arm of this working mode with these links, angles [rad] and velocities [rad/s].
    #[inline(always)]
    pub fn push(
        &self,
        tool: &Tool<S>,
        mode: WorkingMode,
        links: &Links<S>,
        angles: [S; 2],
        omega: [S; 2],
    ) -> WallPush<S> {
        let rates = links.partial_rates();
        let ([omega21, omega24], [omega31, omega34]) = (rates.link2, rates.link3);
        let Links {
            ab: r1,
            bc: r2,
            dc: r3,
            ed: r4,
            ..
        } = *links;
        let (bt, bd) = (tool.from_b(links), r2 - r3);
        let [per1, per4, per2] = self.per_area;
        let ([angle1, angle4], [middle1, middle4], [reach1, reach4]) =
            (angles, self.middle, self.reach);
        let (off1, off4) = (angle1 - middle1, angle4 - middle4);
        let (mut spring, mut damper) = ([S::ZERO; 2], [S::ZERO; 2]);
        let mut add = |depth: S, sign: S, [g1, g4]: [S; 2]| {
            if depth > S::ZERO {
                let gradient = [sign * g1, sign * g4];
                let [by_spring, by_damper] = self.shares(depth, gradient, omega);
                accumulate(&mut spring, gradient, by_spring);
                accumulate(&mut damper, gradient, by_damper);
            }
        };
        let inwards = |off: S| if off > S::ZERO { -S::ONE } else { S::ONE };
        add(off1.abs() - reach1, inwards(off1), [S::ONE, S::ZERO]);
        add(off4.abs() - reach4, inwards(off4), [S::ZERO, S::ONE]);
        let p = r2.dot(&r3);
        let gradient = [
            bd.dot(&r1.perpendicular()) * per2,
            -bd.dot(&r4.perpendicular()) * per2,
        ];
        add(p.abs() * per2 - self.cosine, inwards(p), gradient);
        let (side1, side4) = (mode.elbow1.sign(S::ONE), mode.elbow4.sign(S::ONE));
        let (elbow1, elbow4) = (r1.cross_z(bt), r4.cross_z(r3));
        let along = r1.dot(&bt) * per1;
        let gradient = [along * (omega21 - S::ONE), along * omega24];
        add(self.sine - side1 * elbow1 * per1, side1, gradient);
        let along = r4.dot(&r3) * per4;
        let gradient = [along * omega31, along * (omega34 - S::ONE)];
        add(self.sine - side4 * elbow4 * per4, side4, gradient);
        WallPush {
            spring,
            damper,
            rates,
            mode: WorkingMode::new(Side::of(elbow1), Side::of(elbow4)),
        }
    }

    /// What spring and damper of a wall with this depth and gradient push along it, over |g|².
    #[inline(always)]
    fn shares(&self, depth: S, [g1, g4]: [S; 2], [omega1, omega4]: [S; 2]) -> [S; 2] {
        let square = g1 * g1 + g4 * g4;
        let least = S::from_f64(LEAST_SQUARE);
        let per_square = S::ONE / if square > least { square } else { least };
        let spring = self.stiffness * depth;
        let mut damper = -self.damping * (g1 * omega1 + g4 * omega4);
        if damper < -spring {
            damper = -spring;
        }
        [spring * per_square, damper * per_square]
    }
}

#[inline(always)]
fn accumulate<S: Scalar>([torque1, torque4]: &mut [S; 2], [g1, g4]: [S; 2], share: S) {
    *torque1 += g1 * share;
    *torque4 += g4 * share;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::five_bar::Geometry;
    use nalgebra::Vector2;
    use proptest::prelude::*;

    fn arm() -> Tool<f64> {
        let geometry = Geometry::new([0.10, 0.16, 0.15, 0.11, 0.08]).unwrap();
        Tool::new(geometry, Vector2::new(0.03, 0.01)).unwrap()
    }

    fn walls(tool: &Tool<f64>, sine: f64, angles: [[f64; 2]; 2]) -> Walls<f64> {
        Walls::new(
            tool,
            &WallLimits {
                angles,
                sine,
                stiffness: 20.0,
                damping: 0.0,
            },
        )
    }

    fn links(tool: &Tool<f64>, angles: [f64; 2]) -> Option<Links<f64>> {
        let [u1, u4] = Vector2::units(angles);
        tool.geometry().links(u1, u4, Side::Left).ok()
    }

    /// The coordinates of the walls as `clearances` and the angles have them, by the pose.
    fn coordinates(tool: &Tool<f64>, angles: [f64; 2], mode: WorkingMode) -> [f64; 3] {
        let pose = tool.geometry().pose(&links(tool, angles).unwrap());
        let [sine1, sine4] = tool.elbow_sines(&pose);
        let sign = |side: Side| side.sign(1.0);
        let cosine = (1.0 - pose.sin32() * pose.sin32()).max(0.0).sqrt();
        [
            sign(mode.elbow1) * sine1,
            sign(mode.elbow4) * sine4,
            -cosine,
        ]
    }

    const WIDE: [[f64; 2]; 2] = [[-9.0, 9.0]; 2];

    proptest! {
        /// With one coordinate behind its wall, the torque is K d g/|g|² of a gradient by differences.
        #[test]
        fn a_wall_pushes_along_the_gradient_of_its_coordinate(
            theta1 in 1.2..2.8_f64, theta4 in 0.2..1.8_f64,
        ) {
            let tool = arm();
            let angles = [theta1, theta4];
            prop_assume!(links(&tool, angles).is_some_and(|links| links.cross.abs() > 0.004));
            let of = links(&tool, angles).unwrap();
            let mode = tool.working_mode(&tool.geometry().pose(&of));
            let here = coordinates(&tool, angles, mode);
            let (step, mut expected) = (1e-6, [0.0; 2]);
            let sine = 0.6;
            let limits = [sine, sine, -(1.0_f64 - sine * sine).sqrt()];
            for (k, (c, limit)) in here.into_iter().zip(limits).enumerate() {
                let depth = limit - c;
                prop_assume!(depth.abs() > 1e-4);
                let slope = |joint: usize| {
                    let at = |by: f64| {
                        let mut moved = angles;
                        moved[joint] += by;
                        coordinates(&tool, moved, mode)[k]
                    };
                    (at(step) - at(-step)) / (2.0 * step)
                };
                let g = [slope(0), slope(1)];
                let square = g[0] * g[0] + g[1] * g[1];
                prop_assume!(square > 0.01);
                if depth > 0.0 {
                    for (sum, g) in expected.iter_mut().zip(g) {
                        *sum += 20.0 * depth * g / square;
                    }
                }
            }
            let push = walls(&tool, sine, WIDE).push(&tool, mode, &of, angles, [0.0; 2]);
            for (found, expected) in push.spring.into_iter().zip(expected) {
                prop_assert!((found - expected).abs() < 1e-4 * (1.0 + expected.abs()), "{found} {expected}");
            }
        }
    }

    #[test]
    fn a_joint_behind_its_limit_is_pushed_back_and_never_pulled() {
        let tool = arm();
        let angles = [2.2, 0.9];
        let of = links(&tool, angles).unwrap();
        let mode = tool.working_mode(&tool.geometry().pose(&of));
        let walls = Walls {
            damping: 1.0,
            ..walls(&tool, 0.0, [[2.3, 3.0], [-0.4, 0.8]])
        };
        let torque = |omega| {
            let push = walls.push(&tool, mode, &of, angles, omega);
            [0, 1].map(|k| push.spring[k] + push.damper[k])
        };
        let [torque1, torque4] = torque([0.0; 2]);
        assert!((torque1 - 2.0).abs() < 1e-12 && (torque4 + 2.0).abs() < 1e-12);
        // Outwards the damper adds to the spring, and back it takes at most all of it.
        assert!((torque([-0.5, 0.5])[0] - 2.5).abs() < 1e-12);
        assert_eq!(torque([5.0, -5.0]), [0.0; 2]);
    }
}
