//! The closed loop as a matrix over the states of arm and controller: its poles.

use super::arm::Servo;
use super::law::ArmLaw;
use nalgebra::{DMatrix, DVector, Schur, Vector2};

/// Most encoder readings that are delayed at once: the greatest latency in ticks.
pub const MOST_KEPT: usize = 64;
/// Most steps of the search for the poles.
const MOST_STEPS: usize = 10_000;

impl Servo {
    /// The greatest |z| of the closed loop's poles, with both torques multiplied by `factor`;
    /// below 1 it is stable. Infinite for an arm that is not finite, and if an encoder is later
    /// than [`MOST_KEPT`] ticks.
    pub fn spectral_radius(&self, law: &ArmLaw, factor: f64) -> f64 {
        if self.angle.iter().any(|angle| angle.kept() > MOST_KEPT) {
            return f64::INFINITY;
        }
        let matrix = self.closed_loop(law, factor);
        if !matrix.iter().all(|entry| entry.is_finite()) {
            return f64::INFINITY;
        }
        let Some(schur) = Schur::try_new(matrix, f64::EPSILON, MOST_STEPS) else {
            return f64::INFINITY;
        };
        let poles = schur.complex_eigenvalues();
        poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max)
    }

    /// The frequencies at which the arm rings on its drives' springs [rad/s].
    pub(super) fn resonances(&self) -> Vec<f64> {
        if !self.a.iter().all(|entry| entry.is_finite()) {
            return Vec::new();
        }
        let Some(schur) = Schur::try_new(self.a.clone(), f64::EPSILON, MOST_STEPS) else {
            return Vec::new();
        };
        let poles = schur.complex_eigenvalues();
        let rings = poles.iter().filter(|pole| pole.im > 1e-6);
        rings.map(|pole| pole.arg() / self.period).collect()
    }

    /// The matrix that takes the states over one tick.
    ///
    /// In their order: the arm; the voltages that act; old encoder angles of joint 1, then of
    /// joint 4; for each joint θ̂, ω̂, the integral, the current loop's integral; those of the laws of belts.
    pub(super) fn closed_loop(&self, law: &ArmLaw, factor: f64) -> DMatrix<f64> {
        let laws = &law.joints;
        let n = self.a.nrows();
        let kept = [0, 1].map(|j: usize| self.angle[j].kept());
        let old = [n + 2, n + 2 + kept[0]];
        let loops = [0, 4].map(|offset| n + 2 + kept[0] + kept[1] + offset);
        let on_belts = loops[1] + 4;
        let size = on_belts + law.belts.as_ref().map_or(0, |belts| belts.a.nrows());
        let step = |x: &DMatrix<f64>| {
            let mut next = DMatrix::zeros(size, 1);
            let arm = x.rows(0, n);
            let acting = x.rows(n, 2);
            let mut estimates = [[0.0; 2]; 2];
            let mut alpha = Vector2::zeros();
            let mut angles = DVector::zeros(2);
            for j in 0..2 {
                let (angle, law, at) = (&self.angle[j], &laws[j], loops[j]);
                let now = (&angle.row * arm)[0];
                // Kept angles are shifted by one; the newest comes first.
                let newest = match &angle.early {
                    None => now,
                    Some((state, volts)) => (state * arm + volts * acting)[0],
                };
                let measured = if kept[j] == 0 {
                    now
                } else {
                    x[old[j] + kept[j] - 1]
                };
                for k in 0..kept[j] {
                    let before = if k == 0 { newest } else { x[old[j] + k - 1] };
                    next[old[j] + k] = before;
                }
                angles[j] = measured;
                let o = law.observer;
                let (angle, velocity) = (x[at], x[at + 1]);
                let angle_now =
                    o[(0, 0)] * angle + o[(0, 1)] * velocity + law.measured.x * measured;
                let velocity_now =
                    o[(1, 0)] * angle + o[(1, 1)] * velocity + law.measured.y * measured;
                estimates[j] = [angle_now, velocity_now];
                alpha[j] =
                    x[at + 2] - law.angle_gain * angle_now - law.velocity_gain * velocity_now;
                next[at] = angle_now;
                next[at + 1] = velocity_now;
                // The laws of belts have their own.
                if on_belts == size {
                    next[at + 2] =
                        x[at + 2] - law.integral_gain * (angle_now + law.lead * velocity_now);
                }
            }
            let torques = match &law.belts {
                None => law.mass_matrix * alpha,
                Some(belts) => {
                    let states = x.rows(on_belts, belts.a.nrows());
                    next.rows_mut(on_belts, belts.a.nrows())
                        .copy_from(&(&belts.a * states + &belts.b * &angles));
                    let torques = &belts.c * states + &belts.d * &angles;
                    Vector2::new(torques[0], torques[1])
                }
            };
            for j in 0..2 {
                let (law, drive, at) = (&laws[j], &self.drives[j], loops[j]);
                let error = factor * torques[j] / drive.torque_per_current - x[self.currents[j]];
                let volts = law.current_gain * error + x[at + 3] + law.back_emf * estimates[j][1];
                next[n + j] = volts;
                next[at + 3] = x[at + 3] + law.current_integral * error;
            }
            next.rows_mut(0, n)
                .copy_from(&(&self.a * arm + &self.b * acting));
            next
        };
        let mut matrix = DMatrix::zeros(size, size);
        for column in 0..size {
            let mut unit = DMatrix::zeros(size, 1);
            unit[column] = 1.0;
            matrix.column_mut(column).copy_from(&step(&unit).column(0));
        }
        matrix
    }
}

impl super::arm::Angle {
    /// How many old readings are kept.
    fn kept(&self) -> usize {
        self.ticks + usize::from(self.early.is_some())
    }
}
