use super::{LiveArm, LiveError, Pace, Pending};
use crate::controller::ControllerSource;
use crate::drive::{DriveError, Homing};
use crate::streaming::{SetPoint, StreamOptions};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::motion::{Impedance, StreamMode, StreamPolicy};
use fivebar_firmware::safety::{Fault, State};

/// One robot of each kind of drives.
const KINDS: [&str; 4] = ["benchtop", "benchtop_stepper", "leg", "classroom_servo"];

fn arm(name: &str) -> LiveArm {
    let robot = Robot::load(name).unwrap();
    LiveArm::open(&robot, ControllerSource::Simulated, Pace::AsFastAsPossible).unwrap()
}

fn homed(name: &str) -> LiveArm {
    let arm = arm(name);
    arm.home(Homing::IfUnknown).unwrap().finish().unwrap();
    arm
}

fn state(arm: &LiveArm) -> State {
    arm.progress().status.state
}

fn place(arm: &LiveArm) -> [f32; 2] {
    arm.progress().status.tool.unwrap()
}

fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// A job whose origin is where the tool is.
fn job_here(arm: &LiveArm, text: String) -> Scenario {
    let origin = Some(place(arm).map(f64::from));
    let scenario = Scenario::new("job", arm.robot().clone(), "job", text);
    Scenario { origin, ..scenario }
}

/// Lines back and forth about where the tool is: the whole takes minutes of the arm's time.
fn long_job(arm: &LiveArm) -> Scenario {
    let lines = "G1 X4 Y0 F120\nG1 X0 Y0\n".repeat(40);
    job_here(arm, format!("G21 G90\n{lines}"))
}

/// A homed arm with motors that are on, which draws a long job: with the job, and with the call.
fn drawing(name: &str) -> (LiveArm, Scenario, Pending) {
    let arm = homed(name);
    arm.motors_on().unwrap().finish().unwrap();
    let scenario = long_job(&arm);
    let drawn = arm.draw(&scenario, &scenario.job().unwrap()).unwrap();
    until(&arm, |arm| state(arm) == State::Running);
    (arm, scenario, drawn)
}

/// Waits until the arm is as wanted, whose thread goes on meanwhile.
fn until(arm: &LiveArm, wanted: impl Fn(&LiveArm) -> bool) {
    while !wanted(arm) {
        std::thread::yield_now();
    }
}

#[test]
fn every_kind_homes_moves_draws_and_switches_off() {
    for name in KINDS {
        let arm = homed(name);
        let first = arm.progress().status;
        assert!(first.homed, "{name}");
        arm.motors_on().unwrap().finish().unwrap();
        assert_eq!(state(&arm), State::Armed, "{name}");
        let [x, y] = place(&arm);
        let target = [x + 2e-3, y];
        arm.move_to(target, 0.02).unwrap().finish().unwrap();
        let off = distance(place(&arm), target);
        assert!(off < 1e-3, "{name}: {off}");
        let joints = arm.progress().status.angle.map(|it| it + 5e-3);
        arm.move_joints(joints, 0.05).unwrap().finish().unwrap();
        let turned = arm.progress().status.angle;
        let off = distance(turned, joints);
        assert!(off < 1e-2, "{name}: {off} rad");
        arm.motors_off().unwrap().finish().unwrap();
        assert_eq!(state(&arm), State::Stopped, "{name}");
        assert!(matches!(
            arm.move_to(target, 0.02).err(),
            Some(LiveError::MotorsOff | LiveError::Drive(DriveError::NotHomed))
        ));
        arm.close().unwrap();
        assert!(matches!(arm.motors_on().err(), Some(LiveError::Ended(_))));
    }
}

