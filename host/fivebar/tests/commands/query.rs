//! The command `fivebar query` as scripts use it, over pipes.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;

const VECTORS: &str = include_str!("../../../../tests/data/five_bar_vectors.json");

/// The robot file of one of the reference robots.
fn robot_file(robot: &Value) -> String {
    let lengths = robot["link_lengths"].as_array().unwrap();
    let mut text = format!(
        "name = {}\ngravity = {}\nbase = {}\npayload = {}\n",
        robot["name"], robot["gravity"], lengths[4], robot["payload"]
    );
    for link in 0..4 {
        text += &format!(
            "[[link]]\nlength = {}\nmass = {}\ncom = {}\ninertia = {}\n",
            lengths[link],
            robot["mass"][link],
            robot["com"][link],
            robot["inertia_about_com"][link],
        );
    }
    text
}

/// The answers of `fivebar query` to these lines for this robot file.
fn ask(robot: &str, lines: &[String]) -> Vec<Value> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("robot.toml");
    std::fs::write(&file, robot).unwrap();
    let mut program = fivebar_testkit::program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["query", "--robot"])
        .arg(&file)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    // Each line is sent after the answer to the one before: answers must not be buffered.
    let mut questions = program.stdin.take().unwrap();
    let mut answers = BufReader::new(program.stdout.take().unwrap()).lines();
    let read = lines
        .iter()
        .map(|line| {
            writeln!(questions, "{line}").unwrap();
            let answer = answers.next().expect("an answer to every line").unwrap();
            serde_json::from_str(&answer).unwrap()
        })
        .collect();
    drop(questions);
    assert!(answers.next().is_none(), "one answer for each line");
    assert!(program.wait().unwrap().success());
    read
}

/// Asserts that `actual` has the same keys as `expected`, and equal numbers within 1e-9 of the
/// greatest in the same list.
#[track_caller]
fn assert_same(what: &str, actual: &Value, expected: &Value) {
    match (actual, expected) {
        (Value::Object(actual), Value::Object(expected)) => {
            let names = |object: &serde_json::Map<String, Value>| {
                let mut names: Vec<_> = object.keys().cloned().collect();
                names.sort();
                names
            };
            assert_eq!(names(actual), names(expected), "{what}");
            for (key, value) in expected {
                assert_same(&format!("{what}: {key}"), &actual[key], value);
            }
        }
        (Value::String(_), Value::String(_)) => assert_eq!(actual, expected, "{what}"),
        _ => {
            let (actual, expected) = (numbers(actual), numbers(expected));
            let scale = expected.iter().fold(1e-3_f64, |m, x| m.max(x.abs()));
            assert_eq!(actual.len(), expected.len(), "{what}");
            for (a, e) in actual.iter().zip(&expected) {
                assert!((a - e).abs() <= 1e-9 * scale, "{what}: {a} for {e}");
            }
        }
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        number => vec![number.as_f64().unwrap()],
    }
}

/// The part of an object with these keys.
fn only(object: &Value, keys: &[&str]) -> Value {
    keys.iter()
        .map(|&key| (key.to_owned(), object[key].clone()))
        .collect()
}

