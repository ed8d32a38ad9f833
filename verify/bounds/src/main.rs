//! Bounds of time and stack of the firmware images.
//!
//! ```text
//! fivebar-bounds check <folder of the images> [chip]       compares with the committed figures: verify/bounds/figures*.txt
//! fivebar-bounds print <folder of the images> [chip]       prints the figures to commit
//! fivebar-bounds document                              the table of docs/verify/bounds.md, from the committed figures
//! fivebar-bounds path  <folder of the images> <image> <function>   the longest path's addresses
//! fivebar-bounds stack <folder of the images> <image> <function>   its deepest chain of calls
//! fivebar-bounds sections <folder of the images> <image> <function>   its critical sections
//! ```

use std::path::Path;
use std::process::ExitCode;

use fivebar_bounds::blocking::Section;
use fivebar_bounds::document;
use fivebar_bounds::families::{FAMILIES, Family, stated_of_all};
use fivebar_bounds::image::Image;
use fivebar_bounds::program::Program;
use fivebar_bounds::report::{self, Report};
use fivebar_bounds::response;
use fivebar_bounds::timing::Measure;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match arguments[..] {
        ["check", folder, ref name @ ..] => family(name).and_then(|it| check(it, Path::new(folder))),
        ["document"] => document(),
        ["print", folder, ref name @ ..] => family(name).and_then(|it| print(it, Path::new(folder))),
        ["path", folder, image, function] => path(&Path::new(folder).join(image), function),
        ["stack", folder, image, function] => stack(&Path::new(folder).join(image), function),
        ["sections", folder, image, function] => sections(&Path::new(folder).join(image), function),
        _ => Err(
            "usage: fivebar-bounds check|print <folder> [chip], document, path|stack|sections <folder> <image> <function>"
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

/// The family of this name.
fn family(name: &[&str]) -> Result<&'static Family, String> {
    let name = name.concat();
    let found = FAMILIES.into_iter().find(|family| family.name == name);
    found.ok_or_else(|| format!("no images are called {name}"))
}

fn document() -> Result<String, String> {
    let (chip, instructions, accesses) = (
        include_str!("../../chip/figures.txt"),
        include_str!("../../../tests/data/instructions.txt"),
        include_str!("../../chip/accesses.txt"),
    );
    document::table(chip, instructions, accesses).ok_or_else(|| "a figure is missing".to_owned())
}

fn image(path: &Path) -> Result<Image, String> {
    let file = std::fs::read(path)
        .map_err(|error| format!("{}: {error}; run scripts/firmware.sh", path.display()))?;
    Image::read(&file).map_err(|error| format!("{}: {error}", path.display()))
}

/// The bounds of all images, as a table; an error if something has no bound.
fn print(family: &Family, folder: &Path) -> Result<String, String> {
    let stated = family.stated()?;
    let mut all = Report::default();
    let mut compiler = String::new();
    let driving = family.images.iter().map(|it| (it.label, Some(it)));
    let others = family.others.iter().map(|&label| (label, None));
    for (label, driving) in others.chain(driving) {
        let image = image(&folder.join(label))?;
        let mut report = match label {
            "tick" => report::of_function(label, &image, &stated, "tick::__cortex_m_rt_main")?,
            _ => report::of_handlers(label, &image, &stated)?,
        };
        if let Some(driving) = driving {
            response::add(driving, &image, &stated, &mut report)?;
        }
        all.rows.extend(report.rows);
        all.defects.extend(report.defects);
        compiler = image.compiler;
    }
    let table = report::table(&compiler, &all.rows);
    let defects = all.defects.iter().map(ToString::to_string);
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
        "{table}no bound, see verify/bounds/stated*.txt:{}",
        defects.concat()
    ))
}

fn check(family: &Family, folder: &Path) -> Result<String, String> {
    let now = print(family, folder)?;
    let (_, rows) = report::read(&now);
    let over = family.over_budget(&rows);
    if !over.is_empty() {
        return Err(format!("{now}{}", over.join("\n")));
    }
    let differences = report::compare(family.committed, &now);
    if differences.is_empty() {
        return Ok(now);
    }
    Err(format!(
        "{now}{}\nif that is right, commit the figures: print in place of check, into verify/bounds/{}",
        differences.join("\n"),
        family.file
    ))
}

/// The addresses of a function's longest path in cycles where the code waits, in the order of the path.
fn path(file: &Path, function: &str) -> Result<String, String> {
    let (stated, image) = (stated_of_all()?, image(file)?);
    let found = image
        .named(function)
        .ok_or_else(|| format!("no function {function}"))?;
    let mut program = Program::new(&image, &stated);
    let line = |(address, cost): &(u32, u64)| format!("{address:#x} {cost}\n");
    let path = program.longest_path(found.address, Measure::CyclesCodeWaits);
    Ok(path.iter().map(line).collect())
}

/// The chain of calls below a function that takes the most stack, with the share of each.
fn stack(file: &Path, function: &str) -> Result<String, String> {
    let (stated, image) = (stated_of_all()?, image(file)?);
    let found = image
        .named(function)
        .ok_or_else(|| format!("no function {function}"))?;
    let chain = Program::new(&image, &stated).deepest(found.address);
    let line = |(name, bytes): &(String, u32)| format!("{bytes:6} {name}\n");
    Ok(chain.iter().map(line).collect())
}

/// The critical sections that a function reaches, with instructions and cycles, the longest last.
fn sections(file: &Path, function: &str) -> Result<String, String> {
    let (stated, image) = (stated_of_all()?, image(file)?);
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
