//! Marks on a paper: what the touched holes are for an arm that tells nothing without power. The arm moves its tip to each
//! place, and somebody measures where it is.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::operator::Task;
use super::super::simulated::OperatorActions;
use super::encoder_errors;
use super::moving::joint_angles;
use super::standing::{go, power_on};
use fivebar_design::Noise;
use fivebar_files::measurements::read_columns;
use fivebar_firmware::MoveKind;
use fivebar_kinematics::five_bar::Joint;
use fivebar_report::output::write_whole;
use fivebar_report::study::calibration::propose_poses;
use std::f64::consts::TAU;

/// How many there are.
const MARKS: usize = 24;
/// Standard deviation of a measured mark's x and of its y [m]: by a scanner, or a good ruler.
pub(super) const SIGMA: f64 = 1e-4;
/// The speed with which a joint goes from mark to mark: this share of its greatest one, and so much if it can [rad/s].
const SHARE: f64 = 0.1;
const SPEED: f64 = 1.0;

/// Counts of both joints and the place of each mark.
pub(super) fn marked(bench: &mut Bench) -> Result<Vec<[f64; 4]>, StepError> {
    let path = bench.holes_file.with_file_name("marks.csv");
    if path.exists() {
        return read_columns(&path, ["counts1", "counts4", "x", "y"]).map_err(|error| {
            StepError::other(format_args!(
                "{error}. Measure the marks on the paper, all from one corner, and write x and y of each into this file [m]; \
                 remove it to draw the marks anew"
            ))
        });
    }
    if bench.robot.tool.offset != [0.0; 2] {
        return Err(StepError::wrong(
            "the tool of this arm is beside C, and marks are of C",
            "draw without [tool] in the robot file, with the pen at C, or measure by fivebar calibrate and give the table with \
             --points",
        ));
    }
    let stood = stood(bench)?;
    let mut noise = Noise::new(7);
    let measured = stood.iter().map(|Stand { counts, tip }| {
        let [x, y] = (*tip)?.map(|place| place + SIGMA * noise.normal());
        Some([counts[0], counts[1], x, y])
    });
    if let Some(measured) = measured.collect() {
        return Ok(measured);
    }
    let mut text = String::from("counts1,counts4,x,y\n");
    for Stand { counts, .. } in &stood {
        let [counts1, counts4] = counts;
        text += &format!("{counts1},{counts4},,\n");
    }
    write_whole(&path, text).map_err(StepError::other)?;
    Err(StepError::wrong(
        format_args!(
            "the marks are drawn, and nobody has measured them yet: {}",
            path.display()
        ),
        "measure the marks on the paper, all from one corner, and write x and y of each into this file [m]; then start the \
         step again",
    ))
}

/// A place at which the tip has stood.
struct Stand {
    /// Counts of both joints.
    counts: [f64; 2],
    /// The tip of the simulated arm there [m]; of a real one it is measured on the paper.
    tip: Option<[f64; 2]>,
}

/// Moves the tip from place to place.
fn stood(bench: &mut Bench) -> Result<Vec<Stand>, StepError> {
    let proposal = propose_poses(&bench.robot, MARKS, SIGMA).map_err(StepError::other)?;
    bench.report("Fix a paper under the tip, and a pen that reaches it, or a needle")?;
    bench.home()?;
    power_on(bench)?;
    let [first, second] = bench.robot.limits.max_speed;
    let speed = SHARE.max(SPEED / first.min(second)).min(1.0);
    let mut stood = Vec::new();
    for place in &proposal.proposal.points {
        let Some(to) = joint_angles(&bench.robot, [place.x, place.y].into()) else {
            continue;
        };
        let to = to.map(|angle| angle as f32);
        go(
            bench,
            MoveKind::Joint {
                to,
                speed: speed as f32,
            },
        )?;
        bench.ask(Task::Mark(stood.len()))?;
        let angle = bench.client.status()?.0.angle.map(f64::from);
        let shown = encoder_errors::shown(bench, angle)?;
        let mut counts = [0.0; 2];
        for joint in Joint::ALL {
            counts[joint] = shown[joint] * bench.counts_per_turn(joint)? / TAU - 0.5;
        }
        let tip = bench.operator.actions().map(OperatorActions::tool);
        stood.push(Stand { counts, tip });
    }
    bench.power_off()?;
    Ok(stood)
}
