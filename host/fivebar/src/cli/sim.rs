//! `fivebar sim`: a job on the simulated arm under the production control loop.

use super::failure::{Failure, refused};
use super::output::OutputArgs;
use super::preparing::preparing;
use super::repeat::{Compared, RepeatArgs, print as print_runs};
use super::run_args::RunArgs;
use super::say::{say, warn, warn_of_drivers};
use fivebar_files::job::Job;
use fivebar_files::scenario::Scenario;
use fivebar_report::pages::RunReport;
use fivebar_report::text::{self, conditions, fault_and_next_step, not_drawn, quantity};
use fivebar_sim::machine::{Machine, Signal};
use fivebar_sim::simulation::{
    CauseError, Record, RunError, ServoLimits, Simulate, Summary, TipError, Verdict,
};
use indicatif::{ProgressBar, ProgressStyle};

/// Simulates a job from power-up to its end and writes a report.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    run: RunArgs,
    /// Run the job also with each mismatch of the scenario alone, and show the error by cause.
    #[arg(long, conflicts_with = "repeat")]
    by_cause: bool,
    #[command(flatten)]
    repeat: RepeatArgs,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let scenario = args.run.scenario()?;
    simulate(&scenario, &args.run.output, args.by_cause, &args.repeat)
}

/// Runs a scenario, once more with PID at each joint for comparison, and on demand with each mismatch
/// alone or several times; writes and prints the results.
pub(super) fn simulate(
    scenario: &Scenario,
    output: &OutputArgs,
    by_cause: bool,
    repeat: &RepeatArgs,
) -> Result<(), Failure> {
    let folders = output.prepare("sim")?;
    let job =
        preparing("reading and placing", &scenario.job_file, || scenario.job()).map_err(refused)?;
    for warning in &job.warnings {
        warn(format_args!("{}, {warning}", scenario.job_file));
    }
    scenario
        .check(&job)
        .map_err(|error| refusal(scenario, &error))?;
    warn_of_drivers(&scenario.robot);
    let bar = progress_bar(path_lengths(scenario, &job).last().copied());
    let progress = &mut |done| bar.set_position(millimetres(done));
    let compared = match repeat.runs() {
        Some(_) => repeat.run(scenario, &job, &folders, progress),
        None => run_once(scenario, &job, progress),
    };
    bar.finish_and_clear();
    let Compared {
        mut summary,
        record,
        pid,
    } = compared?;
    summary.out_dir = folders.out.path().display().to_string();
    summary.pid_tip_error = pid.as_ref().map(|(pid, _)| pid.tip_error);
    if by_cause {
        let causes = scenario.by_cause(&job, &summary);
        summary.by_cause = causes.map_err(|error| refusal(scenario, &error))?;
    }
    let text = serde_json::to_string_pretty(&summary).map_err(refused)?;
    let stopped = fault_and_next_step(scenario, &record);
    let report = RunReport {
        robot: &scenario.robot,
        job: Some(&job),
        summary: &summary,
        trace: &record.trace,
        pid: pid
            .as_ref()
            .map(|(summary, record)| (summary, &record.trace)),
        stopped: stopped.as_deref(),
        conditions: &conditions(scenario),
    };
    output.write(&folders, &report, &text)?;
    if output.json {
        say(serde_json::to_string(&summary).map_err(refused)?)?;
    } else {
        print(&Machine::of(scenario.robot.drive_kind()), &summary, &record)?;
        print_runs(&summary)?;
    }
    outcome(scenario, &record, &summary.verdict)
}

fn run_once(
    scenario: &Scenario,
    job: &Job,
    progress: &mut (dyn FnMut(f64) + Send),
) -> Result<Compared, Failure> {
    let (ours, pid) = rayon::join(
        || scenario.simulate(job, progress),
        || {
            let pid = scenario.under_pid();
            pid.map(|pid| pid.simulate(job, &mut |_| ()))
        },
    );
    let (summary, record) = ours.map_err(|error| refusal(scenario, &error))?;
    Ok(Compared {
        summary,
        record,
        // PID may fail where computed torque does not; then there is no comparison.
        pid: pid.and_then(Result::ok),
    })
}

pub(super) fn refusal(scenario: &Scenario, error: &RunError) -> Failure {
    refused(text::refusal(scenario, error))
}

/// A run whose job was not drawn has failed, with the reason.
pub(super) fn outcome(
    scenario: &Scenario,
    record: &Record,
    verdict: &Verdict,
) -> Result<(), Failure> {
    not_drawn(scenario, record, verdict).map_or(Ok(()), |reason| Err(refused(reason)))
}

