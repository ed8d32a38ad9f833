//! Bandwidths that follow from the arm.
//!
//! What bounds a position loop is the phase that delays take (the tick, the current loop, the
//! encoder's latency, the observer), the resonance of the drives, and the torque that the
//! encoder's counts make through the gain on the velocity. All are in the sampled loop, so the
//! bandwidths are searched there: the highest position bandwidth whose least distance from −1, at
//! every pose given, is [`TARGET_MODULUS`] or more, and whose torque noise is small.
//!
//! A count of q is an error of variance q²/12, alike at all frequencies; the torque it makes is
//! M K (1 + P V M K)⁻¹ of it.

use super::arm::Servo;
use super::law::{ArmLaw, Gains};
use super::response::ArmResponse;
use nalgebra::Matrix2;
use num_complex::Complex;
use std::f64::consts::PI;

/// The modulus margin of a loop that is tuned here: above 0.5, to keep that on an arm that
/// differs somewhat.
pub const TARGET_MODULUS: f64 = 0.53;
/// Torque noise by counts, as a share of the peak torque, root mean square.
const NOISE: f64 = 0.08;
/// Points of a locus in the search. Between them a locus may come nearer to −1, so what the search
/// finds is judged once more on refined loci.
const POINTS: usize = 150;
/// Frequencies at which the noise is summed.
const NOISE_POINTS: usize = 64;
/// The highest bandwidth of the position loop that is tried, times the tick's period [1]: 390 rad/s
/// at 10 kHz.
const HIGHEST: f64 = 0.039;
/// How many bandwidths are tried: down to 0.95⁷⁹ = 1/58 of the highest.
const STEPS: usize = 80;
/// Each bandwidth that is tried as a share of the last.
const RATIO: f64 = 0.95;
/// The observer's bandwidths that are tried, per the position loop's [1]. A higher one takes less
/// phase and lets more noise pass.
const OBSERVERS: [f64; 7] = [5.0, 6.0, 8.0, 9.0, 10.0, 14.0, 20.0];
/// Bandwidths of a current loop, times the tick's period [1], the fastest first.
pub const CURRENTS: [f64; 3] = [0.35, 0.2, 0.1];

/// What a search found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// The bandwidths.
    pub gains: Gains,
    /// The least modulus margin over the poses.
    pub modulus: f64,
    /// The greatest torque noise by counts, root mean square, as a share of the peak torque.
    pub noise: f64,
}

impl Tuning {
    /// Whether margin and noise are as wanted.
    pub fn is_good(&self) -> bool {
        self.modulus >= TARGET_MODULUS && self.noise <= NOISE
    }
}

/// The bandwidths for an arm, which `poses` stand for. If none is good, those with the greatest
/// margin; none if there is no pose, or if no loop is stable. `currents` are the bandwidths of the current loop that
/// are tried, times the tick's period.
pub fn tune(poses: &[Servo], currents: &[f64]) -> Option<Tuning> {
    let period = poses.first()?.period;
    let mut search = Search::of(poses);
    let mut best: Option<Tuning> = None;
    for step in 0..STEPS {
        let bandwidth = tidy(HIGHEST / period * RATIO.powi(step as i32));
        let mut here: Vec<Tuning> = Vec::new();
        let mut greatest = best.map_or(0.0, |best| best.modulus);
        for &current in currents {
            for observer in OBSERVERS {
                let gains = Gains {
                    bandwidth,
                    damping: 1.0,
                    integral_rate: 0.25 * bandwidth,
                    observer_bandwidth: observer * bandwidth,
                    current_bandwidth: (current / period).round(),
                    belts: None,
                };
                let possible = gains.bandwidth <= 0.25 * gains.current_bandwidth
                    && gains.observer_bandwidth <= 1.0 / period;
                if !possible {
                    continue;
                }
                if let Some(tuning) = search.judge(gains, greatest.min(TARGET_MODULUS)) {
                    greatest = greatest.max(tuning.modulus);
                    here.push(tuning);
                }
            }
        }
        here.sort_by(|a, b| b.modulus.total_cmp(&a.modulus));
        let stable = |tuning: &Tuning| {
            let radius = |servo: &Servo| servo.spectral_radius(&servo.law(&tuning.gains), 1.0);
            poses.iter().all(|servo| radius(servo) < 1.0)
        };
        // Between the points of the search a locus may come nearer.
        let exactly = |tuning: &Tuning| Tuning {
            modulus: poses
                .iter()
                .map(|servo| servo.margins(&servo.law(&tuning.gains)).modulus)
                .fold(f64::INFINITY, f64::min),
            ..*tuning
        };
        let mut good = here
            .iter()
            .filter(|t| t.is_good() && stable(t))
            .map(exactly);
        if let Some(good) = good.find(Tuning::is_good) {
            return Some(good);
        }
        if let Some(first) = here.first()
            && best.is_none_or(|best| first.modulus > best.modulus)
            && stable(first)
        {
            best = Some(*first);
        }
    }
    best
}

