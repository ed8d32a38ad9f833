//! A mistake in the wiring of an arm that then homes and draws, and what came of it.

use crate::kinds::drives::Drive;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::drives::can::BusDrives;
use fivebar_firmware::drives::{BrushedDrives, DriveInterface, StepDrives};
use fivebar_firmware::{ArmCommand, ArmSample, safety};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{HobbyServoPlant, PlantFault, WiringKey};
use fivebar_sim::link::{DesktopDrives, InProcess};
use fivebar_sim::simulation::{Simulate, SimulatedArm, SimulatedDrives, Simulation, verdict_on};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::path::Path;
use std::rc::Rc;

/// An arm rests whose joints have turned by no more than this [rad] in this time [s].
const RESTING: f64 = 2e-3;
const AT_REST_FOR: f64 = 0.05;

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Found {
    /// A fault was latched, this long after power-up or after the beginning of the job [s].
    Fault {
        fault: safety::Fault,
        after: f64,
        is_in_job: bool,
    },
    /// Only the verdict says so: the tip was wrong by this much while it drew [m].
    Verdict { worst: f64 },
    /// The run ended before the job was done, for this reason.
    Refused(String),
    /// The job is drawn.
    Drawn,
}

/// What came of it, and how the arm was left.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    pub(crate) found: Found,
    /// The controller has taken the motors' power.
    pub(crate) is_off: bool,
    /// By how much a joint still turned in the last [`AT_REST_FOR`] [rad].
    turned: f64,
}

impl Outcome {
    /// Both joints rest.
    pub(crate) fn rests(&self) -> bool {
        self.turned < RESTING
    }
}

/// An arm whose end can be seen behind its run.
struct Observed<P> {
    arm: P,
    end: Rc<RefCell<End>>,
}

/// The latest ticks.
#[derive(Default)]
struct End {
    enable: [bool; 2],
    /// Of the joints in the last [`AT_REST_FOR`] [rad].
    angles: VecDeque<[f64; 2]>,
}

impl End {
    /// The greatest angle by which a joint has turned [rad].
    fn turned(&self) -> f64 {
        let of = |j: Joint| {
            let angles = self.angles.iter().map(|angles| angles[j]);
            let bounds = (f64::INFINITY, f64::NEG_INFINITY);
            let (least, most) = angles.fold(bounds, |(a, b), it| (it.min(a), it.max(b)));
            most - least
        };
        of(Joint::Joint1).max(of(Joint::Joint4))
    }
}

impl<P: SimulatedArm> SimulatedArm for Observed<P> {
    type Interface = P::Interface;

    fn sense(&mut self) -> ArmSample<<Self::Interface as DriveInterface>::Sample> {
        self.arm.sense()
    }

    fn step(
        &mut self,
        command: &ArmCommand<<Self::Interface as DriveInterface>::Command>,
        period: f64,
    ) {
        self.arm.step(command, period);
        let mut end = self.end.borrow_mut();
        end.enable = command.enable;
        end.angles.push_back(Joint::ALL.map(|j| self.arm.angle(j)));
        if end.angles.len() as f64 * period > AT_REST_FOR {
            end.angles.pop_front();
        }
    }

    fn schedule_faults(&mut self, faults: &[PlantFault]) {
        self.arm.schedule_faults(faults);
    }

    fn tool(&self) -> [f64; 2] {
        self.arm.tool()
    }

    fn angle(&self, joint: Joint) -> f64 {
        self.arm.angle(joint)
    }

    fn torque(&self) -> [f64; 2] {
        self.arm.torque()
    }

    fn current(&self) -> [f64; 2] {
        self.arm.current()
    }

    fn lost_steps(&self) -> Option<[i64; 2]> {
        self.arm.lost_steps()
    }
}

/// The file of the arm on which a mistake can be seen: one that homes by index pulses, or whose drives know its angles.
fn robot_file(drive: Drive, key: &WiringKey) -> String {
    let text = drive.robot_file();
    if !key.kinds.contains(&drive.of_controller()) {
        return text;
    }
    match key.name {
        "index_dead" => format!("{text}\n[homing]\nmethod = \"index\"\n"),
        "zero_shift" => {
            let direct = [
                ("gear_ratio = 3.0", "gear_ratio = 1.0"),
                ("peak_torque = 0.97", "peak_torque = 2.91"),
                ("continuous_torque = 0.39", "continuous_torque = 1.17"),
                ("torque_constant = 0.0243", "torque_constant = 0.0729"),
                ("max_speed = 600.0", "max_speed = 200.0"),
                ("torque_range = 2.0", "torque_range = 6.0"),
                ("velocity_range = 640.0", "velocity_range = 220.0"),
            ];
            let text = direct
                .iter()
                .fold(text, |text, (geared, direct)| text.replace(geared, direct));
            format!("{text}\n[homing]\nmethod = \"absolute\"\n")
        }
        _ => text,
    }
}

