//! `fivebar plan`: time-optimal motion along a path.

use super::failure::{Failure, refused};
use super::length::place;
use super::say::{say, warn};
use super::value_error::ValueError;
use fivebar_files::path_case::PathCase;
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_report::output::write_in;
use fivebar_report::pages;
use fivebar_report::study::crossing;
use fivebar_report::study::plan::PlanStudy;
use fivebar_report::study::regions;
use fivebar_report::text::quantity;
use fivebar_sim::crossing::{CrossingConditions, follow};
use std::path::{Path, PathBuf};

/// Plans a motion at the limits of the arm: the fastest along a path, or a crossing.
///
/// With --path, the fastest motion that the limits allow. The path file holds a path of lines,
/// arcs and Fourier series, the working mode and the limits of torque, speed and acceleration;
/// docs/design/time-optimal.md describes it. With --crossing, a motion from one assembly mode to the
/// other, along a line through a singularity of type 2, and whether the controller would accept it.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A built-in robot or a robot file; by default the one that the path file names.
    #[arg(long, value_name = "FILE")]
    robot: Option<String>,
    /// The path, its working mode and its limits, in JSON.
    #[arg(long, value_name = "FILE.json", required_unless_present = "crossing")]
    path: Option<PathBuf>,
    /// Plan a crossing of a singularity of type 2, which the robot file must allow.
    #[arg(long, conflicts_with_all = ["path", "torque_share"], requires_all = ["from", "to", "time"])]
    crossing: bool,
    /// Where the crossing begins, such as 20mm,140mm.
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true, requires = "crossing")]
    from: Option<[f64; 2]>,
    /// Where it ends.
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true, requires = "crossing")]
    to: Option<[f64; 2]>,
    /// Its duration [s].
    #[arg(
        long,
        value_name = "T",
        allow_negative_numbers = true,
        requires = "crossing"
    )]
    time: Option<f64>,
    /// Also follow the crossing on the simulated arm, with the declared mismatch.
    #[arg(long, requires = "crossing")]
    simulate: bool,
    /// The share of the torque limits that the plan uses; the rest is kept for feedback.
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = share)]
    torque_share: f64,
    /// Greatest jerk of each joint [rad/s³]; by default none.
    #[arg(long, value_name = "J", value_parser = jerk, allow_negative_numbers = true, conflicts_with = "crossing")]
    jerk: Option<f64>,
    /// Also write DIR/report.html: the phase plane and the torques, or the regions by mode with the
    /// crossing.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the plan as one JSON object.
    #[arg(long)]
    json: bool,
}

pub(super) fn share(text: &str) -> Result<f64, ValueError> {
    let value: f64 = text.parse().map_err(|_| ValueError::Share)?;
    if value > 0.0 && value <= 1.0 {
        Ok(value)
    } else {
        Err(ValueError::Share)
    }
}

fn jerk(text: &str) -> Result<f64, ValueError> {
    let value: f64 = text.parse().map_err(|_| ValueError::Jerk)?;
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(ValueError::Jerk)
    }
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if let Some(path) = &args.path {
        return along_path(args, path);
    }
    let (Some(from), Some(to), Some(time)) = (args.from, args.to, args.time) else {
        return Err(Failure::Usage(
            "give --path, or --crossing with --from, --to, --time".into(),
        ));
    };
    let robot = Robot::load(args.robot.as_deref().unwrap_or(BuiltIn::DEFAULT)).map_err(refused)?;
    let task = crossing::task(&robot, [from, to], time).map_err(refused)?;
    let plan = task.plan().map_err(refused)?;
    let controller = crossing::check_by_controller(&robot, &task, &plan);
    let run = args.simulate.then(|| {
        let conditions = CrossingConditions::default();
        follow(&robot, &task, &plan, &conditions).map_err(refused)
    });
    let run = run.transpose()?;
    if let Some(folder) = &args.out {
        let regions = regions::regions(&robot).map_err(refused)?;
        let page = pages::crossing(&plan, [from, to], task.mode, &regions).render();
        write_in(folder, "report.html", page).map_err(refused)?;
    }
    if args.json {
        return say(crossing::answer(&plan, &controller, run.as_ref()));
    }
    let [before, after] = plan.assembly;
    let [torque1, torque4] = plan.peak_torque;
    say(format_args!(
        "crosses from assembly {before} to {after} at {:.4} s, {:.1} % of the line\n\
         speed {:.4} 1/s and acceleration {:.4} 1/s² along the line there\n\
         peak torque {torque1:.4} and {torque4:.4} N·m",
        plan.t_c,
        100.0 * plan.s_c,
        plan.s_dot_c,
        plan.s_ddot_c,
    ))?;
    match controller {
        Ok(()) => say("the controller accepts it")?,
        Err(refusal) => say(format_args!("the controller refuses it: {refusal}"))?,
    }
    let Some(run) = run else { return Ok(()) };
    say(format_args!(
        "simulated: ends in assembly {}, tip within {} of the plan, {} at the end",
        run.assembly,
        quantity(run.tip_error, "m"),
        quantity(run.end_error, "m"),
    ))?;
    match run.unpowered_at {
        Some(at) => Err(refused(format_args!(
            "the arm was stuck; its torque ended at {at:.4} s"
        ))),
        None => Ok(()),
    }
}

fn along_path(args: &Args, path: &Path) -> Result<(), Failure> {
    let case = PathCase::read(path).map_err(refused)?;
    let named = args.robot.as_deref().or(case.robot.as_deref());
    let robot = Robot::load(named.unwrap_or(BuiltIn::DEFAULT)).map_err(refused)?;
    let study = PlanStudy::new(&robot, &case, args.torque_share, args.jerk).map_err(refused)?;
    if let Some((n, s, joint)) = study.outside(&robot) {
        warn(format_args!(
            "fivebar: warning: {joint} is outside limits.angle from s = {s:.4} of run {n} on; the path \
             file's limits replace the robot's"
        ));
    }
    if let Some(folder) = &args.out {
        let name = case.name.as_deref().unwrap_or("the path");
        let page = pages::plan(&study, name).render();
        write_in(folder, "report.html", page).map_err(refused)?;
    }
    if args.json {
        return say(study.answer());
    }
    for (n, run) in study.runs.iter().enumerate() {
        let (length, time) = (run.length, run.time);
        say(format_args!(
            "run {}: length {length:.6}, {time:.6} s",
            n + 1
        ))?;
    }
    let (share, excess) = (100.0 * study.active_share(), 100.0 * study.limit_excess());
    say(format_args!(
        "motion {:.6} s, planned in {:.2} ms\na limit is above 95 % for {share:.1} % of the time, \
         and passed by {excess:.3} % at most",
        study.time(),
        1e3 * study.planning.as_secs_f64(),
    ))
}
