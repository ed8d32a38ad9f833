//! What a run needs of a simulated arm, whatever turns its joints.

use fivebar_firmware::drives::{BrushedDrives, Drives};
use fivebar_firmware::{ActuatorCommand, ArmCommand, ArmSample, SensorSample};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{Plant, PlantFault, WornJoints};

/// A simulated arm with drives of one kind, one tick at a time. Index 0 of a pair is joint 1, index 1 joint 4.
pub trait SimulatedArm {
    /// The drives of its controller.
    type Drives: Drives;

    /// Samples all sensors at once.
    fn sense(&mut self) -> ArmSample<<Self::Drives as Drives>::Sample>;

    /// Advances by one tick of `period` [s].
    fn step(&mut self, command: &ArmCommand<<Self::Drives as Drives>::Command>, period: f64);

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

impl SimulatedArm for Plant {
    type Drives = BrushedDrives;

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
