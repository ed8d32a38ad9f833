//! The firmware images running on QEMU.

use fivebar::doctor::compare_outputs;
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::drives::BrushedDrives;
use fivebar_firmware::protocol::{Board, HostCommand, Reply};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{Request, Settings, Status};
use fivebar_plant::Mismatch;
use fivebar_sim::link::{Client, Emulator, Instructions, Lockstep};
use fivebar_sim::simulation::{Record, Simulate, Summary};

/// Lines, corners, arcs both ways, a dwell and a rapid move: 0.3 s of motion and more.
const JOB: &str = "G21\nG90\nM3\nF12000\nG1 X20 Y0\nG1 X20 Y20\nG1 X0 Y20\nG2 X10 Y10 I10 J0\nG4 S0.05\nG3 X20 Y20 I0 J10\nG0 X25 Y15\n";

fn scenario() -> Scenario {
    let robot = Robot::load("benchtop").expect("a built-in robot");
    let mut scenario = Scenario::new("a hook", robot, "hook.gcode", JOB.into());
    scenario.origin = Some([0.03, 0.17]);
    scenario
}

/// The job on the emulated board, compared with a twin of other settings if any.
fn run(twin: impl FnOnce(&mut Settings)) -> (Lockstep<Emulator>, Summary, Record) {
    let scenario = scenario();
    let job = scenario.job().expect("a valid job");
    let settings = scenario.robot.settings().expect("a robot with motors");
    let mut other = settings;
    twin(&mut other);
    let board = Emulator::start(&Emulator::built_image("qemu")).expect("an emulated board");
    let (mut lockstep, identity) = Lockstep::begin(board, &settings, &other).expect("a start");
    assert_eq!(identity.board, Board::Emulated);
    let (summary, record) = scenario
        .run_on(&mut lockstep, &scenario.moves(&job).unwrap(), &mut |_| ())
        .expect("a run");
    (lockstep, summary, record)
}

#[test]
fn the_emulated_board_gives_the_bits_of_this_process() {
    let (lockstep, summary, record) = run(|_| ());
    assert_eq!(lockstep.first_difference(), None);
    assert_eq!(summary.faults, [""; 0]);
    assert!(summary.verdict.drawn, "{:?}", summary.verdict);
    assert!(lockstep.ticks() >= 3_000, "{} ticks", lockstep.ticks());
    let begun = record.begun.expect("the job began");
    assert!(record.simulated - begun > 0.3, "{summary:?}");
    println!(
        "{:?} in {} ticks",
        lockstep.instructions(),
        lockstep.ticks()
    );
    let Instructions { max, .. } = lockstep.instructions();
    assert!(
        max <= longest_interrupt(),
        "the worst tick: {max} instructions"
    );
}

/// The whole demonstration by time-optimal motion.
fn demonstrate_fast(share: f64, mismatch: Mismatch) {
    let mut scenario = Scenario::demonstration(Robot::load("benchtop").expect("a built-in robot"));
    scenario.time_optimal = Some(share);
    scenario.mismatch = mismatch;
    let job = scenario.job().expect("a valid job");
    let settings = scenario.robot.settings().expect("a robot with motors");
    let board = Emulator::start(&Emulator::built_image("qemu")).expect("an emulated board");
    let (mut lockstep, _) =
        Lockstep::<_, BrushedDrives>::begin(board, &settings, &settings).expect("a start");
    let moves = scenario.run_moves(&job).expect("a plan");
    let (summary, record) = scenario
        .run_on(&mut lockstep, &moves, &mut |_| ())
        .expect("a run");
    assert_eq!(lockstep.first_difference(), None);
    assert_eq!(summary.faults, [""; 0]);
    assert_eq!(summary.saturated_ticks, 0);
    assert!(summary.tip_error.max_m < 3e-4, "{:?}", summary.tip_error);
    let time = record.job_time.expect("a whole job");
    assert!((2.5..3.3).contains(&time), "{time} s");
    let Instructions { max, .. } = lockstep.instructions();
    assert!(
        max <= longest_interrupt(),
        "the worst tick: {max} instructions"
    );
    println!(
        "share {share}: {:?} in {} ticks",
        lockstep.instructions(),
        lockstep.ticks()
    );
}

#[test]
fn a_whole_time_optimal_job_has_the_bits_of_this_process_under_the_declared_mismatch() {
    demonstrate_fast(0.7, Mismatch::default());
}

#[test]
fn a_whole_time_optimal_job_of_an_identified_arm_has_the_bits_of_this_process() {
    let known = Mismatch {
        current_noise: 2.0,
        ..Mismatch::NONE
    };
    demonstrate_fast(0.9, known);
}

#[test]
fn the_doctor_tells_this_programs_image_from_another() {
    let compare = |image: &str| {
        compare_outputs::<BrushedDrives>(&Emulator::built_image(image), BuiltIn::DEFAULT)
    };
    let qemu = compare("qemu");
    assert!(qemu.is_ok(), "{qemu:?}");
    let other = compare("stm32f405");
    let reason = other.expect_err("it makes its own ticks").to_string();
    assert!(
        reason.contains("needs a board with the image `qemu`"),
        "{reason}"
    );
}

/// The proved bound of the tick's interrupt [instructions], see `docs/verify/bounds.md`: no tick of a run
/// takes more.
fn longest_interrupt() -> u32 {
    let figures = include_str!("../../verify/bounds/figures.txt");
    let row = figures
        .lines()
        .find_map(|line| line.strip_prefix("stm32f405: ADC"));
    let figure = row.and_then(|row| row.split_whitespace().next()?.parse().ok());
    figure.expect("the interrupt's instructions")
}

#[test]
fn a_gain_changed_on_one_side_is_found() {
    let (lockstep, ..) = run(|twin| twin.control.bandwidth *= 1.001);
    let difference = lockstep.first_difference().expect("other bits");
    assert!(
        ["duties", "current_demand"].contains(&difference.field),
        "{difference:?}"
    );
}

fn status(client: &mut Client<Emulator>) -> Status {
    match client.call(HostCommand::Status).expect("an answer") {
        Reply::Status { status, .. } => status,
        other => panic!("{other:?}"),
    }
}

/// The emulator's crystal never starts.
#[test]
fn the_production_image_boots_to_the_clock_fault_and_refuses_to_arm() {
    let board = Emulator::start(&Emulator::built_image("stm32f405")).expect("an emulated board");
    let (mut client, identity) = Client::open(board).expect("an answer");
    assert_eq!(identity.board, Board::Stm32f405);
    let before = status(&mut client);
    assert_eq!(before.state, State::Fault);
    assert_eq!(before.fault, Some(Fault::ClockFailure));
    for request in [Request::Arm, Request::Home] {
        let reply = client
            .call(HostCommand::Request(request))
            .expect("an answer");
        assert!(matches!(reply, Reply::Refused(_)), "{request:?}: {reply:?}");
    }
    // The clock does not recover, so the fault is raised again each time it is cleared.
    let cleared = client.call(HostCommand::Request(Request::ClearFault));
    assert!(cleared.is_ok());
    std::thread::sleep(std::time::Duration::from_millis(200));
    let after = status(&mut client);
    assert!(after.tick > before.tick, "the slow tick goes on");
    assert_eq!(after.fault, Some(Fault::ClockFailure));
    assert_eq!(after.duty, [0.0; 2]);
}
