//! Crossings by the controller, with the real drives, on the simulated arm.

use crate::crossing::{case, number, pair, robot};
use crate::crossing_arm::cross;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::{Scenario, crossing_move};
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{CrossingMove, Move, MoveKind, Planner, Request, Settings};
use fivebar_kinematics::five_bar::Side;
use fivebar_plant::Mismatch;
use fivebar_report::study::crossing::task;
use fivebar_sim::link::{InProcess, Target};
use fivebar_sim::simulation::{Record, Sample, Simulate, Simulation};
use nalgebra::Vector2;
use serde_json::Value;

pub(crate) fn allowed(case: &Value) -> Robot {
    robot(case, "[crossing]\nallowed = true\n")
}

/// The crossing of a case, and the moves before it.
pub(crate) fn moves(case: &Value, robot: &Robot) -> Vec<Move> {
    moves_in(case, robot, number(&case["tf"]))
}

/// The same in another time [s].
fn moves_in(case: &Value, robot: &Robot, time: f64) -> Vec<Move> {
    let ends = [pair(&case["start"]), pair(&case["end"])];
    let task = task(robot, ends, time).unwrap();
    let plan = task.plan().unwrap();
    let start = task.arm.geometry().inverse(task.from, task.mode).unwrap();
    let [theta1, _, _, theta4] = start.angles().map(|angle| angle as f32);
    let joints = MoveKind::Joint {
        to: [theta1, theta4],
        speed: 0.2,
    };
    let kinds = [joints, crossing_move(&task, &plan)];
    kinds
        .map(|kind| Move {
            tag: 1,
            tool: 0,
            kind,
        })
        .into()
}

/// A run of these moves in this process.
fn run(scenario: &Scenario, moves: &[Move]) -> Record {
    let settings = scenario.robot.settings().unwrap();
    let mut target = InProcess::new(&settings).unwrap();
    let plant = scenario.plant().unwrap();
    let simulation = Simulation::new(&mut target, plant, scenario.robot.control.tick_rate);
    simulation.run(moves, &[], &mut |_| ()).unwrap()
}

fn scenario(robot: Robot, mismatch: Mismatch) -> Scenario {
    let mut scenario = Scenario::new("crossing", robot, "none", String::new());
    scenario.mismatch = mismatch;
    scenario
}

/// The time for which the controller settles after a plan [s].
const SETTLING: f64 = 0.02;

/// The samples of the crossing, and the time at which the plan is in the
/// singularity [s].
fn crossing_of<'a>(case: &Value, record: &'a Record) -> (Vec<&'a Sample>, f64) {
    let end = record.job_time.unwrap();
    let begin = end - SETTLING - number(&case["tf"]);
    let samples = record.trace.samples().iter();
    let samples = samples.filter(|sample| sample.time > begin && sample.time < end - SETTLING);
    (samples.collect(), begin + number(&case["tc"]))
}

/// The assembly mode of the simulated arm, by its true cranks and tool.
pub(crate) fn assembly(robot: &Robot, sample: &Sample) -> Side {
    let geometry = &robot.geometry;
    let [theta1, theta4] = sample.angle;
    let away = |side: &Side| {
        let pose = geometry.forward(theta1, theta4, *side).unwrap();
        (pose.c - Vector2::from(sample.tool)).norm()
    };
    let [left, right] = [Side::Left, Side::Right].map(|side| (away(&side), side));
    let (off, side) = if left.0 < right.0 { left } else { right };
    assert!(off < 1e-6, "{off} m");
    side
}

#[test]
fn the_controller_crosses_under_the_declared_mismatch() {
    for (name, most) in [("short", [2.7e-5, 3.7e-4]), ("pinched", [2e-4, 8.2e-4])] {
        let case = case(name);
        for (mismatch, most) in [Mismatch::NONE, Mismatch::default()].into_iter().zip(most) {
            let scenario = scenario(allowed(&case), mismatch);
            let record = run(&scenario, &moves(&case, &scenario.robot));
            assert_eq!(record.faults, [], "{name}");
            let (samples, _) = crossing_of(&case, &record);
            let error = samples
                .iter()
                .map(|sample| sample.tip_error())
                .fold(0.0, f64::max);
            assert!(error < most, "{name}: {error} m");
            assert!(!samples.iter().any(|sample| sample.saturated), "{name}");
            let last = record.trace.samples().last().unwrap();
            assert_eq!(assembly(&scenario.robot, samples[0]), Side::Left, "{name}");
            assert_eq!(assembly(&scenario.robot, last), Side::Right, "{name}");
        }
    }
}

