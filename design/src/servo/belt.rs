//! The gains of a joint behind a belt, searched on one joint of the arm.
//!
//! In the directions of the mass matrix's eigenvectors the arm is two joints of one inertia each, because equal drives
//! stay equal in any directions. So gains that suit one joint with every inertia from the least to the greatest
//! eigenvalue over the poses suit an arm with equal drives. What differs from that (unequal drives) shows in
//! [`Servo::margins`](super::Servo::margins).

use super::belt_law::belt_laws;
use super::belt_loop::{closed, step, yields};
use super::exponential::exponential;
use super::linear::Linear;
use super::simplex::least;
use fivebar_kinematics::control::{Belt, BeltGains, BeltLaw};
use nalgebra::{DMatrix, Schur};
use num_complex::Complex;
use std::f64::consts::PI;

type C = Complex<f64>;

/// A joint behind a belt, and what its gains must stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeltJoint {
    /// The belt.
    pub belt: Belt<f64>,
    /// The least and the greatest eigenvalue of the arm's mass matrix without rotors over the poses [kg·m²].
    pub inertia: [f64; 2],
    /// The least and the greatest factor on it of an arm that differs from its model [1].
    pub range: [f64; 2],
    /// Bandwidth of the current loop [rad/s].
    pub current_bandwidth: f64,
    /// Age of the encoder's angle [s].
    pub latency: f64,
    /// One count of the encoder [rad].
    pub count: f64,
    /// Greatest torque [N·m].
    pub peak_torque: f64,
    /// T [s].
    pub period: f64,
}

/// What a search found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeltTuning {
    /// The gains.
    pub gains: BeltGains<f64>,
    /// The least modulus margin with the model's inertias.
    pub modulus: f64,
    /// The least modulus margin over the range.
    pub modulus_range: f64,
    /// Torque noise by counts, root mean square [N·m].
    pub noise: f64,
    /// Angle of the joint after a step of its load, root mean square over the first 30 ms [rad/(N·m)].
    pub compliance: f64,
    /// The greatest compliance over all frequencies, per that of the belt and of the position loop in series.
    pub peak: f64,
}

/// The margin that is asked for with the model's inertias: above 0.5, to keep that on the whole arm.
const MODULUS: f64 = 0.58;
/// The margin that is asked for over the range.
const MODULUS_RANGE: f64 = 0.42;
/// Torque noise by counts, as a share of the peak torque.
const NOISE: f64 = 0.02;
/// The greatest compliance that is asked for, per the static one.
const PEAK: f64 = 1.9;
/// The slowest decay [rad/s]: of the estimated load.
const SLOWEST: f64 = 4.0;
/// Greatest whole ticks of an encoder's latency.
pub const MOST_LATE: usize = 7;
/// Points of a locus.
const POINTS: usize = 120;
/// Points after which a search asks whether the gains are refused already.
const POINTS_AT_ONCE: usize = 20;
/// The first step of the search, as a share of each gain.
const FIRST_STEP: f64 = 0.4;
/// Gains that one search tries.
const MOST_TRIALS: usize = 250;
/// Times that the best simplex begins anew.
const RESTARTS: usize = 3;
/// Shapes of the observer from which a search begins: c T/Jr, g1, g2 T, g3.
const SHAPES: [[f64; 4]; 3] = [
    [0.0234, 0.17, 0.0025, 0.055],
    [0.0094, 0.25, 0.005, 0.09],
    [0.0044, 0.43, 0.008, 0.154],
];

impl BeltJoint {
    /// Whole ticks of the encoder's latency.
    pub fn late(&self) -> usize {
        (self.latency / self.period).round() as usize
    }

    fn law(&self, gains: &BeltGains<f64>) -> BeltLaw<f64> {
        let drive_lag = 1.0 / self.current_bandwidth;
        let lag = drive_lag + self.latency;
        BeltLaw::new(&self.belt, gains, drive_lag, lag, self.period)
    }

