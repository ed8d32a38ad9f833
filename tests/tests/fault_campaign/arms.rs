//! The arms of the campaign and what their hosts have prepared: jobs, and a crossing.

use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::crossing_move;
use fivebar_firmware::settings::{CheckedSettings, HomingMethod};
use fivebar_firmware::{Move, MoveKind, Planner};
use fivebar_kinematics::five_bar::{Pose, WorkingMode};
use fivebar_plant::Parameters;
use fivebar_report::study::crossing::task;
use fivebar_sim::time_optimal::JobPlanner;
use nalgebra::Vector2;

/// The share of the torque limits that time-optimal plans use: the motors stand the job for ever.
const TORQUE_SHARE: f64 = 0.33;
/// Where the crossing of the arm with short couplers begins and ends [m], and its time [s].
const CROSSING: [[f64; 2]; 2] = [[0.06, 0.115], [0.03, 0.012]];
const CROSSING_TIME: f64 = 0.3;

/// An arm with its jobs, which begin and end where it starts.
pub(crate) struct Arm {
    pub(crate) robot: Robot,
    pub(crate) settings: CheckedSettings,
    pub(crate) parameters: Parameters,
    /// Where it starts, except for homing.
    pub(crate) start: Pose<f64>,
    /// A square, at a tenth of the greatest speed, at that speed, and time-optimal.
    pub(crate) slow: Vec<Move>,
    pub(crate) fast: Vec<Move>,
    pub(crate) timed: Vec<Move>,
    pub(crate) crossing: Option<MoveKind>,
    pub(crate) has_brakes: bool,
    pub(crate) has_belts: bool,
    pub(crate) has_index: bool,
}

/// The five arms.
pub(crate) fn all() -> Vec<Arm> {
    let short_couplers = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../host/files/robots/short_couplers.toml"
    );
    let built_in = ["benchtop", "benchtop_belt", "usp_2dof", short_couplers];
    let robots = built_in.map(|name| Robot::load(name).expect("a robot"));
    let mut arms: Vec<_> = robots.into_iter().map(arm).collect();
    arms.push(arm(upright()));
    arms
}

/// The benchtop arm, upright with holding brakes, homed by index pulses.
fn upright() -> Robot {
    let text = BuiltIn::find("benchtop").expect("it is built in").text;
    let text = text
        .replace("name = \"benchtop\"", "name = \"upright\"")
        .replace("gravity = [0.0, 0.0]", "gravity = [0.0, -9.81]")
        .replace(
            "encoder_counts = 16384",
            "encoder_counts = 16384\nbrake_torque = 0.5",
        );
    Robot::parse("upright.toml", &(text + "\n[homing]\nmethod = \"index\"\n")).expect("a robot")
}

fn arm(robot: Robot) -> Arm {
    let crossing = robot.crossing.allowed.then(|| {
        let task = task(&robot, CROSSING, CROSSING_TIME).expect("crossings are allowed");
        let plan = task.plan().expect("a plan");
        crossing_move(&task, &plan)
    });
    let settings = robot.settings().expect("it has masses");
    let settings = settings.check().expect("valid settings");
    let mode = robot.working_mode();
    let point = match crossing {
        Some(_) => CROSSING[0],
        None => robot.best_point().expect("a workspace"),
    };
    let start = pose(&robot, point, mode);
    let parameters = robot.plant_parameters().expect("it has masses");
    let from = point.map(|metres| metres as f32);
    let speed = settings.motion.max_speed;
    let [slow, fast] = [0.1, 1.0].map(|share| square(from, share * speed));
    let mut planner = Planner::new(&settings)
        .in_mode(mode)
        .in_assembly(start.assembly());
    let timed = JobPlanner::new(&robot, TORQUE_SHARE)
        .and_then(|jobs| jobs.moves(from, &fast, &mut planner))
        .expect("a plan");
    Arm {
        start,
        slow,
        fast,
        timed,
        crossing,
        has_brakes: parameters.brake_torque != [0.0; 2],
        has_belts: parameters
            .transmissions
            .iter()
            .all(|t| t.stiffness.is_some()),
        has_index: settings.home_reference.method == HomingMethod::Index,
        settings,
        parameters,
        robot,
    }
}

/// The pose with the tool at a point [m].
fn pose(robot: &Robot, point: [f64; 2], mode: WorkingMode) -> Pose<f64> {
    let workspace = robot.workspace(mode).expect("a workspace");
    workspace.check(Vector2::from(point)).expect("a pose")
}

/// A square of 16 mm beside `from` [m], at `feed` [m/s].
fn square([x, y]: [f32; 2], feed: f32) -> Vec<Move> {
    const SIDE: f32 = 0.016;
    let corners = [[x - SIDE, y], [x - SIDE, y - SIDE], [x, y - SIDE], [x, y]];
    corners
        .map(|to| Move {
            tag: 1,
            tool: 0,
            kind: MoveKind::Line { to, feed },
        })
        .into()
}
