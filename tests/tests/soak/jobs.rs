//! Random jobs for any arm: a scenario with a mismatch, faults in some of the runs, and moves that
//! the arm can make.

use fivebar_files::robot::{BUILT_IN, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::settings::ToolOutputSettings;
use fivebar_firmware::{Move, MoveKind, Planner};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{FaultKind, Mismatch, PlantFault};
use oorandom::Rand64;

/// Moves that are tried for one job.
const TRIED: u32 = 40;

/// The built-in robots that can be simulated. These jobs switch no tool: an arm with an output for one is
/// the same as without.
pub(crate) fn robots() -> Vec<Robot> {
    let robots = BUILT_IN.iter().filter_map(|built_in| built_in.robot().ok());
    let robots = robots.filter(|robot| robot.tool_output == ToolOutputSettings::None);
    // The rules are those of brushed motors.
    let robots = robots.filter(|robot| robot.brushed().is_ok());
    robots.filter(|robot| robot.settings().is_ok()).collect()
}

/// A random job.
pub(crate) struct RandomJob {
    pub(crate) scenario: Scenario,
    pub(crate) moves: Vec<Move>,
}

impl RandomJob {
    /// The job of this seed for this arm.
    pub(crate) fn new(robot: Robot, seed: u64) -> Self {
        let random = &mut Rand64::new(seed.into());
        let mut scenario = Scenario::new("soak", robot, "random moves", String::new());
        scenario.seed = seed;
        scenario.mismatch = mismatch(random);
        if random.rand_float() < 0.3 {
            let at = 2.0 * random.rand_float();
            let kind = fault(random);
            scenario.faults.push(PlantFault { at, kind });
        }
        let moves = moves(&scenario.robot, random);
        Self { scenario, moves }
    }
}

fn between(random: &mut Rand64, low: f64, high: f64) -> f64 {
    low + (high - low) * random.rand_float()
}

fn mismatch(random: &mut Rand64) -> Mismatch {
    Mismatch {
        link_mass: between(random, -0.05, 0.05),
        friction: between(random, -0.3, 0.3),
        payload: 0.0,
        current_noise: between(random, 0.0, 3.0),
        current_offset: between(random, -3.0, 3.0),
        ..Mismatch::NONE
    }
}

fn fault(random: &mut Rand64) -> FaultKind {
    let joint = Joint::ALL[random.rand_range(0..2) as usize];
    match random.rand_range(0..8) {
        0 => FaultKind::EncoderDead { joint },
        1 => FaultKind::EncoderJump {
            joint,
            counts: random.rand_range(0..4000) as i32 - 2000,
        },
        2 => FaultKind::MotorDisconnected { joint },
        3 => FaultKind::MotorStalled { joint },
        4 => FaultKind::BusVoltage {
            volts: between(random, 0.0, 60.0),
        },
        5 => FaultKind::DriverFault { joint },
        6 => FaultKind::EmergencyStop,
        _ => FaultKind::TicksMissed {
            ticks: 1 + random.rand_range(0..6) as u32,
        },
    }
}

/// Random moves, of which those are kept that the planner accepts from the arm's home on.
fn moves(robot: &Robot, random: &mut Rand64) -> Vec<Move> {
    let settings = robot.settings().expect("it has masses");
    let planner = Planner::new(&settings.check().expect("valid settings"));
    let home = robot.home_pose().expect("it has a home");
    let start = robot.tool_at(&home).map(|metres| metres as f32);
    let [best_x, best_y] = robot.best_point().expect("it has a workspace");
    let size = 0.3 * settings.lengths[0];
    let speed = settings.motion.max_speed;
    let mut tool = start;
    let mut moves: Vec<Move> = Vec::new();
    for _ in 0..TRIED {
        // The arm begins some micrometres beside its home, so a timed motion is never the first.
        let is_at_tool = moves
            .iter()
            .any(|before| !matches!(before.kind, MoveKind::Dwell { .. }));
        if is_at_tool && random.rand_range(0..8) == 0 {
            let bytes: Vec<u8> = (0..40).map(|_| random.rand_range(0..256) as u8).collect();
            let slower = between(random, 1.3, 3.0) as f32;
            for timed in fivebar_stress::timed_run(&bytes, slower, tool, &planner) {
                let (tag, kind) = (moves.len() as u32, MoveKind::Timed(timed));
                moves.push(Move { tag, tool: 0, kind });
                tool = timed.end();
            }
        }
        let mut near = |reach: f32| between(random, f64::from(-reach), f64::from(reach)) as f32;
        let to = [best_x as f32 + near(size), best_y as f32 + near(size)];
        let aside = near(2.0);
        let feed = speed * (0.6 + near(0.55));
        let [dx, dy] = [0.5 * (to[0] - tool[0]), 0.5 * (to[1] - tool[1])];
        let kind = match random.rand_range(0..10) {
            0..6 => MoveKind::Line { to, feed },
            6..9 => MoveKind::Arc {
                to,
                center: [tool[0] + dx - aside * dy, tool[1] + dy + aside * dx],
                clockwise: aside > 0.0,
                feed,
            },
            _ => MoveKind::Dwell {
                duration: 0.1 * random.rand_float() as f32,
            },
        };
        let tag = moves.len() as u32;
        let next = Move { tag, tool: 0, kind };
        if let Ok(end) = planner.check(tool, &next) {
            tool = end;
            moves.push(next);
        }
    }
    moves
}
