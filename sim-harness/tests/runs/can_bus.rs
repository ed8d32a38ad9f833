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

const PROTOCOLS: [&str; 2] = [
    "protocol = \"odrive\"",
    "protocol = \"mit\"\nposition_range = 12.5\nvelocity_range = 640.0\ntorque_range = 2.0",
];

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
fn the_demonstration_is_drawn_within_15_micrometres_whatever_the_torques_are_off_by() {
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
        assert!(error.rms_m < 15e-6 && error.max_m < 100e-6, "{error:?}");
        assert_eq!(summary.saturated_ticks, 0);
    }
}

/// The jerk of such a plan is a hundred times that of the demonstration: the drives' own encoder loops lag behind it, and their
/// springs hold little of what the model does not know, so the arm's inertia is learnt. The greatest errors without a
/// [`Mismatch`], with the declared one, and with links of a fifth less, or of a third more and twice the payload.
#[test]
fn a_time_optimal_motion_is_followed_by_arms_of_other_inertia_than_their_files() {
    let mit = PROTOCOLS[1];
    for (bandwidth, protocol, most) in [
        ("3000.0", PROTOCOLS[0], [55e-6, 70e-6, 60e-6, 140e-6]),
        ("1000.0", PROTOCOLS[0], [100e-6, 250e-6, 130e-6, 520e-6]),
        ("1000.0", mit, [130e-6, 260e-6, 150e-6, 520e-6]),
    ] {
        let mut scenario = demonstration();
        scenario.robot = leg(|text| {
            text.replace("= 3000.0", &format!("= {bandwidth}"))
                .replace(PROTOCOLS[0], protocol)
        });
        scenario.time_optimal = Some(0.7);
        scenario.fit().unwrap();
        let light = Mismatch {
            link_mass: -0.2,
            ..Mismatch::NONE
        };
        let heavy = Mismatch {
            link_mass: 0.3,
            payload: 0.04,
            ..Mismatch::NONE
        };
        let arms = [Mismatch::NONE, scenario.mismatch, light, heavy];
        for (mismatch, most) in arms.into_iter().zip(most) {
            scenario.mismatch = mismatch;
            let (summary, record) = run(&scenario);
            assert!(record.faults.is_empty(), "{:?}", record.faults);
            let error = summary.tip_error;
            println!("{bandwidth}, {protocol}: {error:?}");
            assert!(error.rms_m < most, "{bandwidth}, {protocol}: {error:?}");
        }
    }
}

