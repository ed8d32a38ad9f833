//! `fivebar drive`: a job on a controller that drives motors.

use super::enter_key::EnterKey;
use super::failure::{Failure, refused};
use super::log::LogArgs;
use super::port::{PortArgs, interrupted};
use super::preparing::preparing;
use super::run_args::JobArgs;
use super::say::{say, warn, warn_of_drivers};
use super::sim::{millimetres, path_lengths};
use fivebar_files::job::Pause;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::{RefusedModeChange, Scenario};
use fivebar_firmware::protocol::Board;
use fivebar_firmware::{Move, Status};
use fivebar_plant::Stepper;
use fivebar_sim::boards::{Facts, Ticks};
use fivebar_sim::drive::{Drive, DriveError, Homing, job_moves};
use fivebar_sim::link::motors_of;
use fivebar_sim::machine::Machine;
use fivebar_sim::simulation::{Sample, Trace};
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::atomic::Ordering;

/// Streams a job to a controller that drives motors; Ctrl-C, and the
/// signals of `kill` and of a terminal that closes, stop the arm on its path and switch the bridges off.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    job: JobArgs,
    #[command(flatten)]
    port: PortArgs,
    /// Store the robot's settings on the controller.
    #[arg(long)]
    upload: bool,
    /// Clear a latched fault first.
    #[arg(long)]
    clear: bool,
    /// Home the arm first, also if the controller knows its place; without this option it homes only an arm whose place
    /// is not known.
    #[arg(long, conflicts_with = "at")]
    home: bool,
    /// Joint angles to which you have turned the arm by hand [rad], in place of homing.
    #[arg(long, value_name = "θ1,θ4", value_parser = super::run_args::point, allow_hyphen_values = true)]
    at: Option<[f64; 2]>,
    #[command(flatten)]
    log: LogArgs,
}

#[expect(
    clippy::too_many_lines,
    reason = "the steps of a job, one after the other"
)]
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if !args.job.names_a_job() {
        return Err(Failure::Usage(
            "give a job: fivebar drive JOB.gcode --port PORT".into(),
        ));
    }
    let scenario = args.job.scenario()?;
    let job =
        preparing("reading and placing", &scenario.job_file, || scenario.job()).map_err(refused)?;
    for warning in &job.warnings {
        warn(format_args!("{}, {warning}", scenario.job_file));
    }
    warn_of_drivers(&scenario.robot);
    let machine = Machine::of(scenario.robot.drive_kind());
    let settings = scenario.robot.settings().map_err(refused)?;
    // Holds for an arm that is to be homed. One that is homed may be in other modes.
    let refused_from_home = scenario.moves(&job).err();

    args.log.prepare()?;
    let interrupted = interrupted()?;
    let (mut client, identity) = args.port.open()?;
    refuse_other(identity.board, &machine)?;
    let wants_stop = || interrupted.load(Ordering::Relaxed);
    let mut drive = Drive::new(&mut client, &wants_stop);
    let lengths = path_lengths(&scenario, &job);
    let length_up_to = |last: Option<&Move>| {
        let line = last.map_or(0, |last| last.tag);
        let steps = job.steps.partition_point(|step| step.line <= line);
        steps.checked_sub(1).map_or(0.0, |last| lengths[last])
    };
    let bar = progress(&lengths);
    let homing = match args.at {
        Some(angles) => Homing::At(angles.map(|angle| angle as f32)),
        None if args.home => Homing::Always,
        None => Homing::IfUnknown,
    };
    let tick_rate = f64::from(settings.control.tick_rate);
    let mut start = None;
    let mut trace = Trace::default();
    let mut moves = Vec::new();
    let mut has_crossed = false;
    let go = || {
        if args.clear {
            drive.clear_fault()?;
        }
        match args.upload {
            true => drive.store_settings(&settings)?,
            false => drive.compare_settings(&settings)?,
        }
        match refused_from_home {
            Some(refusal) if !drive.is_homed()? => return Err(refusal.into()),
            _ => {}
        }
        bar.set_message("homing");
        drive.home(homing)?;
        bar.set_message("");
        let mut planner = drive.planner(&settings)?;
        has_crossed = planner.assembly() != settings.assembly();
        let pauses;
        let planned = drive
            .tool()
            .and_then(|tool| job_moves(&scenario, &job, tool, &mut planner));
        (moves, pauses) = match planned {
            Ok(planned) => planned,
            Err(error) => {
                drive.end_hold()?;
                return Err(error);
            }
        };
        let mut on_progress = |taken: usize, status: &Status| {
            let last = taken.checked_sub(1).and_then(|last| moves.get(last));
            bar.set_position(millimetres(length_up_to(last)));
            let ticks = status.tick.wrapping_sub(*start.get_or_insert(status.tick));
            if let Some(sample) = Sample::reported(status, f64::from(ticks) / tick_rate) {
                trace.push(sample);
            }
        };
        let mut enter = (!pauses.is_empty()).then(|| EnterKey::of_terminal(&bar));
        let mut goes_on = |pause: &Pause| match &mut enter {
            Some(enter) => enter.lets_go_on(pause),
            None => Ok(true),
        };
        drive.follow_with_pauses(&moves, &pauses, &settings, &mut on_progress, &mut goes_on)
    };
    let outcome = go();
    bar.finish_and_clear();
    // A refused job has no samples to log.
    let logged = match trace.samples() {
        [] => Ok(()),
        _ => args.log.write(&scenario.robot, &trace),
    };
    outcome.map_err(|error| refusal(&scenario, error, has_crossed))?;
    let done = moves.len();
    say(format_args!(
        "{}: {done} moves done, bridges off{}",
        scenario.job_file,
        unseen(&scenario.robot)
    ))?;
    logged
}