/// The length of the path at the end of each step, from home on [m].
pub(super) fn path_lengths(scenario: &Scenario, job: &Job) -> Vec<f64> {
    let robot = &scenario.robot;
    let home = robot.home_pose().map(|home| robot.tool_at(&home));
    job.path_lengths(home.unwrap_or_default())
}

pub(super) fn millimetres(metres: f64) -> u64 {
    (1e3 * metres) as u64
}

/// A bar for a path of this length [m].
pub(super) fn progress_bar(length: Option<f64>) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len} mm  {elapsed}");
    // The bar is visible on a terminal only.
    ProgressBar::new(millimetres(length.unwrap_or_default()))
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

pub(super) fn print(machine: &Machine, summary: &Summary, record: &Record) -> Result<(), Failure> {
    let Summary {
        robot, scenario, ..
    } = summary;
    say(format_args!("{robot} draws {scenario}"))?;
    if let Some(time) = summary.job_s {
        say(format_args!("  job         {time:.3} s"))?;
    }
    say(format_args!(
        "  simulated   {:.3} s in {} ({} times real time), with homing",
        summary.simulated_s,
        quantity(summary.wall_s, "s"),
        summary.speed()
    ))?;
    if record.begun.is_some() {
        print_verdict(&summary.verdict)?;
        print_errors(summary)?;
    }
    for CauseError {
        cause,
        tip_error,
        faults,
    } in &summary.by_cause
    {
        let [rms, max] = [tip_error.rms_m, tip_error.max_m].map(|error| quantity(error, "m"));
        let fault = faults.first().map(|fault| format!(", fault: {fault}"));
        say(format_args!(
            "    {cause:<18}{rms} RMS, {max} max{}",
            fault.unwrap_or_default()
        ))?;
    }
    let [torque1, torque4] = summary.peak_torque_nm.map(|torque| quantity(torque, "N·m"));
    let share = summary.torque_share.map_or_else(String::new, |share| {
        format!(", {:.0} % of the {}", 100.0 * share, machine.torque_limit)
    });
    let limited = match machine.shows.contains(&Signal::Current) {
        true => format!(", limited in {} ticks", summary.saturated_ticks),
        // A controller of drives that follow a motion limits none.
        false => String::new(),
    };
    say(format_args!(
        "  torque      {torque1} and {torque4} max{share}{limited}"
    ))?;
    if let Some([lost1, lost4]) = summary.lost_steps {
        say(format_args!("  lost steps  {lost1} and {lost4} full steps"))?;
    }
    if let Some(ServoLimits {
        dead_band_m,
        late_s,
    }) = summary.hobby_servos
    {
        let [dead_band, late] = [quantity(dead_band_m, "m"), quantity(late_s, "s")];
        say(format_args!(
            "  servos      dead band {dead_band} with a straight leg, late by up to {late}; docs/verify/hobby-servos.md"
        ))?;
    }
    let stride = record.trace.stride();
    if stride > 1 {
        say(format_args!(
            "  trace       one tick in {stride} is kept, to bound the memory"
        ))?;
    }
    say(format_args!(
        "  report      {}/report.html",
        summary.out_dir
    ))?;
    Ok(())
}

fn print_verdict(verdict: &Verdict) -> Result<(), Failure> {
    let [worst, allowed] =
        [verdict.worst_m, verdict.tolerance_m].map(|length| quantity(length, "m"));
    let drawn = if verdict.drawn { "yes" } else { "no" };
    say(format_args!(
        "  drawn       {drawn}: the tip was up to {worst} from its place while it drew, {allowed} allowed"
    ))
}

fn print_errors(summary: &Summary) -> Result<(), Failure> {
    let figures = |error: TipError| {
        let [rms, max] = [error.rms_m, error.max_m].map(|error| quantity(error, "m"));
        format!("{rms} RMS, {max} max")
    };
    say(format_args!("  tip error   {}", figures(summary.tip_error)))?;
    say(format_args!(
        "  placed      {}, after the best shift and turn",
        figures(summary.tip_error_placed)
    ))?;
    let Some(pid) = summary.pid_tip_error else {
        return Ok(());
    };
    let ratio = summary.ratio_to(pid);
    let ratio = ratio.map(|ratio| format!(" ({ratio:.1}×)"));
    say(format_args!(
        "  joint PID   {}{}",
        figures(pid),
        ratio.unwrap_or_default()
    ))
}
