//! The calibration from a plate with known holes.

use super::error::CalibrationError;
use super::legs::{LEAST_FOR_LEGS, joined, leg};
use super::measurements::{Criterion, Plate, Touch, different};
use super::observability::{check_seen, covariance, leave_out, rank_and_condition};
use super::parameters::Parameters;
use super::start::{placed, samples};
use super::tip::{on_plate, posed, tip};
use super::unknowns::Unknowns;
use crate::fit::{Rows, median, minimise};
use crate::robust::{self, Block, Scale, Settled};
use crate::statistics::{NORMAL_95, coverage_factor};
use core::f64::consts::{FRAC_PI_2, PI};
use fivebar_kinematics::five_bar::{Geometry, Joint, Side};
use nalgebra::{DMatrix, DVector, SMatrix, Vector2};

/// An arm as calibrated.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// The unknowns.
    pub parameters: Parameters,
    /// Their covariance: of the touches that are used, with the deviation that their residuals show
    /// ([`sigma_scale`](Self::sigma_scale)); with least squares of all touches, with the stated one.
    /// Zero for what is held ([`Unknowns`]).
    pub covariance: SMatrix<f64, 10, 10>,
    /// The residual of each touch [m].
    pub residuals: Vec<Vector2<f64>>,
    /// Root mean square of the residuals' coordinates, with Huber's loss without the rejected
    /// touches [m].
    pub residual_rms: f64,
    /// The same, each touch being predicted from the others [m].
    pub leave_out_rms: f64,
    /// The real deviation of the holes over the stated one: 1 as long as the residuals are such as
    /// the stated one would give.
    pub sigma_scale: f64,
    /// Degrees of freedom with which the scale was found; infinite where σ is as stated.
    pub freedom: f64,
    /// With this factor of its deviation on either side, an unknown's interval holds 95 %: 1.96, or
    /// Student's quantile where the scale was found from the residuals.
    pub coverage_factor: f64,
    /// The touches that the others contradict, by their index from 0: with Huber's loss they are
    /// left out. With least squares, those farther than 4 σ from the fit, which are used.
    pub rejected: Vec<usize>,
    /// The touches with other elbows than most, by their index from 0.
    pub other_elbows: Vec<usize>,
    /// Rank of the Jacobian with its columns scaled by 0.1 m and 1 rad: 10, or 8 without a base.
    pub rank: usize,
    /// Its condition.
    pub condition: f64,
    /// Root mean square distance of the touches from the nominal arm, placed where it fits best
    /// [m]; none where it has no pose.
    pub nominal_rms: Option<f64>,
}

/// The greatest share of the touches that may be left out.
const FEW: f64 = 0.25;
/// The greatest share by which a length may differ from the nominal one.
const GREATEST_CHANGE: f64 = 0.25;

