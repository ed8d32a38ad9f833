//! The response of the tick in the images that drive an arm: from the timer's update that starts it to the end of the
//! interrupt.
//!
//! The interrupt begins when no code of lower priority masks it, and with brushed motors when the conversion has ended. An
//! interrupt of higher priority can come before it or in it.

use crate::image::Image;
use crate::program::Program;
use crate::report::{Report, Row};
use crate::stated::Stated;
use crate::timing::{MEASURES, Measure};

/// An image with a tick of its own.
pub struct Driving {
    /// Its name.
    pub label: &'static str,
    /// The interrupt of the tick.
    pub tick: &'static str,
    /// What interrupts it: the break inputs, and a failure of the clock.
    pub(crate) above: &'static [&'static str],
    /// The interrupts that it interrupts, the one of the serial line first. They may mask it for a while, as may the idle task.
    pub(crate) below: &'static [&'static str],
    /// The interrupt of USB, the lowest, if there is one.
    pub(crate) lowest: Option<&'static str>,
    /// Cycles from the update to the interrupt.
    pub(crate) conversion: u64,
    /// Where the limits hold: where the code waits for the flash and RAM does not, or, without a count of the registers that wait, where
    /// all accesses wait.
    pub(crate) judged: Measure,
    /// Cycles that code below the tick may mask it there.
    pub(crate) blocking: u64,
    /// Cycles that the interrupt, pre-emption, and the whole response may take there.
    pub(crate) budgets: [u64; 3],
    /// Cycles from the interrupt of the serial line until a byte is lost, where the chip holds the bytes.
    pub(crate) receiver: Option<u64>,
    /// What the stack may take, every interrupt within another one and the functions of a ROM besides [bytes]. Their maker does not say
    /// what they take.
    pub(crate) stack: u32,
    pub(crate) rom: u32,
}

/// The row of the longest critical section below the tick.
pub const BLOCKING: &str = "longest blocking";
/// The row of what comes before the interrupt or in it.
pub const BEFORE: &str = "conversion and pre-emption";
/// The row of the sum.
pub const RESPONSE: &str = "response";

/// The row of the time from the interrupt of the serial line until it reads the first byte: what masks it, and the ticks that
/// begin meanwhile.
pub const RECEIVER: &str = "receiver's first byte";

/// The row of the whole stack.
pub const NESTED: &str = "all nested";

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
    // What runs below the tick while it does: the idle task, and interrupts of lower priority. The start is before the first tick.
    let main = format!("{}::app::converse", driving.label);
    let mut program = Program::new(image, stated);
    let mut blocking = [0; MEASURES];
    for name in [&[main.as_str()], driving.below].concat() {
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
    let tick = of(driving.tick)?;
    let response = sum(sum(before, blocking), tick);
    let mut parts = vec![(BLOCKING, blocking), (BEFORE, before), (RESPONSE, response)];
    if driving.receiver.is_some() {
        let [_, _, period] = driving.budgets;
        let mut first = [0; MEASURES];
        for (index, measure) in Measure::ALL.into_iter().enumerate() {
            let alone = blocking[index] + measure.exception(image.core, false);
            first[index] = with_ticks(alone, tick[index], period);
        }
        parts.push((RECEIVER, first));
    }
    for (name, longest) in parts {
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

    /// The budget of a row [cycles].
    pub fn budget(&self, name: &str) -> Option<u64> {
        let [tick, before, response] = self.budgets;
        match name {
            BLOCKING => Some(self.blocking),
            BEFORE => Some(before),
            RESPONSE => Some(response),
            RECEIVER => self.receiver,
            NESTED => Some(u64::from(self.stack - self.rom)),
            _ => (name == self.tick).then_some(tick),
        }
    }

    /// The rows whose figures are above their budgets.
    pub(crate) fn over_budget(&self, rows: &[Row]) -> Vec<String> {
        let over = |part: &str| {
            let (name, budget) = (self.labelled(part), self.budget(part)?);
            let row = rows.iter().find(|row| row.name == name)?;
            let index = Measure::ALL.iter().position(|it| *it == self.judged)?;
            let cycles = *row.longest?.get(index)?;
            let what = match self.judged {
                Measure::CyclesWaiting => "all accesses wait",
                _ => "the code waits",
            };
            (cycles > budget)
                .then(|| format!("{name}: {cycles} cycles where {what}, of at most {budget}"))
        };
        let name = self.labelled(NESTED);
        let stack = rows.iter().find(|row| row.name == name);
        let stack = stack
            .and_then(|row| Some(row.stack? + self.rom))
            .filter(|stack| *stack > self.stack);
        let stack =
            stack.map(|stack| format!("{name}: {stack} bytes of stack, of at most {}", self.stack));
        [self.tick, BLOCKING, BEFORE, RESPONSE, RECEIVER]
            .into_iter()
            .filter_map(over)
            .chain(stack)
            .collect()
    }
}

/// The end of something that takes `alone` if no tick comes: it and the ticks that begin before. Where ticks take all of the time, it
/// never ends.
fn with_ticks(alone: u64, tick: u64, period: u64) -> u64 {
    let mut end = alone;
    loop {
        let next = alone + end.div_ceil(period) * tick;
        if next == end || tick >= period {
            return next;
        }
        end = next;
    }
}

fn sum(mut one: [u64; MEASURES], other: [u64; MEASURES]) -> [u64; MEASURES] {
    for (one, other) in one.iter_mut().zip(other) {
        *one += other;
    }
    one
}
