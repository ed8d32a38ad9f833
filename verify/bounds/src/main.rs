//! Bounds of time and stack of the firmware images.
//!
//! ```text
//! fivebar-bounds check <folder of the images>              compares with verify/bounds/figures.txt
//! fivebar-bounds print <folder of the images>              prints the figures to commit
//! fivebar-bounds document                              the table of docs/verify/bounds.md, from the committed figures
//! fivebar-bounds path  <folder of the images> <image> <function>   the longest path's addresses
//! fivebar-bounds stack <folder of the images> <image> <function>   its deepest chain of calls
//! fivebar-bounds sections <folder of the images> <image> <function>   its critical sections
//! fivebar-bounds fits  <folder of the images> <image>   the stack alone, of an image for the RP2350
//! ```

use std::path::Path;
use std::process::ExitCode;

use fivebar_bounds::blocking::Section;
use fivebar_bounds::document;
use fivebar_bounds::image::Image;
use fivebar_bounds::program::Program;
use fivebar_bounds::report::{self, Report};
use fivebar_bounds::response;
use fivebar_bounds::stated::Stated;
use fivebar_bounds::timing::Measure;

/// What people state.
const STATED: &str = include_str!("../stated.txt");
/// The same of the RP2350's images.
const STATED_RP2350: &str = include_str!("../stated_rp2350.txt");
/// What the functions of the boot ROM may take of the stack [bytes]: its maker does not say it.
const ROM: u32 = 2048;
/// The figures as last committed.
const COMMITTED: &str = include_str!("../figures.txt");

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match arguments[..] {
        ["check", folder] => check(Path::new(folder)),
        ["document"] => document(),
        ["print", folder] => print(Path::new(folder)),
        ["path", folder, image, function] => path(&Path::new(folder).join(image), function),
        ["stack", folder, image, function] => stack(&Path::new(folder).join(image), function),
        ["sections", folder, image, function] => sections(&Path::new(folder).join(image), function),
        ["fits", folder, image] => fits(&Path::new(folder).join(image), image),
        _ => Err(
            "usage: fivebar-bounds check|print <folder>, document, path|stack|sections <folder> <image> <function>, \
             fits <folder> <image>"
                .to_owned(),
        ),
    };
    match outcome {
        Ok(text) => {
            print!("{text}");
            ExitCode::SUCCESS
        }
        Err(text) => {
            eprintln!("bounds: {text}");
            ExitCode::FAILURE
        }
    }
}

fn document() -> Result<String, String> {
    let (chip, instructions, accesses) = (
        include_str!("../../chip/figures.txt"),
        include_str!("../../../tests/data/instructions.txt"),
        include_str!("../../chip/accesses.txt"),
    );
    document::table(COMMITTED, chip, instructions, accesses)
        .ok_or_else(|| "a figure is missing".to_owned())
}

fn image(path: &Path) -> Result<Image, String> {
    let file = std::fs::read(path)
        .map_err(|error| format!("{}: {error}; run scripts/firmware.sh", path.display()))?;
    Image::read(&file).map_err(|error| format!("{}: {error}", path.display()))
}

/// The bounds of all images, as a table; an error if something has no bound.
fn print(folder: &Path) -> Result<String, String> {
    let stated = Stated::read(STATED)?;
    let tick = image(&folder.join("tick"))?;
    let Report {
        mut rows,
        mut defects,
    } = report::of_function("tick", &tick, &stated, "tick::__cortex_m_rt_main")?;
    for name in ["stm32f405", "stm32f405_stepper", "stm32f405_can", "qemu"] {
        let image = image(&folder.join(name))?;
        let mut report = report::of_handlers(name, &image, &stated)?;
        if let Some(driving) = response::IMAGES.iter().find(|it| it.label == name) {
            response::add(driving, &image, &stated, &mut report)?;
        }
        rows.extend(report.rows);
        defects.extend(report.defects);
    }
    let table = report::table(&tick.compiler, &rows);
    let defects = defects.iter().map(ToString::to_string);
    let unused = stated
        .unused()
        .map(|it| format!("there is no loop for: {it}"));
    let defects: Vec<String> = defects
        .chain(unused)
        .map(|it| format!("\n  {it}"))
        .collect();
    if defects.is_empty() {
        return Ok(table);
    }
    Err(format!(
        "{table}no bound, see bounds/stated.txt:{}",
        defects.concat()
    ))
}

