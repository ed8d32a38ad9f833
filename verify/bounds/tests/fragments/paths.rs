//! Small pieces of machine code whose longest paths are counted by hand.

use crate::code::{ADDRESS, alone, examine, function};
use fivebar_bounds::Fault;
use fivebar_bounds::image::Image;
use fivebar_bounds::program::Program;
use fivebar_bounds::stated::Stated;

const CALLS: &[u16] = &[
    0xb580, // f: push {r7, lr}
    0xf000, 0xf803, // bl g
    0xf000, 0xf801, // bl g
    0xbd80, // pop {r7, pc}
    0xb084, // g: sub sp, #16
    0xb004, // add sp, #16
    0xf000, 0xb800, // b.w h
    0xb410, // h: push {r4}
    0xbc10, // pop {r4}
    0x4770, // bx lr
];

#[test]
fn the_longer_of_two_ways_counts() {
    let code = [
        0x2800, // cmp r0, #0
        0xd103, // bne 1f
        0x3101, // adds r1, #1
        0x3101, // adds r1, #1
        0x3101, // adds r1, #1
        0x4770, // bx lr
        0x3102, // 1: adds r1, #2
        0x4770, // bx lr
    ];
    assert_eq!(alone(&code, ""), (6, 0, vec![]));
}

#[test]
fn a_loop_needs_a_bound_and_then_counts_as_often() {
    let code = [
        0x2004, // movs r0, #4
        0x3801, // 1: subs r0, #1
        0xd1fd, // bne 1b
        0x4770, // bx lr
    ];
    assert_eq!(alone(&code, "").2, [Fault::Loop]);
    assert_eq!(
        alone(&code, "loop 4 f #1 ; r0 counts from 4"),
        (1 + 4 * 2 + 1, 0, vec![])
    );
    assert_eq!(
        alone(&code, "total 3 f #1 ; r0 counts from 4"),
        (1 + 4 * 2 + 1, 0, vec![])
    );
}

#[test]
fn a_loop_to_the_functions_first_instruction_is_one() {
    let code = [
        0x3801, // 1: subs r0, #1
        0xd1fd, // bne 1b
        0x4770, // bx lr
    ];
    assert_eq!(alone(&code, "").2, [Fault::Loop]);
    let bound = "loop 4 f #1 ; for the test";
    assert_eq!(alone(&code, bound), (4 * 2 + 1, 0, vec![]));
    // b .
    assert_eq!(alone(&[0xe7fe], "").2, [Fault::Loop]);
}

#[test]
fn a_loop_in_a_loop_counts_the_product_or_a_total() {
    let code = [
        0x2003, // movs r0, #3
        0x2105, // 1: movs r1, #5
        0x3901, // 2: subs r1, #1
        0xd1fd, // bne 2b
        0x3801, // subs r0, #1
        0xd1fa, // bne 1b
        0x4770, // bx lr
    ];
    let outer = "loop 3 f #1 ; r0 counts from 3";
    let inner = "loop 5 f #2 ; r1 counts from 5";
    assert_eq!(alone(&code, outer).2, [Fault::Loop]);
    assert_eq!(alone(&code, inner).2, [Fault::Loop]);
    let both = alone(&code, &format!("{outer}\n{inner}"));
    assert_eq!(both, (1 + 3 * (1 + 5 * 2 + 2) + 1, 0, vec![]));
    // Seven rounds back of the inner loop in all, whichever rounds of the outer one have them.
    let total = alone(&code, &format!("{outer}\ntotal 7 f #2 ; for the test"));
    assert_eq!(total, (1 + 3 * (1 + 2 + 2) + 7 * 2 + 1, 0, vec![]));
}

#[test]
fn a_loop_with_two_entries_is_refused() {
    let code = [
        0xb100, // cbz r0, 2f
        0x3101, // 1: adds r1, #1
        0x3801, // 2: subs r0, #1
        0xd1fc, // bne 1b
        0x4770, // bx lr
    ];
    assert_eq!(
        alone(&code, "loop 4 f #1 ; it is not").2,
        [Fault::LoopEntries]
    );
}

