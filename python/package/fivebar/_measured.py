"""What measurements tell of an arm."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Dict, List, Tuple


@dataclass(frozen=True)
class Found:
    """What was found of an arm by measurements."""

    #: The figures of the program's command with ``--json``; the units are in the keys.
    figures: Dict[str, Any]
    #: The robot file with the measured values, for :meth:`fivebar.Arm.from_toml`.
    robot_toml: str
    #: What makes the result doubtful.
    warnings: List[str]


@dataclass(frozen=True)
class Photo:
    """A photograph of a drawing, compared with its job."""

    #: The figures of ``fivebar photo --json``; the units are in the keys.
    figures: Dict[str, Any]
    #: Where strokes of different directions are near each other: rows of counts1, counts4, u, v for
    #: :meth:`fivebar.Arm.calibrate`. Empty where the pen is beside C, or the arm has no counts.
    points: List[List[float]]


def found(answer: Tuple[str, str, List[str]]) -> Found:
    """The answer of the compiled half."""
    figures, robot, warnings = answer
    return Found(json.loads(figures), robot, warnings)
