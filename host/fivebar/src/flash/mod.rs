//! Images on boards: which file fits, where the board is, and how it gets there.

mod uf2;

pub use uf2::{Uf2Error, image};

use std::path::{Path, PathBuf};

/// The file by which a boot loader says which chip it is of.
const INFO: &str = "INFO_UF2.TXT";
/// What a folder is, as a drive of a board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DriveKind {
    /// The boot loader of a board that takes our files.
    Ours,
    /// That of another board, by what it says of itself.
    Other(String),
    /// No drive of a boot loader.
    None,
}

/// What a folder is.
pub fn kind(folder: &Path) -> DriveKind {
    let Ok(text) = std::fs::read_to_string(folder.join(INFO)) else {
        return DriveKind::None;
    };
    if text.lines().any(|line| line.trim() == uf2::BOARD_ID) {
        return DriveKind::Ours;
    }
    let line = text.lines().find(|line| line.starts_with("Board-ID"));
    DriveKind::Other(line.unwrap_or("no Board-ID").trim().to_owned())
}

/// The drives of such boards that are mounted where systems mount them.
pub fn drives() -> Vec<PathBuf> {
    let folders = |path: &str| {
        let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
        entries.map(|entry| entry.path()).collect::<Vec<_>>()
    };
    let users = ["/media", "/run/media"].map(folders).concat();
    let below = users
        .iter()
        .flat_map(|user| folders(&user.to_string_lossy()));
    let letters = if cfg!(windows) { 'D'..='Z' } else { 'Z'..='D' };
    let mut found: Vec<PathBuf> = folders("/Volumes");
    found.extend(below);
    found.extend(users.iter().cloned());
    found.extend(letters.map(|letter| PathBuf::from(format!("{letter}:\\"))));
    found.retain(|folder| kind(folder) == DriveKind::Ours);
    found
}

/// The commands that bring an image to an STM32F405, as docs/use/bring-up.md has them.
pub fn commands_of_first_board(image: &str) -> [String; 2] {
    [
        format!(
            "probe-rs run --chip STM32F405RGTx target/firmware/thumbv7em-none-eabihf/firmware/{image}"
        ),
        format!("dfu-util -d 0483:df11 -a 0 -s 0x08000000 -D out/images/fivebar-*-{image}.bin"),
    ]
}
