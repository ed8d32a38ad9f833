//! The heights of a pen that a servo lifts: tried while the motors are off, then kept in the robot file.
//!
//! With the motors off a controller holds the tool's output at "up". A trial gives it settings whose "up" is the tried
//! width, so that the servo follows, and needs no message of its own. New settings make the angles unknown: the
//! arm is homed afterwards.

use fivebar_files::robot::{Measured, MeasuredKey};
use fivebar_firmware::Settings;
use fivebar_firmware::protocol::{HostCommand, SectionKey};
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::{CheckedSettings, Field, ToolOutputSettings};
use fivebar_sim::controller::{Session, sentence};
use fivebar_sim::link::LinkError;

/// Writes values to the robot file, whole or not at all; why not, as a sentence.
pub type KeepValues = Box<dyn Fn(&[Measured]) -> Result<(), String> + Send>;

/// What a trial was asked for, or why it is refused, as a sentence.
type Tried = Result<Result<(), String>, LinkError>;

/// A height of the pen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Height {
    Up,
    Down,
}

/// The widths of the servo's pulse that are tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PenTrial {
    /// With the pen up and down [s].
    pub(crate) widths: [f32; 2],
}

impl PenTrial {
    /// A trial that begins with the widths of these settings; why there is none, as a sentence.
    pub(crate) fn of(settings: &Settings) -> Result<Self, String> {
        match settings.tool_output {
            ToolOutputSettings::Servo {
                up_width,
                down_width,
                ..
            } => Ok(Self {
                widths: [up_width, down_width],
            }),
            _ => Err(
                "The arm has no pen with a servo: [tool_output] of its file has another kind."
                    .into(),
            ),
        }
    }

    /// Chooses the width of a height [s], and holds the servo there.
    pub(crate) fn hold(&mut self, session: &mut Session, height: Height, width: f64) -> Tried {
        let [least, most] = Field::ToolPulseWidth.row().range;
        if !(least..=most).contains(&width) {
            let [least, most] = [least, most].map(|bound| 1e3 * bound);
            return Ok(Err(format!(
                "The width of a servo's pulse must be {least} to {most} ms."
            )));
        }
        // As the robot file will have it.
        let width = written(width).parse().unwrap_or(width) as f32;
        let [up, down] = self.widths;
        let (chosen, shown) = match height {
            Height::Up => ([width, down], [width, down]),
            Height::Down => ([up, width], [width, up]),
        };
        let used = use_widths(session, shown)?;
        if used.is_ok() {
            self.widths = chosen;
        }
        Ok(used.map(|_| ()))
    }

    /// Gives the controller its own settings back.
    pub(crate) fn end(session: &mut Session) -> Tried {
        let own = Self::of(&session.settings);
        own.map_or(Ok(Ok(())), |own| {
            Ok(use_widths(session, own.widths)?.map(|_| ()))
        })
    }

    /// Writes the widths to the robot file and has the controller use and store them.
    pub(crate) fn keep(&self, session: &mut Session, write: &KeepValues) -> Tried {
        let settings = match use_widths(session, self.widths)? {
            Ok(settings) => settings,
            Err(why) => return Ok(Err(why)),
        };
        if let Err(why) = write(&self.values()) {
            return Ok(Self::end(session)?.and(Err(why)));
        }
        session.settings = settings;
        // An emulated board in lockstep gets its settings at each start.
        if session.is_in_lockstep() {
            return Ok(Ok(()));
        }
        let stored = session.client.command(HostCommand::SaveSettings)?;
        Ok(stored.map_err(|refusal| {
            format!(
                "The robot file has the heights, the controller's memory has not: start with --upload. {}",
                sentence(&refusal)
            )
        }))
    }

    fn values(&self) -> [Measured; 2] {
        let [up, down] = self.widths;
        [("up_width", up), ("down_width", down)].map(|(key, width)| Measured {
            key: MeasuredKey::ToolOutput(key),
            value: written(f64::from(width)),
            origin: "by trial".into(),
        })
    }
}

/// A width [s] to a hundredth of a millisecond or finer, as text.
fn written(width: f64) -> String {
    format!("{width:.2e}")
}

