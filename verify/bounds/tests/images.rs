//! The linked images: mistakes put into their code are found, and no run took longer than what is
//! proved.

use std::path::Path;

use fivebar_bounds::image::Image;
use fivebar_bounds::instruction::{Flow, Mask, Stack};
use fivebar_bounds::program::Program;
use fivebar_bounds::report::{self, Row};
use fivebar_bounds::response;
use fivebar_bounds::stated::Stated;
use fivebar_bounds::timing::Measure;
use fivebar_bounds::{Fault, narrow, wide};

const STATED: &str = include_str!("../stated.txt");
const FIGURES: &str = include_str!("../figures.txt");

fn image(name: &str) -> Image {
    let built = option_env!("CARGO_TARGET_DIR")
        .unwrap_or(concat!(env!("CARGO_MANIFEST_DIR"), "/../../target"));
    let path = Path::new(built)
        .join("firmware/thumbv7em-none-eabihf/firmware")
        .join(name);
    let file = std::fs::read(&path)
        .unwrap_or_else(|error| panic!("{}: {error}; run scripts/firmware.sh", path.display()));
    Image::read(&file).expect("an image")
}

fn faults(image: &Image, function: &str) -> Vec<Fault> {
    let stated = Stated::read(STATED).expect("statements");
    let address = image.named(function).expect("the function").address;
    let defects = Program::new(image, &stated).defects(address);
    defects.into_iter().map(|defect| defect.fault).collect()
}

/// Some instructions of 16 bits on the longest path of a function that do nothing of interest. None of them is the header
/// of a loop: what is said of that loop covers every jump to its header, so also a seeded one.
fn places(image: &Image, function: &str) -> Vec<u32> {
    let stated = Stated::read(STATED).expect("statements");
    let address = image.named(function).expect("the function").address;
    let mut program = Program::new(image, &stated);
    let path = program.longest_path(address, Measure::Instructions);
    assert!(path.len() > 100, "{function}: {} instructions", path.len());
    let headers = program.loop_headers(address);
    let is_plain = |place: u32| {
        let half = image.half(place).expect("code");
        let instruction = narrow::decode(place, half);
        half >> 11 < 0b11101 && instruction.flow == Flow::Next && instruction.stack == Stack::Keep
    };
    let plain = path
        .iter()
        .map(|(place, _)| *place)
        .filter(|place| is_plain(*place) && !headers.contains(place));
    let places: Vec<u32> = plain.step_by(8).collect();
    assert!(places.len() >= 5, "{function}: {places:x?}");
    places
}

/// The functions that hold the tick: of the image that has nothing else, and of the arm's.
const TICKS: [(&str, &str); 4] = [
    (
        "tick",
        "fivebar_firmware::controller::tick::<impl fivebar_firmware::controller::ArmController<D>>::tick",
    ),
    ("stm32f405", "ADC"),
    ("stm32f405_stepper", "TIM4"),
    ("stm32f405_can", "TIM5"),
];

#[track_caller]
fn every_seed_is_found(code: u16, fault: Fault) {
    for (name, function) in TICKS {
        let image = image(name);
        assert_eq!(faults(&image, function), [], "{name}");
        for place in places(&image, function) {
            let seeded = image.clone().patched(place, &[code]);
            let found = faults(&seeded, function);
            assert!(found.contains(&fault), "{name}, {place:#x}: {found:?}");
        }
    }
}

#[test]
fn a_loop_in_the_tick_is_found() {
    every_seed_is_found(0xd1fe, Fault::Loop); // 1: bne 1b
}

#[test]
fn an_indirect_call_in_the_tick_is_found() {
    every_seed_is_found(0x4798, Fault::IndirectCall); // blx r3
}

#[test]
fn a_computed_jump_in_the_tick_is_found() {
    every_seed_is_found(0x4718, Fault::ComputedJump); // bx r3
}

#[test]
fn a_stack_of_unknown_size_in_the_tick_is_found() {
    every_seed_is_found(0x4685, Fault::UnknownStack); // mov sp, r0
}

/// The longest critical section of the main program [cycles where the code waits], and the faults.
fn blocking(image: &Image) -> (u64, Vec<Fault>) {
    let stated = Stated::read(STATED).expect("statements");
    let main = image.named(MAIN).expect("the main program").address;
    let (sections, defects) = Program::new(image, &stated).sections(main);
    let longest = sections.iter().map(|section| section.longest[2]).max();
    let faults = defects.into_iter().map(|defect| defect.fault);
    (longest.unwrap_or(0), faults.collect())
}

const MAIN: &str = "stm32f405::app::converse";

/// The addresses of the instructions in a function that raise a mask, or restore one.
fn masking(image: &Image, function: &str, mask: Mask) -> Vec<u32> {
    let function = image.named(function).expect("the function");
    let places = (function.address..function.end).step_by(2);
    let is_meant = |place: &u32| {
        let halves = [image.half(*place), image.half(place + 2)];
        let [Some(high), Some(low)] = halves else {
            return false;
        };
        high >> 4 == 0xf38 && low & 0xff00 == 0x8800 && wide::decode(*place, high, low).mask == mask
    };
    places.filter(is_meant).collect()
}

