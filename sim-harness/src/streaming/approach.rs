//! How a stream goes on from rest after a pause: smoothly from where the arm rests to the program's motion.
//!
//! With h = 10u³ − 15u⁴ + 6u⁵, u = t/T, the point is a + h (p − a): it begins at rest at a, and is the program's p after T.

/// T [s].
const TIME: f64 = 0.3;

/// An approach in progress.
#[derive(Clone, Debug)]
pub(super) struct Approach {
    rest: [f64; 2],
    /// [s].
    time: f64,
}

impl Approach {
    /// From this place at rest [rad or m].
    pub(super) fn from(rest: [f64; 2]) -> Self {
        Self { rest, time: 0.0 }
    }

    /// Position and velocity in place of those of the program.
    pub(super) fn blend(&self, position: [f64; 2], velocity: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let u = self.time / TIME;
        let share = u * u * u * (10.0 + u * (6.0 * u - 15.0));
        let rate = 30.0 * u * u * (1.0 - u) * (1.0 - u) / TIME;
        let away = [0, 1].map(|k| position[k] - self.rest[k]);
        (
            [0, 1].map(|k| self.rest[k] + share * away[k]),
            [0, 1].map(|k| share * velocity[k] + rate * away[k]),
        )
    }

    /// Whether it is over after another period [s].
    pub(super) fn is_over_after(&mut self, period: f64) -> bool {
        self.time += period;
        self.time >= TIME
    }
}
