//! What a run leaves behind, and where.

use super::failure::{Failure, refused};
use super::log::LogArgs;
use crate::show::export::trace_csv;
use crate::show::files::OutputFolder;
use crate::show::pages::RunReport;
use std::path::PathBuf;

/// Where a run's report goes.
#[derive(clap::Args)]
pub(super) struct OutputArgs {
    /// The folder for report.html, trace.csv and summary.json.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub(super) out: PathBuf,
    #[command(flatten)]
    log: LogArgs,
    /// Print the figures as one JSON object.
    #[arg(long)]
    pub(super) json: bool,
}

/// The folders that a run leaves its files in.
pub(super) struct Folders {
    pub(super) out: OutputFolder,
    /// Kept until the log is in it: an empty one is taken away again.
    _log: Option<OutputFolder>,
}

impl OutputArgs {
    /// Makes sure, before anything is run, that its files can be written.
    pub(super) fn prepare(&self) -> Result<Folders, Failure> {
        Ok(Folders {
            _log: self.log.prepare()?,
            out: OutputFolder::prepare(&self.out, "--out").map_err(refused)?,
        })
    }

    /// Leaves the report, its picture, the trace and the figures in the folder, and the log.
    pub(super) fn leave(
        &self,
        folders: &Folders,
        report: &RunReport<'_>,
        summary: &str,
    ) -> Result<(), Failure> {
        folders
            .out
            .write(&[
                ("report.html", &report.page().render()),
                ("picture.svg", &report.picture().unwrap_or_default()),
                ("trace.csv", &trace_csv(report.trace)),
                ("summary.json", &summary),
            ])
            .map_err(refused)?;
        self.log.leave(report.robot, report.trace)
    }
}
