//! `fivebar sim` with a current sensor or an encoder that fails.

use crate::bench::Bench;

const PETAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/jobs/petal.gcode");

#[test]
fn hobby_servos_draw_in_the_simulation() {
    let bench = Bench::new();
    let output = bench.sim(&[PETAL, "--robot", "classroom_servo"]);
    let text = String::from_utf8_lossy(&output.stdout);
    let stated = "servos      dead band 1.57 mm with a straight leg, late by up to 36.8 ms";
    assert!(text.contains(stated), "{text}");
}

/// The bridges wake up for 1.6 ms, and the job begins at its own time.
#[test]
fn a_current_sensor_or_an_encoder_that_fails_ends_the_run_with_its_own_fault_in_time() {
    let bench = Bench::new();
    let fault = |kind: &str| format!("[[fault]]\nat = 0.4\nkind = {kind}");
    let cases = [
        (
            "[wiring]\ncurrent_dead = [true, false]".into(),
            "23, current sensor",
            0.0,
            0.0216,
        ),
        (
            "[wiring]\ncurrent_dead = [false, true]".into(),
            "23, current sensor",
            0.0,
            0.0216,
        ),
        (
            fault("\"current_dead\"\njoint = 1"),
            "23, current sensor",
            0.4,
            0.02,
        ),
        (
            fault("\"current_gain\"\njoint = 4\ngain = -1.0"),
            "23, current sensor",
            0.4,
            0.02,
        ),
        (
            fault("\"current_gain\"\njoint = 1\ngain = 0.0"),
            "23, current sensor",
            0.4,
            0.02,
        ),
        (
            fault("\"current_stuck\"\njoint = 4\namperes = 0.3"),
            "23, current sensor",
            0.4,
            0.02,
        ),
        (
            fault("\"current_offset\"\njoint = 4\namperes = 0.5"),
            "23, current sensor",
            0.4,
            0.02,
        ),
        (
            fault("\"encoder_dead\"\njoint = 4"),
            "24, encoder stuck",
            0.4,
            0.008,
        ),
    ];
    for (lines, name, from, within) in cases {
        let file = bench.path("failing.toml");
        std::fs::write(&file, format!("job = {PETAL:?}\n{lines}\n")).unwrap();
        let output = bench.sim(&[file.to_str().unwrap()]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{lines}: {message}");
        assert!(
            message.contains(&format!("with fault {name}")),
            "{lines}: {message}"
        );
        let at = message
            .split("stopped ")
            .nth(1)
            .and_then(|rest| rest.split(' ').next());
        let after = at.unwrap().parse::<f64>().unwrap() - from;
        println!("{lines}: after {:.1} ms", 1e3 * after);
        assert!(after <= within, "{lines}: {after} s");
    }
}

#[test]
fn a_gain_of_a_current_sensor_that_is_no_number_is_refused() {
    let bench = Bench::new();
    let file = bench.path("failing.toml");
    for (gain, words) in [
        ("nan", ["`gain`", "finite"]),
        ("\"half\"", ["`gain`", "number"]),
    ] {
        let text = format!(
            "job = {PETAL:?}\n[[fault]]\nkind = \"current_gain\"\njoint = 1\ngain = {gain}\n"
        );
        std::fs::write(&file, text).unwrap();
        let output = bench.sim(&[file.to_str().unwrap()]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
}