#[test]
fn every_op_matches_all_180_reference_states() {
    const STATE: [&str; 5] = ["theta1", "theta4", "omega1", "omega4", "assembly"];
    let ops: [(&str, Vec<&str>, Vec<&str>); 5] = [
        (
            "forward",
            vec!["theta1", "theta4", "assembly"],
            vec!["c", "theta2", "theta3", "elbow1", "elbow4"],
        ),
        (
            "inverse",
            vec!["c", "elbow1", "elbow4"],
            vec!["theta1", "theta4", "theta2", "theta3", "assembly"],
        ),
        (
            "motion",
            [&STATE[..], &["alpha1", "alpha4"]].concat(),
            vec![
                "c",
                "c_velocity",
                "c_acceleration",
                "omega2",
                "omega3",
                "alpha2",
                "alpha3",
            ],
        ),
        (
            "inverse_dynamics",
            [&STATE[..], &["alpha1", "alpha4", "external_force"]].concat(),
            vec!["torque", "mass_matrix", "bias_torque", "reaction"],
        ),
        (
            "forward_dynamics",
            [&STATE[..], &["torque", "external_force"]].concat(),
            vec!["alpha1", "alpha4"],
        ),
    ];
    let vectors: Value = serde_json::from_str(VECTORS).unwrap();
    let mut states = 0;
    for (index, robot) in vectors["robots"].as_array().unwrap().iter().enumerate() {
        let cases = vectors["cases"].as_array().unwrap();
        let cases: Vec<_> = cases.iter().filter(|case| case["robot"] == index).collect();
        states += cases.len();
        for (op, given, wanted) in &ops {
            let questions: Vec<_> = cases
                .iter()
                .map(|case| {
                    let mut question = only(case, given);
                    question["op"] = json!(op);
                    question.to_string()
                })
                .collect();
            let answers = ask(&robot_file(robot), &questions);
            for ((case, question), answer) in cases.iter().zip(&questions).zip(&answers) {
                assert_same(question, answer, &only(case, wanted));
            }
        }
    }
    assert_eq!(states, 180);
}

/// Four links of 0.23 m on a base of 0.275 m, without masses.
const TEXTBOOK: &str = "name = \"textbook\"\ngravity = [0.0, 0.0]\nbase = 0.275\n\
    [[link]]\nlength = 0.23\n[[link]]\nlength = 0.23\n\
    [[link]]\nlength = 0.23\n[[link]]\nlength = 0.23\n";

#[test]
fn a_query_without_solution_gets_an_error_kind_and_the_next_is_answered() {
    let meeting = (0.1375_f64 / 0.23).acos();
    let flat = (0.1375_f64 / 0.23 - 1.0).acos();
    let driven = |op: &str, theta1: f64| {
        json!({
            "op": op, "theta1": theta1, "theta4": std::f64::consts::PI - theta1,
            "omega1": 1.0, "omega4": 0.5, "alpha1": 0.0, "alpha4": 0.0, "assembly": "left",
        })
    };
    let inverse =
        |x: f64, y: f64| json!({"op": "inverse", "c": [x, y], "elbow1": "left", "elbow4": "right"});
    let asked = [
        (inverse(0.5, 0.5), "unreachable"),
        (inverse(0.0, 0.0), "singular"),
        (driven("forward", 3.0), "unreachable"),
        (driven("forward", meeting), "singular"),
        (driven("motion", flat), "singular"),
        (driven("motion", 1.0), ""),
        (driven("inverse_dynamics", 1.0), "invalid"),
        (
            json!({"op": "forward", "theta1": 1.0, "assembly": "left"}),
            "invalid",
        ),
        (
            json!({"op": "forward", "theta1": "1", "theta4": 2.0, "assembly": "left"}),
            "invalid",
        ),
        (
            json!({"op": "forward", "theta1": 1.0, "theta4": 2.0, "assembly": "up"}),
            "invalid",
        ),
        (
            json!({"op": "inverse", "c": [0.1], "elbow1": "left", "elbow4": "left"}),
            "invalid",
        ),
        (json!({"op": "fly"}), "invalid"),
        (json!({"theta1": 1.0}), "invalid"),
        (json!([1, 2]), "invalid"),
        (json!(null), "invalid"),
        (inverse(0.1375, 0.3), ""),
    ];
    let mut lines: Vec<_> = asked.iter().map(|(line, _)| line.to_string()).collect();
    let mut kinds: Vec<_> = asked.iter().map(|(_, kind)| *kind).collect();
    for text in [
        "",
        "   ",
        "{",
        "forward",
        r#"{"op":"inverse","c":[NaN,0.1],"elbow1":"left","elbow4":"left"}"#,
        r#"{"op":"inverse","c":[1e999,0.1],"elbow1":"left","elbow4":"left"}"#,
        r#"{"op":"inverse","c":[null,0.1],"elbow1":"left","elbow4":"left"}"#,
        r#"["inverse",[0.1375,0.3],"left","right"]"#,
    ] {
        lines.push(text.to_owned());
        kinds.push("invalid");
    }
    lines.push(inverse(0.1375, 0.3).to_string());
    kinds.push("");
    let answers = ask(TEXTBOOK, &lines);
    for ((line, kind), answer) in lines.iter().zip(kinds).zip(&answers) {
        if kind.is_empty() {
            assert!(answer.get("error").is_none(), "{line}: {answer}");
        } else {
            assert_eq!(answer["error"], kind, "{line}: {answer}");
            let message = answer["message"].as_str().unwrap();
            assert!(message.len() > 10, "{line}: {message}");
        }
    }
}

