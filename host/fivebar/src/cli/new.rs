//! `fivebar new`: a robot file for the user's own arm.

use super::failure::{Failure, refused};
use super::questions::{ARM, Question, about_drives, about_hanging, about_motors};
use super::say::{hint, leave_output_to, say, warn};
use fivebar_files::robot::{BuiltIn, Draft, DraftError, Motors};
use fivebar_report::output::{STANDARD_OUTPUT, write_new};
use fivebar_report::text::no_demo_scale;
use fivebar_sim::boards::BoardImage;
use fivebar_sim::machine::Machine;
use fivebar_sim::simulation::find_demo_scale;
use std::io::{self, BufRead};
use std::path::{Path, PathBuf};

/// Asks the few questions that an arm needs and writes its robot file.
///
/// Answers are read line by line from the standard input. An empty line takes the default in
/// brackets; a question is repeated until its answer is valid. The file holds all keys with
/// their units; those without a question are comments. An existing file is not replaced.
/// Before the file is written, the arm draws the demonstration in simulation; if it cannot,
/// the reason is printed.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The file to write, such as my-arm.toml; `-` for the standard output.
    #[arg(value_name = "ROBOT.toml")]
    file: PathBuf,
    /// Use all defaults and ask no questions.
    #[arg(long)]
    defaults: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let file = args.file.display();
    leave_output_to(&args.file);
    if args.file.exists() {
        return Err(refused(format_args!(
            "{file} exists already; give another name or move the file"
        )));
    }
    if args
        .file
        .to_str()
        .is_some_and(|name| BuiltIn::find(name).is_some())
    {
        return Err(refused(format_args!(
            "{file} is the name of a built-in robot, which --robot would use instead; add .toml"
        )));
    }
    let stem = args.file.file_stem().unwrap_or_default();
    let is_unnamed = args.file.as_path() == Path::new(STANDARD_OUTPUT);
    let mut draft = Draft::new(&if is_unnamed {
        "my arm".into()
    } else {
        stem.to_string_lossy()
    });
    if !args.defaults {
        interview(&mut draft, &mut io::stdin().lock())?;
    }
    let robot = draft.check().map_err(refused)?;
    let images = match draft.motors {
        Motors::Ideal => Vec::new(),
        _ => Machine::of(robot.drive_kind()).images().collect(),
    };
    let image = match &images[..] {
        [first, _, ..] if !args.defaults => Some(choose(&images, first, &mut io::stdin().lock())?),
        _ => images.first(),
    };
    let command = format!("fivebar sim --robot {}", in_shell(&file.to_string()));
    let next_step = match find_demo_scale(&robot) {
        Ok(1.0) => format!("Try it: {command}"),
        Ok(scale) => {
            format!("The demonstration is too large for it: {command} --scale {scale}")
        }
        Err(error) => {
            warn(format_args!(
                "This arm cannot draw the demonstration: {}.",
                no_demo_scale(&error)
            ));
            format!("Change the file, then try it: {command}")
        }
    };
    write_new(&args.file, draft.text()).map_err(refused)?;
    let image = image.map_or_else(String::new, |image| {
        let name = image.name;
        format!(" for the image {name} (docs/use/wiring.md has its boards)")
    });
    say(format_args!("Wrote {file}{image}. {next_step}"))
}

/// Asks for the board where several have an image for these motors. The file is the same for all of them.
fn choose<'a>(
    images: &'a [BoardImage],
    first: &'a BoardImage,
    input: &mut impl BufRead,
) -> Result<&'a BoardImage, Failure> {
    let chips: Vec<_> = images.iter().map(|image| image.chip.name).collect();
    loop {
        hint(format_args!(
            "Board: {} [{}]: ",
            chips.join(" or "),
            first.chip.name
        ));
        let mut line = String::new();
        input.read_line(&mut line).map_err(refused)?;
        let answer = line.trim();
        if answer.is_empty() {
            return Ok(first);
        }
        match images.iter().find(|image| image.chip.name == answer) {
            Some(image) => return Ok(image),
            None => warn(format_args!(
                "  Not valid: {answer}; answer {}",
                chips.join(" or ")
            )),
        }
    }
}

/// A file's name, quoted for a shell if necessary.
fn in_shell(name: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "/\\:._-+".contains(letter);
    if name.chars().all(is_plain) {
        name.into()
    } else {
        format!("'{}'", name.replace('\'', r"'\''"))
    }
}

fn interview(draft: &mut Draft, input: &mut impl BufRead) -> Result<(), Failure> {
    let mut last = String::new();
    for question in &ARM {
        last = ask(question, draft, input)?;
    }
    loop {
        let hanging = about_hanging(draft);
        for question in about_motors(&draft.motors, &last).iter().chain(&hanging) {
            ask(question, draft, input)?;
        }
        for question in &about_drives(&draft.motors) {
            ask(question, draft, input)?;
        }
        let Err(reason) = draft.check() else {
            return Ok(());
        };
        warn(format_args!(
            "  Not valid: {reason}\n  The questions about the motors once more:"
        ));
    }
}

/// Whether an answer is valid, or may become so by later ones: whether steppers and hobby servos can hold a hanging arm is
/// seen when all is known of them.
fn check(draft: &Draft) -> Result<(), DraftError> {
    let Err(reason) = draft.check() else {
        return Ok(());
    };
    let follows = matches!(draft.motors, Motors::Steppers(_) | Motors::HobbyServos(_));
    let lying = Draft {
        upright: false,
        ..draft.clone()
    };
    if draft.upright && follows && lying.check().is_ok() {
        return Ok(());
    }
    Err(reason)
}

/// Repeats a question until its answer gives a valid robot file; returns the answer.
fn ask(
    question: &Question,
    draft: &mut Draft,
    input: &mut impl BufRead,
) -> Result<String, Failure> {
    loop {
        let default = (question.default)(draft);
        hint(format_args!("{} [{default}]: ", question.text));
        let mut line = String::new();
        if input.read_line(&mut line).map_err(refused)? == 0 {
            warn("");
            return Err(refused(format_args!(
                "the answers end at \"{}\"; an empty line takes a default, --defaults takes all",
                question.text
            )));
        }
        let answer = match line.trim() {
            "" => default,
            answer => answer.to_owned(),
        };
        let mut changed = draft.clone();
        if let Err(reason) = (question.take)(&mut changed, &answer) {
            warn(format_args!("  Not valid: {reason}"));
        } else if let Err(reason) = check(&changed) {
            warn(format_args!("  Not valid: {reason}"));
        } else {
            *draft = changed;
            return Ok(answer);
        }
    }
}
