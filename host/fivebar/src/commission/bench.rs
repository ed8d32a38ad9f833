//! What every step needs: the controller, the person, the robot as known so far.

use super::StepError;
use super::line::Line;
use super::log::LogRows;
use super::operator::{Operator, Task};
use super::question::{Answer, Question};
use fivebar_files::measurements::read_columns;
use fivebar_files::robot::{Actuator, HomeMethod, Robot};
use fivebar_firmware::controller::{Excitation, ExcitationEnd, Excited};
use fivebar_firmware::protocol::{CommandError, HostCommand, Reply};
use fivebar_firmware::recorder::{LogConfig, LogPage, PAGE_WORDS, Signals};
use fivebar_firmware::safety::State;
use fivebar_firmware::{Request, Settings, Status, ToldSample};
use fivebar_kinematics::five_bar::Joint;
use fivebar_report::output::write_whole;
use fivebar_sim::drive::{Drive, Homing};
use fivebar_sim::link::Client;
use fivebar_sim::machine::{Machine, Signal};
use std::f64::consts::TAU;
use std::fmt::Display;
use std::path::PathBuf;

/// Number of pauses of 10 ms after which the wait for a cleared fault ends: 5 s.
const LONGEST_CLEARING: u32 = 500;

/// The bench.
pub(super) struct Bench {
    pub(super) client: Client<Box<dyn Line>>,
    pub(super) operator: Operator,
    /// The robot as known so far.
    pub(super) robot: Robot,
    /// Its settings, which the controller uses.
    pub(super) settings: Settings,
    /// The robot as drawn.
    pub(super) drawn: Robot,
    /// The current sensors' codes at no current.
    pub(super) zeros: [f64; 2],
    /// The place of the touched plate, see [`Record::placement`](super::record::Record::placement).
    pub(super) placement: [f64; 3],
    /// Greatest travel [rad] and current [A] of each joint in all excitations.
    pub(super) greatest: [[f64; 2]; 2],
    /// Touched holes in place of those that the geometry step asks for.
    pub(super) points: Option<PathBuf>,
    /// Where the touched holes are kept.
    pub(super) holes_file: PathBuf,
}

/// A voltage on a motor, see [`Excitation`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Pulse {
    /// The joint whose bridge is used.
    pub(super) joint: Joint,
    /// The mean and the amplitude of the pseudo-random sequence around it [V].
    pub(super) volts: [f64; 2],
    /// Duration [s].
    pub(super) time: f64,
    /// Travel at which it ends [rad].
    pub(super) travel: f64,
    /// Current of either motor at which it ends [A].
    pub(super) current: f64,
    /// What is logged, and every how many ticks.
    pub(super) signals: Signals,
    pub(super) every: u16,
}

impl Bench {
    /// A bench whose controller has not got the robot's settings yet.
    pub(super) fn new(
        client: Client<Box<dyn Line>>,
        operator: Operator,
        drawn: Robot,
        robot: Robot,
        points: Option<PathBuf>,
    ) -> Result<Self, StepError> {
        let settings = robot.settings().map_err(StepError::other)?;
        Ok(Self {
            client,
            operator,
            zeros: settings.axes.map(|axis| f64::from(axis.current_zero_code)),
            settings,
            robot,
            drawn,
            placement: [0.0; 3],
            greatest: [[0.0; 2]; 2],
            points,
            holes_file: PathBuf::new(),
        })
    }

    /// Clears a fault of before and sends the settings.
    pub(super) fn clear_and_upload(&mut self) -> Result<(), StepError> {
        self.pause(0.05)?;
        if self.sample()?.emergency_stop {
            return Err(StepError::wrong(
                "the emergency stop reads as pressed",
                "release it; a broken wire of S1a reads as pressed, too",
            ));
        }
        self.clear()?;
        self.upload()
    }

    /// Measures the zeros of both current sensors, with the bridges off.
    pub(super) fn measure_zeros(&mut self) -> Result<(), StepError> {
        let config = LogConfig {
            signals: (Signals::SENSED_1 | Signals::SENSED_4).bits(),
            every: 1,
            powered: false,
        };
        self.begin_log(config)?;
        self.pause(0.3)?;
        let rows = self.read_log(&config)?;
        for (joint, zero) in Joint::ALL.into_iter().zip(&mut self.zeros) {
            let codes = rows.current_codes(joint);
            *zero = codes.iter().sum::<f64>() / codes.len().max(1) as f64;
        }
        Ok(())
    }

    /// Keeps touched holes: rows of counts1, counts4, x, y.
    pub(super) fn keep_holes(&self, rows: &[[f64; 4]]) -> Result<(), StepError> {
        let mut text = String::from("counts1,counts4,x,y\n");
        for [counts1, counts4, x, y] in rows {
            text += &format!("{counts1},{counts4},{x},{y}\n");
        }
        write_whole(&self.holes_file, text).map_err(StepError::other)
    }

