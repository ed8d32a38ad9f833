//! Crossings on the production image: the built-in example is driven through the singularity and
//! back, what is no crossing is refused, and an arm that is stuck in the singularity, or in the wrong assembly
//! mode behind it, loses its torque.

mod bench;

use bench::{Bench, Driven, arm_in};
use fivebar_chip::time::MILLISECOND;
use fivebar_chip::{Options, SharedArm};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::protocol::{CommandError, HostCommand, Reply};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{CrossingMove, FULL_TOOL, Move, MoveKind, Request, Settings};
use fivebar_kinematics::five_bar::{Joint, Side};
use fivebar_plant::FaultKind;
use fivebar_sim::drive::Drive;
use nalgebra::Vector2;

const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../host/files");

fn robot() -> Robot {
    Robot::load(&format!("{EXAMPLES}/robots/short_couplers.toml")).expect("a robot file")
}

fn settings() -> Settings {
    robot().settings().expect("masses")
}

/// The moves of the built-in job: there and back.
fn job() -> Vec<Move> {
    let path = format!("{EXAMPLES}/jobs/crossing.gcode");
    let mut scenario = Scenario::of_job(&path, robot()).expect("a job file");
    scenario.origin = Some([0.0; 2]);
    let job = scenario.job().expect("a job");
    scenario.moves(&job).expect("a job without M780")
}

/// The job's first crossing.
fn plan() -> CrossingMove {
    let crossing = |next: Move| match next.kind {
        MoveKind::Crossing(plan) => Some(plan),
        _ => None,
    };
    job().into_iter().find_map(crossing).expect("a crossing")
}

/// The arm with its tool where the first crossing begins.
fn at_the_beginning(settings: &Settings) -> Driven {
    let robot = robot();
    let point = Vector2::from(plan().from.map(f64::from));
    let pose = robot.geometry.inverse(point, robot.elbows).expect("a pose");
    let arm = arm_in(&robot, &pose, MILLISECOND);
    Bench::of(arm, Options::default(), Vec::new()).ready_as(settings)
}

/// The assembly mode of the simulated arm, by its true cranks and tool.
fn assembly(arm: &SharedArm) -> Side {
    let arm = arm.get();
    let [theta1, theta4] = Joint::ALL.map(|joint| arm.plant().angle(joint));
    let is_in = |side: &Side| {
        let pose = robot().geometry.forward(theta1, theta4, *side);
        (pose.expect("a pose").c - arm.plant().tool()).norm() < 1e-6
    };
    Side::BOTH.into_iter().find(is_in).expect("a mode")
}

fn offer(driven: &mut Driven, tool: u16, plan: CrossingMove) -> Reply {
    let kind = MoveKind::Crossing(plan);
    let next = Move { tag: 7, tool, kind };
    let reply = driven.client.call(HostCommand::Move(next));
    reply.expect("an answer")
}

fn refusal(driven: &mut Driven, tool: u16, plan: CrossingMove) -> MoveErrorKind {
    match offer(driven, tool, plan) {
        Reply::Refused(CommandError::Move(error)) => error.kind,
        other => panic!("{plan:?}: {other:?}"),
    }
}

#[test]
fn the_built_in_job_crosses_to_the_other_assembly_mode_and_comes_back() {
    let mut driven = at_the_beginning(&settings());
    driven.arm();
    driven.request(Request::Disarm).expect("disarmed");
    // The mode between the crossings, as often as it changes.
    let arm = driven.arm.clone();
    let mut modes = vec![assembly(&arm)];
    let mut drive = Drive::new(&mut driven.client, &|| false);
    let followed = drive.follow(&job(), &settings(), &mut |_, status| {
        if status.state != State::Crossing {
            modes.push(assembly(&arm));
        }
    });
    followed.expect("the moves are executed");
    modes.dedup();
    assert_eq!(modes, [Side::Left, Side::Right, Side::Left]);
    let away = arm.get().plant().tool() - Vector2::new(0.055, 0.115);
    assert!(away.norm() < 5e-4, "{} m", away.norm());
    let status = driven.status();
    assert_eq!((status.state, status.fault), (State::Stopped, None));
}

