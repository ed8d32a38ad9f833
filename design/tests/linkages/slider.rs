//! The slider-driven mechanism: round trips, rates and error transfer against finite
//! differences, PRRRP against its linkage, singular places.

use fivebar_design::linkage::dyad::{Rrr, SlideBranch};
use fivebar_design::linkage::{Coordinate, Group, Guide, LinkId, Linkage};
use fivebar_design::slider::{Geometry, GeometryError, Limb, Pose, PoseError, Travel, WorkingMode};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::Side;
use nalgebra::Vector2;
use proptest::prelude::*;

/// The test case: l3 1.2, l7 1.1, l5 0.6 m.
fn example() -> Geometry<f64> {
    Geometry::new(1.2, 1.1, 0.6).unwrap()
}

fn mode() -> impl Strategy<Value = WorkingMode> {
    prop::sample::select(WorkingMode::ALL.to_vec())
}

fn geometry() -> impl Strategy<Value = Geometry<f64>> {
    let platform = prop_oneof![Just(0.0), 0.0..1.0_f64];
    prop_oneof![
        Just(example()),
        (0.3..2.0_f64, 0.3..2.0_f64, platform)
            .prop_map(|(l3, l7, l5)| Geometry::new(l3, l7, l5).unwrap())
    ]
}

/// A pose of a random geometry, well away from singularities.
fn regular_pose() -> impl Strategy<Value = (Geometry<f64>, Pose<f64>)> {
    (geometry(), -2.0..2.0_f64, -1.0..1.0_f64, mode())
        .prop_map(|(geometry, x, height, mode)| {
            let p = Vector2::new(x, height * geometry.l3().min(geometry.l7()));
            let pose = geometry.inverse(p, mode).unwrap();
            (geometry, pose)
        })
        .prop_filter("too near a singularity", |(_, pose)| {
            pose.sin73().abs() > 0.2 && pose.u3.x.abs() > 0.2 && pose.u7.x.abs() > 0.2
        })
}

