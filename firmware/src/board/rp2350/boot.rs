//! The start from the boot ROM: what it looks for in the flash, and the copying of the program to SRAM.
//!
//! The ROM takes an image whose first 4 KiB hold a block that calls it a program for the Arm cores (RP2350 datasheet,
//! 5.9.3), and starts it by the vectors at its beginning.

#![allow(
    unsafe_code,
    reason = "the code that copies the program is in assembly"
)]

use core::arch::global_asm;

global_asm!(
    ".section .boot.vectors, \"a\"",
    ".global boot_vectors",
    "boot_vectors:",
    ".word _stack_start",
    ".word boot_copy",
    // The block: its start, one item (image type: executable, secure, Arm, RP2350), the last item, no other block, its end.
    ".section .boot.block, \"a\"",
    ".word 0xffffded3",
    ".word 0x10210142",
    ".word 0x000001ff",
    ".word 0",
    ".word 0xab123579",
    ".section .boot.copy, \"ax\"",
    ".thumb_func",
    "boot_copy:",
    "ldr r0, =__copy_source",
    "ldr r1, =__copy_start",
    "ldr r2, =__copy_end",
    "1:",
    "ldmia r0!, {{r4-r5}}",
    "stmia r1!, {{r4-r5}}",
    "cmp r1, r2",
    "blo 1b",
    // SCB_VTOR: the exceptions go to the copy, too.
    "ldr r0, =0xe000ed08",
    "ldr r1, =__copy_start",
    "str r1, [r0]",
    "dsb",
    "isb",
    "ldr r0, [r1, #4]",
    "bx r0",
    ".ltorg",
    ".text",
);
