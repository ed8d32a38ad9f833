"""The arm: its kinematics, dynamics and simulation."""

from __future__ import annotations

import json
import os
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Type, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arm_studies import ArmStudies
from ._errors import FivebarError, RobotError
from ._results import (
    Asked,
    Derivatives,
    Forward,
    ForwardDynamics,
    Inverse,
    InverseDynamics,
    InverseMotion,
    Jacobian,
    Motion,
)
from ._shapes import Floats, SideLike, Statuses, broadcast, pairs, refuse, sides
from ._simulation import Mismatch, Run, run
from ._status import Side


class Arm(ArmStudies):
    """A planar five-bar arm, from its lengths, or by :meth:`load`, :meth:`from_file`, :meth:`from_toml`.

    >>> import fivebar
    >>> arm = fivebar.Arm.load("benchtop")
    >>> there = arm.inverse([0.04, 0.2])
    >>> there.theta.round(6).tolist()
    [2.253107, 0.888486]
    >>> arm.forward(there.theta, there.assembly).c.round(6).tolist()
    [0.04, 0.2]

    Methods work on batches. Arguments are pairs along the last axis, (x, y) or
    (joint 1, joint 4), with any shape S before it; the arguments' shapes broadcast as in
    NumPy, so that a single pair goes with a batch. A large batch is computed on all cores,
    without the interpreter's lock; Ctrl-C stops it.

    A row without a solution is NaN, and its ``status`` gives the reason
    (:class:`fivebar.Status`). With ``strict=True`` the first such row is raised instead:
    :class:`fivebar.UnreachableError`, :class:`fivebar.SingularError` or
    :class:`fivebar.InvalidError`, with its ``index``.

    Branches are ``"left"`` or ``"right"``, a :class:`fivebar.Side`, or arrays of names or
    signs (+1 left, −1 right). By default they are the robot's own.

    SI units; angles [rad] absolute, counter-clockwise from +x; points [m] in the frame of
    the base, A at the origin, E on +x. Methods are about C, where links 2 and 3 meet. Of an arm whose
    tool is beside C, :meth:`inverse`, :meth:`inverse_motion` and :meth:`jacobian` ask which point is meant:
    ``point="tool"`` or ``point="c"``. :meth:`simulate` and :meth:`plan` move the tool.
    """

    def __init__(
        self,
        *,
        l1: float,
        l2: float,
        l3: Optional[float] = None,
        l4: Optional[float] = None,
        base: float,
        name: str = "arm",
    ) -> None:
        """An arm of these lengths [m], without masses and motors.

        l1, l4: of the driven links; l2, l3: of the links that meet at C; base: from A to E. A
        length of the second leg that is not given is that of the first. ``base=0`` is a coaxial
        arm. The elbows point outwards.

        >>> Arm(l1=0.1, l2=0.16, base=0.08).inverse([0.04, 0.2]).theta.round(4).tolist()
        [2.2531, 0.8885]
        """
        lengths = (l1, l2, l2 if l3 is None else l3, l1 if l4 is None else l4)
        lines = [f"name = {json.dumps(name)}", "gravity = [0.0, 0.0]", f"base = {float(base)!r}"]
        lines += [f"[[link]]\nlength = {float(length)!r}" for length in lengths]
        self._take(_native.Robot.parse(name, "\n".join(lines)))

    def _take(self, robot: _native.Robot) -> None:
        """Keeps a robot, and what single calls ask of it."""
        self._robot = robot
        self._elbow1, self._elbow4 = robot.elbows
        self._own_assembly = robot.assembly
        self._has_tool_beside_c = any(robot.tool_offset)

    @classmethod
    def _of(cls, robot: _native.Robot) -> Arm:
        arm = cls.__new__(cls)
        arm._take(robot)
        return arm

    def __reduce__(self) -> Tuple[Any, ...]:
        return Arm.from_toml, (self.toml, self._robot.file)

    def __eq__(self, other: object) -> bool:
        """Whether both are made of the same robot file, by its text."""
        return isinstance(other, Arm) and self.toml == other.toml

    def __hash__(self) -> int:
        return hash(self.toml)

    @classmethod
    def load(cls, name_or_path: str = "benchtop") -> Arm:
        """The arm of this name, as for ``fivebar --robot``: a built-in one, or else a file.

        Raises :class:`fivebar.RobotError` with file, line and reason.

        >>> Arm.load("usp_2dof").lengths
        (0.12, 0.16, 0.16, 0.12, 0.1)
        """
        return cls._of(_native.Robot.load(name_or_path))

    @classmethod
    def from_file(cls, path: Union[str, os.PathLike[str]]) -> Arm:
        """The arm of a robot file.

        Raises :class:`fivebar.RobotError` with file, line and reason, or ``OSError``.
        """
        with open(path, encoding="utf-8") as file:
            return cls.from_toml(file.read(), os.fspath(path))

    @classmethod
    def from_toml(cls, text: str, name: str = "robot") -> Arm:
        """The arm that the text of a robot file describes; errors name the file ``name``.

        Raises :class:`fivebar.RobotError` with file, line and reason.

        >>> Arm.from_toml('name = "nothing"')
        Traceback (most recent call last):
        ...
        fivebar.RobotError: robot, line 1: missing field `gravity`
        """
        return cls._of(_native.Robot.parse(name, text))

    @property
    def name(self) -> str:
        """The robot's name."""
        return self._robot.name

    @property
    def toml(self) -> str:
        """The text of its robot file."""
        return self._robot.text

    @property
    def lengths(self) -> Tuple[float, ...]:
        """l1, l2, l3, l4 and the base AE [m]."""
        return tuple(self._robot.lengths)

    @property
    def elbow1(self) -> Side:
        """Which way elbow 1 turns in the robot's working mode."""
        return Side(self._elbow1)

    @property
    def elbow4(self) -> Side:
        """Which way elbow 4 turns in the robot's working mode."""
        return Side(self._elbow4)

    @property
    def assembly(self) -> Side:
        """The robot's assembly mode at home.

        Raises :class:`fivebar.RobotError` if it has no home pose.
        """
        return Side(self._assembly_sign())

    @property
    def home(self) -> Tuple[float, ...]:
        """θ1, θ4 at the home switches [rad]."""
        return tuple(self._robot.home)

    @property
    def joint_limits(self) -> Tuple[Tuple[float, ...], ...]:
        """Least and greatest θ1, then θ4 [rad]. Only a run keeps them.

        They may exceed (−π, π], the range of results: add whole turns to compare.
        """
        return tuple(tuple(limits) for limits in self._robot.joint_limits)

    @property
    def tool_offset(self) -> Tuple[float, ...]:
        """The tool from C, along link 2 and to its left [m]."""
        return tuple(self._robot.tool_offset)

    @property
    def has_masses(self) -> bool:
        """Whether its masses are known: without them there are no torques and no runs."""
        return self._robot.has_masses

    def __repr__(self) -> str:
        lengths = ", ".join(f"{length:g}" for length in self.lengths)
        return f"<fivebar.Arm {self.name!r}, l1…l4 and base {lengths} m>"

    def forward(
        self, theta: ArrayLike, assembly: Optional[SideLike] = None, *, strict: bool = False
    ) -> Forward:
        """The positions of C and of the tool from the driven angles θ1, θ4.

        theta: θ1, θ4 [rad], shape S + (2,). assembly: ``left`` where C lies left of the
        ray B→D.
        """
        return self._ask(
            _native.forward, Forward, {"theta": theta}, self._assembly(assembly), strict
        )

    def inverse(
        self,
        points: ArrayLike,
        elbow1: Optional[SideLike] = None,
        elbow4: Optional[SideLike] = None,
        *,
        point: Optional[str] = None,
        strict: bool = False,
    ) -> Inverse:
        """The angles of all links from the position of C, or of the tool.

        points: C, or the tool [m], shape S + (2,). elbow1, elbow4: which way each elbow turns; with the
        tool, elbow 1 is between A–B and B–tool. point: ``"c"`` or ``"tool"``; it must be given where the
        arm's tool is beside C.

        >>> arm = Arm.load("benchtop")
        >>> answer = arm.inverse([[0.04, 0.2], [0.5, 0.0]])
        >>> answer.ok.tolist()
        [True, False]
        >>> arm.inverse([[0.04, 0.2], [0.5, 0.0]], strict=True)
        Traceback (most recent call last):
        ...
        fivebar.UnreachableError: row 1: the point is farther from A than l1 + l2; points = [0.5, 0.0]
        """
        return self._ask(
            _native.inverse,
            Inverse,
            {"points": points},
            self._elbows(elbow1, elbow4),
            strict,
            self._of_tool(point),
        )

    def mode_change(
        self,
        theta: ArrayLike,
        elbow1: Optional[SideLike] = None,
        elbow4: Optional[SideLike] = None,
    ) -> Floats:
        """The path of the joints to another working mode, with the tool at its place again.

        theta: θ1, θ4 [rad] before it, in the robot's assembly mode. elbow1, elbow4: the elbows'
        new sides. The answer has θ1, θ4 at each corner, straight from one to the next, shape
        (n, 2), empty if the arm is in this mode. The path passes a stretched or folded leg. It
        keeps the joint limits and the margin of links 2 and 3, as the controller does; where
        it cannot, ``UnreachableError`` or ``SingularError`` says why.

        >>> arm = Arm.load("benchtop")
        >>> before = arm.inverse([-0.04, 0.18])
        >>> path = arm.mode_change([before.theta1, before.theta4], "left", "left")
        >>> after = arm.forward(path[-1])
        >>> bool(abs(after.c - [-0.04, 0.18]).max() < 1e-6 and after.elbow1 == Side.LEFT)
        True
        """
        start = pairs("theta", theta).reshape(2)
        elbows = [int(sides(*side)) for side in self._elbows(elbow1, elbow4).items()]
        path = _native.mode_change(self._robot, start.tolist(), *elbows)
        return np.array(path, dtype=float).reshape(-1, 2)

    def motion(
        self,
        theta: ArrayLike,
        omega: ArrayLike,
        alpha: ArrayLike = (0.0, 0.0),
        assembly: Optional[SideLike] = None,
        *,
        strict: bool = False,
    ) -> Motion:
        """Velocities and accelerations of C, of the tool and of links 2 and 3.

        theta [rad], omega [rad/s], alpha [rad/s²]: of joints 1 and 4, each S + (2,).
        """
        given = {"theta": theta, "omega": omega, "alpha": alpha}
        return self._ask(_native.motion, Motion, given, self._assembly(assembly), strict)

    def jacobian(
        self,
        theta: ArrayLike,
        assembly: Optional[SideLike] = None,
        *,
        point: Optional[str] = None,
        strict: bool = False,
    ) -> Floats:
        """The derivative of C, or of the tool, by the driven joints' angles, ∂(x, y)/∂(θ1, θ4) [m/rad], S + (2, 2).

        theta [rad]: of joints 1 and 4, S + (2,). point: as for :meth:`inverse`. NaN where B, C, D are in line.
        The torques that hold a force F on the point are −JᵀF.

        >>> arm = Arm.load("benchtop")
        >>> j = arm.jacobian(arm.home)
        >>> v = arm.motion(arm.home, [0.3, -0.2]).c_velocity
        >>> bool(abs(j @ [0.3, -0.2] - v).max() < 1e-15)
        True
        """
        return self._ask(
            _native.jacobian,
            Jacobian,
            {"theta": theta},
            self._assembly(assembly),
            strict,
            self._of_tool(point),
        ).jacobian

    def inverse_motion(
        self,
        points: ArrayLike,
        velocity: ArrayLike,
        acceleration: ArrayLike = (0.0, 0.0),
        elbow1: Optional[SideLike] = None,
        elbow4: Optional[SideLike] = None,
        *,
        point: Optional[str] = None,
        strict: bool = False,
    ) -> InverseMotion:
        """The motion of the links from the motion of C, or of the tool.

        points [m], velocity [m/s], acceleration [m/s²]: of C, or of the tool, each S + (2,). A leg that is
        straight or folded is singular here (type 1). point: as for :meth:`inverse`.
        """
        return self._ask(
            _native.inverse_motion,
            InverseMotion,
            {"points": points, "velocity": velocity, "acceleration": acceleration},
            self._elbows(elbow1, elbow4),
            strict,
            self._of_tool(point),
        )

    def inverse_dynamics(
        self,
        theta: ArrayLike,
        omega: ArrayLike = (0.0, 0.0),
        alpha: ArrayLike = (0.0, 0.0),
        assembly: Optional[SideLike] = None,
        external_force: ArrayLike = (0.0, 0.0),
        *,
        strict: bool = False,
    ) -> InverseDynamics:
        """The torques of a motion and the forces in the joints, with rotors, without friction.

        theta [rad], omega [rad/s], alpha [rad/s²]: of joints 1 and 4, each S + (2,).
        external_force: on C [N], S + (2,). Singular where B, C, D are in line (type 2).
        Raises :class:`fivebar.RobotError` if the robot's masses are not known.

        At rest these are the torques that hold the arm:

        >>> arm = Arm.load("benchtop")      # it lies flat, so these are zero
        >>> arm.inverse_dynamics(arm.home).torque.tolist()
        [0.0, 0.0]
        """
        return self._ask(
            _native.inverse_dynamics,
            InverseDynamics,
            {"theta": theta, "omega": omega, "alpha": alpha, "external_force": external_force},
            self._assembly(assembly),
            strict,
        )

    def derivatives(
        self,
        theta: ArrayLike,
        omega: ArrayLike = (0.0, 0.0),
        alpha: ArrayLike = (0.0, 0.0),
        assembly: Optional[SideLike] = None,
        *,
        order: int = 2,
        strict: bool = False,
    ) -> Derivatives:
        """First and second derivatives of the motion of C and of the torques, by dual numbers.

        theta [rad], omega [rad/s], alpha [rad/s²]: of joints 1 and 4, each S + (2,). The variables are these, the
        lengths and the masses. order: 1 for the first derivatives alone, at less than a tenth of the time; ``second`` is then None. Needs
        an arm with masses. Statuses and errors are as for :meth:`inverse_dynamics`.

        >>> arm = Arm.load("benchtop")
        >>> d = arm.derivatives(arm.home)
        >>> d.first.shape, d.second.shape
        ((8, 15), (8, 15, 15))
        >>> bool(abs(d.first[:2, :2] - arm.jacobian(arm.home)).max() < 1e-15)
        True
        """
        if order not in (1, 2):
            raise FivebarError(f"order must be 1 or 2, not {order!r}")
        given = {"theta": theta, "omega": omega, "alpha": alpha}
        return self._ask(
            _native.derivatives, Derivatives, given, self._assembly(assembly), strict, order == 2
        )

    def forward_dynamics(
        self,
        theta: ArrayLike,
        omega: ArrayLike,
        torque: ArrayLike,
        assembly: Optional[SideLike] = None,
        external_force: ArrayLike = (0.0, 0.0),
        *,
        strict: bool = False,
    ) -> ForwardDynamics:
        """The accelerations of the driven joints under torques, without friction.

        theta [rad], omega [rad/s], torque [N·m]: of joints 1 and 4, each S + (2,).
        external_force: on C [N], S + (2,). Statuses and errors are as for
        :meth:`inverse_dynamics`.
        """
        return self._ask(
            _native.forward_dynamics,
            ForwardDynamics,
            {"theta": theta, "omega": omega, "torque": torque, "external_force": external_force},
            self._assembly(assembly),
            strict,
        )

    def simulate(
        self,
        job: Union[str, os.PathLike[str]],
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
        """Runs a job with the simulated arm under the production control loop.

        job: G-code as text, or the path of a file of G-code or of a scenario in TOML, whose
        robot this arm replaces. Paths are ``pathlib.Path``; a ``str`` is G-code. The other
        arguments default to the scenario's values, or else to these:

        origin: the job's (0, 0) in the frame of the base [m]; by default the middle of the
        drawing goes where the arm moves best. scale: metres in the plane per metre in the
        job; default 1. seed: of every random number; default 1. computed_torque: control by
        the arm's model (True, the default) or by PID at each
        joint with feed-forward of acceleration and friction. mismatch: how the arm differs from
        the controller's model: ``link_mass`` and ``friction`` as extra shares, ``payload``
        [kg], ``current_noise`` and ``current_offset`` [ADC codes], and the other keys of a
        scenario's ``[mismatch]`` with their lists (docs/use/robot-file.md); ``fivebar.NO_MISMATCH``
        for no difference. tolerance: the tip's greatest error of a job that is drawn [m], for ``drawn`` and ``why`` of
        the summary; by default 1 mm, with hobby servos what they allow. compare_pid: run it with PID at each joint, too, for
        ``summary["pid_tip_error"]``, as the program does. by_cause: with each mismatch alone, too, for
        ``summary["by_cause"]``.

        A fault of the arm ends the run and is part of its result, as is a drawing that is wrong:
        ``summary["drawn"]`` is then False, and ``summary["why"]`` says why. Raises
        :class:`fivebar.JobError` with the line if the arm cannot do the job,
        :class:`fivebar.RobotError` if the robot cannot be simulated,
        :class:`fivebar.RunError`, or ``OSError``. Ctrl-C stops it.

        >>> run = Arm.load("benchtop").simulate("G1 X10 F1200", origin=(0.03, 0.2))
        >>> run.faults
        []
        >>> run.summary["tip_error"]["max_m"] < 1e-4
        True
        """
        return run(
            self._robot,
            job,
            origin,
            scale,
            seed,
            computed_torque,
            mismatch,
            tolerance,
            compare_pid,
            by_cause,
        )

    def _ask(
        self,
        question: Callable[..., Tuple[List[Floats], Statuses]],
        kind: Type[Asked],
        given: Mapping[str, ArrayLike],
        branches: Dict[str, SideLike],
        strict: bool,
        *options: bool,
    ) -> Asked:
        try:
            # A single pair of each needs no arrays. Many arrays are given one shape first.
            if getattr(next(iter(given.values())), "ndim", 1) != 1:
                raise TypeError
            fields, status = question(self._robot, *given.values(), *branches.values(), *options)
        except TypeError:
            numbers = {name: pairs(name, value) for name, value in given.items()}
            chosen = {name: sides(name, value) for name, value in branches.items()}
            shape, many, each = broadcast(numbers, chosen)
            fields, status = question(self._robot, *many, *each, *options)
            status = status.reshape(shape)
            fields = [f.reshape(shape + tail) for f, tail in zip(fields, kind.tails())]
        if strict and status.any():
            numbers = {name: pairs(name, value) for name, value in given.items()}
            places = [np.broadcast_to(array, (*status.shape, 2)) for array in numbers.values()]
            refuse(status, dict(zip(numbers, places)))
        return kind.of(status, fields)

    def _of_tool(self, point: Optional[str]) -> bool:
        """Whether a point that is given is the tool's, and not that of C."""
        if point is None:
            if self._has_tool_beside_c:
                along, left = self.tool_offset
                raise FivebarError(
                    f"the tool of {self.name!r} is beside C, {along:g} m along link 2 and {left:g} m to its left: "
                    "say which point is meant, point='tool' or point='c'"
                )
            return False
        if point not in ("c", "tool"):
            raise FivebarError(f"point must be 'c' or 'tool', not {point!r}")
        return point == "tool"

    def _assembly(self, assembly: Optional[SideLike]) -> Dict[str, SideLike]:
        return {"assembly": self._assembly_sign() if assembly is None else assembly}

    def _assembly_sign(self) -> int:
        if self._own_assembly is None:
            raise RobotError(
                f"robot `{self.name}` has no home pose in its working mode: "
                "say assembly='left' or 'right'"
            )
        return self._own_assembly

    def _elbows(
        self, elbow1: Optional[SideLike], elbow4: Optional[SideLike]
    ) -> Dict[str, SideLike]:
        return {
            "elbow1": self._elbow1 if elbow1 is None else elbow1,
            "elbow4": self._elbow4 if elbow4 is None else elbow4,
        }
