//! A controller that a program commands call by call.

use crate::error;
use crate::robot::Robot;
use crate::simulation::Scenario;
use crate::touch;
use fivebar_files::scenario::place_in_job;
use fivebar_firmware::Status;
use fivebar_firmware::motion::{FIXTURES, StreamMode, StreamPolicy};
use fivebar_firmware::safety::Fault;
use fivebar_report::text::next_step;
use fivebar_sim::controller::{ControllerSource, sentence};
use fivebar_sim::drive::{DriveError, Homing};
use fivebar_sim::link::Emulator;
use fivebar_sim::live::{LiveArm, LiveError, LiveStream, Pace, Pending};
use fivebar_sim::machine::{Machine, Signal};
use fivebar_sim::simulation::fault_name;
use fivebar_sim::streaming::{SetPoint, StreamOptions};
use fivebar_sim::teaching::{TaughtPath, TeachError};
use pyo3::prelude::*;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Time between two looks at signals and at the progress.
const LOOK: Duration = Duration::from_millis(50);

/// A connection to a controller.
#[pyclass(frozen, module = "fivebar._native")]
pub(crate) struct Connection {
    arm: LiveArm,
    machine: Machine,
    /// The stream in progress.
    stream: Mutex<Option<LiveStream>>,
    /// The process that has its thread: a child that `fork` made has none.
    process: u32,
}

/// What a call does with its progress: it is called with the moves taken, all moves and the line; and at a pause with
/// its text.
type Watchers = (Option<Py<PyAny>>, Option<Py<PyAny>>);

#[pymethods]
impl Connection {
    /// Opens the controller: "simulated", "emulated" or the name of a port.
    #[new]
    fn new(
        py: Python<'_>,
        robot: &Robot,
        to: &str,
        image: Option<PathBuf>,
        upload: bool,
        real_time: bool,
    ) -> PyResult<Self> {
        let robot = &robot.described;
        let machine = Machine::of(robot.drive_kind());
        let image = image.unwrap_or_else(|| Emulator::built_image(machine.emulated));
        let source = match to {
            "simulated" => ControllerSource::Simulated,
            "emulated" => ControllerSource::Emulated(&image),
            name => ControllerSource::Port { name, upload },
        };
        let pace = match real_time {
            true => Pace::RealTime,
            false => Pace::AsFastAsPossible,
        };
        let arm = py.detach(|| LiveArm::open(robot, source, pace));
        Ok(Self {
            arm: arm.map_err(|refusal| error::controller(py, refusal))?,
            machine,
            stream: Mutex::new(None),
            process: process::id(),
        })
    }

    /// Where the controller runs.
    #[getter]
    fn place(&self) -> &str {
        self.arm.place()
    }

    /// What is known of the arm, as JSON.
    fn state(&self) -> String {
        let progress = self.arm.progress();
        let mut state = self.described(&progress.status);
        state["moves_taken"] = progress.taken.into();
        state["moves"] = progress.moves.into();
        state["pause"] = progress.pause.into();
        state.to_string()
    }

    /// Homes; at these angles [rad] if the arm was turned there by hand.
    fn home(&self, py: Python<'_>, at: Option<[f64; 2]>, again: bool) -> PyResult<()> {
        let homing = match at {
            Some(angles) => Homing::At(angles.map(|angle| angle as f32)),
            None if again => Homing::Always,
            None => Homing::IfUnknown,
        };
        self.call(py, (None, None), |arm| arm.home(homing))
    }

    fn motors_on(&self, py: Python<'_>) -> PyResult<()> {
        self.call(py, (None, None), LiveArm::motors_on)
    }

    fn motors_off(&self, py: Python<'_>) -> PyResult<()> {
        self.call(py, (None, None), LiveArm::motors_off)
    }

    fn clear_fault(&self, py: Python<'_>) -> PyResult<()> {
        self.call(py, (None, None), LiveArm::clear_fault)
    }

    /// Moves the tool straight to a point [m] with at most this speed [m/s].
    fn move_to(&self, py: Python<'_>, to: [f64; 2], speed: f64) -> PyResult<()> {
        let to = to.map(|x| x as f32);
        self.call(py, (None, None), |arm| arm.move_to(to, speed as f32))
    }

