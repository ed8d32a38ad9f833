//! Accepted and refused paths against dense sampling.

use crate::common::{V, envelope};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{
    Geometry, JointLimits, Pose, Side, Tool, WorkingMode, Workspace, WorkspaceViolation,
};
use fivebar_kinematics::trajectory::{Envelope, PathSegment, Sense};
use fivebar_testkit::{Tally, side};
use proptest::prelude::*;

const MARGIN: f64 = 0.08;
/// The reserves of the check of a path, as its module states them.
const SPARE_SHARE: f64 = 0.01;
const SPARE_ANGLE: f64 = 0.001;
const SAMPLES: u32 = 2000;

/// Least |sin| of an angle, and least distance from a joint limit [rad].
struct Keep {
    margin: f64,
    angle: f64,
}

const BARELY: Keep = Keep {
    margin: MARGIN,
    angle: 0.0,
};
// The check's reserves, and rounding.
const SPARED: Keep = Keep {
    margin: MARGIN * (1.0 + SPARE_SHARE) + 1e-9,
    angle: SPARE_ANGLE + 1e-9,
};

// More than the reserves, also along a path of ten nanometres.
const CLEARLY: Keep = Keep {
    margin: 1.1 * MARGIN,
    angle: 2.0 * SPARE_ANGLE,
};

/// The sines at leg 1 (A–B–T), at leg 4 and at C.
fn sines(tool: &Tool<f64>, pose: &Pose<f64>) -> [f64; 3] {
    let bt = tool.point(pose) - pose.b;
    [pose.u1.cross_z(bt) / bt.norm(), pose.sin34(), pose.sin32()]
}

fn within(workspace: &Workspace<f64>, pose: &Pose<f64>, keep: &Keep) -> bool {
    let clear = sines(&workspace.tool, pose)
        .iter()
        .all(|sine| sine.abs() >= keep.margin);
    let free = workspace.limits.as_ref().is_none_or(|limits| {
        let ranges = limits
            .ranges()
            .map(|[a, b]| [a + keep.angle, b - keep.angle]);
        ranges.iter().all(|[a, b]| a < b)
            && JointLimits::new(ranges[0], ranges[1])
                .unwrap()
                .angles_within(pose.u1.polar_angle(), pose.u4.polar_angle())
                .is_ok()
    });
    clear && free
}

/// Dense sampling: whether every sample is within, in one assembly mode.
fn sampled(envelope: &Envelope<f64>, segment: &PathSegment<f64>, keep: &Keep) -> bool {
    let workspace = &envelope.workspace;
    let mut assembly = None;
    (0..=SAMPLES).all(|i| {
        let s = segment.length() * f64::from(i) / f64::from(SAMPLES);
        let Ok(pose) = workspace
            .tool
            .inverse(segment.at(s).position, workspace.mode)
        else {
            return false;
        };
        let side = Side::of(pose.sin32());
        within(workspace, &pose, keep) && *assembly.get_or_insert(side) == side
    })
}

fn arms() -> impl Strategy<Value = Envelope<f64>> {
    let length = 0.05..0.4_f64;
    (
        prop::array::uniform5(length),
        prop::array::uniform2(-0.1..0.1_f64),
        any::<bool>(),
        any::<bool>(),
        any::<bool>(),
        any::<bool>(),
        prop::array::uniform4(-3.0..3.0_f64),
    )
        .prop_filter_map(
            "no arm",
            |(lengths, offset, left1, left4, tool, limited, ends)| {
                let geometry = Geometry::new(lengths).ok()?;
                let offset = if tool {
                    V::new(offset[0], offset[1])
                } else {
                    V::zeros()
                };
                let side = |left| if left { Side::Left } else { Side::Right };
                let [a, b, c, d] = ends;
                let range = |a: f64, b: f64| [a.min(b), (a.max(b) + 1.5).min(a.min(b) + 6.0)];
                let limits = JointLimits::new(range(a, b), range(c, d)).ok()?;
                let mut envelope = envelope(0.0);
                envelope.workspace = Workspace {
                    tool: Tool::new(geometry, offset).ok()?,
                    mode: WorkingMode::new(side(left1), side(left4)),
                    limits: limited.then_some(limits),
                    margin: MARGIN,
                };
                Some(envelope)
            },
        )
}

