//! Calibration from measurements of any kinds: known holes of a plate, distances, unknown holes
//! that are touched in several working modes, photographs of what the tip drew.
//!
//! Without a plate the arm has no placement and seven unknowns, l1…l5, δ1, δ4; without a base,
//! five ([`Unknowns`]). Unknown holes and
//! photographs do not show the scale: at least one distance, or a plate, must be among the
//! measurements.

mod photo;
mod problem;
mod seen;

use super::error::CalibrationError;
use super::measurements::{Criterion, Measurements, Plate};
use super::parameters::Parameters;
use super::plate::{calibrate, half_a_turn_off, of_other_mode, other_length};
use super::start::placed;
use super::unknowns::Unknowns;
use crate::fit::{median, minimise};
use crate::robust::{self, Block, Scale, Settled};
use crate::statistics::{NORMAL_95, coverage_factor};
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
    /// Those that the others contradict, by their index from 0: with Huber's loss they are left out.
    /// With least squares, those farther than 4 σ from the fit, which are used.
    pub rejected: Vec<usize>,
    /// Their real deviation over the stated one: 1 as long as the residuals are such as the stated
    /// one would give.
    pub sigma_scale: f64,
    /// Degrees of freedom with which the scale was found; infinite where σ is as stated.
    pub freedom: f64,
}

/// An arm as calibrated.
#[derive(Clone, Debug, PartialEq)]
pub struct MixedCalibration {
    /// The arm; without a plate its placement is zero.
    pub parameters: Parameters,
    /// Whether its placement is known: with a plate.
    pub placed: bool,
    /// The covariance of l1…l5, δ1, δ4, x, y, φ, of the measurements that are used, with the deviations
    /// that their residuals show; with least squares of all, with the stated ones. Zero for what is held, and
    /// without a plate for the last three.
    pub covariance: SMatrix<f64, 10, 10>,
    /// With this factor of its deviation on either side, an unknown's interval holds 95 %: 1.96, or
    /// Student's quantile with the least freedom with which a scale was found.
    pub coverage_factor: f64,
    /// The kinds that were measured.
    pub kinds: Vec<KindResult>,
    /// How many more residuals there are than unknowns, those of holes and photographs included.
    pub excess: usize,
    /// Rank of the Jacobian of the arm's unknowns, in units of 0.1 m, 1 rad and σ, without what the
    /// unknown holes and photographs take up: 10, or 7 without a plate; of an arm without a base 8, or 5.
    pub rank: usize,
    /// Its condition.
    pub condition: f64,
}

/// The greatest median of the residuals of a credible fit [σ].
const CREDIBLE: f64 = 50.0;
/// The greatest share of one kind that may be far from a fit of least squares.
const FEW: f64 = 1.0 / 3.0;
/// The greatest share of one kind that may be left out.
const FEW_LEFT_OUT: f64 = 0.25;
/// The share of one kind among several beyond which the whole kind is of another arm.
const MOST_LEFT_OUT: f64 = 0.5;
/// The greatest scale of one kind among several: beyond, it is of another arm rather than worse than
/// stated.
const WORSE: f64 = 4.0;

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
    let unknowns = Unknowns::of(nominal);
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
        let problem = Problem::new(measured, unknowns, side);
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
            let arm = Problem::new(measured, unknowns, there).arm(&x);
            return Err(of_other_mode(&arm, unknowns));
        }
    }
    let problem = Problem::new(measured, unknowns, here);
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

/// A fit with the measurements that it uses.
struct Judged {
    x: DVector<f64>,
    /// Whether a measurement is used.
    used: Vec<bool>,
    scales: Vec<Scale>,
    /// The squares of the deviations that the covariance is made with [σ²], one for each kind.
    variances: Vec<f64>,
}

/// From a fit by the criterion of the measurements.
fn judge(
    criterion: Criterion,
    problem: &Problem<'_>,
    x: &DVector<f64>,
    blocks: &[Block],
) -> Option<Judged> {
    match criterion {
        Criterion::Huber => {
            let Settled { x, kept, scales } = robust::settle(x, &|x| problem.rows(x), blocks)?;
            let variances = scales.iter().map(|scale| scale.variance).collect();
            Some(Judged {
                x,
                used: kept,
                scales,
                variances,
            })
        }
        Criterion::LeastSquares => {
            let scales = robust::scales(problem.rows(x)?, blocks);
            Some(Judged {
                x: x.clone(),
                used: vec![true; blocks.len()],
                variances: vec![1.0; scales.len()],
                scales,
            })
        }
    }
}

