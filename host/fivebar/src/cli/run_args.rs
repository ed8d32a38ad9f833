//! The options of commands that run a job.

use super::failure::{Failure, refused};
use super::length::{degrees, length, place, positive_length};
use super::output::OutputArgs;
use super::plan::share;
use super::preparing::preparing;
use super::say::warn;
use super::value_error::ValueError;
use fivebar_files::job::{Dialect, JobOptions, Trace};
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::{Kept, Scenario};
use fivebar_sim::simulation::Simulate;
use std::path::Path;

/// The job and the robot.
#[derive(clap::Args)]
pub(super) struct JobArgs {
    /// A scenario in TOML, a job in G-code, a drawing, or a picture; `-` for a job on the standard
    /// input. Without it `sim`, `pil` and `hil` do the demonstration.
    #[arg(value_name = "SCENARIO.toml|JOB.gcode|DRAWING.svg")]
    file: Option<String>,
    /// A built-in robot (see `fivebar robots`) or a robot file; by default the scenario's, or
    /// else the benchtop arm.
    #[arg(long)]
    robot: Option<String>,
    /// Position of the job's (0, 0) in the frame of the base, such as 30mm,160mm; by default the
    /// drawing is where the arm moves best, or where it fits.
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    origin: Option<[f64; 2]>,
    /// Metres in the plane per metre in the job. When left out: the scenario's, or 1; the
    /// demonstration is made as small as the arm needs.
    #[arg(long, value_parser = scale, allow_hyphen_values = true)]
    scale: Option<f64>,
    /// Turn the job about its (0, 0), counter-clockwise [degrees].
    #[arg(long, value_name = "DEGREES", value_parser = degrees, allow_hyphen_values = true)]
    rotate: Option<f64>,
    /// Draw as large as the arm can: with --scale only a turn and a place are searched, with
    /// --rotate only a scale and a place.
    #[arg(long, conflicts_with = "origin")]
    fit: bool,
    /// With --fit: stay this far inside what the arm reaches, on every side, such as 10mm.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, requires = "fit")]
    margin: Option<f64>,
    /// Start at this line of the job, or at this stroke of an SVG: the tool goes there without
    /// drawing what comes before.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    from_line: Option<u32>,
    /// Draw as fast as the arm's torque allows: feed rates and `[motion]` limits do not apply.
    #[arg(long)]
    time_optimal: bool,
    /// The share of the torque limits that --time-optimal plans with; the rest is for feedback. 0.7
    /// suits an arm as built, 0.9 one whose masses are identified.
    #[arg(long, value_name = "S", default_value_t = 0.7, value_parser = share, requires = "time_optimal")]
    torque_share: f64,
    #[command(flatten)]
    reading: ReadingArgs,
    #[command(flatten)]
    drawing: DrawingArgs,
}

/// How a job is read where its text leaves it open.
#[derive(clap::Args)]
pub(super) struct ReadingArgs {
    /// The unit of P in G4: seconds for grbl, milliseconds for reprap; by default reprap if the
    /// job has M17, M18, an M code from M80, E or checksums.
    #[arg(long, value_name = "grbl|reprap", value_parser = dialect)]
    dialect: Option<Dialect>,
    /// Z at or below which the pen is down, such as 1mm; by default 0, or the middle of the
    /// job's heights if all are on one side of 0.
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true)]
    pen_height: Option<f64>,
    /// S of M3 and M4 at full power, as $30 of Grbl.
    #[arg(long, value_name = "S", default_value_t = 1000.0, value_parser = scale)]
    full_power: f64,
    /// Speed along what is drawn, per second, such as 50mm, in place of the file's F; by default F, or the arm's
    /// greatest where the file has none.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    speed: Option<f64>,
    /// Fill the areas of an SVG with lines at 45° this far apart, such as 0.8mm; white ones stay empty. By default areas
    /// have outlines only. Of a picture, the width of the pen, by default 0.5 mm.
    #[arg(long, value_name = "LENGTH", value_parser = hatch, allow_hyphen_values = true)]
    hatch: Option<f64>,
}

/// How drawings and pictures become strokes.
#[derive(clap::Args)]
struct DrawingArgs {
    /// How a PNG or a JPEG becomes strokes, by default outline. Its longer side is 100 mm at --scale 1.
    #[arg(long = "picture", value_name = "outline|centre-line|tone|stipple|one-line", value_parser = picture)]
    picture_as: Option<Trace>,
    /// The darkness of a picture that becomes ink, 0 to 1; with tone, stipple and one-line half as much ink as black. By
    /// default what divides the picture best, or 0.5.
    #[arg(long, value_name = "SHARE", value_parser = level)]
    level: Option<f64>,
    /// Draw an SVG, DXF, HPGL or picture several times, in columns and rows.
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = copies)]
    copies: Option<[u32; 2]>,
    /// Distance between copies, by default 5 mm.
    #[arg(long, value_name = "LENGTH", value_parser = length, requires = "copies")]
    gap: Option<f64>,
}

impl DrawingArgs {
    fn added_to(&self, options: JobOptions) -> JobOptions {
        JobOptions {
            trace: self.picture_as,
            level: self.level,
            copies: self.copies.unwrap_or(options.copies),
            gap: self.gap.unwrap_or(options.gap),
            ..options
        }
    }
}

