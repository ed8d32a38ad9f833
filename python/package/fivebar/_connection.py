"""An arm that is commanded call by call, simulated or real."""

from __future__ import annotations

import json
import os
import weakref
from dataclasses import dataclass
from types import TracebackType
from typing import Callable, List, Optional, Sequence, Tuple, Type, Union

from . import _native
from ._arm import Arm
from ._errors import FivebarError
from ._shapes import pair
from ._simulation import scenario_of
from ._stream import Stream
from ._teaching import TaughtPath
from ._touch import Fixture, Impedance, begin

Pair = Tuple[float, float]

#: What :meth:`LiveArm.draw` tells while it draws: the moves that the controller has taken, all moves, and the line of the
#: job in progress.
Watcher = Callable[[int, int, Optional[int]], None]


@dataclass(frozen=True)
class ArmState:
    """What a controller tells of its arm. Pairs are (joint 1, joint 4) or (x, y)."""

    #: ``"Stopped"`` (motors off), ``"Homing"``, ``"Armed"`` (motors on, at rest), ``"Running"``, ``"Stopping"``,
    #: ``"Crossing"``, ``"Exciting"``, ``"Compliant"`` (a hand leads it, or it is a spring) or ``"Fault"``.
    state: str
    #: The latched fault; None if there is none.
    fault: Optional[str]
    #: Its number.
    fault_number: Optional[int]
    #: Whether the joint angles are known.
    homed: bool
    #: The tool's position [m]; None until the arm is homed.
    tool: Optional[Pair]
    #: θ1, θ4 [rad]; None until the arm is homed.
    theta: Optional[Pair]
    #: ω1, ω4 [rad/s].
    omega: Pair
    #: The line of the job in progress; 0 on the way to it.
    line: Optional[int]
    #: The tool's level, 0 (up or off) to 1.
    tool_level: float
    #: Time since the controller's start [s].
    time: float
    #: Ticks that the controller has missed since then.
    missed_ticks: int
    #: The demanded torques at the joints [N·m].
    torque: Optional[Pair]
    #: The motors' measured currents [A]; None of motors that do not measure them.
    current: Optional[Pair]
    #: The voltage of the supply [V]; None of motors whose board does not measure it.
    bus_voltage: Optional[float]
    #: How many moves of the present or last call the controller has taken, and how many it has.
    moves_taken: int
    moves: int
    #: What a job waits for, at a pause.
    pause: Optional[str]


