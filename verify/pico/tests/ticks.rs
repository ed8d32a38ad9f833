//! The longest tick of a run beside the bound that is proved from the machine code. The emulated core counts cycles of its own, in which
//! the bus does not wait: the bound of that kind is the one where nothing waits.

mod bench;

use bench::Bench;
use fivebar_firmware::Request;
use fivebar_pico::HZ;

/// The cycles of the tick's interrupt, where nothing waits: the second number behind the row's name.
fn bound(image: &str) -> u64 {
    let name = format!("{image}: SysTick ");
    let figures = include_str!("../../bounds/figures_rp2350.txt");
    let row = figures.lines().find_map(|line| line.strip_prefix(&name));
    let cycles = row.and_then(|row| row.split_whitespace().nth(1));
    cycles.expect("a bound").parse().expect("a number")
}

/// New settings, an arm that takes power, and an emergency stop.
#[test]
fn no_tick_takes_longer_than_is_proved() {
    for (image, robot) in [
        ("rp2350_stepper", "benchtop_stepper"),
        ("rp2350_servo", "classroom_servo"),
    ] {
        let mut bench = Bench::of(image, robot);
        let angles = bench.settings.axes.each_ref().map(|axis| axis.home_angle);
        let start = match image {
            "rp2350_servo" => Request::Home,
            _ => Request::SetAngles(angles),
        };
        bench.request(start).expect("accepted");
        bench.line.chip().run(HZ / 20).expect("it runs");
        bench.request(Request::EmergencyStop).expect("accepted");
        bench.status();
        let (bound, chip) = (bound(image), bench.line.chip());
        println!("{image}: {} cycles of {bound}", chip.longest_tick);
        assert!(chip.ticks > 500, "{} ticks", chip.ticks);
        assert!(chip.longest_tick > 500, "{} cycles", chip.longest_tick);
        assert!(chip.longest_tick <= bound, "{image}: {bound} cycles proved");
    }
}
