//! A refusal names keys that the file has, and numbers that a reader understands.

use fivebar_files::robot::{BUILT_IN, Robot};

/// Each number of a robot file of every kind of drive in turn is replaced by one that makes no sense.
#[test]
fn refusals_name_only_keys_that_the_file_has() {
    let mut refused = 0;
    let kinds = ["benchtop", "benchtop_stepper", "leg", "classroom_servo"];
    for built_in in BUILT_IN.iter().filter(|it| kinds.contains(&it.name)) {
        let lines: Vec<&str> = built_in.text.lines().collect();
        for (at, line) in lines.iter().enumerate() {
            let Some((key, value)) = line.split_once(" = ") else {
                continue;
            };
            let value = value.split('#').next().unwrap_or_default().trim();
            if value.parse::<f64>().is_err() {
                continue;
            }
            for wrong in ["0.0", "-1.0", "nan", "1e300"] {
                let changed = format!("{key} = {wrong}");
                let mut text = lines.clone();
                text[at] = &changed;
                let text = text.join("\n");
                let Err(error) = Robot::parse("arm.toml", &text) else {
                    continue;
                };
                refused += 1;
                for refusal in error.to_string().lines() {
                    let named = refusal
                        .split_once(": `")
                        .and_then(|(_, rest)| rest.split_once('`'));
                    let Some((name, _)) = named else { continue };
                    assert!(
                        text.contains(&format!("{name} = ")) || refusal.contains("missing"),
                        "{}: {changed}: {refusal}",
                        built_in.name
                    );
                }
            }
        }
    }
    assert!(refused > 200, "{refused}");
}

#[test]
fn a_rated_current_of_zero_is_one_refusal_for_each_motor() {
    let text = BUILT_IN
        .iter()
        .find(|robot| robot.name == "benchtop_stepper");
    let text = text
        .unwrap()
        .text
        .replace("rated_current = 1.7", "rated_current = 0.0");
    let error = Robot::parse("arm.toml", &text).unwrap_err().to_string();
    assert_eq!(error.lines().count(), 2, "{error}");
    assert!(
        error.lines().all(|line| line.contains("`rated_current`")),
        "{error}"
    );
}
