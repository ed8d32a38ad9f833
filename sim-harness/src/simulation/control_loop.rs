//! The loop of a run: sense, tick and step, through homing, arming and the moves.

use super::paper::Paper;
use super::{Drawing, JointHistory, Sample, SimulatedArm, TipError, Trace, WorstError};
use crate::link::{Target, TargetError};
use fivebar_firmware::controller::Request;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{Move, MoveKind, Status};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::PlantFault;
use fivebar_plant::WornJoints;

/// Longest simulated time of homing [s].
const LONGEST_HOMING: f64 = 60.0;
/// Longest time for which an armed arm stands before a move and takes none, besides the longest dwell [s].
const LONGEST_STANDSTILL: f64 = 10.0;
/// Time between homing and arming, in which the joints come to rest [s].
const SETTLING: f64 = 0.1;
/// Time that is simulated after the end of the job, or after a fault [s].
const AFTERMATH: f64 = 0.1;

/// The record of a run under one controller, from power-up to its end.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The samples of the job. Their time begins with the job, after homing.
    pub trace: Trace,
    /// Ticks from power-up to the end.
    pub ticks: u64,
    /// Simulated time from power-up to the end [s].
    pub simulated: f64,
    /// Time from power-up to the beginning of the job [s]; none if homing failed.
    pub begun: Option<f64>,
    /// Time from the beginning of the job to its end, or to the fault that ended it [s].
    pub job_time: Option<f64>,
    /// Tip error during the job.
    pub tip_error: TipError,
    /// What is left of it after the best shift and turn of the whole drawing, over the trace's samples.
    pub tip_error_placed: TipError,
    /// The tip while the job was drawn.
    pub drawing: Drawing,
    /// The whole job was done: no fault and nobody who watched ended it early.
    pub finished: bool,
    /// Greatest torque of each motor, at its joint [N·m].
    pub peak_torque: [f64; 2],
    /// Ticks of the job in which a torque was limited.
    pub saturated_ticks: u64,
    /// Forces and contacts of the joints during the job, if joints are worn.
    pub joints: JointHistory,
    /// The faults in order, each with its time from power-up [s].
    pub faults: Vec<(f64, Fault)>,
    /// Full steps that each stepper has lost, if the arm has steppers.
    pub lost_steps: Option<[i64; 2]>,
}

/// What one who watches a run says in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Where the tool should be [m], if that is not the controller's reference.
    pub wanted: Option<[f64; 2]>,
    /// The run is to be stopped on its path.
    pub stop: bool,
}

/// One who watches a run from the beginning of the job to its end, as a host can: by the controller's status.
pub trait Watch {
    /// Sees the status of a tick.
    fn watch(&mut self, status: &Status) -> Seen;
}

/// A controller and the simulated arm in lockstep.
pub struct Simulation<'a, T, P> {
    target: &'a mut T,
    plant: P,
    watch: Option<&'a mut dyn Watch>,
    paper: Paper,
    /// The one who watches has stopped the run.
    stopped: bool,
    /// Period of the tick [s].
    period: f64,
    record: Record,
    job: JobSums,
    /// Whether the job is done or cancelled.
    ended: bool,
}

/// Sums over the ticks of the job.
#[derive(Clone, Copy, Debug, Default)]
struct JobSums {
    ticks: u64,
    /// Sum of the squared tip errors [m²].
    squares: f64,
    /// The reference of the last tick, if the tool was down [m].
    drawn_reference: Option<[f64; 2]>,
}

impl<'a, P: SimulatedArm, T: Target<P::Interface>> Simulation<'a, T, P> {
    /// A run before power-up; `tick_rate` is in Hz.
    pub fn new(target: &'a mut T, plant: P, tick_rate: f64) -> Self {
        Self {
            target,
            plant,
            watch: None,
            paper: Paper::default(),
            stopped: false,
            period: 1.0 / tick_rate,
            record: Record::default(),
            job: JobSums::default(),
            ended: false,
        }
    }

    /// The same while someone watches.
    #[must_use]
    pub fn watched_by(self, watch: &'a mut dyn Watch) -> Self {
        Self {
            watch: Some(watch),
            ..self
        }
    }

    /// The same on paper that grows by these shares in x and y after it was drawn on.
    #[must_use]
    pub fn on_paper(self, growth: [f64; 2]) -> Self {
        Self {
            paper: Paper::that_grows(growth),
            ..self
        }
    }

    /// Homes the arm, does the moves and returns the record. `faults` are injected at their
    /// times from the beginning of the job. `progress` is called a hundred times a second with the
    /// length of the path behind the reference [m]. A fault ends the run and is part of the record.
    ///
    /// # Errors
    /// The controller refuses a request or a move, or does not reply.
    pub fn run(
        mut self,
        moves: &[Move],
        faults: &[PlantFault],
        progress: &mut dyn FnMut(f64),
    ) -> Result<Record, TargetError> {
        self.tick()?;
        self.target.request(Request::Home)?;
        if self.wait_for_home()? {
            self.target.request(Request::Arm)?;
            self.record.begun = Some(self.now());
            self.plant.schedule_faults(faults);
            self.run_moves(moves, progress)?;
            self.record.job_time = self.record.begun.map(|begun| self.now() - begun);
            self.record.finished = !self.stopped && self.record.faults.is_empty();
        }
        self.ended = true;
        self.pause(AFTERMATH)?;
        Ok(self.finished())
    }

