"""Set-points that a program streams to an arm."""

from __future__ import annotations

import json
from asyncio import to_thread
from itertools import repeat
from time import monotonic
from types import TracebackType
from typing import Iterable, List, NamedTuple, Optional, Sequence, Tuple, Type

from . import _native
from ._errors import FivebarError
from ._shapes import pair


class StreamState(NamedTuple):
    """What a stream has done so far, as the controller has told it last; :attr:`Stream.state` gives it."""

    #: "Waits", "Follows", "Starved", "Ends" or "Ended".
    phase: str
    #: The latest reason for which a point was not followed, or the stream ended.
    reason: Optional[str]
    #: Points that came too late, that never came, that were refused, and that a limit kept the arm from.
    late: int
    lost: int
    refused: int
    limited: int
    #: The time until the last point is due [s]; less than 0 if it was due.
    buffered: float
    #: Measured [rad], estimated [rad/s] and demanded [N m], of joint 1 and joint 4.
    theta: Tuple[float, float]
    omega: Tuple[float, float]
    torque: Tuple[float, float]
    #: The points that the program has given, the mean time from one to the next, and the longest [s]: what is more than the
    #: delay lets the arm starve.
    points: int
    interval: float
    longest_interval: float


class Stream:
    """Set-points, one after the other; :meth:`fivebar.LiveArm.stream` makes it.

    Each call is one point, a period of the stream's rate after the point before. It waits while the points before it last
    longer than the stream's delay, so a loop without a clock keeps the stream's time. The first point is where the arm is,
    within 0.5 mm or 1 mrad. All points are of the tip, or all of the joints.

    A program that pauses longer than the delay lets the arm come to rest; its next points lead smoothly back to its motion. A point
    beyond a limit ends the stream before it: the call, or the end of the ``with`` block, raises
    :class:`fivebar.ControllerError` with the reason, and the arm rests.
    """

    def __init__(
        self,
        connection: _native.Connection,
        rate: float,
        delay: Optional[float],
        *,
        goes_on: bool = False,
    ) -> None:
        self._connection = connection
        self._goes_on = goes_on
        self._points = 0
        #: When the first point was given and the last one, and the longest time between two [s].
        self._first = self._last = 0.0
        self._longest = 0.0
        self._rate = rate
        self._delay = delay
        #: Whether the points are of the joints; None before the first one.
        self._joints: Optional[bool] = None

    def tip(
        self,
        x: float,
        y: float,
        vx: Optional[float] = None,
        vy: Optional[float] = None,
        *,
        force: Tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """The tip is at (x, y) [m] with this velocity [m/s]; by default that of the points beside. It presses with a force [N]
        besides what the motion needs, which passes evenly from one point's to the next's; only motors that give a torque do.
        """
        self._give(False, (x, y), (vx, vy), force)

    def joint(
        self,
        theta1: float,
        theta4: float,
        omega1: Optional[float] = None,
        omega4: Optional[float] = None,
        *,
        torque: Tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """The joints are at these angles [rad] with these velocities [rad/s]; by default those of the points beside. The motors
        give these torques [N m] besides, as :meth:`tip` does its force.
        """
        self._give(True, (theta1, theta4), (omega1, omega4), torque)

    @property
    def state(self) -> Optional[StreamState]:
        """What the stream has done so far, also after its end; None before the controller has told."""
        told = self._connection.stream_state()
        if told is None or self._points == 0:
            return None
        described = json.loads(told)
        for key in ("theta", "omega", "torque"):
            described[key] = tuple(described[key])
        intervals = self._points - 1
        return StreamState(
            **described,
            points=self._points,
            interval=(self._last - self._first) / intervals if intervals else 0.0,
            longest_interval=self._longest,
        )

    def follow(
        self,
        points: Iterable[Sequence[float]],
        velocities: Optional[Iterable[Sequence[float]]] = None,
        *,
        joints: bool = False,
    ) -> None:
        """Gives rows of points of the tip [m], or of the joints [rad], such as an array of n × 2, with these velocities."""
        rates: Iterable[Sequence[Optional[float]]] = (
            repeat((None, None)) if velocities is None else velocities
        )
        for point, rate in zip(points, rates):
            self._give(joints, (point[0], point[1]), (rate[0], rate[1]), (0.0, 0.0))

    def _give(
        self,
        joints: bool,
        position: Tuple[float, float],
        velocity: Tuple[Optional[float], Optional[float]],
        force: Tuple[float, float],
    ) -> None:
        first, second = velocity
        if (first is None) != (second is None):
            raise FivebarError("a velocity has two components: give both or none")
        rates = None if first is None or second is None else (first, second)
        if self._joints is None:
            self._connection.begin_stream(joints, self._rate, self._delay, self._goes_on)
            self._joints = joints
        elif self._joints is not joints:
            raise FivebarError("a stream has points of the tip or of the joints, not both")
        self._connection.stream_point(
            _floats("position", position),
            None if rates is None else _floats("velocity", rates),
            _floats("force" if not joints else "torque", force),
        )
        self._count(monotonic())

    def _count(self, now: float) -> None:
        """A point was given now [s]."""
        if self._points == 0:
            self._first = now
        else:
            self._longest = max(self._longest, now - self._last)
        self._points += 1
        self._last = now

    async def __aenter__(self) -> AsyncStream:
        return AsyncStream(self)

    async def __aexit__(
        self,
        kind: Optional[Type[BaseException]],
        error: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None:
        await to_thread(self.__exit__, kind, error, trace)

    def __enter__(self) -> Stream:
        return self

    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        error: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None:
        try:
            self._connection.end_stream()
        except FivebarError:
            # What has ended the block says more.
            if error is None:
                raise


class AsyncStream:
    """What ``async with arm.stream() as s`` gives: the calls of :class:`Stream`, for each of which a program with ``asyncio``
    waits while its other tasks go on.
    """

    def __init__(self, stream: Stream) -> None:
        self._stream = stream

    @property
    def state(self) -> Optional[StreamState]:
        """As :attr:`Stream.state`."""
        return self._stream.state

    async def tip(
        self,
        x: float,
        y: float,
        vx: Optional[float] = None,
        vy: Optional[float] = None,
        *,
        force: Tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """As :meth:`Stream.tip`."""
        await to_thread(self._stream.tip, x, y, vx, vy, force=force)

    async def joint(
        self,
        theta1: float,
        theta4: float,
        omega1: Optional[float] = None,
        omega4: Optional[float] = None,
        *,
        torque: Tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """As :meth:`Stream.joint`."""
        await to_thread(self._stream.joint, theta1, theta4, omega1, omega4, torque=torque)


def _floats(name: str, values: Tuple[float, float]) -> List[float]:
    return [float(value) for value in pair(name, values)]
