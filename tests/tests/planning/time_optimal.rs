//! Time-optimal runs along six paths: times, speeds and torques.

use fivebar_files::path_case::PathCase;
use fivebar_files::robot::Robot;
use fivebar_report::study::plan::PlanStudy;
use serde_json::{Value, json};

fn cases() -> Vec<Value> {
    let text = include_str!("../../data/topp_public.json");
    let all: Value = serde_json::from_str(text).unwrap();
    all["cases"].as_array().unwrap().clone()
}

fn plan(case: &Value) -> PlanStudy {
    let robot = Robot::load(case["robot"].as_str().unwrap()).unwrap();
    let case = PathCase::parse("case.json", &case.to_string()).unwrap();
    PlanStudy::new(&robot, &case, 1.0, None).unwrap()
}

fn numbers(values: &Value) -> Vec<f64> {
    let values = values.as_array().unwrap().iter();
    values.map(|value| value.as_f64().unwrap()).collect()
}

#[test]
fn the_times_are_those_of_three_other_solvers() {
    let cases = cases();
    assert_eq!(cases.len(), 6);
    for case in &cases {
        let (found, name) = (plan(case).time(), &case["name"]);
        let expected = case["optimal_time_s"].as_f64().unwrap();
        assert!(
            (found / expected - 1.0).abs() < 1e-4,
            "{name}: {found} s, not {expected} s"
        );
        for (solver, time) in case["cross_checks_s"].as_object().unwrap() {
            let time = time.as_f64().unwrap();
            assert!(
                (found / time - 1.0).abs() < 3e-3,
                "{name}: {found} s, {solver} {time} s"
            );
        }
    }
}

#[test]
fn speed_and_time_are_the_reference_s_all_along_the_path() {
    for case in cases() {
        let plan = plan(&case);
        let runs = &plan.runs;
        let expected = case["runs"].as_array().unwrap();
        assert_eq!(runs.len(), expected.len());
        for (run, expected) in runs.iter().zip(expected) {
            let (rates, times) = (numbers(&expected["sdot"]), numbers(&expected["t"]));
            let fastest = rates.iter().copied().fold(0.0, f64::max);
            // Every fifth of 201 places is one of 41.
            let every = (run.samples.len() - 1) / (rates.len() - 1);
            for (k, (rate, time)) in rates.iter().zip(&times).enumerate() {
                let sample = run.samples[every * k];
                let name = &case["name"];
                assert!(
                    (sample.s_dot - rate).abs() < 1.5e-4 * fastest,
                    "{name} at {}",
                    sample.s
                );
                assert!(
                    (sample.t - time).abs() < 3e-4 * run.time,
                    "{name} at {}",
                    sample.s
                );
            }
        }
    }
}

#[test]
fn some_limit_is_always_active_and_none_is_passed() {
    for case in cases() {
        let (study, name) = (plan(&case), &case["name"]);
        assert!(
            study.active_share() > 0.98,
            "{name}: {}",
            study.active_share()
        );
        assert!(
            study.limit_excess() < 5e-3,
            "{name}: {}",
            study.limit_excess()
        );
        let limits = numbers(&case["limits"]["torque"]);
        for sample in study.runs.iter().flat_map(|run| &run.samples) {
            for (torque, limit) in sample.torque.iter().zip(&limits) {
                assert!(
                    torque.abs() <= 1.005 * limit,
                    "{name}: {torque} N·m at {}",
                    sample.s
                );
            }
        }
    }
}

#[test]
fn less_torque_takes_more_time_and_a_gravity_in_the_case_replaces_the_robot_s() {
    let case = &cases()[4];
    let robot = Robot::load("benchtop").unwrap();
    let upright = PathCase::parse("case.json", &case.to_string()).unwrap();
    let level = PathCase {
        gravity: Some([0.0; 2]),
        ..upright.clone()
    };
    let robots_own = PathCase {
        gravity: None,
        ..upright.clone()
    };
    let time =
        |case: &PathCase, share: f64| PlanStudy::new(&robot, case, share, None).unwrap().time();
    assert_eq!(time(&level, 1.0), time(&robots_own, 1.0));
    assert!((time(&level, 1.0) / time(&upright, 1.0) - 1.0).abs() > 1e-3);
    assert!(time(&upright, 0.7) > 1.1 * time(&upright, 1.0));
    let loaded = PathCase {
        payload: Some(0.3),
        ..upright.clone()
    };
    assert!(time(&loaded, 1.0) > 1.1 * time(&upright, 1.0));
}

#[test]
fn limits_of_jerk_cost_little_more_than_the_optimum() {
    // Optima by direct transcription in time, 150 steps, IPOPT [s].
    let optima = [
        ("line", [0.1166, 0.1201]),
        ("circle", [0.1871, 0.1900]),
        ("eight_upright", [0.2985, 0.3025]),
    ];
    let robot = Robot::load("benchtop").unwrap();
    for (name, optima) in optima {
        let cases = cases();
        let case = cases.iter().find(|case| case["name"] == name).unwrap();
        let case = PathCase::parse("case.json", &case.to_string()).unwrap();
        for (jerk, optimum) in [2e5, 1e5].into_iter().zip(optima) {
            let study = PlanStudy::new(&robot, &case, 1.0, Some(jerk)).unwrap();
            let ratio = study.time() / optimum;
            assert!((0.99..1.08).contains(&ratio), "{name} at {jerk}: {ratio}");
            assert!(study.limit_excess() < 1e-9);
        }
    }
}

#[test]
fn a_limit_of_jerk_is_refused_where_the_curvature_jumps() {
    let robot = Robot::load("benchtop").unwrap();
    let case = PathCase::parse("case.json", &cases()[3].to_string()).unwrap();
    let error = PlanStudy::new(&robot, &case, 1.0, Some(1e5))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("s = 0.022") && error.contains("curvature"),
        "{error}"
    );
}

#[test]
fn blended_corners_give_the_rounded_square_of_the_reference() {
    // Arcs of 8 mm pass a corner of a square at 8 mm · (√2 − 1).
    let tolerance = 8e-3 * (2.0_f64.sqrt() - 1.0);
    let rounded = &cases()[3];
    let corners = [
        [0.04, 0.13],
        [0.07, 0.13],
        [0.07, 0.19],
        [0.01, 0.19],
        [0.01, 0.13],
        [0.04, 0.13],
    ];
    let lines = corners.windows(2);
    let lines: Vec<Value> = lines
        .map(|ends| json!({ "kind": "line", "from": ends[0], "to": ends[1] }))
        .collect();
    let mut case = rounded.clone();
    case["path"] = json!(lines);
    let sharp = plan(&case).time();
    case["corners"] = json!("blend");
    case["corner_tolerance"] = json!(tolerance);
    let (found, expected) = (
        plan(&case).time(),
        rounded["optimal_time_s"].as_f64().unwrap(),
    );
    assert!(
        (found / expected - 1.0).abs() < 1e-4,
        "{found} s, not {expected} s"
    );
    assert!(sharp > found);
    case["corner_tolerance"] = Value::Null;
    let error = PathCase::parse("case.json", &case.to_string()).unwrap_err();
    assert!(error.to_string().contains("corner_tolerance"), "{error}");
}
