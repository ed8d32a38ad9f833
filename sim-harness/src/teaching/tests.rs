//! A simulated arm is taught by a scripted hand, and does the same again.

use super::{Record, ReplayError, TaughtPath, TaughtPathError, TeachError};
use crate::controller::Hand;
use crate::drive::{Drive, DriveError, Homing};
use crate::link::{Client, Loopback};
use crate::measured_pose::measured_pose;
use crate::simulation::SimulatedDrives;
use fivebar_files::job::{Action, Job};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::ActuatorCommand;
use fivebar_firmware::drives::BrushedDrives;
use fivebar_firmware::planner::{StreamError, StreamPhase, StreamProgress};
use fivebar_firmware::protocol::{CommandError, StreamState};
use fivebar_kinematics::five_bar::{Side, Tool, WorkingMode};
use nalgebra::Vector2;
use std::sync::{Arc, Mutex};

/// The script of 10 s: a curved figure of some centimetres.
const SCRIPT: &str = "1,0.02,0\n2,0.02,0.02\n3.5,-0.02,0.02\n4.5,-0.02,-0.01\n6,0.015,-0.015\n7,0,0.01\n8.5,-0.01,0\n10,0,0\n";

/// A simulated arm and what its tip truly did, tick by tick [m].
struct Bench {
    client: Client<Loopback<BrushedDrives>>,
    robot: Robot,
    tips: Arc<Mutex<Vec<Vector2<f64>>>>,
}

impl Bench {
    fn armed(hand: &Hand) -> Self {
        let robot = Robot::load("benchtop").unwrap();
        let scenario = Scenario::new("taught", robot.clone(), "taught", String::new());
        let mut arm = BrushedDrives::arm(&scenario).unwrap();
        let tips = Arc::new(Mutex::new(Vec::new()));
        let (mut hand, log) = (hand.clone(), tips.clone());
        let plant = move |command: &ActuatorCommand| {
            let (tip, velocity) = (arm.tool(), arm.model().tool_velocity(arm.state()));
            arm.set_tool_force(hand.force(arm.time(), tip, velocity));
            log.lock().unwrap().push(tip);
            arm.step(command, 1e-4);
            arm.sense()
        };
        let settings = robot.settings().unwrap();
        let line = Loopback::<BrushedDrives>::driving(&settings, Box::new(plant)).unwrap();
        let (mut client, _) = Client::open(line).unwrap();
        let mut drive = Drive::new(&mut client, &|| false);
        drive.home(Homing::IfUnknown).unwrap();
        drive.switch_on().unwrap();
        Self {
            client,
            robot,
            tips,
        }
    }

    fn teach(&mut self, hand: &Hand) -> (TaughtPath, Vec<Vector2<f64>>) {
        let before = self.tips.lock().unwrap().len();
        let mut record = Record::new(1e4);
        let mut each = |state: &StreamState| {
            hand.grip();
            record.keep(state) && record.time() < hand.time() + 0.3
        };
        let mut drive = Drive::new(&mut self.client, &|| false);
        drive.be_led(1e4, &mut each).unwrap();
        let tool = self.robot.tool_on_link().unwrap();
        let path = record.path("benchtop", &tool, Side::Left).unwrap();
        (path, self.tips.lock().unwrap()[before..].to_vec())
    }

    fn replay(&mut self, path: &TaughtPath, speed: f64) -> Result<Vec<Vector2<f64>>, ReplayError> {
        let mut drive = Drive::new(&mut self.client, &|| false);
        let planner = drive.planner(&self.robot.settings().unwrap()).unwrap();
        let (status, _) = self.client.status().unwrap();
        let moves = path.replay(speed, &planner, status.tool.unwrap(), status.angle)?;
        let mut drive = Drive::new(&mut self.client, &|| false);
        let before = self.tips.lock().unwrap().len();
        let done = drive.follow_armed(&moves, &[], &mut |_, _| (), &mut |_| Ok(true));
        done.unwrap();
        Ok(self.tips.lock().unwrap()[before..].to_vec())
    }
}

