//! Checks docs/use/robot-file.md: its examples are valid, and its defaults are those of the program.

use fivebar_files::robot::Robot;
use fivebar_files::scenario::{ControlLaw, Scenario};
use fivebar_firmware::settings::{Row, rows};

const DOCUMENT: &str = include_str!("../../../../docs/use/robot-file.md");

/// The TOML examples, in order: robot, drives, other sections, scenario.
fn examples() -> [&'static str; 4] {
    let blocks = DOCUMENT.split("```toml\n").skip(1);
    let examples: Vec<_> = blocks
        .map(|block| block.split("```").next().unwrap())
        .collect();
    examples.try_into().unwrap()
}

#[test]
fn the_document_shows_the_template_of_a_new_robot() {
    let [robot, drives, sections, _] = examples();
    let shown = [robot, drives, sections].join("\n");
    assert_eq!(shown, include_str!("../../src/robot/template.toml"));
}

#[test]
fn the_robot_of_the_document_is_read_with_every_section() {
    let [robot, drives, sections, _] = examples();
    let bare = Robot::parse("bare", robot).unwrap();
    let whole = Robot::parse("whole", &format!("{robot}{drives}{sections}")).unwrap();
    whole.settings().unwrap().check().unwrap();
    bare.settings().unwrap().check().unwrap();
    assert!(bare.actuators.is_none() && whole.actuators.is_some());
    // The document's defaults are the values of a file without these keys.
    assert_eq!(bare.tool, whole.tool);
    assert_eq!(bare.motion, whole.motion);
    assert_eq!(bare.control.tick_rate, whole.control.tick_rate);
    assert_eq!(bare.protection, whole.protection);
    assert_eq!(bare.contact, whole.contact);
    let search = |robot: &Robot| {
        let settings = robot.settings().unwrap();
        let forward = settings.axes.map(|axis| axis.home_forward);
        (settings.homing.speed, settings.homing.back_off, forward)
    };
    assert_eq!(search(&bare), search(&whole));
    assert_eq!(bare.supply.voltage, whole.supply.voltage);
    assert_eq!(bare.limits.max_speed, whole.limits.max_speed);
    assert_eq!(
        bare.limits.singularity_margin,
        whole.limits.singularity_margin
    );
    let range = |robot: &Robot| robot.settings().unwrap().protection.bus_voltage;
    assert_eq!(range(&bare), range(&whole));
    // The default resolution has 4096 codes.
    let per_code = |robot: &Robot| (robot.voltage_per_code() * 1e5).round();
    assert_eq!(per_code(&bare), per_code(&whole));
}

#[test]
fn the_scenario_of_the_document_is_read_with_its_defaults() {
    let [.., scenario] = examples();
    let folder = tempfile::tempdir().unwrap();
    let petal = include_str!("../../jobs/petal.gcode");
    std::fs::write(folder.path().join("petal.gcode"), petal).unwrap();
    let load = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        Scenario::load(path.to_str().unwrap()).unwrap()
    };
    let whole = load("whole.toml", scenario);
    let bare = load("bare.toml", "job = 'petal.gcode'\n");
    assert_eq!(bare.mismatch, whole.mismatch);
    assert_eq!((bare.seed, bare.scale), (whole.seed, whole.scale));
    assert_eq!(bare.control_law, whole.control_law);
    let pid = load("pid.toml", "job = 'petal.gcode'\ncomputed_torque = false\n");
    assert_eq!(
        (whole.control_law, pid.control_law),
        (ControlLaw::ComputedTorque, ControlLaw::Pid)
    );
    assert_eq!(bare.robot, whole.robot);
    assert_eq!((bare.faults.len(), whole.faults.len()), (0, 1));
    assert_eq!(
        (bare.name.as_str(), whole.name.as_str()),
        ("bare", "worn supply")
    );
}

const SETTINGS: &str = include_str!("../../../../docs/use/settings.csv");
const FAULTS: &str = include_str!("../../../../docs/use/scenario_faults.csv");
const PLAUSIBLE: &str = include_str!("../../../../docs/use/plausible_values.csv");

