//! A run: the simulation of a scenario from power-up to the end of its job, and its results.

mod arm;
mod by_cause;
mod can_bus;
mod control_loop;
mod demo_scale;
mod drawing;
mod hobby_servos;
mod joints;
mod paper;
mod steppers;
mod summary;
mod tip_error;
mod trace;
mod verdict;

pub use arm::{ByHand, SimulatedArm, SimulatedDrives, WithArm, with_arm};
pub use by_cause::CauseError;
pub use control_loop::{Record, Seen, Simulation, Watch};
pub use demo_scale::{DemoScaleError, find_demo_scale};
pub use drawing::{Drawing, WorstError};
pub use hobby_servos::ServoLimits;
pub use joints::{JointHistory, PeakForce};
pub use summary::{LearningSummary, RunErrors, Summary};
pub use tip_error::TipError;
pub use trace::{Sample, Trace};
pub use verdict::{TOLERANCE, Verdict, ended_by, fault_name};

use crate::link::{DesktopDrives, InProcess, Target, TargetError};
use crate::time_optimal::{JobPlanner, TimeOptimalError};
use fivebar_files::job::Job;
use fivebar_files::robot::{HomeError, MissingMasses, NotBrushed, Robot, robot_file_message};
use fivebar_files::scenario::{RefusedModeChange, RefusedMove, Scenario, ScenarioError};
use fivebar_firmware::settings::HomingMethod;
use fivebar_firmware::settings::SettingsError;
use fivebar_firmware::{Move, Planner};
use fivebar_kinematics::five_bar::{Joint, Pose};
use fivebar_plant::contact::ClearanceError;
use fivebar_plant::{MismatchError, Parameters, Plant, WornJoints};
use std::time::Instant;

