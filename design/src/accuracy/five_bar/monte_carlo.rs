//! The figures of the analysis by sampling: arms with random errors of their lengths, and pins
//! at random positions in their bearings.

use super::analysis::{AccuracyAnalysis, SCATTERED, TolerancedArm, ToolState};
use super::tool_with_pin_offsets;
use crate::Noise;
use crate::accuracy::arm::ArmAccuracyModel;
use crate::accuracy::sampling::{Accumulator, Moments, Progress, Sampling, sample, sample_block};
use core::f64::consts::TAU;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::Geometry;
use nalgebra::Vector2;
use rayon::prelude::*;

/// The sampled figures of an [`AccuracyAnalysis`].
#[derive(Clone, Debug)]
pub struct MonteCarlo {
    /// Number and seed of the samples.
    pub sampling: Sampling,
    /// Displacement of C by errors of inputs and lengths [m].
    pub position: Moments<2>,
    /// The same with errors of one primitive at a time, in the order of
    /// [`AccuracyAnalysis::primitives`].
    pub alone: Vec<Moments<2>>,
    /// Distance of C from its ideal position with uniform errors of the inputs [m].
    pub input: Moments<1>,
    /// Distance of C from its ideal position with all pins on the rims of their bearings in
    /// random directions: exact, and to first order [m].
    pub clearance: Moments<2>,
    /// Ċ [m/s] and C̈ [m/s²]; none without masses.
    pub motion: Option<Moments<4>>,
    /// Torques [N·m] and joint forces [N]; none without masses.
    pub forces: Option<Moments<12>>,
}

/// Samples everything that [`analyse`](super::analyse) propagates, on all cores.
pub fn monte_carlo(
    arm: &TolerancedArm<'_>,
    state: &ToolState,
    analysis: &AccuracyAnalysis,
    sampling: Sampling,
    progress: Progress<'_>,
) -> MonteCarlo {
    let block = |block| MonteCarlo::block(arm, state, analysis, sampling, block, progress);
    let blocks: Vec<MonteCarlo> = (0..sampling.blocks()).into_par_iter().map(block).collect();
    MonteCarlo::merged(analysis, sampling, &blocks)
}

impl MonteCarlo {
    /// The figures of one block of the samples, a function of the seed and the block's index alone: any process may
    /// draw it.
    pub fn block(
        arm: &TolerancedArm<'_>,
        state: &ToolState,
        analysis: &AccuracyAnalysis,
        sampling: Sampling,
        block: usize,
        progress: Progress<'_>,
    ) -> Self {
        let arms = ArmSampler {
            arm,
            state,
            analysis,
        };
        let displaced = |varies: &dyn Fn(usize) -> bool| {
            sample_block(sampling, block, progress, |noise| {
                arms.displacement(noise, varies)
            })
        };
        let loads = arm.arm.map(|masses| {
            sample_block::<(Moments<4>, Moments<12>)>(sampling, block, progress, |noise| {
                arms.motion_and_forces(masses, noise)
            })
        });
        let (motion, forces) = loads.unzip();
        let alone = (0..analysis.primitives.len()).map(|only| displaced(&|i| i == only));
        Self {
            sampling,
            position: displaced(&|_| true),
            alone: alone.collect(),
            input: sample_block(sampling, block, progress, |noise| arms.input_error(noise)),
            clearance: sample_block(sampling, block, progress, |noise| {
                arms.clearance_error(noise)
            }),
            motion,
            forces,
        }
    }

    /// The figures of all blocks, which come in their order.
    pub fn merged(analysis: &AccuracyAnalysis, sampling: Sampling, blocks: &[Self]) -> Self {
        let figure = |of: &dyn Fn(&Self) -> &Moments<2>| {
            let merge = |sums: Moments<2>, block: &Self| sums.merge(of(block));
            blocks.iter().fold(Moments::default(), merge)
        };
        Self {
            sampling,
            position: figure(&|block| &block.position),
            alone: (0..analysis.primitives.len())
                .map(|index| figure(&|block| &block.alone[index]))
                .collect(),
            input: blocks
                .iter()
                .fold(Moments::default(), |sums, block| sums.merge(&block.input)),
            clearance: figure(&|block| &block.clearance),
            motion: merged(blocks.iter().map(|block| block.motion.as_ref())),
            forces: merged(blocks.iter().map(|block| block.forces.as_ref())),
        }
    }

    /// All of it as numbers, for other processes.
    pub fn to_numbers(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        self.position.write(&mut numbers);
        for alone in &self.alone {
            alone.write(&mut numbers);
        }
        self.input.write(&mut numbers);
        self.clearance.write(&mut numbers);
        if let (Some(motion), Some(forces)) = (&self.motion, &self.forces) {
            motion.write(&mut numbers);
            forces.write(&mut numbers);
        }
        numbers
    }

    /// Takes what [`MonteCarlo::to_numbers`] gave for the same arm; none if the numbers end too early.
    pub fn from_numbers(
        arm: &TolerancedArm<'_>,
        analysis: &AccuracyAnalysis,
        sampling: Sampling,
        numbers: &mut impl Iterator<Item = f64>,
    ) -> Option<Self> {
        let position = Moments::read(numbers)?;
        let alone = (0..analysis.primitives.len()).map(|_| Moments::read(numbers));
        let alone = alone.collect::<Option<_>>()?;
        let (input, clearance) = (Moments::read(numbers)?, Moments::read(numbers)?);
        let (motion, forces) = match arm.arm {
            Some(_) => (Some(Moments::read(numbers)?), Some(Moments::read(numbers)?)),
            None => (None, None),
        };
        Some(Self {
            sampling,
            position,
            alone,
            input,
            clearance,
            motion,
            forces,
        })
    }
}

