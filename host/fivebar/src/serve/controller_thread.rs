//! The thread that exchanges messages with the controller.
//!
//! Before each exchange it does the stops that pages ask for ([`Self::stop_if_asked`]
//! (ControllerThread::stop_if_asked)), so a stop waits for one exchange at most.

use super::error::ServeError;
use super::held_motion::HeldBy;
use super::job_thread::JobThread;
use super::mode_thread::ModeThread;
use super::move_feeder::{JobStatus, MoveFeeder};
use super::parsed_job::ParsedJob;
use super::preview::{JobStart, Preview};
use super::teaching::Teaching;
use super::trail::Trail;
use super::wire::channels::ControllerEnd;
use super::wire::lease::PageId;
use super::wire::message::{FaultMessage, ServerMessage, StateMessage, brief};
use super::wire::updates::Updates;
use crate::pen_heights::{KeepValues, PenTrial};
use crate::senders::{Console, Senders};
use fivebar_files::job::JobReader;
use fivebar_files::robot::Robot;
use fivebar_firmware::Status;
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::protocol::{CommandError, HostCommand, Reply};
use fivebar_firmware::safety::Fault;
use fivebar_kinematics::five_bar::{Side, Tool};
use fivebar_report::text::next_step;
use fivebar_sim::controller::{Session, SpeedMeter, sentence};
use fivebar_sim::drive_values::DriveValues;
use fivebar_sim::link::LinkError;
use fivebar_sim::simulation::fault_name;
use fivebar_sim::time_optimal::JobPlanner;
use std::iter;
use std::sync::Arc;
use std::time::Instant;

/// States sent to pages per second of the controller's time [Hz].
const SAMPLES: f32 = 30.0;
/// The same for a board in lockstep, whose time runs slower than real time [Hz].
const SAMPLES_STEPPED: f32 = 200.0;
/// Events of pages that are handled before the controller gets its next sign of life. Without a limit
/// the arm of a silent page rested after 0.66 to 0.70 s under floods, with it after 0.50 to 0.59 s.
const EVENTS_PER_CYCLE: usize = 64;
/// One controller and the pages that show it.
pub(super) struct ControllerThread {
    pub(super) session: Session,
    /// Senders of G-code, one of which may be in control of the controller.
    pub(super) senders: Box<dyn Senders>,
    /// The page with a console, and the console.
    pub(super) console: Option<(PageId, Console)>,
    pub(super) pages: ControllerEnd,
    pub(super) updates: Updates,
    pub(super) preview: Preview,
    /// The page that was in control when the feeder got its moves.
    controlled_by: Option<PageId>,
    pub(super) feeder: MoveFeeder,
    /// Who holds the control of the motion that goes on while it is held.
    pub(super) held_by: Option<HeldBy>,
    trail: Trail,
    drives: DriveValues,
    /// The fault last sent to all pages, or that there is none; `None` before the first.
    sent_fault: Option<Option<Fault>>,
    pub(super) jobs: JobThread,
    pub(super) modes: ModeThread,
    /// The page that wants another working mode as soon as the arm rests, and its elbows.
    pub(super) mode_wanted: Option<(PageId, [Side; 2])>,
    pub(super) loaded: Option<LoadedJob>,
    /// The page that wants the job to run from this line as soon as it is read and checked.
    pub(super) run_asked_by: Option<(PageId, u32)>,
    /// The page that tries heights of the pen, and these.
    pub(super) pen: Option<(PageId, PenTrial)>,
    /// Writes values to the robot file.
    pub(super) keep: KeepValues,
    /// Whether the job runs on when no page is in control.
    pub(super) run_on: bool,
    /// When a page last cleared a fault.
    pub(super) cleared: Option<Instant>,
    /// A hand leads the arm.
    pub(super) teaching: Option<Teaching>,
    pub(super) tool: Tool<f64>,
    pub(super) speed: SpeedMeter,
}

/// A job that was read and checked.
pub(super) struct LoadedJob {
    pub(super) job: Arc<ParsedJob>,
    /// Where it was checked from.
    pub(super) start: JobStart,
    /// Why it cannot be done from there.
    pub(super) refusal: Option<String>,
    /// The lower left and the upper right corner of what it draws [m]; none if it draws nothing.
    pub(super) drawn_box: Option<[[f32; 2]; 2]>,
}

