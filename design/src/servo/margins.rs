//! Margins from the loci λ(e^(jωT)) of the open loop's eigenvalues.
//!
//! The sensitivity 1/(1 + λ) is greatest where a locus is nearest to −1: the modulus margin is
//! that distance. A locus that crosses the real axis at −x allows the factor 1/x on both torques;
//! one that crosses the unit circle at the angle −π + φ after ω allows the delay φ/ω.

use super::arm::Servo;
use super::law::ArmLaw;
use super::response::ArmResponse;
use nalgebra::Matrix2;
use num_complex::Complex;
use std::f64::consts::{PI, TAU};

/// How far a loop is from instability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// Least |1 + λ|.
    pub modulus: f64,
    /// Least factor above 1 on both torques at which the loop oscillates; infinite if none.
    pub gain_up: f64,
    /// Greatest factor below 1 at which it does; 0 if none.
    pub gain_down: f64,
    /// Least phase, of either sign, at which it does [rad].
    pub phase: f64,
    /// Least delay at which it does [s].
    pub delay: f64,
}

/// The open loop at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopPoint {
    /// ω [rad/s].
    pub omega: f64,
    /// Both eigenvalues, each next to its neighbours.
    pub loci: [Complex<f64>; 2],
}

/// Points of the loci before refinement.
const POINTS: usize = 240;
/// The least frequency of the loci [rad/s]: far below any bandwidth, where the integral part makes the
/// loop gain large.
const LEAST: f64 = 1.0;
/// Neighbours on a locus are no farther apart than this share of their distance from −1.
const FINE: f64 = 0.15;
/// Factors of the gain that are tried between 1 and the expected gain margin, in even steps of their
/// logarithm.
const FACTORS: u32 = 48;
/// The greatest factor of the gain that is tried, and the inverse of the least: no margin beyond is
/// of use.
const GREATEST_FACTOR: f64 = 1e3;
/// Halvings between a stable and an unstable factor: 2⁻²⁴ of the distance of two factors is left.
const HALVINGS: usize = 24;
/// Most halvings of an interval between two points of a locus.
const DEPTH: usize = 10;

/// The eigenvalues of a 2×2 matrix.
pub(super) fn eigenvalues(m: &Matrix2<Complex<f64>>) -> [Complex<f64>; 2] {
    let half = m.trace() * 0.5;
    let root = (half * half - m.determinant()).sqrt();
    [half + root, half - root]
}

/// The order of `b` in which its entries follow those of `a`.
fn following(a: &[Complex<f64>; 2], b: [Complex<f64>; 2]) -> [Complex<f64>; 2] {
    let straight = (a[0] - b[0]).norm() + (a[1] - b[1]).norm();
    let crossed = (a[0] - b[1]).norm() + (a[1] - b[0]).norm();
    if straight <= crossed { b } else { [b[1], b[0]] }
}

/// Distances from a resonance, per its frequency: a drive of little damping changes all within
/// the part of a hundred.
const BESIDE: [f64; 11] = [
    -0.06, -0.03, -0.015, -0.007, -0.003, 0.0, 0.003, 0.007, 0.015, 0.03, 0.06,
];

/// Even steps in log ω from `LEAST` to half the tick rate [rad/s].
fn even_frequencies(period: f64, count: usize) -> Vec<f64> {
    let span = (0.999 * PI / period / LEAST).ln();
    (0..count)
        .map(|i| LEAST * (span * i as f64 / (count - 1) as f64).exp())
        .collect()
}

/// Even steps for loci without resonances.
pub(super) fn plain_frequencies(period: f64) -> Vec<f64> {
    even_frequencies(period, POINTS)
}

/// Loci with these eigenvalues at these frequencies, and between them where they change fast.
pub(super) fn loci_of(
    frequencies: Vec<f64>,
    eigenvalues: impl Fn(f64) -> [Complex<f64>; 2],
) -> Vec<LoopPoint> {
    let at = |omega: f64| LoopPoint {
        omega,
        loci: eigenvalues(omega),
    };
    let mut points: Vec<LoopPoint> = Vec::new();
    for omega in frequencies {
        let next = at(omega);
        match points.last().copied() {
            None => points.push(next),
            Some(before) => refine(&at, before, next, DEPTH, &mut points),
        }
    }
    points
}

