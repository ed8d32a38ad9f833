//! The log of a run, for Foxglove.

use super::failure::{Failure, refused};
use crate::input::robot::Robot;
use crate::run::simulation::Trace;
use crate::show::export::mcap;
use crate::show::files::OutputFolder;
use crate::show::files::write_whole;
use std::path::{Path, PathBuf};

/// Where a run's log goes.
#[derive(clap::Args)]
pub(super) struct LogArgs {
    /// Also log the run as MCAP, for Foxglove.
    #[arg(long, value_name = "FILE.mcap")]
    log: Option<PathBuf>,
}

impl LogArgs {
    /// Makes sure, before anything is run, that the log can be written. The folder is to be
    /// kept until the log is in it: an empty one is taken away again.
    pub(super) fn prepare(&self) -> Result<Option<OutputFolder>, Failure> {
        let Some(log) = &self.log else {
            return Ok(None);
        };
        if log.is_dir() {
            return Err(refused(format!(
                "--log {} is a folder; name a file in it",
                log.display()
            )));
        }
        let parent = log.parent().filter(|parent| !parent.as_os_str().is_empty());
        let folder = OutputFolder::prepare(parent.unwrap_or(Path::new(".")), "--log");
        folder.map(Some).map_err(refused)
    }

    /// Leaves the log of a run, if one is asked for.
    pub(super) fn leave(&self, robot: &Robot, trace: &Trace) -> Result<(), Failure> {
        let Some(path) = &self.log else {
            return Ok(());
        };
        let bytes = mcap(robot, trace).map_err(refused)?;
        write_whole(path, bytes).map_err(refused)
    }
}
