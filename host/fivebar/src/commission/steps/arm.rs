//! The steps of the whole arm: homing, gains, and the drawing that validates what was measured.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::operator::Task;
use super::super::record::Value;
use super::moving::{middle, origins};
use super::{Outcome, index};
use fivebar_files::robot::{HomeMethod, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::Status;
use fivebar_firmware::safety::Fault;
use fivebar_kinematics::five_bar::Joint;
use fivebar_report::picture::{DrawnPoint, validation as picture};
use fivebar_report::study::margins::MarginsStudy;
use fivebar_sim::drive::{Drive, DriveError};
use fivebar_sim::simulation::Simulate;

/// How often the arm is homed: what no encoder watches is homed oftener.
const SEARCHES: usize = 3;
const SEARCHES_UNSEEN: usize = 10;
/// Greatest spread of the counts at the home angle [rad].
const REPEATABILITY: f64 = 2e-3;

/// Homes several times: the angles must be found, at the same counts each time.
pub(in super::super) fn homing(bench: &mut Bench) -> Result<Outcome, StepError> {
    let mut found = Vec::new();
    let mut values = Vec::new();
    let searches = match bench.counts_by_hand() {
        true => SEARCHES,
        false => SEARCHES_UNSEEN,
    };
    for _ in 0..searches {
        // New settings make the controller forget its angles.
        bench.upload()?;
        if bench.robot.homing.method == HomeMethod::Index {
            values = index::home(bench)?;
        } else {
            match bench.home() {
                Err(StepError::Drive(DriveError::Fault(Fault::Envelope))) if found.is_empty() => {
                    home_from_the_middle(bench)?;
                }
                homed => homed?,
            }
        }
        found.push(origins(bench)?);
    }
    for joint in Joint::ALL {
        let first = found[0][joint];
        let spread = found
            .iter()
            .map(|o| (o[joint] - first).abs())
            .fold(0.0, f64::max);
        let number = joint.number();
        if spread > REPEATABILITY {
            return Err(StepError::wrong(
                format_args!(
                    "the home angle of {joint} repeats within {:.1} mrad only",
                    1e3 * spread
                ),
                "check the switch, stop or jig and its mounting, or lower [homing] speed",
            ));
        }
        let name = format!("home_repeatability{number}_rad");
        values.push(Value::new(name, spread, "greatest difference of all times"));
    }
    let times = if searches == SEARCHES { "three" } else { "ten" };
    Ok(Outcome::new(
        format!("both home angles were found {times} times, at the same counts"),
        values,
    ))
}

/// Homes from where a hand has put the arm: the steps before, of an arm that knew no angle, have left it so far behind its
/// switches that it cannot back off them.
fn home_from_the_middle(bench: &mut Bench) -> Result<(), StepError> {
    bench.clear()?;
    bench.ask(Task::Place(middle(bench)?))?;
    bench.ask(Task::LetGo)?;
    bench.home()
}

/// The gains follow from the arm; their margins must do.
pub(in super::super) fn tuning(bench: &mut Bench) -> Result<Outcome, StepError> {
    let study = MarginsStudy::new(&bench.robot).map_err(StepError::other)?;
    let worst = study.worst();
    let Some(margins) = &worst.margins else {
        return Err(StepError::wrong(
            format_args!(
                "with what was measured the position loop is unstable at θ1 = {:.3}, θ4 = {:.3} rad",
                worst.theta[0], worst.theta[1]
            ),
            "leave bandwidth out of [control], so that it follows from the arm",
        ));
    };
    let gains = bench.robot.gains();
    let text = format!(
        "a bandwidth of {:.0} rad/s, a phase margin of {:.0}° and a modulus margin of {:.2} at the \
         worst pose",
        gains.feedback_bandwidth(),
        margins.phase.to_degrees(),
        margins.modulus
    );
    let values = vec![
        Value::new(
            "bandwidth_rad_s",
            gains.feedback_bandwidth(),
            "from the arm",
        ),
        Value::new("modulus_margin", margins.modulus, "of the sampled loop"),
    ];
    Ok(Outcome::new(text, values))
}

/// A tip error that no measurement of this arm explains [m].
const TELLING: f64 = 50e-6;

/// Draws with the drawing's values, then with the measured ones.
pub(in super::super) fn validation(bench: &mut Bench) -> Result<Outcome, StepError> {
    let measured = bench.robot.clone();
    bench.robot = bench.drawn.clone();
    let before = draw(bench, [0.0; 3])?;
    bench.robot = measured;
    let placement = bench.placement;
    let after = draw(bench, placement)?;
    let origin = match bench.operator.actions() {
        Some(_) => "the true tip of the simulated arm",
        None => "as the encoders see it; measure the drawing itself",
    };
    let mut text = format!(
        "tip error {:.1} µm RMS before and {:.1} µm after ({origin}); at most {:.1} and {:.1} µm",
        1e6 * before.rms,
        1e6 * after.rms,
        1e6 * before.greatest,
        1e6 * after.greatest
    );
    if after.rms > 3.0 * before.rms + TELLING {
        return Err(StepError::wrong(
            text,
            "the holes or the second log are not of this arm, or its zeros have changed since: measure \
             again, --again geometry",
        ));
    }
    if after.rms > before.rms {
        text += "; this arm is closer to its drawing than the measurements can show: keep your own \
                 robot file";
    }
    let values = vec![
        Value::new("tip_error_before_rms_m", before.rms, origin),
        Value::new("tip_error_before_max_m", before.greatest, origin),
        Value::new("tip_error_after_rms_m", after.rms, origin),
        Value::new("tip_error_after_max_m", after.greatest, origin),
    ];
    let picture = picture([&before.points, &after.points]);
    Ok(Outcome {
        picture,
        ..Outcome::new(text, values)
    })
}

/// A drawing and the error of its tip.
struct Drawing {
    points: Vec<DrawnPoint>,
    /// Root mean square and greatest error [m].
    rms: f64,
    greatest: f64,
}

/// Draws the demonstration. A simulated tip is measured on the plate that was touched: C of the arm is R(φ) C + (x, y) there.
fn draw(bench: &mut Bench, [plate_x, plate_y, phi]: [f64; 3]) -> Result<Drawing, StepError> {
    bench.upload()?;
    bench.home()?;
    let scenario = demonstration(&bench.robot)?;
    let job = scenario.job().map_err(StepError::other)?;
    let moves = scenario.run_moves(&job).map_err(StepError::other)?;
    let actions = bench.operator.actions().cloned();
    let mut points = Vec::new();
    let mut begun = false;
    let mut take = |_: usize, status: &Status| {
        // The way to the first stroke draws nothing: a hobby servo jumps to where it is told to be first.
        begun |= status.tool_level > 0.0;
        if !begun {
            return;
        }
        let Some(reference) = status.reference else {
            return;
        };
        let [xr, yr] = reference.map(f64::from);
        let (sin, cos) = phi.sin_cos();
        let on_plate = [plate_x + cos * xr - sin * yr, plate_y + sin * xr + cos * yr];
        let believed = status.tool.map(|tool| (tool.map(f64::from), [xr, yr]));
        let seen = actions.as_ref().map(|actions| (actions.tool(), on_plate));
        let Some(([x, y], [xd, yd])) = seen.or(believed) else {
            return;
        };
        points.push(DrawnPoint {
            wanted: [xd, yd],
            error: [x - xd, y - yd],
        });
    };
    let settings = bench.settings;
    Drive::new(&mut bench.client, &|| false).follow(&moves, &settings, &mut take)?;
    if points.is_empty() {
        return Err(StepError::other("the drawing gave no samples"));
    }
    let size = |point: &DrawnPoint| point.error[0].hypot(point.error[1]);
    let squares: f64 = points.iter().map(|point| size(point).powi(2)).sum();
    Ok(Drawing {
        rms: (squares / points.len() as f64).sqrt(),
        greatest: points.iter().map(size).fold(0.0, f64::max),
        points,
    })
}

/// The demonstration, as large as the arm can.
fn demonstration(robot: &Robot) -> Result<Scenario, StepError> {
    let mut scenario = Scenario::demonstration(robot.clone());
    scenario.scale = fivebar_sim::simulation::find_demo_scale(robot).map_err(StepError::other)?;
    Ok(scenario)
}
