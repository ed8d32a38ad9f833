//! `fivebar serve`: the live page.

use super::failure::{Failure, refused};
use crate::robot::{BuiltIn, Robot};
use crate::serve::{Guard, serve};
use std::net::SocketAddr;

/// Serves a live page on this machine: the simulated arm, or the one on a port, in a browser.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A built-in robot (see `fivebar robots`) or a robot file.
    #[arg(long, default_value = BuiltIn::DEFAULT)]
    robot: String,
    /// A controller on this serial port instead of the simulated arm.
    #[arg(long)]
    port: Option<String>,
    /// Where to listen, port 0 being any free one. Away from this machine's own address,
    /// only those may connect who show the token that is printed; it is sent unencrypted.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8105")]
    listen: SocketAddr,
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
    let ready = |address| println!("{} is at http://{address}/{query}", robot.name);
    serve(&robot, args.port.as_deref(), args.listen, guard, ready).map_err(refused)
}
