//! What is accepted and what is refused, against dense sampling in both directions.

use crate::common::{V, envelope, run, tool};
use fivebar_kinematics::five_bar::{
    Geometry, Joint, JointLimits, Outside, Pose, PoseError, Side, Tool, WorkingMode, Workspace,
};
use fivebar_kinematics::trajectory::{Envelope, Obstacle, Segment, Sense};
use proptest::prelude::*;

const MARGIN: f64 = 0.08;
/// What the walk keeps to spare, as its module states.
const SPARE_SHARE: f64 = 0.01;
const SPARE_ANGLE: f64 = 0.001;
const SAMPLES: u32 = 2000;

/// How much of the margin and of the joints' limits must be left.
struct Keep {
    margin: f64,
    angle: f64,
}

const BARELY: Keep = Keep {
    margin: MARGIN,
    angle: 0.0,
};
// What the walk spares, and rounding.
const SPARED: Keep = Keep {
    margin: MARGIN * (1.0 + SPARE_SHARE) + 1e-9,
    angle: SPARE_ANGLE + 1e-9,
};

// And a path of ten nanometres.
const CLEARLY: Keep = Keep {
    margin: 1.1 * MARGIN,
    angle: 2.0 * SPARE_ANGLE,
};

/// |sin| at leg 1 as the tool sees it, at leg 4 and at C.
fn sines(tool: &Tool<f64>, pose: &Pose<f64>) -> [f64; 3] {
    let bt = tool.point(pose) - pose.b;
    [pose.u1.cross(bt) / bt.norm(), pose.sin34(), pose.sin32()]
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
                .admit(pose.u1.angle(), pose.u4.angle())
                .is_ok()
    });
    clear && free
}

/// Dense sampling: is every sample within, and the assembly the same throughout?
fn sampled(envelope: &Envelope<f64>, segment: &Segment<f64>, keep: &Keep) -> bool {
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
                    V::zero()
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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn a_place_is_admitted_as_a_path_through_it_is_with_any_tool(
        envelope in arms(),
        points in prop::collection::vec(prop::array::uniform2(-0.6..0.6_f64), 64),
    ) {
        let workspace = &envelope.workspace;
        for [x, y] in points {
            let point = V::new(x, y);
            let Ok(pose) = workspace.tool.inverse(point, workspace.mode) else {
                prop_assert!(matches!(workspace.admit(point), Err(Outside::Pose(_))));
                continue;
            };
            let admitted = workspace.admit(point);
            prop_assert_eq!(admitted.is_ok(), within(workspace, &pose, &BARELY));
            // As short as a path can be, and far shorter than what is spared.
            let speck = Segment::line(point, point + V::new(1e-8, 0.0)).unwrap();
            let path = envelope.admit(&speck, 0.1);
            prop_assert!(path.is_err() || admitted.is_ok());
            prop_assert!(path.is_ok() || !within(workspace, &pose, &CLEARLY));
        }
    }
}

