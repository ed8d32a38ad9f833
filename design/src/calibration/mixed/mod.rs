//! Calibration from measurements of any kinds: known holes of a plate, distances, unknown holes
//! that are touched in several working modes, photographs of what the tip drew.
//!
//! Without a plate the arm has no placement and seven unknowns, l1…l5, δ1, δ4. Unknown holes and
//! photographs do not show the scale: at least one distance, or a plate, must be among the
//! measurements.

mod photo;
mod problem;
mod seen;

use super::error::CalibrationError;
use super::measurements::{Criterion, Measurements, Plate};
use super::parameters::Parameters;
use super::plate::{calibrate, half_a_turn_off, other_length};
use super::start::placed;
use crate::fit::{median, minimise};
use core::cmp::Ordering;
use fivebar_kinematics::five_bar::{Geometry, Side};
use nalgebra::{DVector, SMatrix};
use problem::Problem;
use seen::{determined, without_nuisances};

/// The measurements of one kind after the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct KindResult {
    /// The kind: `plate`, `bars`, `holes` or `photo 1`, `photo 2` and so on.
    pub kind: String,
    /// The distance of each measurement from the fit [m].
    pub distances: Vec<f64>,
    /// Root mean square of the residuals, without the rejected ones with Huber's loss [m].
    pub residual_rms: f64,
    /// Those farther than 4 σ from the fit, by their index from 0.
    pub rejected: Vec<usize>,
}

/// An arm as calibrated.
#[derive(Clone, Debug, PartialEq)]
pub struct MixedCalibration {
    /// The arm; without a plate its placement is zero.
    pub parameters: Parameters,
    /// Whether its placement is known: with a plate.
    pub placed: bool,
    /// The covariance of l1…l5, δ1, δ4, x, y, φ, from the stated deviations; with Huber's loss
    /// without the rejected measurements. Without a plate the last three are zero.
    pub covariance: SMatrix<f64, 10, 10>,
    /// The kinds that were measured.
    pub kinds: Vec<KindResult>,
    /// How many more residuals there are than unknowns, those of holes and photographs included.
    pub excess: usize,
    /// Rank of the Jacobian of the arm's unknowns, in units of 0.1 m, 1 rad and σ, without what the
    /// unknown holes and photographs take up: 10, or 7 without a plate.
    pub rank: usize,
    /// Its condition.
    pub condition: f64,
}

/// The greatest median of the residuals of a credible fit [σ].
const CREDIBLE: f64 = 50.0;
/// The greatest share of one kind that may be far from the fit.
const FEW: f64 = 1.0 / 3.0;

/// Finds an arm from measurements of any kinds. `nominal` are the lengths as drawn [m]; the fit
/// starts there, with zero offsets, and where the plate alone determines the arm, also from that.
///
/// # Errors
/// What the measurements do not determine, and measurements of another mode, arm or order.
pub fn calibrate_mixed(
    measured: &Measurements,
    nominal: [f64; 5],
) -> Result<MixedCalibration, CalibrationError> {
    measured.check()?;
    Geometry::new(nominal).map_err(|_| CalibrationError::Lengths)?;
    let here = measured.assembly;
    let [l1, l2, l3, l4, l5] = nominal;
    let half_turn = [core::f64::consts::PI; 2];
    let start = |lengths, offsets, side| {
        let free = Parameters {
            lengths,
            offsets,
            ..Parameters::default()
        };
        if measured.plate.is_empty() {
            Some(free)
        } else {
            placed(lengths, offsets, &measured.plate, side)
        }
    };
    // Residuals are in units of their deviations.
    let loss = measured.criterion.loss(1.0);
    let fit = |arm: Option<Parameters>, side: Side| {
        let problem = Problem::new(measured, side);
        let (x, loss) = minimise(&problem.start(&arm?)?, &|x| problem.rows(x), loss)?;
        let (residuals, _) = problem.rows(&x)?;
        let typical = median(residuals.iter().map(|r| r.abs())).unwrap_or(f64::INFINITY);
        Some(Fit { x, loss, typical })
    };
    if measured.plate.is_empty() && measured.bars.is_empty() {
        // Whatever the fit, all lengths may grow together.
        return Err(CalibrationError::NoScale);
    }
    let plate = Plate {
        touches: measured.plate.clone(),
        assembly: here,
        sigma: measured.deviations.plate,
        criterion: measured.criterion,
    };
    let by_plate = calibrate(&plate, nominal)
        .ok()
        .map(|found| found.parameters);
    let starts = [start(nominal, [0.0; 2], here), by_plate];
    let fits = starts.into_iter().filter_map(|arm| fit(arm, here));
    let found = fits.min_by(Fit::by_loss);
    let off = found.as_ref().map_or(f64::INFINITY, |fit| fit.typical);
    if off > 6.0 {
        // Half a turn off in the other assembly mode the joints are exchanged.
        let there = here.opposite();
        let others = [
            fit(start(nominal, [0.0; 2], there), there),
            fit(start([l4, l3, l2, l1, l5], half_turn, there), there),
        ];
        let other = others.into_iter().flatten().min_by(Fit::by_loss);
        if let Some(Fit { x, typical, .. }) = other
            && typical < 0.25 * off
            && typical <= CREDIBLE
        {
            return Err(if half_a_turn_off(&Problem::new(measured, there).arm(&x)) {
                CalibrationError::SwappedJoints
            } else {
                CalibrationError::OtherAssembly
            });
        }
    }
    let problem = Problem::new(measured, here);
    match found.filter(|fit| fit.typical <= CREDIBLE) {
        Some(fit) => judged(measured, &problem, &fit.x, nominal),
        None => Err(CalibrationError::MixedNoFit(off)),
    }
}