impl ControllerThread {
    /// Starts the controller's telemetry.
    pub(super) fn new(
        mut session: Session,
        senders: Box<dyn Senders>,
        robot: Robot,
        (reader, planner, keep): (JobReader, Option<JobPlanner>, KeepValues),
        pages: ControllerEnd,
        updates: Updates,
    ) -> Result<Self, ServeError> {
        let samples = if session.is_in_lockstep() {
            SAMPLES_STEPPED
        } else {
            SAMPLES
        };
        let every = (session.settings.control.tick_rate / samples) as u16;
        session.client.call(HostCommand::Telemetry { every })?;
        let tool = robot.tool_on_link()?;
        let preview = Preview::new(&session.settings);
        let speed = SpeedMeter::from(0.0, session.clock.now());
        Ok(Self {
            drives: DriveValues::of(&robot, &session.settings),
            session,
            senders,
            console: None,
            pages,
            updates,
            jobs: JobThread::start(robot, preview.clone(), reader, planner),
            modes: ModeThread::start(preview.clone()),
            mode_wanted: None,
            preview,
            controlled_by: None,
            feeder: MoveFeeder::default(),
            held_by: None,
            trail: Trail::default(),
            sent_fault: None,
            loaded: None,
            run_asked_by: None,
            pen: None,
            keep,
            run_on: false,
            cleared: None,
            teaching: None,
            tool,
            speed,
        })
    }

    /// Runs until `ends` returns true or a reply fails. It then brings the arm to rest and disarms
    /// it.
    pub(super) fn run(mut self, ends: &dyn Fn() -> bool) -> Result<(), ServeError> {
        let mut served = Ok(());
        while served.is_ok() && !ends() {
            served = self.cycle();
        }
        if served.is_ok() {
            served = self.end_pen_trial().map(|_| ());
        }
        Ok(self.session.stop_after(served)?)
    }

    fn cycle(&mut self) -> Result<(), LinkError> {
        self.handle_events()?;
        self.end_pen_trial_of_a_lost_page()?;
        self.take_prepared_job();
        self.change_mode_if_wanted();
        if self.serve_senders()? {
            let status = self.session.status;
            self.note_position(&status);
            self.feeder.drop_target();
        } else if self.teaching.is_some() {
            self.be_led()?;
        } else {
            self.feed_controller()?;
        }
        self.stop_if_asked()?;
        self.session.pass_time()?;
        self.take_samples()
    }

    /// Takes the samples that have arrived, and sends each as a state.
    pub(super) fn take_samples(&mut self) -> Result<(), LinkError> {
        while let Some(sample) = self.session.client.take_telemetry() {
            let homed = sample.status.homed && !self.session.status.homed;
            self.session.status = sample.status;
            let job = self.feeder.follow(&sample.status);
            self.report_job(job);
            if homed {
                self.check_job_again();
            }
            self.stop_if_asked()?;
            self.send_state()?;
        }
        Ok(())
    }

    /// Serves the sender in control; returns whether there is one.
    fn serve_senders(&mut self) -> Result<bool, LinkError> {
        let admits = self.rests() && !self.feeder.is_running() && self.pen.is_none();
        self.drop_console_of_a_lost_page();
        let is_in_control = self.senders.serve(&mut self.session, admits)?;
        self.pass_on_answers();
        let notes: Vec<_> = iter::from_fn(|| self.senders.take_note()).collect();
        for note in notes {
            self.notice(&note);
        }
        Ok(is_in_control)
    }

    /// Whether a sender is in control.
    pub(super) fn is_sender_in_control(&self) -> bool {
        self.senders.is_in_control()
    }

