//! The report of a made-up run of the default arm on a circle.

use super::RunReport;
use super::shares::ShareModel;
use fivebar_files::job::{Job, Placement};
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_kinematics::PlanarVector;
use fivebar_sim::simulation::{Sample, Summary, TipError, Trace, Verdict};
use nalgebra::Vector2;
use std::f64::consts::TAU;

const CENTER: [f64; 2] = [0.04, 0.17];
const RADIUS: f64 = 0.03;
/// Angular speed on the circle [rad/s].
const OMEGA: f64 = 8.0;

fn robot() -> Robot {
    BuiltIn::find(BuiltIn::DEFAULT).unwrap().robot().unwrap()
}

/// The sample of a tool that circles, with the joint motion that belongs to it, and with an
/// error of `error` [m] outwards.
fn circling(robot: &Robot, time: f64, error: f64) -> Sample {
    let u = Vector2::unit(OMEGA * time);
    let c = Vector2::new(CENTER[0], CENTER[1]) + u * RADIUS;
    let geometry = &robot.geometry;
    let pose = geometry.inverse(c, robot.elbows).unwrap();
    let rates = geometry
        .inverse_velocities(&pose, u.perpendicular() * (RADIUS * OMEGA))
        .unwrap();
    let inward = u * (-RADIUS * OMEGA * OMEGA);
    let accelerations = geometry
        .inverse_accelerations(&pose, &rates, inward)
        .unwrap();
    let [theta1, .., theta4] = pose.angles();
    let tool = c + u * error;
    Sample {
        time,
        line: 4,
        reference: [c.x, c.y],
        tool: [tool.x, tool.y],
        angle: [theta1, theta4],
        reference_angle: [theta1, theta4],
        reference_velocity: [rates.omega[0], rates.omega[3]],
        reference_acceleration: [accelerations.alpha[0], accelerations.alpha[3]],
        torque: [0.1 * u.x, 0.1 * u.y],
        current: [u.x, u.y],
        tool_level: 1.0,
        ..Sample::default()
    }
}

fn trace(robot: &Robot, error: f64) -> Trace {
    let mut trace = Trace::default();
    for tick in 0..20_000 {
        trace.push(circling(robot, f64::from(tick) * 1e-4, error));
    }
    trace
}

fn summary(rms_m: f64) -> Summary {
    Summary {
        robot: "benchtop".into(),
        scenario: "circle".into(),
        simulated_s: 2.0,
        wall_s: 0.05,
        verdict: Verdict {
            drawn: true,
            worst_m: rms_m,
            tolerance_m: 1e-3,
            why: None,
        },
        tip_error: TipError {
            rms_m,
            max_m: rms_m,
        },
        ..Summary::default()
    }
}

#[test]
fn shows_the_whole_run_in_one_small_offline_page() {
    let robot = robot();
    let text = "M18\nF100\nM3\nG3 X10 I5";
    let placement = Placement {
        origin: CENTER,
        scale: 1.0,
        turn: 0.0,
        home: CENTER,
    };
    let job = Job::parse(text, &placement).unwrap();
    let (own, pid) = (trace(&robot, 20e-6), trace(&robot, 200e-6));
    let report = RunReport {
        robot: &robot,
        job: Some(&job),
        summary: &summary(20e-6),
        trace: &own,
        pid: Some((&summary(200e-6), &pid)),
        stopped: None,
        conditions: &[("link masses".into(), "+10 %".into())],
    };
    let html = report.page().render();
    assert!(html.len() < 2_000_000, "{} bytes", html.len());
    for part in [
        "benchtop draws circle",
        "Drawn: the tip was 20.0 µm from its place at most while the tool was down, and 1.00 mm are allowed.",
        "60.0 × 60.0 mm were meant, 60.0 × 60.0 mm drawn; width and height differ by 40.0 µm at most",
        "20.0 µm at most, less than you see",
        "10.0 times as large",
        "40× real time",
        "error magnified 50×",
        "Torque of joint 4 by cause",
        "velocity products",
        "motor current [A]",
        "line 1: M18 is not supported",
        "link masses",
    ] {
        assert!(html.contains(part), "{part}");
    }
}

#[test]
fn the_picture_shows_the_ink_the_arm_and_its_way() {
    let robot = robot();
    let (own, summary) = (trace(&robot, 0.0), summary(0.0));
    let job = Job::parse(
        "F100\nG1 X1",
        &Placement {
            origin: CENTER,
            scale: 1.0,
            turn: 0.0,
            home: CENTER,
        },
    )
    .unwrap();
    let report = |job, trace| RunReport {
        robot: &robot,
        job,
        summary: &summary,
        trace,
        pid: None,
        stopped: None,
        conditions: &[],
    };
    let ink = |svg: &str| svg.matches("class=\"ink\"").count();
    let all = report(None, &own).picture().unwrap();
    assert_eq!((ink(&all), all.matches("class=\"arm\"").count()), (1, 1));
    assert_eq!(all.matches("class=\"ghost\"").count(), 7);
    // What is drawn follows from the controller's output, whatever the job says.
    assert_eq!(ink(&report(Some(&job), &own).picture().unwrap()), 1);
    let mut lifted = Trace::default();
    for sample in own.samples() {
        lifted.push(Sample {
            tool_level: 0.0,
            ..*sample
        });
    }
    assert_eq!(ink(&report(Some(&job), &lifted).picture().unwrap()), 0);
}

#[test]
fn a_run_that_ends_before_its_job_begins_shows_no_motion() {
    let robot = robot();
    let empty = Summary {
        faults: vec!["over-current".into()],
        verdict: Verdict::default(),
        ..summary(0.0)
    };
    let report = RunReport {
        robot: &robot,
        job: None,
        summary: &empty,
        trace: &Trace::default(),
        pid: Some((&empty, &Trace::default())),
        stopped: None,
        conditions: &[],
    };
    let html = report.page().render();
    assert!(html.contains("ended with a fault: over-current. The job had not begun."));
    for part in ["NaN", "Tip error", "No data to show"] {
        assert!(!html.contains(part), "{part}");
    }
}

#[test]
fn shares_are_those_of_the_reference_motion() {
    let robot = robot();
    let model = ShareModel::new(&robot).unwrap();
    for step in 0..20 {
        let sample = circling(&robot, f64::from(step) / 20.0 * TAU / OMEGA, 0.0);
        let c = Vector2::new(sample.reference[0], sample.reference[1]);
        let geometry = &robot.geometry;
        let pose = geometry.inverse(c, robot.elbows).unwrap();
        let u = Vector2::unit(OMEGA * sample.time);
        let rates = geometry
            .inverse_velocities(&pose, u.perpendicular() * (RADIUS * OMEGA))
            .unwrap();
        let inward = u * (-RADIUS * OMEGA * OMEGA);
        let acc = geometry
            .inverse_accelerations(&pose, &rates, inward)
            .unwrap();
        let arm = robot.arm().unwrap();
        let total = arm
            .inverse_dynamics(&pose, &rates, &acc, Vector2::zeros())
            .unwrap();
        let shares = model.shares(&sample).unwrap();
        for (joint, total) in total.into_iter().enumerate() {
            let frictionless = shares.total()[joint] - shares.friction[joint];
            assert!((frictionless - total).abs() < 1e-10);
            assert!(shares.friction[joint] * sample.reference_velocity[joint] >= 0.0);
        }
    }
}
