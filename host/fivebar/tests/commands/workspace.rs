//! The command `fivebar workspace`: its results compared with the models, its files and errors.

use fivebar_files::robot::{BUILT_IN, Robot};
use fivebar_kinematics::five_bar::{Side, WorkingMode};
use fivebar_testkit::program;
use nalgebra::Vector2;
use serde_json::Value;
use std::collections::HashSet;
use std::path::Path;
use std::process::Output;

fn workspace(folder: &Path, args: &[&str]) -> Output {
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
    command.arg("workspace").args(args).arg("--out").arg(folder);
    command.output().unwrap()
}

fn answer(folder: &Path, args: &[&str]) -> Value {
    let output = workspace(folder, &[args, &["--json"]].concat());
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    serde_json::from_slice(&output.stdout).unwrap()
}

#[track_caller]
fn refusal(args: &[&str], status: i32) -> String {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let output = workspace(&out, args);
    assert_eq!(output.status.code(), Some(status));
    assert!(output.stdout.is_empty());
    assert!(!out.exists(), "a refused command wrote files");
    String::from_utf8(output.stderr).unwrap()
}

fn side(value: &Value) -> Side {
    match value.as_str() {
        Some("left") => Side::Left,
        Some("right") => Side::Right,
        other => panic!("{other:?} is no side"),
    }
}

fn mode(branch: &Value) -> WorkingMode {
    WorkingMode::new(side(&branch["elbow1"]), side(&branch["elbow4"]))
}

fn vector(value: &Value) -> Vector2<f64> {
    Vector2::new(value[0].as_f64().unwrap(), value[1].as_f64().unwrap())
}

#[test]
fn a_built_in_robot_is_mapped_and_its_branches_have_the_exact_area() {
    mapped_exactly(&["benchtop", "usp_2dof", "leg"]);
}

#[test]
#[ignore = "some seconds: ./ci.sh tables"]
fn whole_table_of_built_in_robots_that_are_mapped_with_their_exact_area() {
    let names: Vec<&str> = BUILT_IN.iter().map(|built_in| built_in.name).collect();
    mapped_exactly(&names);
}

fn mapped_exactly(robots: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    for name in robots {
        let found = answer(folder.path(), &[name, "--resolution", "5"]);
        let exact = found["reached_exactly_m2"].as_f64().unwrap();
        let branches = found["branches"].as_array().unwrap();
        assert_eq!(branches.len(), 8);
        for pair in branches.chunks(2) {
            assert_eq!(
                (mode(&pair[0]), &pair[0]["assembly"]),
                (mode(&pair[1]), &"left".into())
            );
            let [one, other] = [&pair[0], &pair[1]].map(|b| b["reached_m2"].as_f64().unwrap());
            let counted = one + other;
            // Of about a thousand cells, a tenth lie on the boundary, half of them inside.
            assert!(
                (counted / exact - 1.0).abs() < 0.02,
                "{name}: {counted} for {exact} m²"
            );
        }
    }
}

