//! A run: a scenario simulated from power-up to the end of its job, and what it comes to.

mod control_loop;
mod demo_scale;
mod joints;
mod summary;
mod trace;

pub use control_loop::{Record, Simulation};
pub use demo_scale::{DemoScaleError, find_demo_scale};
pub use joints::{JointHistory, Peak};
pub use summary::{Summary, TipError, fault_name};
pub use trace::{Sample, Trace};

use crate::input::job::Job;
use crate::input::robot::{KinematicsOnly, NoHome, in_words_of_its_file};
use crate::input::scenario::{Scenario, ScenarioError};
use crate::run::contact::ClearanceError;
use crate::run::link::{InProcess, Target, TargetError};
use crate::run::plant::{Plant, WornJoints};
use fivebar_firmware::settings::SettingsError;
use fivebar_firmware::{Move, Planner};
use std::time::Instant;

/// Why a scenario was not run to its end, faults of the arm aside.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The scenario or its job makes no sense.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A joint is worn out.
    #[error(transparent)]
    ClearanceError(#[from] ClearanceError),
    /// The robot has no masses.
    #[error(transparent)]
    KinematicsOnly(#[from] KinematicsOnly),
    /// The robot has no place to start from.
    #[error(transparent)]
    NoHome(#[from] NoHome),
    /// The controller refuses the robot.
    #[error("robot `{robot}`: {}", in_words_of_its_file(*.error))]
    Settings {
        /// The robot's name.
        robot: String,
        /// The setting at fault.
        error: SettingsError,
    },
    /// The controller refuses the job, or something else asked of it.
    #[error(transparent)]
    Target(#[from] TargetError),
}

/// How far each joint stands before its home switch at power-up [rad].
const BEFORE_HOME: f64 = 0.1;

impl Scenario {
    /// The job as moves for the planner.
    pub fn moves(&self, job: &Job) -> Vec<Move> {
        job.moves(self.robot.motion.max_speed).collect()
    }

    /// Holds every move of the job against what the arm may do, before anything moves.
    ///
    /// # Errors
    /// The first line that cannot be done, with the point and the reason.
    pub fn check(&self, job: &Job) -> Result<(), RunError> {
        let planner = Planner::new(&self.robot.settings()?).map_err(|e| self.unsound(e))?;
        let [x, y] = self.robot.tool_at(&self.robot.home_pose()?);
        let mut tool = [x as f32, y as f32];
        for order in self.moves(job) {
            tool = planner.check(tool, &order).map_err(TargetError::Move)?;
        }
        Ok(())
    }

    fn unsound(&self, error: SettingsError) -> RunError {
        RunError::Settings {
            robot: self.robot.name.clone(),
            error,
        }
    }

    /// The simulated arm, unpowered, somewhat before its home switches.
    ///
    /// # Errors
    /// A robot without masses, or without a home.
    pub fn plant(&self) -> Result<Plant, RunError> {
        let settings = self.robot.settings()?;
        let before = settings.axes.map(|axis| {
            if axis.home_forward {
                -BEFORE_HOME
            } else {
                BEFORE_HOME
            }
        });
        let pose = self.robot.pose_near_home(before)?;
        let mut plant = Plant::new(&self.robot, &self.mismatch, &pose, self.seed)?;
        if let Some(clearance) = self.clearance {
            plant = plant.worn(WornJoints::new(&self.robot.contact, clearance)?);
        }
        for &fault in &self.broken {
            plant.inject(fault);
        }
        Ok(plant)
    }

    /// Runs the job in this process, by the arm's model or by PD alone. `progress` is told
    /// how many of the job's moves the controller has taken.
    ///
    /// # Errors
    /// Whatever keeps the run from its end, faults aside: those are part of the record.
    pub fn simulate(
        &self,
        job: &Job,
        computed_torque: bool,
        progress: &mut dyn FnMut(usize),
    ) -> Result<(Summary, Record), RunError> {
        let mut target = self.controller(computed_torque)?;
        self.run_on(&mut target, &self.moves(job), progress)
    }

    /// The controller in this process, by the arm's model or by PD alone, just reset.
    ///
    /// # Errors
    /// A robot without masses, or settings that the controller refuses.
    pub fn controller(&self, computed_torque: bool) -> Result<InProcess, RunError> {
        let mut settings = self.robot.settings()?;
        settings.control.computed_torque = computed_torque;
        InProcess::new(&settings).map_err(|e| self.unsound(e))
    }

    /// Runs moves on a controller, wherever it is; else as [`Scenario::simulate`].
    ///
    /// # Errors
    /// As there.
    pub fn run_on(
        &self,
        target: &mut impl Target,
        moves: &[Move],
        progress: &mut dyn FnMut(usize),
    ) -> Result<(Summary, Record), RunError> {
        let started = Instant::now();
        let simulation = Simulation::new(target, self.plant()?, self.robot.control.tick_rate);
        let record = simulation.run(moves, &self.faults, progress)?;
        let summary = Summary {
            robot: self.robot.name.clone(),
            scenario: self.name.clone(),
            simulated_s: record.simulated,
            wall_s: started.elapsed().as_secs_f64(),
            ticks: record.ticks,
            tip_error: record.tip_error,
            peak_torque_nm: record.peak_torque,
            saturated_ticks: record.saturated_ticks,
            faults: record
                .faults
                .iter()
                .map(|(_, fault)| fault_name(*fault))
                .collect(),
            ..Summary::default()
        };
        Ok((summary, record))
    }
}
