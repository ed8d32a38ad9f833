//! Hostile files of some two hundred kinds: each is read or refused in a process of its own, which measures its memory
//! and its time of the processor. Large files of people among them are read.
#![cfg(target_os = "linux")]

mod committed;
mod drawings;
mod gcode;
mod large;
mod pictures;
mod settings;
mod svg;
mod tables;

use fivebar_files::job::{Job, JobOptions, Placement, Trace};
use fivebar_files::linkage::DrivenLinkage;
use fivebar_files::measurements::parse_columns;
use fivebar_files::path_case::PathCase;
use fivebar_files::picture::parse_picture;
use fivebar_files::robot::Robot;
use fivebar_files::{design_spec, mobility};
use nix::sys::resource::{UsageWho, getrusage};
use std::fmt::Display;
use std::io::{self, Read};
use std::path::Path;
use std::process::Command;

/// Names the kind that a process is to read.
const KIND: &str = "HOSTILE_KIND";
/// Says by how much a process divides the numbers of repeated parts.
const DIVISOR: &str = "HOSTILE_DIVISOR";
/// What a process writes before its measurements.
const MEASURED: &str = "measured:";
/// Most memory [MiB].
const MEMORY: f64 = 1024.0;
/// Most time of the processor [s].
const SECONDS: f64 = 5.0;

/// A file.
pub(crate) enum Input {
    Job(String),
    /// A drawing whose areas are filled with lines this far apart [m].
    Hatched(String, f64),
    Table(String),
    /// A table: how it begins, and a part of it so often.
    Stream(String, String, usize),
    Picture(Vec<u8>),
    /// A picture that becomes a job, and how.
    Traced(Vec<u8>, Trace),
    Robot(String),
    Design(String),
    Linkage(String),
    Mechanisms(String),
    Path(String),
}

/// A kind of file: its name, and what makes one.
pub(crate) type Kind = (String, Box<dyn Fn() -> Input>);

pub(crate) fn kind(name: impl Into<String>, text: impl Fn() -> String + 'static) -> Kind {
    (name.into(), Box::new(move || Input::Job(text())))
}

/// How often a part is repeated that a whole file has `count` times.
pub(crate) fn counted(count: usize) -> usize {
    let divisor = std::env::var(DIVISOR).ok();
    let divisor = divisor.and_then(|text| text.parse().ok()).unwrap_or(1);
    count.div_ceil(divisor)
}

/// All kinds. A large file has the number that its outcome begins with, at least.
fn kinds() -> Vec<(Kind, Option<usize>)> {
    let all = [
        gcode::kinds(),
        drawings::dxf(),
        drawings::hpgl(),
        svg::kinds(),
        tables::kinds(),
        settings::kinds(),
        pictures::kinds(),
    ];
    let hostile = all.into_iter().flatten().map(|kind| (kind, None));
    let large = large::kinds().into_iter();
    hostile
        .chain(large.map(|(kind, least)| (kind, Some(least))))
        .collect()
}

/// The sentence of a refusal, or how much was read.
fn outcome(input: Input) -> String {
    match input {
        Input::Job(text) => job(&text, JobOptions::default()),
        Input::Hatched(text, distance) => job(
            &text,
            JobOptions {
                hatch: Some(distance),
                ..JobOptions::default()
            },
        ),
        Input::Traced(bytes, trace) => traced(&bytes, trace),
        Input::Table(text) => rows(text.as_bytes()),
        Input::Stream(begin, part, count) => rows(stream(begin, part, count)),
        Input::Picture(bytes) => said(parse_picture("picture", &bytes), |picture| {
            format!("{} pixels", picture.size().into_iter().product::<usize>())
        }),
        Input::Robot(text) => said(Robot::parse("robot", &text), |_| "1 robot".into()),
        Input::Design(text) => said(design_spec::parse("design", &text, Path::new(".")), |_| {
            "1 design".into()
        }),
        Input::Linkage(text) => said(DrivenLinkage::parse("linkage", &text), |_| {
            "1 linkage".into()
        }),
        Input::Mechanisms(text) => said(mobility::parse("cases.json", &text), |cases| {
            format!("{} mechanisms", cases.len())
        }),
        Input::Path(text) => said(PathCase::parse("path", &text), |_| "1 path".into()),
    }
}

fn said<T, E: Display>(result: Result<T, E>, read: impl FnOnce(T) -> String) -> String {
    match result {
        Ok(value) => read(value),
        Err(error) => error.to_string(),
    }
}

/// The picture goes through a file, as it does in the program.
fn traced(bytes: &[u8], trace: Trace) -> String {
    let file = tempfile::NamedTempFile::new().expect("a file");
    std::fs::write(file.path(), bytes).expect("a file");
    let options = JobOptions {
        trace: Some(trace),
        ..JobOptions::default()
    };
    said(fivebar_files::job::read(file.path()), |text| {
        job(&text, options)
    })
}

