//! Runs: jobs of the simulated arm.

use crate::error;
use crate::pool::pool;
use crate::robot::Robot;
use fivebar_files::job::PETAL;
use fivebar_files::robot::BuiltIn;
use fivebar_files::scenario::{ControlLaw, Scenario as Described};
use fivebar_firmware::controller::Request;
use fivebar_firmware::{ActuatorCommand, Move, SensorSample, Status};
use fivebar_plant::Mismatch;
use fivebar_sim::link::{InProcess, Target, TargetError};
use fivebar_sim::simulation::{Sample, Simulate, fault_name};
use numpy::{Element, IntoPyArray};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// A run that has not begun.
#[pyclass(frozen, module = "fivebar._native")]
pub(crate) struct Scenario {
    pub(crate) described: Described,
}

#[pymethods]
impl Scenario {
    /// A scenario in TOML, with its own robot unless another is given, or a job in G-code, with
    /// the robot given or else the default one.
    #[staticmethod]
    fn of_file(py: Python<'_>, path: &str, robot: Option<&Robot>) -> PyResult<Self> {
        let refused = |refusal| error::scenario(py, refusal);
        let robot = robot.map(|robot| robot.described.clone());
        let is_scenario = Path::new(path).extension().is_some_and(|e| e == "toml");
        let described = if is_scenario {
            let scenario = Described::load(path).map_err(refused)?;
            let robot = robot.unwrap_or_else(|| scenario.robot.clone());
            Described { robot, ..scenario }
        } else {
            let robot = match robot {
                Some(robot) => robot,
                None => Robot::load(py, BuiltIn::DEFAULT)?.described,
            };
            Described::of_job(path, robot).map_err(refused)?
        };
        Ok(Self { described })
    }

    /// A job in G-code.
    #[staticmethod]
    fn of_text(robot: &Robot, text: String) -> Self {
        let described = Described::new("job", robot.described.clone(), "job", text);
        Self { described }
    }

    /// The petal job of a robot, which `fivebar clearance` draws.
    #[staticmethod]
    fn petal(robot: &Robot) -> Self {
        let job = "the petal job";
        let described = Described::new("petal", robot.described.clone(), job, PETAL.into());
        Self { described }
    }

    /// Runs it; the arguments given replace the scenario's values. Returns the figures as JSON,
    /// the trace's columns by name, the ticks between two samples, the faults with their times
    /// from power-up, the time at which the job began, and the parts of the job skipped.
    #[allow(clippy::too_many_arguments)]
    #[pyo3(signature = (*, origin, scale, seed, computed_torque, mismatch, tolerance, compare_pid, by_cause))]
    fn run<'py>(
        &self,
        py: Python<'py>,
        origin: Option<[f64; 2]>,
        scale: Option<f64>,
        seed: Option<u64>,
        computed_torque: Option<bool>,
        mismatch: BTreeMap<String, Figure>,
        tolerance: Option<f64>,
        compare_pid: bool,
        by_cause: bool,
    ) -> PyResult<Outcome<'py>> {
        let mut scenario = self.described.clone();
        scenario.origin = origin.or(scenario.origin);
        scenario.scale = scale.unwrap_or(scenario.scale);
        scenario.seed = seed.unwrap_or(scenario.seed);
        scenario.control_law = computed_torque.map_or(scenario.control_law, ControlLaw::from_key);
        scenario.tolerance = tolerance;
        change(py, &mut scenario.mismatch, mismatch)?;
        let mut interrupt = None;
        let pool = pool().map_err(|refusal| PyRuntimeError::new_err(refusal.to_string()))?;
        let done = py.detach(|| {
            let job = scenario.job()?;
            scenario.check(&job)?;
            let (mut summary, record) = if scenario.robot.brushed().is_ok() {
                let mut target = Interruptible {
                    controller: scenario.controller()?,
                    ticks: 0,
                    interrupt: &mut interrupt,
                };
                let moves = scenario.run_moves(&job)?;
                scenario.run_on(&mut target, &moves, &mut |_| ())?
            } else {
                // Steppers, hobby servos and drives on a bus have links of their own.
                scenario.simulate(&job, &mut |_| ())?
            };
            if compare_pid {
                // PID may fail where computed torque does not; then there is no comparison.
                let pid = scenario
                    .under_pid()
                    .map(|pid| pid.simulate(&job, &mut |_| ()));
                summary.pid_tip_error = pid.and_then(Result::ok).map(|(pid, _)| pid.tip_error);
            }
            if by_cause {
                summary.by_cause = pool.install(|| scenario.by_cause(&job, &summary))?;
            }
            Ok((job, summary, record))
        });
        if let Some(interrupt) = interrupt {
            return Err(interrupt);
        }
        let (job, summary, record) =
            done.map_err(|refusal| error::run(py, &scenario.job_file, refusal))?;
        let summary = serde_json::to_string(&summary)
            .map_err(|refusal| PyRuntimeError::new_err(refusal.to_string()))?;
        let faults = record.faults.iter();
        Ok((
            summary,
            columns(py, record.trace.samples())?,
            record.trace.stride(),
            faults.map(|&(at, fault)| (at, fault_name(fault))).collect(),
            record.begun,
            job.warnings.iter().map(ToString::to_string).collect(),
        ))
    }
}