#[test]
fn an_indirect_call_needs_its_targets() {
    let code = [
        0xb580, // f: push {r7, lr}
        0x4798, // blx r3
        0xbd80, // pop {r7, pc}
        0xb410, // g: push {r4}
        0xbc10, // pop {r4}
        0x4770, // bx lr
    ];
    let image = Image::of_code(ADDRESS, &code, &[("f", 0, 6), ("g", 6, 12)]);
    assert_eq!(examine(&image, "").1, [Fault::IndirectCall]);
    assert_eq!(
        examine(&image, "calls f -> h ; there is no h").1,
        [Fault::IndirectCall]
    );
    let (bounds, faults) = examine(&image, "calls f -> g ; r3 is g");
    assert_eq!((bounds.longest[0], bounds.stack, faults), (6, 12, vec![]));
}

#[test]
fn a_computed_jump_is_refused() {
    assert_eq!(alone(&[0x4718], "").2, [Fault::ComputedJump]); // bx r3
    assert_eq!(alone(&[0x469f], "").2, [Fault::ComputedJump]); // mov pc, r3
    assert_eq!(alone(&[0xf8d0, 0xf000], "").2, [Fault::ComputedJump]); // ldr pc, [r0]
}

#[test]
fn calls_and_a_last_call_add_up() {
    let image = Image::of_code(
        ADDRESS,
        CALLS,
        &[("f", 0, 12), ("g", 12, 20), ("h", 20, 26)],
    );
    let (bounds, faults) = examine(&image, "");
    // h takes 3, g 3 more, f 4 more; the stack of g is free when h begins.
    assert_eq!((bounds.longest[0], faults), (4 + 2 * (3 + 3), vec![]));
    assert_eq!(bounds.stack, 8 + 16);
}

#[test]
fn a_jump_into_the_middle_of_a_function_is_refused() {
    let image = Image::of_code(
        ADDRESS,
        CALLS,
        &[("f", 0, 12), ("g", 12, 18), ("h", 18, 26)],
    );
    assert_eq!(examine(&image, "").1, [Fault::NoFunction(ADDRESS + 20)]);
}

#[test]
fn a_function_that_calls_itself_through_another_is_refused() {
    let code = [
        0xb580, // f: push {r7, lr}
        0xf000, 0xf801, // bl g
        0xbd80, // pop {r7, pc}
        0xb580, // g: push {r7, lr}
        0xf7ff, 0xfff9, // bl f
        0xbd80, // pop {r7, pc}
    ];
    let image = Image::of_code(ADDRESS, &code, &[("f", 0, 8), ("g", 8, 16)]);
    assert_eq!(examine(&image, "").1, [Fault::Recursion]);
}

/// What follows the call of a function that never returns is other code.
#[test]
fn a_function_that_does_not_return_ends_the_path() {
    let code = [
        0xb110, // f: cbz r0, 1f
        0xb580, // push {r7, lr}
        0xf000, 0xf801, // bl g
        0x4770, // 1: bx lr
        0xde00, // g: udf #0
    ];
    let image = Image::of_code(ADDRESS, &code, &[("f", 0, 10), ("g", 10, 12)]);
    let (bounds, faults) = examine(&image, "");
    assert_eq!((bounds.longest[0], bounds.stack, faults), (4, 8, vec![]));
}

/// A table of three distances and a byte of zero behind it.
#[test]
fn a_table_branch_goes_to_each_target_of_its_table() {
    let code = [
        0x2802, // cmp r0, #2
        0xd80b, // bhi 9f
        0xe8df, 0xf000, // tbb [pc, r0]
        0x0302, 0x0006, // .byte 2, 3, 6, 0
        0x4770, // bx lr
        0xbf00, // nop
        0xbf00, // nop
        0x4770, // bx lr
        0x3001, // adds r0, #1
        0xbf00, // nop
        0xbf00, // nop
        0xbf00, // nop
        0x4770, // 9: bx lr
    ];
    let (bounds, faults) = examine(&function(&code).with_data(8, 12), "");
    assert_eq!((bounds.longest[0], faults), (8, vec![]));
    // Without the linker's mark the table's extent is not known.
    assert_eq!(alone(&code, "").2, [Fault::JumpTable]);
}

