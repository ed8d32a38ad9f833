//! The command line: one module per subcommand, each with its arguments and a `run`.

// These macros panic if the output is closed; `say` does not.
#![warn(clippy::print_stdout, clippy::print_stderr)]

mod accuracy;
mod answer;
mod board_test;
mod bridge;
mod calibrate;
mod clearance;
mod commission;
mod completions;
mod demo;
mod design;
mod doctor;
mod drive;
mod enter_key;
mod examples;
mod export;
mod failure;
mod figures;
mod flash;
mod hil;
mod identify;
mod length;
mod linkage;
mod lockstep;
mod log;
mod man;
mod margins;
mod mobility;
mod monitor;
mod new;
mod output;
mod pen;
mod photo;
mod pil;
mod plan;
mod port;
mod preparing;
mod query;
mod questions;
mod raw_inputs;
mod repeat;
mod replay;
mod rewrite;
mod robots;
mod ros;
mod run_args;
mod say;
mod serve;
mod settings;
mod sim;
mod teach;
mod text;
mod value_error;
mod workspace;

use crate::job_process;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use say::warn;
use std::process::ExitCode;

pub use failure::Failure;

/// Simulate, check and drive a planar five-bar arm.
///
/// Without a command, the default arm draws the demonstration in simulation.
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    demo: demo::Args,
}

#[derive(Subcommand)]
enum Command {
    Accuracy(Box<accuracy::Args>),
    BoardTest(board_test::Args),
    Bridge(bridge::Args),
    Calibrate(calibrate::Args),
    Clearance(clearance::Args),
    Clear(settings::ClearArgs),
    Commission(commission::Args),
    Completions(completions::Args),
    Design(design::Args),
    Doctor(doctor::Args),
    Drive(drive::Args),
    Export(export::Args),
    Flash(flash::Args),
    Hil(hil::Args),
    Identify(identify::Args),
    Linkage(linkage::Args),
    Man(man::Args),
    Margins(margins::Args),
    Mobility(mobility::Args),
    Monitor(monitor::Args),
    New(new::Args),
    Pen(pen::Args),
    Photo(Box<photo::Args>),
    Pil(pil::Args),
    Plan(plan::Args),
    Query(query::Args),
    Replay(replay::Args),
    Robots(robots::Args),
    Ros(ros::Args),
    Serve(serve::Args),
    Settings(settings::Args),
    Sim(sim::Args),
    Teach(teach::Args),
    Text(text::Args),
    Workspace(workspace::Args),
}

/// The definition of the command line: for parsing, completions and the manual.
fn command() -> clap::Command {
    examples::with_examples(Cli::command())
}

/// Parses the arguments, runs the command and reports its failure.
pub fn main() -> ExitCode {
    if std::env::args_os()
        .nth(1)
        .is_some_and(|it| it == job_process::COMMAND)
    {
        return job_process::main();
    }
    let parsed = Cli::from_arg_matches(&command().get_matches());
    let cli = parsed.unwrap_or_else(|error| error.exit());
    let outcome: Result<(), Failure> = match cli.command {
        None => demo::run(&cli.demo),
        Some(command) => match command {
            Command::Accuracy(args) => accuracy::run(&args),
            Command::BoardTest(args) => board_test::run(&args),
            Command::Bridge(args) => bridge::run(&args),
            Command::Calibrate(args) => calibrate::run(&args),
            Command::Clearance(args) => clearance::run(&args),
            Command::Clear(args) => settings::clear(&args),
            Command::Commission(args) => commission::run(&args),
            Command::Completions(args) => completions::run(&args),
            Command::Design(args) => design::run(&args),
            Command::Doctor(args) => doctor::run(&args),
            Command::Drive(args) => drive::run(&args),
            Command::Export(args) => export::run(&args),
            Command::Flash(args) => flash::run(&args),
            Command::Hil(args) => hil::run(&args),
            Command::Identify(args) => identify::run(&args),
            Command::Linkage(args) => linkage::run(&args),
            Command::Man(args) => man::run(&args),
            Command::Margins(args) => margins::run(&args),
            Command::Mobility(args) => mobility::run(&args),
            Command::Monitor(args) => monitor::run(&args),
            Command::New(args) => new::run(&args),
            Command::Pen(args) => pen::run(&args),
            Command::Photo(args) => photo::run(&args),
            Command::Pil(args) => pil::run(&args),
            Command::Plan(args) => plan::run(&args),
            Command::Query(args) => query::run(&args),
            Command::Replay(args) => replay::run(&args),
            Command::Robots(args) => robots::run(&args),
            Command::Ros(args) => ros::run(&args),
            Command::Serve(args) => serve::run(&args),
            Command::Settings(args) => settings::run(&args),
            Command::Sim(args) => sim::run(&args),
            Command::Teach(args) => teach::run(&args),
            Command::Text(args) => text::run(&args),
            Command::Workspace(args) => workspace::run(&args),
        },
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            warn(format_args!("fivebar: {failure}"));
            failure.exit_code()
        }
    }
}
