//! The loops of a graph: closure, its Jacobian, and the platform's motion.
//!
//! Every body's frame coincides with the base frame at home, so a body's displacement is the
//! product of the exponentials of the joints on its path from the ground, and the columns of
//! the Jacobian are the joints' twists, displaced by the joints before them.

use super::{Freedom, MechanismGraph, Screw};
use nalgebra::{DMatrix, DVector, Isometry3, Vector6};

/// One step of a path: a single freedom passed forwards or backwards.
#[derive(Clone, Copy)]
struct PathStep {
    variable: usize,
    forwards: bool,
}

/// A spanning tree of the graph, with the joints that close its loops.
pub(super) struct Loops {
    freedoms: Vec<Freedom>,
    /// For each closing joint the two paths whose ends must coincide.
    closures: Vec<(Vec<PathStep>, Vec<PathStep>)>,
    platform: Vec<PathStep>,
}

impl Loops {
    pub(super) fn new(graph: &MechanismGraph) -> Self {
        let mut first = Vec::with_capacity(graph.joints().len());
        let mut freedoms = Vec::new();
        for joint in graph.joints() {
            first.push(freedoms.len());
            freedoms.extend_from_slice(&joint.freedoms);
        }
        let through = |index: usize, forwards: bool| -> Vec<PathStep> {
            let range = first[index]..first[index] + graph.joints()[index].freedoms.len();
            let steps = range.map(|variable| PathStep { variable, forwards });
            if forwards {
                steps.collect()
            } else {
                steps.rev().collect()
            }
        };

        let mut paths: Vec<Option<Vec<PathStep>>> = vec![None; graph.bodies()];
        paths[0] = Some(Vec::new());
        let mut in_tree = vec![false; graph.joints().len()];
        // Breadth first, so that paths are short; a graph is connected by construction.
        let mut frontier = vec![0];
        while !frontier.is_empty() {
            let mut next = Vec::new();
            for body in frontier {
                for (index, joint) in graph.joints().iter().enumerate() {
                    let (other, forwards) = match body {
                        b if b == joint.from => (joint.to, true),
                        b if b == joint.to => (joint.from, false),
                        _ => continue,
                    };
                    if paths[other].is_none() {
                        let mut path = paths[body].clone().unwrap_or_default();
                        path.extend(through(index, forwards));
                        paths[other] = Some(path);
                        in_tree[index] = true;
                        next.push(other);
                    }
                }
            }
            frontier = next;
        }
        let path = |body: usize| paths[body].clone().unwrap_or_default();
        let closures = graph
            .joints()
            .iter()
            .enumerate()
            .filter(|(index, _)| !in_tree[*index])
            .map(|(index, joint)| {
                let mut left = path(joint.from);
                left.extend(through(index, true));
                (left, path(joint.to))
            })
            .collect();
        Self {
            freedoms,
            closures,
            platform: path(graph.platform()),
        }
    }

    /// The number of joint variables, N.
    pub(super) fn variables(&self) -> usize {
        self.freedoms.len()
    }

    /// The number of independent loops.
    pub(super) fn count(&self) -> usize {
        self.closures.len()
    }

    /// The closure error of the loops at `q`, six numbers for each loop.
    pub(super) fn residual(&self, q: &DVector<f64>) -> DVector<f64> {
        let mut residual = DVector::zeros(6 * self.closures.len());
        for (index, (left, right)) in self.closures.iter().enumerate() {
            let error = self.displacement(left, q) * self.displacement(right, q).inverse();
            let rotation = error.rotation.scaled_axis();
            residual.fixed_rows_mut::<3>(6 * index).copy_from(&rotation);
            residual
                .fixed_rows_mut::<3>(6 * index + 3)
                .copy_from(&error.translation.vector);
        }
        residual
    }

    /// The Jacobian of the closure in the joint variables, 6·loops × N.
    pub(super) fn jacobian(&self, q: &DVector<f64>) -> DMatrix<f64> {
        let mut jacobian = DMatrix::zeros(6 * self.closures.len(), self.variables());
        for (index, (left, right)) in self.closures.iter().enumerate() {
            let mut rows = jacobian.rows_mut(6 * index, 6);
            for (path, sign) in [(left, 1.0), (right, -1.0)] {
                for (variable, twist) in self.twists(path, q) {
                    let mut column = rows.column_mut(variable);
                    column += twist * sign;
                }
            }
        }
        jacobian
    }

    /// The platform's twist for unit rates of each joint variable, 6 × N.
    pub(super) fn platform_jacobian(&self, q: &DVector<f64>) -> DMatrix<f64> {
        let mut jacobian = DMatrix::zeros(6, self.variables());
        for (variable, twist) in self.twists(&self.platform, q) {
            jacobian.set_column(variable, &twist);
        }
        jacobian
    }

    fn displacement(&self, path: &[PathStep], q: &DVector<f64>) -> Isometry3<f64> {
        path.iter().fold(Isometry3::identity(), |before, step| {
            before * self.step_displacement(*step, q)
        })
    }

    fn step_displacement(&self, step: PathStep, q: &DVector<f64>) -> Isometry3<f64> {
        let displacement = self.freedoms[step.variable].displacement(q[step.variable]);
        if step.forwards {
            displacement
        } else {
            displacement.inverse()
        }
    }

    /// Each variable on the path with the twist that it gives to the end of the path.
    fn twists(&self, path: &[PathStep], q: &DVector<f64>) -> Vec<(usize, Vector6<f64>)> {
        let mut before = Isometry3::identity();
        path.iter()
            .map(|step| {
                let twist = self.freedoms[step.variable].twist_at(q[step.variable]);
                let after = before * self.step_displacement(*step, q);
                // d/dq exp($ q)⁻¹ = −exp($ q)⁻¹ $: passed backwards, the twist is displaced by
                // the joints after it too.
                let carried = if step.forwards {
                    twist.transformed(&before).to_vector()
                } else {
                    -twist.transformed(&after).to_vector()
                };
                before = after;
                (step.variable, carried)
            })
            .collect()
    }

    /// The freedoms of the graph at `q` seen at the platform.
    pub(super) fn platform_twists(&self, q: &DVector<f64>, motions: &DMatrix<f64>) -> Vec<Screw> {
        let twists = self.platform_jacobian(q) * motions;
        twists
            .column_iter()
            .map(|column| Screw::from_vector(&Vector6::from_iterator(column.iter().copied())))
            .collect()
    }
}
