//! What a run needs of a simulated arm, whatever turns its joints.

use super::{RunError, hobby_servos};
use crate::link::{DesktopDrives, EmulatedDrives};
use fivebar_files::robot::DriveKind;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::drives::can::BusDrives;
use fivebar_firmware::drives::{BrushedDrives, DriveInterface, StepDrives};
use fivebar_firmware::{ActuatorCommand, ArmCommand, ArmSample, SensorSample};
use fivebar_kinematics::five_bar::{Joint, Pose};
use fivebar_plant::{Plant, PlantFault, WornJoints};

/// A simulated arm with drives of one kind, one tick at a time. Index 0 of a pair is joint 1, index 1 joint 4.
pub trait SimulatedArm {
    /// What it exchanges with its controller.
    type Interface: DesktopDrives;

    /// Samples all sensors at once.
    fn sense(&mut self) -> ArmSample<<Self::Interface as DriveInterface>::Sample>;

    /// Advances by one tick of `period` [s].
    fn step(
        &mut self,
        command: &ArmCommand<<Self::Interface as DriveInterface>::Command>,
        period: f64,
    );

    /// Injects these faults at their times from now on.
    fn schedule_faults(&mut self, faults: &[PlantFault]);

    /// The tool's true position [m].
    fn tool(&self) -> [f64; 2];

    /// The joint's true angle [rad].
    fn angle(&self, joint: Joint) -> f64;

    /// The motors' torques at the joints [N·m].
    fn torque(&self) -> [f64; 2];

    /// The motors' currents [A].
    fn current(&self) -> [f64; 2];

    /// Joints that are worn, if the arm has them.
    fn wear(&mut self) -> Option<&mut WornJoints> {
        None
    }

    /// Full steps that each stepper has lost; none on an arm without steppers.
    fn lost_steps(&self) -> Option<[i64; 2]> {
        None
    }
}

/// A simulated arm that a hand turns while its drives have no power, and whose switches it presses.
pub trait ByHand: SimulatedArm {
    /// The links with their sensors and switches.
    fn plant(&self) -> &Plant;

    /// The same, to press and to turn.
    fn plant_mut(&mut self) -> &mut Plant;

    /// Advances by one tick of `period` [s] in which a hand holds the unpowered arm in `pose`, at rest.
    fn hold_by_hand(
        &mut self,
        pose: &Pose<f64>,
        _: &ArmCommand<<Self::Interface as DriveInterface>::Command>,
        period: f64,
    ) {
        self.plant_mut().hold_by_hand(pose, period);
    }
}

/// What is done with a simulated arm, whatever turns its joints.
pub trait WithArm {
    /// What comes of it.
    type Output;

    /// Does it with this arm.
    fn with<P>(self, arm: P) -> Self::Output
    where
        P: SimulatedArm<Interface: EmulatedDrives> + ByHand + Send + 'static;
}

/// Does this with the arm of a scenario, unpowered, with each joint 0.1 rad before its home switch: the one place where the
/// kind of its drives decides.
///
/// # Errors
/// The robot has no masses or no home pose, or its mismatch does not fit.
pub fn with_arm<W: WithArm>(scenario: &Scenario, act: W) -> Result<W::Output, RunError> {
    Ok(match scenario.robot.drive_kind() {
        DriveKind::Brushed => act.with(BrushedDrives::arm(scenario)?),
        DriveKind::Stepper => act.with(StepDrives::arm(scenario)?),
        DriveKind::CanTorque => act.with(BusDrives::arm(scenario)?),
        DriveKind::Servo => act.with(hobby_servos::plant(scenario)?),
    })
}

/// Drives of a kind that a scenario's arm can have.
pub trait SimulatedDrives: DriveInterface + Sized {
    /// The arm with them.
    type Arm: SimulatedArm<Interface = Self>;

    /// The arm of this scenario, as [`Simulate::plant`](super::Simulate::plant) has it with brushed motors.
    ///
    /// # Errors
    /// It has other drives, no masses or no home pose, or its mismatch does not fit.
    fn arm(scenario: &Scenario) -> Result<Self::Arm, RunError>;
}

impl SimulatedDrives for BrushedDrives {
    type Arm = Plant;

    fn arm(scenario: &Scenario) -> Result<Plant, RunError> {
        super::Simulate::plant(scenario)
    }
}

impl ByHand for Plant {
    fn plant(&self) -> &Plant {
        self
    }

    fn plant_mut(&mut self) -> &mut Plant {
        self
    }
}

impl SimulatedArm for Plant {
    type Interface = BrushedDrives;

    fn sense(&mut self) -> SensorSample {
        Self::sense(self)
    }

    fn step(&mut self, command: &ActuatorCommand, period: f64) {
        Self::step(self, command, period);
    }

    fn schedule_faults(&mut self, faults: &[PlantFault]) {
        Self::schedule_faults(self, faults);
    }

    fn tool(&self) -> [f64; 2] {
        Self::tool(self).into()
    }

    fn angle(&self, joint: Joint) -> f64 {
        Self::angle(self, joint)
    }

    fn torque(&self) -> [f64; 2] {
        let current = self.current();
        Joint::ALL.map(|j| self.model().motors[j].torque(current[j]))
    }

    fn current(&self) -> [f64; 2] {
        self.state().current
    }

    fn wear(&mut self) -> Option<&mut WornJoints> {
        Self::wear(self)
    }
}
