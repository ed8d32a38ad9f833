//! Excitation trajectories as finite Fourier series (Swevers 1997).

use fivebar_kinematics::five_bar::Joint;

/// Harmonics of a trajectory.
pub const HARMONICS: usize = 5;

/// A periodic trajectory of both joints:
/// q = q0 + Σk a_k/(k ω) sin kωt − b_k/(k ω) cos kωt with ω = 2π/period, so that a_k and b_k are
/// amplitudes of the velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excitation {
    /// Its period [s].
    pub period: f64,
    /// Of joint 1, then of joint 4: q0 [rad], a1…a5, b1…b5 [rad/s].
    pub coefficients: [f64; 22],
}

impl Excitation {
    /// Angles, velocities and accelerations of both joints at a time [s].
    pub fn at(&self, time: f64) -> [[f64; 2]; 3] {
        let base = core::f64::consts::TAU / self.period;
        let [joint1, joint4] = Joint::ALL.map(|joint| {
            let from = 11 * joint.index();
            let own = &self.coefficients[from..from + 11];
            let mut motion = [own[0], 0.0, 0.0];
            for k in 1..=HARMONICS {
                let rate = base * k as f64;
                let (sin, cos) = libm::sincos(rate * time);
                let (a, b) = (own[k], own[HARMONICS + k]);
                motion[0] += (a * sin - b * cos) / rate;
                motion[1] += a * cos + b * sin;
                motion[2] += rate * (b * cos - a * sin);
            }
            motion
        });
        [0, 1, 2].map(|derivative: usize| [joint1[derivative], joint4[derivative]])
    }
}
