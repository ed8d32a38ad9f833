//! Runs on an arm whose drives are on a CAN bus.

use super::{RunError, SimulatedArm, check_mismatch, settings_error, start_pose};
use crate::link::InProcess;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::drives::can::{Frames, Link, Protocol};
use fivebar_firmware::drives::{TorqueDrives, TorqueSample, TorqueSetPoint};
use fivebar_firmware::{ArmCommand, ArmSample};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{CanDrive, CanPlant, PlantFault};

/// The simulated arm, and the controller's end of the bus.
pub struct ArmOnBus {
    plant: CanPlant,
    link: Link,
}

impl ArmOnBus {
    /// The arm of this scenario.
    ///
    /// # Errors
    /// Its drives are on no bus, it has no masses or no home pose, or its mismatch does not fit.
    pub fn of(scenario: &Scenario) -> Result<Self, RunError> {
        match scenario.robot.can_bus() {
            Some(bus) => Self::new(scenario, bus),
            None => Err(RunError::NoBus(scenario.robot.name.clone())),
        }
    }

    /// The plant, to disturb its bus.
    pub fn plant_mut(&mut self) -> &mut CanPlant {
        &mut self.plant
    }

    /// The arm of this scenario, as [`Simulate::plant`](super::Simulate::plant) has it with brushed motors.
    pub(super) fn new(
        scenario: &Scenario,
        (protocol, drives): (Protocol, [CanDrive; 2]),
    ) -> Result<Self, RunError> {
        let pose = start_pose(scenario)?;
        let parameters = scenario.arm().plant_parameters()?;
        check_mismatch(scenario, &parameters)?;
        let (mismatch, seed) = (&scenario.mismatch, scenario.seed);
        let bus = (protocol, drives);
        let mut plant = CanPlant::new(&parameters, bus, mismatch, &pose, seed);
        for &fault in &scenario.initial_faults {
            plant.arm_mut().inject(fault);
        }
        let settings = parameters.settings.check();
        let settings = settings.map_err(|error| settings_error(scenario, error))?;
        let nodes = drives.map(|drive| drive.node);
        Ok(Self {
            plant,
            link: Link::new(protocol, nodes, &settings),
        })
    }
}

/// A controller of torque drives.
pub(super) fn controller(scenario: &Scenario) -> Result<InProcess<TorqueDrives>, RunError> {
    let robot = &scenario.robot;
    let settings = match scenario.control_law.is_computed_torque() {
        true => robot.settings()?,
        false => robot.pid_settings()?,
    };
    InProcess::new(&settings).map_err(|error| settings_error(scenario, error))
}

impl SimulatedArm for ArmOnBus {
    type Drives = TorqueDrives;

    fn sense(&mut self) -> ArmSample<TorqueSample> {
        for frame in self.plant.take_received() {
            self.link.receive(&frame);
        }
        let (counts, drives) = self.link.sample(self.plant.is_bus_off());
        let sample = self.plant.sense();
        ArmSample {
            counts,
            drives,
            home: sample.home,
            index: sample.index,
            emergency_stop: sample.emergency_stop,
            driver_fault: sample.driver_fault,
            missed_ticks: sample.missed_ticks,
        }
    }

    fn step(&mut self, command: &ArmCommand<TorqueSetPoint>, period: f64) {
        let mut frames = Frames::new();
        self.link.send(command.enable, &command.drives, &mut frames);
        self.plant
            .step(&frames, command.brake, command.tool, period);
    }

    fn schedule_faults(&mut self, faults: &[PlantFault]) {
        self.plant.arm_mut().schedule_faults(faults);
    }

    fn tool(&self) -> [f64; 2] {
        self.plant.tool().into()
    }

    fn angle(&self, joint: Joint) -> f64 {
        self.plant.angle(joint)
    }

    fn torque(&self) -> [f64; 2] {
        self.plant.torque()
    }

    /// The currents of the settings' torque constants.
    fn current(&self) -> [f64; 2] {
        self.plant.current()
    }
}
