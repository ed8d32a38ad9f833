//! Changes of the working mode, each done or refused with the reason that holds.

use fivebar_files::robot::Robot;
use fivebar_files::scenario::{ModeChangeError, Scenario, change_of_mode};
use fivebar_firmware::Planner;
use fivebar_kinematics::five_bar::{Pose, Side, Tool, WorkingMode, Workspace, WorkspaceViolation};
use fivebar_sim::simulation::Simulate;
use nalgebra::Vector2;

const SIDES: [Side; 2] = [Side::Left, Side::Right];

fn modes() -> impl Iterator<Item = WorkingMode> {
    let of = |elbow1| SIDES.map(|elbow4| WorkingMode::new(elbow1, elbow4));
    SIDES.into_iter().flat_map(of)
}

/// The benchtop arm, in double precision and by its own limits.
struct Bench {
    tool: Tool<f64>,
    assembly: Side,
    ranges: [[f64; 2]; 2],
    margin: f64,
}

impl Bench {
    fn pose(&self, [theta1, theta4]: [f64; 2]) -> Option<Pose<f64>> {
        self.tool
            .geometry()
            .forward(theta1, theta4, self.assembly)
            .ok()
    }

    /// Whether the arm may pass these angles, with some slack [rad, sine].
    fn allows(&self, at: [f64; 2], slack: f64) -> bool {
        let within = |i: usize| {
            let [low, high] = self.ranges[i];
            low - slack <= at[i] && at[i] <= high + slack
        };
        let pose = self.pose(at);
        within(0) && within(1) && pose.is_some_and(|pose| pose.sin32().abs() >= self.margin - slack)
    }

    fn straight_is_allowed(&self, from: [f64; 2], to: [f64; 2]) -> bool {
        (0..=500).all(|k| {
            let t = f64::from(k) / 500.0;
            self.allows([0, 1].map(|i| from[i] + t * (to[i] - from[i])), 1e-5)
        })
    }
}

/// The arm's angles with the tool at a point, if the arm may be there.
fn angles(space: &Workspace<f64>, point: Vector2<f64>) -> Result<[f64; 2], WorkspaceViolation> {
    let pose = space.check(point)?;
    let [theta1, _, _, theta4] = pose.angles();
    Ok(space.limits.unwrap().angles_within(theta1, theta4).unwrap())
}

/// What became of the changes: done, those of them on a bent path, and refused by reason.
#[derive(Debug, Default)]
struct Outcome {
    done: [[usize; 4]; 4],
    bent: usize,
    other_assembly: usize,
    place: usize,
}

/// All changes from points of a grid, for a margin of the singularities. For every pose that the arm
/// may have there is a path.
fn changes(margin: f64) -> Outcome {
    let robot = Robot::load("benchtop").unwrap();
    let mut settings = robot.settings().unwrap();
    settings.motion.singularity_margin = margin as f32;
    let settings = settings.check().unwrap();
    let space = Workspace {
        margin,
        ..robot.workspace(robot.working_mode()).unwrap()
    };
    let bench = Bench {
        tool: space.tool,
        assembly: Planner::new(&settings).assembly(),
        ranges: robot.limits.angle,
        margin,
    };
    let mut points = vec![Vector2::new(0.04, 0.2558)];
    for (x, y) in (-6..=10).flat_map(|x| (-5..=13).map(move |y| (x, y))) {
        points.push(Vector2::new(0.02 * f64::from(x), 0.02 * f64::from(y)));
    }
    let mut outcome = Outcome::default();
    for point in points {
        for (index, mode) in modes().enumerate() {
            let here = Workspace { mode, ..space };
            let Ok(from) = angles(&here, point) else {
                continue;
            };
            if bench.tool.inverse(point, mode).unwrap().assembly() != bench.assembly {
                continue;
            }
            let before = bench.pose(from).unwrap();
            assert!((bench.tool.point(&before) - point).norm() < 1e-9);
            let planner = Planner::new(&settings).in_mode(mode);
            for (other, wanted) in modes().enumerate().filter(|&(other, _)| other != index) {
                let there = angles(
                    &Workspace {
                        mode: wanted,
                        ..space
                    },
                    point,
                );
                let inverse = bench.tool.inverse(point, wanted);
                match change_of_mode(&planner, from.map(|angle| angle as f32), wanted) {
                    Ok(corners) => {
                        let mut at = from;
                        for corner in corners.iter().map(|corner| corner.map(f64::from)) {
                            assert!(bench.straight_is_allowed(at, corner), "{at:?} {corner:?}");
                            at = corner;
                        }
                        let end = bench.pose(at).unwrap();
                        assert_eq!(bench.tool.working_mode(&end), wanted);
                        assert!((bench.tool.point(&end) - point).norm() < 1e-6);
                        outcome.done[index][other] += 1;
                        outcome.bent += usize::from(corners.len() > 1);
                    }
                    Err(ModeChangeError::OtherAssembly { .. }) => {
                        let inverse = inverse.unwrap();
                        // In line, links 2 and 3 are in both assembly modes.
                        let in_line = inverse.sin32().abs() < 1e-5;
                        assert!(in_line || inverse.assembly() != bench.assembly);
                        outcome.other_assembly += 1;
                    }
                    Err(ModeChangeError::Place { reason, .. }) => {
                        assert_eq!(there.unwrap_err(), reason, "{point} {wanted:?}");
                        outcome.place += 1;
                    }
                    Err(other) => panic!("{point} {wanted:?}: {other}"),
                }
            }
        }
    }
    outcome
}

