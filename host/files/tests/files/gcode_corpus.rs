//! Files as common programs write them, each with its strokes as read from it by hand.
//!
//! A line of NAME.strokes is a stroke: the tool's level, then its points in millimetres; `cw:` and
//! `ccw:` are arcs with their centre and their end. Lines with `note:` are the notes on the job,
//! lines with `#` say what the file is. NAME.refused has the message of a file that is no job.

use crate::document::keep;
use fivebar_files::job::{self, Action, Job, Placement};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/corpus");

/// The tool's position and, for an arc, the centre and the sense of rotation [mm].
#[derive(Clone, Debug)]
struct Point {
    at: [f64; 2],
    arc: Option<([f64; 2], bool)>,
}

type Stroke = (f64, Vec<Point>);

fn expected(text: &str) -> Vec<Stroke> {
    let pair = |text: &str| {
        let (x, y) = text.split_once(',').unwrap();
        [x.parse().unwrap(), y.parse().unwrap()]
    };
    let point = |text: &str| match text.split(':').collect::<Vec<_>>()[..] {
        [at] => Point {
            at: pair(at),
            arc: None,
        },
        [sense, center, at] => Point {
            at: pair(at),
            arc: Some((pair(center), sense == "cw")),
        },
        _ => panic!("{text}"),
    };
    let strokes = text.lines();
    let strokes = strokes.filter(|line| !line.starts_with(['#', 'n']) && !line.is_empty());
    strokes
        .map(|line| {
            let mut words = line.split_whitespace();
            let level = words.next().unwrap().parse().unwrap();
            (level, words.map(point).collect())
        })
        .collect()
}

/// The strokes of a job: motions at one level, without a break.
fn strokes(job: &Job) -> Vec<Stroke> {
    let mm = |point: [f64; 2]| point.map(|metres| 1e3 * metres);
    let mut strokes: Vec<Stroke> = Vec::new();
    let (mut at, mut level_before) = ([f64::NAN; 2], 0.0);
    for step in &job.steps {
        let Some(end) = step.action.end() else {
            continue;
        };
        if step.tool > 0.0 {
            if step.tool != level_before {
                strokes.push((step.tool, vec![Point { at, arc: None }]));
            }
            let arc = match step.action {
                Action::Arc {
                    center, clockwise, ..
                } => Some((mm(center), clockwise)),
                _ => None,
            };
            let (_, points) = strokes.last_mut().unwrap();
            points.push(Point { at: mm(end), arc });
        }
        (at, level_before) = (mm(end), step.tool);
    }
    strokes
}

#[track_caller]
fn assert_near(a: [f64; 2], b: [f64; 2], what: &str, tolerance: f64) {
    let distance = (a[0] - b[0]).hypot(a[1] - b[1]);
    assert!(distance < tolerance, "{what}: {a:?} mm, not {b:?} mm");
}

fn compare(name: &str, found: &[Stroke], expected: &[Stroke]) {
    assert_eq!(found.len(), expected.len(), "{name}: {found:?}");
    // usvg has single precision.
    let tolerance = if name.contains(".svg") { 1e-5 } else { 1e-6 }; // mm
    for (number, (found, expected)) in found.iter().zip(expected).enumerate() {
        let what = format!("{name}, stroke {}", number + 1);
        assert!((found.0 - expected.0).abs() < 1e-12, "{what}: {found:?}");
        assert_eq!(found.1.len(), expected.1.len(), "{what}: {found:?}");
        for (found, expected) in found.1.iter().zip(&expected.1) {
            assert_near(found.at, expected.at, &what, tolerance);
            match (found.arc, expected.arc) {
                (None, None) => {}
                (Some((center, clockwise)), Some((expected, sense))) => {
                    assert_near(center, expected, &what, tolerance);
                    assert_eq!(clockwise, sense, "{what}");
                }
                other => panic!("{what}: {other:?}"),
            }
        }
    }
}

/// The files of the folder, in the order of their names, each with its text of this ending.
fn files(ending: &str) -> Vec<(String, PathBuf, String)> {
    let entries = std::fs::read_dir(FOLDER).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let files = paths.filter_map(|path| {
        let name = path.file_name()?.to_str()?.to_owned();
        let is_text = ENDINGS.iter().any(|ending| name.ends_with(ending));
        let text = std::fs::read_to_string(path.with_extension(ending)).ok()?;
        (!is_text).then_some((name, path, text))
    });
    let mut files: Vec<_> = files.collect();
    files.sort();
    files
}

