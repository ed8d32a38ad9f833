//! The host of a trial: it brings the arm into the state, and goes on as if nothing had happened.

use crate::arms::Arm;
use crate::injected::Fault;
use crate::outcome::{COASTING, Found, Measure, Outcome, Seen};
use crate::trial::{During, Trial};
use fivebar_firmware::controller::{Excitation, Excited, RequestError};
use fivebar_firmware::planner::MoveErrorKind;
use fivebar_firmware::safety::{self, Response, State};
use fivebar_firmware::{Controller, Move, MoveKind, Planner, Request};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{FaultKind, Hands, Mismatch, Plant};

/// Simulated time after the fault [s], and after a latched fault that switches off.
const WATCHED: f64 = 3.0;
const WATCHED_OFF: f64 = COASTING + 0.2;
/// The last act of a script goes on for longer than that [s].
const ON: f64 = 10.0;
/// Time of silence after which the held arm rests [s].
const HOLDING: f64 = 0.4;
/// Time from the welded emergency stop until somebody presses it [s].
const PRESSED_AFTER: f64 = 0.2;
/// Turn of the joints from home where a search begins [rad].
const BEFORE_HOME: f64 = 0.05;

/// The trial is over.
struct Over;

/// A controller with its arm and its host.
struct Host<'a> {
    arm: &'a Arm,
    trial: &'a Trial,
    controller: Controller,
    planner: Planner,
    plant: Plant,
    period: f64,
    time: f64,
    /// When the fault comes [s].
    due: Option<f64>,
    measure: Option<Measure>,
    /// The fault that was latched before.
    before: Option<safety::Fault>,
    /// When a fault was latched after the injected one [s], and which.
    latched: Option<(f64, safety::Fault)>,
    silent: bool,
}

/// Runs a trial.
pub(crate) fn run(trial: &Trial, arm: &Arm) -> Outcome {
    let mut host = Host::new(trial, arm);
    let ended = host.script();
    assert!(ended.is_err(), "{trial:?}: the script ends too early");
    host.measure.expect("the fault was injected").outcome
}

impl<'a> Host<'a> {
    fn new(trial: &'a Trial, arm: &'a Arm) -> Self {
        let homes = arm.settings.axes.map(|axis| {
            if axis.home_forward {
                -BEFORE_HOME
            } else {
                BEFORE_HOME
            }
        });
        let pose = match trial.during {
            During::Homing => arm.robot.pose_near_home(homes).expect("a pose"),
            _ => arm.start,
        };
        let period = 1.0 / arm.robot.control.tick_rate;
        Self {
            arm,
            trial,
            controller: Controller::new(&arm.settings),
            planner: Planner::new(&arm.settings),
            plant: Plant::new(&arm.parameters, &Mismatch::default(), &pose, trial.seed),
            period,
            time: 0.0,
            due: None,
            measure: None,
            before: None,
            latched: None,
            silent: false,
        }
    }

