//! `fivebar clearance`: a job on the new arm and with worn joints.

use super::failure::{Failure, refused};
use super::length::{place, positive_length};
use super::run_args::scale;
use super::say::{say, warn};
use super::value_error::ValueError;
use fivebar_files::job::PETAL;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_report::output::OutputFolder;
use fivebar_report::pages;
use fivebar_report::study::clearance::{ClearanceStudy, NAMES, Outcome, answer, study};
use fivebar_report::text::conditions;
use fivebar_report::text::quantity;
use fivebar_sim::simulation::Simulate;
use indicatif::ProgressBar;
use std::path::{Path, PathBuf};

/// Simulates a job with worn joints: impacts, forces and errors against the new arm.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A robot file, or the name of a built-in robot.
    file: String,
    /// A scenario, whose robot is replaced by FILE, or a job (`-` for the standard input); by default a
    /// petal of two arcs.
    #[arg(value_name = "SCENARIO.toml|JOB.gcode")]
    job: Option<String>,
    /// Radial clearances, one run for each, such as 20um,50um; by default the robot's `clearance_radius`.
    #[arg(long, value_name = "LENGTH,…", allow_hyphen_values = true, value_delimiter = ',', value_parser = positive_length)]
    radius: Vec<f64>,
    /// The joints that wear; the others stay ideal.
    #[arg(long, value_name = "A,B,…", value_delimiter = ',', value_parser = joint, default_value = "A,B,C,D,E")]
    joints: Vec<usize>,
    /// Position of the job's (0, 0) in the frame of the base [m].
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    origin: Option<[f64; 2]>,
    /// Metres in the plane per metre in the job.
    #[arg(long, value_parser = scale, allow_hyphen_values = true)]
    scale: Option<f64>,
    /// The folder for report.html and summary.json.
    #[arg(long, value_name = "DIR", default_value = "out/clearance")]
    out: PathBuf,
    /// Print the figures as one JSON object.
    #[arg(long)]
    json: bool,
}

fn joint(text: &str) -> Result<usize, ValueError> {
    let wanted = text.trim();
    let found = NAMES
        .iter()
        .position(|name| name.eq_ignore_ascii_case(wanted));
    found.ok_or(ValueError::Joint)
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let scenario = scenario(args)?;
    let clearances = clearances(args, &scenario.robot)?;
    let folder = OutputFolder::prepare(&args.out, "--out").map_err(refused)?;
    let job = scenario.job().map_err(refused)?;
    for warning in &job.warnings {
        warn(format_args!("{}, {warning}", scenario.job_file));
    }
    scenario.check(&job).map_err(refused)?;
    let bar = ProgressBar::new(clearances.len() as u64 + 1);
    let study = study(&scenario, &job, &clearances, &|| bar.inc(1)).map_err(refused)?;
    bar.finish_and_clear();
    let mut figures = answer(&study);
    figures["out_dir"] = folder.path().display().to_string().into();
    let page = pages::clearance(&study, &conditions(&scenario));
    let text = serde_json::to_string_pretty(&figures).map_err(refused)?;
    folder
        .write(&[("report.html", &page.render()), ("summary.json", &text)])
        .map_err(refused)?;
    if args.json {
        say(&figures)?;
    } else {
        print(&study, folder.path())?;
    }
    outcome(&study)
}

fn scenario(args: &Args) -> Result<Scenario, Failure> {
    let robot = Robot::load(&args.file).map_err(refused)?;
    let mut scenario = match &args.job {
        None => Scenario::new("petal", robot, "the petal job", PETAL.into()),
        Some(path) if Path::new(path).extension().is_some_and(|e| e == "toml") => Scenario {
            robot,
            ..Scenario::load(path).map_err(refused)?
        },
        Some(path) => Scenario::of_job(path, robot).map_err(refused)?,
    };
    scenario.origin = args.origin.or(scenario.origin);
    scenario.scale = args.scale.unwrap_or(scenario.scale);
    Ok(scenario)
}

/// The clearances of all joints for each run.
fn clearances(args: &Args, robot: &Robot) -> Result<Vec<[f64; 5]>, Failure> {
    let worn = |radii: [f64; 5]| {
        std::array::from_fn(|k| {
            if args.joints.contains(&k) {
                radii[k]
            } else {
                0.0
            }
        })
    };
    if !args.radius.is_empty() {
        return Ok(args.radius.iter().map(|&r| worn([r; 5])).collect());
    }
    let clearance = worn(robot.tolerance.clearance_radius);
    if clearance == [0.0; 5] {
        return Err(refused(format_args!(
            "{}: the joints have no clearance: give `clearance_radius` in [tolerance], or \
             --radius in metres",
            args.file
        )));
    }
    Ok(vec![clearance])
}

fn print(study: &ClearanceStudy, folder: &Path) -> Result<(), Failure> {
    say(format_args!("{}: {}", study.robot, study.scenario))?;
    for outcome in &study.outcomes {
        print_one(outcome)?;
    }
    say(format_args!(
        "  report      {}/report.html",
        folder.display()
    ))?;
    Ok(())
}

fn print_one(outcome: &Outcome) -> Result<(), Failure> {
    let joints = &outcome.record.joints.total;
    let clearance = outcome.largest_clearance();
    let name = if clearance > 0.0 {
        format!("clearance of {}", quantity(clearance, "m"))
    } else {
        "new".into()
    };
    say(format_args!("  {name}"))?;
    let error = outcome.summary.tip_error;
    say(format_args!(
        "    tip error   {} RMS, {} max; added by clearance {} RMS, {} max",
        quantity(error.rms_m, "m"),
        quantity(error.max_m, "m"),
        quantity(outcome.added.rms_m, "m"),
        quantity(outcome.added.max_m, "m")
    ))?;
    say(format_args!(
        "    by the pins {} RMS, {} max; predicted: {} in equilibrium, {} worst case",
        quantity(outcome.by_pins.rms_m, "m"),
        quantity(outcome.by_pins.max_m, "m"),
        quantity(outcome.prediction.seated, "m"),
        quantity(outcome.prediction.worst, "m")
    ))?;
    let [torque1, torque4] = outcome.summary.peak_torque_nm;
    say(format_args!(
        "    torque      {} and {} max",
        quantity(torque1, "N·m"),
        quantity(torque4, "N·m")
    ))?;
    let forces = joints.map(|joint| quantity(joint.peak_force, "N"));
    say(format_args!(
        "    reactions   {} max, A to E",
        forces.join(", ")
    ))?;
    if clearance > 0.0 {
        let flight = outcome
            .flight_share()
            .map(|share| format!("{:.0} %", 100.0 * share));
        say(format_args!(
            "    impacts     {}; without contact {} of the time, A to E",
            joints.map(|joint| joint.impacts.to_string()).join(", "),
            flight.join(", ")
        ))?;
    }
    Ok(())
}

/// A failure if a fault ended a run; the report is written all the same.
fn outcome(study: &ClearanceStudy) -> Result<(), Failure> {
    let faulted = study.outcomes.iter().find_map(|outcome| {
        let fault = outcome.summary.faults.first()?;
        Some((outcome.largest_clearance(), fault))
    });
    faulted.map_or(Ok(()), |(clearance, fault)| {
        Err(refused(format_args!(
            "with a clearance of {} the arm stopped with a fault, {fault}; see the report",
            quantity(clearance, "m")
        )))
    })
}
