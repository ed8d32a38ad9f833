//! Whole linkages: compared with the five-bar's own solution and with each other; the limits and
//! branch changes that a sweep finds.

use core::f64::consts::{PI, TAU};
use fivebar_design::Dual;
use fivebar_design::linkage::dyad::{DyadError, Rrp, Rrr, SlideBranch, Unreachable};
use fivebar_design::linkage::{
    Coordinate, DriveLaw, FourBarType, Group, Guide, LinkId, Linkage, ParameterKind, Sweep,
};
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Side};
use fivebar_kinematics::{PlanarVector, Scalar};
use fivebar_testkit::Tally;
use nalgebra::Vector2;
use proptest::prelude::*;

const MASSLESS: Link<f64> = Link {
    mass: 0.0,
    com: Vector2::new(0.0, 0.0),
    inertia: 0.0,
};

/// The five-bar as two cranks and a dyad, its tool loaded with `payload` and `force`.
fn five_bar(
    lengths: [f64; 5],
    links: [Link<f64>; 4],
    side: Side,
    payload: f64,
    gravity: Vector2<f64>,
    force: Vector2<f64>,
) -> Linkage<f64> {
    let [l1, l2, l3, l4, base] = lengths;
    let mut linkage = Linkage::new(gravity).unwrap();
    let mut driven = |at: f64, length: f64, inertia| {
        let pivot = linkage
            .add_point("pivot", LinkId::GROUND, Vector2::from([at, 0.0]))
            .unwrap();
        let crank = linkage.add_group("crank", Group::Crank { pivot }).unwrap();
        let crank = crank.links().next().unwrap();
        linkage.set_link(crank, "crank", inertia).unwrap();
        linkage
            .add_point("elbow", crank, Vector2::from([length, 0.0]))
            .unwrap()
    };
    let ends = [driven(0.0, l1, links[0]), driven(base, l4, links[3])];
    let dyad = Rrr {
        lengths: [l2, l3],
        side,
    };
    let dyad = linkage.add_group("C", Group::Rrr { dyad, ends }).unwrap();
    for (link, inertia) in dyad.links().zip([links[1], links[2]]) {
        linkage.set_link(link, "distal", inertia).unwrap();
    }
    linkage
        .set_load(dyad.inner_pin().unwrap(), payload, force)
        .unwrap();
    linkage
}

fn four_bar([frame, input, coupler, output]: [f64; 4], side: Side) -> Linkage<f64> {
    let mut linkage = Linkage::new(Vector2::zeros()).unwrap();
    let a = linkage
        .add_point("A", LinkId::GROUND, Vector2::from([0.0, 0.0]))
        .unwrap();
    let d = linkage
        .add_point("D", LinkId::GROUND, Vector2::from([frame, 0.0]))
        .unwrap();
    let crank = linkage
        .add_group("crank", Group::Crank { pivot: a })
        .unwrap();
    let crank = crank.links().next().unwrap();
    let b = linkage
        .add_point("B", crank, Vector2::from([input, 0.0]))
        .unwrap();
    let dyad = Rrr {
        lengths: [coupler, output],
        side,
    };
    let dyad = linkage
        .add_group("C", Group::Rrr { dyad, ends: [b, d] })
        .unwrap();
    for (link, name) in dyad.links().zip(["coupler", "output"]) {
        linkage.set_link(link, name, MASSLESS).unwrap();
    }
    linkage
}

fn turn_once(linkage: &Linkage<f64>) -> Sweep {
    let law = DriveLaw {
        start: 0.1,
        speed: TAU,
        ..DriveLaw::default()
    };
    Sweep::new(linkage, &[law], 1.0, 360)
}