    /// From the demanded torque to the encoder's angle, with this inertia of the links. States: θm, ωm, θ, ω, the
    /// current loop's two, the demand of the tick before, late angles.
    fn plant(&self, inertia: f64) -> Linear {
        let Belt {
            stiffness: k,
            damping: d,
            rotor_inertia: jr,
            encoder_at_joint,
        } = self.belt;
        let t = self.period;
        let mut continuous = DMatrix::zeros(5, 5);
        continuous[(0, 1)] = t;
        continuous[(2, 3)] = t;
        for (column, value) in [-k, -d, k, d].into_iter().enumerate() {
            continuous[(1, column)] = t * value / jr;
            continuous[(3, column)] = -t * value / inertia;
        }
        continuous[(1, 4)] = t / jr;
        let sampled = exponential(&continuous);
        let g = self.current_bandwidth * t;
        let late = self.late();
        let n = 7 + late;
        let mut a = DMatrix::zeros(n, n);
        a.view_mut((0, 0), (4, 4))
            .copy_from(&sampled.view((0, 0), (4, 4)));
        // τ⁺ = τ − g τ₋ + g d₋; the mean over the tick acts.
        for row in 0..4 {
            let gain = sampled[(row, 4)];
            a[(row, 4)] = gain;
            a[(row, 5)] = -0.5 * g * gain;
            a[(row, 6)] = 0.5 * g * gain;
        }
        a[(4, 4)] = 1.0;
        a[(4, 5)] = -g;
        a[(4, 6)] = g;
        a[(5, 4)] = 1.0;
        let measured = if encoder_at_joint { 2 } else { 0 };
        for i in 0..late {
            a[(7 + i, if i == 0 { measured } else { 6 + i })] = 1.0;
        }
        let mut b = DMatrix::zeros(n, 1);
        b[6] = 1.0;
        let mut c = DMatrix::zeros(1, n);
        c[if late == 0 { measured } else { n - 1 }] = 1.0;
        Linear {
            a,
            b,
            c,
            d: DMatrix::zeros(1, 1),
        }
    }

    /// The law, from the encoder's angle to the demanded torque, for links of this inertia in the model.
    fn controller(&self, gains: &BeltGains<f64>, inertia: f64) -> Linear {
        let rotor = self.belt.rotor_inertia;
        let mass_matrix = DMatrix::from_element(1, 1, inertia + rotor);
        belt_laws(&[self.law(gains)], &mass_matrix, &[rotor], self.late())
    }
}

/// One inertia of the model, and the plants that it may be in truth.
struct Case {
    inertia: f64,
    plants: Vec<(Linear, Vec<C>)>,
    /// Of the model: the joint's angle for a demanded torque, the encoder's and the joint's for a load.
    yields: Vec<[C; 3]>,
    noise: Vec<C>,
}

/// What is the same for all gains.
struct Search<'a> {
    joint: &'a BeltJoint,
    z: Vec<C>,
    even: Vec<C>,
    cases: Vec<Case>,
}

impl<'a> Search<'a> {
    fn of(joint: &'a BeltJoint) -> Self {
        let nyquist = PI / joint.period;
        let z: Vec<C> = (0..POINTS)
            .map(|i| 5.0 * (0.999 * nyquist / 5.0).powf(i as f64 / (POINTS - 1) as f64))
            .map(|omega| C::from_polar(1.0, omega * joint.period))
            .collect();
        let even: Vec<C> = (0..48)
            .map(|i| C::from_polar(1.0, PI * (f64::from(i) + 0.5) / 48.0))
            .collect();
        let [low, high] = joint.range;
        let [least, greatest] = joint.inertia;
        let cases = [least, (least * greatest).sqrt(), greatest].map(|inertia| {
            let plants = [1.0, low, high].map(|factor| {
                let plant = joint.plant(factor * inertia);
                let responses = z.iter().map(|&z| plant.response(z)[0]).collect();
                (plant, responses)
            });
            let noise = even.iter().map(|&z| plants[0].0.response(z)[0]).collect();
            let yields = z
                .iter()
                .map(|&z| yields(&plants[0].0, inertia, joint.period, z));
            Case {
                inertia,
                yields: yields.collect(),
                plants: plants.into(),
                noise,
            }
        });
        Self {
            joint,
            z,
            even,
            cases: cases.into(),
        }
    }

