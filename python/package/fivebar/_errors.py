"""The exceptions of the package. All of them are ``ValueError``."""

from __future__ import annotations

from typing import Optional, Tuple


class FivebarError(ValueError):
    """The base of all exceptions of this package."""


class PoseError(FivebarError):
    """A point or state without a solution, raised if ``strict=True``."""

    #: ``"unreachable"``, ``"singular"`` or ``"invalid"``, as in the errors of ``fivebar query``.
    kind: str = "invalid"

    def __init__(self, message: str, index: Tuple[int, ...] = ()) -> None:
        super().__init__(message)
        #: The index in the batch: ``points[error.index]`` is the first one without a solution.
        self.index = index


class UnreachableError(PoseError):
    """No pose exists there."""

    kind = "unreachable"


class SingularError(PoseError):
    """The solution is not unique or not finite there."""

    kind = "singular"


class InvalidError(PoseError):
    """An argument is not valid: a number is infinite or NaN, or no branch is given."""

    kind = "invalid"


class RobotError(FivebarError):
    """A robot that is refused, or that lacks data that the call needs."""

    def __init__(
        self, message: str, file: Optional[str] = None, line: Optional[int] = None
    ) -> None:
        super().__init__(message)
        #: The name of the file, if the error is in a file.
        self.file = file
        #: The line with the error, from 1.
        self.line = line


class JobError(FivebarError):
    """A job that the arm cannot do. It is refused before the arm moves."""

    def __init__(
        self,
        message: str,
        line: Optional[int] = None,
        point: Optional[Tuple[float, float]] = None,
    ) -> None:
        super().__init__(message)
        #: The line of the job, from 1.
        self.line = line
        #: The first position on the path that cannot be passed [m], if there is one.
        self.point = point


class RunError(FivebarError):
    """A run that could not begin or ended early, for a reason other than a fault of the arm."""

    def __init__(self, message: str, index: Optional[int] = None) -> None:
        super().__init__(message)
        #: The first arm of :class:`fivebar.Plants` that cannot go on.
        self.index = index


class StudyError(FivebarError):
    """A study that cannot be done, or a description of it that is refused."""


class ControllerError(FivebarError):
    """A controller that refuses a call, or a connection that cannot be made or has ended."""


class FaultError(ControllerError):
    """A fault that the controller has latched: the motors are off, or hold the arm at rest."""

    def __init__(self, message: str, name: str = "", number: int = 0) -> None:
        super().__init__(message)
        #: The fault's name.
        self.name = name
        #: Its number.
        self.number = number


class StoppedError(ControllerError):
    """A call that was stopped: the arm rests on its path."""

    def __init__(self, message: str, line: Optional[int] = None) -> None:
        super().__init__(message)
        #: The line of the job on which it rests; None outside of a job.
        self.line = line
