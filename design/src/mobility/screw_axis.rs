//! The members of a screw system that describe it best: lines of pitch zero, free vectors, and
//! screws of other pitch.
//!
//! The free vectors (couples, translations) are separated first. What remains is brought
//! to its principal screws, the eigenvectors of the pitch form ½(si·mj + sj·mi): where
//! two principal pitches differ in sign, two lines of pitch zero replace the pair.

use super::frame::ScaledFrame;
use super::system::{ScrewSystem, least_norm, row_and_null_space};
use nalgebra::{DMatrix, DVector, DVectorView, Vector3};

/// Pitches and components below this count as zero, in units of the mechanism's size.
const SMALL: f64 = 1e-7;

/// The pitch of a screw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pitch {
    /// A line: a rotation, or a force.
    Zero,
    /// A screw of this pitch [m/rad]: a helical motion, or a wrench.
    Finite(f64),
    /// A free vector: a translation, or a couple.
    Infinite,
}

/// A screw as its axis and pitch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScrewAxis {
    /// Its pitch.
    pub pitch: Pitch,
    /// The direction of its axis, of unit length.
    pub direction: Vector3<f64>,
    /// The point of its axis nearest to the mechanism's centre; none for a free vector.
    pub point: Option<Vector3<f64>>,
}

/// The members of `system`, which is written in `frame`, in the mechanism's own frame.
pub(super) fn screw_axes(system: &ScrewSystem, frame: &ScaledFrame) -> Vec<ScrewAxis> {
    let Parts { directed, free } = split(system);
    let lines = principal(&directed).into_iter().map(|(axis, moment)| {
        let pitch = axis.dot(&moment);
        ScrewAxis {
            pitch: if pitch.abs() < SMALL {
                Pitch::Zero
            } else {
                Pitch::Finite(pitch * frame.size)
            },
            direction: tidy(axis),
            point: Some(tidy(axis.cross(&moment) * frame.size + frame.centre)),
        }
    });
    let frees = echelon(&free).into_iter().map(|axis| ScrewAxis {
        pitch: Pitch::Infinite,
        direction: tidy(axis),
        point: None,
    });
    lines.chain(frees).collect()
}

/// A system divided into screws with a direction and free vectors.
struct Parts {
    /// Axis and moment; the axes are orthonormal.
    directed: Vec<Line>,
    /// Orthonormal columns.
    free: DMatrix<f64>,
}

type Line = (Vector3<f64>, Vector3<f64>);

fn split(system: &ScrewSystem) -> Parts {
    let basis = system.basis();
    let mut directions = basis.rows(0, 3).into_owned();
    // Rounding errors must not count as a direction.
    directions.apply(|x| *x = if x.abs() < SMALL { 0.0 } else { *x });
    let (combinations, rest) = row_and_null_space(&directions);
    let free = basis.rows(3, 3) * rest;
    let mut directed = Vec::new();
    if combinations.ncols() > 0 {
        let qr = (&directions * &combinations).qr();
        if let Some(to_orthonormal) = qr.r().try_inverse() {
            let moments = basis.rows(3, 3) * combinations * to_orthonormal;
            let pairs = qr
                .q()
                .column_iter()
                .map(vector3)
                .zip(moments.column_iter().map(vector3))
                .collect();
            directed = clear_pitches(pairs, &free);
        }
    }
    Parts { directed, free }
}

/// Adds to each screw the free vector that takes the pitch form as near to zero as may be:
/// Pij + ½(si·tj + sj·ti) = 0 with tj = free yj, solved for all yj by least squares. So
/// that a platform free to translate is said to turn about lines that meet.
fn clear_pitches(mut directed: Vec<Line>, free: &DMatrix<f64>) -> Vec<Line> {
    let (n, t) = (directed.len(), free.ncols());
    if t == 0 {
        return directed;
    }
    let form = pitch_form(&directed);
    let pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (i..n).map(move |j| (i, j))).collect();
    let mut system = DMatrix::zeros(pairs.len(), n * t);
    let mut wanted = DVector::zeros(pairs.len());
    for (row, &(i, j)) in pairs.iter().enumerate() {
        for k in 0..t {
            let along = vector3(free.column(k));
            system[(row, j * t + k)] += 0.5 * directed[i].0.dot(&along);
            system[(row, i * t + k)] += 0.5 * directed[j].0.dot(&along);
        }
        wanted[row] = -form[(i, j)];
    }
    if let Some(y) = least_norm(&system, &wanted) {
        for (j, (_, moment)) in directed.iter_mut().enumerate() {
            *moment += vector3((free * y.rows(j * t, t)).column(0));
        }
    }
    directed
}

