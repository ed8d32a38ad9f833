//! Prints how the checker reads each instruction of an image, for a comparison with another
//! disassembler: `scripts/bounds.sh` compares it with LLVM's.
//!
//! A line has the address, the accesses to memory, whether the flags may change, where the program
//! goes and what happens to the stack pointer.

use fivebar_bounds::image::Image;
use fivebar_bounds::{narrow, wide};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("usage: decode <image>")?;
    let image = Image::read(&std::fs::read(path)?)?;
    for function in image.functions() {
        let mut address = function.address;
        while address < function.end {
            if let Some(end) = image.end_of_data(address) {
                address = end;
                continue;
            }
            let Some(half) = image.half(address) else {
                break;
            };
            let instruction = if half >> 11 < 0b11101 {
                narrow::decode(address, half)
            } else {
                wide::decode(address, half, image.half(address + 2).unwrap_or(0))
            };
            println!(
                "{address:x}|{}|{}|{:?}|{:?}",
                instruction.accesses, instruction.sets_flags, instruction.flow, instruction.stack
            );
            address += instruction.length;
        }
    }
    Ok(())
}
