//! On every branch, the inverse solution reverses the forward solution.

use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{
    Geometry, PoseError, Side, Singularity, Unreachable, WorkingMode,
};
use fivebar_testkit::{Case, Tally, assert_close, distance, geometry, pose, side, turned};
use nalgebra::Vector2;
use proptest::prelude::*;

/// The arm of the literature's closed-form figures: four links of 0.23 m, base 0.275 m.
fn textbook() -> Geometry<f64> {
    Geometry::new([0.23, 0.23, 0.23, 0.23, 0.275]).unwrap()
}

proptest! {
    #[test]
    fn inverse_undoes_forward_on_both_assemblies(case in pose(1e-3)) {
        let Case { geometry, theta1, theta4, assembly, pose } = case;
        prop_assert_eq!(pose.assembly(), assembly);
        let back = geometry.inverse(pose.c, pose.working_mode()).unwrap();
        let [back1, _, _, back4] = back.angles();
        prop_assert!(turned(back1, theta1).abs() < 1e-9);
        prop_assert!(turned(back4, theta4).abs() < 1e-9);
        prop_assert_eq!(back.assembly(), assembly);
    }

    #[test]
    fn every_working_mode_holds_the_same_point_in_its_own_way(case in pose(1e-2)) {
        let Case { geometry, pose, .. } = case;
        let poses = WorkingMode::ALL.map(|mode| (mode, geometry.inverse(pose.c, mode).unwrap()));
        for (index, (mode, pose_of_mode)) in poses.iter().enumerate() {
            prop_assert_eq!(pose_of_mode.working_mode(), *mode);
            let [theta1, _, _, theta4] = pose_of_mode.angles();
            // Where links 2 and 3 are in line, the forward solution is accurate only to the square
            // root of the rounding error. The case's own mode is not such a mode.
            let (_, sine) = pose_of_mode.nearest_singularity();
            prop_assert!(sine > 1e-3 || *mode != pose.working_mode());
            if sine > 1e-3 {
                let again = geometry.forward(theta1, theta4, pose_of_mode.assembly()).unwrap();
                prop_assert!(distance(again.c, pose.c) < 1e-10);
            }
            for (_, other) in poses.iter().skip(index + 1) {
                let apart = distance(pose_of_mode.b, other.b) + distance(pose_of_mode.d, other.d);
                prop_assert!(apart > 1e-4, "two modes give one pose");
            }
        }
    }

    #[test]
    fn a_pose_closes_the_loop(case in pose(1e-3)) {
        let Case { geometry, pose, .. } = case;
        let [l1, l2, l3, l4, _] = geometry.lengths();
        for (tip, root, u, length) in [
            (pose.b, Vector2::zeros(), pose.u1, l1),
            (pose.c, pose.b, pose.u2, l2),
            (pose.c, pose.d, pose.u3, l3),
            (pose.d, geometry.e(), pose.u4, l4),
        ] {
            prop_assert!(distance(tip, root + u * length) < 1e-12);
            prop_assert!((u.norm() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn links_are_the_vectors_between_the_joints_of_their_pose(case in pose(1e-3)) {
        let Case { geometry, assembly, pose, .. } = case;
        let links = geometry.links(pose.u1, pose.u4, assembly).unwrap();
        for (vector, root, tip) in [
            (links.ab, Vector2::zeros(), pose.b),
            (links.bc, pose.b, pose.c),
            (links.dc, pose.d, pose.c),
            (links.ed, geometry.e(), pose.d),
        ] {
            prop_assert!(distance(root + vector, tip) < 1e-12);
        }
        prop_assert!((links.cross - links.bc.cross_z(links.dc)).abs() < 1e-12);
        let of_links = geometry.pose(&links);
        for (found, expected) in [
            (of_links.u1, pose.u1),
            (of_links.u2, pose.u2),
            (of_links.u3, pose.u3),
            (of_links.u4, pose.u4),
            (of_links.b, pose.b),
            (of_links.c, pose.c),
            (of_links.d, pose.d),
        ] {
            prop_assert!(distance(found, expected) < 1e-11, "{found} for {expected}");
        }
    }

    #[test]
    fn half_angle_formulas_give_the_same_roots(case in pose(1e-3)) {
        let Case { geometry, theta1, theta4, assembly, pose } = case;
        let [_, theta2, theta3, _] = pose.angles();
        let [yu2, yu3] = geometry.half_angle_forward(theta1, theta4, assembly).unwrap();
        prop_assert!(turned(yu2, theta2).abs() < 1e-8);
        prop_assert!(turned(yu3, theta3).abs() < 1e-8);
        let [yu1, yu4] = geometry.half_angle_inverse(pose.c, pose.working_mode()).unwrap();
        prop_assert!(turned(yu1, theta1).abs() < 1e-8);
        prop_assert!(turned(yu4, theta4).abs() < 1e-8);
    }

    #[test]
    fn a_point_on_the_rim_of_reach_is_not_refused_for_rounding((geometry, c) in rim()) {
        let pose = geometry.inverse(c, WorkingMode::ALL[0]).unwrap();
        prop_assert!(pose.sin21().abs() < 1e-5, "leg 1 is in line");
        prop_assert!(distance(pose.b + pose.u2 * geometry.l2(), c) < 1e-12);
    }
}

/// A point at exactly the greatest or least distance that leg 1 reaches, where leg 4 does.
fn rim() -> impl Strategy<Value = (Geometry<f64>, Vector2<f64>)> {
    (geometry(), -3.1..3.1, 0..2_usize).prop_filter_map(
        "leg 4 does not reach",
        |(geometry, direction, which)| {
            let c = Vector2::unit(direction) * geometry.leg1_radii()[which];
            let beyond_leg4 = matches!(
                geometry.reach(c),
                Err(PoseError::Unreachable(
                    Unreachable::Leg4TooFar | Unreachable::Leg4TooNear
                ))
            );
            (!beyond_leg4).then_some((geometry, c))
        },
    )
}

#[test]
fn what_forward_refuses_has_no_pose() {
    let tally = Tally::default();
    let angle = || -3.1..3.1;
    proptest!(|(geometry in geometry(), theta1 in angle(), theta4 in angle(), assembly in side())| {
        let b = Vector2::unit(theta1) * geometry.l1();
        let d = geometry.e() + Vector2::unit(theta4) * geometry.l4();
        let elbows = distance(b, d);
        let outcome = geometry.forward(theta1, theta4, assembly);
        tally.count(outcome.is_ok());
        if elbows > geometry.l2() + geometry.l3() + 1e-12 {
            prop_assert_eq!(outcome, Err(PoseError::Unreachable(Unreachable::ElbowsTooFar)));
        } else if elbows < (geometry.l2() - geometry.l3()).abs() - 1e-12 {
            prop_assert_eq!(outcome, Err(PoseError::Unreachable(Unreachable::ElbowsTooNear)));
        } else {
            prop_assert!(outcome.is_ok());
        }
    });
    tally.assert_accepted(0.35);
    tally.assert_refused(0.3);
}

#[test]
fn what_inverse_refuses_is_what_reach_refuses() {
    let tally = Tally::default();
    proptest!(|(geometry in geometry(), x in -0.7..0.7, y in -0.7..0.7)| {
        let c = Vector2::new(x, y);
        let reached = geometry.reach(c);
        tally.count(reached.is_ok());
        for mode in WorkingMode::ALL {
            prop_assert_eq!(geometry.inverse(c, mode).map(|_| ()), reached);
        }
    });
    tally.assert_accepted(0.12);
    tally.assert_refused(0.5);
}

#[test]
fn a_leg_reaches_from_the_difference_of_its_links_to_their_sum() {
    let geometry = Geometry::new([0.1, 0.16, 0.12, 0.05, 0.08]).unwrap();
    for (radii, expected) in [
        (geometry.leg1_radii(), [0.06, 0.26]),
        (geometry.leg4_radii(), [0.07, 0.17]),
    ] {
        assert_close("the least radius", radii[0], expected[0], 1e-15);
        assert_close("the greatest radius", radii[1], expected[1], 1e-15);
    }
}

#[test]
fn half_angle_formulas_give_a_driven_link_along_the_base() {
    // θ1 = 0 on one elbow: C is straight above B, and all numbers are exact in binary.
    let geometry = Geometry::new([3.0, 4.0, 4.0, 3.0, 2.0]).unwrap();
    let mode = WorkingMode::new(Side::Left, Side::Right);
    let c = Vector2::new(3.0, 4.0);
    let [theta1, theta4] = geometry.half_angle_inverse(c, mode).unwrap();
    let [expected1, _, _, expected4]: [f64; 4] = geometry.inverse(c, mode).unwrap().angles();
    assert_eq!((theta1, expected1), (0.0, 0.0));
    assert_close("θ4", theta4, expected4, 1e-15);
}

#[test]
fn numbers_that_are_not_finite_are_refused_by_name() {
    let geometry = textbook();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let refused = Err(PoseError::NotFinite);
        assert_eq!(geometry.forward(bad, 1.0, Side::Left).map(|_| ()), refused);
        assert_eq!(geometry.forward(1.0, bad, Side::Left).map(|_| ()), refused);
        for c in [Vector2::new(bad, 0.1), Vector2::new(0.1, bad)] {
            assert_eq!(geometry.reach(c), refused);
            assert_eq!(
                geometry.inverse(c, WorkingMode::ALL[0]).map(|_| ()),
                refused
            );
        }
    }
    let huge = geometry.inverse(Vector2::new(1e300, 0.0), WorkingMode::ALL[0]);
    let too_far = PoseError::Unreachable(Unreachable::Leg1TooFar);
    assert_eq!(huge, Err(too_far));
}

#[test]
fn c_on_a_base_pivot_is_singular_where_the_leg_folds_onto_it() {
    let geometry = textbook();
    for mode in WorkingMode::ALL {
        let at_a = geometry.inverse(Vector2::zeros(), mode);
        assert_eq!(at_a, Err(PoseError::Singular(Singularity::Leg1)));
        let at_e = geometry.inverse(geometry.e(), mode);
        assert_eq!(at_e, Err(PoseError::Singular(Singularity::Leg4)));
    }
    let uneven = Geometry::new([0.2, 0.23, 0.23, 0.2, 0.275]).unwrap();
    let at_a = uneven.inverse(Vector2::zeros(), WorkingMode::ALL[0]);
    assert_eq!(at_a, Err(PoseError::Unreachable(Unreachable::Leg1TooNear)));
}

#[test]
fn elbows_that_meet_are_singular() {
    // cos θ1 = base/(2 l1): 53.28564°.
    let theta1 = (0.1375_f64 / 0.23).acos();
    assert_close("θ1", theta1.to_degrees(), 53.28564, 1e-7);
    for assembly in Side::BOTH {
        let pose = textbook().forward(theta1, std::f64::consts::PI - theta1, assembly);
        assert_eq!(pose, Err(PoseError::Singular(Singularity::Parallel)));
    }
}

#[test]
fn the_symmetric_flat_pose_is_given_but_does_not_move() {
    // Elbows 2·0.23 m apart: cos θ1 = (0.1375 − 0.23)/0.23, 113.71415°.
    let geometry = textbook();
    let theta1 = (0.1375_f64 / 0.23 - 1.0).acos();
    assert_close("θ1", theta1.to_degrees(), 113.71415, 1e-7);
    for assembly in Side::BOTH {
        let pose = geometry
            .forward(theta1, std::f64::consts::PI - theta1, assembly)
            .unwrap();
        assert_close("height of C", pose.c.y, 0.210_579_56, 1e-8);
        let singular = PoseError::Singular(Singularity::Parallel);
        assert_eq!(geometry.forward_velocities(&pose, 1.0, 0.5), Err(singular));
        assert_eq!(geometry.jacobian(&pose), Err(singular));
        // The inverse direction is regular there.
        assert!(geometry.inverse_jacobian(&pose).is_ok());
    }
}

#[test]
fn half_angle_formulas_fail_beside_a_root_at_pi_where_the_arm_does_not() {
    use std::f64::consts::{FRAC_PI_2, PI};
    // Leg 1 with θ1 = π on one elbow: |rC + l1 x̂| = l2, all numbers exact in binary.
    let geometry = Geometry::new([0.25, 0.625, 0.625, 0.25, 0.25]).unwrap();
    let c = Vector2::new(0.125, 0.5);
    let [at_pi, beside] = [Side::Right, Side::Left].map(|side| WorkingMode::new(side, side));
    let [theta1, ..]: [f64; 4] = geometry.inverse(c, at_pi).unwrap().angles();
    assert_close("θ1", theta1.abs(), PI, 1e-15);
    let pose = geometry.inverse(c, beside).unwrap();
    assert!(pose.nearest_singularity().1 > 0.1);
    assert_eq!(geometry.half_angle_inverse(c, beside), None);

    // Dyad B–C–D with θ2 = π on one assembly: |rD − rB + l2 x̂| = l3.
    let geometry = Geometry::new([0.5, 0.25, 0.625, 0.5, 0.625]).unwrap();
    let [_, theta2, ..]: [f64; 4] = geometry
        .forward(0.0, FRAC_PI_2, Side::Left)
        .unwrap()
        .angles();
    assert_close("θ2", theta2.abs(), PI, 1e-15);
    let pose = geometry.forward(0.0, FRAC_PI_2, Side::Right).unwrap();
    assert!(pose.sin32().abs() > 0.1);
    assert_eq!(
        geometry.half_angle_forward(0.0, FRAC_PI_2, Side::Right),
        None
    );
}