fn pitch_form(directed: &[Line]) -> DMatrix<f64> {
    let n = directed.len();
    DMatrix::from_fn(n, n, |i, j| {
        0.5 * (directed[i].0.dot(&directed[j].1) + directed[j].0.dot(&directed[i].1))
    })
}

fn vector3(column: DVectorView<'_, f64>) -> Vector3<f64> {
    Vector3::new(column[0], column[1], column[2])
}

/// Principal screws, pairs of opposite pitch replaced by lines.
fn principal(directed: &[Line]) -> Vec<Line> {
    let n = directed.len();
    if n == 0 {
        return Vec::new();
    }
    let combine = |weights: &DVector<f64>| {
        directed.iter().zip(weights.iter()).fold(
            (Vector3::zeros(), Vector3::zeros()),
            |(axis, moment), (screw, weight)| {
                (axis + screw.0 * *weight, moment + screw.1 * *weight)
            },
        )
    };
    let eigen = pitch_form(directed).symmetric_eigen();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));

    let mut lines = Vec::new();
    // Any combination of screws of one pitch has this pitch too: the simplest axes are taken.
    let mut start = 0;
    let mut groups: Vec<(f64, Vec<DVector<f64>>)> = Vec::new();
    while start < n {
        let pitch = eigen.eigenvalues[order[start]];
        let group: Vec<DVector<f64>> = order[start..]
            .iter()
            .take_while(|&&i| eigen.eigenvalues[i] - pitch < SMALL)
            .map(|&i| eigen.eigenvectors.column(i).into_owned())
            .collect();
        start += group.len();
        groups.push((pitch, group));
    }
    let least = groups.first().map(|(pitch, group)| (*pitch, group.len()));
    let greatest = groups.last().map(|(pitch, group)| (*pitch, group.len()));
    if let (Some((low, 1)), Some((high, 1))) = (least, greatest)
        && low < -SMALL
        && high > SMALL
    {
        // h(φ) = low cos²φ + high sin²φ = 0 at tan φ = ±√(−low/high).
        let (sin, cos) = (-low / high).sqrt().atan().sin_cos();
        let (low, high) = (&groups[0].1[0], &groups[groups.len() - 1].1[0]);
        lines.push(combine(&(low * cos + high * sin)));
        lines.push(combine(&(low * cos - high * sin)));
        groups.pop();
        groups.remove(0);
    }
    for (_, group) in groups {
        let axes: Vec<Line> = group.iter().map(combine).collect();
        let directions = DMatrix::from_fn(3, axes.len(), |row, column| axes[column].0[row]);
        for axis in echelon(&directions) {
            // The directions of a group are orthonormal, so the weights are dot products.
            lines.push(axes.iter().fold(
                (Vector3::zeros(), Vector3::zeros()),
                |(sum_axis, sum_moment), screw| {
                    let weight = screw.0.dot(&axis);
                    (sum_axis + screw.0 * weight, sum_moment + screw.1 * weight)
                },
            ));
        }
    }
    lines
}

/// The simplest basis of the space spanned by the columns: reduced to echelon form, so
/// that coordinate axes appear where the space holds them. Unit vectors.
fn echelon(columns: &DMatrix<f64>) -> Vec<Vector3<f64>> {
    let mut rows: Vec<Vector3<f64>> = columns
        .column_iter()
        .map(|c| Vector3::new(c[0], c[1], c[2]))
        .collect();
    let mut done = 0;
    for axis in 0..3 {
        let Some(pivot) = (done..rows.len())
            .max_by(|&a, &b| rows[a][axis].abs().total_cmp(&rows[b][axis].abs()))
            .filter(|&row| rows[row][axis].abs() > SMALL)
        else {
            continue;
        };
        rows.swap(done, pivot);
        let lead = rows[done] / rows[done][axis];
        rows[done] = lead;
        for (index, row) in rows.iter_mut().enumerate() {
            if index != done {
                *row -= lead * row[axis];
            }
        }
        done += 1;
    }
    rows.into_iter().map(|row| row.normalize()).collect()
}

/// Sets rounding errors to zero.
fn tidy(vector: Vector3<f64>) -> Vector3<f64> {
    let threshold = 1e-9 * vector.amax().max(1.0);
    vector.map(|x| if x.abs() < threshold { 0.0 } else { x })
}
