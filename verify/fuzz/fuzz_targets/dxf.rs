//! DXF drawings: they are read or refused, and their strokes are finite lines.
#![no_main]

use fivebar_files::job::{Job, JobOptions, Placement};
use libfuzzer_sys::fuzz_target;

const PLACEMENT: Placement = Placement {
    origin: [0.0, 0.13],
    scale: 1.0,
    turn: 0.0,
    home: [0.04, 0.18],
};

fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    // What has no sections is the content of that of the entities.
    let text = match text.starts_with("0\nSECTION") {
        true => text.into_owned(),
        false => format!("0\nSECTION\n2\nENTITIES\n{text}\n0\nENDSEC\n0\nEOF\n"),
    };
    match Job::parse_with(&text, &PLACEMENT, &JobOptions::default()) {
        Ok(job) => {
            let ends = job.steps.iter().filter_map(|step| step.action.end());
            assert!(ends.flatten().all(f64::is_finite) && !job.steps.is_empty());
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
