//! The frame in which ranks are computed: about the mechanism's centre and in units of its
//! size, so that the result is independent of the mechanism's position and scale.

use super::{Freedom, Joint, MechanismGraph, Screw};
use nalgebra::{Matrix3, Vector3};

/// The centre of the joint axes and the root mean square of their distances from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScaledFrame {
    pub(super) centre: Vector3<f64>,
    pub(super) size: f64,
}

impl ScaledFrame {
    /// The point nearest to all axes in the sense of least squares:
    /// Σ(1 − ŝŝᵀ) c = Σ(1 − ŝŝᵀ) r over the axes with direction ŝ through r.
    ///
    /// If the axes do not determine the point in some direction (all are parallel), a shift in
    /// this direction changes no moment, and the solution of least norm is taken.
    pub(super) fn new(graph: &MechanismGraph) -> Self {
        let axes: Vec<(Vector3<f64>, Vector3<f64>)> = graph
            .joints()
            .iter()
            .flat_map(|joint| &joint.freedoms)
            .filter_map(|freedom| {
                let twist = freedom.twist();
                Some((twist.direction.try_normalize(0.0)?, twist.axis_point()?))
            })
            .collect();
        let mut normal = Matrix3::zeros();
        let mut right = Vector3::zeros();
        for (direction, point) in &axes {
            let across = Matrix3::identity() - direction * direction.transpose();
            normal += across;
            right += across * point;
        }
        let tolerance = 1e-9 * normal.norm();
        let centre = normal
            .pseudo_inverse(tolerance)
            .map_or(Vector3::zeros(), |inverse| inverse * right);
        let squares: f64 = axes
            .iter()
            .map(|(direction, point)| direction.cross(&(point - centre)).norm_squared())
            .sum();
        let rms = (squares / axes.len().max(1) as f64).sqrt();
        // All axes pass through one point, or there is none: the unit is arbitrary, and must
        // not be the size of rounding errors.
        let reach = axes
            .iter()
            .fold(0.0_f64, |m, (_, point)| m.max(point.norm()));
        let size = if rms > 1e-9 * reach && rms > 0.0 {
            rms
        } else {
            1.0
        };
        Self { centre, size }
    }

    /// A screw written in this frame.
    pub(super) fn express(&self, screw: &Screw) -> Screw {
        Screw {
            direction: screw.direction,
            moment: (screw.moment - self.centre.cross(&screw.direction)) / self.size,
        }
    }

    /// The graph written in this frame.
    pub(super) fn express_graph(&self, graph: &MechanismGraph) -> MechanismGraph {
        let joints = graph
            .joints()
            .iter()
            .map(|joint| Joint {
                freedoms: joint
                    .freedoms
                    .iter()
                    .map(|f| self.express_freedom(f))
                    .collect(),
                ..joint.clone()
            })
            .collect();
        graph.with_joints(joints)
    }

    fn express_freedom(&self, freedom: &Freedom) -> Freedom {
        match freedom {
            Freedom::Screw(screw) => {
                let expressed = self.express(screw).to_vector();
                // The length of an axis has no meaning: displacements are in radians or sizes.
                let scale = if screw.direction.norm() > 0.0 {
                    screw.direction.norm()
                } else {
                    expressed.norm()
                };
                Freedom::Screw(Screw::from_vector(&(expressed / scale)))
            }
            Freedom::Parallelogram { normal, rod } => Freedom::Parallelogram {
                normal: normal.normalize(),
                rod: rod / self.size,
            },
        }
    }
}
