//! The errors of a belt's small pulley: it does not turn its joint evenly.
//!
//! ψ = θm + e sin(n θm) + m sin(16 n θm)
//!
//! n θm is the angle of the motor's shaft, and ψ is where the belt would take the joint if it did not stretch. By virtual
//! work a torque τ at the joint is τ dψ/dθm at the rotor, over the gear ratio.
//!
//! A pulley that runs out by its eccentricity ε moves the belt by ε sin(n θm): e = ε/R, with the radius R of the pulley at
//! the joint. Each tooth that meets the belt moves it by a few micrometres more or less than the pitch line does, with the
//! 16 teeth of a small pulley.

/// Teeth of the small pulley: the least that belts of 2 mm pitch are sold with for common shafts.
pub const PULLEY_TEETH: f64 = 16.0;

/// The errors of one drive's small pulley. None where both are zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pulley {
    /// n.
    gear_ratio: f64,
    /// e and m [rad].
    amplitudes: [f64; 2],
}

/// Steps of Newton's method that find θm: with a slope of 0.5 to 1.5 each leaves a small share of the error's square.
const STEPS: usize = 8;

impl Pulley {
    /// None without either error.
    pub(crate) fn new(gear_ratio: f64, amplitudes: [f64; 2]) -> Option<Self> {
        (amplitudes != [0.0; 2]).then_some(Self {
            gear_ratio,
            amplitudes,
        })
    }

    /// The greatest amplitude of each error [rad] with which the drive can be simulated: the joint turns by a quarter more
    /// or less than the motor.
    pub(crate) fn most(gear_ratio: f64) -> [f64; 2] {
        [1.0, PULLEY_TEETH].map(|periods| 0.25 / (periods * gear_ratio.abs()))
    }

    /// ψ − θm [rad], and dψ/dθm.
    #[inline]
    pub(crate) fn at(&self, angle: f64) -> (f64, f64) {
        let (mut ahead, mut slope) = (0.0, 1.0);
        for (periods, amplitude) in [1.0, PULLEY_TEETH].into_iter().zip(self.amplitudes) {
            let rate = periods * self.gear_ratio;
            let (sin, cos) = libm::sincos(rate * angle);
            ahead += amplitude * sin;
            slope += rate * amplitude * cos;
        }
        (ahead, slope)
    }

    /// θm where the belt takes the joint to `psi` [rad].
    pub(crate) fn rotor(&self, psi: f64) -> f64 {
        let mut angle = psi;
        for _ in 0..STEPS {
            let (ahead, slope) = self.at(angle);
            angle -= (angle + ahead - psi) / slope;
        }
        angle
    }

    /// The fastest rate of its phases at the motor's speed over the gear ratio [1/s].
    pub(crate) fn rate(&self, omega: f64) -> f64 {
        (PULLEY_TEETH * self.gear_ratio * omega).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::Pulley;

    #[test]
    fn the_slope_is_the_derivative_and_the_rotor_is_found_from_the_joint() {
        for gear_ratio in [4.0, -8.0] {
            for share in [0.05, 1.0] {
                let most = Pulley::most(gear_ratio).map(|most| share * most);
                let pulley = Pulley::new(gear_ratio, most).unwrap();
                for step in 0..500 {
                    let angle = 0.01 * f64::from(step);
                    let (ahead, slope) = pulley.at(angle);
                    let h = 1e-6;
                    let rise = pulley.at(angle + h).0 - pulley.at(angle - h).0;
                    assert!((slope - 1.0 - rise / (2.0 * h)).abs() < 1e-6);
                    assert!((pulley.rotor(angle + ahead) - angle).abs() < 1e-12);
                }
            }
        }
    }
}
