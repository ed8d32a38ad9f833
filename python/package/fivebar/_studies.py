"""Studies of arms: the answers of the program's commands, as dictionaries."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, Dict, Optional, Union

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


def workspace(robot: _native.Robot, resolution: Optional[float]) -> Dict[str, Any]:
    """See :meth:`fivebar.Arm.workspace`."""
    return dict(json.loads(_native.workspace(robot, resolution)))


def margins(robot: _native.Robot) -> Dict[str, Any]:
    """See :meth:`fivebar.Arm.margins`."""
    return dict(json.loads(_native.margins(robot)))
