//! Where the joint fit starts: at the legs, and at the nominal arm where it fits the holes best.

use super::parameters::Parameters;
use super::plate::Touch;
use super::tip::posed;
use crate::Noise;
use fivebar_kinematics::five_bar::Side;
use nalgebra::{Rotation2, Vector2};

/// Samples of nine touches for the linear starts; the same for the same touches.
pub(super) fn samples(touches: &[Touch]) -> Vec<Vec<Touch>> {
    const SAMPLES: usize = 120;
    const SIZE: usize = 9;
    if touches.len() <= SIZE {
        return Vec::new();
    }
    let mut noise = Noise::new(1);
    let mut sample = || {
        let mut order: Vec<Touch> = touches.to_vec();
        for i in 0..SIZE {
            let rest = order.len() - i;
            let chosen = i + (noise.uniform() * rest as f64) as usize;
            order.swap(i, chosen);
        }
        order.truncate(SIZE);
        order
    };
    (0..SAMPLES).map(|_| sample()).collect()
}

/// The arm with these lengths and offsets, placed so that its tips are nearest to the holes: with
/// tips a_k and holes b_k about their middles, φ = atan2(Σ a×b, Σ a·b). None if fewer than three
/// of the touches have a pose.
pub(super) fn placed(
    lengths: [f64; 5],
    offsets: [f64; 2],
    touches: &[Touch],
    assembly: Side,
) -> Option<Parameters> {
    let mut p = Parameters {
        lengths,
        offsets,
        ..Parameters::default()
    };
    let pairs: Vec<_> = touches
        .iter()
        .filter_map(|touch| Some((posed(&p, touch.encoder, assembly)?.c, touch.hole)))
        .collect();
    if pairs.len() < 3 {
        return None;
    }
    let per_count = 1.0 / pairs.len() as f64;
    let tips = pairs.iter().map(|(tip, _)| tip).sum::<Vector2<f64>>() * per_count;
    let holes = pairs.iter().map(|(_, hole)| hole).sum::<Vector2<f64>>() * per_count;
    let (mut cross, mut dot) = (0.0, 0.0);
    for (tip, hole) in &pairs {
        let (a, b) = (tip - tips, hole - holes);
        cross += a.perp(&b);
        dot += a.dot(&b);
    }
    p.turn = cross.atan2(dot);
    p.origin = (holes - Rotation2::new(p.turn) * tips).into();
    Some(p)
}
