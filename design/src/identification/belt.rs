//! Stiffness and damping of a belt from the answer of its motor to a pseudo-random torque.
//!
//! With both belts, the rotors' inertias Jr and the links' mass matrix Ma at the pose,
//!
//! Jr θ̈m = τ − k(θm − θ) − d(θ̇m − θ̇) − s θ̇m, Ma θ̈ = k(θm − θ) + d(θ̇m − θ̇) − b θ̇,
//!
//! where the other motor is shorted and braked by s = (N K)²/R. τ follows from the measured current. Friction
//! and the arm's travel are slow: a high-pass filter on angle and torque leaves the belts' swing. k and d of the driven
//! joint are those with which the equations, driven by the filtered torque, come nearest to the filtered angle.

use super::filter::LowPass;
use crate::fit::{Loss, minimise};
use crate::servo::exponential;
use fivebar_kinematics::five_bar::Joint;
use nalgebra::{DMatrix, DVector, Matrix2};

/// What is known of an arm whose belt is asked for, at the pose of the log. Pairs are of joint 1 and joint 4, at the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeltArm {
    /// Ma: the mass matrix without rotors [kg·m²].
    pub links: Matrix2<f64>,
    /// Jr: the rotors' inertias [kg·m²].
    pub rotors: [f64; 2],
    /// b: viscous friction [N·m·s/rad].
    pub friction: [f64; 2],
    /// k, as the file has it [N·m/rad].
    pub stiffness: [f64; 2],
    /// d, as the file has it [N·m·s/rad].
    pub damping: [f64; 2],
    /// s: how a shorted motor brakes [N·m·s/rad].
    pub shorted: [f64; 2],
    /// Whether the encoders are at the joints.
    pub encoder_at_joint: [bool; 2],
}

/// A log of one motor's torque and its encoder's angle.
#[derive(Clone, Copy, Debug)]
pub struct BeltLog<'a> {
    /// The driven joint.
    pub joint: Joint,
    /// Between two rows [s].
    pub period: f64,
    /// The encoder's angle at each row [rad].
    pub angle: &'a [f64],
    /// The torque at each row [N·m].
    pub torque: &'a [f64],
    /// The winding's time constant L/R [s]: how the torque goes from one row to the next.
    pub time_constant: f64,
    /// Age of the encoder's angle [s].
    pub latency: f64,
}

/// A belt as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundBelt {
    /// k [N·m/rad], and its deviation by noise alone.
    pub stiffness: [f64; 2],
    /// d [N·m·s/rad], and its deviation by noise alone.
    pub damping: [f64; 2],
    /// The free frequency of the arm with this belt that moves the driven motor most [Hz].
    pub mode: f64,
    /// The share of the filtered angle's power that these equations leave.
    pub unexplained: f64,
}

/// Stiffnesses that are tried, per that of the file, evenly in their logarithm, with this damping ratio: belts of less
/// swing longer, but their frequency is missed between two trials.
const TRIED: [f64; 2] = [0.05, 4.0];
const TRIALS: u32 = 150;
const TRIED_RATIO: f64 = 0.05;
/// The cut-off of the high-pass filter, per the file's mode: below the mode of the least stiffness that is tried.
const CUTOFF: f64 = 0.12;
/// The difference of the logarithms for derivatives.
const STEP: f64 = 1e-4;
/// The greatest share of the angle's power that may stay unexplained.
const UNEXPLAINED: f64 = 0.5;

impl BeltArm {
    fn with(mut self, joint: Joint, [stiffness, damping]: [f64; 2]) -> Self {
        self.stiffness[joint] = stiffness;
        self.damping[joint] = damping;
        self
    }

    /// ẋ = A x + B τ; x: rotors, links, and their rates. The rows of A and B over `period`, exactly for a constant torque.
    fn sampled(&self, joint: Joint, period: f64) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let inverse = self.links.try_inverse()?;
        let mut all = DMatrix::zeros(9, 9);
        for i in 0..4 {
            all[(i, 4 + i)] = 1.0;
        }
        for other in Joint::ALL {
            let j = other.index();
            let (k, d) = (self.stiffness[j], self.damping[j]);
            // The torque through the belt, of the states.
            let through = [(j, k), (2 + j, -k), (4 + j, d), (6 + j, -d)];
            for (column, value) in through {
                all[(4 + j, column)] -= value / self.rotors[j];
                for i in 0..2 {
                    all[(6 + i, column)] += inverse[(i, j)] * value;
                }
            }
            if other != joint {
                all[(4 + j, 4 + j)] -= self.shorted[j] / self.rotors[j];
            }
            for i in 0..2 {
                all[(6 + i, 6 + j)] -= inverse[(i, j)] * self.friction[j];
            }
        }
        all[(4 + joint.index(), 8)] = 1.0 / self.rotors[joint];
        let grown = exponential(&(all * period));
        let column = grown.view((0, 8), (8, 1)).column(0).into_owned();
        Some((grown.view((0, 0), (8, 8)).into_owned(), column))
    }

    /// The encoder's angle at each row after mean torques between the rows.
    fn angles(&self, log: &BeltLog<'_>, torque: &[f64]) -> Option<Vec<f64>> {
        let joint = log.joint;
        let (a, b) = self.sampled(joint, log.period)?;
        let shown = if self.encoder_at_joint[joint] { 2 } else { 0 } + joint.index();
        let mut x = DVector::zeros(8);
        let mut next = x.clone();
        let step = |&torque: &f64| {
            let angle = x[shown];
            next.gemv(1.0, &a, &x, 0.0);
            next.axpy(torque, &b, 1.0);
            std::mem::swap(&mut x, &mut next);
            angle
        };
        let angles: Vec<f64> = torque.iter().map(step).collect();
        let late = log.latency / log.period;
        let at = |row: isize| usize::try_from(row).map_or(0.0, |row| angles[row]);
        let rows = 0..angles.len() as isize;
        Some(
            rows.map(|row| {
                let row = row - late as isize;
                at(row) + late.fract() * (at(row - 1) - at(row))
            })
            .collect(),
        )
    }

    /// √(k (1/Jr + (Ma⁻¹)jj))/2π: with a rotor far lighter than the links, the mode in which it swings.
    fn mode(&self, joint: Joint) -> Option<f64> {
        let links = self.links.try_inverse()?[(joint.index(), joint.index())];
        let rate = self.stiffness[joint] * (1.0 / self.rotors[joint] + links);
        Some(rate.sqrt() / std::f64::consts::TAU)
    }
}