proptest! {
    #[test]
    fn the_five_bar_as_a_linkage_is_the_five_bar(
        lengths in [0.1..0.5_f64, 0.2..0.6_f64, 0.2..0.6_f64, 0.1..0.5_f64, 0.05..0.6_f64],
        masses in prop::array::uniform4([0.01..1.0_f64, -0.1..0.3_f64, -0.1..0.1_f64, 1e-6..0.01_f64]),
        angles in [-PI..PI, -PI..PI],
        rates in [-10.0..10.0_f64, -10.0..10.0_f64],
        accelerations in [-100.0..100.0_f64, -100.0..100.0_f64],
        world in [[-9.81..9.81_f64, -9.81..9.81_f64], [-20.0..20.0_f64, -20.0..20.0_f64]],
        payload in 0.0..0.5_f64,
        left in any::<bool>(),
    ) {
        let side = if left { Side::Left } else { Side::Right };
        let links = masses.map(|[mass, x, y, inertia]| Link { mass, com: Vector2::from([x, y]), inertia });
        let [gravity, force] = world.map(Vector2::from);
        let geometry = Geometry::new(lengths);
        prop_assume!(geometry.is_ok());
        let arm = Arm::new(geometry.unwrap(), links, payload, gravity, [0.0; 2]).unwrap();
        let geometry = arm.geometry();
        let pose = geometry.forward(angles[0], angles[1], side);
        prop_assume!(pose.is_ok_and(|pose| pose.sin32().abs() > 0.05));
        let pose = pose.unwrap();
        let velocities = geometry.forward_velocities(&pose, rates[0], rates[1]).unwrap();
        let expected = geometry
            .forward_accelerations(&pose, &velocities, accelerations[0], accelerations[1])
            .unwrap();
        let torque = arm.inverse_dynamics(&pose, &velocities, &expected, force).unwrap();

        let linkage = five_bar(lengths, links, side, payload, gravity, force);
        let inputs = [0, 1].map(|i| Coordinate {
            value: angles[i],
            rate: rates[i],
            acceleration: accelerations[i],
        });
        let motion = linkage.motion(&inputs).unwrap();
        let forces = linkage.forces(&motion).unwrap();

        let dyad = motion.dyads[2].unwrap();
        // C, and with it the directions of its links, errs by ε/|sin|, and rates are quotients
        // by |sin| of terms that may cancel.
        let rounding = 1e-12 + 1e-13 / pose.sin32().powi(2);
        let close = |a: f64, b: f64, scale: f64| (a - b).abs() <= rounding * scale.max(1.0);
        let speed = velocities.omega.iter().fold(0.0_f64, |m, w| m.max(w.abs()));
        let quick = expected.alpha.iter().fold(speed * speed, |m, a| m.max(a.abs()));
        prop_assert!((dyad.inner_point.position - pose.c).length() <= rounding);
        prop_assert!((dyad.inner_point.velocity - velocities.c).length() <= rounding * speed.max(1.0));
        prop_assert!((dyad.inner_point.acceleration - expected.c).length() <= rounding * quick.max(1.0));
        for (link, i) in [(1, 0), (3, 1), (4, 2), (2, 3)].map(|(link, i)| (motion.links[link], i)) {
            prop_assert!(close(link.omega, velocities.omega[i], speed));
            prop_assert!(close(link.alpha, expected.alpha[i], quick));
        }
        let scale = torque[0].abs().max(torque[1].abs())
            + forces.reactions.iter().fold(0.0_f64, |m, r| m.max(r.wrench.force.length()));
        for i in 0..2 {
            prop_assert!(close(forces.driving[i], torque[i], scale), "{:?} for {torque:?}", forces.driving);
        }
    }
}

#[test]
fn grashofs_rule_says_whether_the_crank_turns_fully() {
    let (closes, turning) = (Tally::default(), Tally::default());
    proptest!(|(lengths in prop::array::uniform4(0.1..1.0_f64))| {
        let linkage = four_bar(lengths, Side::Left);
        let kind = linkage.four_bar().unwrap().classify();
        let sum: f64 = lengths.iter().sum();
        let [shortest, longest] = lengths.iter().fold([f64::MAX, 0.0_f64], |[s, l], &x| [s.min(x), l.max(x)]);
        if !closes.count(longest < 0.5 * sum && (sum - 2.0 * (shortest + longest)).abs() > 0.01) {
            return Ok(());
        }
        let sweep = turn_once(&linkage);
        let turns = turning.count(sweep.solved().count() == sweep.samples.len());
        let expected = matches!(kind, FourBarType::CrankRocker | FourBarType::DoubleCrank);
        prop_assert_eq!(turns, expected, "{:?}", kind);
    });
    closes.assert_accepted(0.75);
    turning.assert_accepted(0.15);
    turning.assert_refused(0.5);
}