#[test]
fn a_stop_ends_a_job_at_rest_and_the_motors_hold_the_arm() {
    for name in KINDS {
        let (arm, _, drawn) = drawing(name);
        assert!(matches!(arm.motors_off().err(), Some(LiveError::Busy)));
        arm.stop();
        let ended = drawn.finish();
        assert!(
            matches!(ended, Err(LiveError::Drive(DriveError::Stopped(_)))),
            "{name}: {ended:?}"
        );
        assert_eq!(state(&arm), State::Armed, "{name}");
    }
}

#[test]
fn nothing_moves_after_an_emergency_stop_until_the_fault_is_cleared() {
    for name in KINDS {
        let (arm, scenario, drawn) = drawing(name);
        arm.emergency_stop().unwrap();
        let stopped = DriveError::Fault(Fault::EmergencyStop).to_string();
        let ended = drawn.finish().unwrap_err().to_string();
        assert_eq!(ended, stopped, "{name}");
        let status = arm.progress().status;
        assert_eq!(
            (status.state, status.fault),
            (State::Fault, Some(Fault::EmergencyStop)),
            "{name}"
        );
        let refused = arm.motors_on().unwrap().finish().unwrap_err().to_string();
        assert!(
            refused.contains("not possible while Fault"),
            "{name}: {refused}"
        );
        // Also of an arm whose place is lost with its power.
        let job = scenario.job().unwrap();
        let refused = arm.draw(&scenario, &job).err().unwrap().to_string();
        assert_eq!(refused, stopped, "{name}");
        // An arm that turns on without power is cleared when it rests.
        while arm.clear_fault().unwrap().finish().is_err() {}
        assert_eq!(state(&arm), State::Stopped, "{name}");
    }
}

#[test]
fn a_job_that_finds_the_motors_off_leaves_them_off_and_one_that_finds_them_on_leaves_them_on() {
    let arm = homed("benchtop");
    let [x, y] = place(&arm);
    let text = "G21 G90\nG1 X0 Y0 F600\nG1 X5 Y0\nM0\nG1 X0 Y0\n";
    let scenario = job_here(&arm, text.into());
    let job = scenario.job().unwrap();
    for (left, on) in [(State::Stopped, false), (State::Armed, true)] {
        if on {
            arm.motors_on().unwrap().finish().unwrap();
        }
        let drawn = arm.draw(&scenario, &job).unwrap();
        until(&arm, |arm| arm.progress().pause.is_some());
        let waits = arm.progress();
        assert!(waits.taken < waits.moves, "{waits:?}");
        assert!(distance(place(&arm), [x + 5e-3, y]) < 2e-4);
        arm.go_on();
        drawn.finish().unwrap();
        let done = arm.progress();
        assert_eq!((done.pause, done.taken), (None, done.moves));
        assert_eq!(done.status.state, left);
    }
}

/// A circle of 4 mm from where the tool is, or of the joints, in a second.
fn streamed(arm: &LiveArm, mode: StreamMode, points: u32) -> Result<(), LiveError> {
    let status = arm.progress().status;
    let from = match mode {
        StreamMode::Tip | StreamMode::Free | StreamMode::Impedance(_) => status.tool.unwrap(),
        StreamMode::Joint => status.angle,
    };
    let scale = [0.02, 2e-3][usize::from(mode == StreamMode::Tip)];
    let stream = arm.stream(StreamOptions {
        mode,
        rate: 200.0,
        delay: None,
        policy: StreamPolicy::Stop,
        fixtures: [None; 3],
    })?;
    for point in 0..points {
        let time = f64::from(point) / 200.0;
        // Smoothly from rest.
        let turned = std::f64::consts::TAU * time * time * (3.0 - 2.0 * time.min(1.0));
        let (sine, cosine) = turned.sin_cos();
        let position = [
            f64::from(from[0]) + scale * (1.0 - cosine),
            f64::from(from[1]) + scale * sine,
        ];
        if !stream.send(SetPoint::at(position)) {
            break;
        }
    }
    stream.finish()
}

