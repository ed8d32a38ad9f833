//! The simulated arm in real time.

use crate::link::Loopback;
use crate::robot::Robot;
use crate::run::{RunError, Scenario};
use fivebar_firmware::Command;
use std::thread;
use std::time::{Duration, Instant};

/// Time that passes between two looks at the clock.
const PACE: Duration = Duration::from_millis(1);
/// A simulation this late goes on from where it is, slower than time, instead of racing.
const TOO_LATE: Duration = Duration::from_millis(100);

/// A board that moves the scenario's arm and takes as long as a real one.
pub(super) fn line(scenario: &Scenario) -> Result<Loopback, RunError> {
    let settings = scenario.robot.settings()?;
    let mut plant = scenario.plant()?;
    let period = 1.0 / scenario.robot.control.tick_rate;
    let mut pace = Pace::new(&scenario.robot);
    let arm = move |command: &Command| {
        pace.tick();
        plant.step(command, period);
        plant.sense()
    };
    Loopback::driving(&settings, Box::new(arm)).map_err(|error| RunError::Settings {
        robot: scenario.robot.name.clone(),
        error,
    })
}

/// Holds ticks back to the clock on the wall.
struct Pace {
    ticks_per_look: u32,
    ticks: u32,
    /// When the next look is due.
    due: Instant,
}

impl Pace {
    fn new(robot: &Robot) -> Self {
        Self {
            ticks_per_look: ((PACE.as_secs_f64() * robot.control.tick_rate) as u32).max(1),
            ticks: 0,
            due: Instant::now(),
        }
    }

    fn tick(&mut self) {
        self.ticks += 1;
        if self.ticks < self.ticks_per_look {
            return;
        }
        self.ticks = 0;
        self.due += PACE;
        let now = Instant::now();
        match self.due.checked_duration_since(now) {
            Some(early) => thread::sleep(early),
            None if now - self.due > TOO_LATE => self.due = now,
            None => {}
        }
    }
}
