//! `fivebar` without a command: the demonstration, a drawing job on the default arm, and what to try after it.

use super::failure::{Failure, refused};
use super::output::OutputArgs;
use super::repeat::RepeatArgs;
use super::say::{print, say};
use super::sim;
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use std::io::{self, BufRead, IsTerminal};
use std::process::Command;

#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    output: OutputArgs,
}

/// What newcomers try next: its words, and the command, in which FILE stands for a file that is asked for.
const NEXT: [(&str, &str); 4] = [
    ("move the arm on a page in your browser", "serve"),
    (
        "draw a file of your own (G-code, SVG, DXF, HPGL)",
        "sim FILE --fit",
    ),
    ("describe your own arm", "new my-arm.toml"),
    ("see what this computer lacks for a real arm", "doctor"),
];
/// The name of an asked-for file in a command.
const FILE: &str = "FILE";

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let robot = Robot::load(BuiltIn::DEFAULT).map_err(refused)?;
    let scenario = Scenario::demonstration(robot);
    sim::simulate(&scenario, &args.output, false, &RepeatArgs::default())?;
    if args.output.json {
        return Ok(());
    }
    say("\nOpen the report in a browser. Then try:")?;
    for (number, (words, command)) in NEXT.iter().enumerate() {
        say(format_args!("  {}  {words}: fivebar {command}", number + 1))?;
    }
    say("`fivebar help` lists all commands.")?;
    // A script, or a program that reads the output, is asked nothing.
    if !io::stdin().is_terminal() || !io::stdout().is_terminal() {
        return Ok(());
    }
    let Some(arguments) = chosen(&mut io::stdin().lock())? else {
        return Ok(());
    };
    let program = std::env::current_exe().map_err(refused)?;
    let ended = Command::new(program).args(arguments).status();
    match ended.map_err(refused)?.success() {
        true => Ok(()),
        // The command has said why.
        false => Err(refused("the command above failed")),
    }
}

/// The arguments of what the user chooses by its number; none for an empty line or the end of the answers.
fn chosen(answers: &mut impl BufRead) -> Result<Option<Vec<String>>, Failure> {
    let mut ask = |question: String| -> Result<Option<String>, Failure> {
        print(question)?;
        let mut answer = String::new();
        let read = answers.read_line(&mut answer).map_err(refused)?;
        let answer = answer.trim().to_owned();
        Ok((read > 0 && !answer.is_empty()).then_some(answer))
    };
    loop {
        let question = format!("Which, 1 to {}? The Enter key ends: ", NEXT.len());
        let Some(answer) = ask(question)? else {
            return Ok(None);
        };
        let number = answer
            .parse::<usize>()
            .ok()
            .and_then(|it| it.checked_sub(1));
        let Some((_, command)) = number.and_then(|index| NEXT.get(index)) else {
            say(format_args!("There is no {answer}."))?;
            continue;
        };
        let mut arguments: Vec<String> = command.split(' ').map(str::to_owned).collect();
        if let Some(file) = arguments.iter_mut().find(|it| *it == FILE) {
            match ask("The file: ".into())? {
                Some(name) => *file = name,
                None => continue,
            }
        }
        return Ok(Some(arguments));
    }
}

#[cfg(test)]
mod tests {
    use super::{NEXT, chosen};

    #[test]
    fn a_number_chooses_a_command_and_an_empty_line_ends() {
        let of = |answers: &str| chosen(&mut answers.as_bytes()).unwrap();
        assert_eq!(of(""), None);
        assert_eq!(of("\n1\n"), None);
        assert_eq!(of("1\n"), Some(vec!["serve".into()]));
        let draw = ["sim", "my drawing.svg", "--fit"]
            .map(String::from)
            .to_vec();
        assert_eq!(of("2\nmy drawing.svg\n"), Some(draw));
        // What is no number of the list is asked again, and so is a file without a name.
        assert_eq!(
            of("0\n9\nx\n2\n\n3\n"),
            Some(vec!["new".into(), "my-arm.toml".into()])
        );
    }

    #[test]
    fn each_command_is_one_of_the_program() {
        for (_, command) in NEXT {
            let arguments = ["fivebar"].into_iter().chain(command.split(' '));
            let read = crate::cli::command().try_get_matches_from(arguments);
            assert!(read.is_ok(), "{command}: {read:?}");
        }
    }
}