class LiveArm:
    """A controller that this program commands; :func:`fivebar.connect` makes it.

    Each call returns when it is done. One call is done at a time; another thread may call :meth:`stop`,
    :meth:`emergency_stop` and :attr:`state` meanwhile, which wait for no other call. Ctrl-C stops the arm on its path,
    then raises ``KeyboardInterrupt``. The ``with`` block, :meth:`close` and the end of the program bring the arm to rest and
    switch its motors off.

    Calls raise :class:`fivebar.FaultError` if the controller has latched a fault, :class:`fivebar.StoppedError` if they
    were stopped, :class:`fivebar.JobError` for a motion that the arm cannot do, and :class:`fivebar.ControllerError`
    for all else that the controller refuses and for a lost connection.
    """

    def __init__(self, arm: Arm, connection: _native.Connection) -> None:
        #: The arm's kinematics and dynamics.
        self.arm = arm
        self._connection = connection
        # Also at the end of the program.
        self._end = weakref.finalize(self, connection.close)

    @property
    def place(self) -> str:
        """Where the controller runs."""
        return self._connection.place

    @property
    def state(self) -> ArmState:
        """What the controller has told last, some milliseconds ago."""
        told = json.loads(self._connection.state())
        pairs = ("tool", "theta", "omega", "torque", "current")
        told.update({key: tuple(told[key]) for key in pairs if told[key] is not None})
        return ArmState(**told)

    def home(self, at: Optional[Sequence[float]] = None, *, again: bool = False) -> None:
        """Finds the joint angles by the robot's method, unless they are known or with ``again``.

        at: the angles θ1, θ4 [rad] to which you have turned the joints by hand, in place of that.
        An arm that only power keeps in place (steppers without encoders) is on afterwards.
        """
        angles = None if at is None else [float(angle) for angle in pair("at", at)]
        self._connection.home(angles, again)

    def motors_on(self) -> None:
        """Switches the motors on; the arm holds its place."""
        self._connection.motors_on()

    def motors_off(self) -> None:
        """Switches the motors off. An arm that only power keeps in place is to be homed again then."""
        self._connection.motors_off()

    def clear_fault(self) -> None:
        """Clears a latched fault; repair its cause first. It does nothing if there is none."""
        self._connection.clear_fault()

    def move_to(self, x: float, y: float, *, speed: float = 0.05) -> None:
        """Moves the tool straight to (x, y) [m] with at most this speed [m/s]. The motors are on."""
        self._connection.move_to(_finite(x, y), _positive("speed", speed))

    def move_joints(self, theta1: float, theta4: float, *, speed: float = 0.25) -> None:
        """Turns the joints to these angles [rad] with this share of their greatest speed. The motors are on."""
        if not 0.0 < speed <= 1.0:
            raise FivebarError(f"speed must be a share above 0 and at most 1, not {speed!r}")
        self._connection.move_joints(_finite(theta1, theta4), speed)

    def pen_down(self) -> None:
        """Puts the pen down where the arm rests. The motors are on."""
        self._connection.set_tool(1.0)

    def pen_up(self) -> None:
        """Lifts the pen where the arm rests. The motors are on."""
        self._connection.set_tool(0.0)

    def draw(
        self,
        job: Union[str, "os.PathLike[str]"],
        *,
        origin: Optional[Sequence[float]] = None,
        scale: Optional[float] = None,
        progress: Optional[Watcher] = None,
        on_pause: Optional[Callable[[str], None]] = None,
    ) -> List[str]:
        """Draws a job: G-code in a str, or a file given as ``pathlib.Path``. The arm is homed.

        It is checked as a whole before anything moves. Motors that were off are off again in the end.

        origin: where the job's (0, 0) is [m]; by default the drawing lies where the arm moves best.
        scale: of all lengths.
        progress: called about 20 times a second with the moves taken, all moves, and the line.
        on_pause: called with the text of each pause (M0, M1, a change of pen); the job goes on when it returns.
        Returns what was skipped, with its lines.
        """
        return self._connection.draw(
            scenario_of(self.arm._robot, job),
            None if origin is None else [float(x) for x in pair("origin", origin)],
            None if scale is None else _positive("scale", scale),
            progress,
            on_pause,
        )

    def stream(
        self, rate: float = 500.0, *, delay: Optional[float] = None, policy: str = "stop"
    ) -> Stream:
        """A stream of set-points from where the arm rests; the motors are on. See ``docs/use/streaming.md``.

        >>> from math import cos, sin, tau
        >>> import fivebar
        >>> with fivebar.connect("simulated", robot="benchtop", real_time=False) as arm:
        ...     arm.home()
        ...     arm.motors_on()
        ...     x, y = arm.state.tool
        ...     with arm.stream(rate=500) as s:
        ...         for k in range(1001):  # a circle in 2 s, smoothly from rest to rest
        ...             u = k / 1000
        ...             a = tau * u * u * (3 - 2 * u)
        ...             s.tip(x + 0.01 * sin(a), y + 0.01 * (1 - cos(a)))
        ...     print(arm.state.state)
        Armed

        rate: points per second [1/s].
        delay: from a point to the arm's being there [s]: 2 to 200 ms, one to 26 periods. By default 40 ms, three periods if
            that is more, and 26 periods if that is less.
        policy: what becomes of a point that a limit keeps the arm from. "stop": the arm stops before it, and the stream ends.
            "limit": the arm goes towards it as fast as its limits allow, and the stream goes on.
        """
        if policy not in ("stop", "limit"):
            raise FivebarError(f'policy must be "stop" or "limit", not {policy!r}')
        return Stream(
            self._connection,
            _positive("rate", rate),
            None if delay is None else _positive("delay", delay),
            goes_on=policy == "limit",
        )

    def free(self, seconds: float = 600.0) -> TaughtPath:
        """Lets a hand lead the arm for so long [s], or until :meth:`stop`; then it is held. Returns the motion of its tip.

        The motors are on and give way; they carry the arm's weight and a part of its friction. Walls keep it within its angles and
        away from singularities. Arms on steppers, hobby servos, a CAN bus and belts refuse. See ``docs/use/streaming.md``.
        """
        return TaughtPath(self._connection.be_led(_positive("seconds", seconds)))

    def impedance(
        self,
        stiffness: Union[float, Sequence[float]],
        damping: Union[float, Sequence[float]] = 0.0,
        fixtures: Sequence[Fixture] = (),
        *,
        rate: float = 200.0,
    ) -> Impedance:
        """Makes the tip a spring whose end the program moves; the motors are on. See ``docs/use/streaming.md``.

        >>> import fivebar
        >>> with fivebar.connect("simulated", robot="benchtop", real_time=False) as arm:
        ...     arm.home()
        ...     arm.motors_on()
        ...     x, y = arm.state.tool
        ...     with arm.impedance(80.0, 0.02) as spring:
        ...         for k in range(400):  # 2 s
        ...             spring.tip(x, y + 0.01)
        ...     print(round(arm.state.tool[1] - y, 3))
        0.01

        stiffness: [N/m], one number, or xx, xy, yy. What is stiffer than the arm can render here, with all walls and guides, is
            refused with the greatest one.
        damping: [N s/m], likewise.
        fixtures: at most three walls and guides.
        rate: points per second [1/s], more than 50.
        """
        return begin(self._connection, stiffness, damping, fixtures, _positive("rate", rate))

    def replay(self, path: TaughtPath, *, speed: float = 1.0) -> None:
        """Does a taught motion again, at this multiple of its speed, 0.05 to 5. It is checked as a whole before anything moves.

        Raises :class:`fivebar.ControllerError` with the reason and a possible speed, if the arm cannot follow it so fast.
        """
        self._connection.replay(path._text, _positive("speed", speed))

    def stop(self) -> None:
        """Ends the call that another thread waits for: the arm comes to rest on its path, with its motors on.

        It returns when the arm rests; the other thread gets :class:`fivebar.StoppedError`.
        """
        self._connection.stop()

    def emergency_stop(self) -> None:
        """Switches the motors off at once, whatever is being done. Nothing moves until :meth:`clear_fault`."""
        self._connection.emergency_stop()

    def close(self) -> None:
        """Ends the present call, brings the arm to rest, switches its motors off and ends the connection."""
        self._end()

    def __enter__(self) -> LiveArm:
        return self

    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        error: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<fivebar.LiveArm {self.arm.name!r}, {self.place}, {self.state.state}>"


