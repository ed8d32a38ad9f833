//! The strokes that the tool's output draws against the strokes that a job asks for.

use fivebar_files::job::{Action, Job};
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::controller::Request;
use fivebar_firmware::safety::State;
use fivebar_firmware::{ActuatorCommand, Move, SensorSample, Settings, Status};
use fivebar_sim::link::{InProcess, Target, TargetError};
use fivebar_sim::simulation::Simulate;
use nalgebra::Vector2;
use std::path::Path;

type V = Vector2<f64>;

const SERVO: &str = "
[tool_output]
kind = \"servo\"
up_width = 1e-3
down_width = 2e-3
down_time = 0.03
up_time = 0.02
";

/// Distance between the points of a stroke [m].
const STEP: f64 = 50e-6;
/// Greatest distance of a drawn point from its stroke [m]: the corner tolerance of 50 µm, and what the arm
/// and its encoders are off.
const TOLERANCE: f64 = 50e-6 + 40e-6;
/// Greatest distance of a stroke's ends [m].
const ENDS: f64 = 40e-6;

/// A controller in this process, and what it did in each tick.
struct Recorded {
    target: InProcess,
    /// The tool by the encoders [m], where it should be, and whether it is down.
    ticks: Vec<(V, V, bool)>,
    /// The tag of the move in each of these ticks.
    tags: Vec<Option<u32>>,
    /// The tag of the next move.
    tag: u32,
    /// The tags of the moves with which the tool comes down or lifts, and whether it is down then.
    changes: Vec<(u32, bool)>,
    up: u16,
}

impl Recorded {
    fn new(settings: &Settings) -> Self {
        Self {
            target: InProcess::new(settings).expect("valid settings"),
            ticks: Vec::new(),
            tags: Vec::new(),
            tag: 1,
            changes: Vec::new(),
            up: settings.tool_output.off(),
        }
    }

    /// The output changes `lag` ticks behind the tick in which the reference comes to the move that
    /// changes it, give or take one tick.
    fn assert_changes_in_their_ticks(&self, path: &str, lag: usize) {
        let output = self.ticks.windows(2).enumerate();
        let mut output = output
            .filter(|(_, pair)| pair[0].2 != pair[1].2)
            .map(|(tick, _)| tick + 1);
        let mut from = 0;
        for &(tag, down) in &self.changes {
            let begun = self.tags.iter().skip(from).position(|&at| at == Some(tag));
            from += begun.expect("each move is begun");
            let changed = output.next().expect("a change of the output");
            assert_eq!(self.ticks[changed].2, down, "{path}: move {tag}");
            assert!(
                changed.abs_diff(from + lag) <= 1,
                "{path}: move {tag} begins in tick {from}, the output changes in {changed}"
            );
        }
        assert_eq!(output.next(), None, "{path}: a change without a move");
    }
}

impl Target for Recorded {
    fn tick(&mut self, sample: &SensorSample) -> Result<(ActuatorCommand, Status), TargetError> {
        let (command, status) = self.target.tick(sample)?;
        let point = |[x, y]: [f32; 2]| V::new(f64::from(x), f64::from(y));
        if let (Some(tool), Some(reference)) = (status.tool, status.reference) {
            let down = command.tool != self.up;
            self.ticks.push((point(tool), point(reference), down));
            // A path that has not begun shows its first move already.
            self.tags
                .push(status.tag.filter(|_| status.state == State::Running));
        }
        Ok((command, status))
    }

    fn request(&mut self, request: Request) -> Result<(), TargetError> {
        self.target.request(request)
    }

    fn offer(&mut self, next: &Move) -> Result<bool, TargetError> {
        // Tags of their own: several moves of a job may have one.
        let next = Move {
            tag: self.tag,
            ..*next
        };
        let is_taken = self.target.offer(&next)?;
        self.tag += u32::from(is_taken);
        let was_down = self.changes.last().is_some_and(|&(_, down)| down);
        let down = next.tool > 0;
        if is_taken && down != was_down {
            self.changes.push((next.tag, down));
        }
        Ok(is_taken)
    }

    fn is_idle(&self) -> bool {
        self.target.is_idle()
    }
}