    /// The touched holes that were kept; none if there are none.
    pub(super) fn holes(&self) -> Result<Option<Vec<[f64; 4]>>, StepError> {
        if !self.holes_file.exists() {
            return Ok(None);
        }
        let rows = read_columns(&self.holes_file, ["counts1", "counts4", "x", "y"]);
        rows.map(Some).map_err(StepError::other)
    }

    /// Says what a step does.
    pub(super) fn report(&mut self, what: impl Display) -> Result<(), StepError> {
        self.operator.report(&what.to_string())
    }

    /// Says what the controller measured when it latched a fault, if it has one.
    pub(super) fn report_fault(&mut self) {
        if let Ok(Reply::Snapshot(Some(latched))) = self.client.call(HostCommand::Snapshot) {
            let [angle1, angle4] = latched.angle;
            let [current1, current4] = latched.current;
            // Only an addition to the error that follows.
            let _ = self.report(format_args!(
                "fault {} while {:?}: θ1 = {angle1:.3} and θ4 = {angle4:.3} rad, currents \
                 {current1:.2} and {current4:.2} A, bus {:.1} V",
                latched.fault.number(),
                latched.state,
                latched.bus_voltage
            ));
        }
    }

    /// The joint that was farthest from its motion when the fault was latched, if one is.
    pub(super) fn farthest_at_fault(&mut self) -> Option<Joint> {
        match self.client.call(HostCommand::Snapshot) {
            Ok(Reply::Snapshot(Some(latched))) => {
                let [error1, error4] = latched.error.map(f32::abs);
                Some(if error1 > error4 {
                    Joint::Joint1
                } else {
                    Joint::Joint4
                })
            }
            _ => None,
        }
    }

    /// The drive of a joint.
    pub(super) fn drive(&self, joint: Joint) -> Result<Actuator, StepError> {
        self.robot
            .actuators
            .as_ref()
            .map(|both| both[joint])
            .ok_or_else(|| {
                StepError::other(
                    "the robot file has no [[actuator]]: an arm with motors needs both",
                )
            })
    }

    /// Encoder counts per turn of a joint; negative where the motor turns against it.
    pub(super) fn counts_per_turn(&self, joint: Joint) -> Result<f64, StepError> {
        let drive = self.drive(joint)?;
        Ok(f64::from(drive.encoder_counts) * drive.gear_ratio)
    }

    /// The latest sample of the inputs.
    pub(super) fn sample(&mut self) -> Result<ToldSample, StepError> {
        self.client.sample()?.ok_or_else(|| {
            StepError::other("this board has no inputs of its own: it is stepped by its host")
        })
    }

    /// Lets time pass and returns the status after it; the host stays alive.
    pub(super) fn pause(&mut self, seconds: f64) -> Result<Status, StepError> {
        let ticks = (seconds * self.robot.control.tick_rate) as u32;
        let (first, _) = self.client.status()?;
        loop {
            let (status, _) = self.client.status()?;
            if status.tick.wrapping_sub(first.tick) >= ticks {
                return Ok(status);
            }
            self.client.poll()?;
        }
    }

    /// Samples over some time, about one every 10 ms.
    pub(super) fn samples(&mut self, seconds: f64) -> Result<Vec<ToldSample>, StepError> {
        let mut samples = Vec::new();
        for _ in 0..(seconds / 0.01) as u32 {
            samples.push(self.sample()?);
            self.pause(0.01)?;
        }
        Ok(samples)
    }

    /// Asks for a task and waits until it is done.
    pub(super) fn ask(&mut self, task: Task) -> Result<(), StepError> {
        self.operator.ask(&task)?;
        self.pause(0.05)?;
        while !self.operator.is_done() {
            self.pause(0.05)?;
        }
        self.pause(0.05)?;
        Ok(())
    }

    /// Asks what somebody sees or feels.
    pub(super) fn see(&mut self, question: Question) -> Result<Answer, StepError> {
        self.operator.see(&question)
    }

    /// Switches the powered arm off, and waits until it is.
    pub(super) fn power_off(&mut self) -> Result<(), StepError> {
        Ok(Drive::new(&mut self.client, &|| false).end_hold()?)
    }

    /// Whether the controller measures this of the robot's drives.
    pub(super) fn shows(&self, signal: Signal) -> bool {
        Machine::of(self.robot.drive_kind()).shows.contains(&signal)
    }

    /// Whether the counts follow a joint that a hand turns without power.
    pub(super) fn counts_by_hand(&self) -> bool {
        let only_told = self.robot.has_steppers() || self.robot.hobby_servos().is_some();
        !only_told || self.robot.has_steppers_with_encoders()
    }

    /// A request that must be granted.
    pub(super) fn request(&mut self, request: Request) -> Result<(), StepError> {
        let command = HostCommand::Request(request);
        let refused = |error: CommandError| {
            StepError::wrong(
                format_args!("the controller refuses: {error}"),
                "remove the cause, and run the same command again",
            )
        };
        self.client.command(command)?.map_err(refused)
    }