#[test]
fn a_place_is_admitted_as_a_path_through_it_is_with_any_tool() {
    let (reached, within_limits) = (Tally::default(), Tally::default());
    let points = prop::collection::vec(prop::array::uniform2(-0.6..0.6_f64), 64);
    proptest!(ProptestConfig::with_cases(500), |(envelope in arms(), points in points)| {
        let workspace = &envelope.workspace;
        for [x, y] in points {
            let point = V::new(x, y);
            let pose = workspace.tool.inverse(point, workspace.mode);
            let checked = workspace.check(point);
            if !reached.count(pose.is_ok()) {
                prop_assert!(matches!(checked, Err(WorkspaceViolation::Pose(_))));
                continue;
            }
            let pose = pose.unwrap();
            within_limits.count(checked.is_ok());
            prop_assert_eq!(checked.is_ok(), within(workspace, &pose, &BARELY));
            // Almost the shortest path possible, and far shorter than the reserves.
            let speck = PathSegment::line(point, point + V::new(1e-8, 0.0)).unwrap();
            let path = envelope.check(&speck, 0.1);
            prop_assert!(path.is_err() || checked.is_ok());
            prop_assert!(path.is_ok() || !within(workspace, &pose, &CLEARLY));
        }
    });
    reached.assert_accepted(0.17);
    within_limits.assert_accepted(0.5);
    within_limits.assert_refused(0.25);
}

/// Any arm, and a place where it may be.
fn starts() -> impl Strategy<Value = (Envelope<f64>, V)> {
    let guesses = prop::collection::vec(prop::array::uniform2(-0.6..0.6_f64), 24);
    (arms(), guesses).prop_filter_map("no place to start from", |(envelope, guesses)| {
        let workspace = &envelope.workspace;
        let mut places = guesses.iter().map(|[x, y]| V::new(*x, *y));
        let place = places.find(|&point| {
            workspace
                .tool
                .inverse(point, workspace.mode)
                .is_ok_and(|pose| within(workspace, &pose, &SPARED))
        })?;
        Some((envelope, place))
    })
}

/// A line or an arc from `from`.
fn segments(from: V) -> impl Strategy<Value = (PathSegment<f64>, Option<f64>)> {
    let bulge = prop::option::of(-2.0..2.0_f64);
    (-3.0..3.0_f64, -3.0..-0.3_f64, bulge, any::<bool>()).prop_map(
        move |(direction, size, bulge, clockwise)| {
            let to = from + V::unit(direction) * 10_f64.powf(size);
            let segment = match bulge {
                None => PathSegment::line(from, to),
                Some(bulge) => {
                    let chord = to - from;
                    let centre = from + chord * 0.5 + chord.perpendicular() * bulge;
                    let sense = if clockwise {
                        Sense::Clockwise
                    } else {
                        Sense::CounterClockwise
                    };
                    PathSegment::arc(from, to, centre, sense, 1e-9)
                }
            };
            (segment.unwrap(), bulge)
        },
    )
}

#[test]
fn nothing_bad_is_accepted_and_nothing_good_is_refused() {
    let (accepted, sampled_before) = (Tally::default(), Tally::default());
    let cases = starts().prop_flat_map(|(envelope, from)| (Just(envelope), segments(from)));
    proptest!(ProptestConfig::with_cases(2000), |((envelope, (segment, bulge)) in cases)| {
        let outcome = envelope.check(&segment, 0.1);
        accepted.count(outcome.is_ok());
        let Err(refusal) = outcome else {
            prop_assert!(sampled(&envelope, &segment, &BARELY));
            return Ok(());
        };
        let place = segment.at(refusal.fraction * segment.length()).position;
        prop_assert!((place - refusal.point).norm() < 1e-9);
        // The place violates a limit with its reserve, and the path before it violates none.
        let workspace = &envelope.workspace;
        let pose = workspace.tool.inverse(refusal.point, workspace.mode);
        prop_assert!(pose.is_err() || !within(workspace, &pose.unwrap(), &SPARED));
        prop_assert!(refusal.fraction > 0.0, "it starts where it may be");
        if sampled_before.count(bulge.is_none()) {
            let before = PathSegment::line(segment.start(), refusal.point).unwrap();
            let nearly = Keep { margin: MARGIN * 0.999, angle: 0.0 };
            prop_assert!(sampled(&envelope, &before, &nearly));
        }
    });
    accepted.assert_accepted(0.55);
    accepted.assert_refused(0.25);
    sampled_before.assert_accepted(0.35);
}