    /// Waits until the arm is homed. False if a fault ended homing; the record has it.
    fn wait_for_home(&mut self) -> Result<bool, TargetError> {
        while self.now() < LONGEST_HOMING {
            let status = self.tick()?;
            if !self.record.faults.is_empty() {
                return Ok(false);
            }
            if status.homed && matches!(status.state, State::Stopped | State::Armed) {
                self.pause(SETTLING)?;
                return Ok(true);
            }
        }
        Err(TargetError::NeverHomed(LONGEST_HOMING))
    }

    fn run_moves(
        &mut self,
        moves: &[Move],
        progress: &mut dyn FnMut(f64),
    ) -> Result<(), TargetError> {
        let mut offered = 0;
        let every = (0.01 / self.period).ceil().max(1.0) as u64;
        let (mut at, mut way): (Option<[f32; 2]>, f64) = (None, 0.0);
        let longest = LONGEST_STANDSTILL + longest_dwell(moves);
        let mut advanced = self.now();
        loop {
            while let Some(next) = moves.get(offered) {
                if !self.target.offer(next)? {
                    break;
                }
                offered += 1;
                advanced = self.now();
            }
            let status = self.tick()?;
            if let (Some([x1, y1]), Some([x2, y2])) = (at, status.reference) {
                let moved = f64::from((x2 - x1).hypot(y2 - y1));
                way += moved;
                if moved > 0.0 {
                    advanced = self.now();
                }
            }
            if self.now() - advanced > longest {
                return Err(TargetError::NeverDone(longest));
            }
            at = status.reference.or(at);
            if self.record.ticks.is_multiple_of(every) {
                progress(way);
            }
            if self.stopped {
                return self.stop();
            }
            let done = offered == moves.len() && self.target.is_idle();
            if done || !self.record.faults.is_empty() {
                return Ok(());
            }
        }
    }

    /// Stops on the path.
    fn stop(&mut self) -> Result<(), TargetError> {
        self.target.request(Request::Stop)?;
        while !self.target.is_idle() && self.record.faults.is_empty() {
            self.tick()?;
        }
        Ok(())
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
        let sample = self.plant.sense();
        let (command, status) = self.target.tick(&sample)?;
        self.record_sample(&status);
        self.plant.step(&command, self.period);
        self.record.ticks += 1;
        self.record_joints();
        Ok(status)
    }

    /// Records the forces and contacts of the joints during the tick.
    fn record_joints(&mut self) {
        let Some(statistics) = self.plant.wear().map(WornJoints::take_statistics) else {
            return;
        };
        if let Some(begun) = self.record.begun
            && !self.ended
        {
            self.record.joints.record(self.now() - begun, statistics);
        }
    }

    /// Records the state at the instant of the tick's samples.
    fn record_sample(&mut self, status: &Status) {
        let now = self.now();
        let record = &mut self.record;
        if let Some(fault) = status.fault
            && record.faults.last().is_none_or(|&(_, last)| last != fault)
        {
            record.faults.push((now, fault));
        }
        let torque = self.plant.torque();
        for (peak, torque) in record.peak_torque.iter_mut().zip(torque) {
            *peak = peak.max(torque.abs());
        }
        let Some(begun) = record.begun else {
            return;
        };
        let Some(reported) = Sample::reported(status, now - begun) else {
            return;
        };
        let seen = match &mut self.watch {
            Some(watch) if !self.ended => watch.watch(status),
            _ => Seen::default(),
        };
        self.stopped |= seen.stop;
        let sample = Sample {
            reference: seen.wanted.unwrap_or(reported.reference),
            tool: self
                .paper
                .seen(self.plant.tool(), reported.tool_level > 0.0),
            angle: Joint::ALL.map(|j| self.plant.angle(j)),
            torque,
            current: self.plant.current(),
            ..reported
        };
        record.trace.push(sample);
        if !self.ended {
            let error = sample.tip_error();
            record.tip_error.max_m = record.tip_error.max_m.max(error);
            record.saturated_ticks += u64::from(sample.saturated);
            self.job.ticks += 1;
            self.job.squares += error * error;
            self.record_drawing(&sample);
        }
    }

    /// Records the tip error of a tick of the job, and the speed of a drawn line.
    fn record_drawing(&mut self, sample: &Sample) {
        let drawing = &mut self.record.drawing;
        let error = WorstError {
            error: sample.tip_error(),
            time: sample.time,
            line: sample.line,
        };
        drawing.whole = drawing.whole.or(error);
        drawing.end = error;
        let before = self.job.drawn_reference.take();
        if sample.tool_level > 0.0 {
            drawing.down = Some(drawing.down.map_or(error, |worst| worst.or(error)));
            if let Some([x, y]) = before {
                let [to_x, to_y] = sample.reference;
                let speed = (to_x - x).hypot(to_y - y) / self.period;
                drawing.speed = drawing.speed.max(speed);
            }
            self.job.drawn_reference = Some(sample.reference);
        }
    }

    fn finished(self) -> Record {
        let simulated = self.now();
        let mut record = self.record;
        record.simulated = simulated;
        record.lost_steps = self.plant.lost_steps();
        let end = record.job_time.unwrap_or_default();
        let samples = record.trace.samples();
        let of_job = samples.partition_point(|sample| sample.time <= end);
        record.tip_error_placed = TipError::placed(&samples[..of_job]);
        if self.job.ticks > 0 {
            record.tip_error.rms_m = (self.job.squares / self.job.ticks as f64).sqrt();
        }
        record
    }
}

/// The longest time for which moves leave the arm standing [s].
fn longest_dwell(moves: &[Move]) -> f64 {
    let dwell = |next: &Move| match next.kind {
        MoveKind::Dwell { duration } => f64::from(duration),
        _ => 0.0,
    };
    moves.iter().map(dwell).fold(0.0, f64::max)
}
