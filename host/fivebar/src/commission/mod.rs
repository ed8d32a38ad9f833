//! The commissioning of an arm: from a new arm to one that knows itself, step by step. The program's
//! command and the live page run it.

mod bench;
mod finding;
mod line;
mod log;
mod observer;
mod operator;
mod question;
mod record;
mod simulated;
mod steps;

pub(super) use finding::StepError;
pub(super) use operator::Output;
pub(super) use record::Done;
pub(super) use steps::{Step, named, names};

use bench::Bench;
use fivebar_files::robot::{Robot, measured_text, text_of, today};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::Request;
use fivebar_firmware::protocol::HostCommand;
use fivebar_firmware::safety::State;
use fivebar_sim::link::{Client, LinkError, SerialLine, motors_of};
use fivebar_sim::machine::Machine;
use line::{Line, Stoppable};
use operator::Operator;
use record::Record;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Which arm is commissioned, and where the record is.
#[derive(Clone, Debug)]
pub(super) struct Options {
    /// The controller's serial port, or `simulated`.
    pub(super) port: String,
    /// A robot file, or the name of a built-in robot.
    pub(super) robot: String,
    /// How a simulated arm differs from the robot file.
    pub(super) scenario: Option<String>,
    /// The folder of the record.
    pub(super) out: PathBuf,
    /// Holes that were touched before.
    pub(super) points: Option<PathBuf>,
}

/// A commissioning in progress.
pub(super) struct Commissioning {
    /// Those of its drives.
    steps: &'static [Step],
    bench: Bench,
    record: Record,
    /// The robot file with what was measured so far, and its name.
    text: String,
    file: String,
    /// Ends the exchange with the controller while it is true.
    stop: Arc<AtomicBool>,
}

impl Commissioning {
    /// Opens the record and connects to the controller. While `stop` is true, whatever a step does fails.
    ///
    /// # Errors
    /// Files that cannot be read or do not belong together, or no connection.
    pub(super) fn open(
        options: &Options,
        output: Box<dyn Output>,
        stop: Arc<AtomicBool>,
    ) -> Result<Self, StepError> {
        let drawing = text_of(&options.robot).map_err(StepError::other)?;
        let drawn = Robot::load(&options.robot).map_err(StepError::other)?;
        let (steps, machine) = (
            steps::of(drawn.drive_kind()),
            Machine::of(drawn.drive_kind()),
        );
        if steps.is_empty() {
            return Err(StepError::Other(format!(
                "robot `{}` has {}, and there are no steps for these yet",
                drawn.name, machine.motors
            )));
        }
        let record = Record::open(&options.out, &options.robot, &drawing)?;
        let text = record.robot_text()?.unwrap_or(drawing);
        let file = record.robot_path().display().to_string();
        let robot = Robot::parse(&file, &text).map_err(StepError::other)?;
        if robot.actuators.is_none() {
            return Err(StepError::Other(format!(
                "robot `{}` has no [[actuator]]: an arm with motors needs both",
                robot.name
            )));
        }
        let (line, operator) = connect(options, &drawn, output)?;
        let line: Box<dyn Line> = Box::new(Stoppable::new(line, Arc::clone(&stop)));
        let (client, identity) = Client::open(line)?;
        if !machine.fits(identity.board) {
            return Err(StepError::Other(format!(
                "the controller is for {} and the robot has {}: {}",
                motors_of(identity.board),
                machine.motors,
                machine.image_to_write()
            )));
        }
        let mut bench = Bench::new(client, operator, drawn, robot, options.points.clone())?;
        bench.holes_file = record.holes_path();
        bench.placement = record.placement();
        Ok(Self {
            steps,
            bench,
            record,
            text,
            file,
            stop,
        })
    }

