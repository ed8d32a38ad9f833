//! Which instruction of a block made an access: the emulator tells the block only.

/// The address of the first load or store in a block of code whose effective address is
/// `target`; `register` gives R0…R15 as they are now.
pub(crate) fn access_in(
    code: &[u8],
    start: u32,
    target: u32,
    writes: bool,
    register: impl Fn(u32) -> u32,
) -> Option<u32> {
    let half = |at: usize| {
        Some(u32::from(u16::from_le_bytes([
            *code.get(at)?,
            *code.get(at + 1)?,
        ])))
    };
    let mut at = 0;
    while let Some(first) = half(at) {
        let wide = first >= 0xe800;
        let found = if wide {
            half(at + 2).and_then(|second| wide_access(first, second, &register))
        } else {
            narrow_access(first, &register)
        };
        if found.is_some_and(|(address, store)| address & !3 == target & !3 && store == writes) {
            return Some(start + at as u32);
        }
        at += if wide { 4 } else { 2 };
    }
    None
}

/// The address of a 16-bit load or store, and whether it stores.
fn narrow_access(code: u32, register: &impl Fn(u32) -> u32) -> Option<(u32, bool)> {
    let base = register(code >> 3 & 7);
    let immediate = code >> 6 & 31;
    let store = code >> 11 & 1 == 0;
    match code >> 12 {
        // A register as the offset; the first three of eight store.
        5 => Some((
            base.wrapping_add(register(code >> 6 & 7)),
            code >> 9 & 7 < 3,
        )),
        6 => Some((base.wrapping_add(4 * immediate), store)),
        7 => Some((base.wrapping_add(immediate), store)),
        8 => Some((base.wrapping_add(2 * immediate), store)),
        _ => None,
    }
}

/// The address of a 32-bit load or store of one or two registers, and whether it stores.
fn wide_access(first: u32, second: u32, register: &impl Fn(u32) -> u32) -> Option<(u32, bool)> {
    let base = register(first & 15);
    let store = first >> 4 & 1 == 0;
    let signed = |up: bool, offset: u32| {
        if up {
            base.wrapping_add(offset)
        } else {
            base.wrapping_sub(offset)
        }
    };
    match first >> 5 {
        // Single data item: an immediate of 12 bits, or 8 bits, or a register.
        0b111_1100_0100..=0b111_1100_1111 if first >> 7 & 1 != 0 => {
            Some((base.wrapping_add(second & 0xfff), store))
        }
        0b111_1100_0000..=0b111_1100_1111 if second >> 11 & 1 != 0 => {
            Some((signed(second >> 9 & 1 != 0, second & 0xff), store))
        }
        0b111_1100_0000..=0b111_1100_1111 => {
            let offset = register(second & 15) << (second >> 4 & 3);
            Some((base.wrapping_add(offset), store))
        }
        // Two registers at once, with an immediate.
        0b111_0100_0000..=0b111_0100_1111 if first >> 6 & 1 != 0 => {
            Some((signed(first >> 7 & 1 != 0, 4 * (second & 0xff)), store))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::access_in;

    #[test]
    fn finds_the_store_among_loads_of_the_same_register() {
        // ldr r0, [r1, #4]; orr r0, r0, #1; str r0, [r1, #4]; str.w r0, [r2, #0x44];
        // strb r0, [r2, r3]
        let code = [
            0x48, 0x68, 0x40, 0xf0, 0x01, 0x00, 0x48, 0x60, 0xc2, 0xf8, 0x44, 0x00, 0xd0, 0x54,
        ];
        let register = |n: u32| [0, 0x4000_0000, 0x4001_0000, 8][n as usize];
        let find = |target, writes| access_in(&code, 0x100, target, writes, register);
        assert_eq!(find(0x4000_0004, false), Some(0x100));
        assert_eq!(find(0x4000_0004, true), Some(0x106));
        assert_eq!(find(0x4001_0044, true), Some(0x108));
        assert_eq!(find(0x4001_0008, true), Some(0x10c));
        assert_eq!(find(0x4001_0044, false), None);
    }
}
