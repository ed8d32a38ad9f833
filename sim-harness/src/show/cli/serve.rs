//! `fivebar serve`: the live page.

use super::failure::{Failure, refused};
use super::port::interrupted;
use super::say::{say, warn};
use crate::input::robot::{BuiltIn, Robot};
use crate::run::link::Emulator;
use crate::show::serve::{ControllerSource, Guard, ServeError, serve};
use std::net::{IpAddr, SocketAddr, UdpSocket};
use std::path::PathBuf;
use std::sync::atomic::Ordering;

/// Serves a live page: an arm in a browser, to be watched, jogged and given jobs.
///
/// The arm is simulated in real time unless another one is asked for.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A built-in robot (see `fivebar robots`) or a robot file.
    #[arg(long, default_value = BuiltIn::DEFAULT)]
    robot: String,
    /// Run the firmware on an emulated Cortex-M4F with the simulated arm around it, slower
    /// than real time.
    #[arg(long)]
    emulated: bool,
    /// The image of the emulated board; scripts/firmware.sh builds it.
    #[arg(long, value_name = "FILE", requires = "emulated")]
    image: Option<PathBuf>,
    /// A controller on this serial port, which drives motors.
    #[arg(long, conflicts_with = "emulated")]
    port: Option<String>,
    /// Give the robot's settings to the controller on the port and store them there.
    #[arg(long, requires = "port")]
    upload: bool,
    /// Where to listen, port 0 being any free one. Away from this machine's own address,
    /// only those may connect who show the token that is printed; it is sent unencrypted.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8105", value_parser = address)]
    listen: SocketAddr,
}

fn address(text: &str) -> Result<SocketAddr, String> {
    let address = text.parse();
    address.map_err(|_| "give an address in numbers and a port, such as 127.0.0.1:9000".into())
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let robot = Robot::load(&args.robot).map_err(refused)?;
    let guard = if args.listen.ip().is_loopback() {
        Guard::of_loopback()
    } else {
        Guard::with_new_token().map_err(refused)?
    };
    let query = guard.token().map(|token| format!("?token={token}"));
    let query = query.unwrap_or_default();
    let image = args.image.clone();
    let image = image.unwrap_or_else(|| Emulator::built_image("qemu"));
    let source = match &args.port {
        Some(name) => ControllerSource::Port {
            name,
            upload: args.upload,
        },
        None if args.emulated => ControllerSource::Emulated(&image),
        None => ControllerSource::Simulated,
    };
    let ready = |address| {
        say(format_args!(
            "{} is at http://{}/{query}",
            robot.name,
            reached(address)
        ))
        .unwrap_or_else(warn);
    };
    let interrupted = interrupted()?;
    let ends = move || interrupted.load(Ordering::Relaxed);
    let served = serve(&robot, source, args.listen, guard, ready, ends);
    served.map_err(|error| match error {
        ServeError::Link(_) | ServeError::Refused(_) if args.emulated => {
            refused(format_args!("{error}; {}", Emulator::likely_cause(&image)))
        }
        other => refused(other),
    })
}

/// Where others reach a server that listens at all of this machine's addresses.
fn reached(mut address: SocketAddr) -> SocketAddr {
    if address.ip().is_unspecified() {
        address.set_ip(own_address().unwrap_or_else(|| address.ip()));
    }
    address
}

/// The address from which this machine would reach others. A socket for datagrams finds it
/// by being connected; nothing is sent, to an address that is reserved for documents.
fn own_address() -> Option<IpAddr> {
    let socket = UdpSocket::bind("0.0.0.0:0").ok()?;
    socket.connect("192.0.2.1:9").ok()?;
    Some(socket.local_addr().ok()?.ip())
}