fn job(text: &str, options: JobOptions) -> String {
    let placement = Placement {
        origin: [0.0, 0.13],
        scale: 1.0,
        turn: 0.0,
        home: [0.04, 0.18],
    };
    said(Job::parse_with(text, &placement, &options), |job| {
        format!("{} steps", job.steps.len())
    })
}

fn rows(stream: impl Read) -> String {
    said(parse_columns("table", stream, ["x", "y"]), |rows| {
        format!("{} rows", rows.len())
    })
}

/// Text that no memory holds: its begin, and a part so often.
fn stream(begin: String, part: String, count: usize) -> impl Read {
    let length = (count * part.len()) as u64;
    io::Cursor::new(begin).chain(Again { part, at: 0 }.take(length))
}

/// A part again and again.
struct Again {
    part: String,
    at: usize,
}

impl Read for Again {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut filled = 0;
        while filled < buffer.len() {
            let rest = &self.part.as_bytes()[self.at..];
            let count = rest.len().min(buffer.len() - filled);
            buffer[filled..filled + count].copy_from_slice(&rest[..count]);
            self.at = (self.at + count) % self.part.len();
            filled += count;
        }
        Ok(filled)
    }
}

/// What a process measured while it read a kind of file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measurement {
    pub(crate) kind: String,
    /// Time of the processor [s].
    pub(crate) seconds: f64,
    /// Peak memory [MiB].
    pub(crate) mebibytes: f64,
    pub(crate) outcome: String,
}

/// In the process that [`measured`] starts; else it has nothing to read.
#[test]
fn one_kind_is_read_or_refused() {
    let Ok(name) = std::env::var(KIND) else {
        return;
    };
    let ((_, make), _) = kinds()
        .into_iter()
        .find(|((kind, _), _)| *kind == name)
        .expect("a kind");
    let sentence = outcome(make());
    let usage = getrusage(UsageWho::RUSAGE_SELF).expect("a measurement");
    let seconds = [usage.user_time(), usage.system_time()]
        .map(|time| time.tv_sec() as f64 + 1e-6 * time.tv_usec() as f64);
    let mebibytes = usage.max_rss() as f64 / 1024.0;
    let short: String = sentence.replace('\n', " ").chars().take(150).collect();
    println!(
        "\n{MEASURED}{:.2};{mebibytes:.0};{short}",
        seconds[0] + seconds[1]
    );
}

/// Reads a file of a kind in a process of its own.
fn measured(name: &str, divisor: usize) -> Result<Measurement, String> {
    let program = std::env::current_exe().expect("this program");
    let output = Command::new(program)
        .args(["--exact", "one_kind_is_read_or_refused", "--nocapture"])
        .env(KIND, name)
        .env(DIVISOR, divisor.to_string())
        .output()
        .expect("a process");
    let text = String::from_utf8_lossy(&output.stdout);
    let measured = text.lines().find_map(|line| line.strip_prefix(MEASURED));
    let measured = measured.filter(|_| output.status.success());
    let measured = measured.ok_or_else(|| format!("{name}: {}", output.status))?;
    println!("{name}: {measured}");
    let mut parts = measured.splitn(3, ';');
    let mut number = || parts.next()?.parse().ok();
    let [seconds, mebibytes] = [number(), number()].map(|it| it.expect("a number"));
    Ok(Measurement {
        kind: name.into(),
        seconds,
        mebibytes,
        outcome: parts.next().unwrap_or_default().into(),
    })
}

/// What is wrong with a measurement.
pub(crate) fn why_wrong(measurement: &Measurement, least: Option<usize>) -> Option<String> {
    let Measurement {
        kind,
        seconds,
        mebibytes,
        outcome,
    } = measurement;
    let number = outcome.split(' ').next().and_then(|it| it.parse().ok());
    let is_refused = least.is_some_and(|least| number.is_none_or(|number: usize| number < least));
    let is_wrong = *seconds > SECONDS || *mebibytes > MEMORY || outcome.is_empty() || is_refused;
    is_wrong
        .then(|| format!("{kind}: {seconds} s, {mebibytes} MiB, {outcome} (at least {least:?})"))
}

/// Kinds that took more than the bounds before they were counted.
const ONCE_TOO_LONG: [&str; 4] = [
    "svg: arcs of a path",
    "dxf: a spline of high degree and many knots",
    "table: rows without end",
    "table: a text of lines without end",
];

/// One hostile kind in twelve, those that took too long once, and each large file. The libraries of the readers are not
/// optimised where `cargo test` runs, and take several times as long: what is repeated is a tenth.
#[test]
fn hostile_files_take_little_memory_and_time_and_large_ones_are_read() {
    let mut wrong = Vec::new();
    for (index, ((name, _), least)) in kinds().into_iter().enumerate() {
        let once_too_long = ONCE_TOO_LONG.contains(&name.as_str());
        if index % 12 != 0 && least.is_none() && !once_too_long {
            continue;
        }
        match measured(&name, 10) {
            Ok(measurement) => wrong.extend(why_wrong(&measurement, least.map(|it| it / 10))),
            Err(error) => wrong.push(error),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
