//! Draws on a simulated Pico 2 whose image moves a simulated arm, and writes what the arm's tool drew.
//!
//! `draw <folder of the images> <robot> <picture> [job]`: without a job a half circle and its diameter. `scripts/pico.sh draw`
//! builds the images and runs it. A second of the board takes about 16 of a computer: no long job.

use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_pico::{Arm, Chip, HZ, HostLine, Image, ServoArm, StepperArm, Wires};
use fivebar_plant::{HobbyServoPlant, Mismatch, StepperPlant};
use fivebar_sim::drive::{Drive, Homing};
use fivebar_sim::link::Client;
use fivebar_sim::machine::Machine;
use std::cell::RefCell;
use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;
use std::rc::Rc;

/// Cycles of a unit of a servo's pulse, half a microsecond.
const UNIT: f64 = 75.0;
/// Ticks from one place of the tool that is kept to the next.
const EVERY: u32 = 50;
/// A job that takes a few seconds of the board: the diameter of a half circle, and the half circle back.
const JOB: &str = "G21\nG90\nG0 X0 Y0\nG1 X10 Y0 F1200\nG3 X0 Y0 I-5 J0\n";
/// Millimetres around a picture.
const MARGIN: f64 = 2.0;

/// Places of a tool [m].
type Places = Rc<RefCell<Vec<[f64; 2]>>>;

/// An arm, and where its tool was.
struct Watched<A> {
    arm: A,
    tool: fn(&A) -> [f64; 2],
    places: Places,
    ticks: u32,
}

impl<A: Arm> Arm for Watched<A> {
    fn advance(&mut self, wires: &mut Wires, brake_is_released: bool) {
        self.arm.advance(wires, brake_is_released);
        if self.ticks.is_multiple_of(EVERY) {
            self.places.borrow_mut().push((self.tool)(&self.arm));
        }
        self.ticks = self.ticks.wrapping_add(1);
    }
}

/// Puts the robot's arm behind the pins, a steppers' a little before its home switches.
fn connect(chip: &mut Chip, robot: &Robot, places: &Places) -> Result<(), Box<dyn Error>> {
    let (parameters, exact) = (robot.plant_parameters()?, Mismatch::default());
    let settings = robot.settings()?;
    let places = Rc::clone(places);
    if let Some(pulses) = settings.servo_pulses() {
        let servos = robot.hobby_servos().ok_or("the robot has no servos")?;
        let pose = robot.pose_near_home([0.0; 2])?;
        let plant = HobbyServoPlant::new(&parameters, &servos, &exact, &pose, 7);
        let home = pulses.map(|pulse| (f64::from(pulse.home_width) * HZ as f64).round());
        chip.connect(Watched {
            arm: ServoArm::new(plant, home, UNIT),
            tool: |arm| arm.plant.tool().into(),
            places,
            ticks: 0,
        });
        return Ok(());
    }
    let motors = robot.steppers().ok_or("the robot has no steppers")?;
    let before = |home_forward| if home_forward { -0.03 } else { 0.03 };
    let pose = robot.pose_near_home(settings.axes.map(|axis| before(axis.home_forward)))?;
    chip.connect(Watched {
        arm: StepperArm::new(StepperPlant::new(&parameters, &motors, &exact, &pose, 7)),
        tool: |arm| arm.plant.tool().into(),
        places,
        ticks: 0,
    });
    Ok(())
}

/// The places as a picture in millimetres.
fn picture(places: &[[f64; 2]]) -> String {
    let points: Vec<[f64; 2]> = places.iter().map(|[x, y]| [1e3 * x, -1e3 * y]).collect();
    let ends = |axis: usize| {
        let all = || points.iter().map(|point| point[axis]);
        let least = all().fold(f64::INFINITY, f64::min) - MARGIN;
        (
            least,
            all().fold(f64::NEG_INFINITY, f64::max) + MARGIN - least,
        )
    };
    let ((x, width), (y, height)) = (ends(0), ends(1));
    let mut path = String::new();
    for [x, y] in &points {
        let _ = write!(path, "{x:.3},{y:.3} ");
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.1}mm\" height=\"{height:.1}mm\" \
         viewBox=\"{x:.2} {y:.2} {width:.2} {height:.2}\"><polyline points=\"{}\" fill=\"none\" stroke=\"black\" \
         stroke-width=\"0.3\"/></svg>\n",
        path.trim_end()
    )
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, robot, to, job @ ..] = &arguments[..] else {
        return Err("draw <folder of the images> <robot> <picture> [job]".into());
    };
    let robot = Robot::load(robot)?;
    let settings = robot.settings()?;
    let mut images = Machine::of(robot.drive_kind()).images();
    let image = images.find(|image| image.chip.name == "pico2");
    let image = image.ok_or("no image of a Pico 2 is for this robot")?;
    let mut chip = Chip::new(&Image::read(&Path::new(folder).join(image.name))?);
    let places = Places::default();
    connect(&mut chip, &robot, &places)?;
    chip.run(HZ / 100)?;
    let line = HostLine::new(chip);
    let (mut client, _) = Client::open_with_clock(line.clone(), HostLine::time)?;

    let scenario = match job {
        [] => Scenario::new("drawing", robot, "half circle.gcode", JOB.into()),
        [file, ..] => Scenario::new("drawing", robot, file, std::fs::read_to_string(file)?),
    };
    let moves = scenario.moves(&scenario.job()?)?;
    let mut drive = Drive::new(&mut client, &|| false);
    drive.store_settings(&settings)?;
    drive.home(Homing::IfUnknown)?;
    places.borrow_mut().clear();
    drive.follow(&moves, &settings, &mut |_, _| {})?;
    std::fs::write(to, picture(&places.borrow()))?;
    println!(
        "{}: {} moves in {:.1} s of the board's time; the tool's path: {to}",
        image.name,
        moves.len(),
        line.time().as_secs_f64()
    );
    Ok(())
}
