//! Random arms and poses, and numbers compared to a scale.
#![allow(dead_code, unreachable_pub)] // each test file compiles it anew and uses its part

use fivebar_kinematics::five_bar::{Geometry, Pose, Side, WorkingMode};
use fivebar_kinematics::{Scalar, Vec2};
use proptest::prelude::*;

/// A pose of some arm together with how it was reached.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    pub geometry: Geometry<f64>,
    pub theta1: f64,
    pub theta4: f64,
    pub assembly: Side,
    pub pose: Pose<f64>,
}

pub fn side() -> impl Strategy<Value = Side> {
    prop_oneof![Just(Side::Left), Just(Side::Right)]
}

pub fn mode() -> impl Strategy<Value = WorkingMode> {
    (side(), side()).prop_map(|(elbow1, elbow4)| WorkingMode::new(elbow1, elbow4))
}

/// Any five lengths that close, from 5 cm to 50 cm, asymmetric.
pub fn geometry() -> impl Strategy<Value = Geometry<f64>> {
    prop::array::uniform5(0.05..0.5_f64)
        .prop_filter_map("does not close", |lengths| Geometry::new(lengths).ok())
}

/// A pose whose three sines are all at least `margin`.
pub fn pose(margin: f64) -> impl Strategy<Value = Case> {
    let angle = || -3.1..3.1_f64;
    (geometry(), angle(), angle(), side()).prop_filter_map(
        "no pose with that margin",
        move |(geometry, theta1, theta4, assembly)| {
            let pose = geometry.forward(theta1, theta4, assembly).ok()?;
            (pose.nearest_singularity().1 >= margin).then_some(Case {
                geometry,
                theta1,
                theta4,
                assembly,
                pose,
            })
        },
    )
}

/// Asserts |a − b| ≤ `tolerance`·max(1, |b|).
#[track_caller]
pub fn assert_close(what: &str, a: f64, b: f64, tolerance: f64) {
    let bound = tolerance * b.abs().max(1.0);
    assert!(
        (a - b).abs() <= bound,
        "{what}: {a} for {b}, bound {bound:e}"
    );
}

/// The distance of two points.
pub fn distance<S: Scalar>(a: Vec2<S>, b: Vec2<S>) -> f64 {
    (a - b).norm().to_f64()
}

/// The difference of two angles, whole turns apart from none.
pub fn turned(a: f64, b: f64) -> f64 {
    let (sin, cos) = (a - b).sin_cos();
    sin.atan2(cos)
}