/// The unknowns with the least loss near one start.
struct Fit {
    x: DVector<f64>,
    loss: f64,
    /// The median size of the residuals [σ].
    typical: f64,
}

impl Fit {
    fn by_loss(&self, other: &Self) -> Ordering {
        self.loss.total_cmp(&other.loss)
    }
}

/// The calibration at the best fit, checked.
fn judged(
    measured: &Measurements,
    problem: &Problem<'_>,
    x: &DVector<f64>,
    nominal: [f64; 5],
) -> Result<MixedCalibration, CalibrationError> {
    let (residuals, jacobian) = problem.rows(x).ok_or(CalibrationError::Lengths)?;
    let p = problem.arm(x);
    let mut used = Vec::new();
    let mut kinds = Vec::new();
    let mut first = 0;
    for Kind {
        name,
        count,
        size,
        sigma,
    } in Kind::all(measured)
    {
        let rows = |k: usize| first + size * k..first + size * (k + 1);
        let distance = |k| residuals.rows_range(rows(k)).norm();
        let distances: Vec<f64> = (0..count).map(distance).collect();
        let rejected: Vec<usize> = (0..count).filter(|&k| distances[k] > 4.0).collect();
        let kept = (0..count)
            .filter(|k| measured.criterion == Criterion::LeastSquares || !rejected.contains(k));
        let kept: Vec<usize> = kept.flat_map(rows).collect();
        let squares: f64 = kept.iter().map(|&row| residuals[row].powi(2)).sum();
        kinds.push(KindResult {
            kind: name,
            residual_rms: sigma * (squares / kept.len().max(1) as f64).sqrt(),
            distances: distances.iter().map(|distance| sigma * distance).collect(),
            rejected,
        });
        used.extend(kept);
        first += size * count;
    }
    let share = |kind: &KindResult| kind.rejected.len() as f64 / kind.distances.len() as f64;
    let worst = kinds.iter().max_by(|a, b| share(a).total_cmp(&share(b)));
    if let Some(kind) = worst.filter(|kind| share(kind) > FEW) {
        return Err(CalibrationError::Contradicts {
            kind: kind.kind.clone(),
            far: kind.rejected.len(),
            of: kind.distances.len(),
        });
    }
    let arm = without_nuisances(&jacobian.select_rows(&used), problem.arm_unknowns());
    let seen = determined(&arm, &p)?;
    if half_a_turn_off(&p) {
        return Err(CalibrationError::SwappedJoints);
    }
    other_length(&p, &seen.covariance, nominal)?;
    Ok(MixedCalibration {
        parameters: p,
        placed: !measured.plate.is_empty(),
        covariance: seen.covariance,
        kinds,
        excess: used.len().saturating_sub(problem.unknowns()),
        rank: seen.rank,
        condition: seen.condition,
    })
}

/// A kind of measurement and its rows.
struct Kind {
    name: String,
    /// How many were measured.
    count: usize,
    /// Rows of each.
    size: usize,
    /// Standard deviation of a row [m].
    sigma: f64,
}

impl Kind {
    /// The kinds that were measured, in the order of their rows.
    fn all(measured: &Measurements) -> Vec<Self> {
        let kind = |name: &str, count, size, sigma| Self {
            name: name.into(),
            count,
            size,
            sigma,
        };
        let sigma = measured.deviations;
        let mut kinds = vec![
            kind("plate", measured.plate.len(), 2, sigma.plate),
            kind("bars", measured.bars.len(), 1, sigma.bar),
            kind("holes", measured.holes.len(), 2, sigma.hole),
        ];
        for (index, photo) in measured.photos.iter().enumerate() {
            let name = format!("photo {}", index + 1);
            kinds.push(kind(&name, photo.len(), 2, sigma.photo));
        }
        kinds.retain(|kind| kind.count > 0);
        kinds
    }
}
