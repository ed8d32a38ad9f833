//! The simulated arm step by step, with torques at its joints; one arm, or many at once on all cores.

use crate::batch::{Pairs, rows};
use crate::error;
use crate::pool::on_all_cores;
use crate::robot::Robot;
use crate::simulation::{Figure, change};
use fivebar_kinematics::five_bar::{Joint, Pose, Side};
use fivebar_plant::{Mismatch, TorquePlant, TorqueState};
use numpy::{PyArray1, PyReadonlyArrayDyn};
use pyo3::exceptions::{PyIndexError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Plants that a thread steps at a time: some tens of microseconds of work.
const WORTH_A_THREAD: usize = 32;

/// How an arm differs from its robot file.
type Figures = BTreeMap<String, Figure>;

/// Where an arm begins: θ1, θ4 [rad], or else at home; ω1, ω4 [rad/s]; and the sign of its assembly.
type Start = (Option<[f64; 2]>, [f64; 2], i8);

/// An arm that makes the torques that it is told.
#[pyclass(module = "fivebar._native")]
pub(crate) struct Plant {
    arm: TorquePlant,
}

#[pymethods]
impl Plant {
    /// `tolerance` is the greatest error of an angle in an internal step [rad].
    #[new]
    fn new(
        py: Python<'_>,
        robot: &Robot,
        start: Start,
        mismatch: Figures,
        tolerance: Option<f64>,
    ) -> PyResult<Self> {
        let arm = plant(py, robot, start, mismatch, tolerance)?;
        Ok(Self { arm })
    }

    /// The same arm in the same state.
    fn copy(&self) -> Self {
        let arm = self.arm.clone();
        Self { arm }
    }

    /// Advances by `time` [s] with these torques at the joints [N·m] and this force on the tool [N].
    /// After an error its state is that of before.
    fn step(
        &mut self,
        py: Python<'_>,
        torque: Pairs<'_>,
        time: f64,
        force: Pairs<'_>,
    ) -> PyResult<()> {
        let [torque, force] = [one(&torque)?, one(&force)?];
        self.arm.set_tool_force(force.into());
        let done = self.arm.step(torque, time);
        done.map_err(|refusal| error::stopped(py, refusal))
    }

    /// θ1, θ4 [rad].
    #[getter]
    fn theta<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &angles(&self.arm))
    }

    /// ω1, ω4 [rad/s].
    #[getter]
    fn omega<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &velocities(&self.arm))
    }

    /// The tool's position [m].
    #[getter]
    fn tool<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.arm.tool().as_slice())
    }

    /// Since the start [s].
    #[getter]
    fn time(&self) -> f64 {
        self.arm.time()
    }

    /// The numbers of its state.
    #[getter]
    fn numbers<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.arm.state().to_numbers())
    }

    /// Puts it into a state.
    fn set_numbers(&mut self, numbers: PyReadonlyArrayDyn<'_, f64>) -> PyResult<()> {
        match rows(&numbers)? {
            [state] => self.arm.set_state(&TorqueState::from_numbers(state)),
            _ => return Err(PyValueError::new_err("the numbers of one state are wanted")),
        }
        Ok(())
    }
}

/// Arms that make the torques that they are told, each by itself.
#[pyclass(module = "fivebar._native")]
pub(crate) struct Plants {
    arms: Vec<TorquePlant>,
}

#[pymethods]
impl Plants {
    #[new]
    fn new(
        py: Python<'_>,
        robot: &Robot,
        starts: Vec<(Start, Figures)>,
        tolerance: Option<f64>,
    ) -> PyResult<Self> {
        let arms = starts.into_iter().map(|(start, mismatch)| {
            let arm = plant(py, robot, start, mismatch, tolerance)?;
            Ok(arm)
        });
        Ok(Self {
            arms: arms.collect::<PyResult<_>>()?,
        })
    }

    /// Advances all arms by `time` [s], on all cores, with rows of torques at the joints [N·m] and of forces on the tools [N].
    /// Returns the first arm that cannot go on; all arms are then as before.
    fn step(
        &mut self,
        py: Python<'_>,
        torque: PyReadonlyArrayDyn<'_, f64>,
        time: f64,
        force: PyReadonlyArrayDyn<'_, f64>,
    ) -> PyResult<Option<usize>> {
        let (torques, forces) = (rows::<f64, 2>(&torque)?, rows::<f64, 2>(&force)?);
        if [torques.len(), forces.len()] != [self.arms.len(); 2] {
            return Err(PyValueError::new_err("a row for each arm is wanted"));
        }
        let before: Vec<TorqueState> = self.arms.iter().map(TorquePlant::state).collect();
        let arms = &mut self.arms;
        let stopped: Option<usize> = on_all_cores(py, || {
            let arms = arms.par_chunks_mut(WORTH_A_THREAD);
            let loads = torques
                .par_chunks(WORTH_A_THREAD)
                .zip(forces.par_chunks(WORTH_A_THREAD));
            let stepped = arms
                .zip(loads)
                .enumerate()
                .map(|(chunk, (arms, (torques, forces)))| {
                    let stopped = TorquePlant::step_many(arms, torques, forces, time)?;
                    Some(chunk * WORTH_A_THREAD + stopped)
                });
            stepped.flatten().min()
        })?;
        if stopped.is_some() {
            for (arm, before) in self.arms.iter_mut().zip(&before) {
                arm.set_state(before);
            }
        }
        Ok(stopped)
    }

