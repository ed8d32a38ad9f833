//! The image for drives on a CAN bus, with the simulated leg on its pins.

mod bench;

use fivebar_chip::time::{MICROSECOND, MILLISECOND, Time, seconds};
use fivebar_chip::{
    CanArm, CanStatistics, Chip, DriveKind, HostLine, Image, Options, SharedCanArm,
};
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::controller::RequestError;
use fivebar_firmware::drivers::boards::{self, BOARDS, REFERENCE};
use fivebar_firmware::drives::can::{BIT_RATE, BusDrives, Frame, Protocol, most_load, odrive};
use fivebar_firmware::protocol::{Board, CommandError, HostCommand, Reset};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{Move, MoveKind, Request, Status};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{FaultKind, Wires, bits_on_bus};
use fivebar_sim::drive::{Drive, Homing};
use fivebar_sim::link::Client;
use fivebar_sim::simulation::{Simulate, SimulatedDrives};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// A tick.
const TICK: Time = MILLISECOND;
/// An address in RAM.
const UNDEFINED: u32 = 0x2001_f000;
/// The nodes of the leg's drives.
const NODES: [u8; 2] = [1, 2];

fn can_image() -> Arc<Image> {
    static IMAGE: OnceLock<Arc<Image>> = OnceLock::new();
    IMAGE
        .get_or_init(|| {
            let path = bench::path().with_file_name("stm32f405_can");
            Arc::new(Image::read(&path).expect("an image"))
        })
        .clone()
}

/// The demonstration on the leg, without an error of homing: both take the pose in which it stands for its home.
fn demonstration(change: impl Fn(&str) -> String) -> Scenario {
    let text = BuiltIn::find("leg").expect("built in").text;
    let text = format!("{}\n[homing]\nmethod = \"given\"\n", change(text));
    let robot = Robot::parse("leg.toml", &text).unwrap_or_else(|error| panic!("{error}"));
    let mut scenario = Scenario::demonstration(robot);
    scenario.fit().expect("it fits");
    scenario
}

fn leg() -> Scenario {
    demonstration(str::to_owned)
}

fn mit() -> Scenario {
    demonstration(|text| {
        text.replace(
            "protocol = \"odrive\"",
            "protocol = \"mit\"\nposition_range = 12.5\nvelocity_range = 640.0\ntorque_range = 2.0",
        )
    })
}

struct Bench {
    client: Client<HostLine>,
    line: HostLine,
    arm: SharedCanArm,
    scenario: Scenario,
}

fn open(line: &HostLine) -> (Client<HostLine>, Reset) {
    let time = |line: &HostLine| Duration::from_micros(line.chip().now() / MICROSECOND);
    let (client, identity) =
        Client::open_with_clock(line.clone(), time).expect("the controller answers");
    assert_eq!(identity.board, Board::Stm32f405Can);
    (client, identity.reset)
}

impl Bench {
    /// Connected, with the settings in use.
    fn ready(scenario: Scenario) -> Self {
        Self::on(&REFERENCE, can_image(), scenario)
    }

    /// The same on a board with the image for it.
    fn on(board: &'static boards::Board, image: Arc<Image>, scenario: Scenario) -> Self {
        let plant = BusDrives::arm(&scenario).expect("an arm");
        let arm = SharedCanArm::new(CanArm::new(plant));
        let options = Options {
            drives: DriveKind::OnBus,
            board,
            crystal: f64::from(board.crystal) * 1e6,
            ..Options::default()
        };
        let chip =
            Chip::new(image, options, Vec::new(), Box::new(arm.clone())).expect("an emulator");
        let line = HostLine::new(chip);
        let (mut client, _) = open(&line);
        let settings = scenario.robot.settings().expect("settings");
        let applied = client.write_settings(&settings).expect("a line");
        applied.expect("the settings are applied");
        let mut bench = Self {
            client,
            line,
            arm,
            scenario,
        };
        // Until both drives have sent a heartbeat.
        bench.run(20 * MILLISECOND);
        bench
    }

