//! A simulated board on a pseudo terminal: `fivebar drive` and `fivebar monitor` use it as they
//! use a board on a serial line.
//!
//! `board [image] [robot]` prints the terminal's path and runs, at the speed of real time or as
//! fast as this machine allows, until it is interrupted. Lines of its input tell a hand at the arm
//! what to do (`Hand::execute`); it prints `done` when the hand has done it. With `bare` in place of the robot
//! the board has no bridges and no arm, and the lines are the tasks of `fivebar board-test`. A robot with steppers needs
//! the image `stm32f405_stepper`, one with drives on a bus `stm32f405_can`.

use fivebar_chip::time::{MILLISECOND, Time};
use fivebar_chip::{
    Arm, BareBoard, CanArm, Chip, DriveKind, HAND_TIME, Hand, Image, Options, SharedArm,
    SharedBareBoard, SharedCanArm, SharedStepperArm, StepperArm, Wiring,
};
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_plant::{CanPlant, Mismatch, Plant, StepperPlant};
use std::error::Error;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::os::fd::FromRawFd;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Where scripts/firmware.sh builds the images.
const BUILT: &str = match option_env!("CARGO_TARGET_DIR") {
    Some(folder) => folder,
    None => concat!(env!("CARGO_MANIFEST_DIR"), "/../../target"),
};
const IMAGE: &str = "firmware/thumbv7em-none-eabihf/firmware/stm32f405";
/// Linux's flags: read and write, no controlling terminal, do not block.
const FLAGS: c_int = 0o2 | 0o400 | 0o4000;

unsafe extern "C" {
    fn posix_openpt(flags: c_int) -> c_int;
    fn grantpt(terminal: c_int) -> c_int;
    fn unlockpt(terminal: c_int) -> c_int;
    fn ptsname(terminal: c_int) -> *const c_char;
    fn tcgetattr(terminal: c_int, settings: *mut c_void) -> c_int;
    fn cfmakeraw(settings: *mut c_void);
    fn tcsetattr(terminal: c_int, when: c_int, settings: *const c_void) -> c_int;
}

