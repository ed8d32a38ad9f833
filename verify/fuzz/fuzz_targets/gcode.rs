//! G-code: it is read or refused, and its moves are numbers that a planner takes or refuses.
#![no_main]

use fivebar_files::job::{Job, Placement};
use fivebar_firmware::{Planner, Settings};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    let placement = Placement {
        origin: [0.04, 0.18],
        scale: 1.0,
        turn: 0.0,
        home: [0.04, 0.18],
    };
    match Job::parse(&text, &placement) {
        Ok(job) => {
            let settings = Settings::BENCHTOP.check().expect("valid settings");
            let planner = Planner::new(&settings);
            let mut tool = [0.04, 0.18];
            for step in job.moves(0.3) {
                match planner.check(tool, &step) {
                    Ok(end) => tool = end,
                    Err(error) => drop(error.to_string()),
                }
                assert!(tool.iter().all(|metres| metres.is_finite()));
            }
            for step in &job.steps {
                job.draws(step.line);
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