    /// Brings the arm into the state in which the fault comes, then goes on to the job.
    #[expect(clippy::too_many_lines, reason = "a list: one arm for each state")]
    fn script(&mut self) -> Result<(), Over> {
        self.wait(0.01)?;
        match self.trial.during {
            During::Homing => {
                self.fault_comes();
                self.home()?;
                self.request(Request::Arm)?;
                self.far_job()
            }
            During::Exciting => {
                self.request(Request::Excite(self.excitation()))?;
                self.fault_comes();
                while self.controller.state() == State::Exciting {
                    self.tick()?;
                }
                self.wait(0.1)?;
                self.declare_angles()?;
                self.request(Request::Arm)?;
                self.far_job()
            }
            During::Stopped => {
                self.declare_angles()?;
                self.fault_comes();
                self.wait(0.2)?;
                self.request(Request::Arm)?;
                self.job(&self.arm.fast, ON)
            }
            During::Waking => {
                self.declare_angles()?;
                self.request(Request::Arm)?;
                self.fault_comes();
                self.wait(0.01)?;
                self.job(&self.arm.fast, ON)
            }
            During::Armed => {
                self.armed()?;
                self.fault_comes();
                self.wait(0.3)?;
                self.job(&self.arm.fast, ON)
            }
            During::RunningSlowly | During::RunningFast | During::TimeOptimal => {
                self.armed()?;
                let job = match self.trial.during {
                    During::RunningSlowly => &self.arm.slow,
                    During::TimeOptimal => &self.arm.timed,
                    _ => &self.arm.fast,
                };
                self.fault_comes_after(0.1);
                self.job(job, ON)
            }
            During::Stopping => {
                self.armed()?;
                self.job(&self.arm.fast, 0.13)?;
                self.request(Request::Stop)?;
                self.fault_comes();
                self.wait(0.2)?;
                self.request(Request::Disarm)?;
                self.wait(ON)
            }
            During::Crossing => {
                self.armed()?;
                let kind = self.arm.crossing.expect("the arm crosses");
                let start = self.arm.start.angles();
                let to = [start[0] as f32, start[3] as f32];
                let kinds = [MoveKind::Joint { to, speed: 0.2 }, kind];
                let moves = kinds.map(|kind| Move {
                    tag: 1,
                    tool: 0,
                    kind,
                });
                self.offer_all(&moves)?;
                while self.controller.state() != State::Crossing {
                    self.tick()?;
                }
                self.fault_comes();
                self.wait(ON)
            }
            During::Held => {
                self.armed()?;
                self.job(&self.arm.fast, 0.1)?;
                self.silent = true;
                self.wait(HOLDING)?;
                self.fault_comes();
                self.wait(ON)
            }
        }
    }

    /// Turns the joints to where the jobs begin.
    fn to_start(&self) -> Move {
        let start = self.arm.start.angles();
        let to = [start[0] as f32, start[3] as f32];
        Move {
            tag: 1,
            tool: 0,
            kind: MoveKind::Joint { to, speed: 0.2 },
        }
    }

    /// Does the job with the arm anywhere.
    fn far_job(&mut self) -> Result<(), Over> {
        self.offer_all(&[self.to_start()])?;
        self.job(&self.arm.fast, ON)
    }

    fn excitation(&self) -> Excitation {
        let current = self.arm.settings.axes[0].continuous_current;
        Excitation {
            joint: (self.trial.seed % 2) as u8,
            of: Excited::Current,
            offset: 0.0,
            amplitude: 0.5 * current,
            hold: 20,
            ticks: 3000,
            current,
            travel: 0.1,
        }
    }

    fn fault_comes(&mut self) {
        self.fault_comes_after(0.0);
    }

    /// The state begins in this time [s].
    fn fault_comes_after(&mut self, begins: f64) {
        self.due = Some(self.time + begins + self.trial.after);
    }

    fn declare_angles(&mut self) -> Result<(), Over> {
        let angles = Joint::ALL.map(|joint| self.plant.angle(joint) as f32);
        self.request(Request::SetAngles(angles))
    }

    fn armed(&mut self) -> Result<(), Over> {
        self.declare_angles()?;
        self.request(Request::Arm)?;
        self.wait(0.05)
    }

    fn home(&mut self) -> Result<(), Over> {
        self.request(Request::Home)?;
        while self.controller.state() == State::Homing {
            self.tick()?;
        }
        self.wait(0.1)
    }

    /// Does a request. The arm is watched to the end of the trial if it is refused.
    fn request(&mut self, request: Request) -> Result<(), Over> {
        let answer = self.controller.request(request);
        let Err(error) = answer else { return Ok(()) };
        // A host that was answered with a fault does no more.
        let fault = matches!(error, RequestError::State(State::Fault));
        match &mut self.measure {
            Some(measure) if !fault => {
                let time = self.time - self.due.unwrap_or(self.time);
                measure.found(Found::Refused(error), time);
            }
            Some(_) => {}
            // The fault that is still to come has not been injected: a mistake of the script.
            None => panic!("{:?}: {request:?} is refused: {error}", self.trial),
        }
        self.wait(ON)
    }