/// A force on the tool [N], by |sin(θ3−θ2)| and its velocity [m/s].
type Force = fn(f64, Vector2<f64>) -> Vector2<f64>;

/// How a crossing against a force ended.
#[derive(Debug, Default)]
struct Ending {
    fault: Option<Fault>,
    /// Ticks of the crossing in the zone.
    in_zone: u32,
    homed: bool,
    powered: bool,
}

/// A crossing in `time` [s], in which this force hinders the tool.
fn hindered(case: &Value, time: f64, force: Force) -> Ending {
    let robot = allowed(case);
    let moves = moves_in(case, &robot, time);
    let scenario = scenario(robot, Mismatch::default());
    let mut target: InProcess = InProcess::new(&scenario.robot.settings().unwrap()).unwrap();
    let mut plant = scenario.plant().unwrap();
    let (mut offered, mut crossing) = (0, false);
    let mut ending = Ending::default();
    for tick in 0..100_000 {
        let (command, status) = target.tick(&plant.sense()).unwrap();
        ending.powered = command.enable != [false; 2];
        (ending.homed, ending.fault) = (status.homed, status.fault);
        let now = status.state == State::Crossing;
        if ending.fault.is_some() || (crossing && !now) {
            return ending;
        }
        crossing = now;
        if crossing {
            let q = plant.state().q;
            let sine = (q[2].angular - q[1].angular).sin().abs();
            ending.in_zone += u32::from(sine < 0.2);
            plant.set_tool_force(force(sine, plant.model().tool_velocity(plant.state())));
        }
        plant.step(&command, 1e-4);
        match (tick, status.state) {
            (0, _) => target.request(Request::Home).unwrap(),
            (_, State::Stopped) if status.homed => {
                // Refused until the arm rests.
                let _ = target.request(Request::Arm);
            }
            (_, State::Armed | State::Running) => {
                if let Some(next) = moves.get(offered) {
                    offered += usize::from(target.offer(next).unwrap());
                }
            }
            _ => {}
        }
    }
    panic!("the crossing never ends");
}

/// A force of 30 N against a velocity.
fn against(velocity: Vector2<f64>) -> Vector2<f64> {
    -velocity * (30.0 / velocity.norm().max(1e-3))
}

#[test]
fn a_stuck_arm_loses_its_torque_in_the_stated_time_and_its_angles() {
    let case = case("short");
    let time = 0.7;
    let free = hindered(&case, time, |_, _| Vector2::zeros());
    assert!(
        free.fault.is_none() && free.homed && free.powered,
        "{free:?}"
    );
    // In the zone: after twice the time that the plan takes there.
    let nearest = |sine, velocity| match sine < 0.1 {
        true => against(velocity),
        false => Vector2::zeros(),
    };
    let stuck = hindered(&case, time, nearest);
    assert_eq!(stuck.fault, Some(Fault::Envelope));
    assert!(!stuck.powered && !stuck.homed, "{stuck:?}");
    let times = f64::from(stuck.in_zone) / f64::from(free.in_zone);
    assert!(
        (1.97..2.06).contains(&times),
        "{times} times of {}",
        free.in_zone
    );
    // Before it: by the error of the cranks; the assembly mode is unknown.
    let before = hindered(&case, time, |_, velocity| against(velocity));
    assert_eq!(before.fault, Some(Fault::FollowingError));
    assert!(
        !before.powered && !before.homed && before.in_zone == 0,
        "{before:?}"
    );
}

/// A crossing in a job goes there, and back to the first assembly mode.
#[test]
fn a_job_crosses_and_comes_back() {
    let robot = Robot::load("host/files/robots/short_couplers.toml");
    let robot = robot.or_else(|_| Robot::load("../sim-harness/robots/short_couplers.toml"));
    let job = include_str!("../../../host/files/jobs/crossing.gcode");
    let mut scenario = Scenario::new("crossing", robot.unwrap(), "crossing.gcode", job.into());
    scenario.origin = Some([0.0; 2]);
    for share in [None, Some(0.7)] {
        scenario.time_optimal = share;
        let job = scenario.job().unwrap();
        scenario.check(&job).unwrap();
        let (_, record) = scenario.simulate(&job, &mut |_| ()).unwrap();
        assert_eq!(record.faults, []);
        let samples = record.trace.samples();
        let there = samples
            .iter()
            .rev()
            .find(|sample| sample.line == 9)
            .unwrap();
        assert_eq!(assembly(&scenario.robot, there), Side::Right);
        assert_eq!(
            assembly(&scenario.robot, samples.last().unwrap()),
            Side::Left
        );
        assert!(record.tip_error.max_m < 6.5e-4, "{:?}", record.tip_error);
    }
}