/// A place where the arm may be, if there is one near one of a few guesses.
fn start(envelope: &Envelope<f64>, guesses: &[[f64; 2]]) -> Option<V> {
    let workspace = &envelope.workspace;
    guesses.iter().map(|[x, y]| V::new(*x, *y)).find(|&point| {
        workspace
            .tool
            .inverse(point, workspace.mode)
            .is_ok_and(|pose| within(workspace, &pose, &SPARED))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn nothing_bad_is_accepted_and_nothing_good_is_refused(
        envelope in arms(),
        guesses in prop::collection::vec(prop::array::uniform2(-0.6..0.6_f64), 24),
        direction in -3.0..3.0_f64,
        size in -3.0..-0.3_f64,
        bulge in prop::option::of(-2.0..2.0_f64),
        clockwise in any::<bool>(),
    ) {
        let Some(from) = start(&envelope, &guesses) else {
            return Err(TestCaseError::reject("no place to start from"));
        };
        let to = from + V::unit(direction) * 10_f64.powf(size);
        let segment = match bulge {
            None => Segment::line(from, to),
            Some(bulge) => {
                let chord = to - from;
                let sense = if clockwise { Sense::Clockwise } else { Sense::CounterClockwise };
                Segment::arc(from, to, from + chord * 0.5 + chord.perp() * bulge, sense, 1e-9)
            }
        }
        .unwrap();
        match envelope.admit(&segment, 0.1) {
            Ok(_) => prop_assert!(sampled(&envelope, &segment, &BARELY)),
            Err(refusal) => {
                let place = segment.at(refusal.fraction * segment.length()).position;
                prop_assert!((place - refusal.point).norm() < 1e-9);
                // The place itself is within the spare, and all before it is in order.
                let workspace = &envelope.workspace;
                let pose = workspace.tool.inverse(refusal.point, workspace.mode);
                prop_assert!(pose.is_err() || !within(workspace, &pose.unwrap(), &SPARED));
                if refusal.fraction > 0.0 {
                    let before = Segment::line(from, refusal.point);
                    if let (None, Ok(before)) = (bulge, before) {
                        let nearly = Keep { margin: MARGIN * 0.999, angle: 0.0 };
prop_assert!(sampled(&envelope, &before, &nearly));
                    }
                }
            }
        }
    }

    #[test]
    fn joint_moves_keep_the_assembly_all_along(
        envelope in arms(),
        from in prop::array::uniform2(-3.0..3.0_f64),
        turn in prop::array::uniform2(-2.0..2.0_f64),
        left in any::<bool>(),
    ) {
        let assembly = if left { Side::Left } else { Side::Right };
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
        match envelope.admit_joint_move(from, to, assembly, 0.5) {
            Ok((caps, end)) => {
                prop_assert!(allowed && kept(MARGIN));
                let direct = geometry.forward(to[0], to[1], assembly).unwrap();
                prop_assert_eq!(end, direct);
                prop_assert!(caps.speed > 0.0 && caps.speed <= 0.5 * 100.0);
            }
            Err(refusal) => {
                prop_assert!(!(allowed && kept(SPARED.margin)), "{refusal:?}");
                prop_assert!((0.0..=1.0).contains(&refusal.fraction));
            }
        }
    }
}

#[test]
fn refusals_name_the_obstacle_and_the_place() {
    let mut envelope = envelope::<f64>(0.0);
    let from = V::new(0.1375, 0.3);
    let refusal = |envelope: &Envelope<f64>, to: V| {
        let line = Segment::line(from, to).unwrap();
        envelope.admit(&line, 0.1).unwrap_err()
    };
    // Straight up: leg 1 straightens where |AC| comes to the margin's ring, and the
    // margin's 1 % to spare before that.
    let up = refusal(&envelope, V::new(0.1375, 0.6));
    let margin: f64 = 0.05 * 1.01;
    let ring = 0.23 * (2.0 + 2.0 * (1.0 - margin * margin).sqrt()).sqrt();
    let height = (ring * ring - 0.1375 * 0.1375).sqrt();
    assert!((up.point.y - height).abs() < 2e-5, "{up:?}");
    assert!(matches!(up.obstacle, Obstacle::Outside(Outside::Margin(_))));
    // Straight down: elbows out, C comes into line with B and D.
    let down = refusal(&envelope, V::new(0.1375, 0.05));
    assert!(
        (down.point.y - 0.21057956).abs() < 0.02 && down.point.y > 0.21057956,
        "{down:?}"
    );
    // A joint limit on the way, though both ends are within it.
    let dip = Segment::arc(
        from,
        from + V::new(0.0, 1e-3),
        from + V::new(-0.03, 5e-4),
        Sense::Clockwise,
        1e-6,
    )
    .unwrap();
    assert!(envelope.admit(&dip, 0.1).is_ok());
    let theta1 = |point| {
        let pose = envelope
            .workspace
            .tool
            .inverse(point, envelope.workspace.mode);
        pose.unwrap().u1.angle()
    };
    let greatest = theta1(from).max(theta1(dip.end())) + 0.05;
    envelope.workspace.limits = Some(JointLimits::new([0.0, greatest], [-1.0, 3.0]).unwrap());
    let limited = envelope.admit(&dip, 0.1).unwrap_err();
    assert_eq!(
        limited.obstacle,
        Obstacle::Outside(Outside::Joint(Joint::Joint1))
    );
    assert!(limited.fraction > 0.01 && limited.fraction < 0.5);
}

#[test]
fn what_is_not_a_number_is_refused() {
    let envelope = envelope::<f64>(0.0);
    let line = Segment::line(V::new(0.1, 0.3), V::new(0.15, 0.3)).unwrap();
    for feed in [f64::NAN, 0.0, -0.1] {
        assert_eq!(
            envelope.admit(&line, feed).unwrap_err().obstacle,
            Obstacle::Limits
        );
    }
    let moved = envelope.admit_joint_move([f64::NAN, 1.0], [1.0, 1.0], Side::Left, 0.5);
    assert_eq!(
        moved.unwrap_err().obstacle,
        Obstacle::Outside(Outside::Pose(PoseError::NotFinite))
    );
    assert!(Segment::line(V::new(0.1, f64::NAN), V::new(0.1, 0.3)).is_err());
}

/// The peers drop a bad stretch in mid-path, or look at its ends only. Here a path is
/// followed whole or refused whole.
#[test]
fn no_segment_is_dropped_or_cut() {
    let mut runner = proptest::test_runner::TestRunner::new(ProptestConfig::with_cases(3000));
    let mut counts = [0_u32; 2];
    let counted = std::cell::RefCell::new(&mut counts);
    let ends = (
        prop::array::uniform2(-0.2..0.45_f64),
        prop::array::uniform2(-0.2..0.45_f64),
        prop::option::of(-2.0..2.0_f64),
    );
    runner
        .run(&ends, |(from, to, bulge)| {
            let envelope = envelope::<f64>(1e-4);
            let (from, to) = (V::new(from[0], from[1]), V::new(to[0], to[1]));
            let chord = to - from;
            let segment = match bulge {
                None => Segment::line(from, to),
                Some(bulge) => {
                    let centre = from + chord * 0.5 + chord.perp() * bulge;
                    Segment::arc(from, to, centre, Sense::Clockwise, 1e-9)
                }
            }
            .unwrap();
            if envelope.admit(&segment, 0.2).is_err() {
                counted.borrow_mut()[1] += 1;
                return Ok(());
            }
            counted.borrow_mut()[0] += 1;
            let mut covered = 0.0;
            let mut last = from;
            for piece in run(&[segment], 0.2, &envelope) {
                for step in 0..=16 {
                    let here = tool(&piece, piece.duration() * f64::from(step) / 16.0).0;
                    prop_assert!(crate::common::distance_to(&segment, here) < 1e-9);
                    prop_assert!(envelope.workspace.admit(here).is_ok());
                    covered += (here - last).norm();
                    last = here;
                }
            }
            prop_assert!((last - to).norm() < 1e-9);
            // Chords of an arc are a little shorter than the arc.
            prop_assert!((covered / segment.length() - 1.0).abs() < 0.02);
            Ok(())
        })
        .unwrap();
    assert!(counts[0] > 200 && counts[1] > 200, "{counts:?}");
}
