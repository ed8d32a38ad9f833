//! Coaxial arms (base 0) against the closed form of the symmetric one: with ψ the angle of its
//! couplers from the line to C, 1/κ = min(tan ψ, cot ψ).

use fivebar_kinematics::Scalar;
use fivebar_kinematics::five_bar::{
    Geometry, GeometryError, PoseError, Side, Singularity, WorkingMode,
};
use nalgebra::Vector2;
use proptest::prelude::*;
use std::f64::consts::TAU;

/// Elbow 1 on the right of the line to C, elbow 4 on the left, or the reverse.
const MIRRORED: [WorkingMode; 2] = [
    WorkingMode {
        elbow1: Side::Right,
        elbow4: Side::Left,
    },
    WorkingMode {
        elbow1: Side::Left,
        elbow4: Side::Right,
    },
];

fn symmetric<S: Scalar>(crank: S, coupler: S) -> Geometry<S> {
    Geometry::new([crank, coupler, coupler, crank, S::ZERO]).unwrap()
}

/// A symmetric arm's crank, coupler and distance of C from the hip [m], with the couplers' angle ψ
/// [rad] by the law of cosines. Neither leg is nearly in line.
fn reached() -> impl Strategy<Value = ([f64; 3], f64)> {
    (0.05..0.5_f64, 0.05..0.5_f64, 0.02..0.98_f64).prop_map(|(crank, coupler, share)| {
        let near = (crank - coupler).abs();
        let radius = near + share * (crank + coupler - near);
        let cosine =
            (coupler * coupler + radius * radius - crank * crank) / (2.0 * coupler * radius);
        ([crank, coupler, radius], cosine.acos())
    })
}

proptest! {
    #[test]
    fn the_condition_of_a_symmetric_coaxial_arm_is_the_couplers_tangent(
        ([crank, coupler, radius], psi) in reached(),
        direction in 0.0..TAU,
    ) {
        let c = Vector2::new(direction.cos(), direction.sin()) * radius;
        let tangent = psi.tan().abs();
        let expected = tangent.min(1.0 / tangent);
        for mode in MIRRORED {
            let double = symmetric(crank, coupler);
            let pose = double.inverse(c, mode).unwrap();
            // Links 2 and 3 enclose 2 ψ. Where they are in line the Jacobian is not finite.
            prop_assert!((pose.sin32().abs() - (2.0 * psi).sin().abs()).abs() < 1e-9);
            prop_assume!(pose.sin32().abs() > 0.01);
            let condition = double.jacobian(&pose).unwrap().inverse_condition();
            prop_assert!((condition - expected).abs() < 1e-9, "{} for {}", condition, expected);

            let single = symmetric(crank as f32, coupler as f32);
            let pose = single.inverse(Vector2::new(c.x as f32, c.y as f32), mode).unwrap();
            let condition = single.jacobian(&pose).unwrap().inverse_condition();
            // Near 1 it depends on the root of what single precision rounds.
            let condition = f64::from(condition);
            let squares = (1.0 - condition).powi(2) - (1.0 - expected).powi(2);
            let is_near = (condition - expected).abs() < 2e-4 || squares.abs() < 1e-6;
            prop_assert!(is_near, "{} for {}", condition, expected);
        }
    }

    #[test]
    fn a_coaxial_arm_turns_as_a_whole(
        ([crank, coupler, radius], _) in reached(),
        direction in 0.0..TAU,
    ) {
        let arm = symmetric(crank, coupler);
        let along = arm.inverse(Vector2::new(radius, 0.0), MIRRORED[0]).unwrap();
        let c = Vector2::new(direction.cos(), direction.sin()) * radius;
        let turned = arm.inverse(c, MIRRORED[0]).unwrap();
        prop_assert!((turned.u1.dot(&turned.u4) - along.u1.dot(&along.u4)).abs() < 1e-9);
        prop_assert!((turned.sin21() - along.sin21()).abs() < 1e-9);
        prop_assert!((turned.sin34() + turned.sin21()).abs() < 1e-9);
    }
}

#[test]
fn cranks_that_point_alike_are_singular() {
    let arm = symmetric(0.1, 0.16);
    let error = arm.forward(0.7, 0.7, Side::Left).unwrap_err();
    assert_eq!(error, PoseError::Singular(Singularity::Parallel));
    // Elbows on the same side put B on D wherever C is.
    let same = WorkingMode::new(Side::Left, Side::Left);
    let pose = arm.inverse(Vector2::new(0.05, 0.15), same).unwrap();
    assert_eq!(pose.nearest_singularity().0, Singularity::Parallel);
    assert!(pose.nearest_singularity().1 < 1e-9);
    assert!(arm.jacobian(&pose).is_err());
}

#[test]
fn with_equal_links_the_hip_itself_is_singular() {
    let arm = symmetric(0.15, 0.15);
    let error = arm.inverse(Vector2::zeros(), MIRRORED[0]).unwrap_err();
    assert!(matches!(error, PoseError::Singular(_)));
}

#[test]
fn a_base_is_zero_or_more_and_links_are_longer_than_zero() {
    let with = |index: usize, length: f64| {
        let mut lengths = [0.1, 0.16, 0.16, 0.1, 0.08];
        lengths[index] = length;
        Geometry::new(lengths)
    };
    assert!(with(4, 0.0).is_ok());
    assert_eq!(with(4, -1e-9), Err(GeometryError::NotPositive(4)));
    assert_eq!(with(4, f64::NAN), Err(GeometryError::NotPositive(4)));
    for link in 0..4 {
        assert_eq!(with(link, 0.0), Err(GeometryError::NotPositive(link)));
    }
    // One leg out of the other's reach.
    let apart = Geometry::new([0.1, 0.1, 0.1, 0.5, 0.0]);
    assert_eq!(apart, Err(GeometryError::CannotAssemble));
}
