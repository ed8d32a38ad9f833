//! Small pieces of machine code whose stacks are counted by hand.

use crate::code::alone;
use fivebar_bounds::Fault;

#[test]
fn an_if_then_block_is_two_ways_with_a_stack_each() {
    let code = [
        0xb510, // push {r4, lr}
        0xb082, // sub sp, #8
        0x2800, // cmp r0, #0
        0xbf04, // itt eq
        0xb002, // addeq sp, #8
        0xbd10, // popeq {r4, pc}
        0xb40f, // push {r0, r1, r2, r3}
        0xb006, // add sp, #24
        0xbd10, // pop {r4, pc}
    ];
    assert_eq!(alone(&code, ""), (9, 32, vec![]));
}

#[test]
fn an_if_then_block_that_changes_the_flags_forks_again() {
    let code = [
        0x2800, // cmp r0, #0
        0xbf04, // itt eq
        0x2900, // cmpeq r1, #0
        0x4770, // bxeq lr
        0x3101, // adds r1, #1
        0x4770, // bx lr
    ];
    assert_eq!(alone(&code, ""), (6, 0, vec![]));
}

#[test]
fn blocks_that_follow_each_other_share_their_condition() {
    let code = |second: u16, between: u16| {
        [
            0x2800,  // cmp r0, #0
            0xbf04,  // itt eq
            between, // addeq r1, #1
            0xb401,  // pusheq {r0}
            second,  // it eq
            0xbc01,  // popeq {r0}
            0x4770,  // bx lr
        ]
    };
    let (add, compare) = (0x3101, 0x2900); // adds r1, #1; cmp r1, #0
    let (equal, unequal, lower) = (0xbf08, 0xbf18, 0xbf38);
    assert_eq!(alone(&code(equal, add), ""), (7, 4, vec![]));
    // The other condition: what one way pushes, the other one pops.
    let (_, _, faults) = alone(&code(unequal, add), "");
    assert_eq!(faults, [Fault::StackAboveEntry, Fault::StackAtReturn(4)]);
    // A condition that is not related, or may have changed.
    assert!(!alone(&code(lower, add), "").2.is_empty());
    assert!(alone(&code(equal, compare), "").2.is_empty());
    let last = [
        0x2800, // cmp r0, #0
        0xbf04, // itt eq
        0xb401, // pusheq {r0}
        0x2900, // cmpeq r1, #0
        0xbf08, // it eq
        0xbc01, // popeq {r0}
        0x4770, // bx lr
    ];
    assert!(!alone(&last, "").2.is_empty());
}

#[test]
fn every_way_to_move_the_stack_counts() {
    let code = [
        0xb5f0, // push {r4, r5, r6, r7, lr}
        0xe92d, 0x0f00, // push.w {r8, r9, r10, r11}
        0xed2d, 0x8b04, // vpush {d8, d9}
        0xb085, // sub sp, #20
        0xf5ad, 0x6d80, // sub.w sp, sp, #1024
        0xf84d, 0x0d08, // str r0, [sp, #-8]!
        0xf85d, 0x0b08, // ldr r0, [sp], #8
        0xf50d, 0x6d80, // add.w sp, sp, #1024
        0xb005, // add sp, #20
        0xecbd, 0x8b04, // vpop {d8, d9}
        0xe8bd, 0x0f00, // pop.w {r8, r9, r10, r11}
        0xbdf0, // pop {r4, r5, r6, r7, pc}
    ];
    assert_eq!(alone(&code, ""), (12, 20 + 16 + 16 + 20 + 1024 + 8, vec![]));
}

#[test]
fn a_stack_of_unknown_size_is_refused() {
    let code = [
        0xb580, // push {r7, lr}
        0xebad, 0x0d00, // sub.w sp, sp, r0
        0x46bd, // mov sp, r7
        0xbd80, // pop {r7, pc}
    ];
    assert_eq!(alone(&code, "").2, [Fault::UnknownStack]);
}

#[test]
fn a_stack_that_grows_in_a_loop_is_refused() {
    let code = [
        0xb401, // 1: push {r0}
        0x3801, // subs r0, #1
        0xd1fc, // bne 1b
        0x4770, // bx lr
    ];
    let (_, _, faults) = alone(&code, "loop 4 f #1 ; for the test");
    assert_eq!(faults, [Fault::StackDiffers(0, 4), Fault::StackAtReturn(4)]);
}

#[test]
fn what_is_left_on_the_stack_or_taken_too_much_is_refused() {
    let left = [0xb510, 0xbd00]; // push {r4, lr}; pop {pc}
    assert_eq!(alone(&left, "").2, [Fault::StackAtReturn(4)]);
    let taken = [0xb510, 0xbd70]; // push {r4, lr}; pop {r4, r5, r6, pc}
    assert_eq!(alone(&taken, "").2, [Fault::StackAboveEntry]);
}

/// A new stack in the middle of a function would hide the one in use.
#[test]
fn only_a_handler_that_ends_the_program_begins_a_new_stack() {
    let code = [0xf380, 0x8808, 0xde00]; // msr msp, r0; udf #0
    assert_eq!(alone(&code, "").2, [Fault::UnknownStack]);
    assert_eq!(alone(&code, "ends f ; resets the processor").2, []);
}

#[test]
fn calls_into_the_rom_take_no_stack_of_the_image_where_that_is_stated_alone() {
    let code = [
        0xb510, // push {r4, lr}
        0xfe30, 0x0a20, // vselgt.f32 s0, s0, s1
        0x4780, // blx r0
        0xbd10, // pop {r4, pc}
    ];
    assert_eq!(alone(&code, "rom f ; the flash"), (4, 8, vec![]));
    assert_eq!(alone(&code, "rom g ; another").2, [Fault::IndirectCall]);
    // 0xff: no instruction of the FPU.
    let code = [0xff30, 0x0a20, 0x4770];
    assert_eq!(alone(&code, "").2, [Fault::UnknownInstruction]);
}
