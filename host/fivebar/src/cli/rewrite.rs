//! A robot file with measured values, the old one kept.

use super::failure::{Failure, refused};
use super::say::{leave_output_to, warn};
use fivebar_files::robot::{Measured, measured_text, text_of};
use fivebar_report::output::{write_new, write_whole};
use std::path::{Path, PathBuf};

/// Writes the file of `robot` with measured values to `out`. A file that is there is kept beside
/// it as FILE.old, FILE.old2, and so on.
pub(super) fn rewrite(robot: &str, out: &Path, values: &[Measured]) -> Result<(), Failure> {
    leave_output_to(out);
    let text = text_of(robot).map_err(refused)?;
    let new = measured_text(robot, &text, values).map_err(|error| {
        refused(format_args!(
            "the measured values make no valid robot file, so nothing is written: {error}"
        ))
    })?;
    if out.exists() {
        let old = std::fs::read(out)
            .map_err(|error| refused(format_args!("{}: {error}", out.display())))?;
        let kept = unused(out);
        write_new(&kept, old).map_err(refused)?;
        warn(format_args!("kept {} as {}", out.display(), kept.display()));
    }
    write_whole(out, new).map_err(refused)
}

fn unused(out: &Path) -> PathBuf {
    let named = |ending: &str| {
        let mut name = out.as_os_str().to_owned();
        name.push(ending);
        PathBuf::from(name)
    };
    let mut kept = named(".old");
    let mut number = 2;
    while kept.exists() {
        kept = named(&format!(".old{number}"));
        number += 1;
    }
    kept
}
