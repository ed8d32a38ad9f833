//! What the manual forbids ends the run, and the report says what, by which instruction, and
//! from which source line.

mod bench;

use bench::Bench;
use fivebar_chip::Options;
use fivebar_chip::time::MILLISECOND;

/// Code in RAM, with R0 as an address and R1 as a value: runs it, and gives the report.
fn report(code: [u32; 2], address: u32, value: u32) -> String {
    let bench = Bench::with(Options::default(), Vec::new(), 0);
    let mut chip = bench.line.chip();
    chip.run(MILLISECOND / 10).expect("a sound start");
    let place = 0x2001_f000;
    // ldr r0, [pc, #8]; ldr r1, [pc, #8]; the code; the literals.
    chip.write_ram_word(place, 0x4902_4801);
    chip.write_ram_word(place + 4, code[0]);
    chip.write_ram_word(place + 8, address);
    chip.write_ram_word(place + 12, value);
    chip.write_ram_word(place + 16, code[1]);
    chip.go_on_at(place);
    let ended = chip.run(MILLISECOND).expect_err("a violation");
    ended.to_string()
}

/// str r1, [r0]; b .
const STORE: [u32; 2] = [0xe7fe_6001, 0];
/// ldr r1, [r0]; b .
const LOAD: [u32; 2] = [0xe7fe_6801, 0];

#[test]
fn a_reserved_bit() {
    // RCC_CR, bit 2.
    let report = report(STORE, 0x4002_3800, 0x87);
    assert!(
        report.contains("RCC_CR = 0x00000087: reserved bits 0x4 changed"),
        "{report}"
    );
}

#[test]
fn a_peripheral_without_a_clock() {
    let report = report(LOAD, 0x4000_0424, 0);
    assert!(report.contains("0x40000424 is read"), "{report}");
    let report = self::report(STORE, 0x4001_0000, 1);
    assert!(report.contains("Tim1 has no clock"), "{report}");
}

#[test]
fn an_operation_on_a_locked_register() {
    // FLASH_CR while it is locked.
    let report = report(STORE, 0x4002_3c10, 2);
    assert!(
        report.contains("FLASH_CR = 0x00000002: the register is locked"),
        "{report}"
    );
}

#[test]
fn the_core_coupled_memory_holds_no_code_has_no_bits_of_its_own_and_keeps_its_clock() {
    const CCM: u32 = 0x1000_0000;
    // str r1, [r0]; bx r0.
    let report = report([0x4700_6001, 0], CCM | 1, 0xbf00_bf00);
    assert!(report.contains("no code at this address"), "{report}");
    // Where the alias of its bits would be.
    let report = self::report(STORE, CCM + 0x0200_0000, 1);
    assert!(report.contains("0x12000000 = 0x00000001"), "{report}");
    // RCC_AHB1ENR without its bit.
    let report = self::report(STORE, 0x4002_3830, 0);
    assert!(report.contains("loses its clock"), "{report}");
}

#[test]
fn an_address_without_memory() {
    let report = report(STORE, 0x3000_0000, 5);
    assert!(report.contains("0x30000000 = 0x00000005"), "{report}");
}
