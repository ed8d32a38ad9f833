"""Converts array-like arguments to the flat arrays of the compiled half, and results back."""

from __future__ import annotations

from typing import Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import FivebarError
from ._status import ERRORS, Side, Status

Floats = NDArray[np.float64]
Signs = NDArray[np.int8]
Statuses = NDArray[np.uint8]
#: "left", "right", a Side, or an array of names or signs (+1 left, −1 right).
SideLike = Union[str, Side, ArrayLike]


def pairs(name: str, value: ArrayLike) -> Floats:
    """Numbers in pairs along the last axis."""
    array = np.asarray(value)
    if array.shape == (0,):
        array = np.empty((0, 2))
    if array.dtype.kind not in "biuf":
        raise TypeError(f"{name} must hold real numbers, not {array.dtype}")
    if array.ndim == 0 or array.shape[-1] != 2:
        raise FivebarError(f"{name} must have a last axis of length 2, not shape {array.shape}")
    return array.astype(np.float64, copy=False)


def pair(name: str, value: ArrayLike) -> List[float]:
    """One pair of finite numbers."""
    array = pairs(name, value)
    if array.shape != (2,) or not np.all(np.isfinite(array)):
        raise FivebarError(f"{name} must be two finite numbers, not {value!r}")
    return [float(number) for number in array]


def rows(name: str, value: Optional[ArrayLike], columns: Sequence[str]) -> List[List[float]]:
    """A table of finite numbers with these columns; None has no rows."""
    if value is None:
        return []
    array = np.asarray(value, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != len(columns):
        wanted = f"rows with the columns {', '.join(columns)}"
        raise FivebarError(f"{name} must be {wanted}, not of shape {array.shape}")
    if not np.all(np.isfinite(array)):
        row = int(np.argmin(np.isfinite(array).all(axis=1)))
        raise FivebarError(f"{name} must hold finite numbers; row {row} does not")
    table: List[List[float]] = array.tolist()
    return table


def sides(name: str, value: SideLike) -> Signs:
    """Signs of sides: +1 left, −1 right, 0 for a row that had no solution before."""
    if isinstance(value, Side):
        return np.array(value, dtype=np.int8)
    array = np.asarray(value)
    if array.dtype.kind == "U":
        signs = np.zeros(array.shape, dtype=np.int8)
        signs[array == "left"] = Side.LEFT
        signs[array == "right"] = Side.RIGHT
        known = bool(np.all(signs != 0))
    elif array.dtype.kind in "iuf":
        known = bool(np.all((array == 1) | (array == -1) | (array == 0)))
        signs = array.astype(np.int8) if known else np.zeros((), dtype=np.int8)
    else:
        known = False
    if not known:
        raise FivebarError(f"{name} must be 'left' or 'right', or +1 or -1, not {value!r}")
    return signs


def broadcast(
    numbers: Dict[str, Floats], branches: Dict[str, Signs]
) -> Tuple[Tuple[int, ...], List[Floats], List[Signs]]:
    """The shape of the batch, and every argument in that shape, contiguous."""
    shapes = {name: array.shape[:-1] for name, array in numbers.items()}
    shapes.update((name, array.shape) for name, array in branches.items())
    try:
        shape = np.broadcast_shapes(*shapes.values())
    except ValueError:
        said = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
        raise FivebarError(f"the shapes of the batch do not go together: {said}") from None
    return (
        shape,
        [np.require(np.broadcast_to(a, (*shape, 2)), None, ("C", "A")) for a in numbers.values()],
        [np.require(np.broadcast_to(a, shape), None, ("C", "A")) for a in branches.values()],
    )


def refuse(statuses: Statuses, given: Dict[str, Floats]) -> None:
    """Raises the first problem of a batch, if there is one."""
    if not statuses.any():
        return
    first = np.unravel_index(int(np.argmax(statuses != Status.OK)), statuses.shape)
    index = tuple(int(i) for i in first)
    status = Status(int(statuses[index]))
    place = ", ".join(f"{name} = {array[index].tolist()}" for name, array in given.items())
    row = f"row {', '.join(map(str, index))}: " if index else ""
    raise ERRORS[status.kind](f"{row}{status.reason}; {place}", index)