#[test]
fn every_kind_follows_a_stream_and_rests_behind_it() {
    for name in KINDS {
        let arm = homed(name);
        arm.motors_on().unwrap().finish().unwrap();
        for mode in [StreamMode::Tip, StreamMode::Joint] {
            let before = place(&arm);
            streamed(&arm, mode, 200).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(state(&arm), State::Armed, "{name}");
            let off = distance(place(&arm), before);
            assert!(off < 2e-3, "{name} {mode:?}: {off} m");
        }
    }
}

/// A host that draws a circle, half of which is out of reach.
#[test]
fn every_kind_stays_within_its_limits_and_comes_back_where_limits_do_not_end_the_stream() {
    for name in KINDS {
        let arm = homed(name);
        arm.motors_on().unwrap().finish().unwrap();
        let [x, y] = place(&arm).map(f64::from);
        let stream = arm
            .stream(StreamOptions {
                mode: StreamMode::Tip,
                rate: 200.0,
                delay: None,
                policy: StreamPolicy::Limit,
                fixtures: [None; 3],
            })
            .unwrap();
        for point in 0..800 {
            let u = (f64::from(point) / 400.0).min(1.0);
            let (sine, cosine) = (std::f64::consts::TAU * u * u * (3.0 - 2.0 * u)).sin_cos();
            let position = [x + 0.1 * sine, y + 0.3 * (1.0 - cosine)];
            assert!(stream.send(SetPoint::at(position)), "{name}");
        }
        stream
            .finish()
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(state(&arm), State::Armed, "{name}");
        let told = arm.progress().stream.expect("a state").progress;
        assert!((100..700).contains(&told.limited), "{name}: {told:?}");
        let off = distance(place(&arm), [x, y].map(|value| value as f32));
        assert!(off < 2e-3, "{name}: {off} m");
    }
}

#[test]
fn an_arm_with_brushed_motors_is_a_spring_and_other_kinds_refuse_with_the_reason() {
    for name in KINDS {
        let arm = homed(name);
        arm.motors_on().unwrap().finish().unwrap();
        let before = place(&arm);
        let impedance = Impedance {
            stiffness: (60.0, 0.0, 60.0),
            damping: (0.02, 0.0, 0.02),
        };
        let options = StreamOptions {
            mode: StreamMode::Impedance(impedance),
            rate: 200.0,
            delay: None,
            policy: StreamPolicy::Stop,
            fixtures: [None; 3],
        };
        let stream = arm.stream(options).unwrap();
        let [x, y] = before.map(f64::from);
        for _ in 0..400 {
            if !stream.send(SetPoint::at([x, y + 5e-3])) {
                break;
            }
        }
        let ended = stream.finish();
        if name == "benchtop" {
            ended.unwrap();
            assert_eq!(state(&arm), State::Armed);
            let moved = f64::from(place(&arm)[1]) - y;
            assert!((moved - 5e-3).abs() < 5e-4, "{moved} m");
            // A spring without stiffness leaves the arm where it is, and is told so.
            let stream = arm.stream(options).unwrap();
            let none = Impedance {
                stiffness: (0.0, 0.0, 0.0),
                ..impedance
            };
            assert!(stream.send(SetPoint::at([x, y + 5e-3])) && stream.change(none));
            for point in 0..200 {
                let away = if point < 40 { 5e-3 } else { 0.0 };
                assert!(stream.send(SetPoint::at([x, y + away])));
            }
            stream.finish().unwrap();
            let moved = f64::from(place(&arm)[1]) - y;
            assert!(moved > 4e-3, "{moved} m");
        } else {
            let refused = ended.unwrap_err().to_string();
            assert!(refused.contains("arms with brushed motors"), "{refused}");
        }
    }
}

