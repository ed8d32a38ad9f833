//! The loop of a run: sense, tick, step; home, arm, moves, done.

use super::{JointHistory, Sample, TipError, Trace};
use crate::input::scenario::PlantFault;
use crate::run::link::{Target, TargetError};
use crate::run::plant::{Plant, WornJoints};
use fivebar_firmware::controller::Request;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{Move, Status};

/// Simulated time in which both joints must have found their switches [s].
const LONGEST_HOMING: f64 = 60.0;
/// The joints run out after homing before they are held [s].
const SETTLING: f64 = 0.1;
/// What follows the end of the job, or a fault, is watched for so long [s].
const AFTERMATH: f64 = 0.1;

/// A run under one controller, from power-up to its end.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The job sample by sample; its time begins with the job, after homing.
    pub trace: Trace,
    /// Ticks from power-up to the end.
    pub ticks: u64,
    /// All of it [s].
    pub simulated: f64,
    /// When the job began, the arm being homed [s]; never, if it was not.
    pub begun: Option<f64>,
    /// How far the tool was from its reference during the job.
    pub tip_error: TipError,
    /// Greatest torque of each motor, at its joint [N·m].
    pub peak_torque: [f64; 2],
    /// Ticks of the job in which a torque was limited.
    pub saturated_ticks: u64,
    /// What the joints went through during the job, where the run watches them.
    pub joints: JointHistory,
    /// The faults raised, in their order, each with its time from power-up [s].
    pub faults: Vec<(f64, Fault)>,
}

/// A controller and the arm it moves, in lockstep.
pub struct Simulation<'a, T> {
    target: &'a mut T,
    plant: Plant,
    /// From one tick to the next [s].
    period: f64,
    record: Record,
    job: Tally,
    /// The job has come to its end, one way or another.
    ended: bool,
}

/// Sums over the ticks of the job.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    ticks: u64,
    squares: f64,
}

impl<'a, T: Target> Simulation<'a, T> {
    /// Everything unpowered, nothing homed.
    pub fn new(target: &'a mut T, plant: Plant, tick_rate: f64) -> Self {
        Self {
            target,
            plant,
            period: 1.0 / tick_rate,
            record: Record::default(),
            job: Tally::default(),
            ended: false,
        }
    }

    /// Homes the arm, does the moves and tells what happened. `faults` come to pass at
    /// their time from the beginning of the job; `progress` is told how many of the moves
    /// have been handed over. A fault ends the run and is part of the record.
    ///
    /// # Errors
    /// The controller refuses a request or a move, or does not answer.
    pub fn run(
        mut self,
        moves: &[Move],
        faults: &[PlantFault],
        progress: &mut dyn FnMut(usize),
    ) -> Result<Record, TargetError> {
        self.tick()?;
        self.target.request(Request::Home)?;
        if self.wait_for_home()? {
            self.target.request(Request::Arm)?;
            self.record.begun = Some(self.now());
            self.plant.schedule_faults(faults);
            self.follow(moves, progress)?;
        }
        self.ended = true;
        self.pause(AFTERMATH)?;
        Ok(self.finished())
    }

    /// Whether the arm was homed; else a fault is on record.
    fn wait_for_home(&mut self) -> Result<bool, TargetError> {
        while self.now() < LONGEST_HOMING {
            let status = self.tick()?;
            if !self.record.faults.is_empty() {
                return Ok(false);
            }
            if status.homed && status.state == State::Stopped {
                self.pause(SETTLING)?;
                return Ok(true);
            }
        }
        Err(TargetError::NeverHomed(LONGEST_HOMING))
    }

    fn follow(
        &mut self,
        moves: &[Move],
        progress: &mut dyn FnMut(usize),
    ) -> Result<(), TargetError> {
        let mut offered = 0;
        loop {
            while let Some(next) = moves.get(offered) {
                if !self.target.offer(next)? {
                    break;
                }
                offered += 1;
                progress(offered);
            }
            self.tick()?;
            let done = offered == moves.len() && self.target.is_idle();
            if done || !self.record.faults.is_empty() {
                return Ok(());
            }
        }
    }

    fn pause(&mut self, time: f64) -> Result<(), TargetError> {
        for _ in 0..(time / self.period) as u32 {
            self.tick()?;
        }
        Ok(())
    }

    /// Time since power-up [s].
    fn now(&self) -> f64 {
        self.record.ticks as f64 * self.period
    }

    fn tick(&mut self) -> Result<Status, TargetError> {
        let sensed = self.plant.sense();
        let (command, status) = self.target.tick(&sensed)?;
        self.observe(&status);
        self.plant.step(&command, self.period);
        self.record.ticks += 1;
        self.watch_joints();
        Ok(status)
    }

    /// Notes what the joints went through during the tick.
    fn watch_joints(&mut self) {
        let Some(statistics) = self.plant.wear().map(WornJoints::take_statistics) else {
            return;
        };
        if let Some(begun) = self.record.begun
            && !self.ended
        {
            self.record.joints.record(self.now() - begun, statistics);
        }
    }

    /// Notes the instant of the samples that the tick has answered.
    fn observe(&mut self, status: &Status) {
        let now = self.now();
        let record = &mut self.record;
        if let Some(fault) = status.fault
            && record.faults.last().is_none_or(|&(_, last)| last != fault)
        {
            record.faults.push((now, fault));
        }
        let state = self.plant.state();
        let torque = [0, 1].map(|j| self.plant.model().motors[j].torque(state.current[j]));
        for (peak, torque) in record.peak_torque.iter_mut().zip(torque) {
            *peak = peak.max(torque.abs());
        }
        let Some(begun) = record.begun else {
            return;
        };
        let Some(told) = Sample::told(status, now - begun) else {
            return;
        };
        let sample = Sample {
            tool: self.plant.tool().into(),
            angle: [0, 1].map(|j| self.plant.angle(j)),
            torque,
            current: state.current,
            ..told
        };
        record.trace.push(sample);
        if !self.ended {
            let error = sample.tip_error();
            record.tip_error.max_m = record.tip_error.max_m.max(error);
            record.saturated_ticks += u64::from(sample.saturated);
            self.job.ticks += 1;
            self.job.squares += error * error;
        }
    }

    fn finished(self) -> Record {
        let simulated = self.now();
        let mut record = self.record;
        record.simulated = simulated;
        if self.job.ticks > 0 {
            record.tip_error.rms_m = (self.job.squares / self.job.ticks as f64).sqrt();
        }
        record
    }
}
