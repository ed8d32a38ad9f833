//! C programs against the header and the static library, in both precisions: the same bits as in Rust, every refusal, and
//! no code that panics.

#[path = "common/mod.rs"]
mod common;
mod expected;

use common::{compile, printed};
use expected::{Case, Real, cases, expected};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Compiles a source for a precision. Tests run side by side: each has its own name for the program.
fn program<R: Real>(source: &str, name: &str) -> PathBuf {
    let source = format!("tests/{source}.c");
    let flags = ["-std=c99", R::FLAG];
    let name = format!("{name}{}", R::FLAG);
    compile("cc", &flags, &[Path::new(&source)], &name)
}

fn compare_bits<R: Real>() {
    let cases: Vec<Case<R>> = cases();
    let input = cases.iter().map(Case::line).collect::<Vec<_>>().join("\n");
    let text = printed(&program::<R>("bits", "bits"), input);
    let mut lines = text.lines();
    let mut statuses = BTreeSet::new();
    let mut answers = 0;
    for case in &cases {
        for expected in expected(case) {
            assert_eq!(lines.next(), Some(expected.as_str()), "{case:?}");
            let status = expected.split(' ').nth(1).unwrap();
            answers += usize::from(status == "0");
            statuses.insert(status.parse::<i32>().unwrap());
        }
    }
    assert_eq!(lines.next(), None);
    println!("{}: {} cases, {answers} results", R::FLAG, cases.len());
    assert!(answers > 4000, "only {answers} calls have a result");
    // Each status that numbers can cause occurs. `refusals.c` has the others.
    let all = [
        0, 3, 10, 11, 12, 13, 14, 15, 16, 20, 21, 22, 23, 24, 25, 30, 31, 32,
    ];
    assert_eq!(statuses, BTreeSet::from(all));
}

#[test]
fn single_precision_has_the_bits_of_rust() {
    compare_bits::<f32>();
}

#[test]
fn double_precision_has_the_bits_of_rust() {
    compare_bits::<f64>();
}

#[test]
fn null_pointers_wrong_sides_and_unprepared_arms_are_refused() {
    for program in [
        program::<f32>("refusals", "refusals"),
        program::<f64>("refusals", "refusals"),
    ] {
        assert_eq!(printed(&program, String::new()), "");
    }
}

#[test]
fn no_function_has_code_that_panics() {
    for program in [
        program::<f32>("bits", "panics"),
        program::<f64>("bits", "panics"),
    ] {
        let output = Command::new("nm").arg(&program).output().unwrap();
        let symbols = String::from_utf8(output.stdout).unwrap();
        assert!(symbols.contains("fivebar_tool_jacobian"), "{symbols}");
        assert!(!symbols.contains("panic"), "{symbols}");
    }
}

/// The program of the README, and what it says that the program prints.
#[test]
fn the_readme_has_a_program_that_prints_what_it_says() {
    let readme = std::fs::read_to_string("../README.md").unwrap();
    let (_, rest) = readme
        .split_once("```c\n")
        .expect("README has a program in C");
    let (source, rest) = rest.split_once("```").unwrap();
    let (_, rest) = rest.split_once("```text\n").unwrap();
    let (says, _) = rest.split_once("```").unwrap();
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("readme.c");
    std::fs::write(&file, source).unwrap();
    let program = compile("cc", &["-std=c99"], &[&file], "readme");
    assert_eq!(printed(&program, String::new()), says);
}

/// The example for Arduino, compiled with as much of Arduino as it needs.
#[test]
fn the_example_for_arduino_gives_angles_and_torques_in_every_period() {
    if Command::new("c++").arg("--version").output().is_err() {
        println!("no c++: the example for Arduino is not compiled");
        return;
    }
    let flags = ["-std=c++11", "-x", "c++"];
    let program = compile("c++", &flags, &[Path::new("tests/arduino/main.cpp")], "leg");
    let text = printed(&program, String::new());
    let rows: Vec<Vec<f64>> = text
        .lines()
        .map(|line| line.split(' ').map(|it| it.parse().expect(line)).collect())
        .collect();
    assert_eq!(rows.len(), 200);
    for row in rows {
        let [angle1, angle4, torque1, torque4] = row[..] else {
            panic!("{row:?}");
        };
        // The leg and the force are symmetric; the numbers have four decimals.
        assert!((angle1 + angle4 + std::f64::consts::PI).abs() < 2e-4);
        assert!((torque1 + torque4).abs() < 2e-4 && torque1 > 0.5);
    }
}
