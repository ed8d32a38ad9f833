//! The command `fivebar photo`: marks, maps, measurements for `calibrate`, refusals.

use fivebar_design::photo::MARK_STEP;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_kinematics::five_bar::{Geometry, Pose, Tool};
use fivebar_report::study::photo::strokes;
use fivebar_testkit::program;
use fivebar_testkit::{Camera, Paper, circle};
use nalgebra::{Matrix3, Rotation2, Vector2, Vector3};
use serde_json::Value;
use std::path::Path;
use std::process::Output;

fn photo(folder: &Path, args: &[&str]) -> Output {
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
    command.current_dir(folder).arg("photo").args(args);
    command.output().unwrap()
}

fn answer(folder: &Path, args: &[&str]) -> Value {
    let output = photo(folder, &[args, &["--json"]].concat());
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    serde_json::from_slice(&output.stdout).unwrap()
}

#[track_caller]
fn refused(folder: &Path, args: &[&str], wanted: &str) {
    let output = photo(folder, args);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains(wanted), "{message}");
}

/// The demonstration as the arm of the measurements in host/files drew it, and its photograph.
const JOB: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/jobs/fivebar.gcode");
const SAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/photos/fivebar.png");
const DOCUMENT: &str = include_str!("../../../../docs/use/photo.md");

/// That arm: the lengths [m] and the zeros of its joints [rad], of set 2 in `calibration_public.json`.
const LENGTHS: [f64; 5] = [
    0.100_056_716,
    0.159_843_175,
    0.159_876_081,
    0.099_267_560,
    0.080_539_912,
];
const ZEROS: [f64; 2] = [0.022_883_317, -0.006_508_457];

/// That arm under a controller that takes it for the benchtop arm.
struct Arm {
    believed: Tool<f64>,
    real: Tool<f64>,
    home: Pose<f64>,
}

impl Arm {
    fn new() -> Self {
        let robot = Robot::load("benchtop").unwrap();
        let real = Geometry::new(LENGTHS).unwrap();
        Self {
            believed: robot.tool_on_link().unwrap(),
            real: Tool::new(real, Vector2::zeros()).unwrap(),
            home: robot.home_pose().unwrap(),
        }
    }

    /// Where it draws a point that the controller asks for [m].
    fn drawn(&self, point: Vector2<f64>) -> Vector2<f64> {
        let mode = self.home.working_mode();
        let [theta1, _, _, theta4] = self.believed.inverse(point, mode).unwrap().angles();
        let geometry = self.real.geometry();
        let angles = [theta1 + ZEROS[0], theta4 + ZEROS[1]];
        let pose = geometry.forward(angles[0], angles[1], self.home.assembly());
        self.real.point(&pose.unwrap())
    }
}

/// The marks of the demonstration [m], written to marks.gcode.
fn marks(folder: &Path) -> Vec<[f64; 2]> {
    let marks = answer(
        folder,
        &[JOB, "--robot", "benchtop", "--draw-marks", "marks.gcode"],
    );
    serde_json::from_value(marks["marks_m"].clone()).unwrap()
}

/// The strokes of the demonstration as that arm draws them [m].
fn drawn_strokes(arm: &Arm) -> Vec<Vec<[f64; 2]>> {
    let robot = Robot::load("benchtop").unwrap();
    let text = std::fs::read_to_string(JOB).unwrap();
    let scenario = Scenario::new("", robot, "", text);
    let job = strokes(&scenario.job().unwrap(), [0.0; 2]);
    let fine = |stroke: &Vec<Vector2<f64>>| {
        let ends = stroke
            .windows(2)
            .flat_map(|ends| (0..=20).map(|part| ends[0].lerp(&ends[1], f64::from(part) / 20.0)));
        ends.map(|point| arm.drawn(point).into())
            .collect::<Vec<_>>()
    };
    job.points.iter().map(fine).collect()
}

/// The photograph: the demonstration and its marks as that arm draws them.
fn sample(marks: &[[f64; 2]]) -> (Camera, Vec<u8>) {
    let arm = Arm::new();
    let mut strokes = drawn_strokes(&arm);
    for (index, mark) in marks.iter().enumerate() {
        let circles = if index == 0 { 3 } else { 2 };
        for n in 1..=circles {
            let points = circle(*mark, MARK_STEP * f64::from(n)).into_iter();
            strokes.push(points.map(|point| arm.drawn(point.into()).into()).collect());
        }
    }
    let middle = marks.iter().map(|mark| arm.drawn((*mark).into()));
    let camera = Camera {
        size: [1600, 1200],
        target: (0.25 * middle.sum::<Vector2<f64>>()).into(),
        distance: 0.4,
        turns: [0.2, 0.1, 0.05],
        focal: 3300.0,
        lens: -0.03,
        blur: 0.8,
        noise: 0.0,
    };
    let picture = camera.picture(&Paper {
        strokes,
        pen: 0.5e-3,
        greys: [50.0, 240.0, 240.0],
    });
    (camera, picture)
}

