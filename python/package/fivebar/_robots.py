"""The robots that come with the package."""

from __future__ import annotations

from typing import List

from . import _native


def built_in() -> List[str]:
    """The names of the robots that come with the package; the first is the default.

    >>> "benchtop" in built_in()
    True
    """
    return _native.built_in()