#[test]
fn a_point_on_the_rim_of_reach_is_answered() {
    let rim = json!({"op": "inverse", "c": [0.1375, (0.46_f64 * 0.46 - 0.1375 * 0.1375).sqrt()],
        "elbow1": "left", "elbow4": "left"});
    let answers = ask(TEXTBOOK, &[rim.to_string()]);
    assert!(answers[0]["theta1"].is_f64(), "{}", answers[0]);
}

#[test]
fn numbers_are_read_exactly() {
    // B and D coincide here, and the error contains the angle as it was read.
    let question = r#"{"op":"forward","theta1":0.9300098491833563,"theta4":2.211582804406437,
        "assembly":"left"}"#;
    let answers = ask(TEXTBOOK, &[question.replace('\n', " ")]);
    let message = answers[0]["message"].as_str().unwrap();
    assert!(message.contains("θ1 = 0.9300098491833563 rad"), "{message}");
}

#[test]
fn a_missing_robot_is_named_in_the_error() {
    let output = fivebar_testkit::program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["query", "--robot", "nowhere/none.toml"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("nowhere/none.toml"));
    assert!(output.stdout.is_empty());
}

#[test]
fn a_coaxial_arm_is_solved_both_ways() {
    let link = |length: f64| format!("[[link]]\nlength = {length}\n");
    let robot = |base: &str| {
        let links: String = [0.1, 0.16, 0.16, 0.1].map(link).concat();
        format!("name = \"leg\"\ngravity = [0.0, -9.81]\nbase = {base}\n{links}")
    };
    let inverse = json!({"op": "inverse", "c": [0.05, 0.15], "elbow1": "right", "elbow4": "left"});
    let inverse = &ask(&robot("0.0"), &[inverse.to_string()])[0];
    let forward = json!({
        "op": "forward", "theta1": inverse["theta1"], "theta4": inverse["theta4"],
        "assembly": inverse["assembly"],
    });
    // Cranks that point alike hold C nowhere.
    let alike = json!({"op": "forward", "theta1": 1.0, "theta4": 1.0, "assembly": "left"});
    let answers = ask(&robot("0"), &[forward.to_string(), alike.to_string()]);
    for (axis, expected) in [0.05, 0.15].into_iter().enumerate() {
        let found = answers[0]["c"][axis].as_f64().unwrap();
        assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
    }
    assert_eq!(answers[1]["error"], "singular");
}

#[test]
fn a_query_with_a_key_that_no_query_has_is_refused_with_the_nearest_one() {
    let forward = |key: &str| {
        json!({"op": "forward", "theta1": 2.0, "theta4": 1.0, "assembly": "left", key: "left"})
            .to_string()
    };
    // A reference state has the keys of other queries and of answers.
    let lines = [
        forward("elbw1"),
        forward("elbow1"),
        forward("robot"),
        forward("zzz"),
    ];
    let answers = ask(include_str!("../../../files/robots/benchtop.toml"), &lines);
    assert_eq!(answers[0]["error"], "invalid");
    assert_eq!(
        answers[0]["message"],
        "unknown key `elbw1`; did you mean `elbow1`?"
    );
    assert!(answers[1]["c"].is_array() && answers[2]["c"].is_array());
    assert_eq!(answers[3]["message"], "unknown key `zzz`");
    let slider = [r#"{"op":"inverse","p":[0.2,0.3],"letf":"positive"}"#.to_owned()];
    assert_eq!(
        ask(include_str!("../../../files/robots/slider.toml"), &slider)[0]["message"],
        "unknown key `letf`; did you mean `left`?"
    );
}
