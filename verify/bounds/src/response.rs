//! The response of the tick in the images that drive an arm: from the timer's update that starts it to the end of the
//! interrupt.
//!
//! The interrupt begins when no code of lower priority masks it, and with brushed motors when the conversion has ended. An
//! interrupt of higher priority can come before it or in it.

use crate::image::Image;
use crate::program::Program;
use crate::report::{Report, Row};
use crate::stated::Stated;
use crate::timing::MEASURES;

/// An image with a tick of its own.
pub struct Driving {
    /// Its name.
    pub label: &'static str,
    /// The interrupt of the tick.
    pub tick: &'static str,
    /// What interrupts it: the break inputs, and a failure of the clock.
    above: &'static [&'static str],
    /// Cycles from the update to the interrupt.
    conversion: u64,
    /// Cycles that code below the tick may mask it where the code waits for the flash and RAM does not.
    blocking: u64,
    /// Cycles that the interrupt, pre-emption, and the whole response may take there.
    budgets: [u64; 3],
}

/// The image for brushed motors. `SysTick` is not above its tick: it raises the tick where there is no crystal, and then
/// the converter does not.
pub const BRUSHED: Driving = Driving {
    label: "stm32f405",
    tick: "ADC",
    above: &["TIM1_BRK_TIM9", "NonMaskableInt"],
    conversion: CONVERSION,
    blocking: 840,
    budgets: [TICK_BUDGET, BEFORE_BUDGET, PERIOD],
};
/// The image for steppers: the update itself raises the interrupt. A status of drives that measure nothing is cleared by a
/// call, which takes longer than to copy what brushed ones measure.
pub const STEPPER: Driving = Driving {
    label: "stm32f405_stepper",
    tick: "TIM4",
    above: &["TIM1_BRK_TIM9", "TIM8_BRK_TIM12", "NonMaskableInt"],
    conversion: 0,
    blocking: 1_008,
    budgets: [TICK_BUDGET, BEFORE_BUDGET, PERIOD],
};
/// The image for drives on a CAN bus. The interrupt of a free mailbox has the tick's priority, so it comes before the tick, and
/// once: the next frame ends later than it. Its period is ten times as long; 0.2 ms of it are left for the response, so that the
/// frames of both drives go over the bus in it.
pub const CAN: Driving = Driving {
    label: "stm32f405_can",
    tick: "TIM5",
    above: &["CAN1_TX", "NonMaskableInt"],
    conversion: 0,
    blocking: 840,
    budgets: [2 * TICK_BUDGET, 1_008, 2 * PERIOD],
};
/// The images.
pub const IMAGES: [Driving; 3] = [BRUSHED, STEPPER, CAN];
/// Cycles from the trigger to the interrupt: 70 of the converter's clock, which is an eighth of the core's
/// (3 to begin, 40 for a current and 27 for the bus voltage, `firmware/src/board/stm32f405/brushed/analog.rs`).
const CONVERSION: u64 = 8 * (3 + 28 + 12 + 15 + 12);

/// Cycles of a period: 168 MHz over 10 kHz.
pub const PERIOD: u64 = 16_800;
/// Cycles that the interrupt may take where the code waits for the flash and RAM does not.
const TICK_BUDGET: u64 = 10_080;
/// Cycles that pre-emption may take there.
const BEFORE_BUDGET: u64 = 840;

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
pub fn add(
    driving: &Driving,
    image: &Image,
    stated: &Stated,
    report: &mut Report,
) -> Result<(), String> {
    // What runs below the tick while it does: the idle task, and the interrupt of the serial line. The start is before the
    // first tick.
    let main = format!("{}::app::converse", driving.label);
    let mut program = Program::new(image, stated);
    let mut blocking = [0; MEASURES];
    for name in [main.as_str(), "USART1"] {
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
        let row = report
            .rows
            .iter()
            .find(|row| row.name == driving.labelled(name));
        row.and_then(|row| row.longest)
            .ok_or_else(|| format!("no {name}"))
    };
    let [_, cycles @ ..] = [driving.conversion; MEASURES];
    let mut before = [0, cycles[0], cycles[1], cycles[2]];
    for name in driving.above {
        before = sum(before, of(name)?);
    }
    let response = sum(sum(before, blocking), of(driving.tick)?);
    for (name, longest) in [(BLOCKING, blocking), (BEFORE, before), (RESPONSE, response)] {
        report.rows.push(Row {
            name: driving.labelled(name),
            longest: Some(longest),
            stack: None,
        });
    }
    report.defects.sort();
    report.defects.dedup();
    Ok(())
}

impl Driving {
    /// The name of a row.
    pub fn labelled(&self, name: &str) -> String {
        format!("{}: {name}", self.label)
    }

    /// The budget of a row [cycles where the code waits].
    pub fn budget(&self, name: &str) -> Option<u64> {
        let [tick, before, response] = self.budgets;
        match name {
            BLOCKING => Some(self.blocking),
            BEFORE => Some(before),
            RESPONSE => Some(response),
            _ => (name == self.tick).then_some(tick),
        }
    }

    /// The rows whose figures are above their budgets.
    fn over_budget(&self, rows: &[Row]) -> Vec<String> {
        let over = |part: &str| {
            let (name, budget) = (self.labelled(part), self.budget(part)?);
            let row = rows.iter().find(|row| row.name == name)?;
            let [_, _, code_waits, _] = row.longest?;
            (code_waits > budget).then(|| {
                format!("{name}: {code_waits} cycles where the code waits, of at most {budget}")
            })
        };
        let name = self.labelled("all nested");
        let stack = rows.iter().find(|row| row.name == name);
        let stack = stack
            .and_then(|row| row.stack)
            .filter(|stack| *stack > STACK_BUDGET);
        let stack =
            stack.map(|stack| format!("{name}: {stack} bytes of stack, of at most {STACK_BUDGET}"));
        [self.tick, BLOCKING, BEFORE, RESPONSE]
            .into_iter()
            .filter_map(over)
            .chain(stack)
            .collect()
    }
}

fn sum(mut one: [u64; MEASURES], other: [u64; MEASURES]) -> [u64; MEASURES] {
    for (one, other) in one.iter_mut().zip(other) {
        *one += other;
    }
    one
}

/// The most that the stack may take, every interrupt within another one [bytes].
pub const STACK_BUDGET: u32 = 12 * 1024;

/// The rows of the images whose figures are above their budgets.
pub fn over_budget(rows: &[Row]) -> Vec<String> {
    IMAGES
        .iter()
        .flat_map(|image| image.over_budget(rows))
        .collect()
}