    /// The same with known angles, and armed.
    fn armed(scenario: Scenario) -> Self {
        let mut bench = Self::ready(scenario);
        bench.arm_again();
        bench
    }

    fn home(&self) -> [f32; 2] {
        self.scenario.robot.home.map(|angle| angle as f32)
    }

    fn arm_again(&mut self) {
        let angles = Joint::ALL.map(|joint| self.arm.get().plant().angle(joint) as f32);
        self.request(Request::SetAngles(angles));
        self.request(Request::Arm);
        self.run(300 * MILLISECOND);
        let status = self.status();
        assert_eq!((status.state, status.fault), (State::Armed, None));
    }

    /// Armed, and on its way for half a second.
    fn moving(scenario: Scenario) -> Self {
        let mut bench = Self::armed(scenario);
        let [one, four] = bench.home();
        bench.go([one - 0.3, four + 0.3], 0.02);
        bench.run(60 * MILLISECOND);
        assert_eq!(bench.status().state, State::Running);
        bench
    }

    fn run(&mut self, time: Time) {
        let ran = self.line.chip().run(time);
        if let Err(report) = ran {
            panic!("{report}");
        }
    }

    fn request(&mut self, request: Request) {
        let command = HostCommand::Request(request);
        let answer = self.client.command(command).expect("an answer");
        answer.unwrap_or_else(|error| panic!("{request:?}: {error:?}"));
    }

    fn go(&mut self, to: [f32; 2], speed: f32) {
        let kind = MoveKind::Joint { to, speed };
        let a_move = Move {
            tag: 1,
            tool: 0,
            kind,
        };
        self.client
            .call(HostCommand::Move(a_move))
            .expect("an answer");
    }

    fn status(&mut self) -> Status {
        self.client.status().expect("a status").0
    }

    fn statistics(&self) -> CanStatistics {
        self.line.chip().can_statistics()
    }

    fn torque(&self) -> [f64; 2] {
        let now = self.line.chip().now();
        let arm = &mut *self.arm.get();
        arm.follow(now);
        arm.plant().torque()
    }

    /// Both drives give no torque from 4 ms on, and the controller has this fault.
    #[track_caller]
    fn stops_within_4_ms(&mut self, fault: Fault) {
        self.run(4 * MILLISECOND);
        for _ in 0..400 {
            assert_eq!(self.torque(), [0.0; 2]);
            self.run(50 * MICROSECOND);
        }
        assert_eq!(self.status().fault, Some(fault));
        let engaged = self.arm.get().outputs().brake != Some(true);
        assert!(engaged, "the brake is engaged");
    }
}

/// The distance of a point from a line of points [m].
fn distance([x, y]: [f64; 2], line: &[[f64; 2]]) -> f64 {
    let of_piece = |piece: &[[f64; 2]]| {
        let ([ax, ay], [bx, by]) = (piece[0], piece[1]);
        let (dx, dy) = (bx - ax, by - ay);
        let square = dx * dx + dy * dy;
        let share = match square > 0.0 {
            true => (((x - ax) * dx + (y - ay) * dy) / square).clamp(0.0, 1.0),
            false => 0.0,
        };
        (x - ax - share * dx).hypot(y - ay - share * dy)
    };
    line.windows(2).map(of_piece).fold(f64::MAX, f64::min)
}

/// Draws the demonstration on the chip and on the desktop: how far the chip's tool is from the desktop's path, RMS and at most [m].
fn compare(scenario: Scenario) -> [f64; 2] {
    compare_on(scenario, Bench::ready)
}

