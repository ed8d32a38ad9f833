//! Random jobs on the emulated board: every output has the bits of this process.

use crate::jobs::{RandomJob, robots};
use crate::number;
use fivebar::run::link::{Emulator, Lockstep, Target, TargetError};
use fivebar::run::simulation::RunError;
use fivebar_firmware::controller::Request;
use fivebar_firmware::{ActuatorCommand, Move, SensorSample, Status};

/// Ticks between two lines of progress.
const PROGRESS: u64 = 10_000;
/// The reason with which a run ends when all ticks have run.
const ENOUGH: &str = "all ticks of the soak have run";

/// A board that runs a number of ticks and compares each with this process.
struct Limited {
    board: Lockstep<Emulator>,
    /// Ticks before this run, and in all.
    before: u64,
    wanted: u64,
}

impl Target for Limited {
    fn tick(&mut self, sample: &SensorSample) -> Result<(ActuatorCommand, Status), TargetError> {
        let ticks = self.before + self.board.ticks();
        if ticks >= self.wanted {
            return Err(TargetError::Unexpected(ENOUGH.into()));
        }
        let outputs = self.board.tick(sample)?;
        assert_eq!(self.board.first_difference(), None);
        if ticks % PROGRESS == PROGRESS - 1 {
            println!("{} ticks", ticks + 1);
        }
        Ok(outputs)
    }

    fn request(&mut self, request: Request) -> Result<(), TargetError> {
        self.board.request(request)
    }

    fn offer(&mut self, next: &Move) -> Result<bool, TargetError> {
        self.board.offer(next)
    }

    fn is_idle(&self) -> bool {
        self.board.is_idle()
    }
}

/// `SOAK_TICKS` ticks over all arms, from `SOAK_SEED` on.
#[test]
#[ignore = "minutes; scripts/soak.sh runs it"]
fn random_jobs_on_the_emulated_board_have_the_bits_of_this_process() {
    let wanted = number("SOAK_TICKS", 10_000);
    let first = number("SOAK_SEED", 1);
    let robots = robots();
    let (mut ticks, mut seed, mut most) = (0, first, 0);
    let [mut done, mut faults, mut refused, mut cut] = [0; 4];
    while ticks < wanted {
        let robot = robots[seed as usize % robots.len()].clone();
        let name = robot.name.clone();
        let settings = robot.settings().expect("it has masses");
        let job = RandomJob::new(robot, seed);
        let board = Emulator::start(&Emulator::built_image("qemu")).expect("an emulated board");
        let begun = Lockstep::begin(board, &settings, &settings);
        let mut limited = Limited {
            board: begun.expect("a run in lockstep").0,
            before: ticks,
            wanted,
        };
        println!("{name}, seed {seed}");
        match job.scenario.run_on(&mut limited, &job.moves, &mut |_| ()) {
            Ok((_, record)) if record.faults.is_empty() => done += 1,
            Ok(_) => faults += 1,
            Err(RunError::Target(TargetError::Move(_))) => refused += 1,
            Err(RunError::Target(TargetError::Unexpected(text))) if text == ENOUGH => cut += 1,
            Err(error) => panic!("{name}, seed {seed}: {error}"),
        }
        ticks += limited.board.ticks();
        most = most.max(limited.board.instructions().max);
        seed += 1;
    }
    println!(
        "seeds {first} to {}: {ticks} ticks bit-exact, {done} jobs done, {faults} ended by a fault, \
         {refused} refused, {cut} cut short; {most} instructions in the longest tick",
        seed - 1
    );
}
