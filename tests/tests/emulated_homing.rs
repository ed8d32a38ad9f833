//! Homing by hard stops and by index pulses on the emulated Cortex-M4F: each reply, and so each tick, has
//! the bits of a controller in this process that gets the same commands.

mod bench;

use bench::Bench;
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_firmware::Request;
use fivebar_firmware::protocol::HostCommand;
use fivebar_firmware::safety::State;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{Mismatch, Plant};
use fivebar_sim::link::{Emulator, FaultRates};

/// Homes the benchtop arm with other lines in its file, from 0.01 rad before home, until it rests. Returns the
/// ticks and the greatest error of the angles [rad].
fn homed(replaced: [&str; 2], homing: &str) -> (u32, f64) {
    let benchtop = BuiltIn::find("benchtop").expect("a robot").text;
    let [old, new] = replaced;
    assert!(benchtop.contains(old));
    let text = benchtop.replace(old, new) + &format!("\n[homing]\n{homing}\n");
    let robot = Robot::parse("arm.toml", &text).expect("a robot");
    let parameters = robot.plant_parameters().expect("masses");
    let pose = robot.pose_near_home([-0.01, 0.01]).expect("a pose");
    let plant = Plant::new(&parameters, &Mismatch::default(), &pose, 7);
    let board = Emulator::start(&Emulator::built_image("qemu")).expect("an emulated board");
    let mut bench = Bench::of(board, FaultRates::default(), parameters.settings, plant);
    bench.is_done(HostCommand::Request(Request::Home));
    let ticks = (1..20_000).find(|_| bench.tick().state != State::Homing);
    for _ in 0..200 {
        bench.tick();
    }
    let status = bench.status();
    assert_eq!((status.homed, status.fault), (true, None));
    let off =
        Joint::ALL.map(|joint| (f64::from(status.angle[joint]) - bench.plant.angle(joint)).abs());
    let (ticks, off) = (ticks.expect("an end"), off[0].max(off[1]));
    println!("{ticks} ticks, {off} rad");
    (ticks, off)
}

#[test]
fn hard_stops_are_found_with_the_bits_of_this_process() {
    // A way of 0.02 rad from the stops to home, so that the search is short.
    let home = "home = [3.585, -0.445]";
    let keys = "method = \"hard-stop\"\ncurrent = 0.8\nback_off = 0.02\nspeed = 1.0";
    let (ticks, off) = homed(["home = [2.7925268, 0.3490659]", home], keys);
    assert!((4_000..9_000).contains(&ticks), "{ticks} ticks");
    assert!(off < 5e-4, "{off} rad");
}

#[test]
fn index_pulses_are_found_with_the_bits_of_this_process() {
    // Switches 0.07 turns of the encoders behind the pulses, and coarse encoders, so that the search is short.
    let keys = "method = \"index\"\nspeed = 3.0\nback_off = 0.05\nswitch = [2.8475, 0.2941]";
    let (ticks, off) = homed(["encoder_counts = 16384", "encoder_counts = 4096"], keys);
    assert!((6_000..12_000).contains(&ticks), "{ticks} ticks");
    // A count is 192 µrad.
    assert!(off < 192e-6, "{off} rad");
}