    /// θ1, θ4 of each [rad], flat.
    #[getter]
    fn theta<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, angles)
    }

    /// ω1, ω4 of each [rad/s], flat.
    #[getter]
    fn omega<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, velocities)
    }

    /// The tool's position of each [m], flat.
    #[getter]
    fn tool<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |arm| arm.tool().into())
    }

    /// The numbers of the state of each, flat.
    #[getter]
    fn numbers<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |arm| arm.state().to_numbers())
    }

    /// Puts the arms with these indices into motions: rows of θ1, θ4 [rad], ω1, ω4 [rad/s].
    fn set_motions(
        &mut self,
        py: Python<'_>,
        robot: &Robot,
        indices: Vec<usize>,
        motions: PyReadonlyArrayDyn<'_, f64>,
        assembly: i8,
    ) -> PyResult<()> {
        for (index, &[theta1, theta4, omega1, omega4]) in indices.into_iter().zip(rows(&motions)?) {
            let pose = pose(py, robot, Some([theta1, theta4]), assembly)?;
            let arm = self.arms.get_mut(index);
            let arm = arm.ok_or_else(|| PyIndexError::new_err("no such arm"))?;
            set_motion(py, robot, arm, &pose, [omega1, omega4])?;
        }
        Ok(())
    }

    /// Puts the arms with these indices into states, a row for each.
    fn set_numbers(
        &mut self,
        indices: Vec<usize>,
        numbers: PyReadonlyArrayDyn<'_, f64>,
    ) -> PyResult<()> {
        let states = rows(&numbers)?;
        let is_there = indices.iter().all(|&index| index < self.arms.len());
        if states.len() != indices.len() || !is_there {
            return Err(PyValueError::new_err("a state for each arm is wanted"));
        }
        for (index, state) in indices.into_iter().zip(states) {
            self.arms[index].set_state(&TorqueState::from_numbers(state));
        }
        Ok(())
    }
}

impl Plants {
    /// Some numbers of each arm, flat.
    fn each<'py, const N: usize>(
        &self,
        py: Python<'py>,
        of: impl Fn(&TorquePlant) -> [f64; N],
    ) -> Bound<'py, PyArray1<f64>> {
        let numbers: Vec<f64> = self.arms.iter().flat_map(of).collect();
        PyArray1::from_vec(py, numbers)
    }
}

/// An arm that makes the torques that it is told, at its start.
fn plant(
    py: Python<'_>,
    robot: &Robot,
    (theta, omega, assembly): Start,
    mismatch: Figures,
    tolerance: Option<f64>,
) -> PyResult<TorquePlant> {
    let described = &robot.described;
    let parameters = described.plant_parameters();
    let parameters = parameters.map_err(|refusal| error::robot(py, refusal))?;
    let pose = pose(py, robot, theta, assembly)?;
    let mut differs = Mismatch::NONE;
    change(py, &mut differs, mismatch)?;
    let mut arm = TorquePlant::new(&parameters, &differs, &pose);
    if omega != [0.0; 2] {
        set_motion(py, robot, &mut arm, &pose, omega)?;
    }
    Ok(match tolerance {
        None => arm,
        Some(tolerance) => arm.with_tolerance(tolerance),
    })
}

/// Puts an arm into a pose with these velocities of its driven links [rad/s].
fn set_motion(
    py: Python<'_>,
    robot: &Robot,
    arm: &mut TorquePlant,
    pose: &Pose<f64>,
    [omega1, omega4]: [f64; 2],
) -> PyResult<()> {
    let velocities = robot.geometry().forward_velocities(pose, omega1, omega4);
    let velocities = velocities.map_err(|refusal| error::pose(py, refusal))?;
    arm.set_motion(pose, velocities.omega);
    Ok(())
}

/// The pose with these angles in this assembly, or else that of home.
fn pose(
    py: Python<'_>,
    robot: &Robot,
    theta: Option<[f64; 2]>,
    assembly: i8,
) -> PyResult<Pose<f64>> {
    let Some([theta1, theta4]) = theta else {
        let pose = robot.described.home_pose();
        return pose.map_err(|refusal| error::robot(py, refusal));
    };
    let side = match assembly {
        1 => Side::Left,
        _ => Side::Right,
    };
    let pose = robot.geometry().forward(theta1, theta4, side);
    pose.map_err(|refusal| error::pose(py, refusal))
}

/// One pair of finite numbers.
fn one(pair: &Pairs<'_>) -> PyResult<[f64; 2]> {
    match pair {
        Pairs::One([pair]) if pair.iter().all(|number| number.is_finite()) => Ok(*pair),
        // The Python half then says which argument is wrong.
        _ => Err(PyTypeError::new_err("two finite numbers are wanted")),
    }
}

fn angles(arm: &TorquePlant) -> [f64; 2] {
    Joint::ALL.map(|joint| arm.angle(joint))
}

fn velocities(arm: &TorquePlant) -> [f64; 2] {
    Joint::ALL.map(|joint| arm.velocity(joint))
}
