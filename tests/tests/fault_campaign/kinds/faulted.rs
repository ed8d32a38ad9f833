//! An arm that gets a fault at a time of its own.

use fivebar_firmware::drives::DriveInterface;
use fivebar_firmware::{ArmCommand, ArmSample};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{
    CanPlant, FaultKind, HobbyServoPlant, Plant, PlantFault, StepperPlant, Wiring,
};
use fivebar_sim::simulation::SimulatedArm;

/// A fault to inject.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    /// As a scenario file has it.
    Plant(FaultKind),
    /// A wire that breaks, or a mistake that is made, as a scenario's `[wiring]` has it.
    Wiring(Wiring),
    /// A drive tells the same answers again and again.
    StaleAnswers(Joint),
    /// A drive's answers are late by up to this time [s].
    AnswersLate(Joint, f64),
    /// A drive leaves its mode without an error.
    ModeLost(Joint),
    /// A drive has an error that no clear removes.
    DriveBroken(Joint),
    /// The motor makes more torque per ampere than the controller thinks, by this share.
    TorqueConstant(Joint, f64),
}

/// An arm whose faults and wires the campaign can reach.
pub(crate) trait Reachable: SimulatedArm {
    fn plant(&mut self) -> &mut Plant;

    /// Wires it like this.
    fn rewire(&mut self, wiring: &Wiring);

    /// Injects a fault of a drive on a bus.
    fn harm(&mut self, _fault: Fault) {}
}

impl Reachable for Plant {
    fn plant(&mut self) -> &mut Plant {
        self
    }

    fn rewire(&mut self, wiring: &Wiring) {
        Self::rewire(self, wiring);
    }
}

impl Reachable for StepperPlant {
    fn plant(&mut self) -> &mut Plant {
        self.arm_mut()
    }

    fn rewire(&mut self, wiring: &Wiring) {
        Self::rewire(self, wiring);
    }
}

impl Reachable for HobbyServoPlant {
    fn plant(&mut self) -> &mut Plant {
        self.arm_mut()
    }

    fn rewire(&mut self, wiring: &Wiring) {
        Self::rewire(self, wiring);
    }
}

impl Reachable for CanPlant {
    fn plant(&mut self) -> &mut Plant {
        self.arm_mut()
    }

    fn rewire(&mut self, wiring: &Wiring) {
        Self::rewire(self, wiring);
    }

    fn harm(&mut self, fault: Fault) {
        match fault {
            Fault::StaleAnswers(joint) => self.repeat_answers(joint),
            Fault::AnswersLate(joint, most) => self.delay_answers(joint, [0.0, most]),
            Fault::ModeLost(joint) => self.lose_mode(joint),
            Fault::DriveBroken(joint) => self.break_drive(joint),
            Fault::Plant(_) | Fault::Wiring(_) | Fault::TorqueConstant(..) => {}
        }
    }
}

/// An arm that gets a fault.
pub(crate) struct Faulted<P> {
    pub(crate) arm: P,
    pub(crate) fault: Fault,
    /// The time of the fault from power-up [s], or from the beginning of the job.
    pub(crate) at: f64,
    pub(crate) is_of_job: bool,
    pub(crate) time: f64,
    pub(crate) done: bool,
}

impl<P: Reachable> SimulatedArm for Faulted<P> {
    type Interface = P::Interface;

    fn sense(&mut self) -> ArmSample<<Self::Interface as DriveInterface>::Sample> {
        if !self.done && !self.is_of_job && self.time >= self.at {
            self.done = true;
            match self.fault {
                Fault::Plant(kind) => self.arm.plant().inject(kind),
                Fault::Wiring(wiring) => self.arm.rewire(&wiring),
                fault => self.arm.harm(fault),
            }
        }
        self.arm.sense()
    }

    fn step(
        &mut self,
        command: &ArmCommand<<Self::Interface as DriveInterface>::Command>,
        period: f64,
    ) {
        self.arm.step(command, period);
        self.time += period;
    }

    /// The job begins.
    fn schedule_faults(&mut self, _: &[PlantFault]) {
        if self.is_of_job {
            self.at += self.time;
            self.is_of_job = false;
        }
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