#[test]
fn what_is_no_crossing_of_this_arm_is_refused() {
    let forbidden = Settings {
        crossing_allowed: false,
        ..settings()
    };
    let mut driven = at_the_beginning(&forbidden);
    driven.arm();
    let plan = plan();
    let refused = refusal(&mut driven, 0, plan);
    assert_eq!(refused, MoveErrorKind::CrossingNotAllowed);
    driven.request(Request::Disarm).expect("disarmed");
    let written = driven.client.write_settings(&settings()).expect("a line");
    written.expect("the settings are applied");
    driven.arm();

    let with_tool = refusal(&mut driven, FULL_TOOL, plan);
    assert_eq!(with_tool, MoveErrorKind::Crossing);
    let [b0, b1, b2] = plan.law;
    let [x, y] = plan.from;
    for plan in [
        // Not from where the arm is held.
        CrossingMove {
            from: [x, y + 1e-4],
            ..plan
        },
        // Another time of the singularity.
        CrossingMove {
            crosses_at: 0.9 * plan.crosses_at,
            ..plan
        },
        // It ends before the singularity.
        CrossingMove {
            to: [0.05, 0.08],
            ..plan
        },
    ] {
        let refused = refusal(&mut driven, 0, plan);
        assert_eq!(refused, MoveErrorKind::Crossing, "{plan:?}");
    }
    // s̈ differs by 3.5 1/s² in the singularity.
    let missed = CrossingMove {
        law: [b0, b1, b2 + 10.0],
        ..plan
    };
    assert_eq!(
        refusal(&mut driven, 0, missed),
        MoveErrorKind::CrossingCondition
    );
    let number = CrossingMove {
        duration: f32::NAN,
        ..plan
    };
    assert_eq!(refusal(&mut driven, 0, number), MoveErrorKind::Number);
    let fast = CrossingMove {
        duration: 0.1 * plan.duration,
        crosses_at: 0.1 * plan.crosses_at,
        ..plan
    };
    let refused = refusal(&mut driven, 0, fast);
    assert!(matches!(refused, MoveErrorKind::Overload(_)), "{refused:?}");
    let status = driven.status();
    assert_eq!((status.state, status.fault), (State::Armed, None));
    assert_eq!(assembly(&driven.arm), Side::Left);
}

/// sin(θ3−θ2) of the simulated arm.
fn sine(driven: &Driven) -> f64 {
    let arm = driven.arm.get();
    let q = &arm.plant().state().q;
    (q[2].angular - q[1].angular).sin()
}

#[test]
fn an_arm_that_jams_in_the_singularity_loses_its_torque_and_its_angles() {
    let mut driven = at_the_beginning(&settings());
    driven.arm();
    let taken = offer(&mut driven, 0, plan());
    assert!(matches!(taken, Reply::Taken { .. }), "{taken:?}");
    let before = sine(&driven);
    while sine(&driven) * before.signum() > 0.05 {
        driven.run(MILLISECOND);
    }
    assert_eq!(driven.status().state, State::Crossing);
    for joint in Joint::ALL {
        driven.arm.get().inject(FaultKind::MotorStalled { joint });
    }
    // Twice the time that the plan takes in the zone.
    driven.run(90 * MILLISECOND);
    let status = driven.status();
    assert_eq!(status.fault, Some(Fault::Envelope));
    assert!(!status.homed && driven.is_off_twice());
}

#[test]
fn an_arm_that_comes_back_to_its_assembly_mode() {
    let mut driven = at_the_beginning(&settings());
    driven.arm();
    let taken = offer(&mut driven, 0, plan());
    assert!(matches!(taken, Reply::Taken { .. }), "{taken:?}");
    let before = sine(&driven).signum();
    while sine(&driven) * before > -0.05 {
        driven.run(MILLISECOND);
    }
    // The links go into the first mode, the cranks on as they are.
    let state = *driven.arm.get().plant().state();
    let geometry = robot().geometry;
    let [theta1, theta4] = [0, 3].map(|link| state.q[link].angular);
    let [omega1, omega4] = [0, 3].map(|link| state.v[link].angular);
    let pose = geometry
        .forward(theta1, theta4, Side::Left)
        .expect("a pose");
    let velocities = geometry.forward_velocities(&pose, omega1, omega4);
    let omega = velocities.expect("velocities").omega;
    let mut links = driven.arm.get().plant().model().state_at(&pose, omega);
    for link in [0, 3] {
        links.q[link].angular = state.q[link].angular;
    }
    driven.arm.get().set_links(&links);
    while driven.status().state == State::Crossing {
        driven.run(MILLISECOND);
    }
    let status = driven.status();
    assert_eq!(status.fault, Some(Fault::AssemblyMode));
    assert!(!status.homed && driven.is_off_twice());
}
