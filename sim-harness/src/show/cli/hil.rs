//! `fivebar hil`: the firmware on a board, the arm simulated around it.

use super::failure::{Failure, refused};
use super::lockstep::{self, LockstepArgs, Other};
use crate::run::link::SerialLine;

/// Runs a job on a board without motors, in lockstep with the simulated arm.
///
/// Every bit is compared with the same run in this process. The board, on a serial port,
/// carries the image `qemu`, whose bridges and sensors are frames; no motor moves.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    run: LockstepArgs,
    /// The board's serial port, such as /dev/ttyACM0 or COM3.
    #[arg(long)]
    port: String,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let board = Other {
        name: &args.port,
        unit: "ns",
        likely_cause: "if its image `qemu` is older than this program, build it anew with \
                    scripts/firmware.sh and flash it",
    };
    lockstep::run(&args.run, &board, || {
        Ok(Box::new(SerialLine::open(&args.port).map_err(refused)?))
    })
}