#[test]
fn each_change_of_the_benchtop_arm_is_done_or_refused_with_the_reason_that_holds() {
    let usual = changes(0.15);
    for (from, to) in (0..4).flat_map(|from| (0..4).map(move |to| (from, to))) {
        assert!(
            from == to || usual.done[from][to] > 0,
            "{from} {to}: {usual:?}"
        );
    }
    let all: usize = usual.done.iter().flatten().sum();
    assert!(
        all > 100 && usual.other_assembly > 100 && usual.place > 100,
        "{usual:?}"
    );
    let narrow = changes(0.3);
    assert!(narrow.bent > 5, "{narrow:?}");
}

#[test]
fn a_job_makes_all_twelve_changes_and_draws_in_each_mode() {
    // At this point all four modes are in reach and in the arm's assembly mode.
    let point = [0.04, 0.2558];
    let sides = [["-1", "1"], ["1", "1"], ["-1", "-1"], ["1", "-1"]];
    let tour = [0, 1, 0, 2, 0, 3, 1, 2, 1, 3, 2, 3, 0];
    let mut text = String::from("G21 G90 F600\nG0 X0 Y0\n");
    for mode in &tour[1..] {
        let [elbow1, elbow4] = sides[*mode];
        text += &format!("M780 I{elbow1} J{elbow4}\nG1 X0.3\nG1 X0\n");
    }
    let robot = Robot::load("benchtop").unwrap();
    let mut scenario = Scenario::new("tour", robot, "tour", text);
    scenario.origin = Some(point);
    let job = scenario.job().unwrap();
    let (summary, record) = scenario.simulate(&job, &mut |_| ()).unwrap();
    assert_eq!(summary.faults, Vec::<String>::new());
    assert_eq!(summary.saturated_ticks, 0);
    let tool = scenario
        .robot
        .workspace(scenario.robot.working_mode())
        .unwrap()
        .tool;
    for (step, mode) in tour[1..].iter().enumerate() {
        let line = 3 + 3 * step as u32;
        // The line drawn behind the change, in its mode.
        let drawn = record
            .trace
            .samples()
            .iter()
            .filter(|sample| sample.line == line + 1);
        let mut seen = 0;
        for sample in drawn {
            let [theta1, theta4] = sample.angle;
            let pose = tool.geometry().forward(theta1, theta4, Side::Left).unwrap();
            let side = |text: &str| if text == "1" { Side::Left } else { Side::Right };
            let [elbow1, elbow4] = sides[*mode].map(side);
            assert_eq!(
                tool.working_mode(&pose),
                WorkingMode::new(elbow1, elbow4),
                "line {line}"
            );
            let [x, y] = sample.tool;
            assert!(
                (x - point[0]).abs() < 4e-4 && (y - point[1]).abs() < 1e-4,
                "{x} {y}"
            );
            seen += 1;
        }
        assert!(seen > 3, "line {line}");
    }
}