    /// The steps, in their order.
    pub(super) fn steps(&self) -> &'static [Step] {
        self.steps
    }

    /// The place of a step in their order.
    ///
    /// # Errors
    /// Arms with other drives have it.
    pub(super) fn place(&self, name: &str) -> Result<usize, StepError> {
        let place = self.steps.iter().position(|step| step.name == name);
        place.ok_or_else(|| {
            let names: Vec<&str> = self.steps.iter().map(|step| step.name).collect();
            StepError::Other(format!(
                "this arm has no step {name}; its steps are {}",
                names.join(", ")
            ))
        })
    }

    /// Forgets this step and those after it.
    ///
    /// # Errors
    /// Arms with other drives have it.
    pub(super) fn forget_from(&mut self, again: &str) -> Result<(), StepError> {
        let from = self.place(again)?;
        let names: Vec<&str> = self.steps[from..].iter().map(|step| step.name).collect();
        self.record.forget_from(&names);
        Ok(())
    }

    /// What a step found, if it is done.
    pub(super) fn done(&self, step: &str) -> Option<&Done> {
        self.record.done(step)
    }

    /// Which files of the commissioning there are, for the user.
    pub(super) fn files(&self) -> String {
        self.record.files()
    }

    /// The first step that is not done.
    pub(super) fn next(&self) -> Option<&'static Step> {
        self.steps
            .iter()
            .find(|step| self.done(step.name).is_none())
    }

    /// Clears a fault of before and sends the settings, before the first step.
    ///
    /// # Errors
    /// The emergency stop is pressed, or the controller refuses the settings.
    pub(super) fn prepare(&mut self) -> Result<(), StepError> {
        self.bench.clear_and_upload()
    }

    /// Switches the bridges off, after a stop has ended what a step did.
    ///
    /// # Errors
    /// The controller does not reply.
    pub(super) fn switch_off(&mut self) -> Result<(), StepError> {
        self.stop.store(false, Ordering::Release);
        let stop = HostCommand::Request(Request::EmergencyStop);
        // The first one may have the number of the command that the stop broke off: a controller takes it
        // for a repetition then, and what it replies is the reply to that command.
        match self.bench.client.command(stop) {
            Ok(_) | Err(LinkError::UnexpectedReply { .. }) => {}
            Err(error) => return Err(error.into()),
        }
        self.bench.client.command(stop)?.map_err(StepError::other)
    }

    /// Switches the bridges off if a step that failed has left them on.
    ///
    /// # Errors
    /// The controller does not reply.
    pub(super) fn switch_off_if_on(&mut self) -> Result<(), StepError> {
        match self.bench.client.status()?.0.state {
            State::Stopped => Ok(()),
            _ => self.bench.request(Request::EmergencyStop),
        }
    }

    /// Does a step, and writes what it found.
    ///
    /// # Errors
    /// What is wrong, and what to change.
    pub(super) fn run(&mut self, step: &Step) -> Result<(), StepError> {
        let bench = &mut self.bench;
        bench.operator.begin_step(step.name);
        let outcome = (step.run)(bench).inspect_err(|_| bench.report_fault());
        if let Some(observed) = bench.operator.observed()? {
            self.record.write_simulated(&observed)?;
        }
        let outcome = outcome?;
        let new = match &outcome.measured[..] {
            [] => None,
            values => Some(
                measured_text(&self.file, &self.text, values).map_err(|error| {
                    StepError::Other(format!(
                        "the measured values make no valid robot file: {error}"
                    ))
                })?,
            ),
        };
        if let Some(picture) = &outcome.picture {
            self.record.draw(step.name, picture)?;
        }
        let done = Done {
            step: step.name.into(),
            date: today(),
            found: outcome.found,
            values: outcome.values,
            in_robot_file: new.is_some(),
            left_out: outcome.left_out,
        };
        self.record.add(done, new.as_deref())?;
        bench.placement = self.record.placement();
        if let Some(new) = new {
            bench.robot = Robot::parse(&self.file, &new).map_err(StepError::other)?;
            bench.upload()?;
            self.text = new;
        }
        Ok(())
    }
}

fn connect(
    options: &Options,
    drawn: &Robot,
    mut output: Box<dyn Output>,
) -> Result<(Box<dyn Line>, Operator), StepError> {
    if options.port != "simulated" {
        if options.scenario.is_some() {
            return Err(StepError::other("--scenario is for --port simulated"));
        }
        let line = SerialLine::open(&options.port).map_err(StepError::other)?;
        return Ok((Box::new(line), Operator::new(output, None)));
    }
    let scenario = match &options.scenario {
        Some(file) => Scenario::load(file).map_err(StepError::other)?,
        None => Scenario::demonstration(drawn.clone()),
    };
    let arm = &scenario.robot.name;
    if *arm != drawn.name {
        output.report(&format!(
            "the scenario's arm is `{arm}`, the robot file is of `{}`: if that is not meant, start \
             with --robot {arm} and another --out",
            drawn.name
        ))?;
    }
    let (line, actions) = simulated::arm(&scenario, drawn)?;
    Ok((line, Operator::new(output, Some(actions))))
}
