//! Numbers, points and angles compared.

use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Asserts |a − b| ≤ `tolerance`·max(1, |b|).
///
/// # Panics
/// If they differ by more; the message begins with `what`.
#[track_caller]
pub fn assert_close(what: &str, a: f64, b: f64, tolerance: f64) {
    let bound = tolerance * b.abs().max(1.0);
    assert!(
        (a - b).abs() <= bound,
        "{what}: {a} for {b}, bound {bound:e}"
    );
}

/// The distance of two points [m].
pub fn distance<S: Scalar>(a: Vector2<S>, b: Vector2<S>) -> f64 {
    (a - b).length().to_f64()
}

/// The difference a − b of two angles, in (−π, π] [rad].
pub fn turned(a: f64, b: f64) -> f64 {
    let (sin, cos) = (a - b).sin_cos();
    sin.atan2(cos)
}