/// What a controller does not see of a job that it has done.
fn unseen(robot: &Robot) -> &'static str {
    let blind = |motors: [Stepper; 2]| motors.iter().any(|motor| !motor.encoder);
    match robot.steppers().is_some_and(blind) {
        true => {
            "; steppers without encoders do not show lost steps: look whether the drawing is whole"
        }
        false => "",
    }
}

/// Refuses a controller without motors, and one for motors of another kind than the robot's: its settings mean something
/// else.
fn refuse_other(board: Board, machine: &Machine) -> Result<(), Failure> {
    if Facts::of(board).ticks == Ticks::Host {
        let reason = "an emulated board has no motors; run the job on it with `fivebar pil`";
        return Err(Failure::Refused(reason.into()));
    }
    if machine.fits(board) {
        return Ok(());
    }
    Err(refused(format_args!(
        "the controller is for {} and the robot has {}; {}",
        motors_of(board),
        machine.motors,
        machine.image_to_write()
    )))
}

/// A bar as long as the job; `lengths` are those up to each step [m].
fn progress(lengths: &[f64]) -> ProgressBar {
    let length = millimetres(lengths.last().copied().unwrap_or_default());
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len} mm  {elapsed}  {msg}");
    ProgressBar::new(length).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// Why the job is not done, with the line of the job if there is one.
fn refusal(scenario: &Scenario, error: DriveError, has_crossed: bool) -> Failure {
    let (line, reason) = match error {
        DriveError::Move(error) => (error.tag, error.to_string()),
        DriveError::ModeChange(RefusedModeChange { line, error }) => (line, error.to_string()),
        error => return refused(error),
    };
    refused(scenario.named(line, &reason) + way_out(has_crossed))
}

/// What to do about a job that is refused where the arm is.
fn way_out(has_crossed: bool) -> &'static str {
    match has_crossed {
        true => {
            "; the arm is in the other assembly mode since its last crossing: give an --origin with which \
             the job lies in the reach of that, or cross back with M781 first"
        }
        false => "",
    }
}
