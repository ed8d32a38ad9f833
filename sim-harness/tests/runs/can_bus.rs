//! Jobs on an arm whose drives are on a CAN bus.

use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::controller::Request;
use fivebar_firmware::drives::can::{BusCommand, BusDrives, BusSample};
use fivebar_firmware::safety::Fault;
use fivebar_firmware::{ArmCommand, ArmSample, Move, Status};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{CanPlant, FaultKind, Mismatch, PlantFault};
use fivebar_sim::link::{InProcess, Target, TargetError};
use fivebar_sim::simulation::{
    Record, RunError, Simulate, SimulatedArm, SimulatedDrives, Simulation, Summary,
};
use std::cell::RefCell;
use std::rc::Rc;

fn leg(change: impl Fn(&str) -> String) -> Robot {
    let text = BuiltIn::find("leg").expect("built in").text;
    Robot::parse("leg.toml", &change(text)).unwrap_or_else(|error| panic!("{error}"))
}

fn run(scenario: &Scenario) -> (Summary, Record) {
    let job = scenario.job().unwrap();
    scenario.simulate(&job, &mut |_| ()).unwrap()
}

fn demonstration() -> Scenario {
    let mut scenario = Scenario::demonstration(leg(str::to_owned));
    scenario.fit().unwrap();
    scenario
}

#[test]
fn the_demonstration_is_drawn_within_25_micrometres_whatever_the_torques_are_off_by() {
    let mut scenario = demonstration();
    let declared = scenario.mismatch;
    for mismatch in [
        declared,
        Mismatch {
            stiction: [0.3; 2],
            ..declared
        },
        Mismatch {
            link_mass: 0.3,
            ..declared
        },
        Mismatch {
            torque_constant: [-0.15, 0.15],
            ..declared
        },
    ] {
        scenario.mismatch = mismatch;
        let (summary, record) = run(&scenario);
        assert!(record.faults.is_empty(), "{:?}", record.faults);
        let error = summary.tip_error;
        assert!(error.rms_m < 25e-6 && error.max_m < 100e-6, "{error:?}");
        assert_eq!(summary.saturated_ticks, 0);
    }
}

/// An arm whose torques are written down in every tick, from its power-up on.
struct Watched {
    arm: CanPlant,
    torques: Rc<RefCell<Vec<[f64; 2]>>>,
}

impl SimulatedArm for Watched {
    type Interface = BusDrives;

    fn sense(&mut self) -> ArmSample<BusSample> {
        SimulatedArm::sense(&mut self.arm)
    }

    fn step(&mut self, command: &ArmCommand<BusCommand>, period: f64) {
        self.torques.borrow_mut().push(self.arm.torque());
        SimulatedArm::step(&mut self.arm, command, period);
    }

    fn schedule_faults(&mut self, faults: &[PlantFault]) {
        SimulatedArm::schedule_faults(&mut self.arm, faults);
    }

    fn tool(&self) -> [f64; 2] {
        SimulatedArm::tool(&self.arm)
    }

    fn angle(&self, joint: Joint) -> f64 {
        self.arm.angle(joint)
    }

    fn torque(&self) -> [f64; 2] {
        self.arm.torque()
    }

    fn current(&self) -> [f64; 2] {
        self.arm.current()
    }
}

/// The faults of the demonstration with this one, and the torques in each tick from it on [N·m].
fn torques_from(kind: FaultKind, at: f64) -> (Vec<Fault>, Vec<[f64; 2]>) {
    let scenario = demonstration();
    let moves = scenario.run_moves(&scenario.job().unwrap()).unwrap();
    let torques = Rc::new(RefCell::new(Vec::new()));
    let arm = Watched {
        arm: BusDrives::arm(&scenario).unwrap(),
        torques: Rc::clone(&torques),
    };
    let mut target = InProcess::new(&scenario.robot.settings().unwrap()).unwrap();
    let simulation = Simulation::new(&mut target, arm, 1000.0);
    let record = simulation
        .run(&moves, &[PlantFault { at, kind }], &mut |_| ())
        .unwrap();
    // In this tick the fault is injected: `at` is between two of them.
    let tick = ((record.begun.unwrap() + at) * 1000.0).ceil() as usize;
    let from = torques.borrow()[tick..].to_vec();
    (
        record.faults.into_iter().map(|(_, fault)| fault).collect(),
        from,
    )
}

