//! Functions that are given as machine code.

use fivebar_bounds::image::Image;
use fivebar_bounds::program::{Bounds, Program};
use fivebar_bounds::stated::Stated;
use fivebar_bounds::{Defect, Fault};

/// Where the code lies.
pub(crate) const ADDRESS: u32 = 0x0800_0000;

/// The bounds and the defects of the function `f`, the first of the code.
pub(crate) fn examine(image: &Image, stated: &str) -> (Bounds, Vec<Fault>) {
    let stated = Stated::read(stated).expect("statements");
    let mut program = Program::new(image, &stated);
    let bounds = program.bounds(ADDRESS).clone();
    let fault = |defect: Defect| defect.fault;
    (
        bounds,
        program.defects(ADDRESS).into_iter().map(fault).collect(),
    )
}

pub(crate) fn function(code: &[u16]) -> Image {
    let end = 2 * code.len() as u32;
    Image::of_code(ADDRESS, code, &[("f", 0, end)])
}

/// The longest path [instructions], the stack [bytes] and the defects of one function.
pub(crate) fn alone(code: &[u16], stated: &str) -> (u64, u32, Vec<Fault>) {
    let (bounds, faults) = examine(&function(code), stated);
    (bounds.longest[0], bounds.stack, faults)
}