/// The greatest distance of a point of `from` from the nearest one of `to`, each every 2 ms.
fn farthest(from: &[Vector2<f64>], to: &[Vector2<f64>]) -> f64 {
    let to: Vec<_> = to.iter().step_by(5).collect();
    let nearest = |point: &Vector2<f64>| {
        let squares = to.iter().map(|it| (*it - point).norm_squared());
        squares.fold(f64::INFINITY, f64::min).sqrt()
    };
    from.iter().step_by(20).map(nearest).fold(0.0, f64::max)
}

#[test]
fn ten_seconds_that_a_hand_has_taught_are_done_again_within_a_tenth_of_a_millimetre() {
    let hand = Hand::parse(SCRIPT).unwrap();
    let mut bench = Bench::armed(&hand);
    let (path, taught) = bench.teach(&hand);
    assert!((9.5..10.5).contains(&path.time()), "{} s", path.time());
    assert!(path.length() > 0.19, "{} m", path.length());
    for speed in [1.0, 2.0, 0.5, 5.0] {
        // The way to the beginning is short: the arm is where the hand has left it.
        let done = bench.replay(&path, speed).unwrap();
        let off = farthest(&done, &taught).max(farthest(&taught, &done));
        assert!(off < 1e-4 && off > 1e-6, "{speed}: {off} m");
    }
}

/// 40 mm in 0.2 s: five times as fast needs more than the motors have.
#[test]
fn a_speed_that_the_arm_cannot_follow_is_refused_with_one_that_it_can() {
    let hand = Hand::parse("0.5,0,0\n").unwrap();
    let mut bench = Bench::armed(&hand);
    let (status, _) = bench.client.status().unwrap();
    let [x, y] = status.tool.unwrap().map(f64::from);
    let at = |k: u32| {
        let u = f64::from(k) / 20.0;
        let share = u * u * u * (10.0 + u * (6.0 * u - 15.0));
        [x + 0.02 * share, y + 0.035 * share]
    };
    let (path, _) = swing();
    let path = TaughtPath {
        tip_m: (0..=20).map(at).collect(),
        ..path
    };
    let refused = bench.replay(&path, 5.0);
    let Err(ReplayError::TooFast { possible, .. }) = refused else {
        panic!("{:?}", refused.map(|tips| tips.len()));
    };
    assert!((1.0..5.0).contains(&possible), "{possible}");
    let done = bench.replay(&path, possible).unwrap();
    let wanted: Vec<Vector2<f64>> = path.tip_m.iter().map(|&it| it.into()).collect();
    let end = done.last().unwrap() - wanted.last().unwrap();
    assert!(end.norm() < 2e-4, "{} m", end.norm());
    assert!(matches!(
        bench.replay(&path, 6.0),
        Err(ReplayError::Speed(_))
    ));
}

#[test]
fn an_arm_that_is_left_alone_has_taught_nothing() {
    let hand = Hand::parse("0.5,0,0\n").unwrap();
    let mut bench = Bench::armed(&hand);
    let mut record = Record::new(1e4);
    let mut drive = Drive::new(&mut bench.client, &|| false);
    drive
        .be_led(1e4, &mut |state| record.keep(state) && record.time() < 0.5)
        .unwrap();
    let (status, _) = bench.client.status().unwrap();
    let settings = bench.robot.settings().unwrap().check().unwrap();
    assert!(measured_pose(settings.tool(), &status).is_some());
    let tool = bench.robot.tool_on_link().unwrap();
    let path = record.path("benchtop", &tool, Side::Left);
    assert_eq!(path, Err(TeachError::Still));
}

fn state(tick: u32, angle: [f32; 2]) -> StreamState {
    StreamState {
        tick,
        progress: StreamProgress {
            id: 1,
            phase: StreamPhase::Follows,
            reason: None,
            last: None,
            late: 0,
            lost: 0,
            refused: 0,
            limited: 0,
        },
        buffered: 0,
        angle,
        velocity: [0.0; 2],
        torque: [0.0; 2],
    }
}

/// A swing of 2 s of the joints with the noise of coarse encoders.
fn swing() -> (TaughtPath, Tool<f64>) {
    let tool = Robot::load("benchtop").unwrap().tool_on_link().unwrap();
    let mut record = Record::new(1e4);
    for k in 0..=200_u32 {
        let turn = (f64::from(k) * std::f64::consts::PI / 100.0).cos();
        let angle = [2.2 + 0.1 * (1.0 - turn), 0.9].map(|it: f64| (it / 1e-4).round() * 1e-4);
        assert!(record.keep(&state(100 * k, angle.map(|it| it as f32))));
    }
    (record.path("arm \"1\"", &tool, Side::Left).unwrap(), tool)
}

