"""The simulated arm, step by step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arm import Arm
from ._errors import FivebarError, RunError
from ._shapes import Floats, SideLike, pair, pairs, sides

#: How many numbers a state has.
NUMBERS = 31
#: Where θ1, θ4 are among them, ω1, ω4, and the time.
THETA, OMEGA, TIME = [2, 11], [14, 23], 30


@dataclass(frozen=True, eq=False)
class PlantState:
    """All that changes while a :class:`fivebar.Plant` moves: put back, it moves on with the same bits.

    States are equal if all their numbers are. They can be copied and pickled.
    """

    #: x, y [m] and angle [rad] of the centres of mass of links 1 to 4, their rates, then angle and speed of the rotor and
    #: deflection of the friction of each drive [rad, rad/s, rad], then the time [s]; shape (31,).
    numbers: Floats

    def __post_init__(self) -> None:
        numbers = np.array(self.numbers, dtype=np.float64)
        if numbers.shape != (NUMBERS,) or not np.all(np.isfinite(numbers)):
            raise FivebarError(f"a state has {NUMBERS} finite numbers, not the shape {numbers.shape}")
        numbers.flags.writeable = False
        object.__setattr__(self, "numbers", numbers)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, PlantState) and bool(np.array_equal(self.numbers, other.numbers))

    def __hash__(self) -> int:
        return hash(self.numbers.tobytes())

    @property
    def theta(self) -> Floats:
        """θ1, θ4 [rad]."""
        return self.numbers[THETA]

    @property
    def omega(self) -> Floats:
        """ω1, ω4 [rad/s]."""
        return self.numbers[OMEGA]

    @property
    def time(self) -> float:
        """Since the beginning [s]."""
        return float(self.numbers[TIME])


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

    arm: with masses. theta, assembly: where it is in the beginning; by default at home. omega: ω1, ω4 then [rad/s].
    mismatch: how it differs from its robot file, as in :meth:`fivebar.Arm.simulate`; by default not at all.
    tolerance: the greatest error of a link's angle in an internal step [rad], 1e-14 to 1e-3. It is estimated by two half
    steps, which are then used; steps shorter than 20 µs are not halved. Without it internal steps are 1 ms at most.
    Raises :class:`fivebar.RobotError`, or :class:`fivebar.PoseError` for angles at which it cannot be.

    :attr:`state` reads and sets its state; :meth:`copy` and ``pickle`` make an arm that moves on with the same bits.
    """

    def __init__(
        self,
        arm: Arm,
        theta: Optional[ArrayLike] = None,
        *,
        omega: ArrayLike = (0.0, 0.0),
        assembly: Optional[SideLike] = None,
        mismatch: Optional[Mapping[str, Any]] = None,
        tolerance: Optional[float] = None,
    ) -> None:
        start = (None if theta is None else pair("theta", theta), pair("omega", omega))
        side = one_side(arm, assembly)
        self._made = (arm, dict(mismatch or {}), checked(tolerance))
        self._plant = _native.Plant(arm._robot, (*start, side), self._made[1], tolerance)

    @property
    def arm(self) -> Arm:
        """The arm of its robot file."""
        return self._made[0]

    def step(self, torque: ArrayLike, dt: float, *, force: ArrayLike = (0.0, 0.0)) -> None:
        """Advances by dt [s], at most 1 s, with constant torques at joint 1 and joint 4 [N·m] and a force on the tool [N].

        It integrates in steps of at most 1 ms, in which no link turns by more than 0.1 rad, and with a tolerance in
        shorter ones. Raises :class:`fivebar.RunError` if the motion is not finite or too fast for steps of 20 µs; the arm is
        then as it was.
        """
        if not 0.0 < dt <= 1.0:
            raise FivebarError(f"dt must be above 0 and at most 1 s, not {dt!r}")
        try:
            self._plant.step(torque, dt, force)
        except TypeError:
            self._plant.step(pair("torque", torque), dt, pair("force", force))

    def copy(self) -> Plant:
        """The same arm in the same state, which then moves by itself."""
        twin = Plant.__new__(Plant)
        twin._made, twin._plant = self._made, self._plant.copy()
        return twin

    __copy__ = copy

    def __deepcopy__(self, _: Any) -> Plant:
        return self.copy()

    def __reduce__(self) -> Tuple[Any, ...]:
        return _again, (*self._made, self.state)

    @property
    def state(self) -> PlantState:
        """Its state. A state of this arm, or of one with the same lengths and masses, can be set."""
        return PlantState(self._plant.numbers)

    @state.setter
    def state(self, state: PlantState) -> None:
        self._plant.set_numbers(np.array(state.numbers))

    @property
    def theta(self) -> Floats:
        """θ1, θ4 [rad]."""
        return self._plant.theta

    @property
    def omega(self) -> Floats:
        """ω1, ω4 [rad/s]."""
        return self._plant.omega

    @property
    def tool(self) -> Floats:
        """The tool's position [m]."""
        return self._plant.tool

    @property
    def time(self) -> float:
        """Since the beginning [s]."""
        return self._plant.time


