//! The steps that move the homed arm: homing itself, masses, gains, and the drawing that validates
//! them.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::operator::Operator;
use super::super::record::Value;
use super::Outcome;
use crate::input::robot::Robot;
use crate::input::scenario::Scenario;
use crate::run::drive::Drive;
use crate::study::calibration::propose_poses;
use crate::study::identification::{identify_robot, measured};
use crate::study::margins::MarginsStudy;
use fivebar_firmware::recorder::{LogConfig, Signals};
use fivebar_firmware::{Move, MoveKind, Planner, Status};
use std::f64::consts::TAU;

/// Searches for the home switches.
const SEARCHES: usize = 3;
/// Greatest spread of the counts at which a switch closes [rad].
const REPEATABILITY: f64 = 2e-3;

/// Homes several times: the switches must be found, at the same counts each time.
pub(in super::super) fn homing(bench: &mut Bench) -> Result<Outcome, StepError> {
    let mut origins = Vec::new();
    for _ in 0..SEARCHES {
        // New settings make the controller forget its angles.
        bench.upload()?;
        bench.home()?;
        let status = bench.pause(0.3)?;
        let counts = bench.sample()?.counts;
        let mut origin = [0.0; 2];
        for (joint, origin) in origin.iter_mut().enumerate() {
            let per_count = TAU / bench.counts_per_turn(joint)?;
            *origin = f64::from(counts[joint]) * per_count - f64::from(status.angle[joint]);
        }
        origins.push(origin);
    }
    let mut values = Vec::new();
    for joint in [0, 1] {
        let first = origins[0][joint];
        let spread = origins
            .iter()
            .map(|o| (o[joint] - first).abs())
            .fold(0.0, f64::max);
        let number = super::super::operator::number(joint);
        if spread > REPEATABILITY {
            return Err(StepError::wrong(
                format_args!(
                    "the home switch of joint {number} repeats within {:.1} mrad only",
                    1e3 * spread
                ),
                "check the switch and its mounting, or lower [homing] speed",
            ));
        }
        let name = format!("home_repeatability{number}_rad");
        values.push(Value::new(
            name,
            spread,
            "greatest difference of three searches",
        ));
    }
    Ok(Outcome::new(
        "both switches were found three times, at the same counts",
        values,
    ))
}

/// Rows of the log of a motion per second.
const LOG_RATE: f64 = 1000.0;

/// Masses and friction from the currents along a motion of both joints.
pub(in super::super) fn dynamics(bench: &mut Bench) -> Result<Outcome, StepError> {
    bench.home()?;
    let moves = excitation(bench)?;
    let every = (bench.robot.control.tick_rate / LOG_RATE).round().max(1.0) as u16;
    let config = LogConfig {
        signals: (Signals::COUNTS_1 | Signals::COUNTS_4 | Signals::CURRENT_1 | Signals::CURRENT_4)
            .bits(),
        every,
        powered: true,
    };
    let start = bench.pause(0.3)?.angle;
    bench.begin_log(config)?;
    let settings = bench.settings;
    Drive::new(&mut bench.client, &|| false).follow(&moves, &settings, &mut |_, _| ())?;
    let log = bench.read_log(&config)?;
    bench.measure_zeros()?;
    let period = f64::from(every) / bench.robot.control.tick_rate;
    let (mut angles, mut currents) = (Vec::new(), Vec::new());
    for joint in [0, 1] {
        let per_count = TAU / bench.counts_per_turn(joint)?;
        let begin = f64::from(start[joint]);
        angles.push(
            log.counts(joint)
                .iter()
                .map(|c| begin + c * per_count)
                .collect::<Vec<_>>(),
        );
        let sign = bench.drive(joint)?.gear_ratio.signum();
        let per_code = sign * f64::from(bench.settings.axes[joint].current_per_code);
        let zero = bench.zeros[joint];
        let amperes = log
            .current_codes(joint)
            .into_iter()
            .map(|code| (code - zero) * per_code);
        currents.push(amperes.collect::<Vec<_>>());
    }
    // The mean of both ends of a row: the current that acted within it.
    let rows: Vec<[f64; 5]> = (1..angles[0].len())
        .map(|k| {
            let acted = |joint: usize| 0.5 * (currents[joint][k] + currents[joint][k - 1]);
            [
                k as f64 * period,
                angles[0][k],
                angles[1][k],
                acted(0),
                acted(1),
            ]
        })
        .collect();
    let mut slow = bench.robot.clone();
    slow.control.tick_rate /= f64::from(every);
    let found = identify_robot(&slow, &rows).map_err(|error| {
        StepError::wrong(
            format_args!("the motion does not determine the masses: {error}"),
            "check currents and the robot file's masses, and do the step geometry first",
        )
    })?;
    let mut values = Vec::new();
    let names = fivebar_design::identification::BASE_NAMES;
    for (index, (name, value)) in names.iter().zip(&found.base).enumerate() {
        values.push(
            Value::new(*name, *value, "by a motion of both joints").with_sd(found.base_sd[index]),
        );
    }
    let residual = found.residual_rms;
    let text = format!(
        "the torques are explained to {:.2} and {:.2} mN·m from {} rows",
        1e3 * residual[0],
        1e3 * residual[1],
        rows.len()
    );
    Ok(Outcome {
        found: text,
        values,
        measured: measured(&bench.robot, &found),
    })
}

