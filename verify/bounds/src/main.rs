//! Bounds of time and stack of the firmware images.
//!
//! ```text
//! fivebar-bounds check <folder of the images>              compares with bounds/figures.txt
//! fivebar-bounds print <folder of the images>              prints the figures to commit
//! fivebar-bounds path  <folder of the images> <image> <function>   the longest path's addresses
//! ```

use std::path::Path;
use std::process::ExitCode;

use fivebar_bounds::image::Image;
use fivebar_bounds::program::Program;
use fivebar_bounds::report::{self, Report};
use fivebar_bounds::stated::Stated;
use fivebar_bounds::timing::Measure;

/// What people state.
const STATED: &str = include_str!("../stated.txt");
/// The figures as last committed.
const COMMITTED: &str = include_str!("../figures.txt");

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match arguments[..] {
        ["check", folder] => check(Path::new(folder)),
        ["print", folder] => print(Path::new(folder)),
        ["path", folder, image, function] => path(&Path::new(folder).join(image), function),
        _ => Err(
            "usage: fivebar-bounds check|print <folder>, path <folder> <image> <function>"
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
    for name in ["stm32f405", "qemu"] {
        let report = report::of_handlers(name, &image(&folder.join(name))?, &stated)?;
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
    let over = report::over_budget(&rows);
    if !over.is_empty() {
        return Err(format!("{now}{}", over.join("\n")));
    }
    let differences = report::compare(COMMITTED, &now);
    if differences.is_empty() {
        return Ok(now);
    }
    Err(format!(
        "{now}{}\nif that is right, commit the figures: \
         cargo run --package fivebar-bounds -- print <folder> > bounds/figures.txt",
        differences.join("\n")
    ))
}

/// The addresses of a function's longest path in instructions, in the order of the path.
fn path(file: &Path, function: &str) -> Result<String, String> {
    let (stated, image) = (Stated::read(STATED)?, image(file)?);
    let found = image
        .named(function)
        .ok_or_else(|| format!("no function {function}"))?;
    let mut program = Program::new(&image, &stated);
    let line = |(address, cost): &(u32, u64)| format!("{address:#x} {cost}\n");
    let path = program.longest_path(found.address, Measure::Instructions);
    Ok(path.iter().map(line).collect())
}
