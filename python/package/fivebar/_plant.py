"""The simulated arm, step by step."""

from __future__ import annotations

from typing import Any, Mapping, Optional

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arm import Arm
from ._errors import FivebarError
from ._shapes import Floats, SideLike, pair, sides


class Plant:
    """An arm that makes the torques at its joints that it is told: for one's own controller.

    >>> import fivebar
    >>> plant = fivebar.Plant(fivebar.Arm.load("benchtop"))
    >>> for _ in range(100):
    ...     plant.step([-0.05, 0.0], 1e-3)
    >>> round(plant.time, 6), bool(plant.omega[0] < -0.5)
    (0.1, True)

    Links, rotors, friction, belts and gravity are those of :meth:`fivebar.Arm.simulate`; motors have
    no electric part, no limit and no brake. SI units and the frame of the base, as in :class:`fivebar.Arm`.

    arm: with masses. theta, assembly: where it is at rest in the beginning; by default at home.
    mismatch: how it differs from its robot file, as in :meth:`fivebar.Arm.simulate`; by default not at all.
    Raises :class:`fivebar.RobotError`, or :class:`fivebar.PoseError` for angles at which it cannot be.
    """

    def __init__(
        self,
        arm: Arm,
        theta: Optional[ArrayLike] = None,
        *,
        assembly: Optional[SideLike] = None,
        mismatch: Optional[Mapping[str, Any]] = None,
    ) -> None:
        side = sides("assembly", arm.assembly if assembly is None else assembly)
        if side.ndim != 0:
            raise FivebarError(f"assembly must be one side, not {assembly!r}")
        start = None if theta is None else pair("theta", theta)
        self._plant = _native.Plant(arm._robot, start, int(side), dict(mismatch or {}))

    def step(self, torque: ArrayLike, dt: float, *, force: ArrayLike = (0.0, 0.0)) -> None:
        """Advances by dt [s], at most 1 s, with constant torques at joint 1 and joint 4 [N·m] and a force on the tool [N].

        It integrates in steps of at most 1 ms, in which no link turns by more than 0.1 rad. Raises
        :class:`fivebar.RunError` if the motion is not finite or too fast for steps of 20 µs; the arm is then as it was.
        """
        if not 0.0 < dt <= 1.0:
            raise FivebarError(f"dt must be above 0 and at most 1 s, not {dt!r}")
        self._plant.step(pair("torque", torque), dt, pair("force", force))

    @property
    def theta(self) -> Floats:
        """θ1, θ4 [rad]."""
        return np.array(self._plant.theta)

    @property
    def omega(self) -> Floats:
        """ω1, ω4 [rad/s]."""
        return np.array(self._plant.omega)

    @property
    def tool(self) -> Floats:
        """The tool's position [m]."""
        return np.array(self._plant.tool)

    @property
    def time(self) -> float:
        """Since the beginning [s]."""
        return self._plant.time
