//! The linked images: mistakes put into their code are found, and no run took longer than what is
//! proved.

mod seeds;

use fivebar_bounds::Fault;
use fivebar_bounds::families;
use fivebar_bounds::report::{self, Row};
use seeds::Images;

const FIGURES: &str = include_str!("../figures.txt");

const IMAGES: Images = Images {
    target: "thumbv7em-none-eabihf",
    script: "scripts/firmware.sh",
    stated: concat!(
        include_str!("../stated.txt"),
        include_str!("../stated_stm32f405.txt")
    ),
    ticks: &[
        (
            "tick",
            "fivebar_firmware::controller::tick::<impl fivebar_firmware::controller::ArmController<D>>::tick",
        ),
        ("stm32f405", "ADC"),
        ("stm32f405_stepper", "TIM4"),
        ("stm32f405_can", "TIM5"),
    ],
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
fn a_computed_jump_in_the_tick_is_found() {
    IMAGES.every_seed_is_found(0x4718, Fault::ComputedJump); // bx r3
}

#[test]
fn a_stack_of_unknown_size_in_the_tick_is_found() {
    IMAGES.every_seed_is_found(0x4685, Fault::UnknownStack); // mov sp, r0
}

const MAIN: &str = "stm32f405::app::converse";

#[test]
fn a_long_critical_section_is_found() {
    IMAGES.every_lost_end_is_found("stm32f405", MAIN, 840);
}

#[test]
fn a_loop_and_an_indirect_call_in_a_critical_section_are_found() {
    IMAGES.every_seed_in_a_section_is_found("stm32f405", MAIN);
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
    assert_eq!(families::STM32F405.over_budget(&rows), [""; 0]);
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
        assert_eq!(families::STM32F405.over_budget(&rows), [refused]);
        let row = rows.iter_mut().find(|row| row.name.ends_with(name));
        row.expect("a row of this name").longest = before;
    }
    let stack = rows
        .iter_mut()
        .find(|row| row.name == "stm32f405: all nested");
    stack.expect("the stack").stack = Some(12_289);
    assert_eq!(
        families::STM32F405.over_budget(&rows),
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
