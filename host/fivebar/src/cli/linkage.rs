//! `fivebar linkage`: motion and forces of a planar linkage.

use super::failure::{Failure, refused};
use super::say::say;
use fivebar_files::linkage::{DrivenLinkage, EXAMPLES};
use fivebar_report::export::linkage_csv;
use fivebar_report::output::write_report;
use fivebar_report::pages;
use fivebar_report::study::linkage::{SHOWN_ASSEMBLIES, Summary, summary};
use std::path::{Path, PathBuf};

/// Computes motion and forces of a planar linkage, dyad by dyad.
///
/// Without FILE, lists the built-in examples. The status is 1 if the linkage never closes.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A linkage in TOML, or the name of an example.
    file: Option<String>,
    /// The folder for report.html, table.csv and summary.json.
    #[arg(long, value_name = "DIR", default_value = "out/linkage")]
    out: PathBuf,
    /// Print the summary as one JSON object.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let Some(file) = &args.file else {
        for example in EXAMPLES {
            say(format_args!("{:<22} {}", example.name, example.summary()))?;
        }
        return Ok(());
    };
    let driven = DrivenLinkage::load(file).map_err(refused)?;
    let sweep = driven.sweep();
    let summary = summary(&driven, &sweep);
    let json = serde_json::json!(summary);
    let report = pages::linkage(&driven, &sweep, &summary).render();
    write_report(
        &args.out,
        &[
            ("report.html", &report),
            ("table.csv", &linkage_csv(&driven, &sweep)),
            ("summary.json", &format!("{json:#}\n")),
        ],
    )
    .map_err(refused)?;
    if args.json {
        say(&json)?;
    } else {
        print(&summary, &args.out)?;
    }
    if summary.closed == 0 {
        return Err(refused(format_args!(
            "{file}: the linkage closes at no instant of the sweep: check `lengths`, the drive's angles and `branch`"
        )));
    }
    Ok(())
}

fn print(summary: &Summary, out: &Path) -> Result<(), Failure> {
    let Summary {
        linkage,
        samples,
        closed,
        ..
    } = summary;
    say(format_args!(
        "{linkage}: closes at {closed} of {samples} samples"
    ))?;
    if let Some(grashof) = &summary.grashof {
        say(format_args!("  Grashof     {grashof}"))?;
    }
    for range in &summary.transmission {
        let (least, greatest) = (range.min, range.max);
        say(format_args!(
            "  {}: transmission angle {least:.2}° to {greatest:.2}°",
            range.of
        ))?;
    }
    for range in &summary.driving {
        let (least, greatest, unit) = (range.min, range.max, range.unit);
        say(format_args!(
            "  {}: drive {least:.4} {unit} to {greatest:.4} {unit}",
            range.of
        ))?;
    }
    for peak in &summary.peak_reactions {
        say(format_args!(
            "  {}: max {:.4} N (at {:.4} s), max {:.4} N·m",
            peak.joint, peak.force_n, peak.time_s, peak.moment_nm
        ))?;
    }
    for limit in &summary.limits {
        let what = if limit.ends { "ends" } else { "begins" };
        say(format_args!(
            "  motion {what} at {:.6} s, inputs {:?} (rad or m): beyond, {}",
            limit.time_s, limit.inputs, limit.reason
        ))?;
    }
    for change in &summary.branch_changes {
        say(format_args!(
            "  {} changes its branch at a dead point before {:.6} s",
            change.dyad, change.time_s
        ))?;
    }
    if summary.assemblies.len() > 1 {
        for assembly in summary.assemblies.iter().take(SHOWN_ASSEMBLIES) {
            let share = 100.0 * assembly.closes;
            say(format_args!(
                "  assembly {}: closes over {share:.0} % of the sweep",
                assembly.branches
            ))?;
        }
    }
    say(format_args!(
        "  report      {}",
        out.join("report.html").display()
    ))?;
    Ok(())
}
