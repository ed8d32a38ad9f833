//! The response of the tick in the image that drives an arm: from the converter's trigger to the
//! end of the interrupt.
//!
//! The interrupt begins when the conversion has ended and no code of lower priority masks it. An
//! interrupt of higher priority can come before it or in it.

use crate::image::Image;
use crate::program::Program;
use crate::report::{Report, Row};
use crate::stated::Stated;
use crate::timing::MEASURES;

/// The image.
pub const LABEL: &str = "stm32f405";
/// The interrupt of the tick.
pub const TICK: &str = "ADC";
/// What runs below it while it does: the idle task, and the interrupt of the serial line. The start
/// is before the first tick.
const BELOW: [&str; 2] = ["stm32f405::app::converse", "USART1"];
/// What interrupts it: the break input, and a failure of the clock. `SysTick` is not among them: it raises
/// the tick where there is no crystal, and then the converter does not.
const ABOVE: [&str; 2] = ["TIM1_BRK_TIM9", "NonMaskableInt"];
/// Cycles from the trigger to the interrupt: 70 of the converter's clock, which is an eighth of the core's
/// (3 to begin, 40 for a current and 27 for the bus voltage, `firmware/src/board/stm32f405/analog.rs`).
const CONVERSION: u64 = 8 * (3 + 28 + 12 + 15 + 12);

/// Cycles of a period: 168 MHz over 10 kHz.
pub const PERIOD: u64 = 16_800;
/// Cycles that each part may take where the code waits for the flash and RAM does not.
const BUDGETS: [(&str, u64); 4] = [
    (TICK, 10_080),
    (BLOCKING, 840),
    (BEFORE, 840),
    (RESPONSE, PERIOD),
];

/// The row of the longest critical section below the tick.
pub const BLOCKING: &str = "longest blocking";
/// The row of what comes before the interrupt or in it.
pub const BEFORE: &str = "conversion and pre-emption";
/// The row of the sum.
pub const RESPONSE: &str = "response";

/// Adds the rows of the response to those of the handlers.
///
/// # Errors
/// If a function of the response is not in the image.
pub fn add(image: &Image, stated: &Stated, report: &mut Report) -> Result<(), String> {
    let mut program = Program::new(image, stated);
    let mut blocking = [0; MEASURES];
    for name in BELOW {
        let function = image.named(name).ok_or_else(|| format!("no {name}"))?;
        let (sections, defects) = program.sections(function.address);
        for section in sections {
            for (most, longest) in blocking.iter_mut().zip(section.longest) {
                *most = longest.max(*most);
            }
        }
        report.defects.extend(defects);
    }
    let of = |name: &str| {
        let row = report.rows.iter().find(|row| row.name == labelled(name));
        row.and_then(|row| row.longest)
            .ok_or_else(|| format!("no {name}"))
    };
    let [_, cycles @ ..] = [CONVERSION; MEASURES];
    let mut before = [0, cycles[0], cycles[1], cycles[2]];
    for name in ABOVE {
        before = sum(before, of(name)?);
    }
    let response = sum(sum(before, blocking), of(TICK)?);
    for (name, longest) in [(BLOCKING, blocking), (BEFORE, before), (RESPONSE, response)] {
        report.rows.push(Row {
            name: labelled(name),
            longest: Some(longest),
            stack: None,
        });
    }
    report.defects.sort();
    report.defects.dedup();
    Ok(())
}

/// The name of a row.
pub fn labelled(name: &str) -> String {
    format!("{LABEL}: {name}")
}

fn sum(mut one: [u64; MEASURES], other: [u64; MEASURES]) -> [u64; MEASURES] {
    for (one, other) in one.iter_mut().zip(other) {
        *one += other;
    }
    one
}

/// The most that the stack may take, every interrupt within another one [bytes].
pub const STACK_BUDGET: u32 = 12 * 1024;

/// The budget of a row [cycles where the code waits].
pub fn budget(name: &str) -> Option<u64> {
    let (_, budget) = BUDGETS.iter().find(|(of, _)| *of == name)?;
    Some(*budget)
}

/// The rows whose figures are above their budgets.
pub fn over_budget(rows: &[Row]) -> Vec<String> {
    let over = |(name, budget): &(&str, u64)| {
        let name = labelled(name);
        let row = rows.iter().find(|row| row.name == name)?;
        let [_, _, code_waits, _] = row.longest?;
        (code_waits > *budget).then(|| {
            format!("{name}: {code_waits} cycles where the code waits, of at most {budget}")
        })
    };
    let name = labelled("all nested");
    let stack = rows.iter().find(|row| row.name == name);
    let stack = stack
        .and_then(|row| row.stack)
        .filter(|stack| *stack > STACK_BUDGET);
    let stack =
        stack.map(|stack| format!("{name}: {stack} bytes of stack, of at most {STACK_BUDGET}"));
    BUDGETS.iter().filter_map(over).chain(stack).collect()
}
