//! What a run leaves behind, and where.

use super::failure::{Failure, refused};
use crate::report::{RunReport, write_whole};
use crate::run::{OutputFolder, mcap};
use std::path::PathBuf;

/// Where a run's report goes.
#[derive(clap::Args)]
pub(super) struct OutputArgs {
    /// The folder for report.html, trace.csv and summary.json.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub(super) out: PathBuf,
    /// Also log the run as MCAP, for Foxglove.
    #[arg(long, value_name = "FILE.mcap")]
    log: Option<PathBuf>,
    /// Print the figures as one JSON object.
    #[arg(long)]
    pub(super) json: bool,
}

impl OutputArgs {
    /// Leaves the report, its picture, the trace and the figures in the folder, and the log.
    pub(super) fn leave(
        &self,
        folder: &OutputFolder,
        report: &RunReport<'_>,
        summary: &str,
    ) -> Result<(), Failure> {
        folder
            .write(&[
                ("report.html", &report.page().render()),
                ("picture.svg", &report.picture().unwrap_or_default()),
                ("trace.csv", &report.trace.to_csv()),
                ("summary.json", &summary),
            ])
            .map_err(refused)?;
        if let Some(path) = &self.log {
            let bytes = mcap(report.robot, report.trace).map_err(refused)?;
            write_whole(path, bytes).map_err(refused)?;
        }
        Ok(())
    }
}
