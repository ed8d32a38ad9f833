//! The poses that determine an arm best, by D-optimality.
//!
//! A pose adds its two rows A of the scaled Jacobian to W = Σ AᵀA, and multiplies det W by
//! det(I + A W⁻¹ Aᵀ). The exchange (Mitchell 1974, DETMAX) adds the candidate with the greatest
//! gain and drops the pose with the smallest loss, until both are the same. The observability
//! index is O1 = (∏ σi)^{1/n}/√K for n unknowns (Borm and Menq 1991): ten, or eight of an arm
//! without a base ([`Unknowns`]). W has a one in place of each that is held.

use super::parameters::{Parameters, SCALES};
use super::tip::on_plate;
use super::unknowns::Unknowns;
use crate::Noise;
use crate::workspace::reach_bounds;
use fivebar_kinematics::five_bar::{Pose, Workspace};
use nalgebra::{Matrix2, SMatrix, Vector2};

type Row = SMatrix<f64, 2, 10>;
type Square = SMatrix<f64, 10, 10>;

/// The least |sin| at the elbows and at C of a proposed pose; near a singularity, the arm is
/// sensitive to what the model leaves out.
const MARGIN: f64 = 0.3;

/// Poses to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// C in the arm's own frame [m].
    pub points: Vec<Vector2<f64>>,
    /// O1 = (∏ σi)^{1/n}/√K of the scaled Jacobian, for n unknowns.
    pub observability: f64,
    /// The covariance of the unknowns for holes with a standard deviation of 1 m; zero for what is held.
    pub covariance: Square,
}

/// The points of a grid that the arm reaches from its home without leaving its joint limits or
/// its singularity margin, with the poses there. On an arm with links of half a metre together
/// the points are 10 mm apart; they lie on multiples of the pitch.
pub(super) fn reached(
    workspace: &Workspace<f64>,
    home: &Pose<f64>,
) -> Vec<(Vector2<f64>, Pose<f64>)> {
    let lengths = workspace.tool.geometry().lengths();
    let pitch = lengths[..4].iter().sum::<f64>() / 52.0;
    let [low, high] = reach_bounds(&workspace.tool);
    let first = (low / pitch).map(|value| value.floor() as i32);
    let count = (high / pitch).map(|value| value.ceil() as i32) - first;
    let columns = (count.x + 1) as usize;
    let cells = columns * (count.y + 1) as usize;
    let point = |index: usize| {
        let (x, y) = ((index % columns) as i32, (index / columns) as i32);
        Vector2::new(f64::from(first.x + x), f64::from(first.y + y)) * pitch
    };
    let found: Vec<_> = (0..cells)
        .map(|index| {
            let pose = pose_within(workspace, point(index))?;
            (pose.0.assembly() == home.assembly()).then_some(pose)
        })
        .collect();
    let distance = |index: &usize| (point(*index) - home.c).norm();
    let near = |a: &usize, b: &usize| distance(a).total_cmp(&distance(b));
    let start = (0..cells)
        .filter(|&index| found[index].is_some())
        .min_by(near);
    // From point to point, without a jump of the joints.
    let mut is_reached = vec![false; cells];
    let mut open: Vec<usize> = start.into_iter().collect();
    while let Some(index) = open.pop() {
        if std::mem::replace(&mut is_reached[index], true) {
            continue;
        }
        let [x, y] = [index % columns, index / columns];
        let mut neighbours = Vec::new();
        if x > 0 {
            neighbours.push(index - 1);
        }
        if x + 1 < columns {
            neighbours.push(index + 1);
        }
        if y > 0 {
            neighbours.push(index - columns);
        }
        if index + columns < cells {
            neighbours.push(index + columns);
        }
        for next in neighbours {
            if let (Some((_, from)), Some((_, to))) = (&found[index], &found[next])
                && (from[0] - to[0]).abs() < 1.0
                && (from[1] - to[1]).abs() < 1.0
            {
                open.push(next);
            }
        }
    }
    (0..cells)
        .filter(|&index| is_reached[index])
        .filter_map(|index| Some((point(index), found[index]?.0)))
        .collect()
}

/// The pose with C at a point and its θ1, θ4 within the limits, if each |sin| at the elbows and
/// at C is at least the margin.
fn pose_within(workspace: &Workspace<f64>, c: Vector2<f64>) -> Option<(Pose<f64>, [f64; 2])> {
    let geometry = workspace.tool.geometry();
    let pose = geometry.inverse(c, workspace.mode).ok()?;
    let [theta1, _, _, theta4] = pose.angles();
    let angles = match workspace.limits {
        Some(limits) => limits.angles_within(theta1, theta4).ok()?,
        None => [theta1, theta4],
    };
    (least_sine(&pose) >= workspace.margin).then_some((pose, angles))
}

