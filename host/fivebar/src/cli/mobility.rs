//! `fivebar mobility`: degrees of freedom of a mechanism, with an explanation.

use super::failure::{Failure, refused};
use super::say::say;
use fivebar_files::did_you_mean;
use fivebar_files::mobility::{EXAMPLES, MobilityCase, parse, read};
use fivebar_files::text_file::STANDARD_INPUT;
use fivebar_report::output::write_in;
use fivebar_report::pages;
use fivebar_report::study::mobility::{MobilityAnalysis, analyse, answer};
use fivebar_report::text::explain;
use indicatif::ProgressBar;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::path::PathBuf;

/// Computes degrees of freedom by screw theory, explained step by step.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A mechanism in TOML, a list of cases in JSON, or the name of an example; by default
    /// all examples.
    file: Option<String>,
    /// Print one JSON object per mechanism instead of the explanation.
    #[arg(long)]
    json: bool,
    /// Also write the explanation as DIR/report.html.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let studies = studies(args.file.as_deref())?;
    let bar = ProgressBar::new(studies.len() as u64);
    let studied: Vec<(MobilityCase, MobilityAnalysis)> = studies
        .into_par_iter()
        .map(|study| {
            let analysis = analyse(&study);
            bar.inc(1);
            (study, analysis)
        })
        .collect();
    bar.finish_and_clear();
    if let Some(folder) = &args.out {
        write_in(folder, "report.html", pages::mobility(&studied).render()).map_err(refused)?;
    }
    for (study, analysis) in &studied {
        if args.json {
            say(answer(&study.name, analysis))?;
        } else {
            say(explain(study, analysis))?;
        }
    }
    Ok(())
}

fn studies(file: Option<&str>) -> Result<Vec<MobilityCase>, Failure> {
    let example = |(name, text): &(&str, &str)| {
        let studies = parse(&format!("example {name}"), text);
        studies
            .map(|mut studies| studies.remove(0))
            .map_err(refused)
    };
    let Some(file) = file else {
        return EXAMPLES.iter().map(example).collect();
    };
    if let Some(found) = EXAMPLES.iter().find(|(name, _)| *name == file) {
        return Ok(vec![example(found)?]);
    }
    let path = PathBuf::from(file);
    if file != STANDARD_INPUT && !path.exists() {
        let names: Vec<&str> = EXAMPLES.iter().map(|(name, _)| *name).collect();
        return Err(refused(format_args!(
            "{file}: there is no such file and no such example; the examples are {}{}",
            names.join(", "),
            did_you_mean(file, names.iter().copied())
        )));
    }
    read(&path).map_err(refused)
}
