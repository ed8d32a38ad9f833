//! Files for drag and drop (Microsoft's UF2), as `uf2.py` of the board's folder writes them: what must be true of one before a board gets it.

use std::collections::BTreeSet;

/// Bytes of a block and of what it carries.
const BLOCK: usize = 512;
const CARRIED: u32 = 256;
/// The first, second and last word of a block.
const MARKS: [u32; 3] = [0x0a32_4655, 0x9e5d_5157, 0x0ab1_6f30];
/// The flag that says that the family is stated.
const FAMILY_IS_STATED: u32 = 0x2000;
/// Programs for the Arm cores of an RP2350, and others that people mistake for them.
const FAMILY: u32 = 0xe48b_ff59;
const OTHERS: [(u32, &str); 3] = [
    (0xe48b_ff56, "an RP2040 (Pico 1)"),
    (0xe48b_ff5a, "the RISC-V cores of an RP2350"),
    (0xe48b_ff5b, "an RP2350 without security"),
];
/// What the boot loader of an RP2350 says of itself.
pub(super) const BOARD_ID: &str = "Board-ID: RP2350";
/// Where programs lie: behind them are the settings.
const PROGRAM: std::ops::Range<u32> = 0x1000_0000..0x1008_0000;
/// The images for an RP2350, as each has its name in it.
const IMAGES: [&str; 2] = ["rp2350_servo", "rp2350_stepper"];

/// Why a file is not for a Pico 2.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum Uf2Error {
    /// It is none, or is damaged.
    #[error(
        "block {0} is damaged, or the file is no UF2: build it with scripts/pico.sh image, or take it from the release again"
    )]
    Block(usize),
    /// It ends early, or has a block twice.
    #[error("it has {0} of its {1} blocks: copy or build it again")]
    Incomplete(usize, u32),
    /// It is for another chip.
    #[error(
        "it is for {0}, and not for the Arm cores of an RP2350 (Pico 2): take rp2350_servo.uf2 or rp2350_stepper.uf2"
    )]
    Family(String),
    /// It would be written where no program lies.
    #[error(
        "block {0} goes to {1:#x}, outside {start:#x} to {end:#x}: behind it lie the settings",
        start = PROGRAM.start,
        end = PROGRAM.end
    )]
    Place(usize, u32),
    /// It is a program, but none of ours.
    #[error("it holds none of the images {}", IMAGES.join(" and "))]
    Foreign,
}

/// The image that a file holds, whose blocks are all there.
///
/// # Errors
/// Why it is not for a Pico 2.
pub fn image(file: &[u8]) -> Result<&'static str, Uf2Error> {
    let mut numbers = BTreeSet::new();
    let mut carried: Vec<u8> = Vec::new();
    let mut all = 0;
    for (number, block) in file.chunks(BLOCK).enumerate() {
        let word = |at: usize| {
            let bytes = block.get(at..at + 4)?.try_into().ok()?;
            Some(u32::from_le_bytes(bytes))
        };
        let words: Option<Vec<u32>> = (0..BLOCK).step_by(4).map(word).collect();
        let words = words.ok_or(Uf2Error::Block(number))?;
        let is_block = [words[0], words[1], words[127]] == MARKS && words[4] == CARRIED;
        if !is_block || words[2] & FAMILY_IS_STATED == 0 {
            return Err(Uf2Error::Block(number));
        }
        if words[7] != FAMILY {
            let known = OTHERS.iter().find(|(family, _)| *family == words[7]);
            let name = known.map_or_else(
                || format!("the family {:#x}", words[7]),
                |(_, name)| (*name).to_owned(),
            );
            return Err(Uf2Error::Family(name));
        }
        if !PROGRAM.contains(&words[3]) || words[3] % CARRIED != 0 {
            return Err(Uf2Error::Place(number, words[3]));
        }
        all = words[6];
        numbers.insert(words[5]);
        carried.extend(&block[32..32 + CARRIED as usize]);
    }
    let blocks = file.len().div_ceil(BLOCK);
    let complete = numbers.iter().copied().eq(0..all) && blocks == numbers.len();
    if !complete || all == 0 {
        return Err(Uf2Error::Incomplete(numbers.len(), all));
    }
    let holds = |name: &&&str| {
        carried
            .windows(name.len())
            .any(|part| part == name.as_bytes())
    };
    IMAGES.iter().find(holds).copied().ok_or(Uf2Error::Foreign)
}
