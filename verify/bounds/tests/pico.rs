//! The linked images of a Pico 2: mistakes put into their code are found, and no run took longer than what is proved.

mod seeds;

use fivebar_bounds::Fault;
use fivebar_bounds::cores::{M4_IN_FLASH, M33_IN_SRAM};
use fivebar_bounds::families::RP2350;
use fivebar_bounds::image::{Image, SRAM};
use fivebar_bounds::report::{self, Row};
use seeds::Images;

const IMAGES: Images = Images {
    target: "thumbv8m.main-none-eabihf",
    script: "scripts/pico.sh image",
    stated: concat!(
        include_str!("../stated.txt"),
        include_str!("../stated_rp2350.txt")
    ),
    ticks: &[("rp2350_stepper", "SysTick"), ("rp2350_servo", "SysTick")],
};

#[test]
fn a_loop_in_the_tick_is_found() {
    IMAGES.every_seed_is_found(0xd1fe, Fault::Loop); // 1: bne 1b
}

#[test]
fn an_indirect_call_in_the_tick_is_found() {
    IMAGES.every_seed_is_found(0x4798, Fault::IndirectCall); // blx r3
}

#[test]
fn a_stack_of_unknown_size_in_the_tick_is_found() {
    IMAGES.every_seed_is_found(0x4685, Fault::UnknownStack); // mov sp, r0
}

#[test]
fn a_critical_section_without_its_end_or_with_a_loop_is_found() {
    let main = "rp2350_stepper::app::converse";
    IMAGES.every_lost_end_is_found("rp2350_stepper", main, 1_800);
    IMAGES.every_seed_in_a_section_is_found("rp2350_stepper", main);
}

/// The images are read as those of the core that runs them, and all that a tick reaches lies in the SRAM.
#[test]
fn the_tick_runs_from_the_sram() {
    for (name, tick) in IMAGES.ticks {
        let image = IMAGES.image(name);
        assert_eq!(image.core, M33_IN_SRAM);
        assert!(image.named(tick).expect("the tick").address >= SRAM);
    }
    // bx lr, 256 bytes below the SRAM; in it bl to there.
    let code = [vec![0x4770; 128], vec![0xf7ff, 0xff7e, 0x4770]].concat();
    let mut image = Image::of_code(SRAM - 256, &code, &[("g", 0, 2), ("f", 256, 262)]);
    image.core = M33_IN_SRAM;
    let found = IMAGES.faults(&image, "f");
    assert_eq!(found, [Fault::OutsideSram(SRAM - 256)]);
    image.core = M4_IN_FLASH;
    assert_eq!(IMAGES.faults(&image, "f"), []);
}

/// Each part has its limit where every access waits as long as one of a slow register: a path that is one cycle longer is refused.
#[test]
fn what_is_over_its_budget_is_refused() {
    let (_, mut rows) = report::read(RP2350.committed);
    assert_eq!(RP2350.over_budget(&rows), [""; 0]);
    for (name, budget) in [
        ("rp2350_stepper: SysTick", 12_600),
        ("rp2350_stepper: longest blocking", 1_800),
        ("rp2350_servo: response", 15_000),
        ("rp2350_servo: receiver's first byte", 24_000),
    ] {
        let row = |rows: &mut [Row], to: Option<u64>| {
            let row = rows.iter_mut().find(|row| row.name == name);
            let longest = row.expect("a row of this name").longest.as_mut();
            let all_wait = &mut longest.expect("a bound")[3];
            std::mem::replace(all_wait, to.unwrap_or(*all_wait))
        };
        let before = row(&mut rows, Some(budget + 1));
        let refused = format!(
            "{name}: {} cycles where all accesses wait, of at most {budget}",
            budget + 1
        );
        assert_eq!(RP2350.over_budget(&rows), [refused]);
        row(&mut rows, Some(before));
    }
}