impl Servo {
    /// Even steps in log ω from `LEAST` to half the tick rate [rad/s], and more of them about the
    /// resonances of the drives.
    pub(super) fn frequencies(&self, count: usize) -> Vec<f64> {
        let greatest = 0.999 * PI / self.period;
        let mut all = even_frequencies(self.period, count);
        for resonance in self.resonances() {
            let beside = BESIDE.map(|share| resonance * (1.0 + share));
            all.extend(beside.into_iter().filter(|&omega| omega < greatest));
        }
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    /// The open loop from 1 rad/s to half the tick rate, finely where it changes fast.
    pub fn loci(&self, law: &ArmLaw) -> Vec<LoopPoint> {
        loci_of(self.frequencies(POINTS), |omega| {
            self.loci_at(law, &self.arm_response(omega))
        })
    }

    /// The eigenvalues of the open loop at one frequency, in any order.
    pub(super) fn loci_at(&self, law: &ArmLaw, arm: &ArmResponse) -> [Complex<f64>; 2] {
        eigenvalues(&self.open_loop(law, arm).response)
    }

    /// The margins at this pose. They are those of a stable loop only if
    /// [`Servo::spectral_radius`] is below 1.
    pub fn margins(&self, law: &ArmLaw) -> Margins {
        Margins::of(&self.loci(law))
    }

    /// The margins of a stable loop, its gain margins by the poles: a locus that turns fast can
    /// cross the real axis between two points.
    pub fn margins_by_poles(&self, law: &ArmLaw) -> Margins {
        let margins = self.margins(law);
        let up = self.first_unstable(law, margins.gain_up.min(GREATEST_FACTOR));
        let down = self.first_unstable(law, margins.gain_down.max(1.0 / GREATEST_FACTOR));
        Margins {
            gain_up: up.unwrap_or(f64::INFINITY),
            gain_down: down.unwrap_or(0.0),
            ..margins
        }
    }

    /// The factor nearest to 1 at which the loop oscillates, from 1 to a little beyond
    /// `factor`.
    fn first_unstable(&self, law: &ArmLaw, factor: f64) -> Option<f64> {
        let unstable = |log: f64| self.spectral_radius(law, log.exp()) >= 1.0;
        let end = 1.02 * factor.ln();
        let at = |step: u32| end * f64::from(step) / f64::from(FACTORS);
        let step = (1..=FACTORS).find(|&step| unstable(at(step)))?;
        let (mut stable, mut oscillating) = (at(step - 1), at(step));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (stable + oscillating);
            if unstable(middle) {
                oscillating = middle;
            } else {
                stable = middle;
            }
        }
        Some(oscillating.exp())
    }
}

/// Adds what lies between `before`, which is there already, and `next`, and `next` itself.
fn refine(
    at: &impl Fn(f64) -> LoopPoint,
    before: LoopPoint,
    next: LoopPoint,
    depth: usize,
    points: &mut Vec<LoopPoint>,
) {
    let next = LoopPoint {
        loci: following(&before.loci, next.loci),
        ..next
    };
    let coarse = (0..2).any(|i| {
        let (a, b) = (before.loci[i], next.loci[i]);
        let distance = (a + 1.0).norm().min((b + 1.0).norm());
        a.norm().max(b.norm()) > 0.1 && (b - a).norm() > FINE * distance
    });
    if coarse && depth > 0 {
        let middle = at((before.omega * next.omega).sqrt());
        refine(at, before, middle, depth - 1, points);
        let middle = points.last().copied().unwrap_or(before);
        refine(at, middle, next, depth - 1, points);
    } else {
        points.push(next);
    }
}

impl Margins {
    /// The margins of loci that follow one another.
    pub(super) fn of(points: &[LoopPoint]) -> Self {
        let mut margins = Self {
            modulus: f64::INFINITY,
            gain_up: f64::INFINITY,
            gain_down: 0.0,
            phase: PI,
            delay: f64::INFINITY,
        };
        for pair in points.windows(2) {
            for i in 0..2 {
                margins.take(pair, i);
            }
        }
        margins
    }

    /// Takes in the piece of locus `i` between two points, as a straight line.
    fn take(&mut self, pair: &[LoopPoint], i: usize) {
        let (a, b) = (pair[0].loci[i], pair[1].loci[i]);
        let step = b - a;
        // The nearest point to −1.
        let from = a + 1.0;
        let along = if step.norm_sqr() > 0.0 {
            (-(from.re * step.re + from.im * step.im) / step.norm_sqr()).clamp(0.0, 1.0)
        } else {
            0.0
        };
        self.modulus = self.modulus.min((from + step * along).norm());
        if (a.im < 0.0) != (b.im < 0.0) {
            let x = -(a.re - step.re * a.im / step.im);
            if x > 1.0 {
                self.gain_down = self.gain_down.max(1.0 / x);
            } else if x > 0.0 {
                self.gain_up = self.gain_up.min(1.0 / x);
            }
        }
        let (size, next) = (a.norm(), b.norm());
        if (size < 1.0) != (next < 1.0) {
            let share = (1.0 - size) / (next - size);
            let crossing = a + step * share;
            let lead = (crossing.arg() + PI).rem_euclid(TAU);
            let omega = pair[0].omega + share * (pair[1].omega - pair[0].omega);
            self.phase = self.phase.min(lead).min(TAU - lead);
            self.delay = self.delay.min(lead / omega);
        }
    }
}
