//! SVG drawings: they are read or refused, and their strokes are lines that a planner takes or
//! refuses.
#![no_main]

use fivebar_files::job::{Action, Job, JobError, JobOptions, Placement};
use fivebar_firmware::{Planner, Settings};
use libfuzzer_sys::fuzz_target;

const PLACEMENT: Placement = Placement {
    origin: [0.0, 0.13],
    scale: 1.0,
    turn: 0.0,
    home: [0.04, 0.18],
};
/// The check of a move takes long, and all moves of a drawing are lines.
const CHECKED_MOVES: usize = 20;

fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    // What is no document of its own is the content of a page.
    let text = if text.starts_with("<?xml") || text.starts_with("<svg") {
        text.into_owned()
    } else {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
             width=\"80mm\" height=\"60mm\" viewBox=\"0 0 80 60\">{text}</svg>"
        )
    };
    // Coarse, so that a circle has few lines.
    let options = JobOptions {
        tolerance: 1e-4,
        ..JobOptions::default()
    };
    let job = match Job::parse_with(&text, &PLACEMENT, &options) {
        Ok(job) => job,
        Err(error) => {
            let is_known = matches!(error, JobError::Drawing(_) | JobError::Format { .. });
            assert!(is_known && !error.to_string().is_empty());
            return;
        }
    };
    assert!(job.is_drawing && job.steps.first().is_some_and(|step| !step.draws()));
    for step in &job.steps {
        let Action::Line { to, .. } = step.action else {
            panic!("{step:?}");
        };
        assert!(to.iter().all(|metres| metres.is_finite()), "{step:?}");
        assert_eq!(job.draws(step.line), step.draws());
    }
    let settings = Settings::BENCHTOP.check().expect("valid settings");
    let planner = Planner::new(&settings);
    let mut tool = [0.04, 0.18];
    for step in job.moves(0.3).take(CHECKED_MOVES) {
        match planner.check(tool, &step) {
            Ok(end) => tool = end,
            Err(error) => drop(error.to_string()),
        }
    }
});