fn least_sine(pose: &Pose<f64>) -> f64 {
    let sines = [pose.sin21(), pose.sin34(), pose.sin32()];
    sines.map(f64::abs).into_iter().fold(1.0, f64::min)
}

/// The `count` poses that an arm reaches from its home, in the working mode of C and the assembly
/// mode there, that determine its unknowns best; none if it reaches too few points or `count`
/// is below 5.
pub fn propose(workspace: &Workspace<f64>, home: &Pose<f64>, count: usize) -> Option<Proposal> {
    let p = Parameters {
        lengths: workspace.tool.geometry().lengths(),
        ..Parameters::default()
    };
    let unknowns = Unknowns::of(p.lengths);
    let held = Square::from_fn(|i, j| f64::from(i == j && !unknowns.is_free(i)));
    let points = reached(workspace, home);
    let candidates = |margin: f64| -> Vec<(Vector2<f64>, Row)> {
        let within = points.iter().filter(|(_, pose)| least_sine(pose) >= margin);
        let row = |(c, pose): &(Vector2<f64>, Pose<f64>)| {
            let mut row = on_plate(&p, pose).jacobian;
            for (index, mut column) in row.column_iter_mut().enumerate() {
                match unknowns.is_free(index) {
                    true => column *= SCALES[index],
                    false => column.fill(0.0),
                }
            }
            (*c, row)
        };
        within.map(row).collect()
    };
    let mut found = candidates(MARGIN);
    if found.len() < 5 * count.max(8) {
        found = candidates(workspace.margin);
    }
    if count < 5 || found.len() < count {
        return None;
    }
    let mut noise = Noise::new(1);
    let (chosen, _) = (0..8)
        .map(|_| exchange(&found, count, &held, &mut noise))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let rows = chosen.iter().map(|&index| &found[index].1);
    let information: Square = rows.map(|row| row.transpose() * row).sum();
    let information = information + held;
    let covariance = information.try_inverse()? - held;
    let covariance = Square::from_fn(|i, j| covariance[(i, j)] * SCALES[i] * SCALES[j]);
    Some(Proposal {
        points: chosen.iter().map(|&index| found[index].0).collect(),
        // det W is the square of the product of the singular values.
        observability: (0.5 / unknowns.count() as f64 * log_determinant(&information)).exp()
            / (count as f64).sqrt(),
        covariance,
    })
}

fn log_determinant(w: &Square) -> f64 {
    match w.cholesky() {
        Some(factor) => 2.0 * factor.l().diagonal().iter().map(|x| x.ln()).sum::<f64>(),
        None => f64::NEG_INFINITY,
    }
}

/// One exchange from random poses: their indices and ln det W.
fn exchange(
    candidates: &[(Vector2<f64>, Row)],
    count: usize,
    held: &Square,
    noise: &mut Noise,
) -> (Vec<usize>, f64) {
    let total = candidates.len();
    let mut chosen: Vec<usize> = Vec::new();
    while chosen.len() < count {
        let index = (noise.uniform() * total as f64) as usize;
        if !chosen.contains(&index) {
            chosen.push(index);
        }
    }
    // A small multiple of one keeps W invertible until the poses determine all.
    let mut w: Square = Square::identity() * 1e-9 + held;
    for &index in &chosen {
        w += candidates[index].1.transpose() * candidates[index].1;
    }
    for _ in 0..200 * count {
        let Some(inverse) = w.try_inverse() else {
            break;
        };
        let gain = |index: usize, sign: f64| {
            let a = &candidates[index].1;
            (Matrix2::identity() + a * inverse * a.transpose() * sign).determinant()
        };
        let added = (0..total)
            .filter(|index| !chosen.contains(index))
            .max_by(|&a, &b| gain(a, 1.0).total_cmp(&gain(b, 1.0)));
        let Some(added) = added else { break };
        w += candidates[added].1.transpose() * candidates[added].1;
        chosen.push(added);
        let Some(inverse) = w.try_inverse() else {
            break;
        };
        let kept = |index: usize| {
            let a = &candidates[index].1;
            (Matrix2::identity() - a * inverse * a.transpose()).determinant()
        };
        let dropped = (0..chosen.len())
            .max_by(|&a, &b| kept(chosen[a]).total_cmp(&kept(chosen[b])))
            .unwrap_or(0);
        let index = chosen.remove(dropped);
        w -= candidates[index].1.transpose() * candidates[index].1;
        if index == added {
            break;
        }
    }
    let w: Square = chosen
        .iter()
        .map(|&index| candidates[index].1.transpose() * candidates[index].1)
        .sum();
    let determinant = log_determinant(&(w + held));
    (chosen, determinant)
}
