"""Motions that a hand teaches."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Union

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._errors import FivebarError


class TaughtPath:
    """A motion that a hand has taught; :meth:`fivebar.LiveArm.free` makes it, :meth:`fivebar.LiveArm.replay` does it again."""

    def __init__(self, text: str) -> None:
        self._text = text
        told = json.loads(text)
        #: The robot's name.
        self.robot: str = told["robot"]
        #: The tip from knot to knot [m], of shape (n, 2).
        self.tip: NDArray[np.float64] = np.array(told["tip_m"], dtype=float)
        #: The times of the knots [s].
        self.time: NDArray[np.float64] = told["knot_s"] * np.arange(len(self.tip))

    @staticmethod
    def load(file: Union[str, "os.PathLike[str]"]) -> TaughtPath:
        """The path in a file of ``fivebar teach`` or of :meth:`save`."""
        text = Path(file).read_text(encoding="utf-8")
        return TaughtPath(_native.taught_path_as(text, "json"))

    def save(self, file: Union[str, "os.PathLike[str]"]) -> None:
        """Writes the path: ``.json`` to be replayed, ``.gcode`` or ``.svg`` for other programs, ``.csv`` for the places of
        :meth:`rests`.
        """
        form = Path(file).suffix[1:]
        if form not in ("json", "gcode", "svg", "csv"):
            raise FivebarError(f"a taught path is written as .json, .gcode, .svg or .csv, not {file!r}")
        Path(file).write_text(_native.taught_path_as(self._text, form), encoding="utf-8")

    def rests(self, least: float = 0.5) -> NDArray[np.float64]:
        """The places [m] where the tip rested for at least so long [s], of shape (n, 2), with the first one and the last: where to
        pick something up, and where to put it down.
        """
        return np.array(_native.taught_rests(self._text, float(least)), dtype=float)

    def __repr__(self) -> str:
        return f"<fivebar.TaughtPath of {self.robot!r}, {self.time[-1]:.2f} s>"
