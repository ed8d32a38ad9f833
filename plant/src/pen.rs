//! Friction of a pen on paper, at the tip.
//!
//! g(v) = F (1 + s e^(−(v/vs)²))
//! ż = v − σ |v| z/g
//! f = −σ z, on the pen
//!
//! z is the deflection of pen and paper in the plane, F the force while the pen slides, F (1 + s) the one at which it breaks
//! away, and σ = F (1 + s)/z₀. It is the LuGre model (Canudas de Wit, Olsson, Åström, Lischinsky, IEEE TAC 40, 1995) in two
//! directions and without its damping, as for a tyre on a road: |z| stays within g/σ, and no energy appears, because
//! σ z · (v − ż) = σ² |v| |z|²/g ≥ 0. The drives and their joints damp what the pen stores.

use nalgebra::Vector2;

/// A pen on paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pen {
    /// F [N].
    sliding: f64,
    /// σ [N/m].
    stiffness: f64,
}

/// s: a common excess of static over kinetic friction on paper.
const STICTION: f64 = 0.25;
/// vs [m/s]: a tenth of a slow stroke.
const STRIBECK: f64 = 2e-3;
/// z₀, the deflection at breakaway [m]: a pen in a printed holder gives by so much.
const BREAKAWAY: f64 = 1e-4;
/// (v/vs)² from which e^(…) is less than the rounding error.
const NEGLIGIBLE: f64 = 40.0;

impl Pen {
    /// None without a sliding force [N].
    pub(crate) fn new(sliding: f64) -> Option<Self> {
        (sliding > 0.0).then(|| Self {
            sliding,
            stiffness: sliding * (1.0 + STICTION) / BREAKAWAY,
        })
    }

    /// The force on the pen [N] where it is deflected by `z` [m].
    pub(crate) fn force(&self, z: Vector2<f64>) -> Vector2<f64> {
        -self.stiffness * z
    }

    /// ż [m/s], and the power that the friction takes [W], at the tip's velocity [m/s].
    #[inline]
    pub(crate) fn rate(&self, velocity: Vector2<f64>, z: Vector2<f64>) -> (Vector2<f64>, f64) {
        let squared = velocity.norm_squared() / (STRIBECK * STRIBECK);
        let falling = if squared < NEGLIGIBLE {
            libm::exp(-squared)
        } else {
            0.0
        };
        let level = self.sliding * (1.0 + STICTION * falling);
        let slip = self.stiffness * velocity.norm() * z / level;
        (velocity - slip, self.stiffness * z.dot(&slip))
    }

    /// Energy of the deflection [J].
    pub(crate) fn energy(&self, z: Vector2<f64>) -> f64 {
        0.5 * self.stiffness * z.norm_squared()
    }

    /// The rate at which the deflection follows a tip of this speed [m/s], with the steepest change of the force beside it
    /// [1/s].
    pub(crate) fn sliding_rate(&self, speed: f64) -> f64 {
        self.stiffness * speed / self.sliding
    }

    /// Natural frequency of a tip of this mass [kg] on the pen that sticks [rad/s].
    pub(crate) fn resonance(&self, mass: f64) -> f64 {
        (self.stiffness / mass).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::{BREAKAWAY, Pen, STICTION, STRIBECK};
    use nalgebra::Vector2;

    #[test]
    fn a_pen_that_slides_is_held_back_against_its_motion_by_its_force_and_more_when_it_is_slow() {
        let pen = Pen::new(0.3).unwrap();
        for speed in [0.1 * STRIBECK, STRIBECK, 100.0 * STRIBECK] {
            let velocity = speed * Vector2::new(0.6, -0.8);
            let mut z = Vector2::new(0.0, 0.5 * BREAKAWAY);
            let step = 0.01 * BREAKAWAY / speed;
            for _ in 0..3000 {
                z += step * pen.rate(velocity, z).0;
            }
            let expected = 0.3 * (1.0 + STICTION * (-(speed / STRIBECK).powi(2)).exp());
            let force = pen.force(z);
            assert!((force + expected * velocity / speed).norm() < 1e-6 * expected);
            // All work is lost when the deflection stays.
            let (_, lost) = pen.rate(velocity, z);
            assert!((lost + force.dot(&velocity)).abs() < 1e-6 * lost);
        }
    }

    #[test]
    fn a_pen_that_sticks_is_a_spring_and_turns_with_the_motion() {
        let pen = Pen::new(0.2).unwrap();
        let small = 0.01 * BREAKAWAY * Vector2::new(1.0, 0.0);
        let (rate, lost) = pen.rate(Vector2::new(0.0, 1e-6), small);
        assert!((rate - Vector2::new(0.0, 1e-6)).norm() < 0.011e-6 && lost < 1e-10);
        assert!((pen.force(small).x + 0.01 * 0.2 * (1.0 + STICTION)).abs() < 1e-15);
        assert!(Pen::new(0.0).is_none());
    }
}
