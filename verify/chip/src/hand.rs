//! A hand at the simulated arm, which a line of text tells what to do.

use crate::arm::Arm;
use fivebar_files::robot::Robot;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::Hands;
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// A hand. It knows the lengths of the arm that it moves.
pub struct Hand {
    robot: Robot,
    pressed: Hands,
}

impl Hand {
    /// A hand at this arm.
    pub fn new(robot: Robot) -> Self {
        Self {
            robot,
            pressed: Hands::default(),
        }
    }

    /// Does what a line says: `stop 1`, `switch 4 1`, `turn 1 0.785`, `place 2.4 0.7`, `tip 0.04 0.15` or `free`, in
    /// radians and metres; 1 presses, 0 releases.
    ///
    /// # Errors
    /// What is wrong with the line.
    pub fn execute(&mut self, arm: &mut Arm, line: &str) -> Result<(), String> {
        let mut words = line.split_whitespace();
        let name = words.next().unwrap_or_default();
        let numbers: Result<Vec<f64>, _> = words.map(str::parse).collect();
        let numbers = numbers.map_err(|error| format!("{line}: {error}"))?;
        match (name, &numbers[..]) {
            ("stop", [on]) => self.pressed.emergency_stop = *on != 0.0,
            ("switch", [joint, on]) => self.pressed.home[numbered(*joint)] = *on != 0.0,
            ("turn", [joint, by]) => {
                let mut to = Joint::ALL.map(|joint| arm.plant().angle(joint));
                to[numbered(*joint)] += by;
                self.turn(arm, to)?;
            }
            ("place", [theta1, theta4]) => self.turn(arm, [*theta1, *theta4])?,
            ("tip", [x, y]) => {
                let pose = self
                    .robot
                    .geometry
                    .inverse(Vector2::new(*x, *y), self.robot.elbows);
                let angles = pose.map_err(|error| format!("{line}: {error}"))?.angles();
                let to = Joint::ALL.map(|joint| {
                    let (now, angle) = (arm.plant().angle(joint), angles[3 * joint.index()]);
                    angle + ((now - angle) / TAU).round() * TAU
                });
                self.turn(arm, to)?;
            }
            ("free", []) => arm.let_go(),
            _ => {
                return Err(format!(
                    "{line}: a hand does stop, switch, turn, place, tip and free"
                ));
            }
        }
        arm.press(self.pressed);
        Ok(())
    }

    fn turn(&self, arm: &mut Arm, to: [f64; 2]) -> Result<(), String> {
        let home = self.robot.home_pose().map_err(|error| error.to_string())?;
        arm.turn_by_hand(to, self.robot.geometry, home.assembly());
        Ok(())
    }
}

/// Joint 1 or 4 by its number.
fn numbered(number: f64) -> Joint {
    if number > 1.0 {
        Joint::Joint4
    } else {
        Joint::Joint1
    }
}