    /// None for gains with an unstable loop. What it finds only grows the cost, so it ends as soon as the cost is not
    /// below `limit`: the tuning is then a part of the whole. With an infinite limit it is the whole.
    fn judge(&self, gains: &BeltGains<f64>, limit: f64) -> Option<BeltTuning> {
        let mut tuning = BeltTuning {
            gains: *gains,
            modulus: f64::INFINITY,
            modulus_range: f64::INFINITY,
            noise: 0.0,
            compliance: 0.0,
            peak: 0.0,
        };
        let is_beyond =
            |tuning: &BeltTuning| limit.is_finite() && tuning.cost(self.joint.peak_torque) >= limit;
        let period = self.joint.period;
        let laws: Vec<Linear> = self
            .cases
            .iter()
            .map(|case| self.joint.controller(gains, case.inertia))
            .collect();
        // The cheapest first.
        for (case, law) in self.cases.iter().zip(&laws) {
            let moved = step(&case.plants[0].0, law, case.inertia, period);
            tuning.compliance = tuning.compliance.max(moved);
            if is_beyond(&tuning) {
                return Some(tuning);
            }
        }
        // The poles cost most. Gains that the loci refuse need none; without a limit nothing is refused, and the loci of
        // an unstable loop need not be asked.
        if !limit.is_finite() && !self.are_stable(&laws) {
            return None;
        }
        for (case, law) in self.cases.iter().zip(&laws) {
            if self.judge_loci(case, law, &mut tuning, &is_beyond) {
                return Some(tuning);
            }
        }
        (!limit.is_finite() || self.are_stable(&laws)).then_some(tuning)
    }

    /// Whether each loop decays with these laws, fast enough.
    fn are_stable(&self, laws: &[Linear]) -> bool {
        let slowest = (-SLOWEST * self.joint.period).exp();
        let are_stable = |(case, law): (&Case, &Linear)| {
            case.plants.iter().all(|(plant, _)| {
                let poles = Schur::try_new(closed(plant, law), 1e-12, 10_000);
                let radius = poles.map(|poles| {
                    let poles = poles.complex_eigenvalues();
                    poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max)
                });
                radius.is_some_and(|radius| radius <= slowest)
            })
        };
        self.cases.iter().zip(laws).all(are_stable)
    }

    /// Margins, noise and compliance over all frequencies of one inertia of the model; true as soon as the tuning is
    /// beyond.
    fn judge_loci(
        &self,
        case: &Case,
        law: &Linear,
        tuning: &mut BeltTuning,
        is_beyond: &dyn Fn(&BeltTuning) -> bool,
    ) -> bool {
        let spring =
            (case.inertia + self.joint.belt.rotor_inertia) * tuning.gains.bandwidth.powi(2);
        let fixed = 1.0 / self.joint.belt.stiffness + 1.0 / spring;
        for (index, &z) in self.z.iter().enumerate() {
            let k = law.response(z)[0];
            for (of, (_, responses)) in case.plants.iter().enumerate() {
                let modulus = (1.0 - k * responses[index]).norm();
                if of == 0 {
                    tuning.modulus = tuning.modulus.min(modulus);
                }
                tuning.modulus_range = tuning.modulus_range.min(modulus);
            }
            let [moved, shown, yielding] = case.yields[index];
            let p = case.plants[0].1[index];
            let compliance = (yielding + moved * k * shown / (1.0 - k * p)).norm();
            tuning.peak = tuning.peak.max(compliance / fixed);
            if (index + 1) % POINTS_AT_ONCE == 0 && is_beyond(tuning) {
                return true;
            }
        }
        let variance: f64 = self
            .even
            .iter()
            .zip(&case.noise)
            .map(|(&z, p)| {
                let k = law.response(z)[0];
                (k / (1.0 - k * p)).norm_sqr()
            })
            .sum();
        let noise = (variance / self.even.len() as f64 / 12.0).sqrt() * self.joint.count;
        tuning.noise = tuning.noise.max(noise);
        is_beyond(tuning)
    }
}

