//! Runs on an arm whose drives are on a CAN bus.

use super::{ByHand, RunError, SimulatedArm, SimulatedDrives, prepared};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::drives::can::{BusCommand, BusDrives, BusSample, Frame};
use fivebar_firmware::{ArmCommand, ArmSample};
use fivebar_kinematics::five_bar::{Joint, Pose};
use fivebar_plant::{CanPlant, Plant, PlantFault};

impl SimulatedDrives for BusDrives {
    type Arm = CanPlant;

    fn arm(scenario: &Scenario) -> Result<CanPlant, RunError> {
        let robot = &scenario.robot;
        let bus = robot.can_bus();
        let bus = bus.ok_or_else(|| RunError::NoBus(robot.name.clone()))?;
        let (pose, parameters) = prepared(scenario)?;
        let (mismatch, seed) = (&scenario.mismatch, scenario.seed);
        let mut plant = CanPlant::new(&parameters, bus, mismatch, &pose, seed);
        plant.rewire(&scenario.wiring);
        for &fault in &scenario.initial_faults {
            plant.arm_mut().inject(fault);
        }
        Ok(plant)
    }
}

impl ByHand for CanPlant {
    fn plant(&self) -> &Plant {
        self.arm()
    }

    fn plant_mut(&mut self) -> &mut Plant {
        self.arm_mut()
    }

    /// The drives answer meanwhile.
    fn hold_by_hand(&mut self, pose: &Pose<f64>, command: &ArmCommand<BusCommand>, period: f64) {
        self.arm_mut().hold_by_hand(pose, 0.0);
        SimulatedArm::step(self, command, period);
    }
}

impl SimulatedArm for CanPlant {
    type Interface = BusDrives;

    /// Frames for which the controller's FIFOs have no room are lost.
    fn sense(&mut self) -> ArmSample<BusSample> {
        let mut drives = BusSample {
            is_off: self.is_bus_off(),
            ..BusSample::default()
        };
        for (place, frame) in drives.frames.iter_mut().zip(self.take_received()) {
            *place = Some(frame);
        }
        Self::sense(self).with_drives(drives)
    }

    fn step(&mut self, command: &ArmCommand<BusCommand>, period: f64) {
        let frames: Vec<Frame> = command.drives.frames.into_iter().flatten().collect();
        Self::step(self, &frames, command.brake, command.tool, period);
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

    /// The currents of the settings' torque constants.
    fn current(&self) -> [f64; 2] {
        Self::current(self)
    }
}