    /// Does the job again and again for a time [s].
    fn job(&mut self, moves: &[Move], time: f64) -> Result<(), Over> {
        let end = self.time + time;
        while self.time < end {
            for next in moves {
                self.offer(next, end)?;
            }
            // A line goes on from a timed motion only after rest.
            while self.time < end && !self.is_at_rest() {
                self.tick()?;
            }
        }
        Ok(())
    }

    fn is_at_rest(&self) -> bool {
        let snapshot = self.controller.planning_snapshot();
        let is_over = snapshot.state == State::Armed && snapshot.path_left <= 0.0;
        self.planner.is_empty() && is_over
    }

    /// Offers a move until it is taken, or until the end [s].
    fn offer(&mut self, next: &Move, end: f64) -> Result<(), Over> {
        while self.time < end {
            match self.planner.push(&mut self.controller, next) {
                Ok(()) => return self.tick(),
                Err(error) if error.kind == MoveErrorKind::Full => self.tick()?,
                // The arm is not where the host thinks, or does not follow moves: it is watched.
                Err(_) if self.measure.is_some() => return self.wait(ON),
                Err(error) => panic!("{:?}: {error}", self.trial),
            }
        }
        Ok(())
    }

    fn offer_all(&mut self, moves: &[Move]) -> Result<(), Over> {
        for next in moves {
            self.offer(next, f64::INFINITY)?;
        }
        Ok(())
    }

    fn wait(&mut self, time: f64) -> Result<(), Over> {
        let end = self.time + time;
        while self.time < end {
            self.tick()?;
        }
        Ok(())
    }

    fn tick(&mut self) -> Result<(), Over> {
        let due = self.due.is_some_and(|due| due <= self.time);
        if due && self.measure.is_none() {
            self.inject();
        }
        if !self.silent {
            self.controller.feed_host_timeout();
        }
        self.planner.run(&mut self.controller);
        let sample = self.plant.sense();
        let command = self.controller.tick(&sample);
        let status = self.controller.status();
        self.plant.step(&command, self.period);
        self.time += self.period;
        let Some(measure) = &mut self.measure else {
            return Ok(());
        };
        let time = self.time - self.due.unwrap_or(self.time);
        if let Some(fault) = status.fault
            && Some(fault) != self.before
            && self.latched.is_none_or(|(_, latched)| latched != fault)
        {
            measure.found(Found::Latched(fault), time);
            self.latched = Some((self.time, fault));
        }
        measure.tick(&Seen {
            plant: &self.plant,
            time,
            latched: self.latched.map(|(at, fault)| (self.time - at, fault)),
            enabled: command.enable != [false; 2],
            // Until it is homed, its angles are from an unknown origin.
            reference: status
                .joint_reference
                .filter(|_| status.homed)
                .map(|reference| reference.angle),
        });
        let off = self.latched.is_some_and(|(at, fault)| {
            fault.response() == Response::PowerOff && self.time - at > WATCHED_OFF
        });
        if self.trial.fault == Fault::Plant(FaultKind::EmergencyStopWelded) && time > PRESSED_AFTER
        {
            self.plant.press(Hands {
                emergency_stop: true,
                ..Hands::default()
            });
        }
        if off || time > WATCHED {
            Err(Over)
        } else {
            Ok(())
        }
    }

    fn inject(&mut self) {
        let axes = &self.arm.settings.axes;
        self.due = Some(self.time);
        self.before = self.controller.fault().map(|snapshot| snapshot.fault);
        self.measure = Some(Measure::new(
            &self.plant,
            [0, 1].map(|j: usize| f64::from(axes[j].continuous_current)),
            [0, 1].map(|j: usize| f64::from(axes[j].max_speed)),
            self.period,
        ));
        match self.trial.fault {
            Fault::Plant(kind) => self.plant.inject(kind),
            Fault::HostSilent => self.silent = true,
        }
    }
}
