//! `fivebar hil`: the firmware on a board, in lockstep with the simulated arm.

use super::failure::{Failure, refused};
use super::lockstep::{self, LockstepArgs, RemoteController};
use fivebar_sim::link::SerialLine;
use fivebar_sim::machine::Machine;

/// Runs a job on a board without motors, in lockstep with the simulated arm.
///
/// All outputs are compared bit by bit with the same run in this process. The board, on a
/// serial port, has the image `qemu`, for steppers `qemu_stepper`, for drives on a CAN bus
/// `qemu_can`, which exchanges frames instead of driving motors and reading sensors; no motor moves.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    run: LockstepArgs,
    /// The board's serial port, such as /dev/ttyACM0 or COM3.
    #[arg(long)]
    port: String,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let scenario = args.run.scenario()?;
    let board = RemoteController {
        name: &args.port,
        command: "hil",
        unit: "ns",
        likely_cause: &format!(
            "if its image `{}` is older than this program, build it again with scripts/firmware.sh and flash it",
            Machine::of(scenario.robot.drive_kind()).emulated
        ),
    };
    lockstep::run(&args.run, &scenario, &board, || {
        Ok(Box::new(SerialLine::open(&args.port).map_err(refused)?))
    })
}