#[test]
fn smoothing_takes_the_steps_of_the_encoders_out_and_keeps_the_path() {
    let (path, tool) = swing();
    let mut worst = 0.0_f64;
    let roughness = |points: &[[f64; 2]]| {
        let turns = points.windows(4).map(|p| {
            let third = |k: usize| p[3][k] - 3.0 * p[2][k] + 3.0 * p[1][k] - p[0][k];
            third(0).hypot(third(1))
        });
        turns.fold(0.0, f64::max)
    };
    for point in &path.tip_m {
        let pose = tool.inverse((*point).into(), WorkingMode::new(Side::Right, Side::Left));
        let theta4 = pose.unwrap().u4;
        worst = worst.max((theta4.y.atan2(theta4.x) - 0.9).abs());
    }
    assert!(worst < 2e-4, "{worst} rad");
    // A count moves the tip by 10 µm, and the third difference by eight times as much at most.
    assert!(roughness(&path.tip_m) < 1e-5, "{}", roughness(&path.tip_m));
}

#[test]
fn a_file_is_read_as_it_was_written_and_others_are_refused() {
    let (path, _) = swing();
    let again = TaughtPath::parse(&path.to_json()).unwrap();
    assert_eq!((&again.robot, again.knot_s), (&path.robot, path.knot_s));
    for (a, b) in again.tip_m.iter().zip(&path.tip_m) {
        assert!((a[0] - b[0]).abs() < 1e-7 && (a[1] - b[1]).abs() < 1e-7);
    }
    let text = path.to_json();
    for (from, to, says) in [
        ("\"taught_path\": 1", "\"taught_path\": 2", "is 2"),
        ("\"knot_s\": 0.01", "\"knot_s\": 1", "0.001 to 0.1"),
        ("\"knot_s\"", "\"knot\"", "fivebar teach"),
    ] {
        let error = TaughtPath::parse(&text.replace(from, to)).unwrap_err();
        assert!(error.to_string().contains(says), "{error}");
    }
    let short = TaughtPath {
        tip_m: vec![[0.0; 2]; 4],
        ..path
    };
    let error = TaughtPath::parse(&short.to_json()).unwrap_err();
    assert!(matches!(error, TaughtPathError::Count(4)));
}

#[test]
fn its_g_code_is_a_drawing_of_the_same_length() {
    let (path, _) = swing();
    let (name, text) = ("a.gcode", path.to_gcode());
    let robot = Robot::load("benchtop").unwrap();
    let scenario = Scenario::new("taught", robot, name, text);
    let job: Job = scenario.job().unwrap();
    assert!(job.warnings.is_empty(), "{:?}", job.warnings);
    let mut from = None;
    let drawn = job.steps.iter().map(|step| match step.action {
        Action::Line { to, .. } => {
            let from = from.replace(to).filter(|_| step.draws());
            from.map_or(0.0, |[x, y]: [f64; 2]| (to[0] - x).hypot(to[1] - y))
        }
        _ => 0.0,
    });
    let (drawn, taught) = (drawn.sum::<f64>(), path.length());
    assert!(
        (drawn / taught - 1.0).abs() < 1e-2,
        "{name}: {drawn} {taught}"
    );
}

#[test]
fn steppers_are_refused_by_their_name() {
    let robot = Robot::load("benchtop_stepper").unwrap();
    let clock = crate::clock::Clock::simulated();
    let source = crate::controller::ControllerSource::Simulated;
    let (mut session, _) = crate::controller::open(&robot, source, &clock).unwrap();
    let mut drive = Drive::new(&mut session, &|| false);
    drive.home(Homing::IfUnknown).unwrap();
    drive.switch_on().unwrap();
    let refused = drive.be_led(1e4, &mut |_| true).unwrap_err();
    let DriveError::Refused { error, .. } = &refused else {
        panic!("{refused}");
    };
    assert_eq!(*error, CommandError::Stream(StreamError::NoTorque));
    assert!(refused.to_string().contains("steppers"), "{refused}");
}