/// P after small changes of l3, l7, l5, x2 and x8.
fn moved(geometry: &Geometry<f64>, pose: &Pose<f64>, by: [f64; 5]) -> Vector2<f64> {
    let [l3, l7, l5, x2, x8] = by;
    let changed = Geometry::new(geometry.l3() + l3, geometry.l7() + l7, geometry.l5() + l5);
    // A platform of width 0 (PRRRP) cannot become shorter, as central differences would need.
    let changed = changed.unwrap_or(*geometry);
    changed
        .forward(pose.x2 + x2, pose.x8 + x8, pose.assembly())
        .unwrap()
        .p
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * b.abs().max(1.0)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn forward_undoes_inverse_on_every_branch((geometry, pose) in regular_pose()) {
        let [alpha3, alpha7] = pose.angles();
        let half = 0.5 * geometry.l5();
        prop_assert!(close(pose.x2 + geometry.l3() * alpha3.cos() + half, pose.p.x, 1e-14));
        prop_assert!(close(pose.x8 + geometry.l7() * alpha7.cos() - half, pose.p.x, 1e-14));
        prop_assert!(close(geometry.l3() * alpha3.sin(), pose.p.y, 1e-14));
        prop_assert!(close(geometry.l7() * alpha7.sin(), pose.p.y, 1e-14));

        let back = geometry.forward(pose.x2, pose.x8, pose.assembly()).unwrap();
        prop_assert!((back.p - pose.p).length() < 1e-12);
        prop_assert_eq!(back.working_mode(), pose.working_mode());
        let again = geometry.inverse(back.p, back.working_mode()).unwrap();
        prop_assert!((again.x2 - pose.x2).abs() + (again.x8 - pose.x8).abs() < 1e-11);
        let other = geometry.forward(pose.x2, pose.x8, pose.assembly().opposite()).unwrap();
        prop_assert!(close(other.p.x, back.p.x, 1e-13) && close(other.p.y, -back.p.y, 1e-13));
    }

    #[test]
    fn rates_are_finite_differences_and_undo_each_other(
        (geometry, pose) in regular_pose(),
        rates in [-1.0..1.0_f64, -1.0..1.0_f64],
        accelerations in [-3.0..3.0_f64, -3.0..3.0_f64],
    ) {
        let at = |t: f64| {
            let place = |i: usize, x: f64| x + rates[i] * t + 0.5 * accelerations[i] * t * t;
            let pose = geometry
                .forward(place(0, pose.x2), place(1, pose.x8), pose.assembly())
                .unwrap();
            let now = [0, 1].map(|i| rates[i] + accelerations[i] * t);
            (pose, geometry.forward_velocities(&pose, now).unwrap())
        };
        let (start, velocities) = at(0.0);
        let found = geometry
            .forward_accelerations(&start, &velocities, accelerations)
            .unwrap();
        let step = 1e-6;
        let ((p0, v0), (p1, v1)) = (at(-step), at(step));
        let slope = |a: f64, b: f64| (b - a) / (2.0 * step);
        let tolerance = 1e-6 * found.alpha.iter().fold(1.0_f64, |m, a| m.max(a.abs()));
        for (a, b, rate) in [
            (p0.p.x, p1.p.x, velocities.p.x),
            (p0.p.y, p1.p.y, velocities.p.y),
            (p0.angles()[0], p1.angles()[0], velocities.omega[0]),
            (p0.angles()[1], p1.angles()[1], velocities.omega[1]),
            (v0.p.x, v1.p.x, found.p.x),
            (v0.p.y, v1.p.y, found.p.y),
            (v0.omega[0], v1.omega[0], found.alpha[0]),
            (v0.omega[1], v1.omega[1], found.alpha[1]),
        ] {
            prop_assert!((slope(a, b) - rate).abs() <= tolerance, "{rate} for {}", slope(a, b));
        }
        prop_assert!(velocities.p.length() > 0.0 && found.p.length() > 0.0);

        let back = geometry.inverse_velocities(&start, velocities.p).unwrap();
        let again = geometry.inverse_accelerations(&start, &back, found.p).unwrap();
        for i in 0..2 {
            prop_assert!(close(back.sliders[i], rates[i], 1e-12));
            prop_assert!((again.sliders[i] - accelerations[i]).abs() <= 1e-10 * tolerance / 1e-6);
            prop_assert!(close(back.omega[i], velocities.omega[i], 1e-12));
            prop_assert!(close(again.alpha[i], found.alpha[i], 1e-11));
        }
    }

    #[test]
    fn inverse_rates_are_the_printed_ones(
        (geometry, pose) in regular_pose(),
        v in [-1.0..1.0_f64, -1.0..1.0_f64],
        a in [-3.0..3.0_f64, -3.0..3.0_f64],
    ) {
        let rates = geometry.inverse_velocities(&pose, Vector2::new(v[0], v[1])).unwrap();
        let found = geometry.inverse_accelerations(&pose, &rates, Vector2::new(a[0], a[1])).unwrap();
        let y = pose.p.y;
        let limbs = [(geometry.l3(), pose.u3.x), (geometry.l7(), pose.u7.x)];
        for (i, (l, cosine)) in limbs.into_iter().enumerate() {
            let h = (l * l - y * y).sqrt().copysign(cosine);
            let rate = v[0] + y * v[1] / h;
            let acceleration = a[0] + y * a[1] / h + l * l * v[1] * v[1] / (h * h * h);
            prop_assert!(close(rates.sliders[i], rate, 1e-12));
            prop_assert!(close(found.sliders[i], acceleration, 1e-11));
        }
    }

    #[test]
    fn error_transfer_is_the_finite_difference((geometry, pose) in regular_pose()) {
        let transfer = geometry.error_transfer(&pose).unwrap();
        let columns = [transfer.l3, transfer.l7, transfer.l5, transfer.x2, transfer.x8];
        let step = 1e-6;
        for (i, column) in columns.into_iter().enumerate() {
            if i == 2 && geometry.l5() < step {
                continue;
            }
            let mut by = [0.0; 5];
            by[i] = step;
            let after = moved(&geometry, &pose, by);
            let before = moved(&geometry, &pose, by.map(|b| -b));
            let difference = (after - before) * (0.5 / step);
            prop_assert!((difference - column).length() < 1e-6, "{i}: {column:?} for {difference:?}");
            prop_assert!(column.length() > 1e-3);
        }
    }

    #[test]
    fn prrrp_is_the_same_with_and_without_parallelograms(
        (geometry, pose) in regular_pose(),
        rates in [-1.0..1.0_f64, -1.0..1.0_f64],
        accelerations in [-3.0..3.0_f64, -3.0..3.0_f64],
    ) {
        // The platform only shifts: as a linkage of two sliders and two bars, the left
        // guide starts at l5/2 and the right one at −l5/2.
        let mut linkage = Linkage::new(Vector2::zeros()).unwrap();
        let mut ends = Vec::new();
        for shift in [0.5, -0.5] {
            let at = Vector2::new(shift * geometry.l5(), 0.0);
            let through = linkage.add_point("guide", LinkId::GROUND, at).unwrap();
            let guide = Guide { through, direction: Vector2::new(1.0, 0.0) };
            let slider = linkage.add_group("slider", Group::Slider { guide }).unwrap();
            let link = slider.links().next().unwrap();
            ends.push(linkage.add_point("pin", link, Vector2::zeros()).unwrap());
        }
        let apart = pose.x8 - pose.x2 > geometry.l5();
        let dyad = Rrr {
            lengths: [geometry.l3(), geometry.l7()],
            side: if apart { pose.assembly() } else { pose.assembly().opposite() },
        };
        let joint = linkage.add_group("P", Group::Rrr { dyad, ends: [ends[0], ends[1]] }).unwrap().inner_pin();
        let inputs = [(pose.x2, 0), (pose.x8, 1)].map(|(value, i)| Coordinate {
            value,
            rate: rates[i],
            acceleration: accelerations[i],
        });
        let p = linkage.motion(&inputs).unwrap().points[joint.unwrap().index()];

        let velocities = geometry.forward_velocities(&pose, rates).unwrap();
        let found = geometry.forward_accelerations(&pose, &velocities, accelerations).unwrap();
        prop_assert!((p.position - pose.p).length() < 1e-12);
        prop_assert!((p.velocity - velocities.p).length() < 1e-11);
        prop_assert!((p.acceleration - found.p).length() < 1e-10 * found.p.length().max(100.0));
    }
}

