"""What all results of many numbers can become: dictionaries, tables of pandas and xarray, pictures of matplotlib."""

from __future__ import annotations

from importlib import import_module
from typing import Any, ClassVar, Dict, Mapping, Sequence, Tuple

import numpy as np
from numpy.typing import NDArray

from ._errors import FivebarError

#: The labels along the last axes of a field.
LABELS: Dict[str, Sequence[Any]] = {
    "axis": ("x", "y"),
    "joint": (1, 4),
    "of_joint": (1, 4),
    "quantity": ("x", "y", "vx", "vy", "ax", "ay", "torque1", "torque4"),
    "variable": ("theta1", "theta4", "omega1", "omega4", "alpha1", "alpha4",
                 "l1", "l2", "l3", "l4", "base", "m1", "m2", "m3", "m4"),
}
LABELS["of_variable"] = LABELS["variable"]

#: The last axes of a field that has a number for each row, a point, a value of each driven joint.
NUMBER: Tuple[str, ...] = ()
POINT = ("axis",)
JOINTS = ("joint",)


def optional(module: str, what: str) -> Any:
    """A library that the package does without."""
    try:
        return import_module(module)
    except ImportError as missing:
        library = module.partition(".")[0]
        raise FivebarError(f"{what} needs {library}: pip install {library}") from missing


class Table:
    """A result with a row for each point, state or instant."""

    #: The fields in their order, each with the names of its last axes.
    FIELDS: ClassVar[Mapping[str, Tuple[str, ...]]] = {}
    #: The field along which a picture is drawn; without one, the number of the row.
    ALONG: ClassVar[str] = ""

    def to_dict(self) -> Dict[str, NDArray[Any]]:
        """The arrays by their names."""
        return {name: getattr(self, name) for name in self.FIELDS if getattr(self, name) is not None}

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame``: a row for each point, state or instant, and columns such as ``c_x`` or ``torque_4``."""
        pandas = optional("pandas", "to_pandas")
        return pandas.DataFrame(self._columns())

    def to_xarray(self) -> Any:
        """An ``xarray.Dataset`` with the axes of the batch, and of points (``axis``) and joints (``joint``)."""
        xarray = optional("xarray", "to_xarray")
        variables: Dict[str, Tuple[Tuple[str, ...], NDArray[Any]]] = {}
        coordinates: Dict[str, Any] = {}
        for name, array in self.to_dict().items():
            axes = self.FIELDS[name]
            batch = [self.ALONG or f"row_{index}" for index in range(np.ndim(array) - len(axes))]
            variables[name] = ((*batch, *axes), array)
            coordinates.update({axis: list(LABELS[axis]) for axis in axes})
        if self.ALONG:
            coordinates[self.ALONG] = variables.pop(self.ALONG)[1]
        return xarray.Dataset(variables, coordinates)

    def plot(self) -> Any:
        """A ``matplotlib`` figure with a chart for each field."""
        pyplot = optional("matplotlib.pyplot", "plot")
        fields = {name: a for name, a in self.to_dict().items() if name not in ("status", self.ALONG)}
        figure, charts = pyplot.subplots(
            len(fields), sharex=True, squeeze=False, figsize=(7.0, 1.6 * len(fields))
        )
        for chart, (name, array) in zip(charts[:, 0], fields.items()):
            rows = np.reshape(array, (-1, *(len(LABELS[axis]) for axis in self.FIELDS[name])))
            along = getattr(self, self.ALONG) if self.ALONG else np.arange(len(rows))
            chart.plot(along, rows.reshape(len(rows), -1))
            chart.set_ylabel(name)
        charts[-1, 0].set_xlabel(f"{self.ALONG} [s]" if self.ALONG else "row")
        return figure

    def _columns(self) -> Dict[str, NDArray[Any]]:
        columns = {}
        for name, array in self.to_dict().items():
            labels = [LABELS[axis] for axis in self.FIELDS[name]]
            shape = tuple(map(len, labels))
            rows = np.reshape(array, (-1, *shape))
            for index in np.ndindex(*shape):
                ends = [str(names[i]) for names, i in zip(labels, index)]
                columns["_".join([name, *ends])] = rows[(slice(None), *index)]
        return columns
