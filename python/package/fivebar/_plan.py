"""Time-optimal plans along a path."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Dict, Iterator, List, Mapping, Optional, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._errors import FivebarError, StudyError
from ._shapes import Floats
from ._status import Side
from ._studies import UNNAMED, Source, text_of
from ._tables import JOINTS, NUMBER, POINT, Table

#: A path with its limits as a file describes it, or points.
Path = Union[Source, Mapping[str, Any], ArrayLike]


@dataclass(frozen=True, eq=False)
class PlanSamples(Table):
    """The motion of a plan at some times; N of them."""

    ALONG = "time"
    FIELDS = {
        "time": NUMBER,
        "theta": JOINTS,
        "omega": JOINTS,
        "alpha": JOINTS,
        "tool": POINT,
        "tool_velocity": POINT,
        "tool_acceleration": POINT,
        "torque": JOINTS,
    }

    #: From the beginning of the plan [s], shape (N,).
    time: Floats
    #: θ1, θ4 [rad], in (−π, π], shape (N, 2) as all others.
    theta: Floats
    #: ω1, ω4 [rad/s].
    omega: Floats
    #: α1, α4 [rad/s²].
    alpha: Floats
    #: The tool [m].
    tool: Floats
    #: Its velocity [m/s].
    tool_velocity: Floats
    #: Its acceleration [m/s²].
    tool_acceleration: Floats
    #: τ1, τ4 [N·m], with friction; NaN for an arm without masses.
    torque: Floats


class Plan(Mapping[str, Any]):
    """A plan of :meth:`fivebar.Arm.plan`. It is also a mapping of the figures of ``fivebar plan --path --json``."""

    def __init__(
        self, robot: _native.Robot, file: str, text: str, torque_share: float, jerk: Optional[float]
    ) -> None:
        self._made = (robot.file, robot.text, file, text, torque_share, jerk)
        self._plan = _native.Plan(robot, file, text, torque_share, jerk)
        self._figures: Dict[str, Any] = json.loads(self._plan.answer())

    def __reduce__(self) -> Tuple[Any, ...]:
        return _again, self._made

    def __getitem__(self, name: str) -> Any:
        return self._figures[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._figures)

    def __len__(self) -> int:
        return len(self._figures)

    def __repr__(self) -> str:
        return f"<fivebar.Plan of {self.time:g} s>"

    @property
    def time(self) -> float:
        """Its duration [s]."""
        return float(self._figures["time_s"])

    def to_dict(self) -> Dict[str, Any]:
        """Its figures."""
        return dict(self._figures)

    def sample(self, t: ArrayLike) -> PlanSamples:
        """The motion at times t from its beginning [s], as arrays; before and after it the arm rests at the ends.

        >>> import numpy as np
        >>> arm = Arm.load("benchtop")
        >>> plan = arm.plan([[0.0, 0.18], [0.08, 0.18]], limits={"acceleration": [50.0, 50.0]})
        >>> samples = plan.sample(np.linspace(0.0, plan.time, 5))
        >>> samples.tool[[0, -1]].round(6).tolist(), samples.theta.shape
        ([[0.0, 0.18], [0.08, 0.18]], (5, 2))
        """
        times = np.atleast_1d(np.asarray(t, dtype=np.float64))
        if times.ndim != 1 or not np.all(np.isfinite(times)):
            raise FivebarError(f"t must be finite times [s], shape (N,), not the shape {np.shape(t)}")
        rows = self._plan.sample(np.ascontiguousarray(times)).reshape(-1, 7, 2)
        return PlanSamples(times, *(rows[:, column].copy() for column in range(7)))


def plan(
    robot: _native.Robot,
    path: Path,
    limits: Optional[Mapping[str, Any]],
    corners: Optional[str],
    spline: bool,
    torque_share: float,
    jerk: Optional[float],
) -> Plan:
    """See :meth:`fivebar.Arm.plan`."""
    if isinstance(path, (str, Mapping)) or hasattr(path, "__fspath__"):
        if limits is not None or corners is not None or spline:
            raise FivebarError("limits, corners and spline are for points: a path file has its own")
        is_file = not isinstance(path, Mapping)
        name, text = text_of(path) if is_file else (UNNAMED, json.dumps(path))  # type: ignore[arg-type]
        return Plan(robot, name, text, torque_share, jerk)
    points = np.asarray(path, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2 or not np.all(np.isfinite(points)):
        raise FivebarError(f"points must be finite, shape (N, 2) with N of 2 or more, not {points.shape}")
    if limits is None:
        raise StudyError(
            'points need limits, such as {"torque": [0.5, 0.5]} [N·m] or {"speed": [10, 10], "acceleration": [100, 100]} '
            "[rad/s, rad/s²]"
        )
    at: List[List[float]] = points.tolist()
    lines = [{"kind": "line", "from": a, "to": b} for a, b in zip(at, at[1:]) if a != b]
    described = {
        "path": [{"kind": "waypoints", "points": at}] if spline else lines,
        "working_mode": [Side(sign).name.lower() for sign in robot.elbows],
        "limits": {name: np.asarray(limit).tolist() for name, limit in limits.items()},
        "corners": corners or "smooth",
    }
    return Plan(robot, UNNAMED, json.dumps(described), torque_share, jerk)


def _again(file: str, text: str, *made: Any) -> Plan:
    """A plan from what `pickle` keeps of it."""
    return Plan(_native.Robot.parse(file, text), *made)
