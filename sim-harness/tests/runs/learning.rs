//! Jobs that are run again, learnt from what the encoders show.

use fivebar_files::job::Job;
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::{ControlLaw, Scenario};
use fivebar_plant::Mismatch;
use fivebar_sim::learning::{Forgotten, LearningError, Memory, Repetition, Response, repeat};
use fivebar_sim::simulation::Simulate;

/// A line, a turn back, a rest, a circle and a line home.
const JOB: &str = "G21 G90\nG1 X20 Y0 F9000\nX20 Y15\nX0 Y0\nG4 P0.1\nG2 X0 Y0 I8 J0\nG1 X5 Y-10\n";

fn robot(name: &str) -> Robot {
    BuiltIn::find(name).unwrap().robot().unwrap()
}

fn scenario(robot: Robot, mismatch: Mismatch) -> Scenario {
    Scenario {
        mismatch,
        ..Scenario::new("square", robot, "square", JOB.into())
    }
}

fn friction() -> Mismatch {
    Mismatch {
        friction: 0.5,
        link_mass: 0.1,
        stiction: [0.3, 0.3],
        cogging: [3e-3, 3e-3],
        ..Mismatch::NONE
    }
}

fn run(scenario: &Scenario, runs: usize, learn: bool, memory: Option<Memory>) -> Repetition {
    let job: Job = scenario.job().unwrap();
    repeat(scenario, &job, runs, learn, memory, &mut |_| ()).unwrap()
}

/// The errors that the sensors see, and the true ones, root mean square [m].
fn errors(repetition: &Repetition) -> Vec<[f64; 2]> {
    let rms = |run: &fivebar_sim::simulation::RunErrors| [run.sensed.rms_m, run.rms_m];
    repetition.runs.iter().map(rms).collect()
}

/// The exact model's error is what no learning of friction and masses can take. The figures [µm] are those of
/// docs/design/learning.md.
#[test]
fn what_friction_cogging_and_masses_do_is_learnt_to_the_exact_models_error() {
    for (name, [one, two, three, of_exact]) in [
        ("benchtop", [3.3, 1.8, 1.7, 1.5]),
        ("benchtop_belt", [6.4, 2.1, 1.8, 1.1]),
    ] {
        let exact = errors(&run(&scenario(robot(name), Mismatch::NONE), 1, false, None));
        let wrong = scenario(robot(name), friction());
        let found = run(&wrong, 4, true, None);
        assert_eq!(found.ended, None, "{name}");
        let runs = errors(&found);
        let (first, last) = (runs[0], runs[3]);
        let sensed = [runs[0][0], runs[1][0], runs[2][0], exact[0][0]];
        for (sensed, stated) in sensed.into_iter().zip([one, two, three, of_exact]) {
            let sensed = 1e6 * sensed;
            assert!(
                (sensed - stated).abs() < 0.1 * stated,
                "{name}: {sensed} for {stated}"
            );
        }
        for (seen, [first, last]) in [[first[0], last[0]], [first[1], last[1]]]
            .iter()
            .enumerate()
        {
            assert!(*last < 0.65 * first, "{name} {seen}: {runs:?}");
            assert!(
                *last < 1.7 * exact[0][seen],
                "{name} {seen}: {runs:?} {exact:?}"
            );
        }
        // Without learning it stays, and the runs tell that it repeats.
        let found = run(&wrong, 3, false, None);
        let [repeats, rest] = found.repeats.unwrap();
        assert!(
            repeats > 0.9 * first[0] && rest < 0.3 * repeats,
            "{repeats} {rest}"
        );
        assert!(found.memory.is_none());
    }
}

#[test]
fn the_path_is_followed_by_timed_moves_as_by_the_jobs_own() {
    let exact = scenario(robot("benchtop"), Mismatch::NONE);
    let found = run(&exact, 1, true, None);
    // Learnt from one run and not yet shifted.
    let memory = found.memory.clone().unwrap();
    assert_eq!(memory.greatest(), 0.0);
    let again = run(&exact, 1, true, Some(memory));
    let (plain, timed) = (found.runs[0], again.runs[0]);
    assert!(
        (plain.rms_m - timed.rms_m).abs() < 0.05 * plain.rms_m,
        "{plain:?} {timed:?}"
    );
    assert!(
        (plain.max_m - timed.max_m).abs() < 0.2 * plain.max_m,
        "{plain:?} {timed:?}"
    );
    let [before, after] = [&found, &again].map(|run| run.last.0.job_s.unwrap());
    assert!((before - after).abs() < 0.05, "{before} {after}");
}

#[test]
fn what_the_encoders_do_not_show_stays() {
    let mismatch = Mismatch {
        link_length: [5e-5, -5e-5, 5e-5, -5e-5],
        ..friction()
    };
    let runs = errors(&run(&scenario(robot("benchtop"), mismatch), 3, true, None));
    assert!(runs[2][0] < 0.6 * runs[0][0], "{runs:?}");
    assert!(
        (runs[2][1] - runs[0][1]).abs() < 0.1 * runs[0][1],
        "{runs:?}"
    );
    assert!(runs[2][1] > 40e-6, "{runs:?}");
}

