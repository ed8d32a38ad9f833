//! What a run leaves behind, and where.

use super::failure::{Failure, refused};
use crate::report::{RunReport, write_whole};
use crate::run::{OutputFolder, mcap};
use std::path::{Path, PathBuf};

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

/// The folders that a run leaves its files in.
pub(super) struct Folders {
    pub(super) out: OutputFolder,
    /// Kept until the log is in it: an empty one is taken away again.
    _log: Option<OutputFolder>,
}

impl OutputArgs {
    /// Makes sure, before anything is run, that its files can be written.
    pub(super) fn prepare(&self) -> Result<Folders, Failure> {
        let folder = |path: &Path, option| OutputFolder::prepare(path, option).map_err(refused);
        let log_folder = |log: &PathBuf| match log.parent() {
            _ if log.is_dir() => Err(refused(format!(
                "--log {} is a folder; name a file in it",
                log.display()
            ))),
            Some(parent) if !parent.as_os_str().is_empty() => folder(parent, "--log"),
            _ => folder(Path::new("."), "--log"),
        };
        Ok(Folders {
            _log: self.log.as_ref().map(log_folder).transpose()?,
            out: folder(&self.out, "--out")?,
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
