"""Sides of a branch, and the status of each row of a batch."""

from __future__ import annotations

from enum import IntEnum
from typing import Dict, Tuple, Type

from . import _native
from ._errors import InvalidError, PoseError, SingularError, UnreachableError


class Side(IntEnum):
    """Left or right of a directed line: the sign of the cross product.

    Assembly: C lies left of the ray B→D, or right. Elbows: AB×BC > 0 is a left turn of
    elbow 1, ED×DC > 0 one of elbow 4.
    """

    LEFT = 1
    RIGHT = -1


class Status(IntEnum):
    """The status of a row of a batch: the codes in the ``status`` of every result.

    >>> Status(1)
    <Status.LEG1_TOO_FAR: 1>
    >>> Status.LEG1_TOO_FAR.kind, Status.LEG1_TOO_FAR.reason
    ('unreachable', 'the point is farther from A than l1 + l2')
    """

    OK = 0
    #: C is farther from A than l1 + l2.
    LEG1_TOO_FAR = 1
    #: C is nearer to A than |l1 − l2|.
    LEG1_TOO_NEAR = 2
    #: C is farther from E than l4 + l3.
    LEG4_TOO_FAR = 3
    #: C is nearer to E than |l4 − l3|.
    LEG4_TOO_NEAR = 4
    #: B and D are farther apart than l2 + l3.
    ELBOWS_TOO_FAR = 5
    #: B and D are nearer than |l2 − l3|.
    ELBOWS_TOO_NEAR = 6
    #: A, B, C in line: sin(θ2−θ1) = 0 (type 1).
    LEG1_SINGULAR = 7
    #: E, D, C in line: sin(θ3−θ4) = 0 (type 1).
    LEG4_SINGULAR = 8
    #: B, C, D in line or B = D: sin(θ3−θ2) = 0 (type 2).
    PARALLEL_SINGULAR = 9
    #: A number given is infinite or not a number.
    NOT_FINITE = 10
    #: A side of 0: neither left nor right.
    NO_SIDE = 11
    #: The numbers given are so large that the result is not finite.
    TOO_LARGE = 12

    @property
    def kind(self) -> str:
        """``"ok"``, or the error of ``fivebar query``: unreachable, singular, invalid."""
        return _PROBLEMS[self.value][0] if self else "ok"

    @property
    def reason(self) -> str:
        """The reason in a sentence; empty for a row with a solution."""
        return _PROBLEMS[self.value][1] if self else ""


_PROBLEMS: Dict[int, Tuple[str, str]] = {
    code: (kind, reason) for code, kind, reason in _native.statuses()
}

#: The exception of each kind.
ERRORS: Dict[str, Type[PoseError]] = {
    error.kind: error for error in (UnreachableError, SingularError, InvalidError)
}