/// A number of two digits, not above x.
fn tidy(x: f64) -> f64 {
    let unit = 10_f64.powf(x.log10().floor() - 1.0);
    (x / unit).floor() * unit
}

/// What an arm does at the frequencies of a search, which is the same for all bandwidths.
struct Responses {
    /// For the loci.
    loci: Vec<ArmResponse>,
    /// For the noise, at even distances.
    noise: Vec<ArmResponse>,
}

impl Responses {
    fn of(servo: &Servo) -> Self {
        let at = |omega| servo.arm_response(omega);
        Self {
            loci: servo.frequencies(POINTS).into_iter().map(at).collect(),
            noise: servo.noise_responses(),
        }
    }
}

/// A search among gains for the arm that `poses` stand for.
struct Search<'a> {
    poses: &'a [Servo],
    responses: Vec<Responses>,
    /// The pose, and the point of its loci, that refused gains last: they are likely to refuse
    /// the next, too, so they are asked first.
    critical: (usize, usize),
}

impl<'a> Search<'a> {
    fn of(poses: &'a [Servo]) -> Self {
        Self {
            poses,
            responses: poses.iter().map(Responses::of).collect(),
            critical: (0, 0),
        }
    }

    /// Margin and noise at all poses; none if the margin is below `least`.
    fn judge(&mut self, gains: Gains, least: f64) -> Option<Tuning> {
        let laws: Vec<ArmLaw> = self.poses.iter().map(|servo| servo.law(&gains)).collect();
        let distance = |(pose, point): (usize, usize)| {
            // The order of two eigenvalues does not matter to the distance of points from −1.
            let loci = self.poses[pose].loci_at(&laws[pose], &self.responses[pose].loci[point]);
            (loci[0] + 1.0).norm().min((loci[1] + 1.0).norm())
        };
        if distance(self.critical) < least {
            return None;
        }
        let mut modulus = f64::INFINITY;
        for (pose, responses) in self.responses.iter().enumerate() {
            for point in 0..responses.loci.len() {
                modulus = modulus.min(distance((pose, point)));
                if modulus < least {
                    self.critical = (pose, point);
                    return None;
                }
            }
        }
        let noises = self.poses.iter().zip(&laws).zip(&self.responses);
        let noise = noises
            .map(|((servo, law), responses)| servo.noise_at(law, &responses.noise))
            .fold(0.0, f64::max);
        Some(Tuning {
            gains,
            modulus,
            noise,
        })
    }
}

impl Servo {
    /// Torque by the encoders' counts, root mean square, as a share of the peak torque: the
    /// greater of both joints.
    pub fn noise(&self, law: &ArmLaw) -> f64 {
        self.noise_at(law, &self.noise_responses())
    }

    fn noise_responses(&self) -> Vec<ArmResponse> {
        (0..NOISE_POINTS)
            .map(|i| PI / self.period * (i as f64 + 0.5) / NOISE_POINTS as f64)
            .map(|omega| self.arm_response(omega))
            .collect()
    }

    fn noise_at(&self, law: &ArmLaw, responses: &[ArmResponse]) -> f64 {
        let nan = Matrix2::from_element(Complex::new(f64::NAN, 0.0));
        let mut variance = [0.0; 2];
        for arm in responses {
            let open = self.open_loop(law, arm);
            let sensitivity = Matrix2::identity() + open.response;
            let closed = sensitivity.try_inverse().unwrap_or(nan) * open.feedback;
            for (j, sum) in variance.iter_mut().enumerate() {
                for (from, drive) in self.drives.iter().enumerate() {
                    let counts = drive.count * drive.count / 12.0;
                    *sum += closed[(j, from)].norm_sqr() * counts / responses.len() as f64;
                }
            }
        }
        let share = |j: usize| variance[j].sqrt() / self.drives[j].peak_torque;
        share(0).max(share(1))
    }
}
