"""An arm that is felt: springs, walls and guides at its tip."""

from __future__ import annotations

from types import TracebackType
from typing import NamedTuple, Optional, Sequence, Tuple, Type, Union

from . import _native
from ._errors import FivebarError
from ._shapes import pair

Point = Sequence[float]

#: The controller damps an arm that has had no point for 20 ms [1/s].
SLOWEST = 50.0


class Fixture(NamedTuple):
    """A wall or a guide of :meth:`fivebar.LiveArm.impedance`. Walls push the tip out and never pull, guides pull it on.

    >>> import fivebar
    >>> fivebar.Fixture.half_plane((0.0, 0.1), (0.0, 1.0), 150.0).kind
    'half_plane'
    """

    kind: str
    numbers: Tuple[float, ...]
    #: [N/m]
    stiffness: float
    #: [N s/m]
    damping: float

    @classmethod
    def half_plane(
        cls, point: Point, normal: Point, stiffness: float, damping: float = 0.0
    ) -> Fixture:
        """A wall through a point [m]: the tip is free on the side to which the normal points."""
        return cls("half_plane", (*_two("point", point), *_two("normal", normal), 0.0, 0.0), stiffness, damping)

    @classmethod
    def box(
        cls, centre: Point, half: Point, stiffness: float, damping: float = 0.0, axis: Point = (1.0, 0.0)
    ) -> Fixture:
        """A wall: the tip is free inside, so far [m] from the centre [m] along the axis and to its left."""
        numbers = (*_two("centre", centre), *_two("axis", axis), *_two("half", half))
        return cls("box", numbers, stiffness, damping)

    @classmethod
    def inside(cls, centre: Point, radius: float, stiffness: float, damping: float = 0.0) -> Fixture:
        """A wall: the tip is free inside a circle [m]."""
        return cls("inside", _round(centre, radius), stiffness, damping)

    @classmethod
    def outside(cls, centre: Point, radius: float, stiffness: float, damping: float = 0.0) -> Fixture:
        """A wall: the tip is free outside of a circle [m]."""
        return cls("outside", _round(centre, radius), stiffness, damping)

    @classmethod
    def line(cls, point: Point, normal: Point, stiffness: float, damping: float = 0.0) -> Fixture:
        """A guide along a line through a point [m]."""
        return cls("line", (*_two("point", point), *_two("normal", normal), 0.0, 0.0), stiffness, damping)

    @classmethod
    def circle(cls, centre: Point, radius: float, stiffness: float, damping: float = 0.0) -> Fixture:
        """A guide along a circle [m]."""
        return cls("circle", _round(centre, radius), stiffness, damping)


class Impedance:
    """Springs at the tip of an arm; :meth:`fivebar.LiveArm.impedance` makes it.

    Each call is one point, a period after the one before, for which it waits. What the arm cannot render is refused at the
    first one. A program that gives none for 20 ms lets the arm be damped, and its next point lets it give way again; 150 ms
    later the arm is held. The next call, or the end of the ``with`` block, raises :class:`fivebar.ControllerError` then.
    """

    def __init__(self, connection: _native.Connection) -> None:
        self._connection = connection

    def tip(
        self,
        x: float,
        y: float,
        vx: float = 0.0,
        vy: float = 0.0,
        *,
        force: Point = (0.0, 0.0),
    ) -> None:
        """The spring of the tip ends at (x, y) [m], which moves with this velocity [m/s], and a force [N] acts on the tip."""
        self._connection.stream_point(
            _two("position", (x, y)), _two("velocity", (vx, vy)), _two("force", force)
        )

    def change(
        self, stiffness: Union[float, Sequence[float]], damping: Union[float, Sequence[float]] = 0.0
    ) -> None:
        """Changes the spring [N/m] and the damper [N s/m] in 0.1 s. What is not passive is refused: the stream ends then."""
        self._connection.change_impedance(
            _matrix("stiffness", stiffness), _matrix("damping", damping)
        )

    def __enter__(self) -> Impedance:
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


def begin(
    connection: _native.Connection,
    stiffness: Union[float, Sequence[float]],
    damping: Union[float, Sequence[float]],
    fixtures: Sequence[Fixture],
    rate: float,
) -> Impedance:
    """Begins a stream with an impedance."""
    if not all(isinstance(it, Fixture) for it in fixtures):
        raise FivebarError(f"fixtures must be a sequence of Fixture, not {fixtures!r}")
    if rate <= SLOWEST:
        raise FivebarError(
            f"rate must be more than {SLOWEST:.0f} points per second, not {rate!r}: slower ones leave the arm damped"
        )
    told = [(it.kind, list(it.numbers), float(it.stiffness), float(it.damping)) for it in fixtures]
    connection.begin_impedance(
        _matrix("stiffness", stiffness), _matrix("damping", damping), told, rate
    )
    return Impedance(connection)


def _matrix(name: str, value: Union[float, Sequence[float]]) -> Sequence[float]:
    """xx, xy, yy of a number, which is that in all directions, or of these three."""
    if isinstance(value, (int, float)):
        return [float(value), 0.0, float(value)]
    numbers = [float(number) for number in value]
    if len(numbers) != 3:
        raise FivebarError(f"{name} must be one number, or three: xx, xy, yy")
    return numbers


def _two(name: str, values: Point) -> Tuple[float, float]:
    first, second = pair(name, values)
    return float(first), float(second)


def _round(centre: Point, radius: float) -> Tuple[float, ...]:
    return (*_two("centre", centre), float(radius), 0.0, 0.0, 0.0)
