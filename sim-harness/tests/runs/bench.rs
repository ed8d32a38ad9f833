//! What a bench has besides, one effect at a time: its size at the tip, and what is left of it once it is compensated. The
//! figures are those of docs/design/bench.md.

use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_plant::{Harmonic, Harmonics, Mismatch, PULLEY_TEETH};
use fivebar_sim::learning::repeat;
use fivebar_sim::simulation::{Simulate, TipError};
use std::f64::consts::PI;

const DOCUMENT: &str = include_str!("../../../docs/design/bench.md");

/// The arms, and motor turns per joint turn. The last one is the leg with the current loops of drives whose file states none.
const ARMS: [(&str, f64); 4] = [
    ("benchtop", 8.0),
    ("benchtop_stepper", 4.0),
    ("leg", 3.0),
    ("leg of 1000 rad/s", 3.0),
];
/// Of the leg's drives at their joints [N·m].
const PEAK: f64 = 3.0 * 0.97;

/// 25 µm and 7.5 µm on the radius of 64 teeth, 20.4 mm.
const RUN_OUT: f64 = 1.2e-3;
const MESH: f64 = 3.7e-4;
/// 10 µm on 20.4 mm.
const GAP: f64 = 5e-4;
const GROWTH: [f64; 2] = [5e-3, 3e-3];

/// The mismatch of a bench, as the document has it.
fn bench(arm: &str) -> Mismatch {
    let on_bus = Mismatch {
        cogging: [0.03 * PEAK; 2],
        torque_ripple: [0.02; 2],
        ..Mismatch::NONE
    };
    Mismatch {
        pen_friction: 0.25,
        pulley_run_out: [RUN_OUT; 2],
        tooth_mesh: [MESH; 2],
        backlash: [GAP; 2],
        paper_growth: GROWTH,
        ..if arm.starts_with("leg") {
            on_bus
        } else {
            Mismatch::NONE
        }
    }
}

fn robot(name: &str) -> Robot {
    let (built_in, slow) = match name.strip_suffix(" of 1000 rad/s") {
        Some(built_in) => (built_in, true),
        None => (name, false),
    };
    let text = BuiltIn::find(built_in).unwrap().text;
    let bandwidth = if slow { "= 1000.0" } else { "= 3000.0" };
    let text = text.replace(
        "current_bandwidth = 3000.0",
        &format!("current_bandwidth {bandwidth}"),
    );
    Robot::parse(name, &text).unwrap()
}

fn demonstration(name: &str, mismatch: Mismatch) -> Scenario {
    let mut scenario = Scenario::demonstration(robot(name));
    scenario.fit().unwrap();
    scenario.mismatch = mismatch;
    scenario
}

/// The tip error of a run without faults [m].
fn error(scenario: &Scenario) -> TipError {
    let job = scenario.job().unwrap();
    let (summary, _) = scenario.simulate(&job, &mut |_| ()).unwrap();
    assert!(summary.faults.is_empty(), "{:?}", summary.faults);
    summary.tip_error
}

/// "RMS (max)" in micrometres.
fn text(error: &TipError) -> String {
    format!("{:.0} ({:.0})", 1e6 * error.rms_m, 1e6 * error.max_m)
}

/// What is left once an effect is compensated; none if nothing compensates it.
fn compensated(name: &str, gear: f64, cause: &str, alone: Mismatch) -> Option<String> {
    let harmonic = match cause {
        "pulley_run_out" => (1, RUN_OUT),
        "tooth_mesh" => (PULLEY_TEETH as u32, MESH),
        "paper_growth" => return Some(text(&scaled(name, alone))),
        "pen_friction" => {
            let takes_torque = name != "benchtop_stepper";
            return takes_torque.then(|| text(&fed_forward(name, alone)));
        }
        "cogging" | "torque_ripple" => return Some(text(&learnt(&demonstration(name, alone)))),
        _ => return None,
    };
    let takes_a_table = name != "benchtop_stepper";
    takes_a_table.then(|| text(&tabled(name, gear, harmonic, alone)))
}

/// With the job drawn smaller by the mean growth: what is seen, beside the job as it was meant, both from the first drawn
/// point on.
fn scaled(name: &str, alone: Mismatch) -> TipError {
    let mut scenario = demonstration(name, alone);
    let smaller = 1.0 / (1.0 + 0.5 * (GROWTH[0] + GROWTH[1]));
    scenario.scale *= smaller;
    let job = scenario.job().unwrap();
    let (summary, record) = scenario.simulate(&job, &mut |_| ()).unwrap();
    assert!(summary.faults.is_empty(), "{:?}", summary.faults);
    let drawn = record.trace.samples().iter();
    let drawn: Vec<_> = drawn.filter(|sample| sample.tool_level > 0.0).collect();
    let first = drawn[0];
    let errors = drawn.iter().map(|sample| {
        let [x, y] = [0, 1].map(|i| {
            let meant = (sample.reference[i] - first.reference[i]) / smaller;
            sample.tool[i] - first.tool[i] - meant
        });
        x.hypot(y)
    });
    let (squares, greatest) = errors.fold((0.0, 0.0_f64), |(squares, greatest), error| {
        (squares + error * error, greatest.max(error))
    });
    TipError {
        rms_m: (squares / drawn.len() as f64).sqrt(),
        max_m: greatest,
    }
}

