//! A job over bad links: it is completed, or the arm is brought to rest with a reason.

use crate::slow_line::SlowLine;
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_firmware::{ActuatorCommand, Move, MoveKind, Status};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{Mismatch, Plant};
use fivebar_sim::drive::{Drive, Homing};
use fivebar_sim::link::{Client, FaultInjector, FaultRates, Loopback};
use std::fmt::Write as _;
use std::io::Read as _;
use std::sync::{Arc, Mutex};

/// Reads after the job: half a second.
const AFTERMATH: u32 = 50;

type Line = FaultInjector<SlowLine<Loopback>>;

/// What a link does to frames.
#[derive(Clone, Copy)]
struct Link {
    /// Share of the frames that are lost, and share of those that are damaged.
    lost: f32,
    corrupt: f32,
    /// Delay in each direction [10 ms].
    delay: u64,
    /// Frames that fit on the line in each direction.
    queue: usize,
}

/// How fast the driven joints turn [rad/s] and whether the bridges have power.
type Watch = Arc<Mutex<(f64, bool)>>;

fn robot() -> Robot {
    Robot::load(BuiltIn::DEFAULT).expect("a built-in robot")
}

/// The arm behind a controller with its own clock.
fn controller(watch: Watch) -> Loopback {
    let robot = robot();
    let settings = robot.settings().expect("it has masses");
    let before = settings
        .axes
        .map(|axis| if axis.home_forward { -0.03 } else { 0.03 });
    let pose = robot.pose_near_home(before).expect("a pose");
    let parameters = robot.plant_parameters().expect("it has masses");
    let mut plant = Plant::new(&parameters, &Mismatch::default(), &pose, 7);
    let mut last = Joint::ALL.map(|joint| plant.angle(joint));
    let period = 1.0 / robot.control.tick_rate;
    let step = move |command: &ActuatorCommand| {
        plant.step(command, period);
        let now = Joint::ALL.map(|joint| plant.angle(joint));
        let speed = (now[0] - last[0]).abs().max((now[1] - last[1]).abs()) / period;
        last = now;
        *watch.lock().expect("no panic") = (speed, command.enable[0]);
        plant.sense()
    };
    Loopback::driving(&settings, Box::new(step)).expect("valid settings")
}

/// Two seconds of motion to and fro.
fn job() -> Vec<Move> {
    let point = robot().best_point().expect("a workspace");
    let [x, y] = point.map(|metres| metres as f32);
    let line = |tag| MoveKind::Line {
        to: [x + 0.01 * (tag % 2) as f32, y],
        feed: 0.2,
    };
    (1..=24)
        .map(|tag| Move {
            tag,
            tool: 0,
            kind: line(tag),
        })
        .collect()
}

/// The reason why a session was not completed; none if it was.
fn drive(client: &mut Client<Line>, taken: &mut usize) -> Result<(), String> {
    let settings = robot().settings().expect("it has masses");
    let mut drive = Drive::new(client, &|| false);
    drive
        .home(Homing::IfUnknown)
        .and_then(|()| drive.follow(&job(), &settings, &mut |moves, _: &Status| *taken = moves))
        .map_err(|error| {
            let text = error.to_string();
            text.split([';', '(']).next().unwrap_or(&text).trim().into()
        })
}

/// The row of the table for this link.
fn row(link: Link, seed: u64) -> String {
    let watch = Watch::default();
    let line = SlowLine::new(controller(watch.clone()), link.delay, link.queue);
    let rates = FaultRates {
        dropped: link.lost,
        corrupt: link.corrupt,
        ..FaultRates::default()
    };
    let mut taken = 0;
    let mut repeats = 0;
    let outcome = match Client::open(FaultInjector::new(line, rates, seed)) {
        Err(error) => Err(error.to_string().split(';').next().unwrap_or("").into()),
        Ok((mut client, _)) => {
            let outcome = drive(&mut client, &mut taken);
            repeats = client.repeats();
            // The host says no more. The controller must be at rest in the end, whatever it has
            // still got.
            let mut bytes = [0; 512];
            for _ in 0..AFTERMATH {
                let _ = client.line().read(&mut bytes);
            }
            outcome
        }
    };
    let (speed, power) = *watch.lock().expect("no panic");
    let Link {
        lost,
        corrupt,
        delay,
        queue,
    } = link;
    let name = format!("loss {lost}, corrupt {corrupt}, delay {delay}, queue {queue}");
    assert!(speed < 0.05, "{name}: the arm moves at {speed} rad/s");
    let result = match outcome {
        Ok(()) => {
            assert!(!power && taken == job().len(), "{name}: {taken} moves");
            "completed".into()
        }
        Err(reason) => format!("stopped: {reason}"),
    };
    format!(
        "| {:.0} % | {:.0} % | {} ms | {queue} | {taken} | {repeats} | {} | {result} |\n",
        100.0 * lost,
        100.0 * corrupt,
        10 * delay,
        if power { "held" } else { "off" },
    )
}

/// The rows for these shares of lost and damaged frames, and these delays.
fn table(shares: &[(f32, f32)], delays: &[u64]) -> String {
    let mut table = String::new();
    let mut seed = 0;
    for &(lost, corrupt) in shares {
        for &delay in delays {
            for queue in [1, 8] {
                seed += 1;
                let link = Link {
                    lost,
                    corrupt,
                    delay,
                    queue,
                };
                let _ = table.write_str(&row(link, seed));
            }
        }
    }
    table
}

#[test]
fn a_job_over_a_bad_link_is_completed_or_ends_at_rest_with_a_reason() {
    let table = table(&[(0.0, 0.0), (0.02, 0.02), (0.3, 0.1)], &[1, 6]);
    assert!(
        table.contains("completed") && table.contains("stopped: "),
        "{table}"
    );
}

/// The rows of docs/verify/data/links.csv.
#[test]
#[ignore = "a minute; scripts/soak.sh runs it"]
fn every_link_of_the_table_completes_the_job_or_ends_at_rest_with_a_reason() {
    let shares = [(0.0, 0.0), (0.02, 0.02), (0.1, 0.0), (0.1, 0.1), (0.3, 0.1)];
    print!("{}", table(&shares, &[0, 1, 3, 6]));
}