/// A pseudo terminal: its near end, and the path of its far end.
fn terminal() -> std::io::Result<(File, PathBuf)> {
    // SAFETY: the functions get a descriptor that is open, and room for the settings, which
    // take 60 bytes on Linux.
    unsafe {
        let terminal = posix_openpt(FLAGS);
        if terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0 {
            return Err(std::io::Error::last_os_error());
        }
        let mut settings = [0_u64; 32];
        if tcgetattr(terminal, settings.as_mut_ptr().cast()) == 0 {
            cfmakeraw(settings.as_mut_ptr().cast());
            tcsetattr(terminal, 0, settings.as_ptr().cast());
        }
        let name = ptsname(terminal);
        if name.is_null() {
            return Err(std::io::Error::last_os_error());
        }
        let name = CStr::from_ptr(name).to_string_lossy().into_owned();
        Ok((File::from_raw_fd(terminal), PathBuf::from(name)))
    }
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("board: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let image = arguments
        .next()
        .unwrap_or_else(|| format!("{BUILT}/{IMAGE}"));
    let robot = arguments
        .next()
        .unwrap_or_else(|| BuiltIn::DEFAULT.to_owned());
    let read = Image::read(&PathBuf::from(&image));
    let read = read.map_err(|error| format!("{image}: {error}; scripts/firmware.sh builds it"))?;
    let image = Arc::new(read);
    let (mut world, wiring) = match robot.as_str() {
        "bare" => bare(),
        robot => with_arm(Robot::load(robot)?)?,
    };
    let options = Options {
        drives: world.drives(),
        ..Options::default()
    };
    let chip = Chip::new(image, options, Vec::new(), wiring);
    let chip = chip.map_err(|error| format!("the CPU emulator fails: {error:?}"))?;
    let (line, path) = terminal()?;
    println!("{}", path.display());
    serve(chip, &mut world, line)
}

/// What is at the chip's pins, and what a hand can do there.
enum World {
    Arm(SharedArm, Box<Hand>),
    Steppers(SharedStepperArm),
    OnBus(SharedCanArm),
    Bare(SharedBareBoard),
}

impl World {
    /// Forgets the past, of which a long run has too much.
    fn forget(&self) {
        match self {
            Self::Arm(arm, _) => arm.get().forget(),
            Self::OnBus(arm) => arm.get().frames.clear(),
            Self::Steppers(_) | Self::Bare(_) => {}
        }
    }

    fn drives(&self) -> DriveKind {
        match self {
            Self::Arm(..) | Self::Bare(_) => DriveKind::Brushed,
            Self::Steppers(_) => DriveKind::Steppers,
            Self::OnBus(_) => DriveKind::OnBus,
        }
    }

    fn execute(&mut self, order: &str) -> Result<(), String> {
        match self {
            Self::Arm(arm, hand) => hand.execute(&mut arm.get(), order)?,
            Self::Steppers(arm) => arm.get().press_stop(stop(order)?),
            Self::OnBus(arm) => arm.get().press_stop(stop(order)?),
            Self::Bare(board) if board.execute(order) => {}
            Self::Bare(_) => return Err(format!("no hand can do this at a bare board: {order}")),
        }
        Ok(())
    }
}

/// Whether the hand presses the emergency stop, or releases it.
fn stop(order: &str) -> Result<bool, String> {
    match order {
        "stop 1" => Ok(true),
        "stop 0" => Ok(false),
        _ => Err(format!("no hand can do this at such an arm: {order}")),
    }
}

fn bare() -> (World, Box<dyn Wiring>) {
    let board = SharedBareBoard::new(BareBoard::new(None));
    (World::Bare(board.clone()), Box::new(board))
}

/// An arm a little before its home switches.
fn with_arm(robot: Robot) -> Result<(World, Box<dyn Wiring>), Box<dyn Error>> {
    let axes = robot.settings()?.axes;
    let before = axes.map(|axis| if axis.home_forward { -0.03 } else { 0.03 });
    let pose = robot.pose_near_home(before)?;
    let (parameters, exact) = (robot.plant_parameters()?, Mismatch::default());
    if let Some(motors) = robot.steppers() {
        let plant = StepperPlant::new(&parameters, &motors, &exact, &pose, 1);
        let arm = SharedStepperArm::new(StepperArm::new(plant));
        return Ok((World::Steppers(arm.clone()), Box::new(arm)));
    }
    if let Some(bus) = robot.can_bus() {
        let plant = CanPlant::new(&parameters, bus, &exact, &pose, 1);
        let arm = SharedCanArm::new(CanArm::new(plant));
        return Ok((World::OnBus(arm.clone()), Box::new(arm)));
    }
    let plant = Plant::new(&parameters, &exact, &pose, 1);
    let arm = SharedArm::new(Arm::new(plant.with_resolved_windings(), MILLISECOND));
    Ok((
        World::Arm(arm.clone(), Box::new(Hand::new(robot))),
        Box::new(arm),
    ))
}

/// The lines of the input, which a thread reads.
fn orders() -> Receiver<String> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                return;
            }
        }
    });
    receiver
}

fn serve(mut chip: Chip, world: &mut World, mut line: File) -> Result<(), Box<dyn Error>> {
    let orders = orders();
    let mut busy_until = None;
    let began = Instant::now();
    let mut bytes = [0; 512];
    loop {
        match line.read(&mut bytes) {
            Ok(count) => chip.send(&bytes[..count]),
            // Nobody has the far end open.
            Err(error) if error.raw_os_error() == Some(5) => {}
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => return Err(error.into()),
        }
        chip.run(MILLISECOND)?;
        let sent = chip.receive(usize::MAX);
        if !sent.is_empty() {
            // What nobody reads is lost, as on a wire.
            let _ = line.write(&sent);
        }
        world.forget();
        if busy_until.is_some_and(|end| chip.now() >= end) {
            println!("done");
            busy_until = None;
        }
        if busy_until.is_none()
            && let Ok(order) = orders.try_recv()
        {
            world.execute(&order)?;
            busy_until = Some(chip.now() + HAND_TIME + HAND_TIME / 2);
        }
        let simulated = Duration::from_nanos(chip.now() / NANOSECOND);
        if let Some(ahead) = simulated.checked_sub(began.elapsed()) {
            std::thread::sleep(ahead);
        }
    }
}

const NANOSECOND: Time = 1_000_000;
