//! Queries for a slider-driven mechanism, and its robot file.

use fivebar_files::robot::{Mechanism, Robot, SliderRobot};
use fivebar_report::study::query::{serve, slider};
use serde_json::{Value, json};

const FILE: &str = include_str!("../../../files/robots/slider.toml");

fn ask_of(robot: &str, questions: &[Value]) -> Vec<Value> {
    let robot = SliderRobot::parse("slider.toml", robot).unwrap();
    let lines: String = questions.iter().map(|line| format!("{line}\n")).collect();
    let mut output = Vec::new();
    serve(lines.as_bytes(), &mut output, &slider::KEYS, |request| {
        slider::answer(&robot, request)
    })
    .unwrap();
    let text = String::from_utf8(output).unwrap();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

fn ask(question: Value) -> Value {
    ask_of(FILE, &[question]).remove(0)
}

fn number(answer: &Value, key: &str) -> f64 {
    answer[key]
        .as_f64()
        .unwrap_or_else(|| panic!("{key} in {answer}"))
}

fn pair(answer: &Value, key: &str) -> [f64; 2] {
    serde_json::from_value(answer[key].clone()).unwrap_or_else(|_| panic!("{key} in {answer}"))
}

#[track_caller]
fn assert_close(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-9, "{a} for {b}");
}

#[test]
fn forward_is_the_inverse_of_inverse() {
    // sin α7 = 0.66/1.1 = 0.6, hence x8 = 0.3 + 0.88.
    let inverse = ask(json!({"op": "inverse", "p": [0.0, 0.66]}));
    assert_close(number(&inverse, "x8"), 1.18);
    assert_eq!(inverse["assembly"], "left");
    let forward = ask(json!({
        "op": "forward", "x2": inverse["x2"], "x8": inverse["x8"], "assembly": inverse["assembly"],
    }));
    assert_close(pair(&forward, "p")[0], 0.0);
    assert_close(pair(&forward, "p")[1], 0.66);
    assert_eq!(
        (&forward["left"], &forward["right"]),
        (&json!("behind"), &json!("ahead"))
    );
    assert_close(number(&forward, "alpha3"), number(&inverse, "alpha3"));

    let folded = ask(json!({"op": "inverse", "p": [0.0, 0.66], "left": "ahead", "right": "ahead"}));
    assert_close(number(&folded, "x2"), -number(&inverse, "x2") - 0.6);
}

#[test]
fn the_motion_matches_finite_differences_and_its_inverse() {
    let motion = |t: f64| {
        ask(json!({
            "op": "motion", "assembly": "left",
            "x2": -1.2 + 0.3 * t + 0.5 * t * t, "x2_velocity": 0.3 + t, "x2_acceleration": 1.0,
            "x8": 1.1 - 0.2 * t, "x8_velocity": -0.2, "x8_acceleration": 0.0,
        }))
    };
    let (before, now, after) = (motion(-1e-4), motion(0.0), motion(1e-4));
    for axis in 0..2 {
        for (of, rate) in [("p", "p_velocity"), ("p_velocity", "p_acceleration")] {
            let difference = (pair(&after, of)[axis] - pair(&before, of)[axis]) / 2e-4;
            assert!((difference - pair(&now, rate)[axis]).abs() < 1e-6);
            assert!(difference.abs() > 1e-3);
        }
    }
    let back = ask(json!({
        "op": "inverse_motion", "p": now["p"],
        "p_velocity": now["p_velocity"], "p_acceleration": now["p_acceleration"],
    }));
    for (key, value) in now.as_object().unwrap() {
        if let Some(value) = value.as_f64() {
            assert_close(number(&back, key), value);
        }
    }
}