/// Finds lengths, joint offsets and placement of an arm from the touches of a plate. `nominal` are
/// the lengths as drawn [m]; they serve as one of the starts, and show whether the touches are of another arm.
///
/// # Errors
/// What the points do not determine, and points of another mode, arm or order.
pub fn calibrate(plate: &Plate, nominal: [f64; 5]) -> Result<Calibration, CalibrationError> {
    check(plate)?;
    Geometry::new(nominal).map_err(|_| CalibrationError::Lengths)?;
    let [l1, l2, l3, l4, l5] = nominal;
    let unknowns = Unknowns::of(nominal);
    let (touches, here, there) = (&plate.touches, plate.assembly, plate.assembly.opposite());
    let straight = placed(nominal, [0.0; 2], touches, here);
    let mut starts = [straight.map(|p| (p, here)), legs_start(plate, unknowns)];
    // Points that do not fit in this assembly mode may fit in the other: then they were measured
    // there, or the joints are exchanged.
    let exchanged = [l4, l3, l2, l1, l5];
    let others = [
        placed(nominal, [0.0; 2], touches, there),
        placed(exchanged, [PI; 2], touches, there),
        starts[1].filter(|(_, side)| *side == there).map(|(p, _)| p),
    ];
    if let Some((_, side)) = &mut starts[1] {
        *side = here;
    }
    let fitted = |p: &Parameters, side: Side| joint_fit(plate, unknowns, p, side);
    let best = |a: &(Parameters, f64), b: &(Parameters, f64)| a.1.total_cmp(&b.1);
    let found = starts
        .iter()
        .flatten()
        .filter_map(|(p, side)| fitted(p, *side))
        .min_by(best);
    let typical = found.map_or(f64::INFINITY, |(p, _)| typical_distance(plate, &p, here));
    if typical > 6.0 * plate.sigma {
        let other = others.iter().flatten().filter_map(|p| fitted(p, there));
        if let Some((p, _)) = other.min_by(best)
            && typical_distance(plate, &p, there) < 0.25 * typical
        {
            return Err(of_other_mode(&p, unknowns));
        }
    }
    // A wrong hole moves the fit of least squares, and with it all residuals.
    let bound = match plate.criterion {
        Criterion::Huber => 50.0 * plate.sigma,
        Criterion::LeastSquares => (50.0 * plate.sigma).max(0.02 * nominal.iter().sum::<f64>()),
    };
    let Some((parameters, _)) = found.filter(|_| typical <= bound) else {
        if let Some(p) = straight.or(found.map(|(p, _)| p)) {
            check_seen(&jacobian(plate, unknowns, &p), unknowns, &p, plate.sigma)?;
        }
        return Err(CalibrationError::NoFit(typical));
    };
    judged(plate, unknowns, parameters, nominal, straight)
}

/// Why the points of an arm fit this one in the other assembly mode. Without a base, exchanged joints are not half a
/// turn off: the arm seen from joint 4 is the same as from joint 1.
pub(super) fn of_other_mode(p: &Parameters, unknowns: Unknowns) -> CalibrationError {
    if !unknowns.has_base() {
        CalibrationError::OtherAssemblyOrSwappedJoints
    } else if half_a_turn_off(p, unknowns) {
        CalibrationError::SwappedJoints
    } else {
        CalibrationError::OtherAssembly
    }
}

/// Both offsets near half a turn: the joints of an arm with a base are exchanged.
pub(super) fn half_a_turn_off(p: &Parameters, unknowns: Unknowns) -> bool {
    unknowns.has_base() && p.offsets.iter().all(|offset| offset.abs() > FRAC_PI_2)
}

fn check(plate: &Plate) -> Result<(), CalibrationError> {
    let touches = &plate.touches;
    let finite = |touch: &Touch| {
        let [theta1, theta4] = touch.encoder;
        [theta1, theta4, touch.hole.x, touch.hole.y]
            .iter()
            .all(|value| value.is_finite())
    };
    if !(touches.iter().all(finite) && plate.sigma > 0.0 && plate.sigma.is_finite()) {
        return Err(CalibrationError::NotFinite);
    }
    let different = different(touches.iter().map(|touch| touch.encoder));
    if different < 5 {
        return Err(CalibrationError::TooFew(different));
    }
    let middle = super::legs::middle(touches);
    let spread: nalgebra::Matrix2<f64> = touches
        .iter()
        .map(|touch| (touch.hole - middle) * (touch.hole - middle).transpose())
        .sum();
    let [across, along] = {
        let squares = (spread / touches.len() as f64).symmetric_eigenvalues();
        let (a, b) = (squares[0].max(0.0).sqrt(), squares[1].max(0.0).sqrt());
        [a.min(b), a.max(b)]
    };
    if across <= (10.0 * plate.sigma).min(0.02 * along).max(1e-3 * along) {
        return Err(CalibrationError::Collinear);
    }
    Ok(())
}

/// The arm of two legs that are fitted alone, and the assembly mode of most touches.
fn legs_start(plate: &Plate, unknowns: Unknowns) -> Option<(Parameters, Side)> {
    let touches = &plate.touches;
    if touches.len() < LEAST_FOR_LEGS {
        return None;
    }
    let samples = samples(touches);
    let loss = plate.criterion.loss(plate.sigma);
    let leg1 = leg(touches, &samples, Joint::Joint1, loss)?;
    let leg4 = leg(touches, &samples, Joint::Joint4, loss)?;
    let left = |touch: &&Touch| {
        let (b, d) = (leg1.elbow(touch.encoder[0]), leg4.elbow(touch.encoder[1]));
        (d - b).perp(&(touch.hole - b)) > 0.0
    };
    let side = if 2 * touches.iter().filter(left).count() > touches.len() {
        Side::Left
    } else {
        Side::Right
    };
    Some((joined(&leg1, &leg4, unknowns), side))
}