impl ReadingArgs {
    pub(super) fn options(&self) -> JobOptions {
        JobOptions {
            dialect: self.dialect,
            pen_height: self.pen_height,
            full_power: self.full_power,
            speed: self.speed,
            hatch: self.hatch,
            ..JobOptions::default()
        }
    }
}

fn hatch(text: &str) -> Result<f64, ValueError> {
    let distance = length(text).ok().filter(|it| (1e-4..=0.05).contains(it));
    distance.ok_or(ValueError::Hatch)
}

fn picture(text: &str) -> Result<Trace, ValueError> {
    let named = Trace::ALL.into_iter().find(|it| it.name() == text);
    named.ok_or(ValueError::Trace)
}

fn level(text: &str) -> Result<f64, ValueError> {
    let level = text.parse().ok().filter(|it| JobOptions::is_level(*it));
    level.ok_or(ValueError::Level)
}

fn copies(text: &str) -> Result<[u32; 2], ValueError> {
    let parse = || {
        let (columns, rows) = text.split_once(['x', '×'])?;
        let copies = [columns.trim().parse().ok()?, rows.trim().parse().ok()?];
        JobOptions::are_copies(copies).then_some(copies)
    };
    parse().ok_or(ValueError::Copies)
}

fn dialect(text: &str) -> Result<Dialect, ValueError> {
    match text {
        "grbl" => Ok(Dialect::Grbl),
        "reprap" => Ok(Dialect::RepRap),
        _ => Err(ValueError::Dialect),
    }
}

/// The job, the robot and the results.
#[derive(clap::Args)]
pub(super) struct RunArgs {
    #[command(flatten)]
    job: JobArgs,
    /// Greatest distance of the tip from its place while it draws, such as 0.5mm: beyond it the job is not drawn, and
    /// the exit status is 1. By default 1 mm, with hobby servos what their dead band and their delay allow.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length)]
    tolerance: Option<f64>,
    #[command(flatten)]
    pub(super) output: OutputArgs,
}

impl RunArgs {
    /// Whether a job is given.
    pub(super) fn names_a_job(&self) -> bool {
        self.job.names_a_job()
    }

    /// The scenario, with the changes by other options.
    pub(super) fn scenario(&self) -> Result<Scenario, Failure> {
        Ok(Scenario {
            tolerance: self.tolerance,
            ..self.job.scenario()?
        })
    }
}

impl JobArgs {
    /// Whether a job is given.
    pub(super) fn names_a_job(&self) -> bool {
        self.file.is_some()
    }

    /// The scenario, with the changes by other options.
    pub(super) fn scenario(&self) -> Result<Scenario, Failure> {
        let load = |name: &str| Robot::load(name).map_err(refused);
        let robot = self.robot.as_deref().map(load).transpose()?;
        let arm = || robot.clone().map_or_else(|| load(BuiltIn::DEFAULT), Ok);
        let mut scenario = match &self.file {
            None => Scenario::demonstration(arm()?),
            Some(file) if Path::new(file).extension().is_some_and(|e| e == "toml") => {
                Scenario::load(file).map_err(refused)?
            }
            Some(file) => Scenario::of_job(file, arm()?).map_err(refused)?,
        };
        if let Some(robot) = robot {
            scenario.robot = robot;
        }
        scenario.origin = self.origin.or(scenario.origin);
        scenario.turn = self.rotate.unwrap_or(scenario.turn);
        scenario.options = self.drawing.added_to(self.reading.options());
        scenario.margin = self.margin.unwrap_or_default();
        scenario.from_line = self.from_line;
        scenario.time_optimal = self.time_optimal.then_some(self.torque_share);
        match self.scale {
            Some(scale) => scenario.scale = scale,
            None if self.fit => {}
            None if self.file.is_none() => fit(&mut scenario),
            None => {}
        }
        if self.fit {
            let kept = Kept {
                scale: self.scale.is_some(),
                turn: self.rotate.is_some(),
            };
            let file = scenario.job_file.clone();
            preparing("fitting", &file, || scenario.fit_to_reach(kept)).map_err(refused)?;
            warn(format_args!(
                "{} is drawn with --scale {} --rotate {}",
                scenario.job_file,
                scenario.scale,
                (1e6 * scenario.turn.to_degrees()).round() / 1e6
            ));
        }
        Ok(scenario)
    }
}

/// Shrinks the demonstration to what the arm has room for. Where it has room for none, the
/// demonstration stays as it is, to be refused with the place and the reason.
fn fit(demonstration: &mut Scenario) {
    let mut fitted = demonstration.clone();
    if fitted.fit().is_ok() {
        if fitted.scale < demonstration.scale {
            warn(format_args!(
                "the demonstration is too large for this arm: it is drawn at a scale of {}",
                fitted.scale
            ));
        }
        *demonstration = fitted;
    }
}

/// Two numbers without a unit.
pub(super) fn point(text: &str) -> Result<[f64; 2], ValueError> {
    let parse = || {
        let (x, y) = text.split_once(',')?;
        let point = [x.trim().parse().ok()?, y.trim().parse().ok()?];
        point.iter().all(|x: &f64| x.is_finite()).then_some(point)
    };
    parse().ok_or(ValueError::Point)
}

pub(super) fn scale(text: &str) -> Result<f64, ValueError> {
    let scale = text
        .parse()
        .ok()
        .filter(|s: &f64| *s > 0.0 && s.is_finite());
    scale.ok_or(ValueError::Scale)
}