/// A square that is drawn at the arm's greatest speed [m/s].
fn job(fastest: f64) -> String {
    let feed = fastest * 60e3;
    format!("G21 G90 M5\nG0 X-6 Y-6 F{feed:.0}\nM3\nG1 X6\nY6\nX-6\nY-6\nM5\n")
}

/// The scenario with this line under `[wiring]`, read from its file.
///
/// # Errors
/// The refusal of the line.
pub(crate) fn scenario(drive: Drive, key: &WiringKey, value: &str) -> Result<Scenario, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("it can be written");
        path
    };
    let text = robot_file(drive, key);
    file("arm.toml", &text);
    file("dot.gcode", "G21\nG1 X0 Y0 F600\n");
    let wrong = format!("{} = {value}", key.name);
    let lines = format!("robot = \"arm.toml\"\njob = \"dot.gcode\"\n[wiring]\n{wrong}\n");
    let path = file("wrong.toml", &lines);
    let read = Scenario::load(path.to_str().expect("UTF-8"));
    let wiring = read
        .map_err(|error| without_folder(&error.to_string(), folder.path()))?
        .wiring;
    let robot = Robot::parse("arm.toml", &text).expect("it is read above");
    let text = job(robot.motion.max_speed);
    let mut scenario = Scenario::new(drive.name(), robot, "square.gcode", text);
    scenario.fit().expect("it fits");
    scenario.wiring = wiring;
    Ok(scenario)
}

fn without_folder(text: &str, folder: &Path) -> String {
    text.replace(&format!("{}/", folder.display()), "")
}

/// Homes the arm and draws.
pub(crate) fn run(drive: Drive, scenario: &Scenario) -> Outcome {
    match drive {
        Drive::Brushed => {
            on::<BrushedDrives, _>(scenario, BrushedDrives::arm(scenario).expect("an arm"))
        }
        Drive::Stepper | Drive::StepperWithEncoder => {
            on::<StepDrives, _>(scenario, StepDrives::arm(scenario).expect("an arm"))
        }
        Drive::Odrive | Drive::Mit => {
            on::<BusDrives, _>(scenario, BusDrives::arm(scenario).expect("an arm"))
        }
        Drive::HobbyServo => {
            let servos = scenario.robot.hobby_servos().expect("servos");
            let parameters = scenario.robot.plant_parameters().expect("masses");
            let pose = scenario.robot.home_pose().expect("a home pose");
            let mut arm = HobbyServoPlant::new(
                &parameters,
                &servos,
                &scenario.mismatch,
                &pose,
                scenario.seed,
            );
            arm.rewire(&scenario.wiring);
            on::<StepDrives, _>(scenario, arm)
        }
    }
}

fn on<I: DesktopDrives, P: SimulatedArm<Interface = I>>(scenario: &Scenario, arm: P) -> Outcome {
    let job = scenario.job().expect("a job");
    let moves = scenario.run_moves(&job).expect("the job can be done");
    let mut target =
        InProcess::<I>::new(&scenario.robot.settings().expect("settings")).expect("valid settings");
    let end = Rc::new(RefCell::new(End::default()));
    let observed = Observed {
        arm,
        end: Rc::clone(&end),
    };
    let rate = scenario.robot.control.tick_rate;
    let run = Simulation::new(&mut target, observed, rate).run(&moves, &[], &mut |_| ());
    let found = match run {
        Err(error) => Found::Refused(error.to_string()),
        Ok(record) => match (record.faults.first(), verdict_on(scenario, &record)) {
            (Some(&(time, fault)), _) => Found::Fault {
                fault,
                after: time - record.begun.unwrap_or_default(),
                is_in_job: record.begun.is_some(),
            },
            (None, verdict) if verdict.drawn => Found::Drawn,
            (None, verdict) => Found::Verdict {
                worst: verdict.worst_m,
            },
        },
    };
    let end = end.borrow();
    Outcome {
        found,
        is_off: end.enable == [false; 2],
        turned: end.turned(),
    }
}