fn write_png(path: &Path, [width, height]: [usize; 2], grey: &[u8]) {
    let file = std::fs::File::create(path).unwrap();
    let mut encoder = png::Encoder::new(file, width as u32, height as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(grey).unwrap();
}

#[test]
fn the_sample_is_what_the_camera_takes() {
    let folder = tempfile::tempdir().unwrap();
    let (camera, picture) = sample(&marks(folder.path()));
    if std::env::var_os("FIVEBAR_UPDATE").is_some() {
        write_png(Path::new(SAMPLE), camera.size, &picture);
    }
    let decoder = png::Decoder::new(std::io::BufReader::new(
        std::fs::File::open(SAMPLE).unwrap(),
    ));
    let mut reader = decoder.read_info().unwrap();
    let mut kept = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut kept).unwrap();
    assert_eq!(kept.len(), picture.len());
    let differs = |(a, b): (&u8, &u8)| a.abs_diff(*b) > 2;
    assert!(!kept.iter().zip(&picture).any(differs));
}

#[test]
fn the_map_shows_what_the_arm_drew() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    marks(folder);
    let args = [JOB, SAMPLE, "--robot", "benchtop", "--marks", "marks.gcode"];
    let text = photo(folder, &args);
    let text = String::from_utf8(text.stdout).unwrap();
    for line in text.lines().filter(|line| !line.starts_with("wrote")) {
        assert!(
            DOCUMENT.contains(line.trim()),
            "docs/use/photo.md lacks: {line}"
        );
    }
    let table = std::fs::read_to_string(folder.join("out/photo/photo.csv")).unwrap();
    assert!(table.starts_with("line,x_m,y_m,normal_x,normal_y,error_m\n"));
    let map = std::fs::read_to_string(folder.join("out/photo/photo.svg")).unwrap();
    assert!(map.contains("fivebar.gcode") && map.contains("RMS"));

    // The same picture as a JPEG in colours, as a camera writes it.
    let jpeg = SAMPLE.replace(".png", ".jpg");
    let jpeg = answer(
        folder,
        &[JOB, &jpeg, "--robot", "benchtop", "--marks", "marks.gcode"],
    );
    let rms = jpeg["rms_m"].as_f64().unwrap();
    assert!((rms - 0.288e-3).abs() < 0.005e-3, "{rms}");
}

#[test]
fn with_measured_marks_the_map_agrees_with_the_arm() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let marks = marks(folder);
    let args = [JOB, SAMPLE, "--robot", "benchtop", "--marks", "marks.gcode"];
    let arm = Arm::new();
    let mut distances = String::from("from,to,length\n");
    for (from, to) in [(0, 1), (1, 2), (2, 3), (3, 0), (0, 2), (1, 3)] {
        let [a, b] = [from, to].map(|mark: usize| arm.drawn(marks[mark].into()));
        distances += &format!("{},{},{:.5}\n", from + 1, to + 1, (a - b).norm());
    }
    std::fs::write(folder.join("ruler.csv"), distances).unwrap();
    // With a lens that is known, nothing of the arm's errors is taken for it.
    let more = "--distances ruler.csv --window 2mm --lens -0.03";
    let more: Vec<_> = more.split(' ').collect();
    let found = answer(folder, &[&args[..], &more].concat());
    assert!(found["measured_m"].as_f64() > Some(0.4), "{found}");
    let table = std::fs::read_to_string(folder.join("out/photo/photo.csv")).unwrap();
    let rows: Vec<[f64; 5]> = table
        .lines()
        .skip(1)
        .step_by(4)
        .map(|line| {
            let values: Vec<f64> = line
                .split(',')
                .skip(1)
                .map(|x| x.parse().unwrap())
                .collect();
            values.try_into().unwrap()
        })
        .collect();
    // What the arm drew, moved and turned over the job.
    let place = |values: &[f64; 5]| Vector2::new(values[0], values[1]);
    let mean = |point: &dyn Fn(&[f64; 5]) -> Vector2<f64>| {
        rows.iter().map(point).sum::<Vector2<f64>>() / rows.len() as f64
    };
    let [from, to] = [mean(&|values| arm.drawn(place(values))), mean(&place)];
    let turn = rows.iter().fold(Vector2::zeros(), |sum, values| {
        let (p, q) = (arm.drawn(place(values)) - from, place(values) - to);
        sum + Vector2::new(p.dot(&q), p.perp(&q))
    });
    let turn = Rotation2::new(turn.y.atan2(turn.x));
    let lines: Vec<[[f64; 2]; 2]> = drawn_strokes(&arm)
        .iter()
        .flat_map(|stroke| stroke.windows(2))
        .map(|ends| [0, 1].map(|end| (to + turn * (Vector2::from(ends[end]) - from)).into()))
        .collect();
    // Where the ink crosses the line across a stroke.
    let real = |values: &[f64; 5]| {
        let across = Vector2::new(values[2], values[3]);
        let along = Vector2::new(across.y, -across.x);
        // Nearly all lines are far away: plain numbers tell that soonest in a build without optimisation.
        let is_near = |[[x, y], _]: &&[[f64; 2]; 2]| {
            let (x, y) = (x - values[0], y - values[1]);
            x * x + y * y <= 25e-6
        };
        let crossings = lines.iter().filter(is_near).filter_map(|line| {
            let [a, b] = line.map(|end| Vector2::from(end) - place(values));
            let [u, v] = [a.dot(&along), b.dot(&along)];
            (u * v <= 0.0 && u != v).then(|| a.lerp(&b, u / (u - v)).dot(&across))
        });
        let off = |crossing: &f64| (crossing - values[4]).abs();
        crossings.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap()
    };
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    let row = |&[x, y, u, v, _]: &[f64; 5]| Vector3::new(u, v, v * x - u * (y - 0.18));
    for values in &rows {
        normal += row(values) * row(values).transpose();
        right += row(values) * (real(values) - values[4]);
    }
    let placement = normal.cholesky().unwrap().solve(&right);
    let off = |values: &[f64; 5]| values[4] + row(values).dot(&placement) - real(values);
    let squares: f64 = rows.iter().map(|values| off(values).powi(2)).sum();
    let rms = (squares / rows.len() as f64).sqrt();
    let greatest = rows
        .iter()
        .map(|values| off(values).abs())
        .fold(0.0, f64::max);
    println!("off {:.1} µm RMS, {:.1} µm", 1e6 * rms, 1e6 * greatest);
    // Also on an arc of 4 mm radius that lies 0.9 mm from its place.
    assert!(rms < 0.01e-3 && greatest < 0.05e-3, "{rms} {greatest}");
}