/// The points of each stroke of a job, `STEP` apart.
fn asked(job: &Job, home: V) -> Vec<Vec<V>> {
    let mut strokes: Vec<Vec<V>> = Vec::new();
    let (mut at, mut was_down) = (home, false);
    for step in &job.steps {
        let from = at;
        let mut points = Vec::new();
        match step.action {
            Action::Dwell { .. } | Action::ChangeMode(_) | Action::Cross { .. } => {}
            Action::Line { to, .. } => {
                at = V::new(to[0], to[1]);
                let count = ((at - from).norm() / STEP).ceil().max(1.0);
                points.extend((1..=count as u32).map(|n| from.lerp(&at, f64::from(n) / count)));
            }
            Action::Arc {
                to,
                center,
                clockwise,
                ..
            } => {
                at = V::new(to[0], to[1]);
                let center = V::new(center[0], center[1]);
                let [r0, r1] = [from - center, at - center];
                let mut turn = r0.perp(&r1).atan2(r0.dot(&r1));
                let full = std::f64::consts::TAU;
                if clockwise && turn >= 0.0 {
                    turn -= full;
                } else if !clockwise && turn <= 0.0 {
                    turn += full;
                }
                let count = (turn.abs() * r0.norm() / STEP).ceil().max(1.0);
                points.extend((1..=count as u32).map(|n| {
                    let angle = turn * f64::from(n) / count;
                    center + nalgebra::Rotation2::new(angle) * r0
                }));
            }
        }
        let down = step.tool > 0.0;
        if down && !was_down {
            strokes.push(vec![from]);
        }
        if let (true, Some(stroke)) = (down, strokes.last_mut()) {
            stroke.extend(points);
        }
        was_down = down;
    }
    strokes
}

/// The distance of a point from a stroke near `place`, and the place found. A stroke that comes back
/// beside itself is followed along, not across: only a little of the way ahead counts.
fn distance(stroke: &[V], place: usize, point: V) -> (f64, usize) {
    let from = place.saturating_sub(40);
    let near = stroke.iter().enumerate().skip(from).take(56);
    near.map(|(index, at)| ((at.x - point.x).hypot(at.y - point.y), index))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .expect("a stroke has points")
}

fn draws_what_is_asked(path: &str) {
    let text = BuiltIn::find(BuiltIn::DEFAULT).expect("the default").text;
    let robot = Robot::parse("servo.toml", &format!("{text}{SERVO}")).expect("a valid robot");
    let scenario = Scenario::of_job(path, robot).expect("a job");
    let job = scenario.job().expect("a valid job");
    let settings = scenario.robot.settings().expect("masses");
    let mut target = Recorded::new(&settings);
    let (_, record) = scenario
        .run_on(&mut target, &scenario.moves(&job).unwrap(), &mut |_| ())
        .expect("a run");
    assert_eq!(record.faults, []);
    let lag = settings.control.tick_rate / settings.control.current_bandwidth;
    target.assert_changes_in_their_ticks(path, lag.round() as usize);
    let home = target.ticks[0].1;
    let asked = asked(&job, home);
    let drawn: Vec<&[(V, V, bool)]> = target
        .ticks
        .chunk_by(|a, b| a.2 == b.2)
        .filter(|chunk| chunk[0].2)
        .collect();
    assert_eq!(drawn.len(), asked.len(), "{path}: strokes");
    assert!(!asked.is_empty());
    let mut farthest = 0.0_f64;
    for (drawn, asked) in drawn.iter().zip(&asked) {
        let ends = [
            (drawn[0], asked[0]),
            (drawn[drawn.len() - 1], asked[asked.len() - 1]),
        ];
        for ((tool, reference, _), end) in ends {
            assert!((reference - end).norm() < 1e-6, "{path}: {reference} {end}");
            assert!((tool - end).norm() < ENDS, "{path}: {tool} {end}");
        }
        let mut place = 0;
        let mut reached = vec![false; asked.len()];
        for &(tool, ..) in *drawn {
            let (off, found) = distance(asked, place, tool);
            place = found.max(place);
            reached[found] = true;
            farthest = farthest.max(off);
        }
        let missing = (asked[place] - asked[asked.len() - 1]).norm();
        assert!(missing <= STEP, "{path}: {missing} m of the stroke's end");
        // Points are passed at most 30 µm a tick; round corners may leave some out.
        let gap = reached
            .chunk_by(|a, b| a == b)
            .filter(|chunk| !chunk[0])
            .map(<[bool]>::len)
            .max();
        assert!(gap.unwrap_or(0) <= 8, "{path}: {gap:?} points left out");
    }
    // Half a step is the distance between points.
    let allowed = TOLERANCE + 0.5 * STEP;
    println!("{path}: {} strokes, {farthest:.2e} m", asked.len());
    assert!(farthest <= allowed, "{path}: {farthest} m off");
}

