//! A new arm: the few values that define it, and the robot file made from them.

use super::draft_motors::{Motor, Motors};
use super::proposed_limits::proposed;
use super::sections::Limits;
use super::{Robot, template};
use crate::refusal::Key;
use crate::source::FileError;
use fivebar_firmware::settings::SettingsError;
use std::fmt;

/// Ratios of the arm in docs/use/robot-file.md: crank to base, coupler to crank, and the mass of
/// cranks and couplers per length [kg/m].
const CRANK_PER_BASE: f64 = 1.25;
const COUPLER_PER_CRANK: f64 = 1.6;
const CRANK_DENSITY: f64 = 0.7;
const COUPLER_DENSITY: f64 = 0.3;
/// Acceleration of gravity [m/s²].
const GRAVITY: f64 = 9.81;

/// A new arm. Pairs are of leg 1 and leg 4.
#[derive(Clone, Debug, PartialEq)]
pub struct Draft {
    /// Its name.
    pub name: String,
    /// Whether its plane is vertical; else it is horizontal.
    pub upright: bool,
    /// Distance from A to E [m].
    pub base: f64,
    /// Lengths of links 1 and 4 [m].
    pub cranks: [f64; 2],
    /// Lengths of links 2 and 3 [m].
    pub couplers: [f64; 2],
    /// Masses of links 1 and 4 [kg].
    pub crank_masses: [f64; 2],
    /// Masses of links 2 and 3 [kg].
    pub coupler_masses: [f64; 2],
    /// Point mass at C [kg].
    pub payload: f64,
    /// What turns its joints.
    pub motors: Motors,
    /// Bus voltage [V].
    pub voltage: f64,
    /// Torque of a holding brake at each joint [N·m]; none: what the arm needs.
    pub brake_torque: Option<f64>,
}

/// Why the arm of a draft cannot be simulated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DraftError(String);

impl fmt::Display for DraftError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Draft {
    /// An arm with the size and the motors of the benchtop arm.
    pub fn new(name: &str) -> Self {
        let mut draft = Self {
            name: name.into(),
            upright: false,
            base: 0.0,
            cranks: [0.0; 2],
            couplers: [0.0; 2],
            crank_masses: [0.0; 2],
            coupler_masses: [0.0; 2],
            payload: 0.03,
            motors: Motors::Brushed(Motor::TYPICAL),
            voltage: 24.0,
            brake_torque: None,
        };
        draft.set_base(0.08);
        draft
    }

    /// Sets the base [m], and the links from it; coaxial cranks (base 0) keep their links.
    pub fn set_base(&mut self, base: f64) {
        self.base = base;
        if base > 0.0 {
            self.set_cranks([tidy(CRANK_PER_BASE * base); 2]);
        }
    }

    /// Sets links 1 and 4 [m], and from them their masses and the couplers, which become long
    /// enough to meet across the base.
    pub fn set_cranks(&mut self, cranks: [f64; 2]) {
        self.cranks = cranks;
        self.crank_masses = cranks.map(|length| tidy(CRANK_DENSITY * length));
        self.set_couplers(cranks.map(|length| tidy((COUPLER_PER_CRANK * length).max(self.base))));
    }

    /// Sets links 2 and 3 [m], and their masses from them.
    pub fn set_couplers(&mut self, couplers: [f64; 2]) {
        self.couplers = couplers;
        self.coupler_masses = couplers.map(|length| tidy(COUPLER_DENSITY * length));
    }

    /// The robot file.
    pub fn text(&self) -> String {
        let header = format!(
            "# {}: made by `fivebar new`. Keys that are commented out have these default values.\n\
             # com and inertia are those of slender rods: replace them by those of your links.\n\n",
            self.name.escape_debug()
        );
        let mut values = self.values();
        values.extend(self.angles());
        header + &template::filled(&values)
    }