#[test]
fn every_row_of_the_table_matches_the_models() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("offset.toml");
    let text = BUILT_IN[0].text.to_owned() + "\n[tool]\noffset = [0.03, -0.02]\n";
    std::fs::write(&file, text).unwrap();
    let name = file.to_str().unwrap();
    let found = answer(folder.path(), &[name, "--resolution", "5"]);
    let robot = Robot::load(name).unwrap();
    assert_eq!(
        found["reached_exactly_m2"],
        Value::Null,
        "the exact area exists for a tool at C only"
    );

    let table = std::fs::read_to_string(folder.path().join("workspace.csv")).unwrap();
    let mut lines = table.lines();
    let header = lines.next().unwrap();
    assert!(header.starts_with("x_m,y_m,elbow1,elbow4,assembly,within_limits,clear,"));
    let mut counts = [0_u32; 3];
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), header.split(',').count(), "{line}");
        let number = |index: usize| fields[index].parse::<f64>().unwrap();
        let mode = WorkingMode::new(side(&fields[2].into()), side(&fields[3].into()));
        let workspace = robot.workspace(mode).unwrap();
        let place = Vector2::new(number(0), number(1));
        let pose = workspace.tool.inverse(place, mode).unwrap();
        assert_eq!(pose.assembly(), side(&fields[4].into()), "{line}");
        let [elbow1, elbow4] = workspace.tool.elbow_sines(&pose);
        for (index, sine) in [(7, elbow1), (8, elbow4), (9, pose.sin32())] {
            assert!((number(index) - sine.abs()).abs() < 1e-3, "{line}: {sine}");
        }
        // κ from finite differences of the forward solution.
        if number(9) > 0.1 && number(7).min(number(8)) > 0.1 {
            let [theta1, _, _, theta4] = pose.angles();
            let at = |turn1: f64, turn4: f64| {
                let geometry = workspace.tool.geometry();
                let moved = geometry.forward(theta1 + turn1, theta4 + turn4, pose.assembly());
                workspace.tool.point(&moved.unwrap())
            };
            let (h, columns) = (1e-6, [[1e-6, 0.0], [0.0, 1e-6]]);
            let columns = columns.map(|[a, b]| (at(a, b) - at(-a, -b)) * (0.5 / h));
            let [[a, c], [b, d]] = columns.map(|column| [column.x, column.y]);
            let values = nalgebra::Matrix2::new(a, b, c, d).singular_values();
            let condition = values.max() / values.min();
            assert!(
                (number(10) / condition - 1.0).abs() < 1e-3,
                "{line}: {condition}"
            );
        }
        let clear = workspace.check(place).is_ok();
        assert_eq!(fields[6] == "1", clear, "{line}");
        counts[0] += 1;
        counts[1] += u32::from(fields[5] == "1");
        counts[2] += u32::from(clear);
    }
    // The areas are those of the table's cells.
    let cell = found["resolution_m"].as_f64().unwrap().powi(2);
    for (key, count) in ["reached_m2", "within_limits_m2", "clear_m2"]
        .into_iter()
        .zip(counts)
    {
        let branches = found["branches"].as_array().unwrap().iter();
        let area: f64 = branches.map(|branch| branch[key].as_f64().unwrap()).sum();
        assert!(count > 100);
        assert!(
            (area - f64::from(count) * cell).abs() < 1e-9,
            "{key}: {area} m²"
        );
    }
}

#[test]
fn the_rectangles_and_the_best_positions_are_clear() {
    let folder = tempfile::tempdir().unwrap();
    let found = answer(folder.path(), &["benchtop"]);
    let robot = Robot::load("benchtop").unwrap();
    let mut rectangles = 0;
    for branch in found["branches"].as_array().unwrap() {
        let workspace = robot.workspace(mode(branch)).unwrap();
        let is_clear = |place| {
            let pose = workspace.check(place);
            pose.is_ok_and(|pose| pose.assembly() == side(&branch["assembly"]))
        };
        if let Some(best) = branch["best"].as_object() {
            assert!(is_clear(vector(&best["at_m"])));
            assert!(best["condition_number"].as_f64().unwrap() >= 1.0);
        }
        let Some(rectangle) = branch["clear_rectangle"].as_object() else {
            continue;
        };
        let (low, size) = (vector(&rectangle["low_m"]), vector(&rectangle["size_m"]));
        for i in 1..200 {
            for j in 1..200 {
                let share = Vector2::new(size.x * f64::from(i), size.y * f64::from(j)) * 0.005;
                assert!(is_clear(low + share), "{branch}");
            }
        }
        rectangles += 1;
    }
    assert!(rectangles >= 4);
    // A drawing of the size A6 fits into the robot's own branch.
    let own = &found["branches"][4];
    assert_eq!(mode(own), robot.working_mode());
    let size = vector(&own["clear_rectangle"]["size_m"]);
    assert!(size.x > 0.148 && size.y > 0.09, "{size:?} m");
}

#[test]
fn positions_of_the_smallest_arm_are_distinct() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("tiny.toml");
    let links = [1e-5, 2e-5, 2e-5, 1e-5].map(|length| format!("[[link]]\nlength = {length}\n"));
    let text = format!(
        "name = \"tiny\"\ngravity = [0.0, 0.0]\nbase = 1e-5\n{}",
        links.concat()
    );
    std::fs::write(&file, text).unwrap();
    assert!(
        workspace(folder.path(), &[file.to_str().unwrap()])
            .status
            .success()
    );
    let csv = std::fs::read_to_string(folder.path().join("workspace.csv")).unwrap();
    // Position and working mode.
    let key = |line: &str| line.splitn(5, ',').take(4).collect::<Vec<_>>().join(",");
    let lines: Vec<String> = csv.lines().map(key).collect();
    let distinct: HashSet<&String> = lines.iter().collect();
    assert!(lines.len() > 1000 && distinct.len() == lines.len());
}

