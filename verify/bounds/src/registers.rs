//! Registers that make the core wait.
//!
//! A register behind a bridge to a slower bus answers late. A transfer takes two of that bus's clocks, the bridge up to one
//! more to begin with one, and a cycle: with r cycles of the core in a clock of the bus, 1 + 2 r to 1 + 3 r. The machine code
//! does not show which access goes to such a register, so these are counted where it runs, on the simulated chip, and added
//! to the bounds of the tick's interrupt and of the response.

use crate::families::STM32F405;
use crate::report::Row;
use crate::response::{Driving, RESPONSE};

/// Cycles of the core in a clock of APB1 and of APB2, at 42 and 84 MHz.
const RATIOS: [u64; 2] = [4, 2];

/// Cycles of an access over a bus with so many cycles of the core in a clock, at most.
const fn most(ratio: u64) -> u64 {
    1 + 3 * ratio
}

/// What a tick of an image waits for its registers.
pub struct Waits {
    /// The image.
    pub driving: &'static Driving,
    /// Accesses over APB1 and over APB2.
    pub accesses: [u64; 2],
}

impl Waits {
    /// Cycles of all accesses, at most.
    pub fn cycles(&self) -> u64 {
        let [first, second] = self.accesses;
        let [slow, quick] = RATIOS;
        first * most(slow) + second * most(quick)
    }

    /// The bound of a row where the code waits, with the waits, and its limit [cycles].
    pub fn bound(&self, rows: &[Row], name: &str) -> Option<(u64, u64)> {
        let row = rows
            .iter()
            .find(|row| row.name == self.driving.labelled(name))?;
        let [_, _, code_waits, _] = row.longest?;
        Some((code_waits + self.cycles(), self.driving.budget(name)?))
    }

    /// The bounds of the tick's interrupt and of the response.
    pub fn bounds(&self, rows: &[Row]) -> Option<[(u64, u64); 2]> {
        let interrupt = self.bound(rows, self.driving.tick)?;
        Some([interrupt, self.bound(rows, RESPONSE)?])
    }
}

/// The counts of the images, in the text in which the simulated chip has them; none if one is missing.
pub fn counted(text: &str) -> Option<Vec<Waits>> {
    let of = |driving: &'static Driving| {
        let counts = text
            .lines()
            .find_map(|line| line.strip_prefix(driving.label)?.strip_prefix(": "))?;
        let (first, second) = counts.split_once(' ')?;
        let accesses = [first.parse().ok()?, second.parse().ok()?];
        Some(Waits { driving, accesses })
    };
    STM32F405.images.iter().map(of).collect()
}
