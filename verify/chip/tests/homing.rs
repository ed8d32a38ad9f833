//! Homing by other means than switches alone on the production image: index pulses, hard stops and given
//! angles. The board has no absolute encoders.

mod bench;

use bench::{Bench, Driven, arm_in};
use fivebar_chip::time::MILLISECOND;
use fivebar_chip::{Arm, Options, Pin, SharedArm};
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_firmware::controller::RequestError;
use fivebar_firmware::protocol::CommandError;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{Request, Status};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{FaultKind, Mismatch, Plant};
use fivebar_sim::drive::Drive;

/// The benchtop arm with other lines in its file, turned by so much from home [rad].
fn bench(change: impl FnOnce(String) -> String, turned: [f64; 2]) -> (Robot, Driven) {
    let benchtop = BuiltIn::find("benchtop").expect("a built-in robot").text;
    let robot = Robot::parse("arm.toml", &change(benchtop.to_owned())).expect("a robot");
    let pose = robot.pose_near_home(turned).expect("a reachable pose");
    let arm = arm_in(&robot, &pose, MILLISECOND);
    let settings = robot.settings().expect("masses");
    let driven = Bench::of(arm, Options::default(), Vec::new()).ready_as(&settings);
    (robot, driven)
}

/// The benchtop arm with hard stops 0.02 rad behind its limits.
fn with_stops(text: String) -> String {
    let near = "home = [3.57, -0.43]";
    let text = text.replace("home = [2.7925268, 0.3490659]", near);
    assert!(text.contains(near));
    text + "\n[homing]\nmethod = \"hard-stop\"\ncurrent = 0.8\n"
}

/// The benchtop arm with index pulses, and switches that close by this share of the encoders' turn behind them.
fn with_index(share: f64) -> impl FnOnce(String) -> String {
    let behind = share * std::f64::consts::FRAC_PI_4;
    let switch = [2.792_526_8 + behind, 0.349_065_9 - behind];
    move |text| {
        text + &format!("\n[homing]\nmethod = \"index\"\nspeed = 0.9\nswitch = {switch:?}\n")
    }
}

/// Homes until the end, the host giving signs of life.
fn home(driven: &mut Driven) -> Status {
    driven.request(Request::Home).expect("homing begins");
    for _ in 0..600 {
        driven.run(20 * MILLISECOND);
        let status = driven.status();
        if status.state != State::Homing {
            return status;
        }
    }
    panic!("still homing");
}

/// Whether the arm is homed, and how far the angles are from the true ones at most [rad].
fn found(driven: &Driven, status: &Status) -> (bool, f64) {
    let arm = driven.arm.get();
    let off =
        Joint::ALL.map(|joint| (f64::from(status.angle[joint]) - arm.plant().angle(joint)).abs());
    (status.homed, off[0].max(off[1]))
}

#[test]
fn both_hard_stops_are_found_and_left_and_the_arm_can_be_armed() {
    let (robot, mut driven) = bench(with_stops, [-0.06, 0.04]);
    let status = home(&mut driven);
    assert_eq!((status.state, status.fault), (State::Stopped, None));
    let (homed, off) = found(&driven, &status);
    assert!(homed && off < 1e-3, "{off} rad");
    let limits = robot.settings().expect("masses").axes;
    for (angle, axis) in status.angle.into_iter().zip(limits) {
        let [low, high] = axis.angle_limits;
        assert!(low < angle && angle < high, "{angle} rad");
    }
    driven.request(Request::Arm).expect("armed");
    driven.run(5 * MILLISECOND);
    assert_eq!(driven.status().state, State::Armed);
}

#[test]
fn a_joint_whose_motor_has_no_current_is_not_homed() {
    let (_, mut driven) = bench(with_stops, [-0.3, 0.3]);
    driven.request(Request::Home).expect("homing begins");
    driven.run(60 * MILLISECOND);
    let kind = FaultKind::MotorDisconnected {
        joint: Joint::Joint4,
    };
    driven.arm.get().inject(kind);
    for _ in 0..50 {
        driven.run(20 * MILLISECOND);
        driven.status();
    }
    let status = driven.status();
    assert_eq!(status.fault, Some(Fault::CurrentSensor));
    assert!(!status.homed && driven.is_off());
}

#[test]
fn the_angles_of_index_pulses_are_right_to_a_count_wherever_the_switches_close() {
    for share in [0.08, 0.13] {
        let (_, mut driven) = bench(with_index(share), [-0.06, 0.04]);
        let status = home(&mut driven);
        assert_eq!((status.state, status.fault), (State::Stopped, None));
        // The joints come to rest.
        driven.run(100 * MILLISECOND);
        let status = driven.status();
        let (homed, off) = found(&driven, &status);
        // A count is 48 µrad. The angle is a filtered one of whole counts.
        assert!(homed && off < 48e-6, "{off} rad with {share} turns");
    }
}

