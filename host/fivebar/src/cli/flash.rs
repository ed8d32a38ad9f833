//! `fivebar flash`: an image on a board.

use super::failure::{Failure, refused};
use super::say::say;
use crate::flash::{DriveKind, commands_of_first_board, drives, image, kind};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What to do where no board is found.
const HOLD: &str = "hold BOOTSEL of the Pico 2, connect USB, release BOOTSEL: the drive RP2350 appears; if your system does not \
                    mount it, open it in the file manager, name its folder with --drive, or install picotool";

/// Writes an image to a Pico 2 in its boot loader; of an STM32F405, says the commands.
///
/// The file is checked before the board gets anything: whole, for the RP2350, one of the images, not over the settings. It is then
/// copied to the drive of the board, or handed to picotool if that is installed and no drive is there. The settings stay.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The file, such as rp2350_servo.uf2, or the name of an image that was built here.
    image: PathBuf,
    /// The folder where the board's drive is mounted, if it is not found.
    #[arg(long, value_name = "DIR")]
    drive: Option<PathBuf>,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let name = args.image.file_stem().unwrap_or_default();
    let name = name.to_string_lossy().into_owned();
    if let Some(at) = name.find("stm32f405") {
        let [probe, usb] = commands_of_first_board(&name[at..]);
        return Err(refused(format_args!(
            "{name} is for an STM32F405, which has no drive; with a debug probe: {probe}; over USB with BOOT0 held: {usb}"
        )));
    }
    let path = built_or_named(&args.image);
    let shown = path.display();
    let file = std::fs::read(&path).map_err(|error| {
        refused(format_args!(
            "{shown}: {error}; build it with scripts/pico.sh image, or take it from the release"
        ))
    })?;
    let image = image(&file).map_err(|error| refused(format_args!("{shown}: {error}")))?;
    if let Some(drive) = find_drive(args.drive.as_deref())? {
        copy(&file, &drive.join(format!("{image}.uf2")))?;
        return say(format_args!(
            "{image} is on the board, {} KiB; its drive goes and its serial line comes",
            file.len() / 2 / 1024
        ));
    }
    match Command::new("picotool")
        .args(["load", "-v", "-x"])
        .arg(&path)
        .status()
    {
        Ok(status) if status.success() => say(format_args!("{image} is on the board")),
        Ok(_) => Err(refused(format_args!("picotool did not write it; {HOLD}"))),
        Err(_) => Err(refused(format_args!(
            "no Pico 2 in its boot loader; {HOLD}"
        ))),
    }
}

/// The file of an image that is only named.
fn built_or_named(image: &Path) -> PathBuf {
    if image.extension().is_some() {
        return image.to_owned();
    }
    let built = Path::new("target/firmware/thumbv8m.main-none-eabihf/firmware");
    built.join(image).with_extension("uf2")
}

/// The drive of the one board that is there.
fn find_drive(named: Option<&Path>) -> Result<Option<PathBuf>, Failure> {
    let Some(folder) = named else {
        let mut found = drives();
        if found.len() > 1 {
            return Err(refused(format_args!(
                "{} boards are in their boot loaders: name the drive of one with --drive, such as --drive {}",
                found.len(),
                found[0].display()
            )));
        }
        return Ok(found.pop());
    };
    let shown = folder.display();
    match kind(folder) {
        DriveKind::Ours => Ok(Some(folder.to_owned())),
        DriveKind::Other(board) => Err(refused(format_args!(
            "{shown} is the drive of another board ({board}): the image is for an RP2350 (Pico 2)"
        ))),
        DriveKind::None => Err(refused(format_args!(
            "{shown} has no INFO_UF2.TXT, so it is not the drive of a boot loader; {HOLD}"
        ))),
    }
}

/// Copies the file. The board takes it only when all blocks have come: what is cut off leaves it in its boot loader.
fn copy(file: &[u8], to: &Path) -> Result<(), Failure> {
    let copied = std::fs::File::create(to).and_then(|mut target| {
        target.write_all(file)?;
        target.sync_all()
    });
    copied.map_err(|error| {
        refused(format_args!(
            "{}: {error}; the board has not taken the image: connect it again with BOOTSEL held, and repeat the command",
            to.display()
        ))
    })
}
