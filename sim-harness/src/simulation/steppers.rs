//! Runs on an arm with steppers.

use super::{ByHand, RunError, SimulatedArm, SimulatedDrives, prepared};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::drives::{StepCommand, StepDrives, StepSample};
use fivebar_firmware::{ArmCommand, ArmSample};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{Plant, PlantFault, StepperPlant};

impl SimulatedDrives for StepDrives {
    type Arm = StepperPlant;

    fn arm(scenario: &Scenario) -> Result<StepperPlant, RunError> {
        let robot = &scenario.robot;
        let motors = robot.steppers();
        let motors = motors.ok_or_else(|| RunError::NoSteppers(robot.name.clone()))?;
        let (pose, parameters) = prepared(scenario)?;
        let (mismatch, seed) = (&scenario.mismatch, scenario.seed);
        let mut plant = StepperPlant::new(&parameters, &motors, mismatch, &pose, seed);
        plant.rewire(&scenario.wiring);
        for &fault in &scenario.initial_faults {
            plant.arm_mut().inject(fault);
        }
        Ok(plant)
    }
}

impl ByHand for StepperPlant {
    fn plant(&self) -> &Plant {
        self.arm()
    }

    fn plant_mut(&mut self) -> &mut Plant {
        self.arm_mut()
    }
}

impl SimulatedArm for StepperPlant {
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

    fn current(&self) -> [f64; 2] {
        Self::current(self)
    }

    fn lost_steps(&self) -> Option<[i64; 2]> {
        Some(Self::lost_steps(self))
    }
}