/// The sums over blocks that all have them; none if they have none.
fn merged<'a, const N: usize>(
    blocks: impl Iterator<Item = Option<&'a Moments<N>>>,
) -> Option<Moments<N>> {
    let blocks = blocks.collect::<Option<Vec<_>>>()?;
    Some(blocks.into_iter().fold(Moments::default(), Moments::merge))
}

/// Displacements of C by inputs and lengths [m].
pub fn sample_positions(
    arm: &TolerancedArm<'_>,
    state: &ToolState,
    analysis: &AccuracyAnalysis,
    sampling: Sampling,
    progress: Progress<'_>,
) -> Moments<2> {
    let arms = ArmSampler {
        arm,
        state,
        analysis,
    };
    sample(sampling, progress, |noise| {
        arms.displacement(noise, |_| true)
    })
}

/// Ċ [m/s] and C̈ [m/s²], torques [N·m] and joint forces [N]; none without masses.
pub fn sample_forces(
    arm: &TolerancedArm<'_>,
    state: &ToolState,
    analysis: &AccuracyAnalysis,
    sampling: Sampling,
    progress: Progress<'_>,
) -> Option<(Moments<4>, Moments<12>)> {
    let arms = ArmSampler {
        arm,
        state,
        analysis,
    };
    let masses = arm.arm?;
    Some(sample(sampling, progress, |noise| {
        arms.motion_and_forces(masses, noise)
    }))
}

/// The number of samples that [`monte_carlo`] draws in all, for its progress.
pub fn draws(analysis: &AccuracyAnalysis, sampling: Sampling) -> u64 {
    let kinds = 3 + analysis.primitives.len() + usize::from(analysis.forces.is_some());
    (kinds * sampling.samples) as u64
}

struct ArmSampler<'a> {
    arm: &'a TolerancedArm<'a>,
    state: &'a ToolState,
    analysis: &'a AccuracyAnalysis,
}

impl ArmSampler<'_> {
    /// Random θ1, θ4, l1…l5; those that do not vary have their means.
    fn random_primitives(&self, noise: &mut Noise, varies: impl Fn(usize) -> bool) -> [f64; 7] {
        core::array::from_fn(|i| {
            let primitive = &self.analysis.primitives[i];
            let error = if varies(i) { noise.normal() } else { 0.0 };
            primitive.mean + primitive.deviation * error
        })
    }

    fn displacement(&self, noise: &mut Noise, varies: impl Fn(usize) -> bool) -> Option<[f64; 2]> {
        let [theta1, theta4, l1, l2, l3, l4, base] = self.random_primitives(noise, varies);
        let assembly = self.analysis.pose.assembly();
        let made = if base < 0.0 {
            // E has moved past A, as it may in a coaxial arm: the same arm seen from E.
            let geometry = Geometry::new([l4, l3, l2, l1, -base]).ok()?;
            let from_e = geometry
                .forward(theta4, theta1, assembly.opposite())
                .ok()?
                .c;
            from_e + Vector2::new(base, 0.0)
        } else {
            let geometry = Geometry::new([l1, l2, l3, l4, base]).ok()?;
            geometry.forward(theta1, theta4, assembly).ok()?.c
        };
        let middle = 0.5 * (base - self.arm.geometry.base());
        let ideal = self.analysis.pose.c;
        Some([made.x - middle - ideal.x, made.y - ideal.y])
    }

    fn input_error(&self, noise: &mut Noise) -> Option<[f64; 1]> {
        let [theta1, theta4] = self.analysis.inputs.theta;
        let [max1, max4] = self.arm.tolerance.input_max;
        let mut within = |greatest: f64| greatest * (2.0 * noise.uniform() - 1.0);
        let (theta1, theta4) = (theta1 + within(max1), theta4 + within(max4));
        let assembly = self.analysis.pose.assembly();
        let pose = self.arm.geometry.forward(theta1, theta4, assembly).ok()?;
        Some([(pose.c - self.analysis.pose.c).norm()])
    }

    /// Pins on the rims of their bearings, in random directions.
    fn clearance_error(&self, noise: &mut Noise) -> Option<[f64; 2]> {
        let radii = self.arm.tolerance.clearance_radius;
        let offsets = radii.map(|radius| Vector2::unit(TAU * noise.uniform()) * radius);
        let (geometry, pose) = (self.arm.geometry, &self.analysis.pose);
        let exact = (tool_with_pin_offsets(geometry, pose, offsets).ok()? - pose.c).norm();
        // u2·δC = u2·e_left, u3·δC = u3·e_right.
        let [a, b, c, d, e] = offsets;
        let (p, q) = (pose.u2.dot(&(a + b)), pose.u3.dot(&(c + d + e)));
        let linear =
            (pose.u2.perpendicular() * q - pose.u3.perpendicular() * p) * (1.0 / pose.sin32());
        Some([exact, linear.norm()])
    }

    /// Ċ and C̈, torques and joint forces of an arm with random errors.
    fn motion_and_forces(
        &self,
        arm: &Arm<f64>,
        noise: &mut Noise,
    ) -> Option<([f64; 4], [f64; 12])> {
        let model = ArmAccuracyModel {
            arm,
            assembly: self.analysis.pose.assembly(),
            external_force: self.state.force,
        };
        let mut primitives = model.primitives(&self.analysis.inputs);
        let made = self.random_primitives(noise, |_| true);
        for (index, value) in SCATTERED.into_iter().zip(made) {
            primitives[index] = value;
        }
        let [_, _, results @ ..] = model.results(primitives).ok()?;
        let (motion, forces) = results.split_at(4);
        Some((motion.try_into().ok()?, forces.try_into().ok()?))
    }
}
