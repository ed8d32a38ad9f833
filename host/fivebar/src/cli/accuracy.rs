//! `fivebar accuracy`: the effect of tolerances and clearances on positions and forces.

use super::failure::{Failure, refused};
use super::figures::figures;
use super::length::{place, positive_length};
use super::say::{print, say, warn};
use super::value_error::ValueError;
use clap::ArgGroup;
use fivebar_design::accuracy::Sampling;
use fivebar_design::accuracy::five_bar::{ToolState, draws, monte_carlo};
use fivebar_design::accuracy::slider::sample_slider;
use fivebar_files::accuracy_classes::Classes;
use fivebar_files::job::{self, Job, Placement};
use fivebar_files::linkage::DrivenLinkage;
use fivebar_files::robot::{Mechanism, Robot, SliderRobot};
use fivebar_files::scenario::Scenario;
use fivebar_report::html::Page;
use fivebar_report::output::write_in;
use fivebar_report::pages::accuracy::{at_page, linkage_page, map_page, path_page, slider_page};
use fivebar_report::study::accuracy::{
    accuracy_map, allocation_answer, analyse, analyse_slider, answer, cheapest, linkage_answer,
    map_answer, path_accuracy, path_answer, slider_answer, study_linkage, without_tolerance,
};
use fivebar_report::text::quantity;
use indicatif::ProgressBar;
use nalgebra::Vector2;
use serde_json::Value;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// Computes the effect of tolerances and clearances, by analysis and by sampling.
#[derive(clap::Args)]
#[command(group = ArgGroup::new("where").args(["at", "path", "map", "time"]))]
pub(super) struct Args {
    /// A robot or linkage file with [tolerance], or a built-in robot or example.
    file: String,
    /// Analyse one position X,Y of C, such as 40mm,200mm; for a slider-driven mechanism, of P.
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    at: Option<[f64; 2]>,
    /// Analyse the path of a G-code job at its feed rates.
    #[arg(long, value_name = "JOB.gcode")]
    path: Option<PathBuf>,
    /// Analyse the whole workspace.
    #[arg(long)]
    map: bool,
    /// For a linkage: the instant of its sweep to sample [s]; by default its beginning.
    #[arg(long, value_name = "SECONDS", value_parser = instant)]
    time: Option<f64>,
    /// With --at: velocity of C [m/s].
    #[arg(long, value_name = "X,Y", value_parser = numbers::<2>, allow_hyphen_values = true, default_value = "0,0")]
    velocity: [f64; 2],
    /// With --at: acceleration of C [m/s²].
    #[arg(long, value_name = "X,Y", value_parser = numbers::<2>, allow_hyphen_values = true, default_value = "0,0")]
    acceleration: [f64; 2],
    /// Force on C [N].
    #[arg(long, value_name = "X,Y", value_parser = numbers::<2>, allow_hyphen_values = true, default_value = "0,0")]
    force: [f64; 2],
    /// With --path: position of the job's (0,0), such as 30mm,160mm; by default where `fivebar sim`
    /// draws it.
    #[arg(long, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    origin: Option<[f64; 2]>,
    /// With --path: metres in the plane per metre in the job.
    #[arg(long, default_value_t = 1.0)]
    scale: f64,
    /// With --map: analyse only this rectangle [m].
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = numbers::<4>, allow_hyphen_values = true)]
    region: Option<[f64; 4]>,
    /// With --map: find the cheapest tolerances with a radial standard deviation of at most
    /// this everywhere, such as 50um.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, requires_all = ["map", "classes"])]
    wanted: Option<f64>,
    /// With --wanted: the classes of tolerance with their deviations and costs (TOML).
    #[arg(long, value_name = "CLASSES.toml", requires = "wanted")]
    classes: Option<PathBuf>,
    /// With --at, or for a linkage: number of Monte Carlo samples of each figure.
    #[arg(long, default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(2..=100_000_000))]
    samples: u32,
    /// Seed of the samples.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print the result as one JSON object.
    #[arg(long)]
    json: bool,
    /// Write a report to DIR/report.html.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn numbers<const N: usize>(text: &str) -> Result<[f64; N], ValueError> {
    let parsed: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let wrong = || ValueError::Numbers(N);
    let numbers: [f64; N] = parsed
        .map_err(|_| wrong())?
        .try_into()
        .map_err(|_| wrong())?;
    if numbers.iter().all(|x| x.is_finite()) {
        Ok(numbers)
    } else {
        Err(wrong())
    }
}

