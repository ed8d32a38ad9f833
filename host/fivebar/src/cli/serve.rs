//! `fivebar serve`: the live page.

use super::failure::{Failure, refused};
use super::plan::share;
use super::port::interrupted;
use super::rewrite::rewrite;
use super::say::{say, warn, warn_of_drivers};
use super::value_error::ValueError;
use crate::bridge::{self, BridgeOptions};
use crate::commission::Options;
use crate::job_process::APART;
use crate::pen_heights::KeepValues;
use crate::senders::Endpoints;
use crate::serve::commission::serve as guided;
use crate::serve::{Guard, ServeError, ServeOptions, serve};
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_sim::clock::Clock;
use fivebar_sim::controller::{ControllerSource, OpenError};
use fivebar_sim::link::Emulator;
use fivebar_sim::machine::Machine;
use std::net::{IpAddr, SocketAddr, UdpSocket};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

/// Serves a live page on which a browser shows the arm, jogs it and runs jobs.
///
/// By default the arm is simulated in real time.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    controller: ControllerArgs,
    /// The address to listen on; port 0 is any free port. The printed link contains a token,
    /// which is needed to connect. The connection is not encrypted.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8105", value_parser = address)]
    listen: SocketAddr,
    /// Let senders of G-code move the arm, too, as `fivebar bridge` does: at a pseudo-terminal and, if
    /// an address is given, such as 127.0.0.1:8106, over TCP. No password protects the address: any user
    /// and program that reaches it can move the arm.
    #[arg(long, value_name = "ADDRESS:PORT", num_args = 0..=1, value_parser = address)]
    senders: Option<Option<SocketAddr>>,
    /// Run the pages' jobs as fast as the arm's torque allows: feed rates and `[motion]` limits do
    /// not apply. Senders' moves keep theirs.
    #[arg(long)]
    time_optimal: bool,
    /// The share of the torque limits that --time-optimal plans with; the rest is for feedback. 0.7
    /// suits an arm as built, 0.9 one whose masses are identified.
    #[arg(long, value_name = "S", default_value_t = 0.7, value_parser = share, requires = "time_optimal")]
    torque_share: f64,
    /// Serve the guided page of a commissioning in place of the arm's: the steps of `fivebar commission`,
    /// with the record in this folder.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["emulated", "upload", "senders", "time_optimal"])]
    commission: Option<PathBuf>,
    /// With --commission and without --port: how the simulated arm differs from the robot file.
    #[arg(long, value_name = "SCENARIO.toml", requires = "commission")]
    scenario: Option<String>,
}

/// The arm and its controller.
#[derive(clap::Args)]
pub(super) struct ControllerArgs {
    /// A built-in robot (see `fivebar robots`) or a robot file.
    #[arg(long, default_value = BuiltIn::DEFAULT)]
    pub(super) robot: String,
    /// Run the firmware on an emulated Cortex-M4F with the simulated arm; slower than real
    /// time.
    #[arg(long)]
    emulated: bool,
    /// The image of the emulated board; scripts/firmware.sh builds it.
    #[arg(long, value_name = "FILE", requires = "emulated")]
    image: Option<PathBuf>,
    /// Connect to the controller on this serial port, which drives motors.
    #[arg(long, conflicts_with = "emulated")]
    port: Option<String>,
    /// Store the robot's settings on the controller on the port.
    #[arg(long, requires = "port")]
    upload: bool,
}

impl ControllerArgs {
    /// The image of the emulated board, for the drives of this robot.
    pub(super) fn image(&self, robot: &Robot) -> PathBuf {
        let image = self.image.clone();
        image.unwrap_or_else(|| Emulator::built_image(Machine::of(robot.drive_kind()).emulated))
    }

    /// Whether the controller and its arm are simulated in this process.
    pub(super) fn is_simulated(&self) -> bool {
        self.port.is_none() && !self.emulated
    }

    /// The controller that is asked for.
    pub(super) fn source<'a>(&'a self, image: &'a Path) -> ControllerSource<'a> {
        match &self.port {
            Some(name) => ControllerSource::Port {
                name,
                upload: self.upload,
            },
            None if self.emulated => ControllerSource::Emulated(image),
            None => ControllerSource::Simulated,
        }
    }
}