    /// Turns the joints to angles [rad] with this share of their greatest speed.
    fn move_joints(&self, py: Python<'_>, to: [f64; 2], speed: f64) -> PyResult<()> {
        let to = to.map(|x| x as f32);
        self.call(py, (None, None), |arm| arm.move_joints(to, speed as f32))
    }

    /// Puts the tool at a level, 0 (up or off) to 1.
    fn set_tool(&self, py: Python<'_>, level: f64) -> PyResult<()> {
        self.call(py, (None, None), |arm| arm.set_tool(level as f32))
    }

    /// Draws a job.
    #[allow(
        clippy::too_many_arguments,
        reason = "they are those of the Python method"
    )]
    fn draw(
        &self,
        py: Python<'_>,
        scenario: &Scenario,
        origin: Option<[f64; 2]>,
        scale: Option<f64>,
        progress: Option<Py<PyAny>>,
        on_pause: Option<Py<PyAny>>,
    ) -> PyResult<Vec<String>> {
        let mut scenario = scenario.described.clone();
        scenario.origin = origin.or(scenario.origin);
        scenario.scale = scale.unwrap_or(scenario.scale);
        let job = py.detach(|| scenario.job());
        let job = job.map_err(|refusal| error::scenario(py, refusal))?;
        if let (None, Some(stop)) = (&on_pause, job.stops.first()) {
            let reason = format!(
                "{}, line {}: the job waits for its user ({stop}); give `on_pause`",
                scenario.job_file, stop.line
            );
            return Err(error::job(py, reason, stop.line));
        }
        self.call(py, (progress, on_pause), |arm| arm.draw(&scenario, &job))?;
        Ok(job.warnings.iter().map(ToString::to_string).collect())
    }

    /// Lets a hand lead the arm for so long [s], or until it is stopped; returns what it has taught as JSON.
    fn be_led(&self, py: Python<'_>, seconds: f64) -> PyResult<String> {
        let mut record = None;
        self.call(py, (None, None), |arm| {
            let (pending, kept) = arm.be_led(seconds)?;
            record = Some(kept);
            Ok(pending)
        })?;
        let taught = py.detach(|| match &record {
            Some(record) => self.arm.taught(record),
            None => Err(LiveError::Teach(TeachError::Still)),
        });
        let taught = taught.map_err(|refusal| refused(py, refusal))?;
        Ok(taught.to_json())
    }

    /// Does a taught motion, as JSON, again at a multiple of its speed.
    fn replay(&self, py: Python<'_>, taught: &str, speed: f64) -> PyResult<()> {
        let path = TaughtPath::parse(taught).map_err(|refusal| error::controller(py, refusal))?;
        self.call(py, (None, None), |arm| arm.replay(&path, speed))
    }

    /// Begins a stream of set-points of the joints or of the tip: so many points per second, each there after a delay [s]. It may
    /// go on at limits.
    fn begin_stream(
        &self,
        py: Python<'_>,
        joints: bool,
        rate: f64,
        delay: Option<f64>,
        goes_on: bool,
    ) -> PyResult<()> {
        self.here(py)?;
        let mode = match joints {
            true => StreamMode::Joint,
            false => StreamMode::Tip,
        };
        let options = StreamOptions {
            mode,
            rate,
            delay,
            policy: match goes_on {
                true => StreamPolicy::Limit,
                false => StreamPolicy::Stop,
            },
            fixtures: [None; FIXTURES],
        };
        self.begin(py, options)
    }

    /// Begins a stream with an impedance: K [N/m] and D [N·s/m] as xx, xy, yy, and walls and guides, each as its kind, its numbers,
    /// and its stiffness and damping.
    fn begin_impedance(
        &self,
        py: Python<'_>,
        stiffness: [f64; 3],
        damping: [f64; 3],
        fixtures: Vec<(String, [f64; 6], f64, f64)>,
        rate: f64,
    ) -> PyResult<()> {
        self.here(py)?;
        let fixtures =
            touch::fixtures(&fixtures).map_err(|refusal| error::controller(py, refusal))?;
        let options = StreamOptions {
            mode: StreamMode::Impedance(touch::impedance(stiffness, damping)),
            rate,
            delay: None,
            policy: StreamPolicy::Stop,
            fixtures,
        };
        self.begin(py, options)
    }

    /// Gives the next point of the stream; waits until it is due.
    fn stream_point(
        &self,
        py: Python<'_>,
        position: [f64; 2],
        velocity: Option<[f64; 2]>,
        force: [f64; 2],
    ) -> PyResult<()> {
        let point = SetPoint {
            position,
            velocity,
            force,
        };
        self.give(py, |stream| stream.send(point))
    }

    /// Changes the springs and dampers of a stream with an impedance.
    fn change_impedance(
        &self,
        py: Python<'_>,
        stiffness: [f64; 3],
        damping: [f64; 3],
    ) -> PyResult<()> {
        self.give(py, |stream| {
            stream.change(touch::impedance(stiffness, damping))
        })
    }

    /// What the controller has told last of the latest stream, as JSON; times in seconds.
    fn stream_state(&self) -> Option<String> {
        let progress = self.arm.progress();
        let tick_rate = self.arm.tick_rate();
        let state = progress.stream?;
        let told = &state.progress;
        let described = json!({
            "phase": format!("{:?}", told.phase),
            "reason": told.reason.map(|reason| reason.to_string()),
            "late": told.late,
            "lost": told.lost,
            "refused": told.refused,
            "limited": told.limited,
            "buffered": f64::from(state.buffered) / tick_rate,
            "theta": state.angle,
            "omega": state.velocity,
            "torque": state.torque,
        });
        Some(described.to_string())
    }

    /// Ends the stream, and waits until the arm rests behind its last point. Does nothing if it has ended.
    fn end_stream(&self, py: Python<'_>) -> PyResult<()> {
        self.here(py)?;
        let stream = self
            .stream
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        let ended = py.detach(|| stream.map_or(Ok(()), LiveStream::finish));
        ended.map_err(|refusal| refused(py, refusal))
    }

    /// Ends the present call at rest on its path.
    fn stop(&self, py: Python<'_>) -> PyResult<()> {
        self.here(py)?;
        py.detach(|| self.arm.stop());
        Ok(())
    }

    /// Switches the motors off at once.
    fn emergency_stop(&self, py: Python<'_>) -> PyResult<()> {
        self.here(py)?;
        let done = py.detach(|| self.arm.emergency_stop());
        done.map_err(|refusal| refused(py, refusal))
    }

    /// Brings the arm to rest, switches its motors off and ends the connection.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        // The arm is its parent's.
        if self.process != process::id() {
            return Ok(());
        }
        let done = py.detach(|| self.arm.close());
        done.map_err(|refusal| refused(py, refusal))
    }
}