#[test]
fn what_was_learnt_is_used_again_and_forgotten_with_the_robot_or_the_job() {
    let wrong = scenario(robot("benchtop"), friction());
    let found = run(&wrong, 3, true, None);
    let json = found.memory.as_ref().unwrap().to_json().unwrap();
    let of = |scenario: &Scenario| {
        let moves = scenario.run_moves(&scenario.job().unwrap()).unwrap();
        Memory::of(&json, scenario, &moves)
    };
    let kept = of(&wrong).unwrap();
    assert_eq!(kept, found.memory.clone().unwrap());
    let (before, again) = (errors(&found), errors(&run(&wrong, 1, true, Some(kept))));
    assert!(again[0][0] < 1.15 * before[2][0], "{before:?} {again:?}");

    let text = include_str!("../../robots/benchtop.toml");
    for (from, to) in [
        ("payload = 0.03", "payload = 0.04"),
        ("length = 0.16", "length = 0.1601"),
        ("max_acceleration = 4.0", "max_acceleration = 3.0"),
    ] {
        assert!(text.contains(from));
        let changed = Robot::parse("benchtop.toml", &text.replacen(from, to, 1)).unwrap();
        let changed = scenario(changed, friction());
        assert_eq!(of(&changed), Err(Forgotten::Robot), "{to}");
    }
    let pid = Scenario {
        control_law: ControlLaw::Pid,
        ..wrong.clone()
    };
    assert_eq!(of(&pid), Err(Forgotten::Robot));
    let elsewhere = Scenario {
        origin: Some([0.03, 0.16]),
        ..wrong.clone()
    };
    assert_eq!(of(&elsewhere), Err(Forgotten::Job));
    let refused = |json: &str| {
        let moves = wrong.run_moves(&wrong.job().unwrap()).unwrap();
        matches!(Memory::of(json, &wrong, &moves), Err(Forgotten::File(_)))
    };
    assert!(refused("{}") && refused(&json.replace("\"version\":1", "\"version\":2")));
}

/// A shift that belongs to another arm is unlearnt, because the controller's own feedback stays as it is.
#[test]
fn a_shift_of_an_arm_that_has_changed_since_is_unlearnt() {
    let wrong = scenario(robot("benchtop"), friction());
    let memory = run(&wrong, 3, true, None).memory;
    let serviced = scenario(robot("benchtop"), Mismatch::NONE);
    let runs = errors(&run(&serviced, 4, true, memory));
    assert!(runs[3][0] < 0.6 * runs[0][0], "{runs:?}");
}

#[test]
fn what_cannot_be_learnt_is_refused_with_the_reason() {
    let refused = |scenario: &Scenario| {
        let job = scenario.job().unwrap();
        match repeat(scenario, &job, 2, true, None, &mut |_| ()) {
            Err(error) => error,
            Ok(_) => panic!("{} was learnt", scenario.name),
        }
    };
    let steppers = refused(&scenario(robot("benchtop_stepper"), Mismatch::NONE));
    assert!(
        matches!(steppers, LearningError::NoEncoders("a stepper")),
        "{steppers}"
    );
}

/// The law with the arm's model answers a shift nearly as it should; independent joints, which take the inertia for
/// constant, may not.
#[test]
fn the_band_of_the_filter_follows_from_the_loop() {
    for (name, contraction) in [("benchtop", 0.49), ("benchtop_belt", 0.82)] {
        let robot = robot(name);
        let ours = Response::new(&robot, ControlLaw::ComputedTorque).unwrap();
        let filter = ours.filter().unwrap();
        // As in docs/design/learning.md.
        assert!(
            (filter.contraction - contraction).abs() < 0.01,
            "{filter:?}"
        );
        assert!((filter.half - 80.0).abs() < 1e-9, "{filter:?}");
        // A wider band converges less.
        assert!(ours.contraction(2.0 * filter.half) >= filter.contraction);
        let pid = Response::new(&robot, ControlLaw::Pid);
        assert!(matches!(pid, Err(LearningError::Unstable)), "{pid:?}");
    }
}

/// What is left of the error that the sensors see, and how far the true one may be [m]. Encoders of 14 bits, and angles that
/// MIT-type drives cut off, are what no learning takes: of ODrives, whose springs leave less than that, the true error grows.
#[test]
fn what_friction_cogging_and_masses_do_is_learnt_by_drives_on_a_bus() {
    let leg = BuiltIn::find("leg").unwrap().text;
    let mit = leg.replace(
        "protocol = \"odrive\"",
        "protocol = \"mit\"\nposition_range = 12.5\nvelocity_range = 640.0\ntorque_range = 2.0",
    );
    for (name, text, left, most) in [("leg", leg, 0.6, 13e-6), ("mit", &mit, 0.45, 21e-6)] {
        let robot = Robot::parse(name, text).unwrap();
        let found = run(&scenario(robot, friction()), 4, true, None);
        assert_eq!(found.ended, None, "{name}");
        let runs = errors(&found);
        let [[seen, _], .., [seen_after, true_after]] = runs[..] else {
            panic!("{name}: {runs:?}")
        };
        println!("{name}: {runs:?}");
        assert!(
            seen_after < left * seen && true_after < most,
            "{name}: {runs:?}"
        );
    }
}