    /// Its angle limits and its home, if its links have a pose there.
    fn angles(&self) -> Vec<(Key, String)> {
        let links = Self {
            motors: Motors::Ideal,
            ..self.clone()
        };
        let robot = Robot::parse(&self.name, &template::filled(&links.values())).ok();
        let Some((robot, proposal)) = robot.and_then(|it| proposed(&it).map(|found| (it, found)))
        else {
            return Vec::new();
        };
        let limits = |limits: [[f64; 2]; 2]| (Key::In("limits", "angle"), format!("{limits:?}"));
        match &self.motors {
            // A servo needs no room to search for a switch.
            Motors::HobbyServos(motor) => {
                vec![limits(motor.within_travel(proposal.limits, robot.home))]
            }
            _ => vec![
                limits(proposal.limits),
                (Key::Top("home"), format!("{:?}", proposal.home)),
            ],
        }
    }

    /// Checks the robot file and the controller's settings that follow from it.
    ///
    /// # Errors
    /// The first value that is not valid.
    pub fn check(&self) -> Result<Robot, DraftError> {
        let robot = Robot::parse(&self.name, &self.text())
            .map_err(|FileError { reason, .. }| DraftError(reason))?;
        let settings = robot
            .settings()
            .map_err(|error| DraftError(error.to_string()))?;
        settings.check().map_err(|error| match error {
            SettingsError::NoPose => DraftError(
                "with both elbows outwards, the arm has no pose outside the singularity margin: \
                 make the couplers longer"
                    .into(),
            ),
            other => DraftError(other.to_string()),
        })?;
        Ok(robot)
    }

    /// Torque of the holding brakes [N·m].
    pub fn brake(&self) -> f64 {
        self.brake_torque.unwrap_or_else(|| self.needed_brake())
    }

    /// Torque [N·m] that holds an upright arm in any pose: all its mass at the end of a
    /// straight leg.
    fn needed_brake(&self) -> f64 {
        if !self.upright {
            return 0.0;
        }
        let mass: f64 = self.payload
            + [self.crank_masses, self.coupler_masses]
                .concat()
                .iter()
                .sum::<f64>();
        let reach = [0, 1].map(|leg| self.cranks[leg] + self.couplers[leg]);
        tidy(GRAVITY * mass * reach[0].max(reach[1]))
    }

    fn values(&self) -> Vec<(Key, String)> {
        let gravity = if self.upright { -GRAVITY } else { 0.0 };
        let mut values = vec![
            (
                Key::Top("name"),
                toml::Value::from(self.name.as_str()).to_string(),
            ),
            (Key::Top("gravity"), format!("[0.0, {gravity:?}]")),
            (Key::Top("base"), format!("{:?}", self.base)),
            (Key::Top("payload"), format!("{:?}", self.payload)),
            (Key::In("supply", "voltage"), format!("{:?}", self.voltage)),
        ];
        let ([l1, l4], [l2, l3]) = (self.cranks, self.couplers);
        let ([m1, m4], [m2, m3]) = (self.crank_masses, self.coupler_masses);
        for (index, (length, mass)) in [(l1, m1), (l2, m2), (l3, m3), (l4, m4)]
            .into_iter()
            .enumerate()
        {
            // The inertia of a slender rod about its middle is m l²/12.
            for (name, value) in [
                ("length", format!("{length:?}")),
                ("mass", format!("{mass:?}")),
                ("com", format!("[{:?}, 0.0]", tidy(0.5 * length))),
                (
                    "inertia",
                    format!("{:?}", tidy(mass * length * length / 12.0)),
                ),
            ] {
                values.push((Key::Of("link", index, name), value));
            }
        }
        let usual = Limits::default().max_speed[0];
        if let Some(most) = self.motors.max_speed(self.voltage).filter(|&it| it < usual) {
            // Not above it, whatever the last digit.
            let most = tidy(0.999 * most);
            let speeds = format!("[{most:?}, {most:?}]");
            values.push((Key::In("limits", "max_speed"), speeds));
        }
        values.extend(self.motors.limits());
        for index in 0..2 {
            let motor = self.motors.values(index);
            let is_driven = !motor.is_empty();
            for (name, value) in motor {
                values.push((Key::Of("actuator", index, name), value));
            }
            if is_driven {
                let torque = format!("{:?}", self.brake());
                values.push((Key::Of("actuator", index, "brake_torque"), torque));
            }
        }
        values
    }
}

/// A number rounded to four significant digits.
pub(super) fn tidy(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