    /// Clears a latched fault, if there is one.
    pub(super) fn clear(&mut self) -> Result<(), StepError> {
        if self.client.status()?.0.fault.is_some() {
            self.request(Request::ClearFault)?;
        }
        // A fault that holds the arm ends when the holding brakes have engaged.
        for _ in 0..LONGEST_CLEARING {
            if self.client.status()?.0.fault.is_none() {
                break;
            }
            self.pause(0.01)?;
        }
        Ok(())
    }

    /// Makes the controller use and store the settings of the robot as known so far; it is not
    /// homed then.
    pub(super) fn upload(&mut self) -> Result<(), StepError> {
        self.settings = self.robot.settings().map_err(StepError::other)?;
        if let Some(fault) = self.client.status()?.0.fault {
            return Err(StepError::Fault(fault));
        }
        let mut drive = Drive::new(&mut self.client, &|| false);
        drive.end_hold()?;
        drive.store_settings(&self.settings)?;
        // Until its next heartbeat a drive on a bus counts as silent.
        if self.robot.can_drives().is_some() {
            self.pause(0.05)?;
        }
        Ok(())
    }

    /// Homes the arm by the robot file's method, unless it is homed.
    pub(super) fn home(&mut self) -> Result<(), StepError> {
        // A servo turns to its home at full speed when it gets its first pulse.
        let by_hand =
            self.robot.homing.method == HomeMethod::Given || self.robot.hobby_servos().is_some();
        let asked = by_hand && !self.client.status()?.0.homed;
        if asked {
            self.ask(Task::Home)?;
        }
        Drive::new(&mut self.client, &|| false).home(Homing::IfUnknown)?;
        if asked {
            self.ask(Task::LetGo)?;
        }
        Ok(())
    }

    /// Begins a log.
    pub(super) fn begin_log(&mut self, config: LogConfig) -> Result<(), StepError> {
        let begun = self.client.command(HostCommand::BeginLog(config))?;
        begun.map_err(|error| StepError::other(format_args!("no log: {error}")))
    }

    fn page(&mut self, from: u16) -> Result<LogPage, StepError> {
        match self.client.call(HostCommand::ReadLog { from })? {
            Reply::Log(page) => Ok(page),
            other => Err(StepError::other(format_args!("no log: {other:?}"))),
        }
    }

    /// Reads the log.
    pub(super) fn read_log(&mut self, config: &LogConfig) -> Result<LogRows, StepError> {
        let whole = usize::from(self.page(0)?.words);
        let mut words = Vec::with_capacity(whole + PAGE_WORDS);
        while words.len() < whole {
            let from = words.len() as u16;
            words.extend(self.page(from)?.page.iter().flatten());
        }
        words.truncate(whole);
        Ok(LogRows::new(config, words))
    }

    /// Puts a voltage on a motor and returns the log of it. The joints rest afterwards.
    pub(super) fn excite(&mut self, pulse: &Pulse) -> Result<(LogRows, ExcitationEnd), StepError> {
        let config = LogConfig {
            signals: pulse.signals.bits(),
            every: pulse.every,
            powered: true,
        };
        let rate = self.robot.control.tick_rate;
        self.begin_log(config)?;
        self.request(Request::Excite(Excitation {
            joint: pulse.joint.index() as u8,
            of: Excited::Voltage,
            offset: pulse.volts[0] as f32,
            amplitude: pulse.volts[1] as f32,
            hold: 2,
            ticks: (pulse.time * rate) as u32,
            current: pulse.current as f32,
            travel: pulse.travel as f32,
        }))?;
        loop {
            let status = self.pause(0.01)?;
            match (status.state, status.fault) {
                (_, Some(fault)) => return Err(StepError::Fault(fault)),
                (State::Exciting, None) => {}
                _ => break,
            }
        }
        let rows = self.read_log(&config)?;
        self.take_greatest(pulse.joint, &rows)?;
        match self.client.call(HostCommand::ExcitationEnd)? {
            Reply::ExcitationEnd(Some(end)) => Ok((rows, end)),
            other => Err(StepError::other(format_args!("no end of it: {other:?}"))),
        }
    }

    fn take_greatest(&mut self, joint: Joint, rows: &LogRows) -> Result<(), StepError> {
        let per_count = (TAU / self.counts_per_turn(joint)?).abs();
        let per_code = f64::from(self.settings.axes[joint].current_per_code);
        let zero = self.zeros[joint];
        let most = |values: Vec<f64>, zero: f64, unit: f64| {
            let sizes = values.into_iter().map(|value| (value - zero).abs() * unit);
            sizes.fold(0.0, f64::max)
        };
        let [travel, current] = &mut self.greatest[joint];
        *travel = travel.max(most(rows.counts(joint), 0.0, per_count));
        *current = current.max(most(rows.current_codes(joint), zero, per_code));
        Ok(())
    }
}
