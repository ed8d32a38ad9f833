"""Mechanisms beyond the five-bar arm."""

from __future__ import annotations

import json
import os
from typing import Any, Dict, List, Union

from numpy.typing import ArrayLike

from . import _native
from ._shapes import pair
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


def linkage_accuracy(
    source: Union[str, "os.PathLike[str]"], *, time: float = 0.0, samples: int = 100_000, seed: int = 1
) -> Dict[str, Any]:
    """The effect of a linkage's tolerances over its sweep: ``fivebar accuracy --json``.

    source: the name of a built-in example, or the path of a file. time: the instant to sample [s].
    Raises :class:`fivebar.StudyError`.

    >>> "monte_carlo" in linkage_accuracy("loose_four_bar", samples=100)
    True
    """
    return dict(json.loads(_native.linkage_accuracy(os.fspath(source), time, samples, seed)))


def slider_accuracy(
    source: Union[str, "os.PathLike[str]"],
    at: ArrayLike,
    *,
    force: ArrayLike = (0.0, 0.0),
    samples: int = 100_000,
    seed: int = 1,
) -> Dict[str, Any]:
    """The same for the slider-driven mechanism with P at a point [m]: ``fivebar accuracy --at --json``.

    source: the name of a built-in robot, or the path of a file. force on P [N].
    """
    answer = _native.slider_accuracy(
        os.fspath(source), pair("at", at), pair("force", force), samples, seed
    )
    return dict(json.loads(answer))