fn instant(text: &str) -> Result<f64, ValueError> {
    numbers::<1>(text).map(|[time]| time)
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let (answer, page) = subject(args)?;
    if let Some(folder) = &args.out {
        write_in(folder, "report.html", page.render()).map_err(refused)?;
    }
    if args.json {
        say(&answer)?;
    } else {
        if let Some(headline) = headline(&answer) {
            say(headline)?;
        }
        print(figures(&answer))?;
    }
    Ok(())
}

/// The answer in a sentence, where a robot was analysed at one position.
fn headline(answer: &Value) -> Option<String> {
    let figure = |value: &Value| Some(quantity(value.as_f64()?, "m"));
    let [x, y] = [0, 1].map(|axis| figure(&answer["position_sd_m"][axis]));
    let [inputs, clearances] =
        ["input_worst_m", "clearance_worst_m"].map(|key| figure(&answer[key]));
    let mut text = format!(
        "the tool scatters by {} in x and {} in y (standard deviation)",
        x?, y?
    );
    if let (Some(inputs), Some(clearances)) = (inputs, clearances) {
        text += &format!("; at worst the inputs add {inputs}, the clearances {clearances}");
    }
    Some(text)
}

/// Analyses the linkage or the robot of the file; its content shows which of them it is.
fn subject(args: &Args) -> Result<(Value, Page), Failure> {
    if DrivenLinkage::is_named(&args.file) {
        if args.at.is_some() || args.path.is_some() || args.map {
            let reason = "--at, --path and --map are for robots; a linkage is analysed over its \
                          sweep, and at one instant with --time";
            return Err(Failure::Usage(reason.into()));
        }
        let driven = DrivenLinkage::load(&args.file).map_err(refused)?;
        return linkage(args, &driven);
    }
    if args.time.is_some() {
        let reason = "--time is for linkages; for a robot give --at, --path or --map";
        return Err(Failure::Usage(reason.into()));
    }
    if args.at.is_none() && args.path.is_none() && !args.map {
        let reason = "give the positions to analyse: --at, --path or --map";
        return Err(Failure::Usage(reason.into()));
    }
    match Mechanism::load(&args.file).map_err(refused)? {
        Mechanism::FiveBar(robot) => study(args, &robot),
        Mechanism::Slider(robot) => {
            let Some(at) = args.at else {
                let reason = "a slider-driven mechanism takes only --at";
                return Err(Failure::Usage(reason.into()));
            };
            slider(args, &robot, at)
        }
    }
}

fn linkage(args: &Args, driven: &DrivenLinkage) -> Result<(Value, Page), Failure> {
    let sampling = sampling(args);
    let progress = ProgressBar::new(u64::from(args.samples));
    let time = args.time.unwrap_or(0.0);
    let study = study_linkage(driven, time, sampling, &advance(&progress)).map_err(refused)?;
    progress.finish_and_clear();
    Ok((linkage_answer(driven, &study), linkage_page(driven, &study)))
}

fn slider(args: &Args, robot: &SliderRobot, at: [f64; 2]) -> Result<(Value, Page), Failure> {
    let analysis = analyse_slider(robot, vector(at), vector(args.force)).map_err(refused)?;
    let progress = ProgressBar::new(2 * u64::from(args.samples));
    let sampled = sample_slider(
        &robot.toleranced(),
        &analysis,
        sampling(args),
        &advance(&progress),
    );
    progress.finish_and_clear();
    let answer = slider_answer(robot, &analysis, &sampled);
    Ok((answer, slider_page(robot, &analysis, &sampled)))
}

