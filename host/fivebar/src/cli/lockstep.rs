//! The common part of `pil` and `hil`: a run in lockstep with a controller outside this
//! process, compared bit by bit with the same run in this process.

use super::failure::{Failure, refused};
use super::preparing::preparing;
use super::run_args::RunArgs;
use super::say::{say, warn_of_drivers};
use super::sim::{millimetres, outcome, path_lengths, print, progress_bar, refusal};
use fivebar_files::scenario::Scenario;
use fivebar_report::pages::RunReport;
use fivebar_report::text::{conditions, fault_and_next_step};
use fivebar_sim::link::{
    Difference, EmulatedDrives, Instructions, Lockstep, LockstepError, TargetError,
};
use fivebar_sim::machine::Machine;
use fivebar_sim::simulation::{RunError, Simulate, SimulatedArm, Summary, WithArm, with_arm};
use serde::Serialize;
use std::io::{Read, Write};

/// Moves of the demonstration to run by default: less than a minute for an emulator.
const MOVES_OF_THE_DEMONSTRATION: usize = 3;

#[derive(clap::Args)]
pub(super) struct LockstepArgs {
    #[command(flatten)]
    run: RunArgs,
    /// Run only this number of moves from the beginning of the job; by default 3 moves of the
    /// demonstration, or all moves of a named job.
    #[arg(long, value_name = "COUNT")]
    moves: Option<usize>,
}

impl LockstepArgs {
    /// What is run.
    pub(super) fn scenario(&self) -> Result<Scenario, Failure> {
        self.run.scenario()
    }
}

/// The figures of a run in lockstep.
#[derive(Serialize)]
struct LockstepSummary<'a> {
    #[serde(flatten)]
    run: &'a Summary,
    instructions_per_tick: PerTick,
    /// Whether all that goes to the drives, states and estimates have the same bits as in this process.
    bit_exact: bool,
    first_difference: Option<&'a Difference>,
}

/// Instructions of a tick at the other end; 0 if they are not counted.
#[derive(Serialize)]
struct PerTick {
    min: u32,
    mean: f64,
    max: u32,
}

/// The controller at the other end.
pub(super) struct RemoteController<'a> {
    /// Its name in messages.
    pub(super) name: &'a str,
    /// The command that connects to it.
    pub(super) command: &'a str,
    /// The unit in which it measures a tick.
    pub(super) unit: &'a str,
    /// The likely cause of other outputs, or of no reply.
    pub(super) likely_cause: &'a str,
}

impl LockstepArgs {
    /// The greatest number of moves that are executed.
    fn greatest_moves(&self) -> usize {
        let demonstration = !self.run.names_a_job();
        let by_default = demonstration.then_some(MOVES_OF_THE_DEMONSTRATION);
        self.moves.or(by_default).unwrap_or(usize::MAX)
    }
}

/// Runs the job on the controller at the other end of `line`, with the robot's kind of drives.
pub(super) fn run(
    args: &LockstepArgs,
    scenario: &Scenario,
    other: &RemoteController<'_>,
    line: impl FnOnce() -> Result<Box<dyn Connection>, Failure>,
) -> Result<(), Failure> {
    warn_of_drivers(&scenario.robot);
    let run = Run {
        args,
        scenario,
        other,
        line,
    };
    with_arm(scenario, run).map_err(refused)?
}

struct Run<'a, L> {
    args: &'a LockstepArgs,
    scenario: &'a Scenario,
    other: &'a RemoteController<'a>,
    line: L,
}

impl<L: FnOnce() -> Result<Box<dyn Connection>, Failure>> WithArm for Run<'_, L> {
    type Output = Result<(), Failure>;

    fn with<P: SimulatedArm<Interface: EmulatedDrives>>(self, arm: P) -> Self::Output {
        let Self {
            args,
            scenario,
            other,
            line,
        } = self;
        let RemoteController {
            name,
            command,
            unit,
            likely_cause,
        } = other;
        let folders = args.run.output.prepare(command)?;
        let job = preparing("reading and placing", &scenario.job_file, || scenario.job())
            .map_err(refused)?;
        scenario
            .check(&job)
            .map_err(|error| refusal(scenario, &error))?;
        let count = args.greatest_moves();
        let moves = scenario.first_moves(&job, count);
        let moves = moves.map_err(|error| refusal(scenario, &error))?;

        let settings = scenario.robot.settings().map_err(refused)?;
        let (mut lockstep, _) = Lockstep::<_, P::Interface>::begin(line()?, &settings, &settings)
            .map_err(|error| match error {
            LockstepError::Link(_) | LockstepError::Refused(_) => {
                refused(format_args!("{name}: {error}; {likely_cause}"))
            }
            other => refused(format_args!("{name}: {other}")),
        })?;
        let lengths = path_lengths(scenario, &job);
        let last = count.min(lengths.len()).saturating_sub(1);
        let bar = progress_bar(lengths.get(last).copied());
        let ran = scenario.run_arm(&mut lockstep, arm, &moves, &mut |done| {
            bar.set_position(millimetres(done));
        });
        bar.finish_and_clear();
        let (mut summary, record) = ran.map_err(|error| match error {
            RunError::Target(TargetError::Link(_) | TargetError::Unexpected(_)) => {
                refused(format_args!("{name}: {error}; {likely_cause}"))
            }
            other => refusal(scenario, &other),
        })?;
        summary.out_dir = folders.out.path().display().to_string();

        let Instructions { min, max, total } = lockstep.instructions();
        let figures = LockstepSummary {
            run: &summary,
            instructions_per_tick: PerTick {
                min,
                mean: total as f64 / lockstep.ticks().max(1) as f64,
                max,
            },
            bit_exact: lockstep.first_difference().is_none(),
            first_difference: lockstep.first_difference(),
        };
        let stopped = fault_and_next_step(scenario, &record);
        let report = RunReport {
            robot: &scenario.robot,
            job: Some(&job),
            summary: &summary,
            trace: &record.trace,
            pid: None,
            stopped: stopped.as_deref(),
            conditions: &conditions(scenario),
        };
        let text = serde_json::to_string_pretty(&figures).map_err(refused)?;
        args.run.output.write(&folders, &report, &text)?;
        if args.run.output.json {
            say(serde_json::to_string(&figures).map_err(refused)?)?;
        } else {
            let machine = Machine::of(scenario.robot.drive_kind());
            print(&machine, &summary, &record)?;
            print_comparison(&figures, lockstep.ticks(), unit, P::Interface::OUTPUTS)?;
        }
        if let Some(difference) = lockstep.first_difference() {
            return Err(refused(format_args!("{difference}; {likely_cause}")));
        }
        outcome(scenario, &record, &summary.verdict)
    }
}

/// A stream of bytes to a controller.
pub(super) trait Connection: Read + Write {}
impl<L: Read + Write> Connection for L {}

fn print_comparison(
    figures: &LockstepSummary<'_>,
    ticks: u64,
    unit: &str,
    outputs: &str,
) -> Result<(), Failure> {
    let PerTick { min, mean, max } = figures.instructions_per_tick;
    say(format_args!(
        "  tick        {min} to {max} {unit}, {mean:.0} on average"
    ))?;
    if figures.bit_exact {
        say(format_args!(
            "  bit exact   all {outputs}, states and estimates of {ticks} ticks equal those in this \
             process"
        ))?;
    }
    Ok(())
}
