//! The log of a run, for Foxglove.

use super::failure::{Failure, refused};
use super::say::leave_output_to;
use fivebar_files::robot::Robot;
use fivebar_report::output::OutputFolder;
use fivebar_report::output::write_whole;
use fivebar_sim::simulation::Trace;
use std::path::PathBuf;

/// The option for the log of a run.
#[derive(clap::Args)]
pub(super) struct LogArgs {
    /// Also write a log of the run as MCAP, for Foxglove; `-` for the standard output. The program
    /// must be built with `--features mcap`.
    #[arg(long, value_name = "FILE.mcap")]
    log: Option<PathBuf>,
}

impl LogArgs {
    /// Makes sure, before the run, that the log can be written.
    pub(super) fn prepare(&self) -> Result<(), Failure> {
        let Some(log) = &self.log else {
            return Ok(());
        };
        if !cfg!(feature = "mcap") {
            return Err(refused(WITHOUT_MCAP));
        }
        leave_output_to(log);
        if log.is_dir() {
            return Err(refused(format!(
                "--log {} is a folder; give a file in it",
                log.display()
            )));
        }
        let folder = OutputFolder::prepare_for(log, "--log");
        folder.map(drop).map_err(refused)
    }

    /// Writes the log of a run, if the option is given.
    pub(super) fn write(&self, robot: &Robot, trace: &Trace) -> Result<(), Failure> {
        let Some(path) = &self.log else {
            return Ok(());
        };
        write_whole(path, mcap(robot, trace)?).map_err(refused)
    }
}

/// Why a build without the feature `mcap` refuses a log.
const WITHOUT_MCAP: &str =
    "--log: this program was built without MCAP; build it with `--features mcap`";

#[cfg(feature = "mcap")]
fn mcap(robot: &Robot, trace: &Trace) -> Result<Vec<u8>, Failure> {
    fivebar_report::export::mcap(robot, trace).map_err(refused)
}

#[cfg(not(feature = "mcap"))]
fn mcap(_: &Robot, _: &Trace) -> Result<Vec<u8>, Failure> {
    Err(refused(WITHOUT_MCAP))
}