/// The controller's own refusals, whatever the host has planned.
#[test]
fn the_controller_refuses_what_is_no_crossing() {
    let case = case("short");
    let robot = allowed(&case);
    let [_, crossing] = moves(&case, &robot)[..] else {
        panic!("two moves");
    };
    let MoveKind::Crossing(plan) = crossing.kind else {
        panic!("a crossing");
    };
    let settings = robot.settings().unwrap();
    let planner = |allowed| {
        let settings = Settings {
            crossing_allowed: allowed,
            ..settings
        };
        Planner::new(&settings.check().unwrap())
    };
    let refusal = |plan, allowed| {
        let next = Move {
            kind: MoveKind::Crossing(plan),
            ..crossing
        };
        let from = pair(&case["start"]).map(|value| value as f32);
        planner(allowed)
            .check(from, &next)
            .map_err(|error| error.kind)
    };
    assert_eq!(refusal(plan, true), Ok(plan.to));
    assert_eq!(refusal(plan, false), Err(MoveErrorKind::CrossingNotAllowed));
    let [b0, b1, b2] = plan.law;
    let [x, y] = plan.from;
    let no_crossing = [
        // Another beginning than the place of rest, another time of the singularity.
        CrossingMove {
            from: [x + 1e-4, y],
            ..plan
        },
        CrossingMove {
            crosses_at: 0.9 * plan.crosses_at,
            ..plan
        },
        // An end before the singularity.
        CrossingMove {
            to: [0.05, 0.08],
            ..plan
        },
    ];
    for plan in no_crossing {
        assert_eq!(
            refusal(plan, true),
            Err(MoveErrorKind::Crossing),
            "{plan:?}"
        );
    }
    // Another acceleration in the singularity: s̈ by 3.5 1/s².
    let missed = CrossingMove {
        law: [b0, b1, b2 + 10.0],
        ..plan
    };
    assert_eq!(refusal(missed, true), Err(MoveErrorKind::CrossingCondition));
    let fast = CrossingMove {
        duration: 0.03,
        crosses_at: 0.1 * plan.crosses_at,
        ..plan
    };
    assert!(matches!(
        refusal(fast, true),
        Err(MoveErrorKind::Overload(_))
    ));
    // Beyond the end of the line, and back.
    let back = CrossingMove {
        law: [b0 + 200.0, b1, b2],
        ..plan
    };
    assert!(refusal(back, true).is_err());
    for duration in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let plan = CrossingMove { duration, ..plan };
        assert!(refusal(plan, true).is_err(), "{duration} s");
    }
}

/// Where laws change, in the singularity and beside it, the demanded torque does not step, whatever the encoders'
/// counts are.
#[test]
fn the_demanded_torque_is_continuous_from_law_to_law() {
    let case = case("short");
    let t_c = number(&case["tc"]);
    for (counts, most) in [(524_288, [5e-4, 8e-4]), (16_384, [6e-4, 1.1e-3])] {
        let mut robot = allowed(&case);
        for actuator in robot.actuators.iter_mut().flatten() {
            actuator.encoder_counts = counts;
        }
        let mut ticks = Vec::new();
        cross(&case, robot, Mismatch::default(), |arm, time| {
            ticks.push((time, arm.sine().abs(), arm.torque));
        });
        // In the singularity, and where one law takes over from the other.
        let mut steps = [0.0_f64; 2];
        for three in ticks.windows(3) {
            let [(_, _, before), (time, sine, _), (_, _, after)] = three else {
                continue;
            };
            let step = (0..2).map(|j| (after[j] - before[j]).abs());
            let step = step.fold(0.0, f64::max);
            let places = [(time - t_c).abs() < 2e-3, (0.01..0.31).contains(sine)];
            for (most, _) in steps.iter_mut().zip(places).filter(|&(_, here)| here) {
                *most = most.max(step);
            }
        }
        for (step, most) in steps.into_iter().zip(most) {
            assert!(0.0 < step && step < most, "{counts} counts: {step} N·m");
        }
    }
}
