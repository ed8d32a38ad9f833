//! Files as common programs write them, each with its strokes as read from it by hand.
//!
//! A line of NAME.strokes is a stroke: the tool's level, then its points in millimetres; `cw:` and
//! `ccw:` are arcs with their centre and their end. Lines with `note:` are the notes on the job,
//! lines with `#` are comments.

use fivebar_files::job::{self, Action, Job, Placement};
use std::path::Path;

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

#[test]
fn files_of_common_programs_give_the_strokes_that_they_draw() {
    let placement = Placement {
        origin: [0.0, 0.0],
        scale: 1.0,
        turn: 0.0,
        home: [0.05, 0.2],
    };
    let mut files = 0;
    for entry in std::fs::read_dir(FOLDER).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "strokes") {
            continue;
        }
        let name = path.file_name().unwrap().to_str().unwrap();
        let text = std::fs::read_to_string(path.with_extension("strokes")).unwrap();
        let read = job::read(Path::new(&path)).unwrap();
        let job = Job::parse(&read, &placement).unwrap_or_else(|error| panic!("{name}: {error}"));
        compare(name, &strokes(&job), &expected(&text));
        let notes: Vec<&str> = text
            .lines()
            .filter_map(|line| line.strip_prefix("note: "))
            .collect();
        let told: Vec<String> = job.warnings.iter().map(ToString::to_string).collect();
        assert_eq!(told, notes, "{name}");
        files += 1;
    }
    assert!(files >= 20, "{files} files");
}
