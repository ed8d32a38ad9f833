//! No number of an input, however large or small, gives an answer that is not a number or is infinite: it is
//! refused, or the answer is finite.

use std::fs;
use std::process::Command;

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

#[test]
#[expect(clippy::too_many_lines, reason = "a list of cases")]
fn no_answer_holds_a_number_that_is_none() {
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
    let petal = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/jobs/petal.gcode");
    let scenario = scenario.replace("../jobs/fivebar.gcode", petal);
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
        for number in EXTREMES {
            for text in with_each(&uncommented(text), number).into_iter().step_by(3) {
                fs::write(&path, &text).unwrap();
                let args = args.replace("FILE", &path.display().to_string());
                let output = Command::new(env!("CARGO_BIN_EXE_fivebar"))
                    .args(args.split(' '))
                    // What a command writes beside its answer.
                    .current_dir(folder.path())
                    .output()
                    .unwrap();
                let said = String::from_utf8(output.stdout).unwrap().to_lowercase();
                let words = said.split(|c: char| !c.is_ascii_alphanumeric());
                let is_none = words.into_iter().any(|word| word == "nan" || word == "inf");
                assert!(!is_none, "{args}: {said}\n{text}");
                // What an arm does not have.
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
    assert!(tried > 150, "{tried}");
}