/// The same with a board and an image of one's own.
fn compare_on(scenario: Scenario, ready: impl FnOnce(Scenario) -> Bench) -> [f64; 2] {
    let job = scenario.job().expect("a job");
    let moves = scenario.run_moves(&job).expect("moves");
    let settings = scenario.robot.settings().expect("settings");
    let mut desktop = Vec::new();
    let (summary, record) = scenario
        .simulate(&job, &mut |_| ())
        .expect("it is simulated");
    assert!(record.faults.is_empty(), "{:?}", record.faults);
    desktop.extend(record.trace.samples().iter().map(|sample| sample.tool));

    let mut bench = ready(scenario);
    let home = bench.home();
    let mut drive = Drive::new(&mut bench.client, &|| false);
    drive.home(Homing::At(home)).expect("it is homed");
    bench.arm.get().frames.clear();
    let (mut began, mut ended) = (None, 0);
    let clock = bench.line.clone();
    drive
        .follow(&moves, &settings, &mut |_, status| {
            if status.state == State::Running {
                ended = clock.chip().now();
                began.get_or_insert(ended);
            }
        })
        .expect("the job is drawn");
    let began = began.expect("it has moved");
    let arm = bench.arm.get();
    // The desktop's record begins with the first move; here the brakes release in that time, and the arm settles on its drives.
    let began = began + 200 * MILLISECOND;
    let drawn = arm
        .frames
        .iter()
        .filter(|it| it.is_own && (began..ended).contains(&it.at));
    let off: Vec<f64> = drawn
        .step_by(3)
        .map(|it| distance(it.tool, &desktop))
        .collect();
    let rms = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
    let most = off.iter().copied().fold(0.0, f64::max);
    println!(
        "{} points: off the desktop's path by {:.1} µm RMS, {:.1} µm at most; its own error {:?}",
        off.len(),
        1e6 * rms,
        1e6 * most,
        summary.tip_error
    );
    drop(arm);
    println!("{:?}", bench.statistics());
    assert!(off.len() > 500);
    [rms, most]
}

#[test]
fn the_demonstration_is_drawn_as_on_the_desktop() {
    let [rms, most] = compare(leg());
    assert!(rms < 10e-6 && most < 50e-6, "{rms} {most}");
}

#[test]
fn the_demonstration_with_mit_type_drives_is_drawn_as_on_the_desktop() {
    let [rms, most] = compare(mit());
    assert!(rms < 40e-6 && most < 150e-6, "{rms} {most}");
}

/// Its crystal has 12 MHz, and its emergency stop is at another pin.
#[test]
fn the_demonstration_is_drawn_and_stopped_on_a_board_with_other_pins() {
    let board = BOARDS.iter().find(|board| board.name == "feather_f405");
    let board = board.expect("the board");
    let image = || bench::image_for("FIVEBAR_BOARD", board.name, "stm32f405_can");
    let [rms, most] = compare_on(leg(), |scenario| Bench::on(board, image(), scenario));
    assert!(rms < 10e-6 && most < 50e-6, "{rms} {most}");
    let mut bench = Bench::on(board, image(), leg());
    bench.arm_again();
    bench.arm.get().press_stop(true);
    bench.stops_within_4_ms(Fault::EmergencyStop);
}

#[test]
fn each_tick_sends_its_frames_in_order_and_both_drives_answer() {
    for scenario in [leg(), mit()] {
        let (protocol, _) = scenario.robot.can_bus().expect("a bus");
        let mut bench = Bench::armed(scenario);
        let before = bench.statistics();
        bench.arm.get().frames.clear();
        bench.run(200 * MILLISECOND);
        let now = bench.statistics();
        assert_eq!(now.filtered, before.filtered);
        assert_eq!((now.failed, now.overrun, now.aborted), (0, 0, 0));
        let arm = bench.arm.get();
        let began = bench.line.chip().tick_began() % TICK;
        let tick = |at: Time| (at + TICK - began) / TICK;
        let last = tick(bench.line.chip().now());
        let mut most = 0.0_f32;
        for frames in arm
            .frames
            .chunk_by(|one, next| tick(one.at) == tick(next.at))
        {
            let own: Vec<u16> = frames
                .iter()
                .filter(|it| it.is_own)
                .map(|it| it.frame.id)
                .collect();
            let answers = frames.iter().filter(|it| !it.is_own).count();
            let wanted: &[u16] = match protocol {
                Protocol::Odrive => &[0x2C, 0x4C, 0x29, 0x49],
                Protocol::Mit(_) => &[1, 2],
            };
            if tick(frames[0].at) == last || tick(frames[0].at) == tick(arm.frames[0].at) {
                continue;
            }
            assert_eq!(own, wanted);
            assert!((2..=4).contains(&answers), "{answers} answers");
            let bits: u32 = frames.iter().map(|it| bits_on_bus(&it.frame)).sum();
            most = most.max(bits as f32 * 1e3 / BIT_RATE);
        }
        println!("{protocol:?}: at most {most} of the bus");
        assert!(most > 0.3 && most <= most_load(&protocol, 1000.0));
    }
}