fn advance(bar: &ProgressBar) -> impl Fn(u64) + Sync + '_ {
    |count| bar.inc(count)
}

fn sampling(args: &Args) -> Sampling {
    Sampling {
        samples: args.samples as usize,
        seed: args.seed,
    }
}

fn vector([x, y]: [f64; 2]) -> Vector2<f64> {
    Vector2::new(x, y)
}

fn study(args: &Args, robot: &Robot) -> Result<(Value, Page), Failure> {
    let force = vector(args.force);
    if let Some(reason) = without_tolerance(robot).filter(|_| args.wanted.is_none()) {
        warn(format_args!("{}: {reason}", args.file));
    }
    if let Some(path) = &args.path {
        return along_path(args, robot, path, force);
    }
    match args.at {
        Some(at) => at_position(args, robot, at, force),
        None => over_region(args, robot, force),
    }
}

/// The study along the path of a job.
fn along_path(
    args: &Args,
    robot: &Robot,
    path: &Path,
    force: Vector2<f64>,
) -> Result<(Value, Page), Failure> {
    let shown = path.display();
    let in_file = |error: &dyn Display| refused(format_args!("{shown}: {error}"));
    let text = job::read(path).map_err(|error| in_file(&error))?;
    let job = match args.origin {
        Some(origin) => {
            let placement = Placement {
                origin,
                scale: args.scale,
                turn: 0.0,
                home: robot
                    .home_pose()
                    .map_or(origin, |pose| [pose.c.x, pose.c.y]),
            };
            Job::parse(&text, &placement).map_err(|error| in_file(&error))?
        }
        None => {
            let file = shown.to_string();
            let mut scenario = Scenario::new(&file, robot.clone(), &file, text);
            scenario.scale = args.scale;
            scenario.job().map_err(refused)?
        }
    };
    let along = path_accuracy(robot, &job, force).map_err(|error| in_file(&error))?;
    Ok((
        path_answer(&robot.name, &along),
        path_page(&robot.name, &along),
    ))
}

/// The study at one position of the tool.
fn at_position(
    args: &Args,
    robot: &Robot,
    at: [f64; 2],
    force: Vector2<f64>,
) -> Result<(Value, Page), Failure> {
    let state = ToolState {
        position: vector(at),
        velocity: vector(args.velocity),
        acceleration: vector(args.acceleration),
        force,
    };
    let analysis = analyse(robot, &state).map_err(refused)?;
    let sampling = sampling(args);
    let progress = ProgressBar::new(draws(&analysis, sampling));
    let sampled = monte_carlo(
        &robot.toleranced(),
        &state,
        &analysis,
        sampling,
        &advance(&progress),
    );
    progress.finish_and_clear();
    let page = at_page(&robot.name, &analysis, &sampled);
    Ok((answer(&robot.name, &state, &analysis, &sampled), page))
}

/// The study over a region, with the cheapest tolerances if a deviation is wanted.
fn over_region(args: &Args, robot: &Robot, force: Vector2<f64>) -> Result<(Value, Page), Failure> {
    let map = accuracy_map(robot, force, args.region).map_err(refused)?;
    let mut answer = map_answer(&robot.name, &map);
    let mut page = map_page(robot, &map);
    if let (Some(wanted), Some(path)) = (args.wanted, &args.classes) {
        let classes = Classes::read(path).map_err(refused)?;
        let cheapest = cheapest(&map, wanted, &classes).map_err(refused)?;
        page.heading("The cheapest tolerances");
        let rows = cheapest.names.iter();
        let rows: Vec<_> = rows.map(|(d, c)| vec![(*d).into(), c.clone()]).collect();
        page.table(&["dimension", "class"], &rows);
        page.paragraph(&format!(
            "Their total cost is {}; the greatest radial standard deviation is {}.",
            cheapest.allocation.cost,
            quantity(cheapest.allocation.worst_variance.sqrt(), "m")
        ));
        answer["allocation"] = allocation_answer(&cheapest);
    }
    Ok((answer, page))
}