const ENDINGS: [&str; 2] = [".strokes", ".refused"];

fn parsed(path: &Path) -> Result<Job, String> {
    let placement = Placement {
        origin: [0.0, 0.0],
        scale: 1.0,
        turn: 0.0,
        home: [0.05, 0.2],
    };
    let text = job::read(path).map_err(|error| error.to_string())?;
    Job::parse(&text, &placement).map_err(|error| error.to_string())
}

/// The notes of a .strokes file.
fn notes(text: &str) -> Vec<&str> {
    text.lines()
        .filter_map(|line| line.strip_prefix("note: "))
        .collect()
}

/// What a file is: its comment.
fn described(text: &str) -> String {
    let lines = text.lines();
    let comment: Vec<&str> = lines.filter_map(|line| line.strip_prefix("# ")).collect();
    comment.join(" ")
}

#[test]
fn files_of_common_programs_give_the_strokes_that_they_draw() {
    let files = files("strokes");
    for (name, path, text) in &files {
        let job = parsed(path).unwrap_or_else(|error| panic!("{name}: {error}"));
        let strokes = strokes(&job);
        // The pen touches the paper.
        assert!(strokes.iter().any(|(level, _)| *level > 0.0), "{name}");
        compare(name, &strokes, &expected(text));
        let told: Vec<String> = job.warnings.iter().map(ToString::to_string).collect();
        assert_eq!(told, notes(text), "{name}");
    }
    assert!(files.len() >= 40, "{} files", files.len());
}

#[test]
fn files_that_are_no_jobs_are_refused_with_the_remedy() {
    for (name, path, text) in files("refused") {
        let told = parsed(&path).expect_err(&name);
        let wanted: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
        assert_eq!(told, wanted.join(" "), "{name}");
    }
}

const TABLE: &str = include_str!("../../../../docs/verify/data/programs.csv");

/// The table of the files: a row for each.
fn table() -> String {
    let mut rows = csv::Writer::from_writer(Vec::new());
    let mut write = |cells: [&str; 3]| rows.write_record(cells).expect("a row");
    write(["file", "what it is", "read as"]);
    for (name, _, text) in files("strokes") {
        let count = expected(&text).len();
        let notes = match notes(&text).len() {
            0 => String::new(),
            1 => ", 1 note".into(),
            notes => format!(", {notes} notes"),
        };
        let strokes = if count == 1 { "stroke" } else { "strokes" };
        let read = format!("{count} {strokes}{notes}");
        write([&name, &described(&text), &read]);
    }
    for (name, _, text) in files("refused") {
        let told: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
        let read = format!("refused: {}", told.join(" "));
        write([&name, &described(&text), &read]);
    }
    String::from_utf8(rows.into_inner().expect("memory")).expect("UTF-8")
}

#[test]
fn the_documents_have_the_table_of_the_files() {
    keep("verify/data/programs.csv", TABLE, &table());
}

/// What `scripts/many_programs.sh` found, beside independent readers.
#[test]
fn no_file_of_another_program_is_drawn_otherwise_without_a_word() {
    let table = include_str!("../../../../docs/verify/data/files_of_programs.csv");
    let mut programs = BTreeSet::new();
    let (mut drawn, mut refused, mut noted) = (0, 0, 0);
    for row in csv::Reader::from_reader(table.as_bytes()).records() {
        let row = row.unwrap();
        let [program, file, verdict, far, said] = [0, 1, 2, 5, 6].map(|column| &row[column]);
        let is_near = far.parse().is_ok_and(|far: f64| far <= 0.05);
        match verdict {
            "drawn" => drawn += usize::from(is_near),
            "refused" => refused += usize::from(!said.is_empty()),
            "noted" => noted += usize::from(said.contains("left out")),
            other => panic!("{file}: {other}"),
        }
        programs.insert(program.to_owned());
    }
    let (files, programs) = (drawn + refused + noted, programs.len());
    let rows = table.lines().count() - 1;
    assert_eq!(files, rows, "each row is what its verdict says");
    let sentence = format!(
        "{files} files that {programs} programs made (`scripts/many_programs.sh`): {drawn} are drawn within 0.05 mm of \
         independent readers, {refused} refused, {noted} noted"
    );
    let document = include_str!("../../../../docs/use/programs.md");
    let document = document.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(document.contains(&sentence), "{sentence}");
}
