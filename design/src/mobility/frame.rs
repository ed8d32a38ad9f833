//! The frame ranks are judged in: about the mechanism's centre, in units of its size, so
//! that an answer depends neither on where the mechanism stands nor on its scale.

use super::{Freedom, Joint, MechanismGraph, Screw};
use nalgebra::{Matrix3, Vector3};

/// A point amid the joint axes and the root mean square of their distances from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScaledFrame {
    pub(super) centre: Vector3<f64>,
    pub(super) size: f64,
}

impl ScaledFrame {
    /// The point nearest to all axes in the sense of least squares:
    /// Σ(1 − ŝŝᵀ) c = Σ(1 − ŝŝᵀ) r over the axes with direction ŝ through r.
    ///
    /// Where the axes leave a direction open (all parallel), moving along it changes no
    /// moment, and the solution of least norm serves.
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
        // All axes through one point, or none at all: any length is as good as another,
        // so the distance of rounding errors must not become the unit.
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
                // A joint's own scale says nothing: amounts are radians or sizes.
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