impl Connection {
    /// Gives the stream something, if it goes on; else says why it has ended.
    fn give(&self, py: Python<'_>, send: impl Fn(&LiveStream) -> bool + Sync) -> PyResult<()> {
        self.here(py)?;
        let goes_on = py.detach(|| {
            let stream = self.stream.lock().unwrap_or_else(PoisonError::into_inner);
            stream.as_ref().is_some_and(&send)
        });
        match goes_on {
            true => Ok(()),
            false => self.end_stream(py),
        }
    }

    fn begin(&self, py: Python<'_>, options: StreamOptions) -> PyResult<()> {
        let begun = py.detach(|| self.arm.stream(options));
        let begun = begun.map_err(|refusal| refused(py, refusal))?;
        *self.stream.lock().unwrap_or_else(PoisonError::into_inner) = Some(begun);
        Ok(())
    }

    /// Does a call and waits for its end. A signal or an error of a watcher stops it.
    fn call(
        &self,
        py: Python<'_>,
        (progress, on_pause): Watchers,
        begin: impl FnOnce(&LiveArm) -> Result<Pending, LiveError> + Send,
    ) -> PyResult<()> {
        self.here(py)?;
        let pending = py.detach(|| begin(&self.arm));
        let mut pending = pending.map_err(|refusal| refused(py, refusal))?;
        loop {
            // One thread at a time waits for the answer: what waits goes there and back.
            let answer;
            (pending, answer) = py.detach(move || {
                let answer = pending.wait(LOOK);
                (pending, answer)
            });
            if let Some(answer) = answer {
                return answer.map_err(|refusal| refused(py, refusal));
            }
            let watched = py
                .check_signals()
                .and_then(|()| self.tell(py, progress.as_ref(), on_pause.as_ref()));
            if let Err(error) = watched {
                py.detach(|| self.arm.stop());
                return Err(error);
            }
        }
    }