#[test]
fn the_test_case_has_the_numbers_of_its_equations() {
    // xP = x2 + 1.2 cos α3 + 0.3 = x8 + 1.1 cos α7 − 0.3 with P at (0, 0.66):
    // sin α3 = 0.55, sin α7 = 0.6, cos α7 = −0.8.
    let pose = example()
        .inverse(Vector2::new(0.0, 0.66), WorkingMode::APART)
        .unwrap();
    assert!((pose.x8 - (0.3 + 0.88)).abs() < 1e-15);
    assert!((pose.x2 + 0.3 + 1.2 * (1.0 - 0.55_f64 * 0.55).sqrt()).abs() < 1e-15);
    let [alpha3, alpha7] = pose.angles();
    assert!((alpha3.to_degrees() - 33.367_012_969).abs() < 1e-8);
    assert!((alpha7.to_degrees() - 143.130_102_354).abs() < 1e-8);
}

#[test]
fn the_printed_coefficient_at_fixed_angle_is_wrong() {
    let geometry = example();
    let pose = geometry
        .inverse(Vector2::new(0.0, 0.66), WorkingMode::APART)
        .unwrap();
    let step = 1e-6;
    let by = |l3: f64| moved(&geometry, &pose, [l3, 0.0, 0.0, 0.0, 0.0]);
    let truth = (by(step) - by(-step)) * (0.5 / step);
    let ours = geometry.error_transfer(&pose).unwrap().l3;
    let printed = pose.u3.x;
    assert!((ours - truth).length() < 1e-8);
    assert!((printed - truth.x).abs() > 0.1, "{printed} for {}", truth.x);
}

#[test]
fn equal_limbs_keep_their_angles_supplementary() {
    let geometry = Geometry::new(1.0, 1.0, 0.4).unwrap();
    let pose = geometry.forward(-0.9, 0.9, Side::Left).unwrap();
    let [alpha3, alpha7] = pose.angles();
    assert!((alpha3 + alpha7 - std::f64::consts::PI).abs() < 1e-14);
    assert!(pose.p.x.abs() < 1e-15);
}

