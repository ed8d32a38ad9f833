//! `fivebar bridge`: an endpoint for senders of G-code.

use super::failure::{Failure, refused};
use super::length::place;
use super::port::interrupted;
use super::run_args::ReadingArgs;
use super::say::{say, warn, warn_of_drivers};
use super::serve::{ControllerArgs, address, described};
use crate::bridge::{BridgeError, BridgeOptions, bridge};
use crate::senders::Endpoints;
use fivebar_files::robot::Robot;
use fivebar_sim::clock::Clock;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

/// Where senders connect over TCP if no address is given.
pub(super) const DEFAULT_ADDRESS: &str = "127.0.0.1:8106";

/// Lets senders such as UGS, Candle, LightBurn, OctoPrint or Printrun move the arm.
///
/// It speaks Grbl 1.1 and, to a sender that speaks it, RepRap, at a pseudo-terminal and, with
/// --listen, over TCP. The first line printed is host:port, or no-tcp, and the terminal's path. $H or
/// G28 homes, the first move arms, and G92 X0 Y0 makes the tool's position the job's zero. By default
/// the arm is simulated in real time.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    controller: ControllerArgs,
    /// Listen for senders over TCP, too, by default at 127.0.0.1:8106; port 0 is any free port. No
    /// password protects the address: any user and program that reaches it can move the arm.
    #[arg(long, value_name = "ADDRESS:PORT", num_args = 0..=1, default_missing_value = DEFAULT_ADDRESS, value_parser = address)]
    listen: Option<SocketAddr>,
    /// Position of X0 Y0 before any G92, in the frame of the base, such as 30mm,160mm; by default
    /// home.
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    origin: Option<[f64; 2]>,
    /// Write the arm's path as a table: time [s], the tool's reference position [m] and its level.
    #[arg(long, value_name = "FILE.csv")]
    log: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadingArgs,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let robot = Robot::load(&args.controller.robot).map_err(refused)?;
    warn_of_drivers(&robot);
    let reading = args.reading.options();
    let options = BridgeOptions {
        address: args.listen,
        dialect: reading.dialect,
        origin: args.origin,
        reading,
        log: args.log.clone(),
        clock: Clock::real(),
    };
    let ready = |endpoints: &Endpoints| {
        say(endpoints).unwrap_or_else(warn);
        warn(format_args!("{}, {}", robot.name, endpoints.place));
        if let Some(warning) = endpoints.warning() {
            warn(warning);
        }
    };
    let interrupted = interrupted()?;
    let ends = move || interrupted.load(Ordering::Relaxed);
    let image = args.controller.image(&robot);
    let source = args.controller.source(&image);
    let note = Box::new(|text: &str| warn(text));
    bridge(&robot, source, &options, ready, note, &ends).map_err(|error| match error {
        BridgeError::Controller(error) => described(error, &args.controller, &robot),
        other => refused(other),
    })
}
