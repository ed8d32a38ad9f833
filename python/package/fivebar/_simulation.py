"""Runs of the simulated arm and their results."""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._errors import FivebarError
from ._shapes import Floats
from ._tables import JOINTS, NUMBER, POINT, Table

#: How an arm differs from the controller's model: a number, a list of numbers, or for
#: ``encoder_error`` a list of harmonics for each encoder, by the keys of a scenario's
#: ``[mismatch]``.
Mismatch = Mapping[str, Any]

#: The mismatch of an arm that is exactly as the controller's model.
NO_MISMATCH: Dict[str, Any] = {
    "link_mass": 0.0,
    "friction": 0.0,
    "payload": 0.0,
    "current_noise": 0.0,
    "current_offset": 0.0,
    "link_length": [0.0] * 4,
    "base_length": 0.0,
    "home_error": [0.0] * 2,
    "torque_constant": [0.0] * 2,
    "torque_ripple": [0.0] * 2,
    "cogging": [0.0] * 2,
    "drive_damping": [0.0] * 2,
    "backlash": [0.0] * 2,
    "pulley_run_out": [0.0] * 2,
    "tooth_mesh": [0.0] * 2,
    "stiction": [0.0] * 2,
    "encoder_error": [[], []],
    "encoder_latency": [0.0] * 2,
    "supply_resistance": 0.0,
    "pen_friction": 0.0,
    "paper_growth": [0.0] * 2,
}


@dataclass(frozen=True, eq=False)
class Trace(Table):
    """A job sample by sample, evenly spaced; N samples, at most 50,000.

    Pairs, of shape (N, 2), are (x, y) in the frame of the base, or joint 1 and joint 4.
    """

    ALONG = "time"
    FIELDS = {
        "time": NUMBER,
        "line": NUMBER,
        "reference": POINT,
        "tool": POINT,
        "angle": JOINTS,
        "reference_angle": JOINTS,
        "reference_velocity": JOINTS,
        "reference_acceleration": JOINTS,
        "torque": JOINTS,
        "current_set_point": JOINTS,
        "current": JOINTS,
        "duty": JOINTS,
        "saturated": NUMBER,
        "tool_level": NUMBER,
    }

    #: Since the beginning of the job, after homing [s], shape (N,).
    time: Floats
    #: The line of the job in progress, shape (N,).
    line: NDArray[np.uint32]
    #: The tool's reference [m].
    reference: Floats
    #: The tool's true position [m].
    tool: Floats
    #: The joints' true angles [rad].
    angle: Floats
    #: The joints' angles of the reference [rad].
    reference_angle: Floats
    #: The joints' velocities of the reference [rad/s].
    reference_velocity: Floats
    #: The joints' accelerations of the reference [rad/s²].
    reference_acceleration: Floats
    #: Torques of the motors, at the joints [N·m].
    torque: Floats
    #: Set-points of the motors' currents [A].
    current_set_point: Floats
    #: Currents in the motors [A].
    current: Floats
    #: Duties of the bridges, −1…1.
    duty: Floats
    #: Whether the torques were limited, shape (N,).
    saturated: NDArray[np.bool_]
    #: The tool's level as the controller sets it, 0 (up or off) to 1, shape (N,).
    tool_level: Floats

    @property
    def tip_error(self) -> Floats:
        """Distance of the tool from its reference [m], shape (N,)."""
        difference = self.tool - self.reference
        return np.hypot(difference[:, 0], difference[:, 1])


@dataclass(frozen=True, eq=False)
class Run:
    """The results of a run."""

    #: The figures of ``fivebar sim --json``: robot, scenario, drawn, why, worst_m, tolerance_m, simulated_s, wall_s,
    #: ticks, tip_error {rms_m, max_m}, peak_torque_nm [2], saturated_ticks, faults.
    summary: Dict[str, Any]
    #: The job sample by sample.
    trace: Trace
    #: Ticks from one sample of the trace to the next: more than 1 in a long run.
    stride: int
    #: The faults raised, each with its time from power-up [s]; the first ended the run.
    faults: List[Tuple[float, str]]
    #: Time from power-up to the beginning of the job [s]; None if homing failed.
    begun: Optional[float]
    #: The parts of the job that were skipped, with their lines.
    warnings: List[str]


def simulate(
    file: Union[str, os.PathLike[str]],
    *,
    origin: Optional[Sequence[float]] = None,
    scale: Optional[float] = None,
    seed: Optional[int] = None,
    computed_torque: Optional[bool] = None,
    mismatch: Optional[Mismatch] = None,
    tolerance: Optional[float] = None,
    compare_pid: bool = False,
    by_cause: bool = False,
) -> Run:
    """Runs a scenario file with the robot that it names, as ``fivebar sim FILE`` does.

    The other arguments and the errors are those of :meth:`fivebar.Arm.simulate`.
    """
    scenario = _native.Scenario.of_file(os.fspath(file), None)
    return _run(
        scenario, origin, scale, seed, computed_torque, mismatch, tolerance, compare_pid, by_cause
    )


def run(
    robot: _native.Robot,
    job: Union[str, os.PathLike[str]],
    origin: Optional[Sequence[float]],
    scale: Optional[float],
    seed: Optional[int],
    computed_torque: Optional[bool],
    mismatch: Optional[Mismatch],
    tolerance: Optional[float],
    compare_pid: bool,
    by_cause: bool,
) -> Run:
    """Runs a job or a scenario with a robot; see :meth:`fivebar.Arm.simulate`."""
    scenario = scenario_of(robot, job)
    return _run(
        scenario, origin, scale, seed, computed_torque, mismatch, tolerance, compare_pid, by_cause
    )


def scenario_of(robot: _native.Robot, job: Union[str, os.PathLike[str]]) -> _native.Scenario:
    """A job or a scenario with a robot; see :meth:`fivebar.Arm.simulate`."""
    if not isinstance(job, str):
        return _native.Scenario.of_file(os.fspath(job), robot)
    if job.endswith((".gcode", ".nc", ".toml")) and "\n" not in job:
        raise FivebarError(f"a str is taken for G-code; for a file give pathlib.Path({job!r})")
    return _native.Scenario.of_text(robot, job)


def _run(
    scenario: _native.Scenario,
    origin: Optional[Sequence[float]],
    scale: Optional[float],
    seed: Optional[int],
    computed_torque: Optional[bool],
    mismatch: Optional[Mismatch],
    tolerance: Optional[float],
    compare_pid: bool,
    by_cause: bool,
) -> Run:
    if origin is not None and not (len(origin) == 2 and all(map(math.isfinite, origin))):
        raise FivebarError(f"origin must be two finite numbers [m], not {origin!r}")
    if scale is not None and not (scale > 0 and math.isfinite(scale)):
        raise FivebarError(f"scale must be a positive finite number, not {scale!r}")
    if tolerance is not None and not (tolerance > 0 and math.isfinite(tolerance)):
        raise FivebarError(f"tolerance must be a positive finite length [m], not {tolerance!r}")
    summary, columns, stride, faults, begun, warnings = scenario.run(
        origin=None if origin is None else [float(x) for x in origin],
        scale=scale,
        seed=seed,
        computed_torque=computed_torque,
        mismatch=dict(mismatch or {}),
        tolerance=tolerance,
        compare_pid=compare_pid,
        by_cause=by_cause,
    )
    alone = ("time", "line", "saturated", "tool_level")
    trace = {n: c if n in alone else c.reshape(-1, 2) for n, c in columns.items()}
    figures = json.loads(summary)
    del figures["out_dir"]  # nothing is written
    return Run(figures, Trace(**trace), stride, faults, begun, warnings)
