//! A trial: a fault of a kind of drive while its arm does a job, and what came of it.

use super::drives::{APPROACH, DRAWS_FAST, DRAWS_SLOWLY, Drive, RESTS, scenario};
use super::faulted::{Fault, Faulted, Reachable};
use super::faults::{During, ROWS};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::drives::can::BusDrives;
use fivebar_firmware::drives::{BrushedDrives, StepDrives};
use fivebar_firmware::{Move, safety};
use fivebar_plant::HobbyServoPlant;
use fivebar_sim::link::{DesktopDrives, InProcess};
use fivebar_sim::simulation::{
    Record, Simulate, SimulatedArm, SimulatedDrives, Simulation, verdict_on,
};
use oorandom::Rand64;

/// The latest time of a fault while the arm homes, from power-up on [s].
const WHILE_HOMING: f64 = 0.3;

/// A kind of drive with its arm, its job and the times of a run without a fault.
pub(crate) struct Prepared {
    pub(crate) drive: Drive,
    scenario: Scenario,
    moves: Vec<Move>,
    /// When the states begin and end, from the beginning of the job on [s].
    windows: [[f64; 2]; 5],
    /// The length of a leg of the arm [m].
    size: f64,
    bus_voltage: f64,
}

/// Which trial.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trial {
    pub(crate) drive: usize,
    pub(crate) row: usize,
    pub(crate) during: During,
    pub(crate) seed: u64,
}

/// What came of it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outcome {
    /// The fault that was latched first, and the time from the injected fault until then [s].
    pub(crate) latched: Option<(safety::Fault, f64)>,
    /// A request or a move was refused, or the arm did not do it in time.
    pub(crate) refused: bool,
    /// The greatest distance of the tip from its path while the job was done [m].
    pub(crate) worst: f64,
    /// The arm was wrong by more than a tenth of its size.
    pub(crate) is_far: bool,
    /// The exit status of the run is 0: the arm drew its job, as the verdict has it.
    pub(crate) is_drawn: bool,
}

impl Outcome {
    pub(crate) fn is_found(&self) -> bool {
        self.latched.is_some()
    }

    /// Wrong by more than a tenth of its size, exit status 0, and no fault has its name.
    pub(crate) fn is_unnamed(&self) -> bool {
        self.is_far && self.is_drawn && !self.is_found() && !self.refused
    }

    /// Likewise far off, and only the simulation's verdict says so.
    pub(crate) fn is_silent(&self) -> bool {
        self.is_far && !self.is_found() && !self.refused
    }
}

impl Prepared {
    pub(crate) fn new(drive: Drive) -> Self {
        let scenario = scenario(drive);
        let job = scenario.job().expect("a job");
        let moves = scenario.run_moves(&job).expect("the job can be done");
        let (summary, record) = scenario.simulate(&job, &mut |_| ()).expect("it ends");
        assert!(summary.verdict.drawn, "{drive:?}: {:?}", summary.verdict);
        let of_lines = |[first, last]: [u32; 2]| {
            let samples = record.trace.samples().iter();
            let mut times = samples
                .filter(|sample| (first..=last).contains(&sample.line))
                .map(|sample| sample.time);
            let begins = times.next().expect("a state of the job");
            [begins, times.next_back().unwrap_or(begins)]
        };
        let [l1, l2, ..] = scenario.robot.geometry.lengths();
        Self {
            drive,
            moves,
            windows: [
                [0.0, WHILE_HOMING],
                of_lines([APPROACH; 2]),
                of_lines([RESTS; 2]),
                of_lines(DRAWS_SLOWLY),
                of_lines(DRAWS_FAST),
            ],
            size: l1 + l2,
            bus_voltage: scenario
                .robot
                .plant_parameters()
                .expect("masses")
                .bus_voltage,
            scenario,
        }
    }

    pub(crate) fn run(&self, trial: &Trial) -> Outcome {
        let random = &mut Rand64::new(trial.seed.into());
        let fault = ROWS[trial.row].fault(random, self.bus_voltage);
        let [begins, ends] = self.windows[trial.during as usize];
        let at = begins + (ends - begins) * random.rand_float();
        let mut scenario = self.scenario.clone();
        scenario.seed = trial.seed;
        if let Fault::TorqueConstant(joint, share) = fault {
            scenario.mismatch.torque_constant[joint] = share;
        }
        let is_of_job = trial.during != During::Homing;
        let at = match fault {
            Fault::TorqueConstant(..) => 0.0,
            _ => at,
        };
        match self.drive {
            Drive::Brushed => {
                let arm = BrushedDrives::arm(&scenario).expect("an arm");
                self.run_on::<BrushedDrives, _>(&scenario, arm, fault, (at, is_of_job))
            }
            Drive::Stepper | Drive::StepperWithEncoder => {
                let arm = StepDrives::arm(&scenario).expect("an arm");
                self.run_on::<StepDrives, _>(&scenario, arm, fault, (at, is_of_job))
            }
            Drive::Odrive | Drive::Mit => {
                let arm = BusDrives::arm(&scenario).expect("an arm");
                self.run_on::<BusDrives, _>(&scenario, arm, fault, (at, is_of_job))
            }
            Drive::HobbyServo => {
                let arm = self.servos(&scenario);
                self.run_on::<StepDrives, _>(&scenario, arm, fault, (at, is_of_job))
            }
        }
    }

    /// The arm with hobby servos, as a hand has put it at home.
    fn servos(&self, scenario: &Scenario) -> HobbyServoPlant {
        let servos = scenario.robot.hobby_servos().expect("servos");
        let parameters = scenario.robot.plant_parameters().expect("masses");
        let pose = scenario.robot.home_pose().expect("a home pose");
        HobbyServoPlant::new(
            &parameters,
            &servos,
            &scenario.mismatch,
            &pose,
            scenario.seed,
        )
    }

    fn run_on<I: DesktopDrives, P: Reachable + SimulatedArm<Interface = I>>(
        &self,
        scenario: &Scenario,
        arm: P,
        fault: Fault,
        (at, is_of_job): (f64, bool),
    ) -> Outcome {
        let mut target = InProcess::<I>::new(&scenario.robot.settings().expect("settings"))
            .expect("valid settings");
        let arm = Faulted {
            arm,
            fault,
            at,
            is_of_job,
            time: 0.0,
            done: false,
        };
        let rate = scenario.robot.control.tick_rate;
        let run = Simulation::new(&mut target, arm, rate).run(&self.moves, &[], &mut |_| ());
        match run {
            Ok(record) => self.outcome(scenario, &record, (at, is_of_job)),
            Err(_) => Outcome {
                refused: true,
                ..Outcome::default()
            },
        }
    }

    fn outcome(
        &self,
        scenario: &Scenario,
        record: &Record,
        (at, is_of_job): (f64, bool),
    ) -> Outcome {
        let verdict = verdict_on(scenario, record);
        let begun = if is_of_job { record.begun } else { Some(0.0) };
        let injected = begun.map_or(0.0, |begun| begun + at);
        let worst = record.tip_error.max_m;
        Outcome {
            latched: record.faults.first().map(|&(time, fault)| {
                assert!(time >= injected - 1e-3, "{fault:?} before its cause");
                (fault, (time - injected).max(0.0))
            }),
            refused: false,
            worst,
            is_far: worst.is_nan() || worst > 0.1 * self.size,
            is_drawn: verdict.drawn,
        }
    }
}