fn built_in(name: &str) -> String {
    format!(
        "{}/../sim-harness/jobs/{name}.gcode",
        env!("CARGO_MANIFEST_DIR")
    )
}

#[test]
fn the_demonstration_is_drawn_as_asked() {
    draws_what_is_asked(&built_in("fivebar"));
}

#[test]
fn jobs_with_corners_and_curves_are_drawn_as_asked() {
    draws_what_is_asked(&built_in("gear"));
    draws_what_is_asked(&built_in("petal"));
}

/// Short strokes, a dot, strokes that meet, a full circle, and a tool left down at the end.
#[test]
fn short_strokes_and_dots_are_drawn_as_asked() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("strokes.gcode");
    let mut text = String::from("G21 G90 F3000\n");
    for n in 0..8 {
        let (x, y) = (4 * n, 3 * (n % 3));
        text += &format!("G0 X{x} Y{y}\nM3\nG1 X{}\nM5\n", f64::from(x) + 0.4);
    }
    text += "G0 X10 Y15\nM3\nG4 P0.05\nM5\nG0 X15\nM3\nG1 X20 Y20\nM5\nM3\nG1 X25 Y15\nM5\n";
    text += "G0 X30 Y10\nM3\nG2 I-4 J0\nM5\nG0 X5 Y12\nM3\nG1 X8 Y14\n";
    std::fs::write(&path, text).expect("written");
    draws_what_is_asked(path.to_str().expect("text"));
}

/// The jobs of a folder, without the files that say what is expected of them, and without those that are refused.
fn jobs_of(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut jobs: Vec<String> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|ending| ending != "strokes"))
        .filter(|path| !path.with_extension("refused").exists())
        .map(|path| path.to_str().expect("text").to_owned())
        .collect();
    jobs.sort();
    jobs
}

fn corpus() -> Vec<String> {
    let corpus = concat!(env!("CARGO_MANIFEST_DIR"), "/../host/files/tests/corpus");
    let jobs = jobs_of(Path::new(corpus));
    assert!(jobs.len() >= 40, "{jobs:?}");
    jobs
}

/// The shortest file with each ending.
#[test]
fn a_file_of_each_kind_is_drawn_as_asked() {
    let mut jobs: Vec<(String, u64, String)> = corpus()
        .into_iter()
        .map(|job| {
            let ending = Path::new(&job).extension().expect("an ending");
            let ending = ending.to_str().expect("text").to_owned();
            let length = std::fs::metadata(&job).expect("a file").len();
            (ending, length, job)
        })
        .collect();
    jobs.sort();
    jobs.dedup_by(|later, kept| later.0 == kept.0);
    assert!(jobs.len() >= 8, "{jobs:?}");
    for (_, _, job) in &jobs {
        draws_what_is_asked(job);
    }
}

#[test]
#[ignore = "half a minute: ./ci.sh tables"]
fn whole_table_of_files_of_common_programs_that_are_drawn_as_asked() {
    let jobs = corpus();
    std::thread::scope(|scope| {
        for job in &jobs {
            scope.spawn(|| draws_what_is_asked(job));
        }
    });
}

/// Further jobs: FIVEBAR_JOBS=FOLDER cargo test … further_jobs
#[test]
fn further_jobs_of_a_named_folder_are_drawn_as_asked() {
    let Some(folder) = std::env::var_os("FIVEBAR_JOBS") else {
        return;
    };
    for job in jobs_of(Path::new(&folder)) {
        draws_what_is_asked(&job);
    }
}