/// The failure, with its likely cause where the board is emulated.
pub(super) fn described(error: OpenError, args: &ControllerArgs, robot: &Robot) -> Failure {
    match error {
        OpenError::Link(_) | OpenError::Refused(_) if args.emulated => refused(format_args!(
            "{error}; {}",
            Emulator::likely_cause(&args.image(robot))
        )),
        other => refused(other),
    }
}

pub(super) fn address(text: &str) -> Result<SocketAddr, ValueError> {
    let address = text.parse();
    address.map_err(|_| ValueError::Address)
}

/// Serves the guided page.
fn commission(args: &Args, out: &Path) -> Result<(), Failure> {
    let guard = Guard::with_new_token().map_err(refused)?;
    let query = format!("?token={}", guard.token());
    let options = Options {
        port: args
            .controller
            .port
            .clone()
            .unwrap_or_else(|| "simulated".into()),
        robot: args.controller.robot.clone(),
        scenario: args.scenario.clone(),
        out: out.into(),
        points: None,
    };
    let ready = |address| {
        say(format_args!(
            "the commissioning of {} is at http://{}/{query}",
            options.robot,
            reached(address)
        ))
        .unwrap_or_else(warn);
    };
    let interrupted = interrupted()?;
    let ends = move || interrupted.load(Ordering::Relaxed);
    guided(&options, args.listen, guard, Clock::real(), ready, ends).map_err(refused)
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if let Some(out) = &args.commission {
        return commission(args, out);
    }
    let robot = Robot::load(&args.controller.robot).map_err(refused)?;
    warn_of_drivers(&robot);
    let guard = Guard::with_new_token().map_err(refused)?;
    let query = format!("?token={}", guard.token());
    let image = args.controller.image(&robot);
    let source = args.controller.source(&image);
    let ready = |address, endpoints: Option<&Endpoints>| {
        say(format_args!(
            "{} is at http://{}/{query}",
            robot.name,
            reached(address)
        ))
        .unwrap_or_else(warn);
        if let Some(endpoints) = endpoints {
            say(format_args!("senders: {endpoints}")).unwrap_or_else(warn);
            if let Some(warning) = endpoints.warning() {
                warn(warning);
            }
        }
    };
    let interrupted = interrupted()?;
    let ends = move || interrupted.load(Ordering::Relaxed);
    let options = ServeOptions {
        address: args.listen,
        guard,
        senders: bridge::for_pages(args.senders.map(BridgeOptions::at)),
        time_optimal: args.time_optimal.then_some(args.torque_share),
        keep: keep(args.controller.robot.clone()),
        jobs: APART,
        clock: Clock::real(),
    };
    let served = serve(&robot, source, options, ready, ends);
    served.map_err(|error| match error {
        ServeError::Open(error) => described(error, &args.controller, &robot),
        ServeError::Link(error) => described(error.into(), &args.controller, &robot),
        other => refused(other),
    })
}

/// What writes values to the robot's file, the old one kept.
pub(super) fn keep(robot: String) -> KeepValues {
    Box::new(move |values| {
        if BuiltIn::find(&robot).is_some() {
            return Err(format!(
                "{robot} is a built-in robot: write its file with `fivebar robots {robot} > my-arm.toml`, then use --robot my-arm.toml."
            ));
        }
        rewrite(&robot, Path::new(&robot), values).map_err(|failure| format!("{failure}."))
    })
}

/// The address at which others reach a server that listens on all of this computer's
/// addresses.
fn reached(mut address: SocketAddr) -> SocketAddr {
    if address.ip().is_unspecified() {
        address.set_ip(own_address().unwrap_or_else(|| address.ip()));
    }
    address
}

/// This computer's address in its network. Connecting a datagram socket shows it; the remote
/// address is one reserved for documentation, and nothing is sent.
fn own_address() -> Option<IpAddr> {
    let socket = UdpSocket::bind("0.0.0.0:0").ok()?;
    socket.connect("192.0.2.1:9").ok()?;
    Some(socket.local_addr().ok()?.ip())
}