#[test]
fn the_error_transfer_holds_for_fixed_sliders() {
    let place = json!({"op": "error_transfer", "x2": -1.2, "x8": 1.1, "assembly": "left"});
    let transfer = ask(place);
    let p = |file: &str| {
        let question = json!({"op": "forward", "x2": -1.2, "x8": 1.1, "assembly": "left"});
        pair(&ask_of(file, &[question])[0], "p")
    };
    for (key, value) in [("left_link", 1.2), ("right_link", 1.1), ("platform", 0.6)] {
        let with = |by: f64| {
            let line = format!("{key} = {value}");
            assert!(FILE.contains(&line));
            p(&FILE.replace(&line, &format!("{key} = {}", value + by)))
        };
        let (before, after) = (with(-1e-6), with(1e-6));
        for axis in 0..2 {
            let difference = (after[axis] - before[axis]) / 2e-6;
            assert!((difference - pair(&transfer, key)[axis]).abs() < 1e-8);
        }
    }
    // If both sliders shift by the same distance, P shifts by that distance.
    for axis in 0..2 {
        let both = pair(&transfer, "x2")[axis] + pair(&transfer, "x8")[axis];
        assert_close(both, [1.0, 0.0][axis]);
    }
}

#[test]
fn queries_without_solution_get_their_error_kind() {
    let kinds = ask_of(
        FILE,
        &[
            json!({"op": "inverse", "p": [0.0, 1.15]}),
            json!({"op": "forward", "x2": 0.0, "x8": 5.0, "assembly": "left"}),
            json!({"op": "reach", "y": 0.05}),
            json!({"op": "motion", "x2": -1.5, "x8": 1.4, "assembly": "left", "x2_velocity": 0.1,
                   "x8_velocity": 0.0, "x2_acceleration": 0.0, "x8_acceleration": 0.0}),
            json!({"op": "inverse_motion", "p": [0.0, 1.1], "p_velocity": [0.0, 1.0],
                   "p_acceleration": [0.0, 0.0]}),
            json!({"op": "inverse_dynamics"}),
            json!({"op": "forward", "x2": 0.0}),
        ],
    );
    let message: Vec<_> = kinds
        .iter()
        .map(|k| k["error"].as_str().unwrap_or("none"))
        .collect();
    let expected = [
        "unreachable",
        "unreachable",
        "none",
        "singular",
        "singular",
        "invalid",
        "invalid",
    ];
    // In the fourth pose the limbs and the platform are in line: 2.9 m = 1.2 + 1.1 + 0.6.
    assert_eq!(message, expected, "{kinds:?}");
    let [least, greatest] = pair(&kinds[2], "x");
    assert!(least < greatest);
    let untravelled = FILE.split("[travel]").next().unwrap();
    let reach = ask_of(untravelled, &[json!({"op": "reach", "y": 0.5})]);
    assert!(
        reach[0]["message"]
            .as_str()
            .unwrap()
            .contains("no [travel]")
    );
}

#[test]
fn the_mechanism_follows_from_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("slider.toml");
    std::fs::write(&path, FILE).unwrap();
    let path = path.to_str().unwrap();
    assert!(matches!(Mechanism::load(path), Ok(Mechanism::Slider(_))));
    assert!(matches!(
        Mechanism::load("benchtop"),
        Ok(Mechanism::FiveBar(_))
    ));
    let refused = Robot::load(path).unwrap_err().to_string();
    assert!(
        refused.contains("line 2: `mechanism` is \"slider\""),
        "{refused}"
    );
}

#[test]
fn invalid_mechanisms_are_refused_with_their_line() {
    for (from, to, message) in [
        (
            "left_link = 1.2 ",
            "left_link = -1.2 ",
            "line 4: `left_link` cannot make a mechanism",
        ),
        (
            "platform = 0.6",
            "platform = nan",
            "line 6: `platform` cannot make a mechanism",
        ),
        (
            "right_link",
            "rigth_link",
            "line 5: unknown field `rigth_link`",
        ),
        ("\"ahead\"]", "\"up\"]", "unknown variant `up`"),
        (
            "[-1.6, -0.5]",
            "[-0.5, -1.6]",
            "line 10: `left` of [travel] must be two finite numbers",
        ),
        ("\"slider\"\nleft", "\"\"\nleft", "`name` must not be empty"),
    ] {
        assert!(FILE.contains(from), "{from}");
        let error = SliderRobot::parse("f.toml", &FILE.replace(from, to)).unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
    }
}
