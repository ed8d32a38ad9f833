//! Random jobs on the emulated board: every output has the bits of this process.

use crate::jobs::{RandomJob, robots};
use crate::number;
use crate::replay::{Recorded, replay};
use fivebar_firmware::controller::Request;
use fivebar_firmware::{ActuatorCommand, Move, MoveKind, SensorSample, Status};
use fivebar_sim::link::{Lockstep, Target, TargetError};
use fivebar_sim::simulation::{RunError, Simulate};
use std::time::Instant;

/// The reason with which a run ends when all ticks have run.
const ENOUGH: &str = "all ticks of the soak have run";

/// A recorded run that ends after a number of ticks. Two controllers in this process give the
/// same outputs: one called directly, and one behind the frames that the board gets, too.
struct Limited {
    recorded: Lockstep<Recorded>,
    /// Ticks before this run, and in all.
    before: u64,
    wanted: u64,
    /// Moves that were accepted, and the timed ones among them.
    moves: [u32; 2],
}

impl Target for Limited {
    fn tick(&mut self, sample: &SensorSample) -> Result<(ActuatorCommand, Status), TargetError> {
        if self.before + self.recorded.ticks() >= self.wanted {
            return Err(TargetError::Unexpected(ENOUGH.into()));
        }
        let outputs = self.recorded.tick(sample)?;
        assert_eq!(self.recorded.first_difference(), None);
        Ok(outputs)
    }

    fn request(&mut self, request: Request) -> Result<(), TargetError> {
        self.recorded.request(request)
    }

    fn offer(&mut self, next: &Move) -> Result<bool, TargetError> {
        let taken = self.recorded.offer(next)?;
        let timed = matches!(next.kind, MoveKind::Timed(_));
        self.moves[0] += u32::from(taken);
        self.moves[1] += u32::from(taken && timed);
        Ok(taken)
    }

    fn is_idle(&self) -> bool {
        self.recorded.is_idle()
    }
}

/// What some runs came to.
#[derive(Debug, Default)]
struct Total {
    ticks: u64,
    /// Moves that were accepted, and the timed ones among them.
    moves: [u32; 2],
    /// Jobs that were done, that a fault ended, that were refused, and that were cut short.
    ends: [u32; 4],
    /// The faults, in words.
    faults: Vec<String>,
    /// The most instructions in a tick.
    most: u32,
}

/// Runs of seeds from `first` on, until so many ticks have run on the board.
fn run(first: u64, wanted: u64) -> Total {
    let robots = robots();
    let mut total = Total::default();
    let mut seed = first;
    while total.ticks < wanted {
        let robot = robots[seed as usize % robots.len()].clone();
        let name = robot.name.clone();
        let settings = robot.settings().expect("it has masses");
        let job = RandomJob::new(robot, seed);
        let begun = Lockstep::begin(Recorded::new(), &settings, &settings);
        let mut limited = Limited {
            recorded: begun.expect("a run in lockstep").0,
            before: total.ticks,
            wanted,
            moves: [0; 2],
        };
        let begun = Instant::now();
        let end = match job.scenario.run_on(&mut limited, &job.moves, &mut |_| ()) {
            Ok((_, record)) if record.faults.is_empty() => 0,
            Ok((summary, _)) => {
                total.faults.extend(summary.faults);
                1
            }
            Err(RunError::Target(TargetError::Move(_))) => 2,
            Err(RunError::Target(TargetError::Unexpected(text))) if text == ENOUGH => 3,
            Err(error) => panic!("{name}, seed {seed}: {error}"),
        };
        let simulated = begun.elapsed().as_secs_f64();
        let recorded = limited.recorded.client().line();
        let replayed =
            replay(recorded).unwrap_or_else(|found| panic!("{name}, seed {seed}: {found}"));
        total.ticks += limited.recorded.ticks();
        total.moves = [0, 1].map(|kind| total.moves[kind] + limited.moves[kind]);
        total.ends[end] += 1;
        total.most = total.most.max(replayed.most);
        println!(
            "{name}, seed {seed}: {} {}, {replayed:?}, {} ticks in all; {simulated:.0} s here, \
             {:.0} s on the board",
            ["done", "ended by a fault", "refused", "cut short"][end],
            total
                .faults
                .last()
                .filter(|_| end == 1)
                .map_or("", |fault| fault),
            total.ticks,
            begun.elapsed().as_secs_f64() - simulated,
        );
        seed += 1;
    }
    println!("seeds {first} to {}: {total:?}", seed - 1);
    total
}

#[test]
fn a_random_job_on_the_emulated_board_has_the_bits_of_this_process() {
    let total = run(1, 4000);
    assert_eq!(total.ticks, 4000);
    assert!(total.most <= 1000, "{total:?}");
}

/// `SOAK_TICKS` ticks over all arms, from `SOAK_SEED` on.
#[test]
#[ignore = "minutes; scripts/soak.sh runs it"]
fn random_jobs_on_the_emulated_board_have_the_bits_of_this_process() {
    run(number("SOAK_SEED", 1), number("SOAK_TICKS", 10_000));
}