/// Gravity at home would take a loop alone 12 mrad.
#[test]
fn an_arm_that_searches_for_its_switches_under_gravity_is_carried() {
    let robot = leg(|text| {
        let text = text.replace("method = \"absolute\"", "method = \"switch\"");
        text.replace("following_error = 0.05", "following_error = 0.005")
    });
    let mut scenario = Scenario::demonstration(robot);
    scenario.fit().unwrap();
    let (summary, record) = run(&scenario);
    assert!(record.faults.is_empty(), "{:?}", record.faults);
    assert!(summary.tip_error.max_m < 1e-4, "{:?}", summary.tip_error);
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
fn a_drive_that_is_silent_or_resets_and_a_bus_that_is_off_leave_both_without_torque_within_4_ms() {
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
            for (tick, torque) in torques.iter().enumerate().skip(4) {
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
fn ticks_that_may_be_missed_trip_no_watchdog_of_a_drive() {
    let mut scenario = demonstration();
    for (ticks, fault) in [(1, None), (2, None), (3, Some("ticks missed"))] {
        let kind = FaultKind::TicksMissed { ticks };
        scenario.faults = vec![PlantFault { at: 0.5, kind }];
        let (summary, _) = run(&scenario);
        let faults: Vec<&str> = summary.faults.iter().map(String::as_str).collect();
        assert_eq!(faults.is_empty(), fault.is_none(), "{ticks}: {faults:?}");
    }
}

/// An arm to which something happens when it has come to the middle of its job.
struct Disturbed {
    arm: CanPlant,
    ticks: u32,
    change: fn(&mut CanPlant, u32),
}

impl SimulatedArm for Disturbed {
    type Interface = BusDrives;

    fn sense(&mut self) -> ArmSample<BusSample> {
        SimulatedArm::sense(&mut self.arm)
    }

    fn step(&mut self, command: &ArmCommand<BusCommand>, period: f64) {
        (self.change)(&mut self.arm, self.ticks);
        self.ticks += 1;
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

/// The faults of the demonstration when this happens to the arm, in each tick with its number.
fn faults_of(scenario: &Scenario, change: fn(&mut CanPlant, u32)) -> Vec<Fault> {
    let moves = scenario.run_moves(&scenario.job().unwrap()).unwrap();
    let arm = Disturbed {
        arm: BusDrives::arm(scenario).unwrap(),
        ticks: 0,
        change,
    };
    let mut target = InProcess::new(&scenario.robot.settings().unwrap()).unwrap();
    let simulation = Simulation::new(&mut target, arm, scenario.robot.control.tick_rate);
    let record = simulation.run(&moves, &[], &mut |_| ()).unwrap();
    record.faults.into_iter().map(|(_, fault)| fault).collect()
}

#[test]
fn one_late_answer_is_tolerated_at_each_tick_rate_and_two_in_a_row_are_a_silent_drive() {
    for tick_rate in [700, 1000] {
        let mut scenario = demonstration();
        scenario.robot = leg(|text| format!("{text}\n[control]\ntick_rate = {tick_rate}.0\n"));
        scenario.fit().unwrap();
        // In one tick of fifty a drive answers by more than a tick too late; later in each of two.
        let late = |arm: &mut CanPlant, tick: u32| {
            let is_late = tick.is_multiple_of(50) && tick > 100;
            arm.delay_answers(Joint::Joint1, [if is_late { 1.2e-3 } else { 0.0 }; 2]);
        };
        assert_eq!(faults_of(&scenario, late), [], "{tick_rate} Hz");
        let silent = |arm: &mut CanPlant, tick: u32| {
            let is_silent = (1500..1502).contains(&tick);
            arm.delay_answers(Joint::Joint4, [if is_silent { 1.0 } else { 0.0 }; 2]);
        };
        assert_eq!(
            faults_of(&scenario, silent),
            [Fault::DriveSilent],
            "{tick_rate} Hz"
        );
    }
}

#[test]
fn answers_that_come_up_to_half_a_millisecond_late_draw_the_job() {
    let scenario = demonstration();
    let late = |arm: &mut CanPlant, _: u32| {
        for joint in Joint::ALL {
            arm.delay_answers(joint, [1e-4, 5e-4]);
        }
    };
    assert_eq!(faults_of(&scenario, late), []);
}

#[test]
fn a_drive_that_loses_its_mode_or_has_the_number_of_the_other_gives_a_fault() {
    let scenario = demonstration();
    let lost = |arm: &mut CanPlant, tick: u32| {
        if tick == 1500 {
            arm.lose_mode(Joint::Joint4);
        }
    };
    assert_eq!(faults_of(&scenario, lost), [Fault::DriveError]);
    let same = |arm: &mut CanPlant, tick: u32| {
        if tick == 0 {
            arm.give_node(Joint::Joint4, 1);
        }
    };
    assert_eq!(faults_of(&scenario, same), [Fault::DriveSilent]);
}

#[test]
fn an_mit_type_pair_draws_as_finely_as_its_position_is_told() {
    let mut scenario = demonstration();
    scenario.robot = leg(|text| text.replace(PROTOCOLS[0], PROTOCOLS[1]));
    scenario.fit().unwrap();
    let (summary, record) = run(&scenario);
    assert!(record.faults.is_empty(), "{:?}", record.faults);
    // A position is told and asked for in steps of 0.38 mrad of the drive: 11 µm at the knee.
    let error = summary.tip_error;
    assert!(error.rms_m < 32e-6, "{error:?}");
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