#[test]
fn a_table_branch_goes_to_each_target_of_a_table_behind_the_code() {
    let code = [
        0x2802, // cmp r0, #2
        0xd807, // bhi 9f
        0xa104, // adr r1, 5f
        0xe8d1, 0xf000, // tbb [r1, r0]
        0x4770, // bx lr
        0xbf00, // nop
        0x4770, // bx lr
        0xbf00, // nop
        0xbf00, // nop
        0x4770, // 9: bx lr
        0xbf00, // nop
        0x0100, 0xff03, // 5: .byte 0, 1, 3, 255
    ];
    let (bounds, faults) = examine(&function(&code).with_data(24, 28), "");
    assert_eq!((bounds.longest[0], faults), (7, vec![]));
    // Another register than the one that takes the table's address.
    let mut other = code;
    other[3] = 0xe8d2; // tbb [r2, r0]
    let (_, faults) = examine(&function(&other).with_data(24, 28), "");
    assert_eq!(faults, [Fault::JumpTable]);
}

#[test]
fn a_table_of_jumps_goes_to_each() {
    let code = [
        0xbf00, // nop
        0xf20f, 0x0608, // adr.w r6, 1f
        0xeb06, 0x0680, // add.w r6, r6, r0, lsl #2
        0x46b7, // mov pc, r6
        0xf000, 0xb802, // 1: b.w 2f
        0xf000, 0xb802, // b.w 3f
        0xbf00, // 2: nop
        0x4770, // bx lr
        0x4770, // 3: bx lr
    ];
    assert_eq!(alone(&code, ""), (7, 0, vec![]));
    // The jumps are aligned to 4 bytes; an instruction that is not executed may precede them.
    let mut aligned = code;
    aligned[..6].rotate_left(1);
    assert_eq!(alone(&aligned, ""), (6, 0, vec![]));
    let mut elsewhere = code;
    elsewhere[2] = 0x060c;
    assert_eq!(alone(&elsewhere, "").2, [Fault::ComputedJump]);
}

#[test]
fn sleep_unknown_code_and_code_behind_the_end_are_refused() {
    assert_eq!(alone(&[0xbf30, 0x4770], "").2, [Fault::Sleep]); // wfi; bx lr
    assert_eq!(alone(&[0xfc00, 0x0000], "").2, [Fault::UnknownInstruction]);
    assert_eq!(alone(&[0xbf00], "").2, [Fault::UnknownInstruction]); // nop, and no return
}

/// One cycle more for each result of the FPU, three for each branch that is taken.
#[test]
fn cycles_are_those_of_the_timing_table() {
    let code = [
        0xee80, 0x0a81, // vdiv.f32 s0, s1, s2: 15
        0xeeb1, 0x0ac0, // vsqrt.f32 s0, s0: 15
        0xee30, 0x0a20, // vadd.f32 s0, s0, s1: 2
        0xeea0, 0x0a81, // vfma.f32 s0, s1, s2: 4
        0xfb90, 0xf0f1, // sdiv r0, r0, r1: 12
        0x6808, // ldr r0, [r1]: 2
        0xe9d2, 0x0100, // ldrd r0, r1, [r2]: 3
        0xe890, 0x000e, // ldm.w r0, {r1, r2, r3}: 4
        0x4800, // ldr r0, [pc]: 2
        0xed9f, 0x0a00, // vldr s0, [pc]: 2
        0x4770, // bx lr: 4
    ];
    let (bounds, faults) = examine(&function(&code), "");
    let cycles = 15 + 15 + 2 + 4 + 12 + 2 + 3 + 4 + 2 + 2 + 4;
    // 38 bytes begin three lines, at 5 cycles each; a return waits for 10, and so do two constants
    // among the code. Six accesses are to data in RAM.
    let code_waits = cycles + 3 * 5 + 10 + 2 * 10;
    assert_eq!(
        bounds.longest,
        [11, cycles, code_waits, code_waits + 6 * 10]
    );
    assert_eq!(faults, []);
}

#[test]
fn a_statement_needs_a_reason() {
    assert!(Stated::read("# a comment\n\nloop 4 f #1 ; counted").is_ok());
    for line in [
        "loop 4 f ; no number",
        "loop 4 f #1",
        "loop 4 f #1 ;",
        "loop f #1 ; why",
        "calls f ; why",
        "bound 4 f #1 ; why",
    ] {
        assert!(Stated::read(line).is_err(), "{line}");
    }
}

#[test]
fn a_statement_on_a_loop_that_is_not_there_is_named() {
    let stated = Stated::read("loop 4 f #1 ; counted").expect("a statement");
    let image = function(&[0x4770]); // bx lr
    Program::new(&image, &stated).bounds(ADDRESS);
    assert_eq!(stated.unused().collect::<Vec<_>>(), ["loop 4 f #1"]);
}
