//! `fivebar design`: lengths for a wanted work area.

use super::failure::{Failure, refused};
use super::say::{hint, print, say};
use fivebar_design::synthesis::{Study, Synthesis, SynthesisError};
use fivebar_files::design_spec;
use fivebar_report::output::{OutputFolder, write_whole};
use fivebar_report::pages::synthesis_files;
use fivebar_report::study::synthesis::{self, SEARCHES, known_searches, searches_text};
use fivebar_report::text;
use std::fs;
use std::io::{IsTerminal, stderr};
use std::path::PathBuf;
use std::sync::Mutex;

/// Searches the lengths of an arm for a wanted work area.
///
/// The specification names the shape of the area, the least dexterity 1/κ in it, limits of the base and
/// of the links' sum, and what is sought: the largest area, the shortest arm,
/// the least torque or error, the greatest dexterity, speed or stiffness. docs/design/synthesis.md
/// describes it. That the area has no singularity is proved by interval arithmetic.
#[derive(clap::Args)]
pub(super) struct Args {
    /// What is wanted of the arm.
    #[arg(value_name = "SPEC.toml")]
    specification: PathBuf,
    /// Also write DIR/report.html with the arms and their front, DIR/best.toml, a robot file with lengths in
    /// stock, and DIR/front-2.toml and so on. Each search that is done is kept in
    /// DIR/searches.json: the same command goes on from there.
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
    let study = Study::new(&specification, args.seed);
    let found = searched(&study, folder.as_ref())
        .map_err(|error| refused(format_args!("{}: {error}", args.specification.display())))?;
    if let Some(folder) = &folder {
        let stem = args.specification.file_stem().unwrap_or_default();
        let files = synthesis_files(&stem.to_string_lossy(), &specification, &found);
        let files = files.map_err(refused)?;
        let files: Vec<(&str, &dyn AsRef<[u8]>)> = files
            .iter()
            .map(|(name, text)| (&**name, text as _))
            .collect();
        folder.write(&files).map_err(refused)?;
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
            "wrote report.html, best.toml{} to {}",
            if found.front.len() > 1 {
                " and the arms of the front"
            } else {
                ""
            },
            folder.path().display()
        )),
        None => Ok(()),
    }
}

/// Searches, goes on from what DIR has of the same study, and keeps each result there.
fn searched(study: &Study, folder: Option<&OutputFolder>) -> Result<Synthesis, SynthesisError> {
    let file = folder.map(|folder| folder.path().join(SEARCHES));
    let text = file.as_ref().and_then(|file| fs::read_to_string(file).ok());
    let known = text.and_then(|text| known_searches(study, &text));
    let known = known.unwrap_or_else(|| vec![None; study.searches()]);
    let shows_progress = stderr().is_terminal();
    let all = Mutex::new(known.clone());
    let found = study.run(&known, &|index, found| {
        let Ok(mut all) = all.lock() else { return };
        all[index] = Some(*found);
        if let (Some(file), Ok(text)) = (&file, searches_text(study, &all)) {
            // Without the file the search only cannot go on from here.
            let _ = write_whole(file, text);
        }
        if shows_progress {
            let done = all.iter().flatten().count();
            hint(format_args!(
                "\rsearching: {done} of {} searches",
                all.len()
            ));
        }
    });
    if shows_progress {
        hint("\r                                   \r");
    }
    found
}
