//! The simulated arm: moved by a controller in this process in real time, or by one that
//! is stepped.

use super::pace::Pace;
use crate::input::robot::Robot;
use crate::input::scenario::Scenario;
use crate::run::link::{Client, LinkError, Loopback};
use crate::run::plant::Plant;
use crate::run::simulation::RunError;
use fivebar_firmware::Command;
use std::io::{Read, Write};

/// Ticks between two looks at the pages: few against the controller's command timeout.
const TICKS_PER_STEP: u32 = 20;

fn scenario(robot: &Robot) -> Scenario {
    Scenario::new("page", robot.clone(), "page", String::new())
}

/// A board that moves the robot's arm and takes as long as a real one.
pub(super) fn line(robot: &Robot) -> Result<Loopback, RunError> {
    let mut plant = scenario(robot).plant()?;
    let settings = robot.settings()?;
    let rate = robot.control.tick_rate;
    let mut pace = Pace::new(rate);
    let arm = move |command: &Command| {
        pace.tick();
        plant.step(command, 1.0 / rate);
        plant.sense()
    };
    Loopback::driving(&settings, Box::new(arm)).map_err(|error| RunError::Settings {
        robot: robot.name.clone(),
        error,
    })
}

/// The arm of a board whose sensors and bridges are frames: no faster than time, and as
/// much slower as the board is.
pub(super) struct SteppedArm {
    plant: Plant,
    period: f64,
    pace: Pace,
}

impl SteppedArm {
    pub(super) fn new(robot: &Robot) -> Result<Self, RunError> {
        let rate = robot.control.tick_rate;
        Ok(Self {
            plant: scenario(robot).plant()?,
            period: 1.0 / rate,
            pace: Pace::new(rate),
        })
    }

    /// Makes some ticks, and moves as they command.
    pub(super) fn step<L: Read + Write>(&mut self, board: &mut Client<L>) -> Result<(), LinkError> {
        for _ in 0..TICKS_PER_STEP {
            let ticked = board.tick(self.plant.sense())?;
            self.plant.step(&ticked.command, self.period);
            self.pace.tick();
        }
        Ok(())
    }
}
