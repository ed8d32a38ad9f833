//! Drives with backlash: an encoder at the joint sees what its loop lets out, one at the motor does not.

use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::safety::Fault;
use fivebar_report::text::{next_step, stopped_by};
use fivebar_sim::simulation::Simulate;

/// The row of docs/design/belts.md that begins with this cell: its numbers.
fn documented(first: &str) -> Vec<f64> {
    let text = include_str!("../../../docs/design/belts.md");
    let row = text
        .lines()
        .find(|line| line.starts_with(&format!("| {first} |")));
    let cells = row.unwrap_or_else(|| panic!("no row {first}")).split('|');
    cells.filter_map(|cell| cell.trim().parse().ok()).collect()
}

/// An arm whose encoders are at its joints or its motors, with a bandwidth in place of its own.
fn arm(robot: &str, at_joint: bool, bandwidth: Option<f64>) -> Robot {
    let mut text = BuiltIn::find(robot).expect("built in").text.to_owned();
    if at_joint {
        // As fine at the joint as a motor's behind its gear.
        let keys = "encoder_counts = 131072\nencoder_side = \"joint\"";
        text = text.replace("encoder_counts = 16384", keys);
    }
    if let Some(bandwidth) = bandwidth {
        text += &format!("[control]\nbandwidth = {bandwidth:?}\n");
    }
    Robot::parse("backlash.toml", &text).expect("a valid robot")
}

/// A row of the table: its name, the robot, whether its encoders are at the joints, and a bandwidth in place of its own.
type Row = (&'static str, &'static str, bool, Option<f64>);

#[test]
fn backlash_costs_little_with_encoders_at_the_joints_and_is_named_where_a_loop_swings_in_it() {
    assert_rows(&[
        ("joint, rigid", "benchtop", true, None),
        ("motor, rigid", "benchtop", false, None),
    ]);
}

#[test]
#[ignore = "half a minute: ./ci.sh tables"]
fn whole_table_of_backlash_on_belts_and_with_a_lower_bandwidth() {
    assert_rows(&[
        ("joint, belt", "benchtop_belt", true, None),
        ("motor, rigid, 150 rad/s", "benchtop", false, Some(150.0)),
        ("motor, belt", "benchtop_belt", false, None),
    ]);
}

fn assert_rows(rows: &[Row]) {
    for &(name, robot, at_joint, bandwidth) in rows {
        let figures = documented(name);
        let row = [0.0, 5e-4, 1e-3].map(|gap| {
            let mut scenario = Scenario::demonstration(arm(robot, at_joint, bandwidth));
            scenario.mismatch.backlash = [gap; 2];
            let job = scenario.job().expect("the demonstration");
            let (summary, record) = scenario.simulate(&job, &mut |_| ()).expect("it runs");
            if let [(_, fault), ..] = record.faults[..] {
                assert_eq!(fault, Fault::Oscillation, "{name}, {gap} rad");
                let said = stopped_by(&scenario, &record).expect("a fault");
                assert!(said.contains("backlash of "), "{said}");
                // On an arm whose backlash nobody knows, too.
                assert!(next_step(fault).contains("backlash"));
                return None;
            }
            Some(1e6 * summary.tip_error.rms_m)
        });
        println!("{name}: {row:.3?}");
        let seen: Vec<f64> = row.into_iter().flatten().collect();
        assert_eq!(
            seen.len(),
            figures.len(),
            "{name}: {seen:?}, not {figures:?}"
        );
        for (seen, documented) in seen.iter().zip(&figures) {
            let share = seen / documented;
            assert!(
                (share - 1.0).abs() < 0.03,
                "{name}: {seen}, not {documented}"
            );
        }
    }
}
