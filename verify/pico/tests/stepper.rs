//! The image for steppers: the edges of its steps, against the desktop's loop and against the emergency stop.

mod bench;

use bench::{Bench, PERIOD};
use fivebar_files::robot::Robot;
use fivebar_firmware::protocol::{Board, HostCommand, Reset};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::{BeltSettings, HomingMethod};
use fivebar_firmware::{Move, MoveKind, Request, Settings};
use fivebar_pico::{HZ, Pulse};
use std::f32::consts::TAU;

/// The unevenness that is allowed: 100 ns.
const JITTER: u64 = HZ / 10_000_000;

/// The robot's settings with as many micro-steps as the board makes at this greatest speed of the joints [rad/s]. The
/// fields do not lead the load: where they do, a joint that stops turns back by its lead, and edges say no place.
fn fastest(speed: f32) -> Bench {
    let robot = Robot::load("benchtop_stepper").expect("a built-in robot");
    let mut settings = robot.settings().expect("settings");
    settings.home_reference.method = HomingMethod::Switch;
    settings.protection.over_speed = 1.02 * speed;
    settings.belts = [BeltSettings::RIGID; 2];
    for axis in &mut settings.axes {
        axis.max_speed = speed;
        axis.encoder_counts =
            (TAU * 199_000.0 / (1.02 * speed * axis.gear_ratio.abs())) as u32 & !0xf;
    }
    Bench::with("rp2350_stepper", robot, settings)
}

/// Its angles are known, and it is armed.
fn armed(speed: f32) -> Bench {
    let mut bench = fastest(speed);
    assert_eq!(bench.line.chip().wires().powered, [false; 2]);
    let start = start(&bench.settings);
    // Only power keeps an arm without encoders where it is: this arms it.
    bench.request(Request::SetAngles(start)).expect("accepted");
    bench.line.chip().run(HZ * 3 / 10).expect("it runs");
    assert_eq!(bench.line.chip().wires().powered, [true; 2]);
    bench
}

fn start(settings: &Settings) -> [f32; 2] {
    settings.axes.each_ref().map(|axis| axis.home_angle)
}

fn go(bench: &mut Bench, by: [f32; 2], speed: f32) {
    let [one, four] = start(&bench.settings);
    let to = [one + by[0], four + by[1]];
    let kind = MoveKind::Joint { to, speed };
    let next = Move {
        tag: 1,
        tool: 0,
        kind,
    };
    bench
        .client
        .call(HostCommand::Move(next))
        .expect("an answer");
}

/// Lets the arm come to rest.
fn finish(bench: &mut Bench) {
    for _ in 0..400 {
        bench.line.chip().run(HZ / 200).expect("it runs");
        let status = bench.status();
        assert_eq!((status.fault, status.missed_ticks), (None, 0));
        if status.state == State::Armed {
            return bench.line.chip().run(HZ / 200).expect("it runs");
        }
    }
    panic!("the arm does not come to rest");
}

/// How far each edge is from its place: those of each tick at (k + 1/2) of its share, in ticks that begin at `phase`.
fn unevenness(edges: &[Pulse], phase: u64, seen: &mut [bool; 21]) -> u64 {
    let ticks = edges
        .iter()
        .map(|edge| ((edge.from - phase) / PERIOD, (edge.from - phase) % PERIOD));
    let ticks: Vec<_> = ticks.collect();
    let mut worst = 0;
    for tick in ticks.chunk_by(|one, next| one.0 == next.0) {
        let count = tick.len() as u64;
        seen[tick.len()] = true;
        for (k, &(_, at)) in (0..).zip(tick) {
            worst = worst.max(((2 * k + 1) * PERIOD / (2 * count)).abs_diff(at));
        }
    }
    worst
}