#[test]
fn a_drive_that_is_silent_or_resets_and_a_bus_that_is_off_leave_both_without_torque_within_3_ms() {
    for kind in [
        FaultKind::CanSilent {
            joint: Joint::Joint1,
        },
        FaultKind::CanSilent {
            joint: Joint::Joint4,
        },
        FaultKind::CanReset {
            joint: Joint::Joint1,
        },
        FaultKind::CanReset {
            joint: Joint::Joint4,
        },
        FaultKind::CanBusOff,
    ] {
        let fault = match kind {
            FaultKind::CanBusOff => Fault::BusOff,
            _ => Fault::DriveSilent,
        };
        for at in [0.4996, 0.7506, 1.0016] {
            let (faults, torques) = torques_from(kind, at);
            assert_eq!(faults, [fault], "{kind:?}");
            assert!(
                torques[0].iter().all(|torque| torque.abs() > 1e-4),
                "{:?}",
                torques[0]
            );
            assert!(torques.len() > 50);
            for (tick, torque) in torques.iter().enumerate().skip(3) {
                assert_eq!(*torque, [0.0; 2], "{kind:?} at {at} s, {tick} ms after it");
            }
        }
    }
}

#[test]
fn frames_that_errors_hit_are_sent_again_in_their_tick() {
    let scenario = demonstration();
    let job = scenario.job().unwrap();
    let moves = scenario.run_moves(&job).unwrap();
    let run = |share: f64| {
        let mut arm = BusDrives::arm(&scenario).unwrap();
        arm.disturb(share);
        let mut target = InProcess::new(&scenario.robot.settings().unwrap()).unwrap();
        let simulation = Simulation::new(&mut target, arm, scenario.robot.control.tick_rate);
        simulation.run(&moves, &[], &mut |_| ()).unwrap()
    };
    let rare = run(1e-3);
    assert!(rare.faults.is_empty(), "{:?}", rare.faults);
    let often = run(0.5);
    assert_eq!(
        often.faults.first().map(|&(_, fault)| fault),
        Some(Fault::DriveSilent)
    );
}

#[test]
fn a_drive_in_error_by_its_own_watchdog_says_so() {
    // The controller misses two ticks, which it may; the drives get no command for 3 ms.
    let mut scenario = demonstration();
    let kind = FaultKind::TicksMissed { ticks: 2 };
    scenario.faults.push(PlantFault { at: 0.5, kind });
    let (summary, _) = run(&scenario);
    assert_eq!(summary.faults.len(), 1, "{:?}", summary.faults);
    assert!(["drive error", "drive silent"].contains(&summary.faults[0].as_str()));
}

#[test]
fn an_mit_type_pair_draws_as_finely_as_its_position_is_told() {
    let mut scenario = demonstration();
    scenario.robot = leg(|text| {
        text.replace(
            "protocol = \"odrive\"",
            "protocol = \"mit\"\nposition_range = 12.5\nvelocity_range = 640.0\ntorque_range = 2.0",
        )
    });
    scenario.fit().unwrap();
    let (summary, record) = run(&scenario);
    assert!(record.faults.is_empty(), "{:?}", record.faults);
    // A position is told and asked for in steps of 0.38 mrad of the drive: 11 µm at the knee.
    let error = summary.tip_error;
    assert!(error.rms_m < 50e-6, "{error:?}");
}

#[test]
fn what_is_of_brushed_motors_refuses_drives_on_a_bus() {
    let scenario = demonstration();
    let refused = |error: RunError| error.to_string().contains("has drives on a CAN bus");
    assert!(scenario.plant().is_err_and(refused));
    assert!(scenario.controller().is_err_and(refused));
}

#[test]
fn a_job_that_never_begins_ends_in_an_error() {
    /// Accepts every move, and does none.
    struct Idle(InProcess<BusDrives>);
    impl Target<BusDrives> for Idle {
        fn tick(
            &mut self,
            sample: &ArmSample<BusSample>,
        ) -> Result<(ArmCommand<BusCommand>, Status), TargetError> {
            self.0.tick(sample)
        }
        fn request(&mut self, request: Request) -> Result<(), TargetError> {
            self.0.request(request)
        }
        fn offer(&mut self, _: &Move) -> Result<bool, TargetError> {
            Ok(true)
        }
        fn is_idle(&self) -> bool {
            false
        }
    }
    let scenario = demonstration();
    let moves = scenario.run_moves(&scenario.job().unwrap()).unwrap();
    let mut target = Idle(InProcess::new(&scenario.robot.settings().unwrap()).unwrap());
    let arm = BusDrives::arm(&scenario).unwrap();
    let simulation = Simulation::new(&mut target, arm, scenario.robot.control.tick_rate);
    let ended = simulation.run(&moves, &[], &mut |_| ());
    assert!(matches!(ended, Err(TargetError::NeverDone(_))));
}