class Plants:
    """Many arms at once, each by itself, stepped on all cores: :class:`fivebar.Plant` in rows.

    >>> import fivebar
    >>> import numpy as np
    >>> plants = fivebar.Plants(fivebar.Arm.load("benchtop"), 100, theta=[2.2, 0.9])
    >>> plants.step(np.linspace([0.0, 0.0], [0.05, 0.0], 100), 1e-3)
    >>> plants.theta.shape, bool(plants.omega[99, 0] > plants.omega[0, 0])
    ((100, 2), True)

    count: how many. theta, omega: of each, shape (count, 2), or of all, shape (2,). mismatch: of all, or a list with one of
    each, such as :func:`fivebar.sim.drawn` makes. The rest, and the bits, are those of :class:`fivebar.Plant`. The
    interpreter's lock is free during a step.
    """

    def __init__(
        self,
        arm: Arm,
        count: int,
        theta: Optional[ArrayLike] = None,
        *,
        omega: ArrayLike = (0.0, 0.0),
        assembly: Optional[SideLike] = None,
        mismatch: Union[None, Mapping[str, Any], Sequence[Mapping[str, Any]]] = None,
        tolerance: Optional[float] = None,
    ) -> None:
        if isinstance(mismatch, Mapping) or mismatch is None:
            mismatch = [mismatch or {}] * count
        if count < 1 or len(mismatch) != count:
            raise FivebarError(f"{len(mismatch)} mismatches for {count!r} arms: give one for each, and 1 arm or more")
        starts = [None] * count if theta is None else self._rows("theta", theta, count).tolist()
        speeds = self._rows("omega", omega, count).tolist()
        self._side = one_side(arm, assembly)
        all_starts = [
            ((start, speed, self._side), dict(differs))
            for start, speed, differs in zip(starts, speeds, mismatch)
        ]
        self._arm, self._count = arm, count
        self._plants = _native.Plants(arm._robot, all_starts, checked(tolerance))

    def __len__(self) -> int:
        return self._count

    @property
    def arm(self) -> Arm:
        """The arm of their robot file."""
        return self._arm

    def step(self, torque: ArrayLike, dt: float, *, force: ArrayLike = (0.0, 0.0)) -> None:
        """Advances all arms by dt [s], as :meth:`fivebar.Plant.step`. torque, force: of each, or of all.

        Raises :class:`fivebar.RunError` with the first arm that cannot go on; all arms are then as they were.
        """
        if not 0.0 < dt <= 1.0:
            raise FivebarError(f"dt must be above 0 and at most 1 s, not {dt!r}")
        stopped = self._plants.step(
            self._rows("torque", torque, self._count), dt, self._rows("force", force, self._count)
        )
        if stopped is not None:
            raise RunError(
                f"arm {stopped}: within 20 µs a link would turn by more than 0.1 rad, or not by a finite angle: "
                "make its torques [N·m] or the force [N] smaller",
                stopped,
            )

    def place(
        self, rows: ArrayLike, theta: ArrayLike, omega: ArrayLike = (0.0, 0.0)
    ) -> None:
        """Puts the arms with these indices into a motion θ [rad], ω [rad/s], each in the turn nearest to where it was."""
        indices = np.atleast_1d(np.asarray(rows, dtype=np.int64))
        motion = [self._rows(n, v, len(indices)) for n, v in (("theta", theta), ("omega", omega))]
        numbers = np.ascontiguousarray(np.concatenate(motion, axis=1))
        self._plants.set_motions(self._arm._robot, indices.tolist(), numbers, self._side)

    @property
    def numbers(self) -> Floats:
        """The states of all, shape (count, 31), as in :class:`fivebar.PlantState`: a snapshot, to be set again."""
        return self._plants.numbers.reshape(self._count, NUMBERS)

    @numbers.setter
    def numbers(self, numbers: ArrayLike) -> None:
        self.set_numbers(range(self._count), numbers)

    def set_numbers(self, rows: Sequence[int], numbers: ArrayLike) -> None:
        """Puts the arms with these indices into states."""
        states = np.ascontiguousarray(numbers, dtype=np.float64)
        if states.shape != (len(rows), NUMBERS) or not np.all(np.isfinite(states)):
            raise FivebarError(f"give {NUMBERS} finite numbers for each of {len(rows)} arms")
        self._plants.set_numbers(list(rows), states)

    @property
    def theta(self) -> Floats:
        """θ1, θ4 of each [rad], shape (count, 2)."""
        return self._plants.theta.reshape(self._count, 2)

    @property
    def omega(self) -> Floats:
        """ω1, ω4 of each [rad/s], shape (count, 2)."""
        return self._plants.omega.reshape(self._count, 2)

    @property
    def tool(self) -> Floats:
        """The tool's position of each [m], shape (count, 2)."""
        return self._plants.tool.reshape(self._count, 2)

    @property
    def time(self) -> Floats:
        """Since the beginning of each [s], shape (count,)."""
        return self.numbers[:, TIME]

    @staticmethod
    def _rows(name: str, value: ArrayLike, count: int) -> Floats:
        array = pairs(name, value)
        if array.shape not in ((2,), (count, 2)):
            raise FivebarError(f"{name} must have the shape (2,) or ({count}, 2), not {array.shape}")
        if not np.all(np.isfinite(array)):
            raise FivebarError(f"{name} must be finite numbers")
        return np.require(np.broadcast_to(array, (count, 2)), None, ("C", "A"))


def one_side(arm: Arm, assembly: Optional[SideLike]) -> int:
    """The sign of one assembly; by default the arm's own."""
    side = sides("assembly", arm.assembly if assembly is None else assembly)
    if side.ndim != 0:
        raise FivebarError(f"assembly must be one side, not {assembly!r}")
    return int(side)


def checked(tolerance: Optional[float]) -> Optional[float]:
    """A tolerance that a step can keep: 64-bit numbers round angles at 1e-15."""
    if tolerance is not None and not 1e-14 <= tolerance <= 1e-3:
        raise FivebarError(f"tolerance must be 1e-14 to 1e-3 rad, not {tolerance!r}")
    return tolerance


def _again(
    arm: Arm, mismatch: Mapping[str, Any], tolerance: Optional[float], state: PlantState
) -> Plant:
    """A plant from what `pickle` keeps of it."""
    plant = Plant(arm, mismatch=mismatch, tolerance=tolerance)
    plant.state = state
    return plant