/// Residuals and Jacobian of all touches. A touch without a pose counts as far away, and its
/// derivatives as zero.
fn rows(plate: &Plate, unknowns: Unknowns, p: &Parameters, side: Side) -> Option<Rows> {
    Geometry::new(p.lengths).ok()?;
    let count = plate.touches.len();
    let mut residuals = DVector::zeros(2 * count);
    let mut jacobian = DMatrix::zeros(2 * count, 10);
    let reach: f64 = p.lengths.iter().sum();
    for (k, touch) in plate.touches.iter().enumerate() {
        let tip = posed(p, touch.encoder, side).map(|pose| on_plate(p, &pose));
        let (r, j) = match tip {
            Some(tip) => (tip.position - touch.hole, tip.jacobian),
            None => (Vector2::new(reach, reach), SMatrix::zeros()),
        };
        residuals.fixed_rows_mut::<2>(2 * k).copy_from(&r);
        jacobian.fixed_view_mut::<2, 10>(2 * k, 0).copy_from(&j);
    }
    Some((residuals, unknowns.columns(&jacobian)))
}

fn joint_fit(
    plate: &Plate,
    unknowns: Unknowns,
    start: &Parameters,
    side: Side,
) -> Option<(Parameters, f64)> {
    let start = unknowns.vector(start);
    let found = minimise(
        &start,
        &|x| rows(plate, unknowns, &unknowns.parameters(x), side),
        plate.criterion.loss(plate.sigma),
    )?;
    Some((unknowns.parameters(&found.0), found.1))
}

fn jacobian(plate: &Plate, unknowns: Unknowns, p: &Parameters) -> DMatrix<f64> {
    let none = DMatrix::zeros(2, unknowns.count());
    rows(plate, unknowns, p, plate.assembly).map_or(none, |(_, jacobian)| jacobian)
}

/// The median distance of the touches from an arm [m].
fn typical_distance(plate: &Plate, p: &Parameters, side: Side) -> f64 {
    let distance = |touch: &Touch| {
        let tip = tip(p, touch.encoder, side);
        tip.map_or(f64::INFINITY, |tip| (tip.position - touch.hole).norm())
    };
    median(plate.touches.iter().map(distance)).unwrap_or(f64::INFINITY)
}

/// A fit, the touches that it contradicts, and how far the others scatter.
struct Judged {
    p: Parameters,
    rejected: Vec<usize>,
    scale: Scale,
    /// The deviation of a hole's coordinate that the covariance is made with [m].
    sigma: f64,
}

/// From a fit by the plate's criterion.
fn judge(plate: &Plate, unknowns: Unknowns, p: Parameters) -> Option<Judged> {
    let count = plate.touches.len();
    let blocks: Vec<Block> = (0..count)
        .map(|k| Block {
            first: 2 * k,
            size: 2,
            kind: 0,
        })
        .collect();
    let over_sigma = |x: &DVector<f64>| {
        let (r, j) = rows(plate, unknowns, &unknowns.parameters(x), plate.assembly)?;
        Some((r / plate.sigma, j / plate.sigma))
    };
    let x = unknowns.vector(&p);
    Some(match plate.criterion {
        Criterion::Huber => {
            let Settled { x, kept, scales } = robust::settle(&x, &over_sigma, &blocks)?;
            Judged {
                p: unknowns.parameters(&x),
                rejected: (0..count).filter(|&k| !kept[k]).collect(),
                scale: scales[0],
                sigma: plate.sigma * scales[0].variance.sqrt(),
            }
        }
        Criterion::LeastSquares => {
            let (r, j) = over_sigma(&x)?;
            let far = |k: &usize| r.fixed_rows::<2>(2 * k).norm() > 4.0;
            Judged {
                p,
                rejected: (0..count).filter(far).collect(),
                scale: robust::scales((r.clone(), j), &blocks)[0],
                sigma: plate.sigma,
            }
        }
    })
}