impl BeltTuning {
    /// What the search makes small.
    fn cost(&self, peak_torque: f64) -> f64 {
        let lacks =
            (MODULUS - self.modulus).max(0.0) + (MODULUS_RANGE - self.modulus_range).max(0.0);
        let noise = (self.noise / (NOISE * peak_torque)).ln().max(0.0);
        let peak = (self.peak / PEAK).ln().max(0.0);
        self.compliance.ln() + 40.0 * lacks + 20.0 * noise + 10.0 * peak
    }

    /// Whether margins and noise are as wanted, on this joint.
    pub fn is_good(&self, joint: &BeltJoint) -> bool {
        self.modulus > MODULUS - 0.01
            && self.modulus_range > MODULUS_RANGE - 0.01
            && self.noise < 1.1 * NOISE * joint.peak_torque
    }
}

/// The gains of a joint; none if no stable ones were found, or if its encoder is too late.
///
/// The search is that of a simplex, over the logarithms of all gains, from each shape of the observer. What it makes
/// small is the compliance; what the margins and the noise lack is added to it. An encoder at the joint finds no
/// stable start yet on most belts: it does not see the rotor that the torque turns.
pub fn tune_belt(joint: &BeltJoint) -> Option<BeltTuning> {
    if joint.late() > MOST_LATE {
        return None;
    }
    let search = Search::of(joint);
    let [low, high] = joint.inertia;
    let middle = (low * high).sqrt();
    let (period, jr) = (joint.period, joint.belt.rotor_inertia);
    let gains = |x: &[f64; 8]| {
        let [wc, zeta, rotor, g1, g2, g3, g4, g5] = x.map(f64::exp);
        BeltGains {
            bandwidth: wc,
            damping: zeta,
            rotor_damping: rotor * jr / period,
            observer: [g1, g2 / period, g3, g4 * middle, g5 * middle],
        }
    };
    let cost_of = |tuning: &BeltTuning| tuning.cost(joint.peak_torque);
    let cost_below = |x: &[f64; 8], limit: f64| {
        let tuning = search.judge(&gains(x), limit);
        tuning.as_ref().map_or(f64::INFINITY, cost_of)
    };
    let cost = |x: &[f64; 8]| cost_below(x, f64::INFINITY);
    let found = SHAPES.into_iter().filter_map(|[rotor, g1, g2, g3]| {
        // From the first gains that are stable.
        let starts = [200.0, 100.0, 60.0, 30.0, 15.0].into_iter().flat_map(|wc| {
            [40.0, 15.0, 5.0]
                .into_iter()
                .flat_map(move |g4| [2e3, 5e2].map(|g5| [wc, 0.7, rotor, g1, g2, g3, g4, g5]))
        });
        let mut starts = starts.map(|x| x.map(f64::ln));
        let start = starts.find(|x| cost(x).is_finite())?;
        Some(least(cost_below, start, FIRST_STEP, MOST_TRIALS))
    });
    let mut best = found.min_by(|a, b| cost(a).total_cmp(&cost(b)))?;
    // A simplex that has become flat goes on when it begins anew.
    for _ in 0..RESTARTS {
        best = least(cost_below, best, FIRST_STEP, MOST_TRIALS);
    }
    search.judge(&gains(&best), f64::INFINITY)
}

#[cfg(test)]
mod tests;
