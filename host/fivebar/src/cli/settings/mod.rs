//! `fivebar settings` and `fivebar clear`: what a controller stores, without moving the arm.

mod text;

use super::failure::{Failure, refused};
use super::port::{PortArgs, PortClient};
use super::say::{leave_output_to, say};
use fivebar_files::robot::Robot;
use fivebar_files::text_file;
use fivebar_firmware::Settings;
use fivebar_report::output::write_new;
use fivebar_sim::drive::Drive;
use fivebar_sim::simulation::fault_name;
use std::path::{Path, PathBuf};

/// Shows, saves and sends the settings of a controller. Nothing moves.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(clap::Subcommand)]
enum Action {
    /// Prints the settings in use, with units.
    Show {
        #[command(flatten)]
        port: PortArgs,
    },
    /// Writes the settings in use to a file, which `upload --settings` sends again.
    Download {
        #[command(flatten)]
        port: PortArgs,
        /// The file to write.
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
    /// Sends settings to the controller, which checks, uses and stores them; it must then be homed.
    Upload {
        #[command(flatten)]
        port: PortArgs,
        /// The robot whose settings are sent: a built-in one or a robot file.
        #[arg(
            long,
            required_unless_present = "settings",
            conflicts_with = "settings"
        )]
        robot: Option<String>,
        /// A file that `download` has written.
        #[arg(long, value_name = "FILE")]
        settings: Option<PathBuf>,
    },
}

/// Clears the fault that a controller has latched. Nothing moves.
#[derive(clap::Args)]
pub(super) struct ClearArgs {
    #[command(flatten)]
    port: PortArgs,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    match &args.action {
        Action::Show { port } => {
            let text = download(&mut port.open()?.0)?;
            say(text.trim_end())
        }
        Action::Download { port, out } => {
            leave_output_to(out);
            let text = download(&mut port.open()?.0)?;
            write_new(out, text.as_bytes()).map_err(refused)?;
            say(format_args!(
                "the controller's settings are in {}",
                out.display()
            ))
        }
        Action::Upload {
            port,
            robot,
            settings,
        } => {
            let (new, from) = match (robot, settings) {
                (Some(robot), _) => (of_robot(robot)?, robot.clone()),
                (None, Some(file)) => (of_file(file)?, file.display().to_string()),
                // The command line demands one of them.
                (None, None) => return Err(Failure::Usage("give --robot or --settings".into())),
            };
            let (mut client, _) = port.open()?;
            let mut before = new;
            client.read_settings(&mut before).map_err(refused)?;
            Drive::new(&mut client, &|| false)
                .store_settings(&new)
                .map_err(refused)?;
            let what = if before == new {
                "no value changed"
            } else {
                "home the arm before it moves"
            };
            say(format_args!(
                "the controller uses and stores the settings of {from}; {what}"
            ))
        }
    }
}

pub(super) fn clear(args: &ClearArgs) -> Result<(), Failure> {
    let (mut client, _) = args.port.open()?;
    let (status, _) = client.status().map_err(refused)?;
    let Some(fault) = status.fault else {
        return say("no fault is latched");
    };
    Drive::new(&mut client, &|| false)
        .clear_fault()
        .map_err(refused)?;
    say(format_args!(
        "cleared fault {}: {}",
        fault.number(),
        fault_name(fault)
    ))
}

fn download(client: &mut PortClient) -> Result<String, Failure> {
    let mut theirs = Settings::BENCHTOP;
    client.read_settings(&mut theirs).map_err(refused)?;
    text::write(&theirs).map_err(refused)
}

fn of_robot(robot: &str) -> Result<Settings, Failure> {
    let robot = Robot::load(robot).map_err(refused)?;
    robot.settings().map_err(refused)
}

fn of_file(file: &Path) -> Result<Settings, Failure> {
    let shown = file.display();
    let text = text_file::read_text(file, text_file::LARGEST_TOML)
        .map_err(|error| refused(format_args!("cannot read {shown}: {error}")))?;
    let new = text::parse(&text).map_err(|error| refused(format_args!("{shown}: {error}")))?;
    let faults = new.faults();
    if faults.is_empty() {
        return Ok(new);
    }
    let lines: Vec<_> = faults
        .iter()
        .map(|fault| format!("{shown}: {fault}"))
        .collect();
    Err(refused(lines.join("\n")))
}
