//! The simulated arm, moved by a controller in this process in real time or by a board in
//! lockstep.

use super::pace::Pacer;
use crate::link::{Client, LinkError, Loopback};
use crate::simulation::{RunError, Simulate};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::ActuatorCommand;
use fivebar_plant::Plant;
use std::io::{Read, Write};

/// Ticks between two rounds of the thread: short against the controller's command timeout.
const TICKS_PER_STEP: u32 = 20;

fn scenario(robot: &Robot) -> Scenario {
    Scenario::new("page", robot.clone(), "page", String::new())
}

/// A controller in this process that moves the simulated arm in real time.
pub(super) fn line(robot: &Robot) -> Result<Loopback, RunError> {
    let mut plant = scenario(robot).plant()?;
    let settings = robot.settings()?;
    let rate = robot.control.tick_rate;
    let mut pace = Pacer::new(rate);
    let arm = move |command: &ActuatorCommand| {
        pace.tick();
        plant.step(command, 1.0 / rate);
        plant.sense()
    };
    Loopback::driving(&settings, Box::new(arm)).map_err(|error| RunError::Settings {
        robot: robot.name.clone(),
        error,
    })
}

/// The simulated arm of a board in lockstep. It runs at most in real time, and slower if the
/// board is slower.
pub(super) struct SteppedArm {
    plant: Plant,
    period: f64,
    pace: Pacer,
}

impl SteppedArm {
    pub(super) fn new(robot: &Robot) -> Result<Self, RunError> {
        let rate = robot.control.tick_rate;
        Ok(Self {
            plant: scenario(robot).plant()?,
            period: 1.0 / rate,
            pace: Pacer::new(rate),
        })
    }

    /// Runs some ticks on the board and moves the arm by their outputs.
    pub(super) fn step<L: Read + Write>(&mut self, board: &mut Client<L>) -> Result<(), LinkError> {
        for _ in 0..TICKS_PER_STEP {
            let result = board.tick(self.plant.sense())?;
            self.plant.step(&result.command, self.period);
            self.pace.tick();
        }
        Ok(())
    }
}
