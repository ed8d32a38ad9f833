"""Mechanisms beyond the five-bar arm."""

from __future__ import annotations

import json
from typing import Any, Dict, List

from . import _native
from ._studies import Source, text_of


def linkage(source: Source) -> Dict[str, Any]:
    """Motion and forces of a planar linkage, dyad by dyad: ``fivebar linkage --json``.

    source: TOML, the ``pathlib.Path`` of such a file, or the name of a built-in example.
    Raises :class:`fivebar.StudyError`.

    >>> found = linkage("four_bar")
    >>> found["closed"] == found["samples"]
    True
    """
    if isinstance(source, str) and "\n" not in source:
        return dict(json.loads(_native.linkage(source, None)))
    name, text = text_of(source)
    return dict(json.loads(_native.linkage(name, text)))


def mobility(source: Source) -> List[Dict[str, Any]]:
    """Degrees of freedom by screw theory, a dictionary for each mechanism: ``fivebar mobility --json``.

    source: a mechanism in TOML, the ``pathlib.Path`` of such a file or of a list of cases in JSON,
    or the name of a built-in example. Raises :class:`fivebar.StudyError`.

    >>> [found["M_inst"] for found in mobility("delta")]
    [3]
    """
    name, text = text_of(source)
    return [json.loads(answer) for answer in _native.mobility(name, text)]
