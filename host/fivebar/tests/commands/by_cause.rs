//! `fivebar sim --by-cause`: the same run with each mismatch alone.

use fivebar_testkit::program;
use serde_json::Value;

const PETAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/jobs/petal.gcode");

#[test]
fn each_mismatch_has_a_run_of_its_own_in_the_table_the_bars_and_the_json() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("case.toml");
    let text = format!(
        "job = '{PETAL}'\n[mismatch]\nlink_mass = 0\nfriction = 0.3\npayload = 0\n\
         current_noise = 0\ncurrent_offset = 0\nhome_error = [1e-3, 0]\n\
         stiffness = [5000, 5000]\ndrive_damping = [0.02, 0.02]\n"
    );
    std::fs::write(&file, text).unwrap();
    let run = |options: &[&str]| {
        let output = program(env!("CARGO_BIN_EXE_fivebar"))
            .args(["sim", "case.toml", "--by-cause"])
            .args(options)
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let summary: Value = serde_json::from_str(run(&["--json"]).trim()).unwrap();
    let causes = summary["by_cause"].as_array().unwrap();
    let names: Vec<_> = causes
        .iter()
        .map(|c| c["cause"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        ["none", "friction", "home_error", "stiffness", "all"]
    );
    let rms = |cause: usize| causes[cause]["tip_error"]["rms_m"].as_f64().unwrap();
    // A switch off by 1 mrad moves the tip by about 0.1 mm; without mismatch little is left.
    assert!(rms(0) < 5e-6 && rms(1) > rms(0), "{causes:?}");
    assert!((5e-5..3e-4).contains(&rms(2)), "{causes:?}");
    assert_eq!(causes[4]["tip_error"], summary["tip_error"]);
    assert!(rms(4) > 5e-5);
    assert!(
        causes
            .iter()
            .all(|cause| cause["faults"] == Value::Array(vec![]))
    );
    let printed = run(&[]);
    let report = std::fs::read_to_string(folder.path().join("out/sim/report.html")).unwrap();
    for name in names {
        assert!(
            printed.lines().any(|line| line.trim().starts_with(name)),
            "{printed}"
        );
        assert!(report.contains(&format!("<td>{name}</td>")), "{name}");
        assert!(report.contains(&format!(">{name}</text>")), "{name}");
    }
    assert!(report.contains("Tip error by cause"));
}