fn check(folder: &Path) -> Result<String, String> {
    let now = print(folder)?;
    let (_, rows) = report::read(&now);
    let over = response::over_budget(&rows);
    if !over.is_empty() {
        return Err(format!("{now}{}", over.join("\n")));
    }
    let differences = report::compare(COMMITTED, &now);
    if differences.is_empty() {
        return Ok(now);
    }
    Err(format!(
        "{now}{}\nif that is right, commit the figures: \
         cargo run --package fivebar-bounds -- print <folder> > verify/bounds/figures.txt",
        differences.join("\n")
    ))
}

/// The addresses of a function's longest path in cycles where the code waits, in the order of the path.
fn path(file: &Path, function: &str) -> Result<String, String> {
    let (stated, image) = (Stated::read(STATED)?, image(file)?);
    let found = image
        .named(function)
        .ok_or_else(|| format!("no function {function}"))?;
    let mut program = Program::new(&image, &stated);
    let line = |(address, cost): &(u32, u64)| format!("{address:#x} {cost}\n");
    let path = program.longest_path(found.address, Measure::CyclesCodeWaits);
    Ok(path.iter().map(line).collect())
}

/// The deepest stack of an image and its space; an error if that is too small, or not known to suffice. Its times are not judged:
/// the core that runs it may count other cycles.
fn fits(file: &Path, name: &str) -> Result<String, String> {
    let stated = Stated::read(&[STATED, STATED_RP2350].concat())?;
    let image = image(file)?;
    let report = report::of_handlers(name, &image, &stated)?;
    let stack_of = |what: &str| {
        let row = report.rows.iter().find(|row| row.name.ends_with(what));
        row.and_then(|row| row.stack).unwrap_or(u32::MAX)
    };
    let (used, space) = (stack_of(": all nested"), stack_of(": space"));
    let line =
        format!("{name}: {used} bytes of stack at most, and {ROM} for the ROM, of {space}\n");
    let defects = report.defects.iter();
    let defects: Vec<String> = defects
        .filter(|defect| defect.fault.concerns_stack())
        .map(|defect| format!("{defect}\n"))
        .collect();
    if defects.is_empty() && used + ROM <= space {
        return Ok(line);
    }
    Err(format!("{line}{}", defects.concat()))
}

/// The chain of calls below a function that takes the most stack, with the share of each.
fn stack(file: &Path, function: &str) -> Result<String, String> {
    let (stated, image) = (Stated::read(STATED)?, image(file)?);
    let found = image
        .named(function)
        .ok_or_else(|| format!("no function {function}"))?;
    let chain = Program::new(&image, &stated).deepest(found.address);
    let line = |(name, bytes): &(String, u32)| format!("{bytes:6} {name}\n");
    Ok(chain.iter().map(line).collect())
}

/// The critical sections that a function reaches, with instructions and cycles, the longest last.
fn sections(file: &Path, function: &str) -> Result<String, String> {
    let (stated, image) = (Stated::read(STATED)?, image(file)?);
    let found = image
        .named(function)
        .ok_or_else(|| format!("no function {function}"))?;
    let (mut sections, defects) = Program::new(&image, &stated).sections(found.address);
    sections.sort_by_key(|section| section.longest);
    let line = |it: &Section| format!("{:#x} {:?} {}\n", it.address, it.longest, it.function);
    let lines = sections.iter().map(line);
    let defects = defects.iter().map(|defect| format!("{defect}\n"));
    Ok(lines.chain(defects).collect())
}