#[test]
fn the_four_types_of_four_bar_are_told_apart() {
    for (lengths, kind) in [
        ([0.35, 0.10, 0.30, 0.25], FourBarType::CrankRocker),
        ([0.35, 0.25, 0.30, 0.10], FourBarType::RockerCrank),
        ([0.10, 0.35, 0.30, 0.25], FourBarType::DoubleCrank),
        ([0.35, 0.30, 0.10, 0.25], FourBarType::DoubleRocker),
        ([0.40, 0.10, 0.25, 0.25], FourBarType::ChangePoint),
        ([0.50, 0.20, 0.25, 0.25], FourBarType::TripleRocker),
    ] {
        let found = four_bar(lengths, Side::Left).four_bar().unwrap();
        assert_eq!(found.classify(), kind, "{lengths:?}");
    }
    let two_cranks = five_bar(
        [0.1, 0.2, 0.2, 0.1, 0.1],
        [MASSLESS; 4],
        Side::Left,
        0.0,
        Vector2::zeros(),
        Vector2::zeros(),
    );
    assert!(two_cranks.four_bar().is_none());
}

#[test]
fn a_sweep_finds_where_the_motion_ends_and_begins() {
    // The crank reaches until the diagonal from B to D is coupler + output:
    // cos θ = (a² + d² − (b+c)²) / (2 a d).
    let [d, a, b, c]: [f64; 4] = [0.50, 0.30, 0.25, 0.25];
    let edge = ((a * a + d * d - (b + c) * (b + c)) / (2.0 * a * d)).acos();
    let sweep = turn_once(&four_bar([d, a, b, c], Side::Left));
    let [ends, begins] = &sweep.limits[..] else {
        panic!("{:?}", sweep.limits);
    };
    assert!(ends.ends && !begins.ends);
    assert!(
        (ends.inputs[0] - edge).abs() < 1e-9,
        "{} for {edge}",
        ends.inputs[0]
    );
    assert!((begins.inputs[0] - (TAU - edge)).abs() < 1e-9);
    for limit in [ends, begins] {
        let too_far = DyadError::Unreachable(Unreachable::EndsTooFar);
        assert_eq!(limit.failure.element, 1);
        assert_eq!(limit.failure.reason, too_far);
    }
}

#[test]
fn a_sweep_tells_where_a_parallelogram_would_turn_over() {
    let sweep = turn_once(&four_bar([0.4, 0.1, 0.4, 0.1], Side::Left));
    assert_eq!(sweep.solved().count(), sweep.samples.len());
    let angles: Vec<f64> = sweep
        .branch_changes
        .iter()
        .map(|change| sweep.samples[change.sample].inputs[0].value)
        .collect();
    // The links are in line after half a turn and a whole turn; the sample is within a step
    // after that.
    assert_eq!(angles.len(), 2, "{angles:?}");
    for (angle, dead_point) in angles.iter().zip([PI, TAU]) {
        assert!(
            (0.0..=TAU / 360.0).contains(&(angle - dead_point)),
            "{angle}"
        );
    }
    let crank_rocker = turn_once(&four_bar([0.35, 0.10, 0.30, 0.25], Side::Left));
    assert!(crank_rocker.branch_changes.is_empty());
}

#[test]
fn every_parameter_can_be_perturbed_by_name() {
    let linkage = four_bar([0.35, 0.10, 0.30, 0.25], Side::Left);
    let longer = linkage.map_parameters(|parameter, value| match parameter.kind {
        ParameterKind::Length if parameter.part == "output" => value + 0.01,
        _ => value,
    });
    let at = [Coordinate {
        value: 1.0,
        rate: 0.0,
        acceleration: 0.0,
    }];
    let angle = |linkage: &Linkage<f64>| linkage.motion(&at).unwrap().links[3].axis.polar_angle();
    assert!((angle(&longer) - angle(&linkage)).abs() > 1e-3);
    assert_eq!(linkage.map_parameters(|_, value| value), linkage);
}

