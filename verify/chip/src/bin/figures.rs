//! Sums up the figures of a run of all tests, and compares them with the committed ones.
//!
//! `figures <image> <folder> <committed>`; with `--write` it writes them instead.

use fivebar_chip::{Image, Summary};
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

/// The least share of the machine code that the tests must run [%].
const LEAST_COVERAGE: f64 = 85.0;
/// A function with so many bytes that did not run is listed.
const MANY: u32 = 150;
/// How far a figure may be from the committed one, for another compiler [%].
const TOLERANCE: f64 = 10.0;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [image, folder, committed, rest @ ..] = arguments.as_slice() else {
        eprintln!("figures <image> <folder> <committed> [--write]");
        return ExitCode::FAILURE;
    };
    let image = match Image::read(&PathBuf::from(image)) {
        Ok(image) => image,
        Err(error) => return failed(&error.to_string()),
    };
    let summary = match Summary::read(&PathBuf::from(folder)) {
        Ok(summary) if summary.ticks > 0 => summary,
        Ok(_) => return failed("no chip has stored figures"),
        Err(error) => return failed(&format!("{folder}: {error}")),
    };
    let figures = figures(&image, &summary);
    let text: String = figures
        .iter()
        .fold(String::new(), |mut text, (name, value)| {
            let _ = writeln!(text, "{name}: {value:.1}");
            text
        });
    let unreached = unreached(&image, &summary);
    print!("{text}");
    let [(_, coverage), ..] = figures;
    if coverage < LEAST_COVERAGE {
        print!("{unreached}");
        return failed(&format!("less than {LEAST_COVERAGE} % of the code ran"));
    }
    if rest.iter().any(|option| option == "--write") {
        let text = format!("{text}\nWhat no test runs [bytes of the function's]:\n\n{unreached}");
        return match std::fs::write(committed, text) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => failed(&format!("{committed}: {error}")),
        };
    }
    let committed = match std::fs::read_to_string(committed) {
        Ok(text) => text,
        Err(error) => return failed(&format!("{committed}: {error}")),
    };
    for (name, value) in figures {
        let line = committed
            .lines()
            .find_map(|line| line.strip_prefix(&format!("{name}: ")));
        let Some(before) = line.and_then(|text| text.parse::<f64>().ok()) else {
            return failed(&format!("no committed figure '{name}'"));
        };
        if (value / before - 1.0).abs() > TOLERANCE / 100.0 {
            return failed(&format!("{name}: {value:.1}, committed {before:.1}"));
        }
    }
    ExitCode::SUCCESS
}

fn failed(why: &str) -> ExitCode {
    eprintln!("figures: {why}");
    ExitCode::FAILURE
}

fn figures(image: &Image, summary: &Summary) -> [(&'static str, f64); 4] {
    let text = image.text.clone();
    let size = f64::from(text.end - text.start);
    let ran = f64::from(summary.ran_in(text));
    [
        ("code that ran [%]", 100.0 * ran / size),
        (
            "tick, mean [instructions]",
            summary.in_ticks as f64 / summary.ticks as f64,
        ),
        ("tick, most [instructions]", summary.longest_tick as f64),
        ("stack, most [bytes]", summary.stack as f64),
    ]
}

/// Functions of which less than half ran, or many bytes did not; those with most of them first.
fn unreached(image: &Image, summary: &Summary) -> String {
    let mut functions: Vec<_> = image
        .functions()
        .iter()
        .map(|(address, size, name)| (size - summary.ran_in(*address..address + size), size, name))
        .filter(|&(left, &size, _)| left >= MANY || 2 * left > size && size > 16)
        .collect();
    functions.sort_by_key(|&(left, ..)| std::cmp::Reverse(left));
    functions
        .iter()
        .fold(String::new(), |mut text, (left, size, name)| {
            let _ = writeln!(text, "{left:5} of {size:5}: {}", readable(name));
            text
        })
}

/// A mangled name without its numbers and hash.
fn readable(name: &str) -> String {
    let mut parts = Vec::new();
    let mut rest = name.strip_prefix("_ZN").unwrap_or(name);
    loop {
        let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let Ok(length) = rest[..digits].parse::<usize>() else {
            break;
        };
        let Some(part) = rest.get(digits..digits + length) else {
            break;
        };
        parts.push(part);
        rest = &rest[digits + length..];
    }
    parts.pop_if(|part| part.len() == 17 && part.starts_with('h'));
    if parts.is_empty() {
        name.to_owned()
    } else {
        parts.join("::")
    }
}