#[test]
fn a_stream_ends_by_its_limit_a_stop_and_an_emergency_stop() {
    let arm = homed("benchtop");
    let off = streamed(&arm, StreamMode::Tip, 5).unwrap_err();
    assert!(matches!(off, LiveError::MotorsOff), "{off}");
    arm.motors_on().unwrap().finish().unwrap();
    let stream = |mode| {
        let (rate, delay) = (200.0, None);
        arm.stream(StreamOptions {
            mode,
            rate,
            delay,
            policy: StreamPolicy::Stop,
            fixtures: [None; 3],
        })
        .unwrap()
    };
    let [x, y] = place(&arm).map(f64::from);
    let along = |way: f64| SetPoint::at([x + way, y]);

    let begun = stream(StreamMode::Tip);
    let mut way = 0.0;
    while begun.send(along(way)) {
        way += 1e-3 * (way / 0.01 + 0.02).min(1.0);
    }
    let ended = begun.finish().unwrap_err().to_string();
    assert!(
        ended.contains("a limit keeps the arm from a point"),
        "{ended}"
    );
    assert_eq!(state(&arm), State::Armed);

    let begun = stream(StreamMode::Tip);
    while begun.send(along(1.0)) {}
    let ended = begun.finish().unwrap_err().to_string();
    assert!(ended.contains("from the arm: move there first"), "{ended}");

    let begun = stream(StreamMode::Tip);
    arm.stop();
    assert!(!begun.send(along(0.0)));
    let ended = begun.finish().unwrap_err();
    assert!(
        matches!(ended, LiveError::Drive(DriveError::Stopped(_))),
        "{ended}"
    );

    let begun = stream(StreamMode::Tip);
    arm.emergency_stop().unwrap();
    while begun.send(along(0.0)) {}
    let ended = begun.finish().unwrap_err();
    assert!(
        matches!(
            ended,
            LiveError::Drive(DriveError::Fault(Fault::EmergencyStop))
        ),
        "{ended}"
    );
}

#[test]
fn an_arm_that_is_dropped_while_it_moves_is_at_rest_and_off() {
    let arm = homed("benchtop");
    let shared = arm.shared.clone();
    let scenario = long_job(&arm);
    let drawn = arm.draw(&scenario, &scenario.job().unwrap()).unwrap();
    until(&arm, |arm| state(arm) == State::Running);
    drop(arm);
    assert!(drawn.finish().is_err());
    let status = shared.progress().status;
    assert!(matches!(status.state, State::Armed | State::Stopped));
    assert!(
        status.velocity.iter().all(|rate| rate.abs() < 0.05),
        "{status:?}"
    );
}

#[test]
fn jobs_out_of_reach_and_unknown_places_are_refused_before_anything_moves() {
    let arm = arm("benchtop");
    let scenario = Scenario::new(
        "job",
        arm.robot().clone(),
        "job",
        "G21 G90\nG1 X900 Y900 F600\n".into(),
    );
    let job = scenario.job().unwrap();
    let refused = arm.draw(&scenario, &job).err().unwrap().to_string();
    assert_eq!(refused, "the joint angles are unknown: home first");
    arm.home(Homing::IfUnknown).unwrap().finish().unwrap();
    let before = place(&arm);
    let refused = arm.draw(&scenario, &job).err().unwrap().to_string();
    assert!(refused.contains("limits"), "{refused}");
    // A refused call leaves the arm free for the next one.
    arm.motors_on().unwrap().finish().unwrap();
    assert!(arm.move_to([0.9, 0.9], 0.1).is_err());
    assert!(distance(place(&arm), before) < 1e-4);
}

/// Its thread ends without a word, as in a panic.
#[test]
fn who_asks_for_an_emergency_stop_learns_that_the_thread_has_ended() {
    let arm = homed("benchtop");
    let asked = arm.shared.ask_for_emergency_stop();
    arm.shared.note_end();
    assert!(asked.recv().is_err());
    let refused = arm.emergency_stop();
    assert!(matches!(refused, Err(LiveError::Ended(_))), "{refused:?}");
}
