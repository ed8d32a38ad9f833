//! A curve through knots that are evenly spaced in time: cubic pieces with continuous acceleration, at rest at both
//! ends.
//!
//! Between knots at distance h, with u from 0 to 1, rₖ the knots and vₖ the velocities there times h:
//!
//! r(u) = rₖ + vₖ u + (3 (rₖ₊₁ − rₖ) − 2 vₖ − vₖ₊₁) u² + (2 (rₖ − rₖ₊₁) + vₖ + vₖ₊₁) u³.
//!
//! The acceleration is continuous where vₖ₋₁ + 4 vₖ + vₖ₊₁ = 3 (rₖ₊₁ − rₖ₋₁).

use nalgebra::Vector2;

/// Least number of pieces between knots that a curve needs to be given as polynomials.
pub(super) const LEAST: usize = 4;

/// The curve.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spline {
    knots: Vec<Vector2<f64>>,
    /// Velocities at the knots times the time between two knots.
    rates: Vec<Vector2<f64>>,
}

impl Spline {
    /// Through these knots, of which there are two or more.
    pub(crate) fn through(knots: Vec<Vector2<f64>>) -> Self {
        let count = knots.len();
        let mut rates = vec![Vector2::zeros(); count];
        // Thomas's algorithm: the pivots, then from behind.
        let mut over = vec![0.0; count];
        for k in 1..count.saturating_sub(1) {
            let pivot = 4.0 - over[k - 1];
            over[k] = 1.0 / pivot;
            rates[k] = ((knots[k + 1] - knots[k - 1]) * 3.0 - rates[k - 1]) / pivot;
        }
        for k in (1..count.saturating_sub(1)).rev() {
            let next = rates[k + 1];
            rates[k] -= next * over[k];
        }
        Self { knots, rates }
    }

    /// The knots.
    pub(crate) fn knots(&self) -> &[Vector2<f64>] {
        &self.knots
    }

    /// Pieces between knots.
    pub(super) fn pieces(&self) -> usize {
        self.knots.len().saturating_sub(1)
    }

    /// Coefficients of 1, u, u², u³ on a piece.
    fn cubic(&self, piece: usize) -> [Vector2<f64>; 4] {
        let (r0, r1) = (self.knots[piece], self.knots[piece + 1]);
        let (v0, v1) = (self.rates[piece], self.rates[piece + 1]);
        let c2 = (r1 - r0) * 3.0 - v0 * 2.0 - v1;
        let c3 = (r0 - r1) * 2.0 + v0 + v1;
        [r0, v0, c2, c3]
    }

    /// Position, velocity and acceleration at a knot, in units of the time between two knots; at both ends at rest.
    fn motion(&self, knot: usize) -> [Vector2<f64>; 3] {
        let acceleration = match knot {
            0 => Vector2::zeros(),
            knot if knot >= self.pieces() => Vector2::zeros(),
            knot => self.cubic(knot)[2] * 2.0,
        };
        [self.knots[knot], self.rates[knot], acceleration]
    }

    /// The curve as polynomials from knot to knot, of which there are at least [`LEAST`]. One of them leaves out a knot
    /// in its middle and goes on with the same motion at both ends: at the curve's own ends, where it so begins and
    /// ends without acceleration, and where `joins` is true of the knot's velocity and acceleration in units of the time
    /// between two knots.
    pub(crate) fn spans(&self, joins: impl Fn(Vector2<f64>, Vector2<f64>) -> bool) -> Vec<Span> {
        let mut spans = Vec::new();
        let last = self.pieces();
        let mut knot = 0;
        while knot < last {
            let behind = knot + 1;
            let [_, velocity, acceleration] = self.motion(behind);
            let at_end = knot == 0 || knot + 2 == last;
            let joined = at_end || (knot + 3 < last && joins(velocity, acceleration));
            let next = if joined { knot + 2 } else { behind };
            let span = match joined {
                true => Span::between(knot, [self.motion(knot), self.motion(next)]),
                false => {
                    let [c0, c1, c2, c3] = self.cubic(knot);
                    let zero = Vector2::zeros();
                    Span {
                        begin: knot,
                        knots: 1,
                        coefficients: [c0, c1, c2, c3, zero, zero],
                    }
                }
            };
            spans.push(span);
            knot = next;
        }
        spans
    }

    /// The curve at a time in units of the time between two knots; at rest beyond its ends.
    pub(super) fn at(&self, time: f64) -> Vector2<f64> {
        let last = self.pieces() as f64;
        let time = time.clamp(0.0, last);
        let piece = (time as usize).min(self.pieces().saturating_sub(1));
        let [c0, c1, c2, c3] = self.cubic(piece);
        let u = time - piece as f64;
        c0 + (c1 + (c2 + c3 * u) * u) * u
    }
}

/// A part of the curve as one polynomial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    /// The knot at its beginning.
    pub(crate) begin: usize,
    /// Knots from its beginning to its end.
    pub(crate) knots: usize,
    /// Of 1, u … u⁵, with u from 0 to 1.
    coefficients: [Vector2<f64>; 6],
}

