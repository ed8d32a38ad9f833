"""What is refused, as exceptions. All of them are ``ValueError``."""

from __future__ import annotations

from typing import Optional, Tuple


class FivebarError(ValueError):
    """Anything that this package refuses."""


class PoseError(FivebarError):
    """A point or state without an answer, raised where ``strict=True``."""

    #: ``"unreachable"``, ``"singular"`` or ``"invalid"``, as ``fivebar query`` says it.
    kind: str = "invalid"

    def __init__(self, message: str, index: Tuple[int, ...] = ()) -> None:
        super().__init__(message)
        #: Where in the batch: ``points[error.index]`` is the first one without an answer.
        self.index = index


class UnreachableError(PoseError):
    """No pose exists there."""

    kind = "unreachable"


class SingularError(PoseError):
    """The answer is not unique or not finite there."""

    kind = "singular"


class InvalidError(PoseError):
    """The question makes no sense: a number is infinite or NaN, or no branch is given."""

    kind = "invalid"


class RobotError(FivebarError):
    """A robot that is refused, or that lacks what is asked of it."""

    def __init__(
        self, message: str, file: Optional[str] = None, line: Optional[int] = None
    ) -> None:
        super().__init__(message)
        #: The file as it was named, if a file is at fault.
        self.file = file
        #: The line at fault, from 1.
        self.line = line


class JobError(FivebarError):
    """A job that the arm cannot do as written. Nothing has moved."""

    def __init__(
        self,
        message: str,
        line: Optional[int] = None,
        point: Optional[Tuple[float, float]] = None,
    ) -> None:
        super().__init__(message)
        #: The line of the job, from 1.
        self.line = line
        #: The first place on the path that cannot be passed [m], if it is one.
        self.point = point


class RunError(FivebarError):
    """A run that could not be begun or did not come to its end, faults of the arm aside."""