#[test]
fn every_step_comes_once_evenly_and_with_its_direction_up_to_200_000_in_a_second() {
    let mut bench = armed(8.0);
    assert_eq!(bench.identity.board, Board::Rp2350Stepper);
    assert_eq!(bench.identity.reset, Reset::Power);
    let moves: [(f32, [f32; 2]); 5] = [
        (0.01, [-0.02, 0.02]),
        (0.3, [-0.2, 0.2]),
        (1.0, [-0.5, 0.5]),
        (1.0, [-0.02, 0.02]),
        (0.05, [-0.03, 0.01]),
    ];
    let mut wanted_edges = [0, 0];
    let mut position = [0; 2];
    for (speed, by) in moves {
        go(&mut bench, by, speed);
        finish(&mut bench);
        let before = position;
        position = bench.line.chip().wires().edges;
        for joint in 0..2 {
            let axis = &bench.settings.axes[joint];
            let steps = by[joint] / TAU * axis.gear_ratio * axis.encoder_counts as f32;
            let off = position[joint] - steps.round() as i32;
            assert!(off.abs() <= 1, "{position:?} steps for {steps}");
            wanted_edges[joint] += (position[joint] - before[joint]).unsigned_abs() as usize;
        }
        let sample = bench.client.sample().expect("a line").expect("a sample");
        assert_eq!(sample.counts, position, "the steps that it has counted");
    }
    let mut chip = bench.line.chip();
    let wires = chip.wires();
    let mut seen = [false; 21];
    for (joint, wanted) in wanted_edges.into_iter().enumerate() {
        let edges: Vec<Pulse> = bench::of(&wires.pulses, joint);
        assert_eq!(edges.len(), wanted, "no step back");
        // The ticks of the state machines begin at some cycle.
        let phase = (0..PERIOD)
            .min_by_key(|&phase| unevenness(&edges[..200], phase, &mut [false; 21]))
            .expect("a phase");
        let worst = unevenness(&edges, phase, &mut seen);
        let high = edges.iter().map(|edge| edge.cycles).min().unwrap_or(0);
        let gaps = edges
            .windows(2)
            .map(|pair| pair[1].from - pair[0].from - pair[0].cycles);
        let low = gaps.min().unwrap_or(0);
        let turns = wires.turns.iter().filter(|turn| turn.1 == joint);
        let [mut setup, mut hold] = [u64::MAX; 2];
        for &(at, _) in turns {
            let next = edges.partition_point(|edge| edge.from < at);
            if let Some(edge) = edges.get(next) {
                setup = setup.min(edge.from - at);
            }
            if let Some(edge) = next.checked_sub(1).and_then(|last| edges.get(last)) {
                hold = hold.min(at - edge.from - edge.cycles);
            }
        }
        println!(
            "joint {joint}: {} edges; off by {worst} cycles at most; high {high}, low {low}, setup {setup}, hold {hold}",
            edges.len()
        );
        assert!(worst <= JITTER);
        // 2.4 µs high and low; 5 µs from a direction to a step and 1 µs back, as the slowest driver asks for.
        assert!(high.min(low) >= HZ * 24 / 10_000_000);
        assert!(setup >= HZ * 5 / 1_000_000 && hold >= HZ / 1_000_000);
    }
    let speeds = seen.iter().filter(|seen| **seen).count();
    println!("{speeds} speeds, {seen:?}");
    assert!(speeds >= 19 && (seen[19] || seen[20]), "{seen:?}");
}

