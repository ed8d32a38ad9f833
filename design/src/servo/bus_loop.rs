//! The position loop through a bus: torque drives that close their own current loops, each with a spring and a damper about
//! its set-point.
//!
//! A torque τ that a tick demands is at its drive after the delay a, and stays for a tick T. The drive's current loop has the
//! lag Tc, and so have both poles of the loop that tracks its encoder. With its stiffness k and damping d, and the arm's mass
//! matrix M,
//!
//! (s² M + s b + S(s)) θ = τ/(1 + s Tc), S = (k + s d/(1 + s Tc)²)/(1 + s Tc).
//!
//! The angle is as old as its answer when a tick takes it. The loop is opened at the torques that the tick demands: springs and
//! dampers belong to what is controlled. It is sampled by the sum over the frequencies that the sampling folds onto one.

use super::arm::ServoDrive;
use super::law::{ArmLaw, Gains, Law};
use super::margins::{LoopPoint, Margins, eigenvalues, loci_of, plain_frequencies};
use super::response::{Estimate, product};
use nalgebra::Matrix2;
use num_complex::Complex;
use std::f64::consts::{PI, TAU};

type C = Complex<f64>;

/// A torque drive on a bus, as the position loop meets it; all at the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BusDrive {
    /// Encoder, friction and greatest torque. Its latency is the age of the answers.
    pub drive: ServoDrive,
    /// Time from the end of a tick until its torque is at the drive [s].
    pub arrival: f64,
    /// Tc [s].
    pub lag: f64,
    /// k [N·m/rad].
    pub stiffness: f64,
    /// d [N·m·s/rad].
    pub damping: f64,
}

/// An arm at one pose with its drives on a bus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BusServo {
    /// M(θ) with the rotors [kg·m²].
    pub mass_matrix: Matrix2<f64>,
    /// The drives of joint 1 and joint 4.
    pub drives: [BusDrive; 2],
    /// One tick [s].
    pub period: f64,
    /// Time from the end of a tick until its torque acts in the mean, by which the controller leads [s].
    pub lead: f64,
}

/// Frequencies on either side that are folded onto one.
const FOLDS: i32 = 8;
/// Frequencies of the integral for the noise.
const NOISE_POINTS: u32 = 300;

impl BusServo {
    /// What a controller does whose model is this arm. It may then control another one.
    pub fn law(&self, gains: &Gains) -> ArmLaw {
        let gains = Gains {
            current_bandwidth: 1.0 / self.lead,
            belts: None,
            ..*gains
        };
        ArmLaw {
            joints: self
                .drives
                .map(|of| Law::new(&gains, &of.drive, self.period)),
            mass_matrix: self.mass_matrix,
            angle_gains: [gains.bandwidth * gains.bandwidth; 2],
            belts: None,
        }
    }

    /// s² M + s b + S(s), and 1/(1 + s Tc) of each drive.
    fn stiffness(&self, s: C) -> (Matrix2<C>, [C; 2]) {
        let current = self.drives.map(|of| C::from(1.0) / (s * of.lag + 1.0));
        let spring = |j: usize| {
            let of = &self.drives[j];
            let damper = s * of.damping * current[j] * current[j];
            (damper + of.stiffness) * current[j] + s * of.drive.viscous_friction
        };
        let mut stiffness = self.mass_matrix.map(|m| s * s * m);
        stiffness[(0, 0)] += spring(0);
        stiffness[(1, 1)] += spring(1);
        (stiffness, current)
    }

    /// The greatest share of an error of the model's torques that springs and dampers leave at ω [rad/s]:
    /// ‖s² (s² M + s b + S)⁻¹ M‖, of which the controller's loop leaves its sensitivity.
    pub fn left_by_springs(&self, omega: f64) -> f64 {
        let s = C::new(0.0, omega);
        let (stiffness, _) = self.stiffness(s);
        let mass = self.mass_matrix.map(|m| s * s * m);
        let left = stiffness.try_inverse().map(|moved| product(&moved, &mass));
        left.map_or(f64::INFINITY, |left| left.singular_values().max())
    }

    /// The angles, as the ticks take them, for the torques demanded.
    fn angles(&self, omega: f64) -> Matrix2<C> {
        let one = C::from(1.0);
        let mut sum = Matrix2::from_element(C::from(0.0));
        let z = C::from_polar(1.0, omega * self.period);
        for fold in -FOLDS..=FOLDS {
            let s = C::new(0.0, omega + TAU * f64::from(fold) / self.period);
            let (stiffness, current) = self.stiffness(s);
            let Some(moved) = stiffness.try_inverse() else {
                continue;
            };
            let held = (one - one / z) / (s * self.period);
            sum += Matrix2::from_fn(|angle, torque| {
                let late = self.drives[torque].arrival + self.drives[angle].drive.encoder_latency;
                moved[(angle, torque)] * current[torque] * held * (-s * late).exp()
            });
        }
        sum
    }

    /// M K: the torques demanded for angles.
    fn feedback(&self, law: &ArmLaw, omega: f64) -> Matrix2<C> {
        let z = C::from_polar(1.0, omega * self.period);
        law.feedback(z, &law.joints.each_ref().map(|of| Estimate::new(of, z)))
    }

    /// The open loop from 1 rad/s to half the tick rate, finely where it changes fast.
    pub fn loci(&self, law: &ArmLaw) -> Vec<LoopPoint> {
        loci_of(plain_frequencies(self.period), |omega| {
            let open = product(&self.feedback(law, omega), &self.angles(omega));
            eigenvalues(&open)
        })
    }

    /// The margins of these loci; none if the closed loop is unstable. By Nyquist's criterion: the open loop has the poles of
    /// both integrals at z = 1 and none outside, so 1 + λ of both loci together must not turn about 0 on its way from there
    /// to half the tick rate.
    pub fn margins(loci: &[LoopPoint]) -> Option<Margins> {
        let turn = |locus: usize| {
            let first = loci
                .first()
                .map_or(0.0, |point| (point.loci[locus] + 1.0).arg());
            let turned: f64 = loci
                .windows(2)
                .map(|pair| {
                    let [from, to] = [0, 1].map(|i: usize| pair[i].loci[locus] + 1.0);
                    (to / from).arg()
                })
                .sum();
            first + turned
        };
        ((turn(0) + turn(1)).abs() < PI).then(|| Margins::of(loci))
    }

    /// Torque by the encoders' counts, root mean square, as a share of the peak torque; of both joints the greater one.
    pub fn noise(&self, law: &ArmLaw) -> f64 {
        let mut squares = [0.0; 2];
        for point in 0..NOISE_POINTS {
            let omega = (f64::from(point) + 0.5) / f64::from(NOISE_POINTS) * PI / self.period;
            let feedback = self.feedback(law, omega);
            let open = product(&feedback, &self.angles(omega));
            let Some(closed) = (Matrix2::identity() + open).try_inverse() else {
                return f64::INFINITY;
            };
            let torques = product(&closed, &feedback);
            for (joint, square) in squares.iter_mut().enumerate() {
                for (by, drive) in self.drives.iter().enumerate() {
                    // A count is spread evenly over its width.
                    let angle = drive.drive.count * drive.drive.count / 12.0;
                    *square += torques[(joint, by)].norm_sqr() * angle / f64::from(NOISE_POINTS);
                }
            }
        }
        let shares = [0, 1].map(|j| squares[j].sqrt() / self.drives[j].drive.peak_torque);
        shares[0].max(shares[1])
    }
}
