//! Invalid linkage files: each is refused quickly, with one sentence that names the line.

use fivebar_files::linkage::DrivenLinkage;
use std::time::{Duration, Instant};

const GOOD: &str = r#"name = "four-bar"
gravity = [0.0, -9.81]
[sweep]
duration = 1.0
steps = 36
[ground]
A = [0.0, 0.0]
D = [0.35, 0.0]
[[element]]
kind = "crank"
pivot = "A"
link = { name = "crank" }
drive = { speed_deg_s = 360.0 }
[[element]]
kind = "RRR"
ends = ["B", "D"]
lengths = [0.30, 0.25]
joint = "C"
branch = "left"
links = [{ name = "coupler" }, { name = "rocker" }]
[[point]]
name = "B"
link = "crank"
at = [0.10, 0.0]
"#;

/// The error for the valid file with `from` replaced by `to`.
fn refusal(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from}");
    let text = GOOD.replace(from, to);
    let started = Instant::now();
    let error = DrivenLinkage::parse("f.toml", &text).expect_err(to);
    assert!(started.elapsed() < Duration::from_secs(5), "{from} → {to}");
    let message = error.to_string();
    assert!(
        message.starts_with("f.toml") && !message.contains('\n'),
        "{message}"
    );
    assert!(message.len() < 400, "{message}");
    message
}

#[test]
fn the_unchanged_file_is_accepted() {
    let driven = DrivenLinkage::parse("f.toml", GOOD).unwrap();
    assert_eq!(driven.sweep().solved().count(), 37);
}

#[test]
#[expect(clippy::too_many_lines, reason = "a list of cases")]
fn each_mistake_is_reported_with_its_line_and_key() {
    for (from, to, message) in [
        (
            "gravity",
            "gravitation",
            "line 2: unknown field `gravitation`",
        ),
        ("joint", "pin", "unknown field `pin`"),
        ("pivot = \"A\"", "", "missing field `pivot`"),
        ("\"RRR\"", "\"RRX\"", "unknown variant `RRX`"),
        ("\"left\"", "\"up\"", "unknown variant `up`"),
        (
            "\"B\", \"D\"",
            "\"B\", \"E\"",
            "line 16: `ends` of [[element]] 2 names a point `E`",
        ),
        (
            "pivot = \"A\"",
            "pivot = \"C\"",
            "line 11: `pivot` of [[element]] 1 names `C`, which is known only once",
        ),
        (
            "\"B\", \"D\"",
            "\"B\", \"C\"",
            "names `C`, which is known only once this or a later element",
        ),
        (
            "link = \"crank\"",
            "link = \"lever\"",
            "line 23: `link` of [[point]] 1 names a link `lever`",
        ),
        (
            "\"rocker\"",
            "\"crank\"",
            "line 20: `links` of [[element]] 2 name `crank`, which another link has",
        ),
        (
            "\"rocker\"",
            "\"ground\"",
            "name `ground`, which another link has",
        ),
        (
            "joint = \"C\"",
            "joint = \"D\"",
            "`D` is the name of another point",
        ),
        (
            "joint = \"C\"",
            "joint = \"\"",
            "must be a name of 1 to 60 characters",
        ),
        (
            "A = [0.0, 0.0]",
            "A = [0.0, 0.0]\nA = [1.0, 0.0]",
            "duplicate key",
        ),
        (
            "0.30",
            "-0.30",
            "every length must be a positive finite number of metres",
        ),
        (
            "0.30",
            "nan",
            "every length must be a positive finite number of metres",
        ),
        ("at = [0.10", "at = [inf", "every number must be finite"),
        ("at = [0.10", "at = [1e12", "check its unit"),
        (
            "\"coupler\"",
            "\"coupler\", mass = -1.0",
            "mass and inertia must be finite and not negative",
        ),
        (
            "duration = 1.0",
            "duration = 0.0",
            "line 4: `duration` of [sweep] must be a positive number",
        ),
        (
            "steps = 36",
            "steps = 0",
            "line 5: `steps` of [sweep] must be 1 to",
        ),
        (
            "steps = 36",
            "steps = 1000000000",
            "line 5: `steps` of [sweep] must be 1 to 100000",
        ),
        (
            "360.0",
            "inf",
            "`drive` of [[element]] 1 must hold finite numbers",
        ),
        ("speed_deg_s", "speed", "unknown field `speed`"),
    ] {
        let sentence = refusal(from, to);
        assert!(
            sentence.contains(message),
            "{message:?} is missing in {sentence:?}"
        );
    }
}

