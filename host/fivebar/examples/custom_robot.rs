//! A robot of one's own: described in TOML, simulated under the production controller, and
//! plotted to an HTML report and an SVG picture.
//!
//! `cargo run --example custom_robot FOLDER`; without a folder, into target/tmp.

use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_report::html::{Chart, Page};
use fivebar_report::output::OutputFolder;
use fivebar_report::pages::RunReport;
use fivebar_sim::simulation::Simulate;
use std::error::Error;
use std::path::PathBuf;

/// An arm with unlike legs on a level table; ideal torque sources drive it. SI units.
const ROBOT: &str = r#"
name = "my arm"
gravity = [0.0, 0.0]
base = 0.10
payload = 0.02
working_mode = ["right", "left"]
home = [2.6, 0.5]
link = [
    { length = 0.12, mass = 0.08, com = [0.05, 0.0], inertia = 1.4e-4 },
    { length = 0.18, mass = 0.06, com = [0.09, 0.0], inertia = 2.0e-4 },
    { length = 0.17, mass = 0.05, com = [0.08, 0.0], inertia = 1.6e-4 },
    { length = 0.11, mass = 0.08, com = [0.05, 0.0], inertia = 1.2e-4 },
]
"#;

/// A square of 30 mm.
const JOB: &str = "G21 G90 F3000\nG0 X0 Y0\nM3\nG1 X30\nG1 Y30\nG1 X0\nG1 Y0\nM5\n";

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).filter(|_| cfg!(not(test)));
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/tmp/custom_robot");
    let folder = folder.map_or_else(|| PathBuf::from(default), PathBuf::from);

    // A mistake is refused with its line and key.
    let misspelt = ROBOT.replace("payload", "pay_load");
    let error = Robot::parse("my_arm.toml", &misspelt)
        .err()
        .ok_or("it was accepted")?;
    println!("{error}");
    assert_eq!(error.line, Some(5));

    let robot = Robot::parse("my_arm.toml", ROBOT)?;
    let scenario = Scenario::new("a square", robot, "square.gcode", JOB.into());
    let job = scenario.job()?;
    scenario.check(&job)?;
    let (summary, record) = scenario.simulate(&job, &mut |_| ())?;
    let [torque1, torque4] = summary.peak_torque_nm;
    println!(
        "{:.1} µm RMS, {:.1} µm at most; torques up to {torque1:.2} and {torque4:.2} N·m",
        1e6 * summary.tip_error.rms_m,
        1e6 * summary.tip_error.max_m,
    );
    assert!(summary.faults.is_empty(), "{:?}", summary.faults);
    assert!(summary.tip_error.max_m < 0.2e-3);

    // The report of a run, and a page with a chart of one's own.
    let report = RunReport {
        robot: &scenario.robot,
        job: Some(&job),
        summary: &summary,
        trace: &record.trace,
        pid: None,
        stopped: None,
        conditions: &[],
    };
    let samples = record.trace.samples().iter();
    let torques = [0, 1].map(|joint| {
        let points = samples
            .clone()
            .map(|sample| [sample.time, sample.torque[joint]]);
        points.collect::<Vec<_>>()
    });
    let [torque1, torque4] = torques;
    let chart = Chart::new("Torques", "time [s]", "torque [N·m]");
    let chart = chart.line("joint 1", torque1).dashed("joint 4", torque4);
    let mut page = Page::new("The torques of my arm");
    page.chart(&chart);

    let picture = report.picture().ok_or("the run drew nothing")?;
    assert!(picture.starts_with("<svg") && page.render().contains("joint 4"));
    OutputFolder::prepare(&folder, "the folder")?.write(&[
        ("report.html", &report.page().render()),
        ("torques.html", &page.render()),
        ("picture.svg", &picture),
    ])?;
    println!("wrote {}", folder.display());
    Ok(())
}

#[test]
fn an_arm_of_ones_own_draws_a_square() -> Result<(), Box<dyn Error>> {
    main()
}