impl BeltLog<'_> {
    /// The mean torque from each row to the next: between them the winding's current goes to its end by e^(−t R/L).
    fn mean_torque(&self) -> Vec<f64> {
        let share = self.period / self.time_constant;
        let left = (-share).exp();
        let mean = (1.0 - left) / share;
        let of = |pair: &[f64]| {
            let end = (pair[1] - left * pair[0]) / (1.0 - left);
            end + mean * (pair[0] - end)
        };
        let last = self.torque.last().copied();
        self.torque.windows(2).map(of).chain(last).collect()
    }
}

/// The belt of the driven joint; none if the log does not show it.
pub fn identify_belt(arm: &BeltArm, log: &BeltLog<'_>) -> Option<FoundBelt> {
    let joint = log.joint;
    let slow = LowPass::new(CUTOFF * arm.mode(joint)?, 1.0 / log.period);
    let fast = |values: &[f64]| -> Vec<f64> {
        let slow = slow.apply(values);
        values
            .iter()
            .zip(slow)
            .map(|(value, slow)| value - slow)
            .collect()
    };
    // The links integrate what is left of slow torques: the modelled angle is filtered again, and so is the seen one.
    let (torque, angle) = (fast(&log.mean_torque()), fast(&fast(log.angle)));
    // At the ends the filter has no neighbours.
    let edge = slow.settling() / 2;
    let inner = edge..angle.len().checked_sub(edge)?;
    if inner.len() < 2 * edge {
        return None;
    }
    let residuals = |belt: [f64; 2]| -> Option<DVector<f64>> {
        let modelled = fast(&arm.with(joint, belt).angles(log, &torque)?);
        let rows = angle[inner.clone()].iter().zip(&modelled[inner.clone()]);
        Some(DVector::from_iterator(
            inner.len(),
            rows.map(|(seen, model)| seen - model),
        ))
    };
    let cost = |belt: [f64; 2]| residuals(belt).map_or(f64::INFINITY, |r| r.norm_squared());
    let tried = (0..=TRIALS).map(|trial| {
        let share = f64::from(trial) / f64::from(TRIALS);
        let stiffness = arm.stiffness[joint] * TRIED[0] * (TRIED[1] / TRIED[0]).powf(share);
        // ζ = d/2 √((1/Jr + 1/J)/k)
        let damping = arm.with(joint, [stiffness, 0.0]).mode(joint)?;
        let damping = TRIED_RATIO * 2.0 * stiffness / (std::f64::consts::TAU * damping);
        Some([stiffness, damping])
    });
    let best = tried
        .flatten()
        .min_by(|a, b| cost(*a).total_cmp(&cost(*b)))?;
    let belt = |logs: &DVector<f64>| [logs[0].exp(), logs[1].exp()];
    let rows = |logs: &DVector<f64>| {
        let now = residuals(belt(logs))?;
        let mut slopes = DMatrix::zeros(now.len(), 2);
        for i in 0..2 {
            let mut beside = logs.clone();
            beside[i] += STEP;
            slopes.set_column(i, &((residuals(belt(&beside))? - &now) / STEP));
        }
        Some((now, slopes))
    };
    let start = DVector::from_iterator(2, best.map(f64::ln));
    let (logs, squares) = minimise(&start, &rows, Loss::Squares)?;
    let (_, slopes) = rows(&logs)?;
    let spread = slopes.tr_mul(&slopes).try_inverse()? * (squares / inner.len() as f64);
    let [stiffness, damping] = belt(&logs);
    let power: f64 = angle[inner].iter().map(|angle| angle * angle).sum();
    let found = FoundBelt {
        stiffness: [stiffness, stiffness * spread[(0, 0)].sqrt()],
        damping: [damping, damping * spread[(1, 1)].sqrt()],
        mode: arm.with(joint, [stiffness, damping]).mode(joint)?,
        unexplained: squares / power,
    };
    (found.unexplained < UNEXPLAINED).then_some(found)
}
