//! Random jobs on every arm in this process; the rules and limits hold in every tick.

use crate::jobs::{RandomJob, robots};
use crate::number;
use crate::watched::Watched;
use fivebar_files::scenario::ControlLaw;
use fivebar_sim::link::TargetError;
use fivebar_sim::simulation::{RunError, Simulate};
use fivebar_stress::limits::Reached;

/// `SOAK_SECONDS` of simulated time on each arm, from `SOAK_SEED` on.
#[test]
fn random_jobs_on_every_arm_keep_the_rules_and_the_limits() {
    keep_the_rules_for(number("SOAK_SECONDS", 1) as f64);
}

#[test]
#[ignore = "half a minute: ./ci.sh tables"]
fn whole_table_of_random_jobs_that_keep_the_rules_and_the_limits() {
    keep_the_rules_for(4.0);
}

/// So many seconds of simulated time on each arm.
fn keep_the_rules_for(seconds: f64) {
    let first = number("SOAK_SEED", 1);
    let mut timed = 0;
    for robot in robots() {
        let settings = robot.settings().expect("it has masses");
        let (mut simulated, mut ticks, mut seed) = (0.0, 0_u64, first);
        let [mut moves, mut done, mut faults, mut refused] = [0; 4];
        let mut reached = Reached::default();
        while simulated < seconds {
            let mut job = RandomJob::new(robot.clone(), seed);
            job.scenario.control_law = ControlLaw::from_key(seed % 8 != 0);
            let controller = job.scenario.controller().expect("a controller");
            let mut target = Watched::new(controller, &settings, &job.moves);
            let outcome = job.scenario.run_on(&mut target, &job.moves, &mut |_| ());
            match outcome {
                Ok((_, record)) if record.faults.is_empty() => done += 1,
                Ok(_) => faults += 1,
                // The arm begins the job some micrometres beside its home.
                Err(RunError::Target(TargetError::Move(_))) => refused += 1,
                Err(error) => panic!("{}, seed {seed}: {error}", robot.name),
            }
            let name = &robot.name;
            assert_eq!(target.broken, None, "{name}, seed {seed}");
            simulated += f64::from(target.ticks) / robot.control.tick_rate;
            ticks += u64::from(target.ticks);
            reached = reached.max(target.reached);
            moves += job.moves.len();
            seed += 1;
        }
        println!(
            "| {} | {first} to {} | {simulated:.0} | {ticks} | {moves} | {done} | {faults} | \
             {refused} | {:.3} / {:.3} / {:.3} | {:.3} / {:.3} |",
            robot.name,
            seed - 1,
            reached.speed,
            reached.acceleration,
            reached.jerk,
            reached.joint_speed,
            reached.joint_acceleration,
        );
        assert!(reached.ticks > 0 && done > 0, "{}", robot.name);
        timed += reached.timed;
    }
    assert!(timed > 0, "some motions are planned by the host");
}