#[test]
fn what_cannot_be_reached_and_singular_places_are_told_apart() {
    let g = example();
    let at = |y: f64| g.inverse(Vector2::new(0.0, y), WorkingMode::APART);
    let too_short = Err(PoseError::LimbTooShort(Limb::Right));
    assert_eq!(at(1.15), too_short);
    assert_eq!(at(1.25), Err(PoseError::LimbTooShort(Limb::Left)));
    let apart = |x8: f64| g.forward(0.0, x8, Side::Left);
    assert_eq!(apart(2.95), Err(PoseError::SlidersTooFar));
    assert_eq!(apart(0.65), Err(PoseError::SlidersTooNear));
    assert_eq!(apart(0.6), Err(PoseError::SlidersTooNear));
    assert_eq!(apart(f64::NAN), Err(PoseError::NotFinite));
    let twin = Geometry::new(1.0, 1.0, 0.6).unwrap();
    assert_eq!(twin.forward(0.0, 0.6, Side::Left), Err(PoseError::Parallel));

    // Type 1: the right limb is perpendicular. Forward rates exist, inverse ones do not.
    let square = at(1.1).unwrap();
    assert!(g.forward_velocities(&square, [0.1, 0.2]).is_ok());
    let refused = g.inverse_velocities(&square, Vector2::new(0.0, 1.0));
    assert_eq!(refused, Err(PoseError::LimbPerpendicular(Limb::Right)));
    // Type 2: both limbs are along the guide. Inverse rates exist, forward ones do not.
    let flat = at(0.0).unwrap();
    assert!(g.inverse_velocities(&flat, Vector2::new(0.1, 0.2)).is_ok());
    let refused = g.forward_velocities(&flat, [0.1, 0.2]);
    assert_eq!(refused, Err(PoseError::Parallel));
}

#[test]
fn lengths_that_make_no_mechanism_are_refused() {
    let refused = |l3, l7, l5| Geometry::<f64>::new(l3, l7, l5).unwrap_err();
    assert_eq!(refused(0.0, 1.0, 0.0), GeometryError::Limb(Limb::Left));
    assert_eq!(
        refused(1.0, f64::NAN, 0.0),
        GeometryError::Limb(Limb::Right)
    );
    assert_eq!(refused(1.0, 1.0, -0.1), GeometryError::Platform);
}

#[test]
fn the_workspace_is_where_the_inverse_stays_within_the_travel() {
    let geometry = example();
    let travel = Travel {
        left: [-1.6, -0.5],
        right: [0.4, 1.5],
    };
    // The sliders can pass each other, so every mode has a workspace.
    let wide = Travel {
        left: [-1.0, 0.9],
        right: [-0.7, 1.1],
    };
    let cases = WorkingMode::ALL.map(|mode| (mode, wide, 0.05));
    for (mode, travel, least) in cases.into_iter().chain([(WorkingMode::APART, travel, 0.5)]) {
        let (mut inside, step) = (0_u32, 0.01);
        for i in 0..400 {
            for j in 0..120 {
                let x = -2.0 + (f64::from(i) + 0.5) * step;
                let y = (f64::from(j) + 0.5) * step;
                let p = Vector2::new(x, y);
                let reached = geometry
                    .inverse(p, mode)
                    .is_ok_and(|pose| travel.contains(&pose));
                let section = geometry.reachable_at(y, mode, &travel);
                let within = section.is_ok_and(|[least, greatest]| least <= x && x <= greatest);
                assert_eq!(reached, within, "{mode:?} at {x}, {y}");
                inside += u32::from(reached);
            }
        }
        let counted = f64::from(inside) * step * step;
        let area = geometry.workspace_area(mode, &travel, 400);
        assert!(
            (area - counted).abs() < 0.02,
            "{mode:?}: {area} for {counted}"
        );
        assert!(area > least, "{mode:?}: {area}");
    }
    let apart = WorkingMode::new(SlideBranch::Behind, SlideBranch::Ahead);
    assert_eq!(
        geometry.reachable_at(
            0.0,
            apart,
            &Travel {
                left: [0.0, 0.1],
                right: [0.2, 0.3]
            }
        ),
        Err(PoseError::BeyondTravel)
    );
}
