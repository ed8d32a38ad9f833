//! The bounds of an image's interrupts, as a table.

use std::fmt::Write as _;

use crate::image::Image;
use crate::program::{Bounds, Program};
use crate::stated::Stated;
use crate::timing::{MEASURES, Measure};
use crate::{Defect, Fault};

/// Registers that an exception saves, those of the FPU among them: 26 words; and a word so that
/// the stack stays aligned to 8 bytes.
const FRAME: u32 = 4 * (26 + 1);
/// Numbers of the reset and of the exception that ends the program.
const RESET: u32 = 1;

/// The bounds of one function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// The image's name and the function's.
    pub name: String,
    /// The longest path by each of [`Measure::ALL`]; none for what has no end.
    pub longest: Option<[u64; MEASURES]>,
    /// The deepest stack, with the registers that an exception saves [bytes]; none for a sum of times.
    pub stack: Option<u32>,
}

/// The bounds of an image.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// By function, then the sum of the stacks.
    pub rows: Vec<Row>,
    /// What cannot be bounded.
    pub defects: Vec<Defect>,
}

/// The bounds of one function of an image, by its name.
///
/// # Errors
/// If there is no such function.
pub fn of_function(
    label: &str,
    image: &Image,
    stated: &Stated,
    name: &str,
) -> Result<Report, String> {
    let function = image
        .functions()
        .find(|function| function.name.ends_with(name));
    let function = function.ok_or_else(|| format!("{label}: no function {name}"))?;
    let mut program = Program::new(image, stated);
    let Bounds { longest, stack, .. } = *program.bounds(function.address);
    let row = Row {
        name: format!("{label}: {name}"),
        longest: Some(longest),
        stack: Some(stack),
    };
    Ok(Report {
        rows: vec![row],
        defects: program.defects(function.address),
    })
}

/// The bounds of all handlers of an image, of its main program's stack, and the deepest stack
/// where all handlers interrupt each other. No priority is relied on: a handler does not
/// interrupt itself, so each is there once.
///
/// # Errors
/// If the image has no vector table or defines no stack.
pub fn of_handlers(label: &str, image: &Image, stated: &Stated) -> Result<Report, String> {
    let mut program = Program::new(image, stated);
    let mut report = Report::default();
    let mut addresses: Vec<(u32, u32)> = image.vectors().to_vec();
    addresses.sort_by_key(|(_, address)| *address);
    addresses.dedup_by_key(|(_, address)| *address);
    addresses.sort_unstable();
    if addresses.first().is_none_or(|(number, _)| *number != RESET) {
        return Err(format!("{label}: no vector table"));
    }
    let mut total = 0;
    for (number, address) in addresses {
        let name = image
            .function(address)
            .map_or_else(String::new, |function| function.name.clone());
        let Bounds {
            mut longest,
            mut stack,
            returns,
            float,
            ..
        } = *program.bounds(address);
        let defects = program.defects(address);
        let is_main = number == RESET;
        // The main program runs for ever; its loops need no bound.
        let has_time = !is_main && !stated.ends(&name);
        let matters = |fault: Fault| has_time || fault.concerns_stack();
        report
            .defects
            .extend(defects.into_iter().filter(|defect| matters(defect.fault)));
        if returns && !has_time {
            let fault = Fault::Returns;
            report.defects.push(Defect {
                function: name.clone(),
                address,
                fault,
            });
        }
        if !is_main {
            stack += FRAME;
            for (longest, measure) in longest.iter_mut().zip(Measure::ALL) {
                *longest += measure.exception(image.core, float);
            }
        }
        total += stack;
        report.rows.push(Row {
            name: format!("{label}: {name}"),
            longest: has_time.then_some(longest),
            stack: Some(stack),
        });
    }
    report.rows.push(Row {
        name: format!("{label}: all nested"),
        longest: None,
        stack: Some(total),
    });
    let (low, high) = image
        .stack
        .ok_or_else(|| format!("{label}: no stack is defined"))?;
    report.rows.push(Row {
        name: format!("{label}: space"),
        longest: None,
        stack: Some(high - low),
    });
    report.defects.sort();
    report.defects.dedup();
    Ok(report)
}

/// The table's head; the column of names is as wide.
const HEAD: &str = "longest path and deepest stack                instructions  cycles  code waits  all waits  stack [B]";
/// Width of the names.
const NAMES: usize = 44;

/// Rows as text.
pub fn table(compiler: &str, rows: &[Row]) -> String {
    let mut text = format!("{compiler}\n{HEAD}\n");
    for Row {
        name,
        longest,
        stack,
    } in rows
    {
        let [instructions, cycles, code_waits, all_waits] = match longest {
            Some(longest) => longest.map(|figure| figure.to_string()),
            None => ["-"; MEASURES].map(str::to_owned),
        };
        let stack = stack.map_or("-".to_owned(), |stack| stack.to_string());
        let _ = writeln!(
            text,
            "{name:NAMES$}  {instructions:>12}  {cycles:>6}  {code_waits:>10}  {all_waits:>9}  {stack:>9}"
        );
    }
    text
}

/// A table's compiler and rows.
pub fn read(text: &str) -> (String, Vec<Row>) {
    let mut lines = text.lines();
    let compiler = lines.next().unwrap_or_default().to_owned();
    let row = |line: &str| {
        let (name, figures) = line.split_at_checked(NAMES)?;
        let mut figures = figures.split_whitespace();
        let mut next = || figures.next()?.parse().ok();
        let longest: [Option<u64>; MEASURES] = [next(), next(), next(), next()];
        let stack = next();
        let known = longest.iter().all(Option::is_some);
        let longest = known.then(|| longest.map(Option::unwrap_or_default));
        // The heading has neither.
        (known || stack.is_some()).then(|| Row {
            name: name.trim().to_owned(),
            longest,
            stack: stack.map(|stack| stack as u32),
        })
    };
    (compiler, lines.filter_map(row).collect())
}

/// The share by which a figure may be larger than the committed one if the compiler is another.
const OTHER_COMPILER: f64 = 0.1;
/// The share by which it may be smaller; then the committed one no longer says what is proved.
const SMALLER: f64 = 0.01;

/// What a committed table and the present one do not agree in. With the same compiler no figure
/// may be larger.
pub fn compare(committed: &str, now: &str) -> Vec<String> {
    let ((committed_compiler, committed), (compiler, now)) = (read(committed), read(now));
    let same_compiler = committed_compiler == compiler;
    let (smaller, larger) = if same_compiler {
        (SMALLER, 0.0)
    } else {
        (1.0, OTHER_COMPILER)
    };
    let mut differences = Vec::new();
    for row in &now {
        let Some(then) = committed.iter().find(|then| then.name == row.name) else {
            differences.push(format!("{} is not committed", row.name));
            continue;
        };
        let figures = |row: &Row| {
            let [instructions, cycles, code_waits, all_waits] = row.longest.unwrap_or_default();
            [
                ("instructions", instructions),
                ("cycles", cycles),
                ("cycles where the code waits", code_waits),
                ("cycles where all waits", all_waits),
                ("bytes of stack", row.stack.unwrap_or(0).into()),
            ]
        };
        for ((what, now), (_, then)) in figures(row).into_iter().zip(figures(then)) {
            let change = now as f64 - then as f64;
            let differs = change > larger * then as f64 || -change > smaller * then as f64;
            if differs {
                differences.push(format!("{}: {now} {what}, committed {then}", row.name));
            }
        }
    }
    for then in &committed {
        if !now.iter().any(|row| row.name == then.name) {
            differences.push(format!("{} is committed and not there", then.name));
        }
    }
    differences
}
