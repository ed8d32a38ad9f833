//! The longest tick of a job beside the bound that is proved from the machine code. The emulated core counts cycles of its own, in which
//! the bus does not wait: the bound of that kind is the first of the three, where nothing waits.

mod bench;

use bench::{Bench, commands};
use fivebar_firmware::Request;

/// Each image with its robot.
const IMAGES: [(&str, &str); 2] = [
    ("rp2350_stepper", "benchtop_stepper"),
    ("rp2350_servo", "classroom_servo"),
];
/// The cycles that were seen last, and how far other code may be from them. `FIVEBAR_UPDATE=1` writes them.
const SEEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/ticks.csv");
const CHANGE: f64 = 0.1;

/// The cycles of the tick's interrupt, where nothing waits: the second number behind the row's name.
fn bound(image: &str) -> u64 {
    let name = format!("{image}: SysTick ");
    let figures = include_str!("../../bounds/figures_rp2350.txt");
    let row = figures.lines().find_map(|line| line.strip_prefix(&name));
    let cycles = row.and_then(|row| row.split_whitespace().nth(1));
    cycles.expect("a bound").parse().expect("a number")
}

/// The longest tick of homing, a job and an emergency stop.
fn longest(image: &str, robot: &str) -> u64 {
    let mut bench = Bench::of(image, robot);
    if robot.ends_with("servo") {
        bench.power();
    } else {
        let angles = bench.settings.axes.each_ref().map(|axis| axis.home_angle);
        bench.request(Request::SetAngles(angles)).expect("accepted");
        bench
            .line
            .chip()
            .run(fivebar_pico::HZ * 3 / 10)
            .expect("it runs");
    }
    let job = commands(&bench.robot, 0.05);
    bench.draw(&job);
    bench.request(Request::EmergencyStop).expect("accepted");
    bench.status();
    let chip = bench.line.chip();
    assert!(chip.ticks > 30_000, "{} ticks", chip.ticks);
    chip.longest_tick
}

#[test]
fn no_tick_of_a_job_takes_longer_than_is_proved() {
    let seen = IMAGES.map(|(image, robot)| (image, longest(image, robot)));
    let printed: String = seen
        .iter()
        .map(|(image, cycles)| format!("{image},{cycles}\n"))
        .collect();
    if std::env::var_os("FIVEBAR_UPDATE").is_some() {
        std::fs::write(SEEN, &printed).expect("the file is written");
    }
    let committed = std::fs::read_to_string(SEEN).expect("the file");
    for ((image, cycles), line) in seen.into_iter().zip(committed.lines()) {
        let bound = bound(image);
        println!("{image}: {cycles} cycles of at most {bound}");
        assert!(cycles <= bound, "{image}: {cycles} cycles, {bound} proved");
        let (name, before) = line.split_once(',').expect("a row");
        let before: f64 = before.parse().expect("a number");
        assert_eq!(name, image);
        assert!(
            (cycles as f64 / before - 1.0).abs() < CHANGE,
            "{SEEN} should be:\n{printed}"
        );
    }
}
