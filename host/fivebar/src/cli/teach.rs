//! `fivebar teach`: a motion that a hand teaches, as a file.

use super::failure::{Failure, refused};
use super::port::interrupted;
use super::say::{leave_output_to, say, warn, warn_of_drivers};
use super::serve::{ControllerArgs, described};
use super::value_error::ValueError;
use fivebar_files::robot::Robot;
use fivebar_files::text_file::{LARGEST_TOML, read_text};
use fivebar_firmware::protocol::StreamState;
use fivebar_kinematics::five_bar::Side;
use fivebar_report::output::write_whole;
use fivebar_sim::clock::Clock;
use fivebar_sim::controller::{ControllerSource, Hand, Session, open};
use fivebar_sim::drive::{Controlled, Drive, DriveError, Homing};
use fivebar_sim::teaching::{Record, TaughtPath};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

/// Rounds of some 10 ms before the first command: drives on a bus answer some time after their power.
const WAKING: u32 = 20;

/// Time for which a record goes on after a scripted hand has let go [s].
const AFTER_HAND: f64 = 0.3;

/// Records a motion that you teach: lead the arm's tip by hand, then press Ctrl-C.
///
/// The motors carry the arm's weight and a part of its friction. Walls keep it within its angles and away from singularities, and
/// a tip faster than 0.25 m/s is braked. `fivebar replay` does the motion again.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    controller: ControllerArgs,
    /// The file: .json for `fivebar replay`, .gcode or .svg for other programs, .csv for the places where the tip rested for half
    /// a second; - is JSON on the standard output.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// End after this time [s].
    #[arg(long, value_name = "S", value_parser = seconds)]
    seconds: Option<f64>,
    /// The hand that leads a simulated arm: rows of time [s], x and y [m] from where it grips the tip.
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["port", "emulated"])]
    hand: Option<PathBuf>,
}

fn seconds(text: &str) -> Result<f64, ValueError> {
    let time = text
        .parse()
        .ok()
        .filter(|time| (0.1..=600.0).contains(time));
    time.ok_or(ValueError::TeachTime)
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    Format::of(&args.out)?;
    leave_output_to(&args.out);
    let robot = Robot::load(&args.controller.robot).map_err(refused)?;
    warn_of_drivers(&robot);
    let hand = args.hand.as_deref().map(scripted).transpose()?;
    if args.controller.is_simulated() && hand.is_none() {
        return Err(Failure::Usage(
            "nobody leads a simulated arm: give the motion of a hand with --hand FILE.csv, or a --port".into(),
        ));
    }
    let interrupted = interrupted()?;
    let wants_stop = || interrupted.load(Ordering::Relaxed);
    let mut session = opened(&args.controller, &robot, hand.as_ref())?;
    let tick_rate = f64::from(session.settings.control.tick_rate);
    let mut record = Record::new(tick_rate);
    let taught = taught(&mut session, &wants_stop, |drive| {
        warn("lead the tip by hand; Ctrl-C ends it");
        let longest = args.seconds.unwrap_or(f64::INFINITY);
        let longest = hand
            .as_ref()
            .map_or(longest, |hand| longest.min(hand.time() + AFTER_HAND));
        drive.be_led(tick_rate, &mut |state: &StreamState| {
            if let Some(hand) = &hand {
                hand.grip();
            }
            record.keep(state) && record.time() < longest
        })
    })?;
    let tool = robot.tool_on_link().map_err(refused)?;
    let path = record.path(&robot.name, &tool, taught).map_err(refused)?;
    write(&args.out, &path)?;
    say(format_args!(
        "{:.2} s and {:.1} mm taught, in {}",
        path.time(),
        1e3 * path.length(),
        args.out.display()
    ))
}

/// Homes the arm, if that is needed, and holds it; does this with it; then its motors are off. Returns the assembly mode.
fn taught(
    session: &mut Session,
    wants_stop: &dyn Fn() -> bool,
    work: impl FnOnce(&mut Drive<'_, Session>) -> Result<(), DriveError>,
) -> Result<Side, Failure> {
    let settings = session.settings;
    let mut drive = Drive::new(session, wants_stop);
    let mut assembly = settings.assembly();
    let done = (|| {
        drive.home(Homing::IfUnknown)?;
        drive.switch_on()?;
        assembly = drive.planner(&settings)?.assembly();
        work(&mut drive)
    })();
    let stopped = session.stop_arm();
    done.map_err(refused)?;
    stopped.map_err(refused)?;
    Ok(assembly)
}

/// Opens the controller.
pub(super) fn opened(
    args: &ControllerArgs,
    robot: &Robot,
    hand: Option<&Hand>,
) -> Result<Session, Failure> {
    let image = args.image(robot);
    let (source, clock) = match hand {
        Some(hand) => (ControllerSource::Led(hand), Clock::simulated()),
        None if args.is_simulated() => (ControllerSource::Simulated, Clock::simulated()),
        None => (args.source(&image), Clock::real()),
    };
    let (mut session, _) =
        open(robot, source, &clock).map_err(|error| described(error, args, robot))?;
    for _ in 0..WAKING {
        Controlled::pass_time(&mut session).map_err(refused)?;
        session.read_status().map_err(refused)?;
    }
    Ok(session)
}

fn scripted(path: &Path) -> Result<Hand, Failure> {
    let named =
        |error: &dyn std::fmt::Display| refused(format_args!("{}: {error}", path.display()));
    let text = read_text(path, LARGEST_TOML).map_err(|error| named(&error))?;
    Hand::parse(&text).map_err(|error| named(&error))
}

/// What a file of a taught path is.
#[derive(Clone, Copy)]
enum Format {
    Json,
    Gcode,
    Svg,
    Places,
}

impl Format {
    fn of(path: &Path) -> Result<Self, Failure> {
        let ending = path.extension().and_then(|it| it.to_str());
        match ending {
            Some("json") => Ok(Self::Json),
            None if path == Path::new("-") => Ok(Self::Json),
            Some("gcode" | "nc" | "ngc") => Ok(Self::Gcode),
            Some("svg") => Ok(Self::Svg),
            Some("csv") => Ok(Self::Places),
            _ => Err(Failure::Usage(format!(
                "{}: a taught path is written as .json, .gcode, .svg or .csv",
                path.display()
            ))),
        }
    }
}

/// Writes a taught path as its file's ending says.
pub(super) fn write(out: &Path, path: &TaughtPath) -> Result<(), Failure> {
    let text = match Format::of(out)? {
        Format::Json => path.to_json(),
        Format::Gcode => path.to_gcode(),
        Format::Svg => path.to_svg(),
        Format::Places => path.rests_to_csv(),
    };
    write_whole(out, text).map_err(refused)
}
