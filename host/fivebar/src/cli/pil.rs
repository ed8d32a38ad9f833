//! `fivebar pil`: the firmware on an emulated Cortex-M4F, in lockstep with the simulated arm.

use super::failure::{Failure, refused};
use super::lockstep::{self, LockstepArgs, RemoteController};
use fivebar_sim::link::Emulator;
use fivebar_sim::machine::Machine;
use std::path::PathBuf;

/// Runs a job on the firmware on an emulated board, in lockstep with the simulated arm.
///
/// All outputs are compared bit by bit with the same run in this process.
/// scripts/firmware.sh builds the image for the board.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    run: LockstepArgs,
    /// The image of the emulated board; by default that for the robot's kind of drives, as scripts/firmware.sh builds it.
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let scenario = args.run.scenario()?;
    let image = args.image.clone().unwrap_or_else(|| {
        Emulator::built_image(Machine::of(scenario.robot.drive_kind()).emulated)
    });
    let board = RemoteController {
        name: "the emulated board",
        command: "pil",
        unit: "instructions",
        likely_cause: &Emulator::likely_cause(&image),
    };
    lockstep::run(&args.run, &scenario, &board, || {
        Ok(Box::new(Emulator::start(&image).map_err(refused)?))
    })
}
