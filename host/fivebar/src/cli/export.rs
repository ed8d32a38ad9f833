//! `fivebar export`: a robot for other tools.

use super::failure::{Failure, refused};
use super::say::{leave_output_to, print, say};
use fivebar_files::robot::Robot;
use fivebar_report::export::{dot, mjcf, urdf};
use fivebar_report::output::write_whole;
use std::path::PathBuf;

/// Writes a robot for MuJoCo (mjcf), for URDF readers, or as a Graphviz drawing (dot).
#[derive(clap::Args)]
pub(super) struct Args {
    /// The format.
    format: Format,
    /// A robot file, or the name of a built-in robot.
    #[arg(default_value = "benchtop")]
    robot: String,
    /// The file to write; by default the text is printed.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Format {
    /// MuJoCo; an equality constraint closes the loop.
    Mjcf,
    /// URDF; the loop is open at C, and gravity is not in it: the file says what to set.
    Urdf,
    /// Links and joints as a graph.
    Dot,
}

impl Format {
    /// The programs that read the format.
    fn reader(self) -> &'static str {
        match self {
            Self::Mjcf => "MuJoCo",
            Self::Urdf => {
                "readers of URDF, without gravity and with its loop open at C as the file says,"
            }
            Self::Dot => "Graphviz",
        }
    }
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let robot = Robot::load(&args.robot).map_err(refused)?;
    let text = match args.format {
        Format::Mjcf => mjcf(&robot).map_err(refused)?,
        Format::Urdf => urdf(&robot).map_err(refused)?,
        Format::Dot => dot(&robot),
    };
    match &args.out {
        Some(path) => {
            leave_output_to(path);
            write_whole(path, text).map_err(refused)?;
            say(format_args!(
                "wrote {} for {} to {}",
                robot.name,
                args.format.reader(),
                path.display()
            ))?;
            Ok(())
        }
        None => {
            print(&text)?;
            Ok(())
        }
    }
}
