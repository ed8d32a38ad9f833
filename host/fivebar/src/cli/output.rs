//! The files that a run writes.

use super::failure::{Failure, refused};
use super::log::LogArgs;
use fivebar_report::export::trace_csv;
use fivebar_report::output::OutputFolder;
use fivebar_report::pages::RunReport;
use std::path::PathBuf;

/// The options for the results of a run.
#[derive(clap::Args)]
pub(super) struct OutputArgs {
    /// The folder for report.html, trace.csv and summary.json, which replace what has these names there, symbolic links
    /// too; by default out/ with the name of the command.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    log: LogArgs,
    /// Print the figures as one JSON object.
    #[arg(long)]
    pub(super) json: bool,
}

/// The folders for the files of a run.
pub(super) struct Folders {
    pub(super) out: OutputFolder,
}

impl OutputArgs {
    /// Makes sure, before the run, that its files can be written.
    /// `command` names the folder if no other is given.
    pub(super) fn prepare(&self, command: &str) -> Result<Folders, Failure> {
        let out = self.out.clone();
        let out = out.unwrap_or_else(|| PathBuf::from("out").join(command));
        self.log.prepare()?;
        Ok(Folders {
            out: OutputFolder::prepare(&out, "--out").map_err(refused)?,
        })
    }

    /// Writes the report, its picture, the trace, the figures and the log.
    pub(super) fn write(
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
        self.log.write(report.robot, report.trace)
    }
}