type Outcome<'py> = (
    String,
    Bound<'py, PyDict>,
    u64,
    Vec<(f64, String)>,
    Option<f64>,
    Vec<String>,
);

/// A figure of a mismatch: a number, a list, or the harmonics of each encoder.
#[derive(FromPyObject)]
pub(crate) enum Figure {
    Number(f64),
    List(Vec<f64>),
    Harmonics(Vec<Vec<BTreeMap<String, f64>>>),
}

impl Figure {
    fn into_json(self) -> Value {
        match self {
            Self::Number(number) => number.into(),
            Self::List(numbers) => numbers.into(),
            Self::Harmonics(encoders) => {
                let encoders = encoders.into_iter().map(|harmonics| {
                    let harmonics = harmonics.into_iter().map(|harmonic| {
                        let entries = harmonic.into_iter().map(|(key, value)| {
                            let is_count = key == "harmonic" && value.fract() == 0.0;
                            let value = if is_count {
                                Value::from(value as i64)
                            } else {
                                Value::from(value)
                            };
                            (key, value)
                        });
                        Value::Object(entries.collect())
                    });
                    Value::Array(harmonics.collect())
                });
                Value::Array(encoders.collect())
            }
        }
    }
}

/// Replaces the named figures of a mismatch.
pub(crate) fn change(
    py: Python<'_>,
    mismatch: &mut Mismatch,
    figures: BTreeMap<String, Figure>,
) -> PyResult<()> {
    for (name, figure) in figures {
        let mut all = serde_json::to_value(*mismatch)
            .map_err(|refusal| PyRuntimeError::new_err(refusal.to_string()))?;
        let Some(place) = all.get_mut(&name) else {
            let known: Vec<&String> = all
                .as_object()
                .into_iter()
                .flatten()
                .map(|(n, _)| n)
                .collect();
            let reason = format!(
                "no such figure of a mismatch: `{name}`; there are {}",
                known
                    .iter()
                    .map(|name| name.as_str())
                    .collect::<Vec<_>>()
                    .join(", ")
            );
            return Err(error::invalid(py, reason));
        };
        *place = figure.into_json();
        *mismatch = serde_json::from_value(all).map_err(|refusal| {
            error::invalid(py, format!("`{name}` of the mismatch: {refusal}"))
        })?;
    }
    mismatch.check().map_err(|invalid| {
        let name = invalid.name;
        error::invalid(py, format!("`{name}` of the mismatch {invalid}"))
    })
}

/// A quantity of joint 1 and joint 4, or of x and y.
type Pair = fn(&Sample) -> [f64; 2];

/// The samples column by column, pairs flat.
fn columns<'py>(py: Python<'py>, samples: &[Sample]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    fn column<'py, T: Element>(
        columns: &Bound<'py, PyDict>,
        name: &str,
        values: impl Iterator<Item = T>,
    ) -> PyResult<()> {
        let values: Vec<T> = values.collect();
        columns.set_item(name, values.into_pyarray(columns.py()))
    }
    column(&columns, "time", samples.iter().map(|s| s.time))?;
    column(&columns, "line", samples.iter().map(|s| s.line))?;
    column(&columns, "saturated", samples.iter().map(|s| s.saturated))?;
    let level = samples.iter().map(|s| s.tool_level);
    column(&columns, "tool_level", level)?;
    let pairs: [(&str, Pair); 10] = [
        ("reference", |s| s.reference),
        ("tool", |s| s.tool),
        ("angle", |s| s.angle),
        ("reference_angle", |s| s.reference_angle),
        ("reference_velocity", |s| s.reference_velocity),
        ("reference_acceleration", |s| s.reference_acceleration),
        ("torque", |s| s.torque),
        ("current_set_point", |s| s.current_set_point),
        ("current", |s| s.current),
        ("duty", |s| s.duty),
    ];
    for (name, pair) in pairs {
        column(&columns, name, samples.iter().flat_map(pair))?;
    }
    Ok(columns)
}

/// The controller in this process, with a check for Ctrl-C every few ticks.
struct Interruptible<'a> {
    controller: InProcess,
    ticks: u32,
    interrupt: &'a mut Option<PyErr>,
}

/// Ticks between two checks: some milliseconds of work.
const BETWEEN_LOOKS: u32 = 5_000;

impl Target for Interruptible<'_> {
    fn tick(&mut self, sample: &SensorSample) -> Result<(ActuatorCommand, Status), TargetError> {
        self.ticks += 1;
        if self.ticks == BETWEEN_LOOKS {
            self.ticks = 0;
            if let Err(interrupt) = Python::attach(|py| py.check_signals()) {
                *self.interrupt = Some(interrupt);
                return Err(TargetError::Interrupted);
            }
        }
        self.controller.tick(sample)
    }

    fn request(&mut self, request: Request) -> Result<(), TargetError> {
        self.controller.request(request)
    }

    fn offer(&mut self, next: &Move) -> Result<bool, TargetError> {
        self.controller.offer(next)
    }

    fn is_idle(&self) -> bool {
        self.controller.is_idle()
    }
}