#[test]
fn the_picture_explains_its_areas() {
    let folder = tempfile::tempdir().unwrap();
    let output = workspace(folder.path(), &["benchtop"]);
    let message = String::from_utf8(output.stdout).unwrap();
    assert!(
        message.contains("right, left") && message.contains("[cm²]"),
        "{message}"
    );
    let svg = std::fs::read_to_string(folder.path().join("workspace.svg")).unwrap();
    for shown in [
        "Workspace of benchtop",
        "elbow of leg 1 to the right, of leg 4 to the left",
        "x [mm]",
        "outside the joint limits",
        "within the margin of 0.15",
        "stroke-dasharray=\"7 4\"",
        ">A<",
    ] {
        assert!(svg.contains(shown), "{shown}");
    }

    // A robot without limits has no hatched area. Another branch can be drawn.
    workspace(folder.path(), &["haply", "--branch", "left,left"]);
    let svg = std::fs::read_to_string(folder.path().join("workspace.svg")).unwrap();
    assert!(svg.contains("elbow of leg 1 to the left, of leg 4 to the left"));
    assert!(!svg.contains("outside the joint limits"));
}

#[cfg(feature = "png")]
#[test]
fn the_image_has_its_title_without_a_system_font() {
    let folder = tempfile::tempdir().unwrap();
    workspace(folder.path(), &["benchtop"]);
    let image = std::fs::read(folder.path().join("workspace.png")).unwrap();
    let image = resvg::tiny_skia::Pixmap::decode_png(&image).unwrap();
    assert!(image.width() > 1500 && image.height() > 1200);
    // Pixels of the title, which no line crosses.
    let dark = |pixel: &&resvg::tiny_skia::PremultipliedColorU8| pixel.red() < 0x80;
    let title = 100 * image.width() as usize;
    assert!(image.pixels()[..title].iter().filter(dark).count() > 500);
}

#[test]
fn robots_that_cannot_be_mapped_are_refused_with_the_reason() {
    let slider = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/robots/slider.toml");
    let message = refusal(&[slider], 1);
    assert!(
        message.contains("`mechanism` is \"slider\"") && message.contains("five-bar"),
        "{message}"
    );
    let message = refusal(&["nobody"], 1);
    assert!(
        message.contains("no such robot") && message.contains("benchtop"),
        "{message}"
    );
    let message = refusal(&["--resolution", "0.001"], 1);
    assert!(
        message.contains("two million cells") && message.contains("--resolution"),
        "{message}"
    );
    let message = refusal(&["--resolution", "1000"], 1);
    assert!(
        message.contains("reaches no position that a map can show"),
        "{message}"
    );
    // With a base as long as all links together, the legs reach one point only.
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("stretched.toml");
    let links = "[[link]]\nlength = 0.1\n".repeat(4);
    let text = format!("name = \"stretched\"\ngravity = [0.0, 0.0]\nbase = 0.4\n{links}");
    std::fs::write(&file, text).unwrap();
    let message = refusal(&[file.to_str().unwrap()], 1);
    assert!(
        message.contains("`stretched` reaches no position"),
        "{message}"
    );
    for (option, value) in [
        ("--resolution", "-1"),
        ("--resolution", "fine"),
        ("--branch", "up,left"),
    ] {
        let message = refusal(&[&format!("{option}={value}")], 2);
        assert!(message.contains("invalid value"), "{message}");
    }
}

#[test]
fn an_unwritable_folder_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let taken = folder.path().join("taken");
    std::fs::write(&taken, "a file").unwrap();
    let output = workspace(&taken, &["haply"]);
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(
        message.contains("taken") && message.contains("--out"),
        "{message}"
    );
    assert_eq!(std::fs::read_to_string(&taken).unwrap(), "a file");
}