    /// Handles what pages ask for, up to a request for which the controller was asked.
    fn handle_events(&mut self) -> Result<(), LinkError> {
        for _ in 0..EVENTS_PER_CYCLE {
            self.stop_if_asked()?;
            let Ok(event) = self.pages.events.try_recv() else {
                return Ok(());
            };
            self.drop_moves_of_a_lost_page();
            if self.handle_event(&event)? {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Drops the moves of a page that is no longer in control. Its job keeps its place, or goes on
    /// if it is set to.
    fn drop_moves_of_a_lost_page(&mut self) {
        let holder = self.pages.shared.lease.holder();
        if holder != self.controlled_by {
            self.controlled_by = holder;
            self.run_asked_by = None;
            self.mode_wanted = None;
            if self.runs_on() {
                self.feeder.drop_target();
            } else {
                self.feeder.leave();
            }
        }
    }

    /// Whether a job runs that goes on without a page in control.
    pub(super) fn runs_on(&self) -> bool {
        self.run_on && self.feeder.is_running()
    }

    pub(super) fn report_job(&self, status: JobStatus) {
        match status {
            JobStatus::Unchanged => {}
            JobStatus::Finished => self.notice("The job is done."),
            JobStatus::Paused => {
                let pause = self.feeder.pause().unwrap_or_default();
                self.notice(&format!("{pause}. The job waits: press Resume."));
            }
            JobStatus::Held => {
                let line = self.feeder.line().unwrap_or_default();
                self.notice(&format!(
                    "The job has stopped at line {line} and can be resumed there."
                ));
            }
        }
    }

    /// Whether the host may send to the controller now: only while the page in control gives
    /// signs of life or a job runs on without one, and after the stops that pages have asked for.
    pub(super) fn may_feed(&mut self) -> Result<bool, LinkError> {
        if self.stop_if_asked()? {
            return Ok(false);
        }
        self.drop_moves_of_a_lost_page();
        Ok(self.runs_on() || self.pages.shared.lease.is_alive(self.session.clock.now()))
    }

    /// Gives the controller a sign of life and the moves that wait.
    fn feed_controller(&mut self) -> Result<(), LinkError> {
        if !self.may_feed()? {
            return Ok(());
        }
        let (status, mut free) = self.session.client.status()?;
        self.note_position(&status);
        let job = self.feeder.update(&status, free);
        self.report_job(job);
        while self.may_feed()? {
            let Some(next) = self.feeder.next(free) else {
                break;
            };
            match self.session.client.call(HostCommand::Move(next))? {
                Reply::Refused(CommandError::Move(refusal))
                    if refusal.kind == MoveErrorKind::Full =>
                {
                    break;
                }
                Reply::Refused(refusal) => {
                    self.feeder.refused();
                    self.refuse(None, sentence(&refusal));
                }
                Reply::Taken { free: left } => {
                    self.feeder.taken(&next);
                    free = left;
                }
                other => {
                    self.feeder.refused();
                    self.refuse(None, format!("Unexpected reply to a move: {other:?}."));
                }
            }
        }
        Ok(())
    }

    /// Notes where the tool is, for the drawing.
    pub(super) fn note_position(&mut self, status: &Status) {
        self.trail
            .note(status, self.session.settings.control.tick_rate);
    }

    fn send_state(&mut self) -> Result<(), LinkError> {
        if self.sent_fault != Some(self.session.status.fault) {
            self.sent_fault = Some(self.session.status.fault);
            let snapshot = match self.session.status.fault {
                Some(_) => self.session.client.call(HostCommand::Snapshot)?,
                None => Reply::Snapshot(None),
            };
            if let Reply::Snapshot(snapshot) = snapshot {
                self.updates
                    .send(&ServerMessage::Fault(snapshot.map(|snapshot| {
                        FaultMessage {
                            name: fault_name(snapshot.fault),
                            advice: next_step(snapshot.fault),
                            snapshot,
                        }
                    })));
            }
        }
        // Pages know moves by the lines of the job.
        let mut status = self.session.status;
        status.tag = status.tag.and_then(|_| self.feeder.line());
        let status = &status;
        let tick_rate = f64::from(self.session.settings.control.tick_rate);
        let time = f64::from(status.tick) / tick_rate;
        let now = self.session.clock.now();
        let pose = self.preview.pose(status);
        let lease = &self.pages.shared.lease;
        self.updates.send(&ServerMessage::State(StateMessage {
            status,
            time,
            speed: self.speed.at(time, now),
            drives: self.drives.at(status),
            joints: pose.map(|pose| [pose.b, pose.c, pose.d].map(|point| [point.x, point.y])),
            elbows: pose.map(|pose| self.preview.branch(&pose).elbows),
            modes: self.modes.reachable(),
            trail: self.trail.points(),
            sender: self.is_sender_in_control(),
            console: self.console_in_control(),
            pending: !self.feeder.has_no_target(),
            control: lease.holder(),
            alive: lease.is_alive(now),
            progress: self.feeder.progress(tick_rate),
            left: self.feeder.left(tick_rate),
            held: self.feeder.held().and_then(|_| self.feeder.line()),
            pause: self.feeder.pause(),
            pen: self.pen_widths(),
            run_on: self.run_on,
            feed: self.feeder.feed(),
        }));
        self.trail.clear();
        Ok(())
    }

    /// Sends a notice to all pages.
    pub(super) fn notice(&self, text: &str) {
        self.updates.send(&ServerMessage::Notice {
            to: None,
            refused: false,
            text: text.into(),
        });
    }

    /// Sends a refusal to one page, or to all.
    pub(super) fn refuse(&self, to: Option<PageId>, text: String) {
        self.updates.send(&ServerMessage::Notice {
            to,
            refused: true,
            text: brief(text),
        });
    }
}