#[test]
fn a_drive_that_is_silent_or_resets_leaves_both_without_torque_within_4_ms() {
    for kind in [
        FaultKind::CanSilent {
            joint: Joint::Joint1,
        },
        FaultKind::CanSilent {
            joint: Joint::Joint4,
        },
        FaultKind::CanReset {
            joint: Joint::Joint1,
        },
        FaultKind::CanReset {
            joint: Joint::Joint4,
        },
    ] {
        for phase in [0, 300, 700] {
            let mut bench = Bench::moving(leg());
            bench.run(phase * MICROSECOND);
            assert!(bench.torque().iter().all(|torque| torque.abs() > 1e-4));
            bench.arm.get().plant_mut().arm_mut().inject(kind);
            bench.stops_within_4_ms(Fault::DriveSilent);
        }
    }
}

#[test]
fn shorted_wires_take_the_chip_off_the_bus_and_it_returns_when_they_are_whole() {
    let mut bench = Bench::moving(leg());
    // Behind the answers of a tick: the next one finds out. Earlier in a tick the answers that are missing may come first.
    let began = bench.line.chip().tick_began();
    let ran = bench.line.chip().run_until(began + 950 * MICROSECOND);
    ran.expect("no violation");
    bench.arm.get().plant_mut().set_wires(Wires::Shorted);
    bench.stops_within_4_ms(Fault::BusOff);
    assert!(bench.statistics().failed >= 32);
    bench.arm.get().plant_mut().set_wires(Wires::Whole);
    bench.run(20 * MILLISECOND);
    bench.request(Request::ClearFault);
    // The drives' watchdogs have tripped meanwhile; their heartbeats tell that this is cleared, too.
    bench.run(110 * MILLISECOND);
    bench.arm_again();
}

#[test]
fn frames_of_others_are_not_taken_and_a_full_bus_delays_no_torque() {
    let mut bench = Bench::moving(leg());
    let before = bench.statistics();
    // The drives' messages that nobody asked for, another node's, and a request of the identifier of an answer.
    for id in [0x2A, 0x34, 3 << 5 | 0x09, 0x7FF] {
        bench
            .arm
            .get()
            .plant_mut()
            .disturb_with(Frame::new(id, [0x7F; 8]));
        bench.run(20 * MILLISECOND);
        bench.status();
    }
    let asked = odrive::ask_for_estimates(NODES[0]);
    bench.arm.get().plant_mut().disturb_with(asked);
    bench.run(20 * MILLISECOND);
    let now = bench.statistics();
    assert_eq!(now.filtered - before.filtered, 5);
    assert_eq!(bench.status().fault, None);
    // Frames before all others for 6 ms, from behind those of a tick on: the drives' watchdogs count from these.
    let began = bench.line.chip().tick_began();
    let ran = bench.line.chip().run_until(began + 950 * MICROSECOND);
    ran.expect("no violation");
    bench.arm.get().frames.clear();
    for _ in 0..46 {
        let first = Frame::new(0, [0x55; 8]);
        bench.arm.get().plant_mut().disturb_with(first);
    }
    let began = bench.line.chip().now();
    bench.stops_within_4_ms(Fault::DriveSilent);
    assert!(bench.statistics().aborted > now.aborted);
    let arm = bench.arm.get();
    let free = arm.frames.iter().rfind(|it| it.frame.id == 0);
    let free = free.expect("a frame").at;
    println!("the bus is full for {} ms", 1e3 * seconds(free - began));
    let late = arm
        .frames
        .iter()
        .filter(|it| it.is_own && it.at > free && it.at < free + TICK);
    // Those of one tick, or the rest of one and the next: no torque of a tick before.
    let late: Vec<u16> = late.map(|it| it.frame.id & 0x1F).collect();
    assert!(late.len() <= 8, "{late:?}");
    assert!(
        !late.is_empty()
            && late
                .iter()
                .all(|message| [0x07, 0x0C, 0x09].contains(message))
    );
}

