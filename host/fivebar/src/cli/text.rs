//! `fivebar text`: a text as single strokes of a pen, as a file.

use super::failure::{Failure, refused};
use super::length::{length, positive_length};
use super::say::{leave_output_to, say};
use fivebar_files::lettering::{Align, Layout, Lettering};
use fivebar_report::output::write_whole;
use std::path::{Path, PathBuf};

/// Writes a text as single strokes of a pen, in a Hershey font.
///
/// The font has Latin letters, also with accents, digits and signs. The file is a job as any other:
/// `fivebar text Hello --out hello.svg`, then `fivebar sim hello.svg`.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The text; each argument is a line.
    #[arg(required = true, value_name = "LINE")]
    lines: Vec<String>,
    /// The file: .svg or .gcode; - is an SVG on the standard output.
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
    /// Height of capital letters.
    #[arg(long, value_name = "LENGTH", default_value = "10mm", value_parser = positive_length)]
    size: f64,
    /// Distance between letters beyond the font's own.
    #[arg(long, value_name = "LENGTH", default_value = "0mm", value_parser = length, allow_hyphen_values = true)]
    spacing: f64,
    /// Where the lines meet.
    #[arg(long, default_value = "left")]
    align: AlignArg,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum AlignArg {
    Left,
    Middle,
    Right,
}

impl From<AlignArg> for Align {
    fn from(of: AlignArg) -> Self {
        match of {
            AlignArg::Left => Self::Left,
            AlignArg::Middle => Self::Middle,
            AlignArg::Right => Self::Right,
        }
    }
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let written: fn(&Lettering) -> String = match ending(&args.out) {
        Some("svg") => Lettering::to_svg,
        None if args.out == Path::new("-") => Lettering::to_svg,
        Some("gcode" | "nc" | "ngc") => Lettering::to_gcode,
        _ => {
            return Err(Failure::Usage(format!(
                "{}: a text is written as .svg or .gcode",
                args.out.display()
            )));
        }
    };
    leave_output_to(&args.out);
    let layout = Layout {
        size: args.size,
        spacing: args.spacing,
        align: args.align.into(),
    };
    let text = args.lines.join("\n");
    let lettering = Lettering::new(&text, &layout).map_err(refused)?;
    write_whole(&args.out, written(&lettering)).map_err(refused)?;
    let [width, height] = lettering.size.map(|side| 1e3 * side);
    say(format_args!(
        "{} strokes, {width:.1} mm × {height:.1} mm, in {}",
        lettering.strokes.len(),
        args.out.display()
    ))
}

fn ending(path: &Path) -> Option<&str> {
    path.extension().and_then(|it| it.to_str())
}
