//! Accuracy from the robot file to the figures: the literature's example, analysis against
//! samples, and the cheapest tolerances.

use fivebar_design::accuracy::Sampling;
use fivebar_design::accuracy::allocation::ToleranceClass;
use fivebar_design::accuracy::five_bar::{
    AccuracyAnalysis, ToolState, cheapest_classes, monte_carlo,
};
use fivebar_files::robot::Robot;
use fivebar_report::study::accuracy::{accuracy_map, analyse, answer};
use nalgebra::Vector2;
use proptest::prelude::*;
use serde_json::Value;

const LINK: &str = "[[link]]\nlength = 0.23\nmass = 0.12\ncom = [0.1, 0.0]\ninertia = 5e-4\n";
const TOLERANCE: &str =
    "[tolerance]\nlength_sd = 20e-6\ninput_max = 2e-4\nclearance_radius = 10e-6\n";

/// All links .23 m on a base of .275 m.
fn example() -> Robot {
    let head = "name = \"example\"\ngravity = [0.0, -9.81]\nbase = 0.275\npayload = 0.0\n";
    let text = format!("{head}{}{TOLERANCE}", LINK.repeat(4));
    Robot::parse("example.toml", &text).unwrap()
}

fn at(x: f64, y: f64) -> ToolState {
    ToolState::at_rest(Vector2::new(x, y))
}

fn study(robot: &Robot, state: &ToolState, samples: usize) -> (AccuracyAnalysis, Value) {
    let analysis = analyse(robot, state).unwrap();
    let sampling = Sampling { samples, seed: 5 };
    let sampled = monte_carlo(&robot.toleranced(), state, &analysis, sampling, &|_| ());
    let found = answer(&robot.name, state, &analysis, &sampled);
    (analysis, found)
}

#[test]
fn the_example_of_the_literature_to_all_printed_digits() {
    let (_, found) = study(&example(), &at(0.1375, 0.25), 1000);
    let microns = |value: &Value| (value.as_f64().unwrap() * 1e8).round() / 100.0;
    assert_eq!(microns(&found["position_sd_m"][0]), 14.72);
    assert_eq!(microns(&found["position_sd_m"][1]), 106.05);
    assert_eq!(microns(&found["input_worst_m"]), 271.38);
    assert_eq!(microns(&found["clearance_worst_linear_m"]), 151.18);
    assert_eq!(microns(&found["clearance_worst_m"]), 151.47);
    assert_eq!(microns(&found["clearance_rms_m"]), 48.45);
}

/// Every figure against the same figure by sampling: scatters agree within 4 sampling errors (and
/// 1 % for the terms of higher order), and samples stay within the worst cases.
fn compare(found: &Value) {
    let twins = &found["monte_carlo"];
    let error = 4.0 * twins["relative_error_of_sd"].as_f64().unwrap() + 0.01;
    let numbers = |value: &Value| {
        let mut list = Vec::new();
        let mut open = vec![value.clone()];
        while let Some(value) = open.pop() {
            match value {
                Value::Array(items) => open.extend(items),
                Value::Object(items) => open.extend(items.into_iter().map(|(_, item)| item)),
                Value::Number(number) => list.push(number.as_f64().unwrap()),
                _ => {}
            }
        }
        list
    };
    for key in [
        "position_sd_m",
        "velocity_sd_m_s",
        "acceleration_sd_m_s2",
        "torque_sd_nm",
        "reaction_sd_n",
        "clearance_rms_m",
    ] {
        let (analytic, sampled) = (numbers(&found[key]), numbers(&twins[key]));
        assert_eq!(analytic.len(), sampled.len());
        assert!(!analytic.is_empty());
        let scale = analytic.iter().fold(0.0_f64, |m, x| m.max(*x));
        for (a, s) in analytic.iter().zip(&sampled) {
            assert!(
                (a - s).abs() <= error * a + 1e-3 * scale,
                "{key}: {a} and {s}"
            );
        }
    }
    for key in [
        "input_worst_m",
        "clearance_worst_m",
        "clearance_worst_linear_m",
    ] {
        let (worst, largest) = (found[key].as_f64().unwrap(), twins[key].as_f64().unwrap());
        assert!(
            largest <= worst * (1.0 + 1e-9) && largest > 0.5 * worst,
            "{key}: {largest} of {worst}"
        );
    }
    let shares = |list: &Value| -> Vec<f64> {
        let list = list.as_array().unwrap();
        list.iter().map(|c| c["share"].as_f64().unwrap()).collect()
    };
    let (analytic, sampled) = (
        shares(&found["contributors"]),
        shares(&twins["contributors"]),
    );
    assert!((analytic.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    for (a, s) in analytic.iter().zip(sampled) {
        assert!((a - s).abs() < 0.03, "{a} and {s}");
    }
}

#[test]
fn analysis_and_samples_agree_on_the_example_in_motion() {
    let state = ToolState {
        velocity: Vector2::new(0.3, -0.2),
        acceleration: Vector2::new(-2.0, 5.0),
        force: Vector2::new(1.0, 2.0),
        ..at(0.1, 0.28)
    };
    compare(&study(&example(), &state, 40_000).1);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn analysis_and_samples_agree_at_random_poses(x in 0.0..0.275_f64, y in 0.15..0.33_f64) {
        let robot = example();
        let clear = |analysis: &AccuracyAnalysis| analysis.pose.nearest_singularity().1 > 0.3;
        prop_assume!(analyse(&robot, &at(x, y)).is_ok_and(|analysis| clear(&analysis)));
        compare(&study(&robot, &at(x, y), 10_000).1);
    }
}

#[test]
fn a_point_out_of_reach_is_refused_with_the_place() {
    let refusal = analyse(&example(), &at(2.0, 0.0)).unwrap_err();
    assert!(
        refusal.to_string().starts_with("at (2, 0) m: "),
        "{refusal}"
    );
}

#[test]
fn the_cheapest_tolerances_hold_what_was_wanted() {
    let robot = example();
    let map = accuracy_map(&robot, Vector2::zeros(), Some([0.05, 0.2, 0.2, 0.3])).unwrap();
    let class = |deviation, cost| ToleranceClass { deviation, cost };
    let inputs = [class(2e-4, 1.0), class(5e-5, 4.0)];
    let lengths = [class(50e-6, 1.0), class(20e-6, 3.0), class(5e-6, 10.0)];
    let coarse = cheapest_classes(&map, 2e-3, &inputs, &lengths).unwrap();
    assert_eq!(coarse.cost, 7.0);
    let fine = cheapest_classes(&map, 300e-6, &inputs, &lengths).unwrap();
    assert!(fine.cost > coarse.cost);
    assert!(fine.worst_variance.sqrt() <= 300e-6);
    assert_eq!(cheapest_classes(&map, 1e-6, &inputs, &lengths), None);
}