def connect(
    to: str = "simulated",
    robot: Union[str, "os.PathLike[str]", Arm] = "benchtop",
    *,
    image: Optional[Union[str, "os.PathLike[str]"]] = None,
    upload: bool = False,
    real_time: bool = True,
) -> LiveArm:
    """Connects to a controller with this robot.

    >>> import fivebar
    >>> with fivebar.connect("simulated", robot="benchtop", real_time=False) as arm:
    ...     arm.home()
    ...     arm.motors_on()
    ...     arm.move_to(0.03, 0.20, speed=0.1)
    ...     x, y = arm.state.tool
    ...     print(round(x, 3), round(y, 3))
    0.03 0.2

    to: ``"simulated"``, a controller in this process with the simulated arm; ``"emulated"``, the firmware on an emulated
        board with the simulated arm (QEMU and its image are needed); or the name of a serial port.
    robot: a built-in robot, a file, or an :class:`fivebar.Arm`.
    image: the emulated board's image; by default that which ``scripts/firmware.sh`` has built.
    upload: store the robot's settings on the controller of a port, which must have them.
    real_time: whether a simulated arm keeps the time of the machine. Otherwise its time passes only during calls, as
        fast as it can be computed.
    Raises :class:`fivebar.RobotError`, or :class:`fivebar.ControllerError` with the way out.
    """
    arm = robot if isinstance(robot, Arm) else Arm.load(os.fspath(robot))
    where = None if image is None else os.fspath(image)
    return LiveArm(arm, _native.Connection(arm._robot, to, where, upload, real_time))


def _finite(first: float, second: float) -> List[float]:
    return [float(value) for value in pair("target", (first, second))]


def _positive(name: str, value: float) -> float:
    if not 0.0 < value < float("inf"):
        raise FivebarError(f"{name} must be a positive finite number, not {value!r}")
    return float(value)