/// The calibration at the best fit, checked.
fn judged(
    measured: &Measurements,
    problem: &Problem<'_>,
    x: &DVector<f64>,
    nominal: [f64; 5],
) -> Result<MixedCalibration, CalibrationError> {
    let all = Kind::all(measured);
    let blocks = Kind::blocks(&all);
    let Judged {
        x,
        used,
        scales,
        variances,
    } = judge(measured.criterion, problem, x, &blocks).ok_or(CalibrationError::Lengths)?;
    let (residuals, mut jacobian) = problem.rows(&x).ok_or(CalibrationError::Lengths)?;
    let distance = |block: &Block| residuals.rows_range(block.rows()).norm();
    let mut kinds = Vec::new();
    for (number, kind) in all.iter().enumerate() {
        let own = blocks.iter().zip(&used);
        let own: Vec<_> = own.filter(|(block, _)| block.kind == number).collect();
        let distances: Vec<f64> = own.iter().map(|(block, _)| distance(block)).collect();
        let rejected = own.iter().enumerate().filter(|(_, (block, used))| {
            !**used || measured.criterion == Criterion::LeastSquares && distance(block) > 4.0
        });
        let rejected: Vec<usize> = rejected.map(|(index, _)| index).collect();
        check_kind(
            measured.criterion,
            kind,
            &distances,
            &rejected,
            scales[number].value,
            all.len(),
        )?;
        let kept = own.iter().filter(|(_, used)| **used);
        let squares: f64 = kept.clone().map(|(block, _)| distance(block).powi(2)).sum();
        let rows: usize = kept.map(|(block, _)| block.size).sum();
        kinds.push(KindResult {
            kind: kind.name.clone(),
            residual_rms: kind.sigma * (squares / rows.max(1) as f64).sqrt(),
            distances: distances
                .iter()
                .map(|distance| kind.sigma * distance)
                .collect(),
            rejected,
            sigma_scale: scales[number].value,
            freedom: scales[number].freedom,
        });
    }
    for block in &blocks {
        for row in block.rows() {
            jacobian
                .row_mut(row)
                .scale_mut(1.0 / variances[block.kind].sqrt());
        }
    }
    let kept = blocks.iter().zip(&used).filter(|(_, used)| **used);
    let kept: Vec<usize> = kept.flat_map(|(block, _)| block.rows()).collect();
    let p = problem.arm(&x);
    let unknowns = problem.arm_unknowns();
    let arm = without_nuisances(&jacobian.select_rows(&kept), unknowns.count());
    let seen = determined(&arm, unknowns, &p)?;
    if half_a_turn_off(&p, unknowns) {
        return Err(CalibrationError::SwappedJoints);
    }
    other_length(&p, &seen.covariance, nominal)?;
    let freedom = scales.iter().map(|scale| scale.freedom);
    Ok(MixedCalibration {
        parameters: p,
        placed: !measured.plate.is_empty(),
        covariance: seen.covariance,
        coverage_factor: match measured.criterion {
            Criterion::Huber => coverage_factor(freedom.fold(f64::INFINITY, f64::min)),
            Criterion::LeastSquares => NORMAL_95,
        },
        kinds,
        excess: kept.len().saturating_sub(problem.unknowns()),
        rank: seen.rank,
        condition: seen.condition,
    })
}

/// Refuses a kind of which too much contradicts the rest.
fn check_kind(
    criterion: Criterion,
    kind: &Kind,
    distances: &[f64],
    rejected: &[usize],
    scale: f64,
    kinds: usize,
) -> Result<(), CalibrationError> {
    let share = rejected.len() as f64 / distances.len() as f64;
    let another_arm = kinds > 1 && share > MOST_LEFT_OUT;
    if criterion == Criterion::Huber && share > FEW_LEFT_OUT && !another_arm {
        return Err(CalibrationError::TooManyWrong {
            kind: kind.name.clone(),
            rows: rejected.to_vec(),
            of: distances.len(),
        });
    }
    let contradicts = match criterion {
        Criterion::Huber => another_arm || kinds > 1 && scale > WORSE,
        Criterion::LeastSquares => share > FEW,
    };
    if contradicts {
        return Err(CalibrationError::Contradicts {
            kind: kind.name.clone(),
            far: distances.iter().filter(|distance| **distance > 4.0).count(),
            of: distances.len(),
        });
    }
    Ok(())
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

    /// The rows of each measurement.
    fn blocks(kinds: &[Self]) -> Vec<Block> {
        let mut first = 0;
        let mut blocks = Vec::new();
        for (kind, Self { count, size, .. }) in kinds.iter().enumerate() {
            for _ in 0..*count {
                blocks.push(Block {
                    first,
                    size: *size,
                    kind,
                });
                first += size;
            }
        }
        blocks
    }
}