impl Span {
    /// From position, velocity and acceleration to others two knots later, in units of the time between two knots.
    fn between(begin: usize, [[r0, v0, a0], [r1, v1, a1]]: [[Vector2<f64>; 3]; 2]) -> Self {
        let (v0, v1) = (v0 * 2.0, v1 * 2.0);
        let (a0, a1) = (a0 * 4.0, a1 * 4.0);
        let apart = r1 - r0;
        Self {
            begin,
            knots: 2,
            coefficients: [
                r0,
                v0,
                a0 * 0.5,
                apart * 10.0 - v0 * 6.0 - v1 * 4.0 - a0 * 1.5 + a1 * 0.5,
                apart * -15.0 + v0 * 8.0 + v1 * 7.0 + a0 * 1.5 - a1,
                apart * 6.0 - (v0 + v1) * 3.0 - a0 * 0.5 + a1 * 0.5,
            ],
        }
    }

    /// Coefficients from `from` to `to`, with u from 0 to 1 between them.
    pub(crate) fn part(&self, from: f64, to: f64) -> [Vector2<f64>; 6] {
        let mut part = self.coefficients;
        // Horner's scheme over and over: the polynomial about `from`.
        for least in 0..6 {
            for k in (least..5).rev() {
                let next = part[k + 1];
                part[k] += next * from;
            }
        }
        let share = to - from;
        for (k, coefficient) in (0..).zip(&mut part) {
            *coefficient *= share.powi(k);
        }
        part
    }

    /// Velocity and acceleration at `u`, in units of the time between two knots.
    pub(super) fn motion(&self, u: f64) -> [Vector2<f64>; 2] {
        let [_, c1, c2, ..] = self.part(u, u + 1.0);
        let per = 1.0 / self.knots as f64;
        [c1 * per, c2 * (2.0 * per * per)]
    }
}

#[cfg(test)]
mod tests {
    use super::{Span, Spline};
    use nalgebra::Vector2;

    /// From rest to rest without acceleration at both ends.
    fn swing(pieces: u32) -> Spline {
        let knots = (0..=pieces).map(|k| wave(f64::from(k) / f64::from(pieces)));
        Spline::through(knots.collect())
    }

    fn wave(share: f64) -> Vector2<f64> {
        let distance = share.powi(3) * (10.0 + share * (6.0 * share - 15.0));
        Vector2::new(distance, 2.0 * distance)
    }

    #[test]
    fn a_smooth_motion_is_kept_to_the_fourth_order() {
        let worst = |pieces: u32| {
            let spline = swing(pieces);
            let errors = (0..1000_u32).map(|i| {
                let share = f64::from(i) / 1000.0;
                (spline.at(share * f64::from(pieces)) - wave(share)).norm()
            });
            errors.fold(0.0, f64::max)
        };
        let (coarse, fine) = (worst(20), worst(40));
        assert!((14.0..18.0).contains(&(coarse / fine)), "{coarse} {fine}");
    }

    fn ends(c: [Vector2<f64>; 6], time: f64) -> [Vector2<f64>; 3] {
        let sum = |weight: fn(f64) -> f64| -> Vector2<f64> {
            (0..6_u8).zip(c).map(|(k, c)| c * weight(k.into())).sum()
        };
        let (first, second) = (sum(|k| k), sum(|k| k * (k - 1.0)));
        [sum(|_| 1.0), first / time, second / (time * time)]
    }

    #[test]
    fn position_velocity_and_acceleration_go_on_at_knots_and_cuts() {
        let spline = swing(40);
        for every in [false, true] {
            let spans = spline.spans(|_, _| every);
            assert_eq!(spans.len(), if every { 20 } else { 38 });
            assert_eq!(spans[0].motion(0.0)[1], Vector2::zeros());
            let mut before: Option<[Vector2<f64>; 3]> = None;
            for span in &spans {
                for (from, to) in [(0.0, 0.3), (0.3, 0.8), (0.8, 1.0)] {
                    let part = span.part(from, to);
                    let time = (to - from) * span.knots as f64;
                    let begins = [part[0], part[1] / time, part[2] * 2.0 / (time * time)];
                    let motion = span.motion(from);
                    assert!((motion[0] - begins[1]).norm() < 1e-12);
                    assert!((motion[1] - begins[2]).norm() < 1e-12);
                    for (before, begins) in before.iter().flatten().zip(begins) {
                        assert!((before - begins).norm() < 1e-12, "{before} {begins}");
                    }
                    before = Some(ends(part, time));
                }
                let middle = |span: &Span| span.part(0.5, 1.0)[0];
                let time = span.begin as f64 + 0.5 * span.knots as f64;
                let error = (middle(span) - spline.at(time)).norm();
                assert!(error < 1e-4, "{error}");
            }
            let [_, velocity, acceleration] = before.unwrap();
            assert!(velocity.norm() < 1e-13 && acceleration.norm() < 1e-12);
        }
    }
}
