//! No number of an input, however large or small, gives an answer that is not a number or is infinite: it is
//! refused, or the answer is finite.

use fivebar_testkit::program;
use std::fs;

/// Rows of the table of cases.
const EXTREMES: [&str; 4] = ["1e308", "-1e308", "1e-308", "1e30"];

/// The text with each of its numbers, behind `=`, `[`, `,` or `:`, replaced by `number`.
fn with_each(text: &str, number: &str) -> Vec<String> {
    let mut texts = Vec::new();
    let mut start = 0;
    while let Some(found) = text[start..].find(|c: char| c.is_ascii_digit() || c == '-') {
        let begin = start + found;
        let length = text[begin..]
            .find(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c)))
            .unwrap_or(text.len() - begin);
        let before = text[..begin].trim_end().chars().last();
        if before.is_some_and(|c| "=[,:".contains(c)) {
            texts.push(text[..begin].to_owned() + number + &text[begin + length..]);
        }
        start = begin + length;
    }
    texts
}

/// One extreme for each number, in turn.
#[test]
fn no_answer_holds_a_number_that_is_none() {
    let tried = answers_hold_numbers(|place, extreme| place % EXTREMES.len() == extreme);
    assert!(tried > 100, "{tried}");
}

#[test]
#[ignore = "a minute: ./ci.sh tables"]
fn whole_table_no_answer_to_any_extreme_holds_a_number_that_is_none() {
    let tried = answers_hold_numbers(|_, _| true);
    assert!(tried > 400, "{tried}");
}

/// Tries every third number of each file with those extremes that `is_tried` names for its place. Returns how many
/// commands it ran.
#[expect(clippy::too_many_lines, reason = "a list of cases")]
fn answers_hold_numbers(is_tried: impl Fn(usize, usize) -> bool) -> usize {
    let folder = tempfile::tempdir().unwrap();
    let uncommented = |text: &str| -> String {
        let lines = text
            .lines()
            .map(|line| line.split('#').next().unwrap_or_default());
        lines.map(|line| format!("{line}\n")).collect()
    };
    let holes = include_str!("../../../files/measurements/benchtop_holes.csv");
    let holes: String = holes
        .lines()
        .take(14)
        .map(|line| format!("{line}\n"))
        .collect();
    let scenario = include_str!("../../../files/scenarios/realistic.toml");
    let line = folder.path().join("line.gcode");
    fs::write(&line, "G21 G90\nG1 X2 F6000\n").unwrap();
    let line = line.display().to_string();
    let scenario = scenario.replace("../jobs/fivebar.gcode", &line);
    let mut tried = 0;
    for (file, text, args) in [
        (
            "f.toml",
            include_str!("../../../files/linkages/four_bar.toml"),
            "linkage FILE --json",
        ),
        (
            "f.toml",
            include_str!("../../../files/linkages/prrrp.toml"),
            "linkage FILE --json",
        ),
        (
            "f.toml",
            include_str!("../../../files/mobility/five-bar.toml"),
            "mobility FILE --json",
        ),
        (
            "f.toml",
            include_str!("../../../files/mobility/slider-parallelograms.toml"),
            "mobility FILE --json",
        ),
        (
            "f.toml",
            include_str!("../../../files/robots/slider.toml"),
            "accuracy FILE --at 0,0.8 --json",
        ),
        (
            "f.toml",
            include_str!("../../../files/robots/usp_2dof.toml"),
            "accuracy FILE --at 0.05,0.2 --json",
        ),
        (
            "f.json",
            include_str!("../../../files/paths/square.json"),
            "plan FILE --json",
        ),
        (
            "f.toml",
            include_str!("../../../files/robots/benchtop.toml"),
            "margins FILE --json",
        ),
        ("f.csv", &holes, "calibrate --points FILE --json"),
        ("f.toml", &scenario, "sim FILE --json"),
    ] {
        let path = folder.path().join(file);
        for (extreme, number) in EXTREMES.into_iter().enumerate() {
            let texts = with_each(&uncommented(text), number).into_iter().step_by(3);
            let texts = texts
                .enumerate()
                .filter(|(place, _)| is_tried(*place, extreme));
            for (_, text) in texts {
                fs::write(&path, &text).unwrap();
                let args = args.replace("FILE", &path.display().to_string());
                let output = program(env!("CARGO_BIN_EXE_fivebar"))
                    .args(args.split(' '))
                    // What a command writes beside its answer.
                    .current_dir(folder.path())
                    .output()
                    .unwrap();
                let said = String::from_utf8(output.stdout).unwrap().to_lowercase();
                let words = said.split(|c: char| !c.is_ascii_alphanumeric());
                let is_none = words.into_iter().any(|word| word == "nan" || word == "inf");
                assert!(!is_none, "{args}: {said}\n{text}");
                // A scale that is stated, a job that was drawn, and what an arm does not have.
                let said = said.replace("\"why\":null", "");
                let said = said.replace("\"degrees_of_freedom\":null", "");
                let said = said.replace("\"grashof\":null", "");
                let said = said.replace("\"resonance_hz\":[null,null]", "");
                let said = said.replace("\"modes_hz\":[null,null]", "");
                let nulls = said.matches("null").count();
                assert!(
                    !output.status.success() || nulls == 0,
                    "{args}: {said}\n{text}"
                );
                tried += 1;
            }
        }
    }
    tried
}
