//! An upright arm and its holding brakes, which take time to engage and to release: how far it falls.

use fivebar_files::robot::Robot;
use fivebar_firmware::Status;
use fivebar_firmware::controller::Request;
use fivebar_firmware::safety::{Fault, State};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{FaultKind, Mismatch, Plant};
use fivebar_sim::link::{InProcess, Target};

const TICK: f64 = 1e-4;

/// The benchtop arm upright, with brakes that take 50 ms.
fn upright() -> Robot {
    let text = include_str!("../../../host/files/robots/benchtop.toml")
        .replace("gravity = [0.0, 0.0]", "gravity = [0.0, -9.81]")
        .replace("encoder_counts = ", "brake_torque = 0.5\nencoder_counts = ");
    Robot::parse("upright", &text).unwrap()
}

/// The arm and its controller.
struct Run {
    target: InProcess,
    plant: Plant,
    /// The height at which the measurement began [m].
    from: f64,
    /// The deepest that the tool has been below it [m].
    fall: f64,
}

impl Run {
    /// At its home position, held by its brakes.
    fn new() -> Self {
        let robot = upright();
        let parameters = robot.plant_parameters().unwrap();
        let home = robot.home_pose().unwrap();
        let mut run = Self {
            target: InProcess::new(&robot.settings().unwrap()).unwrap(),
            plant: Plant::new(&parameters, &Mismatch::NONE, &home, 1),
            from: 0.0,
            fall: 0.0,
        };
        run.tick();
        run
    }

    /// Homed, and armed with free brakes.
    fn armed() -> Self {
        let mut run = Self::new();
        run.request(Request::Home);
        run.until(State::Stopped);
        run.request(Request::Arm);
        let status = run.ticks(2000);
        assert_eq!(status.state, State::Armed, "{:?}", status.fault);
        run.measure();
        run
    }

    fn request(&mut self, request: Request) {
        self.target.request(request).unwrap();
    }

    /// Begins to measure how far the tool falls.
    fn measure(&mut self) {
        self.from = self.plant.tool().y;
        self.fall = 0.0;
    }

    fn tick(&mut self) -> Status {
        let sample = self.plant.sense();
        let (command, status) = self.target.tick(&sample).unwrap();
        self.plant.step(&command, TICK);
        self.fall = self.fall.max(self.from - self.plant.tool().y);
        status
    }

    fn ticks(&mut self, ticks: u32) -> Status {
        let mut status = self.tick();
        for _ in 1..ticks {
            status = self.tick();
        }
        status
    }

    #[track_caller]
    fn until(&mut self, state: State) -> Status {
        (0..200_000)
            .map(|_| self.tick())
            .find(|status| status.state == state)
            .expect("the state comes")
    }
}

#[test]
fn an_upright_arm_does_not_fall_when_it_is_armed_homed_and_disarmed() {
    let mut run = Run::new();
    run.measure();
    run.request(Request::Home);
    run.ticks(516);
    assert!(run.fall < 2e-4, "it sags by {} m before it homes", run.fall);
    assert!(run.until(State::Stopped).homed);
    run.measure();
    run.ticks(2000);
    assert!(run.fall < 1e-4, "it falls by {} m after homing", run.fall);
    run.request(Request::Arm);
    run.ticks(2000);
    assert!(run.fall < 1e-4, "it falls by {} m when armed", run.fall);
    run.request(Request::Disarm);
    run.until(State::Stopped);
    run.ticks(3000);
    assert!(run.fall < 1e-4, "it falls by {} m when disarmed", run.fall);
}

/// The distance that docs/use/faults.md states.
#[test]
fn an_upright_arm_falls_until_its_brakes_engage_when_its_power_is_cut() {
    let mut run = Run::armed();
    run.request(Request::EmergencyStop);
    run.ticks(3000);
    assert!((0.012..0.017).contains(&run.fall), "{} m", run.fall);
}

#[test]
fn brakes_that_engage_later_than_they_should_are_waited_for_or_found() {
    // Some milliseconds later they hold before the torque is gone; much later they are found.
    for (seconds, fault) in [(0.02, None), (0.2, Some(Fault::BrakeFailed))] {
        let mut run = Run::armed();
        for joint in Joint::ALL {
            run.plant.inject(FaultKind::BrakeLate { joint, seconds });
        }
        run.request(Request::Disarm);
        let status = run.ticks(4000);
        assert_eq!(status.fault, fault, "{seconds} s");
        assert!(run.fall < 2e-3, "{seconds} s: it falls by {} m", run.fall);
    }
}

#[test]
fn an_arm_whose_brakes_fail_is_held_by_its_motors() {
    for both in [false, true] {
        let mut run = Run::armed();
        run.plant.inject(FaultKind::BrakeFails {
            joint: Joint::Joint1,
        });
        if both {
            run.plant.inject(FaultKind::BrakeFails {
                joint: Joint::Joint4,
            });
        }
        run.request(Request::Disarm);
        let status = run.ticks(20_000);
        assert_eq!(status.fault, Some(Fault::BrakeFailed));
        assert!(run.fall < 3e-3, "it falls by {} m", run.fall);
    }
}
