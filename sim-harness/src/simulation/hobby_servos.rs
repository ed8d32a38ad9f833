//! Runs on an arm with hobby servos. Their controller is that of stepper drives, whose micro-steps are units of the timer
//! that makes the pulses: it takes the place that a servo is told for the place where it is.

use super::{ByHand, RunError, SimulatedArm, prepared};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::drives::{StepCommand, StepDrives, StepSample};
use fivebar_firmware::{ArmCommand, ArmSample};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{HobbyServoPlant, Plant, PlantFault};
use serde::Serialize;

/// How far hobby servos are from their set-points, whatever their controller does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ServoLimits {
    /// The dead band at the tool with a straight leg, of the worse joint [m].
    pub dead_band_m: f64,
    /// The longest time from a set-point until the joint is there, of the worse joint [s].
    pub late_s: f64,
}

/// What this robot's servos leave of any drawing.
pub(super) fn limits(robot: &Robot) -> Option<ServoLimits> {
    let servos = robot.hobby_servos()?;
    let [l1, l2, l3, l4, _] = robot.geometry.lengths();
    let worse = |[one, other]: [f64; 2]| one.max(other);
    let leg = [l1 + l2, l3 + l4];
    Some(ServoLimits {
        dead_band_m: worse(Joint::ALL.map(|j| {
            let servo = &servos[j];
            leg[j.index()] * servo.dead_angle() / servo.gear_ratio.abs()
        })),
        late_s: worse(servos.map(|servo| servo.longest_delay() + servo.lag())),
    })
}

/// The simulated arm, as [`Simulate::plant`](super::Simulate::plant) has it with brushed motors: a hand has put it near its
/// home angles.
pub(super) fn plant(scenario: &Scenario) -> Result<HobbyServoPlant, RunError> {
    let robot = &scenario.robot;
    let servos = robot.hobby_servos();
    let servos = servos.ok_or_else(|| RunError::NoServos(robot.name.clone()))?;
    let (pose, parameters) = prepared(scenario)?;
    let (mismatch, seed) = (&scenario.mismatch, scenario.seed);
    let mut plant = HobbyServoPlant::new(&parameters, &servos, mismatch, &pose, seed);
    plant.rewire(&scenario.wiring);
    for &fault in &scenario.initial_faults {
        plant.arm_mut().inject(fault);
    }
    Ok(plant)
}

impl ByHand for HobbyServoPlant {
    fn plant(&self) -> &Plant {
        self.arm()
    }

    fn plant_mut(&mut self) -> &mut Plant {
        self.arm_mut()
    }
}

impl SimulatedArm for HobbyServoPlant {
    type Interface = StepDrives;

    fn sense(&mut self) -> ArmSample<StepSample> {
        Self::sense(self)
    }

    fn step(&mut self, command: &ArmCommand<StepCommand>, period: f64) {
        Self::step(self, command, period);
    }

    fn schedule_faults(&mut self, faults: &[PlantFault]) {
        self.arm_mut().schedule_faults(faults);
    }

    fn tool(&self) -> [f64; 2] {
        Self::tool(self).into()
    }

    fn angle(&self, joint: Joint) -> f64 {
        Self::angle(self, joint)
    }

    fn torque(&self) -> [f64; 2] {
        Self::torque(self)
    }

    /// A servo tells no current: its torque, at 1 N·m/A.
    fn current(&self) -> [f64; 2] {
        Self::torque(self)
    }
}