#[test]
fn a_long_critical_section_is_found() {
    let image = image("stm32f405");
    let (longest, faults) = blocking(&image);
    assert!(faults.is_empty() && longest > 100, "{longest}: {faults:?}");
    let ends = masking(&image, MAIN, Mask::Restore);
    assert!(ends.len() >= 10, "{ends:x?}");
    for place in ends {
        // Two NOPs in place of its end: it goes on, into others and into the loop of the main program.
        let seeded = image.clone().patched(place, &[0xbf00, 0xbf00]);
        let (now, faults) = blocking(&seeded);
        assert!(now > 840 || !faults.is_empty(), "{place:#x}: {now}");
    }
}

#[test]
fn a_loop_and_an_indirect_call_in_a_critical_section_are_found() {
    let image = image("stm32f405");
    for place in masking(&image, MAIN, Mask::Raise) {
        // Behind MSR comes ISB, a wide instruction.
        for (code, fault) in [(0xd1fe, Fault::Loop), (0x4798, Fault::IndirectCall)] {
            let seeded = image.clone().patched(place + 4, &[code, 0xbf00]);
            let (_, faults) = blocking(&seeded);
            assert!(faults.contains(&fault), "{place:#x}: {faults:?}");
        }
    }
}

#[test]
fn an_instruction_more_in_the_tick_is_a_difference() {
    let (compiler, rows) = report::read(FIGURES);
    let mut grown = rows.clone();
    let tick: &mut Row = &mut grown[0];
    tick.longest.as_mut().expect("a bound")[0] += 1;
    let text = |rows: &[Row]| report::table(&compiler, rows);
    assert_eq!(report::compare(&text(&rows), &text(&rows)), [""; 0]);
    let differences = report::compare(&text(&rows), &text(&grown));
    assert_eq!(differences.len(), 1, "{differences:?}");
    // A smaller figure passes by a percent, and one of another compiler by ten.
    let shrunk = |share: f64| {
        let mut rows = rows.clone();
        let [instructions, ..] = rows[0].longest.as_mut().expect("a bound");
        *instructions = (*instructions as f64 * share) as u64;
        rows
    };
    assert_eq!(
        report::compare(&text(&rows), &text(&shrunk(0.995))).len(),
        0
    );
    assert_eq!(report::compare(&text(&rows), &text(&shrunk(0.98))).len(), 1);
    let other = |rows: &[Row]| report::table("another compiler", rows);
    assert_eq!(
        report::compare(&text(&rows), &other(&shrunk(1.05))).len(),
        0
    );
    assert_eq!(
        report::compare(&text(&rows), &other(&shrunk(1.15))).len(),
        1
    );
    // A row that is missing, on either side, is one too.
    assert_eq!(report::compare(&text(&rows), &text(&rows[1..])).len(), 1);
    assert_eq!(report::compare(&text(&rows[1..]), &text(&rows)).len(), 1);
}

/// The proved figure of a row.
fn proved(name: &str) -> Row {
    let (_, rows) = report::read(FIGURES);
    rows.into_iter()
        .find(|row| row.name == name)
        .expect("a row of this name")
}

/// Each part of the response has its budget where the code waits for the flash and the RAM does not, as on
/// the chip, and the stack has one. A path that is one cycle longer is refused.
#[test]
fn what_is_over_its_budget_is_refused() {
    let (_, mut rows) = report::read(FIGURES);
    assert_eq!(response::over_budget(&rows), [""; 0]);
    for (name, budget) in [
        ("ADC", 10_080),
        ("longest blocking", 840),
        ("conversion and pre-emption", 840),
        ("response", 16_800),
    ] {
        let row = rows.iter_mut().find(|row| row.name.ends_with(name));
        let row = row.expect("a row of this name");
        let before = row.longest;
        row.longest.as_mut().expect("a bound")[2] = budget + 1;
        let refused = format!(
            "stm32f405: {name}: {} cycles where the code waits, of at most {budget}",
            budget + 1
        );
        assert_eq!(response::over_budget(&rows), [refused]);
        let row = rows.iter_mut().find(|row| row.name.ends_with(name));
        row.expect("a row of this name").longest = before;
    }
    let stack = rows.iter_mut().find(|row| row.name.ends_with("all nested"));
    stack.expect("the stack").stack = Some(12_289);
    assert_eq!(
        response::over_budget(&rows),
        ["stm32f405: all nested: 12289 bytes of stack, of at most 12288"]
    );
}

/// What runs on the emulated and on the simulated board took at most.
#[test]
fn no_run_took_more_than_what_is_proved() {
    let [tick, ..] = proved("tick: tick::__cortex_m_rt_main")
        .longest
        .expect("a bound");
    let counted = include_str!("../../../tests/data/instructions.txt");
    let ticks = counted.lines().filter(|line| line.contains("tick"));
    let most = ticks.filter_map(|line| line.split_whitespace().last()?.parse().ok());
    let most: Vec<u64> = most.collect();
    assert!(
        most.len() >= 4 && most.iter().all(|most| *most <= tick),
        "{most:?}"
    );

    let figures = include_str!("../../chip/figures.txt");
    let figure = |name: &str| -> f64 {
        let line = figures.lines().find_map(|line| line.strip_prefix(name));
        line.and_then(|figure| figure.trim().parse().ok())
            .expect("a figure")
    };
    let [interrupt, ..] = proved("stm32f405: ADC").longest.expect("a bound");
    assert!(figure("tick, most [instructions]:") <= interrupt as f64);
    let [stack, space] = ["all nested", "space"].map(|name| {
        proved(&format!("stm32f405: {name}"))
            .stack
            .expect("a stack")
    });
    assert!(figure("stack, most [bytes]:") <= f64::from(stack));
    assert!(4 * stack <= 3 * space);
}
