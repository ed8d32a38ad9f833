//! Paths C(s) of the tip, with their derivatives.
//!
//! | piece | C(s) | s |
//! |---|---|---|
//! | line | P + s u | length [m] |
//! | arc | M + r u(φ), φ = φ0 ± s/r | length [m] |
//! | curve | a shape of a trajectory, from one s to another | that of the curve, from 0 [m] |
//! | waypoints | a cubic spline | length of the chords [m] |
//! | Fourier | x0 + Σ ak cos 2πks + bk sin 2πks, and y alike | 0…1 |

use super::waypoints::Waypoints;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::trajectory::Curve;
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// One coordinate of a Fourier piece: the mean [m], and the amplitudes [m] of the cosine and the
/// sine of each harmonic.
#[derive(Clone, Debug, PartialEq)]
pub struct FourierSeries {
    /// The mean [m].
    pub mean: f64,
    /// (ak, bk) for k = 1, 2, … [m].
    pub harmonics: Vec<[f64; 2]>,
}

/// A smooth piece of a path.
#[derive(Clone, Debug, PartialEq)]
pub enum PathPiece {
    /// A straight line.
    Line {
        /// Where it begins [m].
        from: Vector2<f64>,
        /// Where it ends [m].
        to: Vector2<f64>,
    },
    /// A circular arc.
    Arc {
        /// Its centre M [m].
        centre: Vector2<f64>,
        /// Its radius r [m].
        radius: f64,
        /// The angle φ0 at which it begins [rad].
        start: f64,
        /// The angle it covers, negative if clockwise [rad].
        sweep: f64,
    },
    /// A curve of period 1 in s.
    Fourier {
        /// x(s).
        x: FourierSeries,
        /// y(s).
        y: FourierSeries,
    },
    /// A smooth curve through points.
    Waypoints(Waypoints),
    /// A part of a shape on which the controller moves the tool.
    Curve {
        /// The shape.
        curve: Curve<f64>,
        /// Where it begins on the shape [m].
        from: f64,
        /// Its length [m].
        length: f64,
    },
}

/// A point of a path with its derivatives by s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// C [m].
    pub c: Vector2<f64>,
    /// C′.
    pub tangent: Vector2<f64>,
    /// C″.
    pub curvature: Vector2<f64>,
}

impl FourierSeries {
    /// The value, its first and its second derivative.
    fn at(&self, s: f64) -> [f64; 3] {
        let mut sum = [self.mean, 0.0, 0.0];
        // u(2πks) by turning on from harmonic to harmonic.
        let (sine1, cosine1) = libm::sincos(TAU * s);
        let (mut sine, mut cosine) = (0.0, 1.0);
        for (index, [a, b]) in self.harmonics.iter().enumerate() {
            let k = TAU * (index + 1) as f64;
            (sine, cosine) = (
                sine * cosine1 + cosine * sine1,
                cosine * cosine1 - sine * sine1,
            );
            let value = a * cosine + b * sine;
            sum[0] += value;
            sum[1] += k * (b * cosine - a * sine);
            sum[2] -= k * k * value;
        }
        sum
    }
}

impl PathPiece {
    /// The angle by which the tangent turns between two points, nearly [rad].
    pub(super) fn turning(&self, from: f64, to: f64) -> f64 {
        const SAMPLES: usize = 2;
        match self {
            Self::Line { .. } => 0.0,
            Self::Arc { radius, .. } => (to - from) / radius,
            Self::Curve { .. } | Self::Fourier { .. } | Self::Waypoints(_) => {
                let step = (to - from) / SAMPLES as f64;
                let rates = (0..SAMPLES).map(|k| {
                    let at = self.at(from + step * (k as f64 + 0.5));
                    at.tangent.perp(&at.curvature).abs() / at.tangent.norm_squared()
                });
                rates.sum::<f64>() * step
            }
        }
    }

    /// The greatest s; the least is 0.
    pub fn length(&self) -> f64 {
        match self {
            Self::Line { from, to } => (to - from).norm(),
            Self::Arc { radius, sweep, .. } => radius * sweep.abs(),
            Self::Fourier { .. } => 1.0,
            Self::Curve { length, .. } => *length,
            Self::Waypoints(curve) => curve.length(),
        }
    }

    /// The point at s, and its derivatives.
    pub fn at(&self, s: f64) -> PathPoint {
        match self {
            Self::Line { from, to } => {
                let u = (to - from) / self.length();
                PathPoint {
                    c: from + u * s,
                    tangent: u,
                    curvature: Vector2::zeros(),
                }
            }
            Self::Arc {
                centre,
                radius,
                start,
                sweep,
            } => {
                let turn = sweep.signum();
                let (sine, cosine) = libm::sincos(start + turn * s / radius);
                let u = Vector2::new(cosine, sine);
                PathPoint {
                    c: centre + u * *radius,
                    tangent: u.perpendicular() * turn,
                    curvature: u / -radius,
                }
            }
            Self::Curve { curve, from, .. } => {
                let point = curve.at(from + s);
                PathPoint {
                    c: point.position,
                    tangent: point.tangent,
                    curvature: point.curvature,
                }
            }
            Self::Waypoints(curve) => curve.at(s),
            Self::Fourier { x, y } => {
                let ([x, x1, x2], [y, y1, y2]) = (x.at(s), y.at(s));
                PathPoint {
                    c: Vector2::new(x, y),
                    tangent: Vector2::new(x1, y1),
                    curvature: Vector2::new(x2, y2),
                }
            }
        }
    }
}
