//! Critical sections of small pieces of machine code, counted by hand.

use crate::code::{ADDRESS, function};
use fivebar_bounds::Fault;
use fivebar_bounds::image::Image;
use fivebar_bounds::program::Program;
use fivebar_bounds::stated::Stated;

/// mrs r0, basepri; msr basepri_max, r1; msr basepri, r0.
const READ: [u16; 2] = [0xf3ef, 0x8011];
const RAISE: [u16; 2] = [0xf381, 0x8812];
const RESTORE: [u16; 2] = [0xf380, 0x8811];
/// adds r2, #1.
const WORK: u16 = 0x3201;
/// bx lr.
const RETURN: u16 = 0x4770;

/// The lengths of the sections that `f` reaches [instructions], by address, and the faults.
fn sections(image: &Image, stated: &str) -> (Vec<u64>, Vec<Fault>) {
    let stated = Stated::read(stated).expect("statements");
    let (mut sections, defects) = Program::new(image, &stated).sections(ADDRESS);
    sections.sort_by_key(|section| section.address);
    let lengths = sections.iter().map(|section| section.longest[0]);
    let faults = defects.iter().map(|defect| defect.fault);
    (lengths.collect(), faults.collect())
}

fn alone(pieces: &[&[u16]], stated: &str) -> (Vec<u64>, Vec<Fault>) {
    sections(&function(&pieces.concat()), stated)
}

#[test]
fn a_section_counts_from_the_raise_to_the_end_of_its_longest_way() {
    let branch = [
        0xb10b, // cbz r3, 1f
        WORK, WORK, // 1:
    ];
    let code: [&[u16]; 7] = [
        &[WORK],
        &READ,
        &RAISE,
        &branch,
        &RESTORE,
        &[WORK, WORK],
        &[RETURN],
    ];
    assert_eq!(alone(&code, ""), (vec![5], vec![]));
}

#[test]
fn primask_masks_as_basepri_does() {
    // mrs r0, primask; cpsid i; …; msr primask, r0.
    let code: [&[u16]; 5] = [
        &[0xf3ef, 0x8010, 0xb672],
        &[WORK],
        &[0xf380, 0x8810],
        &[WORK],
        &[RETURN],
    ];
    assert_eq!(alone(&code, ""), (vec![3], vec![]));
}

#[test]
fn a_section_within_another_does_not_end_it() {
    let code: [&[u16]; 9] = [
        &READ,
        &RAISE,
        &[0xf3ef, 0x8411], // mrs r4, basepri
        &RAISE,
        &[WORK],
        &[0xf384, 0x8811], // msr basepri, r4
        &[WORK, WORK],
        &RESTORE,
        &[RETURN],
    ];
    assert_eq!(alone(&code, ""), (vec![8], vec![]));
}

#[test]
fn what_a_section_calls_counts_and_so_do_the_sections_of_what_is_called() {
    let f: [&[u16]; 5] = [
        &[0xb510], // push {r4, lr}
        &RAISE,
        &[0xf000, 0xf803], // bl g
        &RESTORE,
        &[0xbd10], // pop {r4, pc}
    ];
    let g: [&[u16]; 4] = [&RAISE, &[WORK], &RESTORE, &[RETURN]];
    let code = [f.concat(), g.concat()].concat();
    let image = Image::of_code(ADDRESS, &code, &[("f", 0, 16), ("g", 16, 28)]);
    assert_eq!(sections(&image, ""), (vec![7, 3], vec![]));
}

/// The main program's loop needs no bound; one in a section does.
#[test]
fn a_loop_in_a_section_needs_a_bound() {
    let inside: [&[u16]; 5] = [
        &RAISE,
        &[WORK, 0xd1fd], // 1: adds r2, #1; bne 1b
        &RESTORE,
        &[RETURN],
        &[],
    ];
    assert_eq!(alone(&inside, "").1, [Fault::Loop]);
    assert_eq!(alone(&inside, "loop 3 f #1 ; counted"), (vec![8], vec![]));
    // b back to the raise.
    let around: [&[u16]; 4] = [&RAISE, &[WORK], &RESTORE, &[0xe7f9]];
    assert_eq!(alone(&around, ""), (vec![3], vec![]));
}

#[test]
fn an_indirect_call_in_a_section_is_refused() {
    let code: [&[u16]; 4] = [&RAISE, &[0x4798], &RESTORE, &[RETURN]]; // blx r3
    assert_eq!(alone(&code, "").1, [Fault::IndirectCall]);
}

#[test]
fn a_section_without_an_end_is_refused() {
    let returns: [&[u16]; 2] = [&RAISE, &[RETURN]];
    assert_eq!(alone(&returns, "").1, [Fault::SectionEnd]);
    // One way past the end: cbz r3, over the restore.
    let past: [&[u16]; 4] = [&RAISE, &[0xb10b], &RESTORE, &[RETURN]];
    assert_eq!(alone(&past, "").1, [Fault::SectionEnd]);
    // cpsie i lets everything through, whatever the sections around.
    let opens: [&[u16]; 3] = [&RAISE, &[0xb662], &[RETURN]];
    assert_eq!(alone(&opens, "").1, [Fault::SectionEnd]);
    // Each round opens one more.
    let grows: [&[u16]; 2] = [&RAISE, &[0xe7fc]]; // b back
    assert!(alone(&grows, "").1.contains(&Fault::SectionEnd));
}