/// The table of the settings.
fn table() -> String {
    let mut lines = csv::Writer::from_writer(Vec::new());
    let mut write = |row: [&str; 3]| lines.write_record(row).unwrap();
    write(["key", "unit", "what it must be"]);
    for row in rows().filter(|row| !row.key.is_empty()) {
        let Row {
            key, unit, must, ..
        } = row;
        // The heading says that a value must be so, and the unit has a column of its own.
        let must = must.to_string();
        let must = ["must lie in ", "must be "]
            .into_iter()
            .find_map(|start| must.strip_prefix(start))
            .unwrap_or(&must);
        let with_unit = format!(" {unit}");
        let must = must.strip_suffix(&with_unit).unwrap_or(must);
        write([key, unit, &must.replace('`', "")]);
    }
    String::from_utf8(lines.into_inner().unwrap()).unwrap()
}

#[test]
fn the_documents_have_the_table_of_the_settings() {
    keep("use/settings.csv", SETTINGS, &table());
}

/// The rows of a table, without its heading.
fn rows_of(table: &'static str) -> Vec<csv::StringRecord> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    reader.records().map(Result::unwrap).collect()
}

/// A scenario is read with each fault of the table and the keys that it needs, and with no key less.
#[test]
fn the_faults_of_a_scenario_need_the_keys_of_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let petal = include_str!("../../jobs/petal.gcode");
    std::fs::write(folder.path().join("petal.gcode"), petal).unwrap();
    let [robot, drives, sections, _] = examples();
    let whole = [robot, drives, sections].concat();
    std::fs::write(folder.path().join("whole.toml"), whole).unwrap();
    let path = folder.path().join("scenario.toml");
    let load = |kind: &str, keys: &[&str]| {
        // The document's arm has a brake and a belt.
        let robot = match kind.split('_').next() {
            Some("can") => "leg",
            Some("step" | "phase") => "benchtop_stepper",
            _ => "whole.toml",
        };
        let lines = keys.iter().map(|&key| match key {
            "pressed" | "high" => format!("{key} = true\n"),
            "gain" | "share" | "amperes" | "volts" | "kilograms" | "seconds" => {
                format!("{key} = 0.5\n")
            }
            _ => format!("{key} = 1\n"),
        });
        let lines: String = lines.collect();
        let job = format!("robot = '{robot}'\njob = 'petal.gcode'\norigin = [0.03, 0.16]");
        let text = format!("{job}\n[[fault]]\nat = 0.1\nkind = '{kind}'\n{lines}");
        std::fs::write(&path, text).unwrap();
        Scenario::load(path.to_str().unwrap())
    };
    let unknown = load("none", &[]).unwrap_err().to_string();
    for row in rows_of(FAULTS) {
        let (kind, needs) = (&row[0], row[1].split_whitespace().collect::<Vec<_>>());
        assert_eq!(load(kind, &needs).expect(kind).faults.len(), 1);
        for &key in &needs {
            let others: Vec<_> = needs.iter().copied().filter(|&it| it != key).collect();
            let error = load(kind, &others).unwrap_err().to_string();
            assert!(error.contains("is missing"), "{kind}, {key}: {error}");
        }
    }
    // A refusal names every kind.
    let named = unknown.split('`').filter(|name| name.contains('_')).count();
    assert_eq!(rows_of(FAULTS).len(), named, "{unknown}");
}

/// The keys of the table of plausible values are keys of a robot file.
#[test]
fn the_plausible_values_are_of_keys_that_there_are() {
    let [robot, drives, sections, _] = examples();
    let template = [robot, drives, sections].concat();
    for row in rows_of(PLAUSIBLE) {
        let (keys, _) = row[0].split_once(" of ").unwrap_or((&row[0], ""));
        for key in keys.split(", ").filter(|key| !key.starts_with('[')) {
            let key = key.split(' ').next().unwrap();
            let assigned = format!("{key} = ");
            let there = |line: &str| line.trim_start_matches(['#', ' ']).starts_with(&assigned);
            let of_slider = row[0].starts_with("of a slider");
            assert!(of_slider || template.lines().any(there), "{key}");
        }
    }
}

/// Holds a file of docs to this text. With `FIVEBAR_UPDATE` in the environment, it is written anew instead.
pub(crate) fn keep(name: &str, old: &str, new: &str) {
    if std::env::var_os("FIVEBAR_UPDATE").is_some() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs");
        std::fs::write(format!("{folder}/{name}"), new).unwrap();
    } else {
        let hint = "FIVEBAR_UPDATE=1 cargo test -p fivebar-files --test files writes it anew";
        assert!(new == old, "docs/{name} is not up to date; {hint}");
    }
}
