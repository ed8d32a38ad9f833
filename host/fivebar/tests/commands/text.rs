//! `fivebar text`: its file is a job, in both formats.

use fivebar_testkit::program;
use serde_json::Value;
use std::path::Path;
use std::process::Output;

fn run(folder: &Path, args: &[&str]) -> Output {
    let mut program = program(env!("CARGO_BIN_EXE_fivebar"));
    program.args(args).current_dir(folder).output().unwrap()
}

#[test]
fn a_text_is_written_as_svg_or_gcode_and_each_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    for file in ["word.svg", "word.gcode"] {
        let written = run(
            folder.path(),
            &["text", "Hü", "1", "--align", "right", "--out", file],
        );
        let said = String::from_utf8(written.stdout).unwrap();
        // H has three strokes, ü four with its dots, 1 one.
        let expected = format!("8 strokes, 15.7 mm × 27.5 mm, in {file}\n");
        assert_eq!(said, expected, "{file}");
        let drawn = run(folder.path(), &["sim", file, "--json", "--out", "out"]);
        let message = String::from_utf8_lossy(&drawn.stderr).into_owned();
        let figures: Value =
            serde_json::from_slice(&drawn.stdout).unwrap_or_else(|_| panic!("{message}"));
        assert_eq!(figures["drawn"], true, "{file}: {message}");
    }
}

#[test]
fn what_cannot_be_written_is_refused_with_the_reason_and_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    for (args, status, words) in [
        (
            ["text", "aж漢", "--out", "a.svg"],
            1,
            "the font has no ж (U+0436), 漢 (U+6F22)",
        ),
        (["text", " ", "--out", "a.svg"], 1, "nothing to draw"),
        (
            ["text", "a", "--out", "a.pdf"],
            2,
            "a.pdf: a text is written as .svg or .gcode",
        ),
        (["text", "a", "--size", "0mm"], 2, "give a length above 0"),
    ] {
        let refused = run(folder.path(), &args);
        let message = String::from_utf8(refused.stderr).unwrap();
        assert_eq!(refused.status.code(), Some(status), "{message}");
        assert!(message.contains(words), "{message}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
