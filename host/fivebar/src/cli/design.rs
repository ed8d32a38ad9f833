//! `fivebar design`: lengths for a wanted work area.

use super::failure::{Failure, refused};
use super::say::{hint, print, say};
use fivebar_design::synthesis::synthesise;
use fivebar_files::design_spec;
use fivebar_report::output::OutputFolder;
use fivebar_report::study::synthesis;
use fivebar_report::text;
use std::io::{IsTerminal, stderr};
use std::path::PathBuf;

/// Searches the lengths of an arm for a wanted work area.
///
/// The specification names the shape of the area, the least dexterity 1/κ in it, limits of the base and
/// of the links' sum, and what is sought: the largest area, or the shortest arm. docs/design/synthesis.md
/// describes it. That the area has no singularity is proved by interval arithmetic.
#[derive(clap::Args)]
pub(super) struct Args {
    /// What is wanted of the arm.
    #[arg(value_name = "SPEC.toml")]
    specification: PathBuf,
    /// Also write DIR/best.toml, a robot file with lengths in whole millimetres.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// The seed of the search; the same seed gives the same answer.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print the answer as one JSON object.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let specification = design_spec::read(&args.specification).map_err(refused)?;
    let folder = args.out.as_ref();
    let folder = folder.map(|path| OutputFolder::prepare(path, "--out").map_err(refused));
    let folder = folder.transpose()?;
    let shows_progress = stderr().is_terminal();
    let progress = |share: f64| {
        if shows_progress {
            hint(format_args!("\rsearching: {:3.0} %", 100.0 * share));
        }
    };
    let found = synthesise(&specification, args.seed, &progress);
    if shows_progress {
        hint("\r                \r");
    }
    let found = found
        .map_err(|error| refused(format_args!("{}: {error}", args.specification.display())))?;
    if let Some(folder) = &folder {
        let stem = args.specification.file_stem().unwrap_or_default();
        let robot = synthesis::robot_file(&stem.to_string_lossy(), &found.whole);
        let robot = robot.map_err(refused)?;
        folder.write(&[("best.toml", &robot)]).map_err(refused)?;
    }
    if args.json {
        let mut answer = synthesis::answer(&found);
        if let Some(folder) = &folder {
            answer["out_dir"] = folder.path().display().to_string().into();
        }
        return say(answer);
    }
    print(text::synthesis(&found))?;
    match &folder {
        Some(folder) => say(format_args!(
            "wrote {}",
            folder.path().join("best.toml").display()
        )),
        None => Ok(()),
    }
}