/// Why a run ended early. Faults of the controller are no errors here; the record has them.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The scenario or its job is not valid.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A clearance is not between 0 and the bearing's radius.
    #[error(transparent)]
    ClearanceError(#[from] ClearanceError),
    /// Worn joints on an arm whose drives are not ideal.
    #[error(
        "worn joints are simulated with ideal drives only: leave out the `stiffness` of the robot \
         file, and under [mismatch] `stiffness`, `backlash`, `pulley_run_out`, \
         `tooth_mesh`, `stiction`, `cogging`, `torque_ripple`, `supply_resistance` and `pen_friction`"
    )]
    WornDrives,
    /// The robot has no masses.
    #[error(transparent)]
    MissingMasses(#[from] MissingMasses),
    /// The robot has other drives, and the run is of brushed motors.
    #[error(transparent)]
    NotBrushed(#[from] NotBrushed),
    /// The robot has no steppers.
    #[error("robot `{0}` has no steppers: its drives are of another `kind`")]
    NoSteppers(String),
    /// The robot's drives are on no bus.
    #[error("the drives of robot `{0}` are on no CAN bus: theirs is another `kind`")]
    NoBus(String),
    /// The robot has no hobby servos.
    #[error("robot `{0}` has no hobby servos: its drives are of another `kind`")]
    NoServos(String),
    /// The robot has no home pose.
    #[error(transparent)]
    HomeError(#[from] HomeError),
    /// The controller refuses the robot's settings.
    #[error("robot `{robot}`: {}", robot_file_message(*.error))]
    Settings {
        /// The robot's name.
        robot: String,
        /// The setting that is not valid.
        error: SettingsError,
    },
    /// The mismatch does not fit the robot.
    #[error("with robot `{robot}`, `{}` of [mismatch] {error}", error.name)]
    Mismatch {
        /// The robot's name.
        robot: String,
        /// The value that does not fit.
        error: MismatchError,
    },
    /// The job cannot be planned time-optimally.
    #[error(transparent)]
    TimeOptimal(#[from] TimeOptimalError),
    /// The working mode cannot be changed as the job asks for.
    #[error(transparent)]
    ModeChange(#[from] RefusedModeChange),
    /// The controller refuses the job or a request, or does not reply.
    #[error(transparent)]
    Target(#[from] TargetError),
}

/// Angle of each joint before its home switch at power-up [rad].
const BEFORE_HOME: f64 = 0.1;

/// Runs of a scenario: its job checked, and done by a simulated arm under the controller.
pub trait Simulate {
    /// The job as moves for an arm at home: where a straight way to the job would leave the
    /// workspace, the joints move there.
    ///
    /// # Errors
    /// The robot has no masses, the controller refuses its settings, or a time-optimal job cannot
    /// be planned.
    fn run_moves(&self, job: &Job) -> Result<Vec<Move>, RunError>;

    /// As [`Simulate::run_moves`], for the first `count` moves of the job.
    ///
    /// # Errors
    /// As [`Simulate::run_moves`].
    fn first_moves(&self, job: &Job, count: usize) -> Result<Vec<Move>, RunError>;

    /// Checks all moves of the job against the arm's envelope, before anything moves.
    ///
    /// # Errors
    /// The first line that cannot be done, with the point and the reason.
    fn check(&self, job: &Job) -> Result<(), RunError>;

    /// The simulated arm, unpowered, with each joint 0.1 rad before its home switch.
    ///
    /// # Errors
    /// The robot has no masses or no home pose.
    fn plant(&self) -> Result<Plant, RunError>;

    /// Runs the job in this process, under the scenario's control law. Calls `progress` with the
    /// length of the path that is done [m].
    ///
    /// # Errors
    /// Anything that ends the run early, except faults: the record has those.
    fn simulate(
        &self,
        job: &Job,
        progress: &mut dyn FnMut(f64),
    ) -> Result<(Summary, Record), RunError>;

    /// A controller in this process, as after a reset, with the scenario's control law.
    ///
    /// # Errors
    /// The robot has no masses, or the controller refuses its settings.
    fn controller(&self) -> Result<InProcess, RunError>;

    /// Runs moves on any controller with this arm, else as [`Simulate::simulate`].
    ///
    /// # Errors
    /// As [`Simulate::simulate`].
    fn run_arm<P: SimulatedArm>(
        &self,
        target: &mut impl Target<P::Interface>,
        arm: P,
        moves: &[Move],
        progress: &mut dyn FnMut(f64),
    ) -> Result<(Summary, Record), RunError>;

    /// Runs moves on any controller, else as [`Simulate::simulate`].
    ///
    /// # Errors
    /// As [`Simulate::simulate`].
    fn run_on<I: SimulatedDrives>(
        &self,
        target: &mut impl Target<I>,
        moves: &[Move],
        progress: &mut dyn FnMut(f64),
    ) -> Result<(Summary, Record), RunError>;

    /// Runs moves in this process, else as [`Simulate::simulate`], while someone watches.
    ///
    /// # Errors
    /// As [`Simulate::simulate`].
    fn run_watched(
        &self,
        moves: &[Move],
        watch: &mut dyn Watch,
        progress: &mut dyn FnMut(f64),
    ) -> Result<(Summary, Record), RunError>;

    /// The tip errors without any mismatch, with each alone, and with all: `all` is the run
    /// itself. What the robot file states of the drives stays in every run.
    ///
    /// # Errors
    /// As [`Simulate::simulate`].
    fn by_cause(&self, job: &Job, all: &Summary) -> Result<Vec<CauseError>, RunError>;

    /// Sets the greatest of a few scales at which the controller accepts the job.
    ///
    /// # Errors
    /// The refusal at the least scale, or an error other than a refused move.
    fn fit(&mut self) -> Result<(), RunError>;
}

impl Simulate for Scenario {
    fn run_moves(&self, job: &Job) -> Result<Vec<Move>, RunError> {
        self.first_moves(job, usize::MAX)
    }

    fn first_moves(&self, job: &Job, count: usize) -> Result<Vec<Move>, RunError> {
        let settings = self.robot.settings()?.check();
        let mut planner = Planner::new(&settings.map_err(|e| settings_error(self, e))?);
        let mut moves = self.moves_from_home(&planner, job)?;
        moves.truncate(count);
        let (Some(share), Some(home)) = (self.time_optimal, self.home_point()) else {
            return Ok(moves);
        };
        Ok(JobPlanner::new(&self.robot, share)?.moves(home, &moves, &mut planner)?)
    }

    fn check(&self, job: &Job) -> Result<(), RunError> {
        let settings = self.robot.settings()?.check();
        let mut planner = Planner::new(&settings.map_err(|e| settings_error(self, e))?);
        self.robot.home_pose()?;
        match self.verify(&mut planner, job) {
            Ok(()) => Ok(()),
            Err(RefusedMove::Move(refused)) => Err(TargetError::Move(refused).into()),
            Err(RefusedMove::ModeChange(refused)) => Err(refused.into()),
        }
    }

    fn plant(&self) -> Result<Plant, RunError> {
        let arm = self.arm().brushed()?;
        let (pose, parameters) = prepared(self)?;
        let mut plant = Plant::new(&parameters, &self.mismatch, &pose, self.seed);
        if let Some(clearance) = self.clearance {
            if plant.drives().is_some() {
                return Err(RunError::WornDrives);
            }
            plant = plant.worn(WornJoints::new(&arm.contact, clearance)?);
        }
        plant.rewire(&self.wiring);
        for &fault in &self.initial_faults {
            plant.inject(fault);
        }
        Ok(plant)
    }

    fn simulate(
        &self,
        job: &Job,
        progress: &mut dyn FnMut(f64),
    ) -> Result<(Summary, Record), RunError> {
        let moves = &self.run_moves(job)?;
        with_arm(
            self,
            InThisProcess {
                scenario: self,
                moves,
                watch: None,
                progress,
            },
        )?
    }

    fn controller(&self) -> Result<InProcess, RunError> {
        self.robot.brushed()?;
        controller(self)
    }

    fn run_arm<P: SimulatedArm>(
        &self,
        target: &mut impl Target<P::Interface>,
        arm: P,
        moves: &[Move],
        progress: &mut dyn FnMut(f64),
    ) -> Result<(Summary, Record), RunError> {
        run(self, target, arm, moves, None, progress)
    }

    fn run_on<I: SimulatedDrives>(
        &self,
        target: &mut impl Target<I>,
        moves: &[Move],
        progress: &mut dyn FnMut(f64),
    ) -> Result<(Summary, Record), RunError> {
        self.run_arm(target, I::arm(self)?, moves, progress)
    }

    fn run_watched(
        &self,
        moves: &[Move],
        watch: &mut dyn Watch,
        progress: &mut dyn FnMut(f64),
    ) -> Result<(Summary, Record), RunError> {
        with_arm(
            self,
            InThisProcess {
                scenario: self,
                moves,
                watch: Some(watch),
                progress,
            },
        )?
    }

    fn by_cause(&self, job: &Job, all: &Summary) -> Result<Vec<CauseError>, RunError> {
        by_cause::by_cause(self, job, all)
    }

    fn fit(&mut self) -> Result<(), RunError> {
        demo_scale::fit(self)
    }
}

/// Runs moves on a controller in this process.
struct InThisProcess<'a> {
    scenario: &'a Scenario,
    moves: &'a [Move],
    watch: Option<&'a mut dyn Watch>,
    progress: &'a mut dyn FnMut(f64),
}

impl WithArm for InThisProcess<'_> {
    type Output = Result<(Summary, Record), RunError>;

    fn with<P: SimulatedArm>(self, arm: P) -> Self::Output {
        let mut target = controller::<P::Interface>(self.scenario)?;
        let Self {
            scenario,
            moves,
            watch,
            progress,
        } = self;
        run(scenario, &mut target, arm, moves, watch, progress)
    }
}

/// A controller in this process, as after a reset, with the scenario's control law.
fn controller<I: DesktopDrives>(scenario: &Scenario) -> Result<InProcess<I>, RunError> {
    let robot = &scenario.robot;
    // Steppers and hobby servos have no loop.
    let has_no_loop = robot.has_steppers() || robot.hobby_servos().is_some();
    let settings = match scenario.control_law.is_computed_torque() || has_no_loop {
        true => robot.settings()?,
        false => robot.pid_settings()?,
    };
    InProcess::new(&settings).map_err(|error| settings_error(scenario, error))
}

fn settings_error(scenario: &Scenario, error: SettingsError) -> RunError {
    RunError::Settings {
        robot: scenario.robot.name.clone(),
        error,
    }
}

/// Whether the simulated arm drew its job in a run of this scenario, whoever ran it.
pub fn verdict_on(scenario: &Scenario, record: &Record) -> Verdict {
    Verdict::new(scenario, record, hobby_servos::limits(&scenario.robot))
}

/// Runs moves on this controller and this simulated arm.
fn run<P: SimulatedArm>(
    scenario: &Scenario,
    target: &mut impl Target<P::Interface>,
    plant: P,
    moves: &[Move],
    watch: Option<&mut dyn Watch>,
    progress: &mut dyn FnMut(f64),
) -> Result<(Summary, Record), RunError> {
    let started = Instant::now();
    let mut simulation = Simulation::new(target, plant, scenario.robot.control.tick_rate)
        .on_paper(scenario.mismatch.paper_growth);
    if let Some(watch) = watch {
        simulation = simulation.watched_by(watch);
    }
    let record = simulation.run(moves, &scenario.faults, progress)?;
    let servos = hobby_servos::limits(&scenario.robot);
    let summary = Summary {
        verdict: verdict_on(scenario, &record),
        robot: scenario.robot.name.clone(),
        scenario: scenario.name.clone(),
        simulated_s: record.simulated,
        wall_s: started.elapsed().as_secs_f64(),
        ticks: record.ticks,
        tip_error: record.tip_error,
        tip_error_placed: record.tip_error_placed,
        peak_torque_nm: record.peak_torque,
        torque_share: torque_share(&scenario.robot, &record.trace),
        saturated_ticks: record.saturated_ticks,
        job_s: record.job_time,
        faults: record
            .faults
            .iter()
            .map(|(_, fault)| fault_name(*fault))
            .collect(),
        lost_steps: record.lost_steps,
        hobby_servos: servos,
        ..Summary::default()
    };
    Ok((summary, record))
}

/// The greatest torque in these samples, as a share of what limits it at its speed.
fn torque_share(robot: &Robot, trace: &Trace) -> Option<f64> {
    let limit = robot.torque_limit().ok()?;
    let shares = trace.samples().iter().flat_map(|sample| {
        let [torques, rates] = [sample.torque, sample.reference_velocity];
        Joint::ALL.map(|joint| (torques[joint] / limit.at(joint, rates[joint])).abs())
    });
    shares.reduce(f64::max)
}

/// The arm with each joint 0.1 rad before its home switch, or at home where that is given.
fn start_pose(scenario: &Scenario) -> Result<Pose<f64>, RunError> {
    let settings = scenario.robot.settings()?;
    let is_given = settings.home_reference.method == HomingMethod::Given;
    let before = settings.axes.map(|axis| match axis.home_forward {
        _ if is_given => 0.0,
        true => -BEFORE_HOME,
        false => BEFORE_HOME,
    });
    Ok(scenario.arm().pose_near_home(before)?)
}

/// Where the arm is put, and its parameters, which the mismatch fits.
fn prepared(scenario: &Scenario) -> Result<(Pose<f64>, Parameters), RunError> {
    let pose = start_pose(scenario)?;
    let parameters = scenario.arm().plant_parameters()?;
    let fits = scenario.mismatch.check_for(&parameters);
    fits.map_err(|error| RunError::Mismatch {
        robot: scenario.robot.name.clone(),
        error,
    })?;
    Ok((pose, parameters))
}