#[test]
fn a_linkage_without_elements_or_without_a_drive_is_refused() {
    let bare = "name = \"x\"\n[sweep]\nduration = 1.0\n";
    let error = DrivenLinkage::parse("f.toml", bare).unwrap_err();
    assert!(error.to_string().contains("must be given 1 to 100 times"));
    let frame = format!(
        "{bare}[ground]\nA = [0.0, 0.0]\nB = [1.0, 0.0]\n[[element]]\nkind = \"RRR\"\n\
         ends = [\"A\", \"B\"]\nlengths = [1.0, 1.0]\njoint = \"C\"\nbranch = \"left\"\n\
         links = [{{ name = \"a\" }}, {{ name = \"b\" }}]\n"
    );
    let error = DrivenLinkage::parse("f.toml", &frame).unwrap_err();
    assert!(error.to_string().contains("needs a driven link"), "{error}");
}

#[test]
fn excessive_sizes_are_refused_in_bounded_time() {
    let dyad = |i: usize| {
        format!(
            "[[element]]\nkind = \"RRR\"\nends = [\"B\", \"D\"]\nlengths = [0.3, 0.25]\n\
             joint = \"C{i}\"\nbranch = \"left\"\n\
             links = [{{ name = \"a{i}\" }}, {{ name = \"b{i}\" }}]\n"
        )
    };
    let dyads = |count| -> String { (0..count).map(dyad).collect() };
    let message = refusal("[[point]]", &(dyads(4_000) + "[[point]]"));
    assert!(
        message.contains("must be given 1 to 100 times, not 4002"),
        "{message}"
    );
    let message = refusal("[[point]]", &(dyads(20) + "[[point]]"));
    assert!(message.contains("21 dyads with two branches"), "{message}");

    let points: String = (0..5000).map(|i| format!("P{i} = [0.0, 0.0]\n")).collect();
    let message = refusal("[ground]\n", &format!("[ground]\n{points}"));
    assert!(message.contains("more than 1000"), "{message}");

    let nested = format!("at = {}{}", "[".repeat(100_000), "]".repeat(100_000));
    refusal("at = [0.10, 0.0]", &nested);
}

#[test]
fn unreadable_files_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let missing = DrivenLinkage::load("no_such_linkage").unwrap_err();
    assert!(
        missing
            .to_string()
            .contains("neither a built-in example nor a file")
    );
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, [0xff; 64]).unwrap();
    let error = DrivenLinkage::load(binary.to_str().unwrap()).unwrap_err();
    assert!(error.to_string().contains("cannot be read as text"));
    let huge = folder.path().join("huge.toml");
    std::fs::write(&huge, "#".repeat(2 << 20)).unwrap();
    let error = DrivenLinkage::load(huge.to_str().unwrap()).unwrap_err();
    assert!(error.to_string().contains("at most 1048576 bytes are read"));
}

#[test]
fn the_files_in_the_documentation_are_valid() {
    let text = include_str!("../../../../docs/design/linkages.md");
    let blocks = text.split("```toml\n").skip(1);
    let blocks: Vec<&str> = blocks
        .filter_map(|block| block.split("```").next())
        .collect();
    let [linkage, slider] = blocks[..] else {
        panic!("{} blocks", blocks.len());
    };
    let driven = DrivenLinkage::parse("linkages.md", linkage).unwrap();
    assert_eq!(driven.sweep().solved().count(), 361);
    fivebar_files::robot::SliderRobot::parse("linkages.md", slider).unwrap();
}

#[test]
fn a_robot_file_is_refused_as_one() {
    for robot in fivebar_files::robot::BUILT_IN {
        if robot.text.contains("[slider]") {
            continue;
        }
        let linkage = DrivenLinkage::parse("arm.toml", robot.text).err().unwrap();
        let mechanism = fivebar_files::mobility::parse("arm.toml", robot.text)
            .err()
            .unwrap();
        for error in [linkage, mechanism] {
            let error = error.to_string();
            assert!(
                error.contains("this is a robot file, not a"),
                "{}: {error}",
                robot.name
            );
        }
    }
}
