//! A job on the image for steppers, with its motors' simulated windings and rotors on the pins.

mod bench;

use fivebar_chip::time::{MICROSECOND, MILLISECOND};
use fivebar_chip::{Chip, DriveKind, HostLine, Image, Options, SharedStepperArm, StepperArm};
use fivebar_files::job::Job;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{Mismatch, StepperPlant};
use fivebar_sim::drive::{Drive, Homing};
use fivebar_sim::link::Client;
use std::sync::Arc;
use std::time::Duration;

const DRAWING: &str = "G21 G90 F1800\nG1 X10 Y0\nG3 X10 Y10 I0 J5\nG1 X-10 Y-5\nG1 X0 Y0\n";

/// 0.03 rad before its home switches.
fn arm(robot: &Robot) -> SharedStepperArm {
    let axes = robot.settings().expect("settings").axes;
    let before = axes.map(|axis| if axis.home_forward { -0.03 } else { 0.03 });
    let pose = robot.pose_near_home(before).expect("a reachable pose");
    let parameters = robot.plant_parameters().expect("masses");
    let motors = robot.steppers().expect("steppers");
    let plant = StepperPlant::new(&parameters, &motors, &Mismatch::default(), &pose, 7);
    SharedStepperArm::new(StepperArm::new(plant))
}

#[test]
fn the_arm_homes_and_draws_without_losing_a_step() {
    let robot = Robot::load("benchtop_stepper").expect("a built-in robot");
    let settings = robot.settings().expect("settings");
    let arm = arm(&robot);
    let path = bench::path().with_file_name("stm32f405_stepper");
    let image = Arc::new(Image::read(&path).expect("an image"));
    let options = Options {
        drives: DriveKind::Steppers,
        ..Options::default()
    };
    let chip = Chip::new(image, options, Vec::new(), Box::new(arm.clone())).expect("an emulator");
    let line = HostLine::new(chip);
    let time = |line: &HostLine| Duration::from_micros(line.chip().now() / MICROSECOND);
    let (mut client, _) = Client::open_with_clock(line.clone(), time).expect("it answers");

    let scenario = Scenario::new("drawing", robot, "drawing.gcode", DRAWING.into());
    let job: Job = scenario.job().expect("a job");
    let moves = scenario.moves(&job).expect("moves");
    let mut drive = Drive::new(&mut client, &|| false);
    drive.store_settings(&settings).expect("stored");
    drive.home(Homing::IfUnknown).expect("homed");
    let mut worst: f64 = 0.0;
    let mut seen = 0;
    let followed = drive.follow(&moves, &settings, &mut |_, status| {
        let Some([x, y]) = status.tool else { return };
        let [true_x, true_y]: [f64; 2] = arm.get().plant().tool().into();
        worst = worst.max((f64::from(x) - true_x).hypot(f64::from(y) - true_y));
        seen += 1;
    });
    followed.expect("it draws");
    line.chip().run(10 * MILLISECOND).expect("it runs");
    let plant = arm.get();
    let plant = plant.plant();
    println!(
        "{seen} reports, {:.0} µm at most from the true tool",
        1e6 * worst
    );
    assert_eq!(plant.lost_steps(), [0, 0]);
    assert!(seen > 10, "{seen}");
    // The report is up to 10 ms old at 30 mm/s, and a micro-step is about 0.1 mm.
    assert!(worst < 5e-4, "{worst} m");
    for joint in Joint::ALL {
        assert!(plant.torque()[joint].abs() < 0.1, "it is at rest");
    }
}