#[test]
fn a_bus_without_drives_is_no_bus_off_and_arms_nothing() {
    let mut bench = Bench::ready(leg());
    for joint in Joint::ALL {
        let kind = FaultKind::CanSilent { joint };
        bench.arm.get().plant_mut().arm_mut().inject(kind);
    }
    bench.run(200 * MILLISECOND);
    let home = bench.home();
    // A tick between the two requests sees that the place of a silent drive is not known.
    let accepted = (0..40).any(|_| {
        bench.run(MILLISECOND / 10);
        bench.request(Request::SetAngles(home));
        let arm = bench.client.command(HostCommand::Request(Request::Arm));
        match arm.expect("an answer") {
            Ok(_) => true,
            Err(CommandError::Request(RequestError::NotHomed)) => false,
            Err(other) => panic!("{other:?}"),
        }
    });
    assert!(accepted, "no tick between the two requests");
    bench.run(50 * MILLISECOND);
    assert_eq!(bench.status().fault, Some(Fault::DriveSilent));
}

#[test]
fn the_emergency_stop_ends_the_torque_in_a_tick() {
    let mut bench = Bench::moving(leg());
    bench.arm.get().press_stop(true);
    bench.stops_within_4_ms(Fault::EmergencyStop);
}

/// The messages of the chip's frames from a time on.
fn messages(bench: &Bench, from: Time) -> Vec<(u16, Option<[u8; 8]>)> {
    let arm = bench.arm.get();
    let own = arm.frames.iter().filter(|it| it.is_own && it.at > from);
    own.map(|it| (it.frame.id, it.frame.data)).collect()
}

#[test]
fn a_panic_and_a_hard_fault_send_both_drives_their_last_frames() {
    let panic = can_image().symbol("rust_begin_unwind");
    let (panic, _) = panic.expect("a panic handler");
    for (cause, reset) in [
        (0, Reset::Panic),
        (1, Reset::HardFault),
        (2, Reset::HardFault),
    ] {
        let mut bench = Bench::moving(leg());
        let now = bench.line.chip().now();
        match cause {
            0 => bench.line.chip().go_on_at(panic),
            1 => {
                // An instruction that the processor does not have.
                bench.line.chip().write_ram_word(UNDEFINED, 0xde00_de00);
                bench.line.chip().go_on_at(UNDEFINED);
            }
            _ => bench.line.chip().leave_stack(64),
        }
        bench.run(3 * MILLISECOND);
        let sent = messages(&bench, now);
        let stops = NODES.map(|node| {
            let stop = odrive::set_axis_state(node, odrive::IDLE);
            (stop.id, stop.data)
        });
        let place = sent.windows(2).position(|pair| pair == stops);
        assert!(place.is_some(), "{sent:?}");
        for _ in 0..100 {
            assert_eq!(bench.torque(), [0.0; 2]);
            bench.run(50 * MICROSECOND);
        }
        bench.run(200 * MILLISECOND);
        let (_, found) = open(&bench.line);
        assert_eq!(found, reset);
    }
}

#[test]
fn without_its_crystal_the_chip_leaves_the_bus() {
    let mut bench = Bench::moving(leg());
    bench.line.chip().crystal_fails();
    let now = bench.line.chip().now();
    bench.run(4 * MILLISECOND + 500 * MICROSECOND);
    for _ in 0..100 {
        assert_eq!(bench.torque(), [0.0; 2]);
        bench.run(50 * MICROSECOND);
    }
    let sent = messages(&bench, now + 135 * MICROSECOND);
    assert_eq!(sent, [], "nothing is sent with a wrong clock");
    bench.run(100 * MILLISECOND);
}