/// The fourth run of a job that is learnt from the runs before.
fn learnt(scenario: &Scenario) -> TipError {
    let job = scenario.job().unwrap();
    let found = repeat(scenario, &job, 4, true, None, &mut |_| ()).unwrap();
    let last = found.runs.last().unwrap();
    TipError {
        rms_m: last.rms_m,
        max_m: last.max_m,
    }
}

/// With the pen's friction in the robot file.
fn fed_forward(name: &str, alone: Mismatch) -> TipError {
    let mut scenario = demonstration(name, alone);
    scenario.robot.advanced.pen_friction = alone.pen_friction as f32;
    error(&scenario)
}

/// With the error in the table of the encoder: the joint turns by ε(φ) more than the encoder at φ says.
fn tabled(name: &str, gear: f64, (harmonic, amplitude): (u32, f64), alone: Mismatch) -> TipError {
    let mut scenario = demonstration(name, alone);
    scenario.arm = Some(scenario.robot.clone());
    let table = Harmonic {
        harmonic,
        amplitude: gear * amplitude,
        phase: PI,
    };
    for actuator in scenario.robot.actuators.as_mut().unwrap() {
        actuator.encoder_error = Harmonics::new(&[table]).unwrap();
    }
    error(&scenario)
}

/// The lines of an arm in the table.
fn rows(name: &str, gear: f64) -> Vec<String> {
    let scenario = demonstration(name, bench(name));
    let job = scenario.job().unwrap();
    let (summary, _) = scenario.simulate(&job, &mut |_| ()).unwrap();
    let causes = scenario.by_cause(&job, &summary).unwrap();
    let mut alone = scenario.mismatch.alone();
    alone.insert(0, ("none", Mismatch::NONE));
    alone.push(("all", scenario.mismatch));
    let pairs = causes.iter().zip(alone);
    pairs
        .map(|(found, (cause, mismatch))| {
            assert_eq!(found.cause, cause);
            let size = if found.faults.is_empty() {
                text(&found.tip_error)
            } else {
                found.faults.join(", ")
            };
            let left = compensated(name, gear, cause, mismatch);
            let left = left.unwrap_or_else(|| "–".into());
            format!("| {name} | {cause} | {size} | {left} |")
        })
        .collect()
}

#[test]
#[ignore = "a minute: ./ci.sh tables"]
fn whole_table_of_what_a_bench_has_besides() {
    let lines: Vec<String> = ARMS
        .iter()
        .flat_map(|(name, gear)| rows(name, *gear))
        .collect();
    let table = lines.join("\n");
    assert!(DOCUMENT.contains(&table), "{table}");
}

/// The rows of effects that move the arm and of one that moves the paper.
#[test]
fn the_document_states_the_run_out_the_growth_and_the_pen_that_are_found() {
    for ((name, gear), cause) in [
        (ARMS[0], "pulley_run_out"),
        (ARMS[0], "paper_growth"),
        (ARMS[0], "pen_friction"),
        (ARMS[3], "pen_friction"),
    ] {
        let all = bench(name).alone();
        let (_, alone) = all.iter().find(|(key, _)| *key == cause).unwrap();
        let size = text(&error(&demonstration(name, *alone)));
        let left = compensated(name, gear, cause, *alone).unwrap();
        let row = format!("| {name} | {cause} | {size} | {left} |");
        assert!(DOCUMENT.contains(&row), "{row}");
    }
}

/// Each joint is off by what its pulley does there, less what it does at home, where the controller took its angle.
/// Each arm with the error that its loop leaves, RMS [rad].
#[test]
fn a_run_out_turns_the_joints_by_its_harmonic_of_the_motors_angle_since_home() {
    for ((name, gear), left) in [(ARMS[0], 3e-5), (ARMS[2], 2e-4)] {
        let mismatch = Mismatch {
            pulley_run_out: [RUN_OUT, 0.0],
            ..Mismatch::NONE
        };
        let scenario = demonstration(name, mismatch);
        let job = scenario.job().unwrap();
        let (_, record) = scenario.simulate(&job, &mut |_| ()).unwrap();
        let home = scenario.robot.home[0];
        // The controller takes the rotor for the joint, shifted by their difference at home.
        let mut at_home = home;
        for _ in 0..20 {
            at_home = home - RUN_OUT * (gear * at_home).sin();
        }
        let (mut greatest, mut squares) = (0.0_f64, [0.0; 2]);
        for sample in record.trace.samples() {
            let rotor = sample.reference_angle[0] + at_home - home;
            let expected = rotor + RUN_OUT * (gear * rotor).sin();
            // The joint may be in another turn than its reference.
            let off = (sample.angle[0] - expected).sin();
            let other = (sample.angle[1] - sample.reference_angle[1]).sin();
            squares[0] += off * off;
            squares[1] += other * other;
            let turned = (sample.angle[0] - sample.reference_angle[0]).sin();
            greatest = greatest.max(turned.abs());
        }
        let count = record.trace.samples().len() as f64;
        let rms = squares.map(|sum: f64| (sum / count).sqrt());
        assert!(rms.iter().all(|rms| *rms < left), "{name}: {rms:?} rad");
        assert!(greatest > 1.1e-3, "{name}: {greatest} rad");
    }
}
