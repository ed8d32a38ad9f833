//! A smooth curve through points: the cubic spline with continuous C″, natural at its ends.
//!
//! s is the length of the chords. Between two points h apart, with the second derivatives M on both sides,
//!
//! C(s) = (1−t) P0 + t P1 + h²/6 [((1−t)³ − (1−t)) M0 + (t³ − t) M1], t = (s − s0)/h,
//!
//! and C′ is continuous where h0 M0 + 2 (h0 + h1) M1 + h1 M2 = 6 ((P2 − P1)/h1 − (P1 − P0)/h0): a tridiagonal system.

use super::path::PathPoint;
use nalgebra::Vector2;

/// A smooth curve through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Waypoints {
    /// s of each point [m].
    s: Vec<f64>,
    points: Vec<Vector2<f64>>,
    /// C″ at each point [1/m].
    second: Vec<Vector2<f64>>,
}

impl Waypoints {
    /// The curve through these points [m]; none if they are fewer than two, or two that follow one another are the same or
    /// not finite.
    pub fn new(points: &[Vector2<f64>]) -> Option<Self> {
        let chords: Vec<f64> = points.windows(2).map(|p| (p[1] - p[0]).norm()).collect();
        if chords.is_empty() || !chords.iter().all(|h| *h > 0.0 && h.is_finite()) {
            return None;
        }
        let mut s = vec![0.0];
        for h in &chords {
            s.push(s[s.len() - 1] + h);
        }
        Some(Self {
            s,
            second: second_derivatives(points, &chords),
            points: points.to_vec(),
        })
    }

    /// The length of all chords [m].
    pub fn length(&self) -> f64 {
        self.s[self.s.len() - 1]
    }

    /// The point at s, and its derivatives.
    pub(super) fn at(&self, s: f64) -> PathPoint {
        let last = self.points.len() - 2;
        let k = self
            .s
            .partition_point(|&begin| begin <= s)
            .saturating_sub(1)
            .min(last);
        let h = self.s[k + 1] - self.s[k];
        let t = (s - self.s[k]) / h;
        let r = 1.0 - t;
        let ([p0, p1], [m0, m1]) = (
            [self.points[k], self.points[k + 1]],
            [self.second[k], self.second[k + 1]],
        );
        PathPoint {
            c: p0 * r + p1 * t + (m0 * (r * r * r - r) + m1 * (t * t * t - t)) * (h * h / 6.0),
            tangent: (p1 - p0) / h
                + (m1 * (3.0 * t * t - 1.0) - m0 * (3.0 * r * r - 1.0)) * (h / 6.0),
            curvature: m0 * r + m1 * t,
        }
    }
}

/// M at each point, by elimination along the diagonal.
fn second_derivatives(points: &[Vector2<f64>], chords: &[f64]) -> Vec<Vector2<f64>> {
    let count = points.len();
    let (mut above, mut right) = (vec![0.0; count], vec![Vector2::zeros(); count]);
    for k in 1..count - 1 {
        let [h0, h1] = [chords[k - 1], chords[k]];
        let bend = (points[k + 1] - points[k]) / h1 - (points[k] - points[k - 1]) / h0;
        let pivot = 2.0 * (h0 + h1) - h0 * above[k - 1];
        above[k] = h1 / pivot;
        right[k] = (bend * 6.0 - right[k - 1] * h0) / pivot;
    }
    let mut second = vec![Vector2::zeros(); count];
    for k in (1..count - 1).rev() {
        second[k] = right[k] - second[k + 1] * above[k];
    }
    second
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Noise;

    fn random(seed: u64) -> Waypoints {
        let mut noise = Noise::new(seed);
        let mut number = || 0.1 * noise.uniform();
        let points: Vec<_> = (0..12).map(|_| Vector2::new(number(), number())).collect();
        Waypoints::new(&points).unwrap()
    }

    #[test]
    fn it_passes_each_point_and_its_second_derivative_does_not_jump() {
        for seed in 0..20 {
            let curve = random(seed);
            for (k, &s) in curve.s.iter().enumerate() {
                assert!((curve.at(s).c - curve.points[k]).norm() < 1e-15);
                let [before, after] =
                    [-1e-9, 1e-9].map(|by| curve.at((s + by).clamp(0.0, curve.length())));
                assert!((before.tangent - after.tangent).norm() < 1e-5);
                let scale = 1.0 + curve.at(s).curvature.norm();
                assert!((before.curvature - after.curvature).norm() < 1e-4 * scale);
            }
            assert!(curve.at(0.0).curvature.norm() < 1e-12);
        }
    }

    #[test]
    fn its_derivatives_are_those_of_differences() {
        let curve = random(7);
        for i in 1..200 {
            let s = curve.length() * f64::from(i) / 200.3;
            let step = 1e-6;
            let [low, high] = [-step, step].map(|by| curve.at(s + by));
            let here = curve.at(s);
            assert!(
                ((high.c - low.c) / (2.0 * step) - here.tangent).norm()
                    < 1e-6 * (1.0 + here.tangent.norm())
            );
            let slope = (high.tangent - low.tangent) / (2.0 * step);
            assert!((slope - here.curvature).norm() < 1e-4 * (1.0 + here.curvature.norm()));
        }
    }

    #[test]
    fn it_bends_less_than_other_curves_through_the_points() {
        // Of all curves through the points the natural spline has the least ∫|C″|² ds: any bump adds to it.
        let curve = random(3);
        let (steps, length) = (200_000, curve.length());
        let ds = length / f64::from(steps);
        let [mut own, mut bumped] = [0.0; 2];
        for i in 0..steps {
            let s = (f64::from(i) + 0.5) * ds;
            let k = curve.s.partition_point(|&begin| begin <= s) - 1;
            let h = curve.s[k + 1] - curve.s[k];
            let phase = std::f64::consts::PI * (s - curve.s[k]) / h;
            // sin² vanishes with its slope at every point; this is its second derivative.
            let bump = 2.0 * (std::f64::consts::PI / h).powi(2) * (2.0 * phase).cos() * 1e-4;
            let second = curve.at(s).curvature;
            own += second.norm_squared() * ds;
            bumped += (second + Vector2::new(bump, 0.0)).norm_squared() * ds;
        }
        assert!(own < bumped, "{own} {bumped}");
    }

    #[test]
    fn points_that_make_no_curve_are_refused() {
        let point = Vector2::new(0.1, 0.2);
        assert!(Waypoints::new(&[point]).is_none() && Waypoints::new(&[point, point]).is_none());
        assert!(Waypoints::new(&[point, Vector2::new(f64::NAN, 0.0)]).is_none());
    }
}