#[test]
fn an_emergency_stop_ends_the_steps_within_its_time_and_the_power_in_a_tick() {
    // At any moment of a pulse, and between two.
    for moment in [0, 1, 370, 400, 740, 20_011] {
        let mut bench = armed(8.0);
        go(&mut bench, [-0.5, 0.5], 1.0);
        let mut chip = bench.line.chip();
        chip.run(HZ / 12).expect("it runs");
        while !chip.wires().pulse_lasts(0) {
            chip.run(1).expect("it runs");
        }
        chip.run(moment).expect("it runs");
        assert!(chip.wires().pulses.len() > 1000, "it moves");
        let pressed = chip.now();
        chip.press_stop(true);
        chip.run(2 * PERIOD).expect("it runs");
        let last = chip.wires().last_edge;
        // Two clocks; the synchroniser has two more, and one is for the place between two.
        assert!(
            last <= pressed + 2,
            "{moment}: {} cycles after",
            last - pressed
        );
        assert_eq!(chip.wires().powered, [false; 2]);
        // Released again, nothing moves until a host asks for it.
        chip.press_stop(false);
        chip.run(HZ / 50).expect("it runs");
        assert_eq!(chip.wires().last_edge, last);
        drop(chip);
        let status = bench.status();
        assert_eq!(status.fault, Some(Fault::EmergencyStop));
        assert_eq!(status.state, State::Fault);
    }
}

#[test]
fn a_press_that_is_over_before_the_next_tick_ends_the_steps_and_a_host_lets_them_go_on() {
    let mut bench = armed(8.0);
    go(&mut bench, [-0.5, 0.5], 1.0);
    let mut chip = bench.line.chip();
    chip.run(HZ / 12).expect("it runs");
    let pressed = chip.now();
    chip.press_stop(true);
    chip.run(150).expect("it runs");
    chip.press_stop(false);
    chip.run(HZ / 100).expect("it runs");
    let last = chip.wires().last_edge;
    assert!(last <= pressed + 2, "{} cycles after", last - pressed);
    drop(chip);
    assert_eq!(bench.status().fault, Some(Fault::EmergencyStop));
    bench.request(Request::ClearFault).expect("cleared");
    let start = start(&bench.settings);
    bench.request(Request::SetAngles(start)).expect("accepted");
    bench.line.chip().run(HZ * 3 / 10).expect("it runs");
    go(&mut bench, [-0.1, 0.1], 1.0);
    finish(&mut bench);
    assert!(bench.line.chip().wires().last_edge > last, "it moves again");
}

#[test]
fn a_driver_that_reports_a_fault_or_whose_wire_is_off_ends_the_motion() {
    for joint in 0..2 {
        let mut bench = armed(1.0);
        bench.line.chip().wires().fault[joint] = true;
        bench.line.chip().run(HZ / 1000).expect("it runs");
        let fault = bench.status().fault;
        assert!(fault.is_some(), "joint {joint}");
        println!("{fault:?}");
        assert_eq!(bench.line.chip().wires().powered, [false; 2]);
    }
}

#[test]
fn a_fault_of_the_processor_takes_the_power_at_once_and_the_next_start_reports_it() {
    let mut bench = armed(8.0);
    go(&mut bench, [-0.5, 0.5], 1.0);
    let mut chip = bench.line.chip();
    chip.run(HZ / 12).expect("it runs");
    let faulted = chip.now();
    chip.fault();
    chip.run(30).expect("it runs");
    assert_eq!(chip.wires().powered, [false; 2], "within 0.2 µs");
    chip.run(HZ / 50).expect("it starts again");
    assert!(chip.wires().last_edge < faulted + 30);
    assert_eq!(chip.resets, 1);
    drop(chip);
    assert_eq!(bench.connect_again().reset, Reset::HardFault);
    assert_eq!(bench.status().fault, Some(Fault::HardFault));
}

#[test]
fn a_core_that_hangs_makes_no_more_steps_and_is_reset_by_the_watchdog() {
    let mut bench = armed(8.0);
    go(&mut bench, [-0.5, 0.5], 1.0);
    let mut chip = bench.line.chip();
    chip.run(HZ / 12).expect("it runs");
    chip.hang();
    let hung = chip.now();
    chip.run(HZ / 25).expect("it hangs");
    assert!(chip.wires().last_edge < hung + 2 * PERIOD, "steps go on");
    chip.run(HZ / 25).expect("it starts again");
    assert_eq!(chip.resets, 1);
    assert_eq!(chip.wires().powered, [false; 2]);
    drop(chip);
    assert_eq!(bench.connect_again().reset, Reset::Watchdog);
}