/// Has the controller use other widths with the pen up and down [s]; the settings, or why it does not. Its servo goes up.
fn use_widths(
    session: &mut Session,
    [up, down]: [f32; 2],
) -> Result<Result<CheckedSettings, String>, LinkError> {
    session.read_status()?;
    if session.status.state != State::Stopped {
        return Ok(Err(
            "The pen is tried with the motors off and no fault latched. The arm is homed afterwards."
                .into(),
        ));
    }
    let mut settings: Settings = *session.settings;
    if let ToolOutputSettings::Servo {
        up_width,
        down_width,
        ..
    } = &mut settings.tool_output
    {
        [*up_width, *down_width] = [up, down];
    }
    let checked = match settings.check() {
        Ok(checked) => checked,
        Err(error) => {
            return Ok(Err(format!(
                "Heights must differ, and their pulses fit a frame: {error}."
            )));
        }
    };
    if let Some(section) = SectionKey::ToolOutput.of(&settings) {
        let put = session.client.command(HostCommand::SetSection(section))?;
        let used = match put {
            Ok(()) => session.client.command(HostCommand::ApplySettings)?,
            refused => refused,
        };
        if let Err(refusal) = used {
            return Ok(Err(sentence(&refusal)));
        }
    }
    // New settings begin with a new count of ticks.
    session.read_status()?;
    Ok(Ok(checked))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fivebar_files::robot::{Robot, measured_text, text_of};
    use fivebar_sim::clock::Clock;
    use fivebar_sim::controller::{ControllerSource, open};
    use fivebar_sim::drive::Drive;
    use std::sync::{Arc, Mutex};

    const PEN: &str = "[tool_output]\nkind = \"servo\"\nup_width = 1.0e-3\ndown_width = 1.5e-3\ndown_time = 0.12\nup_time = 0.08\n";

    const MIT: &str = "\"mit\"\nposition_range = 12.5\nvelocity_range = 640.0\ntorque_range = 2.0";

    /// The width that the controller's servo has with the motors off [s].
    fn held(session: &mut Session) -> f32 {
        let mut settings = *session.settings;
        session.client.read_settings(&mut settings).unwrap();
        assert_eq!(session.status.state, State::Stopped);
        PenTrial::of(&settings).unwrap().widths[0]
    }

    #[test]
    fn the_servo_follows_both_heights_and_the_kept_file_is_what_the_controller_has_with_every_kind_of_drive()
     {
        for name in [
            "benchtop",
            "benchtop_stepper",
            "leg",
            "mit",
            "classroom_servo",
        ] {
            let mut text = match name {
                "mit" => text_of("leg").unwrap().replace("\"odrive\"", MIT),
                _ => text_of(name).unwrap(),
            };
            if !text.contains("[tool_output]") {
                text = format!("{text}\n{PEN}");
            }
            let robot = Robot::parse(name, &text).unwrap();
            let clock = Clock::simulated();
            let (mut session, _) = open(&robot, ControllerSource::Simulated, &clock).unwrap();
            let own = held(&mut session);
            let mut trial = PenTrial::of(&session.settings).unwrap();
            for (height, width) in [(Height::Down, 1.7e-3), (Height::Up, 0.9e-3)] {
                trial.hold(&mut session, height, width).unwrap().unwrap();
                assert_eq!(held(&mut session), width as f32, "{name}: {height:?}");
            }
            // A program that is killed now leaves the tried widths; the next one compares its settings.
            let file = session.settings;
            Drive::new(&mut session, &|| false)
                .compare_settings(&file)
                .unwrap();
            session.read_status().unwrap();
            assert_eq!(held(&mut session), own, "{name}: the next session");
            let unwritten: KeepValues = Box::new(|_| Err("The disk is full.".into()));
            let full = trial.keep(&mut session, &unwritten).unwrap();
            assert_eq!(full, Err("The disk is full.".into()));
            assert_eq!(held(&mut session), own, "{name}: nothing is kept");
            let new = Arc::<Mutex<String>>::default();
            let written = Arc::clone(&new);
            let keep: KeepValues = Box::new(move |values| {
                *written.lock().unwrap() =
                    measured_text("arm", &text, values).map_err(|e| e.to_string())?;
                Ok(())
            });
            trial.keep(&mut session, &keep).unwrap().unwrap();
            let kept = Robot::parse("arm", &new.lock().unwrap()).unwrap();
            assert_eq!(kept.settings().unwrap(), *session.settings, "{name}");
            PenTrial::end(&mut session).unwrap().unwrap();
            assert_eq!(held(&mut session), 0.9e-3, "{name}");
        }
    }
}
