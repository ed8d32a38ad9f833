//! What the image needs of the boot ROM: the search for its functions, and those that erase and program the flash. Each is an
//! endless loop at an address of its own; the chip does its work when the core is there, and lets it return when it is done.

/// Where the ROM has the address of its search.
pub(crate) const LOOKUP_POINTER: usize = 0x16;
const LOOKUP: u32 = 0x100;
/// `udf #0` is there, which no core executes.
pub(crate) const UNDEFINED: u32 = 0x300;
/// `b .` is there: a program that hangs.
pub(crate) const HANGS: u32 = 0x310;
/// `b .`
const LOOP: u16 = 0xe7fe;
/// The functions by their codes.
const FUNCTIONS: [([u8; 2], u32, Function); 6] = [
    (*b"IF", 0x110, Function::Connect),
    (*b"EX", 0x120, Function::LeaveXip),
    (*b"RE", 0x130, Function::Erase),
    (*b"RP", 0x140, Function::Program),
    (*b"FC", 0x150, Function::FlushCache),
    (*b"CX", 0x160, Function::EnterXip),
];

/// A function of the ROM.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    Lookup,
    Connect,
    LeaveXip,
    Erase,
    Program,
    FlushCache,
    EnterXip,
}

/// The ROM's bytes.
pub(crate) fn bytes() -> Vec<u8> {
    let mut rom = vec![0; 32 * 1024];
    rom[LOOKUP_POINTER..LOOKUP_POINTER + 2].copy_from_slice(&((LOOKUP | 1) as u16).to_le_bytes());
    for at in FUNCTIONS
        .map(|(_, at, _)| at)
        .into_iter()
        .chain([LOOKUP, HANGS])
    {
        rom[at as usize..at as usize + 2].copy_from_slice(&LOOP.to_le_bytes());
    }
    rom[UNDEFINED as usize + 1] = 0xde;
    rom
}

/// The function at an address.
pub(crate) fn at(address: u32) -> Option<Function> {
    if address == LOOKUP {
        return Some(Function::Lookup);
    }
    let found = FUNCTIONS.iter().find(|(_, at, _)| *at == address);
    found.map(|(.., function)| *function)
}

/// The address of the function with this code; 0 if there is none.
pub(crate) fn find(code: u32) -> u32 {
    let code = (code as u16).to_le_bytes();
    let found = FUNCTIONS.iter().find(|(name, ..)| *name == code);
    found.map_or(0, |(_, at, _)| at | 1)
}