/// Fast moves of both joints between places all over the workspace.
fn excitation(bench: &mut Bench) -> Result<Vec<Move>, StepError> {
    let places = propose_poses(&bench.robot, 12, 20e-6).map_err(StepError::other)?;
    let settings = bench.settings.check().map_err(StepError::other)?;
    let planner = Planner::new(&settings);
    let robot = &bench.robot;
    let mut tool = bench.client.status()?.0.tool.ok_or_else(|| {
        StepError::other("the controller is homed and knows no place of its tool")
    })?;
    let (mut moves, mut tag) = (Vec::new(), 0);
    let count = places.proposal.places.len();
    let best = robot.best_point().map_err(StepError::other)?;
    for round in 0..7_usize {
        for step in 0..count {
            // Each round visits them in another order.
            let visited = places.proposal.places[(step * [5, 7, 11, 1][round % 4] + round) % count];
            // At last to a place from which the switches are found.
            let place = if round < 6 { visited } else { best.into() };
            let Ok(pose) = robot.geometry.inverse(place, robot.elbows) else {
                continue;
            };
            let angles = pose.angles();
            let within = |joint: usize, angle: f64| {
                let [least, greatest] = robot.limits.angle[joint];
                let turns = [0.0, TAU, -TAU].map(|turn| angle + turn);
                turns
                    .into_iter()
                    .find(|angle| (least..=greatest).contains(angle))
            };
            let (Some(theta1), Some(theta4)) = (within(0, angles[0]), within(1, angles[3])) else {
                continue;
            };
            let to = [theta1 as f32, theta4 as f32];
            for speed in [0.6, 0.3] {
                let next = Move {
                    tag,
                    tool: 0,
                    kind: MoveKind::Joint { to, speed },
                };
                if let Ok(end) = planner.check(tool, &next) {
                    tool = end;
                    moves.push(next);
                    tag += 1;
                    break;
                }
            }
        }
    }
    if moves.len() < 12 {
        return Err(StepError::wrong(
            "hardly any move between places of the workspace is possible",
            "check limits.angle and singularity_margin of the robot file",
        ));
    }
    Ok(moves)
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
    let gains = bench.robot.control.gains();
    let text = format!(
        "a bandwidth of {:.0} rad/s, a phase margin of {:.0}° and a modulus margin of {:.2} at the \
         worst pose",
        gains.bandwidth,
        margins.phase.to_degrees(),
        margins.modulus
    );
    let values = vec![
        Value::new("bandwidth_rad_s", gains.bandwidth, "from the arm"),
        Value::new("modulus_margin", margins.modulus, "of the sampled loop"),
    ];
    Ok(Outcome::new(text, values))
}

/// Draws with the drawing's values, then with the measured ones.
pub(in super::super) fn validation(bench: &mut Bench) -> Result<Outcome, StepError> {
    let measured = bench.robot.clone();
    bench.robot = bench.drawn.clone();
    let before = draw(bench, [0.0; 3])?;
    bench.robot = measured;
    let placement = bench.placement;
    let after = draw(bench, placement)?;
    let origin = match bench.operator {
        Operator::Simulated(_) => "the true tip of the simulated arm",
        Operator::Person => "as the encoders see it; measure the drawing itself",
    };
    let text = format!(
        "tip error {:.1} µm RMS before and {:.1} µm after ({origin}); at most {:.1} and {:.1} µm",
        1e6 * before[0],
        1e6 * after[0],
        1e6 * before[1],
        1e6 * after[1]
    );
    let values = vec![
        Value::new("tip_error_before_rms_m", before[0], origin),
        Value::new("tip_error_before_max_m", before[1], origin),
        Value::new("tip_error_after_rms_m", after[0], origin),
        Value::new("tip_error_after_max_m", after[1], origin),
    ];
    Ok(Outcome::new(text, values))
}

/// Draws the demonstration; the error of the tip [m], root mean square and greatest. A simulated tip
/// is measured on the plate that was touched: C of the arm is R(φ) C + (x, y) there.
fn draw(bench: &mut Bench, [plate_x, plate_y, phi]: [f64; 3]) -> Result<[f64; 2], StepError> {
    bench.upload()?;
    bench.home()?;
    let scenario = demonstration(&bench.robot)?;
    let job = scenario.job().map_err(StepError::other)?;
    let moves = scenario.run_moves(&job).map_err(StepError::other)?;
    let hand = match &bench.operator {
        Operator::Simulated(hand) => Some(hand.clone()),
        Operator::Person => None,
    };
    let (mut sum, mut most, mut count) = (0.0, 0.0_f64, 0.0);
    let mut take = |_: usize, status: &Status| {
        let Some(reference) = status.reference else {
            return;
        };
        let [xr, yr] = reference.map(f64::from);
        let (sin, cos) = phi.sin_cos();
        let on_plate = [plate_x + cos * xr - sin * yr, plate_y + sin * xr + cos * yr];
        let believed = status.tool.map(|tool| (tool.map(f64::from), [xr, yr]));
        let seen = hand.as_ref().map(|hand| (hand.tool(), on_plate));
        let Some(([x, y], [xd, yd])) = seen.or(believed) else {
            return;
        };
        let error = (x - xd).hypot(y - yd);
        sum += error * error;
        most = most.max(error);
        count += 1.0;
    };
    let settings = bench.settings;
    Drive::new(&mut bench.client, &|| false).follow(&moves, &settings, &mut take)?;
    if count == 0.0 {
        return Err(StepError::other("the drawing gave no samples"));
    }
    Ok([f64::sqrt(sum / count), most])
}

/// The demonstration, as large as the arm can.
fn demonstration(robot: &Robot) -> Result<Scenario, StepError> {
    let mut scenario = Scenario::demonstration(robot.clone());
    scenario.scale = crate::run::simulation::find_demo_scale(robot).map_err(StepError::other)?;
    Ok(scenario)
}
