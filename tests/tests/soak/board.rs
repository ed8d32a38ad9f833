//! Random jobs on the emulated board: every output has the bits of this process.

use crate::jobs::{RandomJob, robots};
use crate::number;
use fivebar::run::link::{Emulator, Lockstep, TargetError};
use fivebar::run::simulation::RunError;

/// `SOAK_TICKS` ticks over all arms, from `SOAK_SEED` on.
#[test]
#[ignore = "minutes; scripts/soak.sh runs it"]
fn random_jobs_on_the_emulated_board_have_the_bits_of_this_process() {
    let wanted = number("SOAK_TICKS", 10_000);
    let first = number("SOAK_SEED", 1);
    let robots = robots();
    let (mut ticks, mut seed, mut most) = (0, first, 0);
    let [mut done, mut faults, mut refused] = [0; 3];
    while ticks < wanted {
        let robot = robots[seed as usize % robots.len()].clone();
        let name = robot.name.clone();
        let settings = robot.settings().expect("it has masses");
        let job = RandomJob::new(robot, seed);
        let board = Emulator::start(&Emulator::built_image("qemu")).expect("an emulated board");
        let (mut lockstep, _) =
            Lockstep::begin(board, &settings, &settings).expect("a run in lockstep");
        match job.scenario.run_on(&mut lockstep, &job.moves, &mut |_| ()) {
            Ok((_, record)) if record.faults.is_empty() => done += 1,
            Ok(_) => faults += 1,
            Err(RunError::Target(TargetError::Move(_))) => refused += 1,
            Err(error) => panic!("{name}, seed {seed}: {error}"),
        }
        assert_eq!(lockstep.first_difference(), None, "{name}, seed {seed}");
        ticks += lockstep.ticks();
        most = most.max(lockstep.instructions().max);
        println!("{name}, seed {seed}: {} ticks", lockstep.ticks());
        seed += 1;
    }
    println!(
        "seeds {first} to {}: {ticks} ticks bit-exact, {done} jobs done, {faults} ended by a fault, \
         {refused} refused; {most} instructions in the longest tick",
        seed - 1
    );
}