/// A four-bar whose output drives a heavy slider, everything loaded.
fn heavy_slider() -> Linkage<f64> {
    let mut linkage =
        four_bar([0.35, 0.10, 0.30, 0.25], Side::Left).map_parameters(|parameter, value| {
            match parameter.kind {
                ParameterKind::Gravity(1) => -9.81,
                ParameterKind::Mass if parameter.part != "ground" => 0.4,
                ParameterKind::Inertia => 1e-3,
                ParameterKind::CentreOfMass(axis) => 0.1 - 0.07 * axis as f64,
                _ => value,
            }
        });
    let id = |name: &str| {
        linkage.elements()[1]
            .links()
            .find(|link| linkage.links()[link.index()].name == name)
    };
    let output = id("output").unwrap();
    let end = linkage
        .add_point("E", output, Vector2::from([0.2, 0.05]))
        .unwrap();
    let through = linkage
        .add_point("G", LinkId::GROUND, Vector2::from([0.0, 0.4]))
        .unwrap();
    let guide = Guide {
        through,
        direction: Vector2::from([1.0, 0.1]),
    };
    let dyad = Rrp {
        length: 0.5,
        offset: 0.03,
        branch: SlideBranch::Ahead,
    };
    let added = linkage
        .add_group("F", Group::Rrp { dyad, end, guide })
        .unwrap();
    for (link, name) in added.links().zip(["rod", "ram"]) {
        let inertia = Link {
            mass: 0.8,
            com: Vector2::from([0.2, 0.01]),
            inertia: 2e-3,
        };
        linkage.set_link(link, name, inertia).unwrap();
    }
    linkage
        .set_load(added.inner_pin().unwrap(), 0.3, Vector2::from([-40.0, 5.0]))
        .unwrap();
    linkage
}

/// The ram's position, its acceleration, the driving torque and the reaction at its guide.
fn outcome<S: Scalar>(linkage: &Linkage<S>, angle: S) -> [S; 4] {
    let input = Coordinate {
        value: angle,
        rate: S::from_f64(12.0),
        acceleration: S::from_f64(-30.0),
    };
    let motion = linkage.motion(&[input]).unwrap();
    let forces = linkage.forces(&motion).unwrap();
    let ram = motion.points.last().unwrap();
    let guide = forces.reactions.last().unwrap();
    [
        ram.position.x,
        ram.acceleration.x,
        forces.driving[0],
        guide.wrench.force.length(),
    ]
}

#[test]
fn dual_numbers_give_the_sensitivity_to_every_parameter() {
    let linkage = heavy_slider();
    let mut count = 0;
    linkage.map_parameters(|_, value: f64| {
        count += 1;
        value
    });
    assert!(count > 40);
    let mut felt = 0;
    for chosen in 0..count {
        let mut index = 0;
        let seeded = linkage.map_parameters(|_, value| {
            index += 1;
            let seed = if index - 1 == chosen { 1.0 } else { 0.0 };
            Dual::new(value, seed)
        });
        let exact = outcome(&seeded, Dual::constant(0.9)).map(Dual::derivative);
        let step = 1e-6;
        let beside = |by: f64| {
            let mut index = 0;
            let moved = linkage.map_parameters(|_, value| {
                index += 1;
                if index - 1 == chosen {
                    value + by
                } else {
                    value
                }
            });
            outcome(&moved, 0.9)
        };
        let (before, after) = (beside(-step), beside(step));
        for i in 0..4 {
            let difference = (after[i] - before[i]) / (2.0 * step);
            let tolerance = 1e-5 * (1.0 + exact[i].abs());
            assert!(
                (exact[i] - difference).abs() < tolerance,
                "parameter {chosen}, outcome {i}: {} for {difference}",
                exact[i]
            );
            felt += usize::from(exact[i].abs() > 1e-3);
        }
    }
    assert!(
        felt > count,
        "only {felt} sensitivities of {count} parameters are felt"
    );
    let to_angle = outcome(
        &linkage.map_parameters(|_, v| Dual::constant(v)),
        Dual::variable(0.9),
    );
    assert!(to_angle[0].derivative().abs() > 1e-2);
}
