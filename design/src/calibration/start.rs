//! Where the joint fit starts: at the legs, and at the nominal arm where it fits the holes best.

use super::measurements::Touch;
use super::parameters::Parameters;
use super::tip::posed;
use crate::Noise;
use fivebar_kinematics::five_bar::Side;
use nalgebra::{Isometry2, UnitComplex, Vector2};

/// How many samples of the touches are drawn. If a fifth of the touches is wrong, one of nine is free
/// of these in 13 % of the draws, and no sample at all in 10⁻⁷ of the cases.
const SAMPLES: usize = 120;
/// The touches of a sample: two more than the seven that a leg's linear start needs.
const SIZE: usize = 9;

/// Samples of nine touches for the linear starts; the same for the same touches.
pub(super) fn samples(touches: &[Touch]) -> Vec<Vec<Touch>> {
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

/// The arm with these lengths and offsets, placed so that its tips are nearest to the holes. None
/// if fewer than three of the touches have a pose.
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
    let placement = rigid(
        &pairs
            .iter()
            .map(|(tip, hole)| (*hole, *tip))
            .collect::<Vec<_>>(),
    )?;
    p.turn = placement.rotation.angle();
    p.origin = placement.translation.vector.into();
    Some(p)
}

/// The turn and shift that bring the second points nearest to the first ones: with points a and b
/// about their middles, φ = atan2(Σ b×a, Σ b·a). None without points.
///
/// ```
/// use fivebar_design::calibration::rigid;
/// use nalgebra::{Isometry2, Vector2};
///
/// let placed = Isometry2::new(Vector2::new(0.01, -0.02), 0.3);
/// let drawn = [Vector2::new(0.0, 0.1), Vector2::new(0.05, 0.2), Vector2::new(-0.03, 0.15)];
/// let pairs = drawn.map(|point| ((placed * nalgebra::Point2::from(point)).coords, point));
/// let found = rigid(&pairs).unwrap();
/// assert!((found.rotation.angle() - 0.3).abs() < 1e-12);
/// ```
pub fn rigid(pairs: &[(Vector2<f64>, Vector2<f64>)]) -> Option<Isometry2<f64>> {
    let per_count = (!pairs.is_empty()).then(|| 1.0 / pairs.len() as f64)?;
    let to = pairs.iter().map(|(a, _)| a).sum::<Vector2<f64>>() * per_count;
    let from = pairs.iter().map(|(_, b)| b).sum::<Vector2<f64>>() * per_count;
    let (mut cross, mut dot) = (0.0, 0.0);
    for (a, b) in pairs {
        let (a, b) = (a - to, b - from);
        cross += b.perp(&a);
        dot += b.dot(&a);
    }
    let turn = UnitComplex::new(cross.atan2(dot));
    Some(Isometry2::from_parts((to - turn * from).into(), turn))
}