    /// Tells of the progress, and of a pause.
    fn tell(
        &self,
        py: Python<'_>,
        progress: Option<&Py<PyAny>>,
        on_pause: Option<&Py<PyAny>>,
    ) -> PyResult<()> {
        let now = self.arm.progress();
        if let Some(progress) = progress {
            progress.call1(py, (now.taken, now.moves, now.status.tag))?;
        }
        if let (Some(on_pause), Some(text)) = (on_pause, now.pause) {
            on_pause.call1(py, (text,))?;
            self.arm.go_on();
        }
        Ok(())
    }

    /// Refuses a process that has not the connection's thread.
    fn here(&self, py: Python<'_>) -> PyResult<()> {
        match self.process == process::id() {
            true => Ok(()),
            false => Err(error::controller(
                py,
                "the connection belongs to the process that made it: connect in this one",
            )),
        }
    }

    fn described(&self, status: &Status) -> Value {
        let pair = |values: [f32; 2]| json!(values.map(f64::from));
        let shown = |signal: Signal, value: Value| match self.machine.shows.contains(&signal) {
            true => value,
            false => Value::Null,
        };
        let rate = self.arm.robot().control.tick_rate;
        json!({
            "state": format!("{:?}", status.state),
            "fault": status.fault.map(fault_name),
            "fault_number": status.fault.map(Fault::number),
            "homed": status.homed,
            "tool": status.tool.filter(|_| status.homed).map(pair),
            "theta": status.homed.then(|| pair(status.angle)),
            "omega": pair(status.velocity),
            "line": status.tag,
            "tool_level": f64::from(status.tool_level),
            "time": f64::from(status.tick) / rate,
            "missed_ticks": status.missed_ticks,
            "torque": shown(Signal::Torque, pair(status.torque)),
            "current": shown(Signal::Current, pair(status.current)),
            "bus_voltage": shown(Signal::BusVoltage, json!(f64::from(status.bus_voltage))),
        })
    }
}

/// A taught path, as JSON, in another form: "gcode", "svg" or "csv".
#[pyfunction]
pub(crate) fn taught_path_as(py: Python<'_>, taught: &str, form: &str) -> PyResult<String> {
    let path = TaughtPath::parse(taught).map_err(|refusal| error::controller(py, refusal))?;
    Ok(match form {
        "gcode" => path.to_gcode(),
        "svg" => path.to_svg(),
        "csv" => path.rests_to_csv(),
        _ => path.to_json(),
    })
}

/// The places at which the tip rested for so long [s] along a taught path, as JSON.
#[pyfunction]
pub(crate) fn taught_rests(py: Python<'_>, taught: &str, least: f64) -> PyResult<Vec<[f64; 2]>> {
    let path = TaughtPath::parse(taught).map_err(|refusal| error::controller(py, refusal))?;
    Ok(path.rests(least))
}

/// A refused or ended call as an exception.
fn refused(py: Python<'_>, refusal: LiveError) -> PyErr {
    match refusal {
        LiveError::Drive(DriveError::Fault(fault)) => {
            let message = format!(
                "the controller stopped the arm with fault {}, {}. {}",
                fault.number(),
                fault_name(fault),
                next_step(fault)
            );
            error::fault(py, message, &fault_name(fault), fault.number())
        }
        LiveError::Drive(DriveError::Stopped(line)) => {
            let place = line.filter(|line| *line > 0);
            let place = place.map_or_else(String::new, |line| format!(" on line {line}"));
            error::stopped_by_user(py, format!("stopped{place}; the arm rests"), line)
        }
        LiveError::Drive(DriveError::Move(refusal)) => {
            let place = place_in_job(false, refusal.tag);
            error::refused_move(
                py,
                format!("{place}: {refusal}"),
                refusal.tag,
                refusal.point,
            )
        }
        LiveError::Drive(DriveError::ModeChange(refusal)) => {
            error::job(py, refusal.to_string(), refusal.line)
        }
        LiveError::Drive(DriveError::Refused { what, error }) => {
            let message = format!("the controller refuses to {what}: {}", sentence(&error));
            error::controller(py, message)
        }
        other => error::controller(py, other),
    }
}