/// The calibration at the best fit, checked.
fn judged(
    plate: &Plate,
    unknowns: Unknowns,
    p: Parameters,
    nominal: [f64; 5],
    straight: Option<Parameters>,
) -> Result<Calibration, CalibrationError> {
    let Judged {
        p,
        rejected,
        scale,
        sigma,
    } = judge(plate, unknowns, p).ok_or(CalibrationError::Lengths)?;
    let (all, jacobian) =
        rows(plate, unknowns, &p, plate.assembly).ok_or(CalibrationError::Lengths)?;
    let count = plate.touches.len();
    if plate.criterion == Criterion::Huber && rejected.len() as f64 > FEW * count as f64 {
        return Err(CalibrationError::TooManyWrong {
            kind: "plate".into(),
            rows: rejected,
            of: count,
        });
    }
    let residuals: Vec<Vector2<f64>> = (0..count)
        .map(|k| Vector2::new(all[2 * k], all[2 * k + 1]))
        .collect();
    let is_used = |k: &usize| plate.criterion == Criterion::LeastSquares || !rejected.contains(k);
    let used = (0..count).filter(is_used);
    let pick: Vec<usize> = used.flat_map(|k| [2 * k, 2 * k + 1]).collect();
    let (r, j) = (all.select_rows(&pick), jacobian.select_rows(&pick));
    check_seen(&j, unknowns, &p, sigma)?;
    let near_half = |offset: &f64| PI - offset.abs() < 0.5;
    if unknowns.has_base() && p.offsets.iter().all(near_half) {
        return Err(CalibrationError::SwappedJoints);
    }
    let covariance = covariance(&j, unknowns, sigma);
    other_length(&p, &covariance, nominal)?;
    let (rank, condition) = rank_and_condition(&jacobian, unknowns);
    let rms = |r: &DVector<f64>| (r.norm_squared() / r.len() as f64).sqrt();
    Ok(Calibration {
        parameters: p,
        covariance,
        residual_rms: rms(&r),
        leave_out_rms: rms(&leave_out(&r, &j, unknowns)),
        residuals,
        sigma_scale: scale.value,
        freedom: scale.freedom,
        coverage_factor: match plate.criterion {
            Criterion::Huber => coverage_factor(scale.freedom),
            Criterion::LeastSquares => NORMAL_95,
        },
        rejected,
        other_elbows: other_elbows(plate, &p),
        rank,
        condition,
        nominal_rms: straight.and_then(|p| {
            let (r, _) = rows(plate, unknowns, &p, plate.assembly)?;
            Some(rms(&r) * core::f64::consts::SQRT_2)
        }),
    })
}

/// Refuses lengths far from the nominal ones, beyond what the points leave open.
pub(super) fn other_length(
    p: &Parameters,
    covariance: &SMatrix<f64, 10, 10>,
    nominal: [f64; 5],
) -> Result<(), CalibrationError> {
    for (index, (&found, nominal)) in p.lengths.iter().zip(nominal).enumerate() {
        let sd = covariance[(index, index)].sqrt();
        if (found - nominal).abs() > GREATEST_CHANGE * nominal + 5.0 * sd {
            return Err(CalibrationError::OtherArm {
                number: index + 1,
                found,
                nominal,
            });
        }
    }
    Ok(())
}

/// The touches with other elbows than most.
fn other_elbows(plate: &Plate, p: &Parameters) -> Vec<usize> {
    let poses = plate
        .touches
        .iter()
        .map(|touch| posed(p, touch.encoder, plate.assembly));
    let modes: Vec<_> = poses
        .map(|pose| pose.map(|pose| pose.working_mode()))
        .collect();
    let share = |mode: &Option<_>| modes.iter().filter(|other| *other == mode).count();
    let Some(most) = modes.iter().max_by_key(|mode| share(mode)) else {
        return Vec::new();
    };
    (0..modes.len())
        .filter(|&k| modes[k].is_some() && modes[k] != *most)
        .collect()
}
