//! The simulated arm, whatever turns its joints, moved by a controller in this process in real time or by a board in
//! lockstep.

use super::pace::Pacer;
use super::{Connection, Hand};
use crate::clock::Clock;
use crate::link::{Client, EmulatedDrives, LinkError, Loopback};
use crate::simulation::{ByHand, RunError, SimulatedArm, WithArm, with_arm};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::ArmCommand;
use fivebar_firmware::drives::DriveInterface;
use fivebar_firmware::settings::SettingsError;

/// Time between two rounds of the thread: short against the controller's command timeout [s].
const ROUND: f64 = 2e-3;

fn scenario(robot: &Robot) -> Scenario {
    Scenario::new("page", robot.clone(), "page", String::new())
}

/// A controller in this process that moves the simulated arm by this clock.
pub(super) fn line(
    robot: &Robot,
    clock: &Clock,
    hand: Option<Hand>,
) -> Result<Box<dyn Connection>, RunError> {
    let in_real_time = InRealTime { robot, clock, hand };
    let line = with_arm(&scenario(robot), in_real_time)??;
    Ok(line)
}

struct InRealTime<'a> {
    robot: &'a Robot,
    clock: &'a Clock,
    hand: Option<Hand>,
}

impl WithArm for InRealTime<'_> {
    type Output = Result<Box<dyn Connection>, RunError>;

    fn with<P>(self, mut arm: P) -> Self::Output
    where
        P: SimulatedArm<Interface: EmulatedDrives> + ByHand + Send + 'static,
    {
        let robot = self.robot;
        let mut hand = self.hand;
        let rate = robot.control.tick_rate;
        let mut pace = Pacer::new(rate, self.clock);
        let step = move |command: &ArmCommand<<P::Interface as DriveInterface>::Command>| {
            pace.tick();
            if let Some(hand) = &mut hand {
                let plant = arm.plant_mut();
                let (tip, velocity) = (plant.tool(), plant.model().tool_velocity(plant.state()));
                plant.set_tool_force(hand.force(plant.time(), tip, velocity));
            }
            arm.step(command, 1.0 / rate);
            arm.sense()
        };
        let refused = |error: SettingsError| RunError::Settings {
            robot: robot.name.clone(),
            error,
        };
        let line = Loopback::<P::Interface>::driving(&robot.settings()?, Box::new(step));
        Ok(Box::new(line.map_err(refused)?))
    }
}

/// The simulated arm of a board in lockstep. It runs at most as fast as its clock, and slower if the
/// board is slower.
pub(super) trait SteppedArm: Send {
    /// Runs some ticks on the board and moves the arm by their outputs.
    fn step(&mut self, board: &mut Client<Box<dyn Connection>>) -> Result<(), LinkError>;
}

/// The simulated arm of this robot for a board in lockstep.
pub(super) fn stepped(robot: &Robot, clock: &Clock) -> Result<Box<dyn SteppedArm>, RunError> {
    with_arm(&scenario(robot), InLockstep { robot, clock })
}

struct InLockstep<'a> {
    robot: &'a Robot,
    clock: &'a Clock,
}

impl WithArm for InLockstep<'_> {
    type Output = Box<dyn SteppedArm>;

    fn with<P>(self, arm: P) -> Self::Output
    where
        P: SimulatedArm<Interface: EmulatedDrives> + ByHand + Send + 'static,
    {
        let rate = self.robot.control.tick_rate;
        Box::new(Stepped {
            arm,
            period: 1.0 / rate,
            pace: Pacer::new(rate, self.clock),
        })
    }
}

struct Stepped<P> {
    arm: P,
    period: f64,
    pace: Pacer,
}

impl<P: SimulatedArm + Send> SteppedArm for Stepped<P> {
    fn step(&mut self, board: &mut Client<Box<dyn Connection>>) -> Result<(), LinkError> {
        for _ in 0..(ROUND / self.period).ceil() as u32 {
            let result = board.tick::<P::Interface>(self.arm.sense())?;
            self.arm.step(&result.command, self.period);
            self.pace.tick();
        }
        Ok(())
    }
}
