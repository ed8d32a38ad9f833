//! `fivebar pen`: the heights of a pen are tried and kept.

use fivebar_files::robot::Robot;
use fivebar_firmware::settings::ToolOutputSettings;
use fivebar_testkit::program;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::Stdio;

/// What the program says to these lines: its output, its messages, and whether it succeeded.
fn answers(folder: &Path, robot: &str, lines: &str) -> (String, String, bool) {
    let mut program = program(env!("CARGO_BIN_EXE_fivebar"));
    let mut child = program
        .args(["pen", "--robot", robot])
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut input = child.stdin.take().expect("a pipe");
    // A program that has ended reads nothing.
    let _ = input.write_all(lines.as_bytes());
    drop(input);
    let output = child.wait_with_output().expect("it ends");
    let [said, warned] = [output.stdout, output.stderr].map(|it| String::from_utf8(it).unwrap());
    (said, warned, output.status.success())
}

#[test]
fn heights_are_typed_and_kept_in_the_file_with_its_comments() {
    let folder = tempfile::tempdir().unwrap();
    let text = fivebar_files::robot::text_of("benchtop_pen").unwrap();
    let file = folder.path().join("arm.toml");
    fs::write(&file, &text).unwrap();
    let lines = "down 1.7\nup 0.9\nup 1.7\nup 9\nhigher\nkeep\ndown 2\n";
    let (said, warned, done) = answers(folder.path(), "arm.toml", lines);
    assert!(done, "{warned}");
    let shown = [
        "up 1.00 ms, down 1.50 ms",
        "up 1.00 ms, down 1.70 ms",
        "up 0.90 ms, down 1.70 ms",
        "up 0.90 ms, down 1.70 ms",
        "up 0.90 ms, down 2.00 ms",
    ];
    assert_eq!(said.lines().collect::<Vec<_>>(), shown, "{warned}");
    for words in ["must differ", "0.1 to 5 ms", "`higher` is no order"] {
        assert!(warned.contains(words), "{words}: {warned}");
    }
    let new = fs::read_to_string(&file).unwrap();
    // All lines but the two stay, and each of the two has a line above it.
    let is_new = |line: &&str| !text.lines().any(|old| old == *line);
    let added: Vec<_> = new.lines().filter(is_new).collect();
    assert_eq!(added.len(), 4, "{added:?}");
    assert!(
        added[1].starts_with("up_width = 9.00e-4") && added[3].starts_with("down_width = 1.70e-3")
    );
    assert_eq!(
        fs::read_to_string(folder.path().join("arm.toml.old")).unwrap(),
        text
    );
}

#[test]
fn a_built_in_robot_and_an_arm_without_a_servo_are_refused_with_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let (_, warned, _) = answers(folder.path(), "benchtop_pen", "up 1.2\nkeep\n");
    assert!(
        warned.contains("fivebar robots benchtop_pen > my-arm.toml"),
        "{warned}"
    );
    for robot in ["benchtop", "benchtop_stepper", "leg", "classroom_servo"] {
        let output = Robot::load(robot).unwrap().tool_output;
        let has_servo = matches!(output, ToolOutputSettings::Servo { .. });
        let (_, warned, done) = answers(folder.path(), robot, "");
        assert_eq!(done, has_servo, "{robot}: {warned}");
        assert!(
            has_servo || warned.contains("no pen with a servo"),
            "{robot}: {warned}"
        );
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