#[test]
fn the_points_of_a_photograph_calibrate_the_arm() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    marks(folder);
    let args = [JOB, SAMPLE, "--robot", "benchtop", "--marks", "marks.gcode"];
    answer(folder, &[&args[..], &["--points", "points.csv"]].concat());
    let mut calibrate = program(env!("CARGO_BIN_EXE_fivebar"));
    calibrate
        .current_dir(folder)
        .args(["calibrate", "--robot", "benchtop", "--json"]);
    let bars = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../files/measurements/benchtop_bars.csv"
    );
    let output = calibrate
        .args(["--photo", "points.csv", "--bars", bars])
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    println!("{found}");
    for (index, real) in LENGTHS.into_iter().enumerate() {
        let length = found["link_lengths"][index].as_f64().unwrap();
        assert!((length - real).abs() < 0.1e-3, "{length} m, not {real} m");
    }
}

#[test]
fn refusals_name_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    marks(folder);
    let with = |picture: &str, marks: &str, wanted: &str| {
        refused(
            folder,
            &[JOB, picture, "--marks", marks, "--robot", "benchtop"],
            wanted,
        );
    };
    write_png(&folder.join("blank.png"), [800, 600], &[230; 480_000]);
    with("blank.png", "marks.gcode", "no mark is found: four marks");
    write_png(&folder.join("small.png"), [200, 100], &[230; 20_000]);
    with("small.png", "marks.gcode", "take the camera's full size");
    std::fs::write(folder.join("photo.heic"), b"\0\0\0\x18ftypheic\0\0\0\0").unwrap();
    with("photo.heic", "marks.gcode", "save it as PNG or JPEG");
    std::fs::write(folder.join("broken.png"), b"\x89PNG\r\n\x1a\n1234").unwrap();
    with("broken.png", "marks.gcode", "the PNG is broken");
    std::fs::write(folder.join("broken.jpg"), b"\xff\xd8\xff\xe01234").unwrap();
    with("broken.jpg", "marks.gcode", "the JPEG is broken");
    with("none.png", "marks.gcode", "none.png");
    with(SAMPLE, JOB, "that --draw-marks wrote");
    let text = include_str!("../../../files/robots/benchtop.toml");
    std::fs::write(
        folder.join("beside.toml"),
        format!("{text}\n[tool]\noffset = [0.01, 0.0]\n"),
    )
    .unwrap();
    refused(
        folder,
        &[
            JOB,
            SAMPLE,
            "--marks",
            "marks.gcode",
            "--robot",
            "beside.toml",
            "--points",
            "points.csv",
        ],
        "a pen at C",
    );
    assert!(!folder.join("points.csv").exists());
    let marked = [JOB, SAMPLE, "--marks", "marks.gcode"];
    let and = |more: &[&str], wanted: &str| refused(folder, &[&marked, more].concat(), wanted);
    // The job at another place is another job.
    and(
        &["--origin", "45mm,180mm"],
        "of the strokes are found where the job has them",
    );
    std::fs::write(folder.join("two.csv"), "from,to,length\n1,2,0.1\n2,3,0.1\n").unwrap();
    and(&["--distances", "two.csv"], "five different distances");
    std::fs::write(folder.join("five.csv"), "from,to,length\n1,5,0.1\n").unwrap();
    and(
        &["--distances", "five.csv"],
        "the marks have the numbers 1 to 4",
    );
    std::fs::write(folder.join("up.gcode"), "G21\nG0 X1 Y1\nG0 X5\n").unwrap();
    refused(
        folder,
        &["up.gcode", "--draw-marks", "m.gcode"],
        "draws nothing",
    );
    assert_eq!(photo(folder, &[JOB]).status.code(), Some(2));
}