#[test]
fn joint_moves_keep_the_assembly_all_along() {
    let accepted = Tally::default();
    let from = prop::array::uniform2(-3.0..3.0_f64);
    let turn = prop::array::uniform2(-2.0..2.0_f64);
    let config = ProptestConfig::with_cases(2000);
    proptest!(config, |(envelope in arms(), from in from, turn in turn, assembly in side())| {
        let to = [from[0] + turn[0], from[1] + turn[1]];
        let geometry = envelope.workspace.tool.geometry();
        let kept = |margin: f64| (0..=SAMPLES).all(|i| {
            let share = f64::from(i) / f64::from(SAMPLES);
            geometry
                .forward(from[0] + turn[0] * share, from[1] + turn[1] * share, assembly)
                .is_ok_and(|pose| pose.sin32().abs() >= margin && pose.assembly() == assembly)
        });
        let allowed = envelope.workspace.limits.is_none_or(|limits| {
            let ranges = limits.ranges();
            (0..2).all(|i| [from[i], to[i]].iter().all(|q| ranges[i][0] <= *q && *q <= ranges[i][1]))
        });
        let outcome = envelope.check_joint_move(from, to, assembly, 0.5);
        accepted.count(outcome.is_ok());
        match outcome {
            Ok((limits, end)) => {
                prop_assert!(allowed && kept(MARGIN));
                let direct = geometry.forward(to[0], to[1], assembly).unwrap();
                prop_assert_eq!(end, direct);
                prop_assert!(limits.speed > 0.0 && limits.speed <= 0.5 * 100.0);
            }
            Err(refusal) => {
                prop_assert!(!(allowed && kept(SPARED.margin)), "{refusal:?}");
                prop_assert!((0.0..=1.0).contains(&refusal.fraction));
            }
        }
    });
    accepted.assert_accepted(0.15);
    accepted.assert_refused(0.6);
}

/// An arm of these lengths [m] with the tool at `offset` from C [m], and no other limits than the margin.
fn arm(lengths: [f64; 5], offset: V) -> Envelope<f64> {
    let mut envelope = envelope(0.0);
    envelope.workspace = Workspace {
        tool: Tool::new(Geometry::new(lengths).unwrap(), offset).unwrap(),
        mode: WorkingMode::new(Side::Right, Side::Left),
        limits: None,
        margin: MARGIN,
    };
    envelope
}

/// How far the ends of two links of lengths a, b are apart where the sine of their angle is 1.5 % above the margin [m].
fn barely_straight(a: f64, b: f64) -> f64 {
    let sine = 1.015 * MARGIN;
    (a * a + b * b + 2.0 * a * b * (1.0 - sine * sine).sqrt()).sqrt()
}

#[test]
fn a_long_path_along_the_margin_is_accepted_just_above_its_reserve() {
    for offset in [V::zeros(), V::new(-0.15, 0.02), V::new(-0.12, 0.12)] {
        let envelope = arm([0.2, 0.2, 0.25, 0.25, 0.1], offset);
        let radius = barely_straight(0.2, envelope.workspace.tool.reach());
        // About A: leg 1 turns as a whole.
        let [from, to] = [1.0, 1.8].map(|angle| V::unit(angle) * radius);
        let arc = PathSegment::arc(from, to, V::zeros(), Sense::CounterClockwise, 1e-9).unwrap();
        assert!(sampled(&envelope, &arc, &SPARED), "{offset}");
        assert!(envelope.check(&arc, 0.1).is_ok(), "{offset}");
    }
}

#[test]
fn a_long_joint_move_along_the_margin_is_accepted_just_above_its_reserve() {
    // Joints 1 and 4 turn links of equal lengths alike: B and D stay as far apart as A and E.
    let apart = barely_straight(0.2, 0.2);
    let envelope = arm([0.1, 0.2, 0.2, 0.1, apart], V::zeros());
    let moved = envelope.check_joint_move([0.3, 0.3], [2.8, 2.8], Side::Left, 0.5);
    assert!(moved.is_ok(), "{moved:?}");
}
