//! Scenario files: read with their robot and job, or refused; a short one is checked as a run
//! would check it.
#![no_main]

use fivebar_files::scenario::Scenario;
use fivebar_sim::simulation::Simulate;
use libfuzzer_sys::fuzz_target;
use std::path::PathBuf;
use std::sync::LazyLock;

/// A folder with the job that most scenarios name.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("fivebar-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let job = "G21 G90 F600\nG0 X0 Y0\nG1 X10 Y0\nG2 X20 Y0 I5 J0\nM2\n";
    std::fs::write(folder.join("job.gcode"), job).expect("a file");
    folder
});

fuzz_target!(|bytes: &[u8]| {
    // A device may never end, or wait for somebody.
    if bytes
        .windows(4)
        .any(|four| four == b"/dev" || four == b"proc")
    {
        return;
    }
    let path = FOLDER.join("scenario.toml");
    std::fs::write(&path, bytes).expect("a file");
    if let Ok(scenario) = Scenario::load(&path.to_string_lossy())
        && let Ok(job) = scenario.job()
    {
        let _ = scenario.check(&job);
        let _ = scenario.plant();
    }
});