#[test]
fn an_index_output_without_its_wire() {
    let (_, mut driven) = bench(with_index(0.08), [-0.02, 0.02]);
    for pin in [8, 9] {
        driven.arm.get().break_wire(Pin(2, pin));
    }
    let status = home(&mut driven);
    // The chip pulls them up.
    let sample = driven.client.sample().expect("a line");
    assert_eq!(sample.expect("inputs").index, [true; 2]);
    assert_eq!(status.fault, Some(Fault::IndexNotFound));
    assert!(!status.homed && driven.is_off());
}

#[test]
fn a_switch_that_closes_near_an_index_pulse() {
    let benchtop = BuiltIn::find("benchtop").expect("a built-in robot").text;
    let text = with_index(0.08)(benchtop.to_owned());
    let robot = Robot::parse("arm.toml", &text).expect("a robot");
    let settings = robot.settings().expect("masses");
    // The switch of joint 4 has moved, to 0.025 turns behind the pulse.
    let mut parameters = robot.plant_parameters().expect("masses");
    let [switch1, _] = parameters.switches.expect("switches");
    parameters.switches = Some([switch1, robot.home[1] - 0.02]);
    let pose = robot.pose_near_home([-0.02, 0.02]).expect("a pose");
    let plant = Plant::new(&parameters, &Mismatch::default(), &pose, 7);
    let arm = SharedArm::new(Arm::new(plant, MILLISECOND));
    let mut driven = Bench::of(arm, Options::default(), Vec::new()).ready_as(&settings);
    let status = home(&mut driven);
    assert_eq!(status.fault, Some(Fault::IndexAmbiguous));
    assert!(!status.homed && driven.is_off());
}

#[test]
fn absolute_encoders_are_refused_by_a_board_whose_counters_start_at_0() {
    let counts = "encoder_counts = 16384";
    let text = BuiltIn::find("benchtop").expect("a built-in robot").text;
    let text = text.replace(counts, &format!("{counts}\nencoder_side = \"joint\""));
    let text = text + "\n[homing]\nmethod = \"absolute\"\n";
    let robot = Robot::parse("arm.toml", &text).expect("a robot");
    let settings = robot.settings().expect("masses");
    let mut driven = Bench::with(Options::default(), Vec::new(), 0).connect();
    let refused = driven.client.write_settings(&settings).expect("a line");
    assert_eq!(refused, Err(CommandError::Settings));
    let mut drive = Drive::new(&mut driven.client, &|| false);
    let refused = drive.store_settings(&settings).expect_err("no such board");
    let words = "home_reference.method must not be absolute";
    assert!(refused.to_string().contains(words), "{refused}");
}

#[test]
fn given_angles_are_those_of_home_and_not_those_of_an_arm_that_moves() {
    let given = |text: String| text + "\n[homing]\nmethod = \"given\"\n";
    let (robot, mut driven) = bench(given, [0.0; 2]);
    let hand = |driven: &Driven, to: [f64; 2]| {
        let home = robot.home_pose().expect("a pose");
        let mut arm = driven.arm.get();
        arm.turn_by_hand(to, robot.geometry, home.assembly());
    };
    let [theta1, theta4] = robot.home;
    hand(&driven, [theta1 - 0.3, theta4]);
    driven.run(100 * MILLISECOND);
    let refused = Err(CommandError::Request(RequestError::Moving));
    assert_eq!(driven.request(Request::Home), refused);
    hand(&driven, robot.home);
    driven.run(400 * MILLISECOND);
    let status = home(&mut driven);
    assert_eq!((status.state, status.fault), (State::Stopped, None));
    let (homed, off) = found(&driven, &status);
    assert!(homed && off < 1e-3, "{off} rad");
}

/// The benchtop arm upright, with holding brakes.
fn upright(text: String) -> String {
    text.replace("gravity = [0.0, 0.0]", "gravity = [0.0, -9.81]")
        .replace("encoder_counts = ", "brake_torque = 0.5\nencoder_counts = ")
}

#[test]
fn brakes_that_do_not_hold_an_upright_arm_after_homing() {
    let (_, mut driven) = bench(upright, [-0.06, 0.04]);
    driven.request(Request::Home).expect("homing begins");
    for _ in 0..10 {
        driven.run(20 * MILLISECOND);
        driven.status();
    }
    for joint in Joint::ALL {
        let brake = FaultKind::BrakeFails { joint };
        driven.arm.get().inject(brake);
    }
    let mut status = driven.status();
    for _ in 0..600 {
        driven.run(20 * MILLISECOND);
        status = driven.status();
        if status.state != State::Homing {
            break;
        }
    }
    assert_eq!(status.fault, Some(Fault::BrakeFailed));
    let before = driven.arm.get().plant().tool();
    driven.run(300 * MILLISECOND);
    let fallen = (driven.arm.get().plant().tool() - before).norm();
    assert!(fallen < 3e-3, "it fell by {fallen} m");
    assert!(!driven.is_off(), "the motors hold it");
}
