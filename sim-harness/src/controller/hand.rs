//! A hand that leads the tip of a simulated arm, by a script.
//!
//! It pulls as a spring and a damper from a point that goes from place to place of its script, each time from rest to rest:
//! F = k (p − x) + d (ṗ − v), at most [`STRENGTH`].

use nalgebra::Vector2;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// k [N/m].
const STIFFNESS: f64 = 800.0;
/// d [N·s/m].
const DAMPING: f64 = 8.0;
/// The greatest force [N].
const STRENGTH: f64 = 12.0;

/// Why a script is none.
#[derive(Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HandError {
    /// A row has no three numbers.
    #[error("line {0}: write three numbers, time [s], x and y [m] from where the hand grips")]
    Row(usize),
    /// Times do not rise.
    #[error("line {0}: its time is not later than the one before, or it is more than 600 s")]
    Time(usize),
    /// No row.
    #[error(
        "it has no row: write time [s], x and y [m] from where the hand grips, separated by commas"
    )]
    Empty,
}

/// A hand with its script.
#[derive(Clone, Debug)]
pub struct Hand {
    /// Time [s], and the place then from where it grips [m].
    script: Arc<[(f64, Vector2<f64>)]>,
    grips: Arc<AtomicBool>,
    /// Time and place of the grip [s, m].
    grip: Option<(f64, Vector2<f64>)>,
}

impl Hand {
    /// A hand with the script in this text: rows of time [s], x and y [m], without a head or with one.
    ///
    /// # Errors
    /// The first row that is not valid.
    pub fn parse(text: &str) -> Result<Self, HandError> {
        let mut script = vec![(0.0, Vector2::zeros())];
        for (line, row) in (1..).zip(text.lines()) {
            let cells: Vec<&str> = row.split(',').map(str::trim).collect();
            let has_digit = row.contains(|letter: char| letter.is_ascii_digit());
            if row.trim().is_empty() || (script.len() == 1 && !has_digit) {
                continue;
            }
            let numbers: Option<Vec<f64>> = cells.iter().map(|cell| cell.parse().ok()).collect();
            let numbers = numbers.filter(|them| them.iter().all(|number| number.is_finite()));
            let Some(&[time, x, y]) = numbers.as_deref() else {
                return Err(HandError::Row(line));
            };
            let before = script.last().map_or(0.0, |(time, _)| *time);
            if time <= before || time > 600.0 {
                return Err(HandError::Time(line));
            }
            script.push((time, Vector2::new(x, y)));
        }
        if script.len() == 1 {
            return Err(HandError::Empty);
        }
        Ok(Self {
            script: script.into(),
            grips: Arc::default(),
            grip: None,
        })
    }

    /// Grips the tip, and begins its script.
    pub fn grip(&self) {
        self.grips.store(true, Ordering::Relaxed);
    }

    /// The time from the grip until it lets the tip go [s].
    pub fn time(&self) -> f64 {
        self.script.last().map_or(0.0, |(time, _)| *time)
    }

    /// The force on a tip with this place [m] and velocity [m/s] at this time [s].
    pub fn force(&mut self, time: f64, tip: Vector2<f64>, velocity: Vector2<f64>) -> Vector2<f64> {
        if !self.grips.load(Ordering::Relaxed) {
            return Vector2::zeros();
        }
        let (begun, from) = *self.grip.get_or_insert((time, tip));
        let Some((place, rate)) = self.at(time - begun) else {
            return Vector2::zeros();
        };
        let force = STIFFNESS * (from + place - tip) + DAMPING * (rate - velocity);
        force * (STRENGTH / force.norm()).min(1.0)
    }

    /// Place [m] and velocity [m/s] so long after the grip [s]; none after the script.
    fn at(&self, time: f64) -> Option<(Vector2<f64>, Vector2<f64>)> {
        let next = self.script.iter().position(|(end, _)| time < *end)?;
        let ((begin, from), (end, to)) = (self.script[next.checked_sub(1)?], self.script[next]);
        let (duration, away) = (end - begin, to - from);
        let u = (time - begin) / duration;
        let share = u * u * u * (10.0 + u * (6.0 * u - 15.0));
        let rate = 30.0 * u * u * (1.0 - u) * (1.0 - u) / duration;
        Some((from + away * share, away * rate))
    }
}

#[cfg(test)]
mod tests {
    use super::{Hand, HandError, STRENGTH};
    use nalgebra::Vector2;

    #[test]
    fn a_hand_pulls_towards_its_script_and_lets_go_after_it() {
        let mut hand = Hand::parse("t,x,y\n1, 0.01, 0\n2, 0.01, 0.5\n").unwrap();
        let (still, tip) = (Vector2::zeros(), Vector2::new(0.1, 0.2));
        assert_eq!(hand.force(4.0, tip, still), still);
        hand.grip();
        assert_eq!(hand.force(5.0, tip, still), still);
        // In the middle of 10 mm: 5 mm, and 30/16 of the mean velocity of 10 mm/s.
        let force = hand.force(5.5, tip, still);
        assert!((force - Vector2::new(800.0 * 0.005 + 8.0 * 0.01875, 0.0)).norm() < 1e-9);
        assert!((hand.force(6.9, tip, still).norm() - STRENGTH).abs() < 1e-9);
        assert_eq!(hand.force(7.0, tip, still), still);
    }

    #[test]
    fn a_script_that_is_none_is_refused_with_its_line() {
        for (text, error) in [
            ("", HandError::Empty),
            ("t,x,y\n", HandError::Empty),
            ("t,x,y\n1,2\n", HandError::Row(2)),
            ("1,2,nan\n", HandError::Row(1)),
            ("1,0,0\n1,0,0\n", HandError::Time(2)),
        ] {
            assert_eq!(Hand::parse(text).unwrap_err(), error, "{text:?}");
        }
    }
}
