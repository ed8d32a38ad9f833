//! The duties of the production image equal those of the controller in this process, to within
//! the rounding of a compare register, for the same samples.

mod bench;

use bench::{Bench, Driven, robot, settings};
use fivebar::run::link::{InProcess, Target};
use fivebar_chip::time::{MILLISECOND, Time};
use fivebar_chip::{Options, Tick};
use fivebar_firmware::protocol::{HostCommand, Reply};
use fivebar_firmware::{Move, MoveKind, Request};

/// Counts of half a PWM period.
const FULL: f32 = 4200.0;
/// Ticks before the bridges are enabled that the controller here sees, too: its observers settle.
const BEFORE: usize = 300;

/// Whether the controller here, which gets this request in front of tick `at` and this move so
/// many ticks later, gives the same duties up to tick `end`: the first tick that differs.
fn first_difference(
    ticks: &[Tick],
    at: usize,
    end: usize,
    requests: &[Request],
    offered: Option<(usize, Move)>,
) -> Option<(usize, [i32; 2], [i32; 2])> {
    let mut here = InProcess::new(&settings()).expect("valid settings");
    for number in at - BEFORE..end {
        if number == at {
            for &request in requests {
                here.request(request).expect("accepted");
            }
        }
        if let Some((after, offered)) = &offered
            && number == at + after
        {
            assert!(here.offer(offered).expect("a valid move"));
        }
        let (command, _) = here.tick(&ticks[number].sample).expect("a tick");
        // The registers are preloaded, and seen up to the tick after that.
        let Some(seen) = ticks.get(number + 2).filter(|seen| seen.enabled) else {
            continue;
        };
        if command.enable != [true; 2] {
            continue;
        }
        let duty = command.duty.map(|duty| (duty * FULL).round() as i32);
        let differs = (0..2).any(|joint| (duty[joint] - seen.duty[joint]).abs() > 1);
        if number >= at && differs {
            return Some((number - at, duty, seen.duty));
        }
    }
    None
}

/// The tick in which the bridges are enabled first, from `from` on.
fn enabled_at(ticks: &[Tick], from: usize) -> usize {
    // A record shows what was so up to its tick.
    let enabled = ticks[from..].iter().position(|tick| tick.enabled);
    from + enabled.expect("enabled") - 1
}

fn run(driven: &mut Driven, time: Time) {
    for _ in 0..time / (20 * MILLISECOND) {
        driven.run(20 * MILLISECOND);
        driven.status();
    }
}

#[test]
fn homing_gives_the_duties_of_the_controller_in_this_process() {
    let mut driven = Bench::with(Options::default(), Vec::new(), 0).ready();
    run(&mut driven, 60 * MILLISECOND);
    driven.request(Request::Home).expect("homing");
    run(&mut driven, 400 * MILLISECOND);
    let ticks = std::mem::take(&mut driven.arm.get().ticks);
    let at = enabled_at(&ticks, 0);
    let end = ticks.len() - 2;
    assert!(end - at > 3000);
    assert_eq!(
        first_difference(&ticks, at, end, &[Request::Home], None),
        None
    );
}

#[test]
fn a_line_gives_the_duties_of_the_controller_in_this_process() {
    let mut driven = Bench::with(Options::default(), Vec::new(), 0).ready();
    run(&mut driven, 60 * MILLISECOND);
    let angles = driven.arm();
    let held = driven.arm.get().ticks.len();
    let [x, y] = robot().best_point().expect("a point").map(|x| x as f32);
    let kind = MoveKind::Line {
        to: [x, y],
        feed: 0.3,
    };
    let line = Move { tag: 1, kind };
    let reply = driven
        .client
        .call(HostCommand::Move(line))
        .expect("an answer");
    assert!(matches!(reply, Reply::Taken { .. }), "{reply:?}");
    run(&mut driven, 300 * MILLISECOND);
    let ticks = std::mem::take(&mut driven.arm.get().ticks);
    let at = enabled_at(&ticks, 0);
    let end = ticks.len() - 2;
    let requests = [Request::SetAngles(angles), Request::Arm];
    // The move arrives a little after it was sent.
    let sent = held - at;
    let differences: Vec<_> = (sent..sent + 30)
        .map(|after| first_difference(&ticks, at, end, &requests, Some((after, line))))
        .collect();
    let agreed = differences
        .iter()
        .filter(|difference| difference.is_none())
        .count();
    let latest = differences.iter().flatten().max_by_key(|(tick, ..)| *tick);
    assert_eq!(agreed, 1, "the last to differ: {latest:?}");
}
