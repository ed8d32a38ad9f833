//! A simulated arm whose tool is pushed.

use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::drives::BrushedDrives;
use fivebar_firmware::{ActuatorCommand, SensorSample};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{Plant, PlantFault};
use fivebar_sim::link::InProcess;
use fivebar_sim::simulation::{Sample, Simulate, SimulatedArm, Simulation};
use nalgebra::Vector2;
use std::fs;

/// The benchtop arm with belts of this stiffness [N·m/rad] and a damping ratio of 1 %.
pub(crate) fn benchtop(stiffness: f64) -> Robot {
    let inertia = 1.0 / (1.0 / 64e-6 + 1.0 / 1e-3);
    let damping = 0.02 * f64::sqrt(stiffness * inertia);
    let keys =
        format!("encoder_counts = 16384\nstiffness = {stiffness:?}\ndrive_damping = {damping:?}");
    let text = BuiltIn::find("benchtop").expect("built in").text;
    let text = text.replace("encoder_counts = 16384", &keys);
    Robot::parse("belts.toml", &text).expect("a valid robot")
}

/// The force on the tool [N] after so long from power-up [s].
type Push<'a> = dyn Fn(f64) -> Vector2<f64> + 'a;

struct Pushed<'a> {
    plant: Plant,
    push: &'a Push<'a>,
    time: f64,
}

impl SimulatedArm for Pushed<'_> {
    type Interface = BrushedDrives;

    fn sense(&mut self) -> SensorSample {
        self.plant.sense()
    }

    fn step(&mut self, command: &ActuatorCommand, period: f64) {
        self.plant.set_tool_force((self.push)(self.time));
        self.plant.step(command, period);
        self.time += period;
    }

    fn schedule_faults(&mut self, faults: &[PlantFault]) {
        self.plant.schedule_faults(faults);
    }

    fn tool(&self) -> [f64; 2] {
        self.plant.tool().into()
    }

    fn angle(&self, joint: Joint) -> f64 {
        self.plant.angle(joint)
    }

    fn torque(&self) -> [f64; 2] {
        SimulatedArm::torque(&self.plant)
    }

    fn current(&self) -> [f64; 2] {
        SimulatedArm::current(&self.plant)
    }
}

/// The samples of a job from home, and the time from power-up to its beginning [s], while its tool is pushed.
pub(crate) fn pushed(robot: &Robot, job: &str, push: &Push<'_>) -> (Vec<Sample>, f64) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("job.gcode");
    fs::write(&path, job).expect("written");
    let path = path.to_str().expect("text");
    let mut scenario = Scenario::of_job(path, robot.clone()).expect("a job");
    let home = robot.home_pose().expect("a home");
    scenario.origin = Some(robot.tool_at(&home));
    scenario.mismatch = fivebar_plant::Mismatch::NONE;
    let job = scenario.job().expect("valid");
    let moves = scenario.run_moves(&job).expect("moves");
    let mut target = InProcess::new(&robot.settings().expect("masses")).expect("valid settings");
    let arm = Pushed {
        plant: scenario.plant().expect("an arm"),
        push,
        time: 0.0,
    };
    let simulation = Simulation::new(&mut target, arm, robot.control.tick_rate);
    let record = simulation.run(&moves, &[], &mut |_| ()).expect("it runs");
    assert_eq!(record.faults, []);
    (
        record.trace.samples().to_vec(),
        record.begun.expect("it begins"),
    )
}
