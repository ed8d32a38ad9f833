"""Studies of arms: the answers of the program's commands, as dictionaries."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, Mapping, Optional, Union

from . import _native

#: A file's path, as ``pathlib.Path`` or another path object, or the text of such a file.
Source = Union[str, "os.PathLike[str]"]

#: The name in errors of a text that comes from no file.
UNNAMED = "study"


def text_of(source: Source) -> "tuple[str, str]":
    """The name and the text of a source."""
    if isinstance(source, str):
        return UNNAMED, source
    return os.fspath(source), Path(source).read_text(encoding="utf-8")


@dataclass(frozen=True)
class Design:
    """An arm for a wanted work area."""

    #: The figures of ``fivebar design --json``: best {link_lengths [5], size, link_sum,
    #: dexterity, place [x, y]}, whole_millimetres (the same keys), front, sensitivity_per_m,
    #: evaluations, proved, unproved_at, whole_proved. Lengths in metres.
    figures: Dict[str, Any]
    #: The robot file with lengths in whole millimetres, for :meth:`fivebar.Arm.from_toml`.
    robot_toml: str


def design(specification: Source, *, seed: int = 1) -> Design:
    """Searches the lengths of an arm for a wanted work area, as ``fivebar design`` does.

    The specification is TOML, or a ``pathlib.Path`` of such a file, beside which its drawing is
    looked for; docs/design/synthesis.md describes its keys. The same seed gives the same answer.
    Raises :class:`fivebar.StudyError`. It takes seconds to minutes, on all cores.

    >>> found = design('''
    ... symmetric = true
    ... base = [0.0, 0.0]
    ... link_sum = 0.3
    ... [area]
    ... kind = "annulus"
    ... [require]
    ... dexterity = 0.5
    ... [objective]
    ... maximise = "size"
    ... ''')
    >>> found.figures["proved"], round(found.figures["best"]["size"], 3)
    (True, 0.245)
    """
    name, text = text_of(specification)
    figures, robot = _native.design(name, text, str(Path(name).parent), seed)
    return Design(json.loads(figures), robot)


def workspace(robot: _native.Robot, resolution: Optional[float]) -> Dict[str, Any]:
    """See :meth:`fivebar.Arm.workspace`."""
    return dict(json.loads(_native.workspace(robot, resolution)))


def margins(robot: _native.Robot) -> Dict[str, Any]:
    """See :meth:`fivebar.Arm.margins`."""
    return dict(json.loads(_native.margins(robot)))


def plan(
    robot: _native.Robot,
    path: Union[Source, Mapping[str, Any]],
    torque_share: float,
    jerk: Optional[float],
) -> Dict[str, Any]:
    """See :meth:`fivebar.Arm.plan`."""
    name, text = (UNNAMED, json.dumps(path)) if isinstance(path, Mapping) else text_of(path)
    return dict(json.loads(_native.plan(robot, name, text, torque_share, jerk)))
