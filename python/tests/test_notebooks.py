"""Runs the notebooks: each of them ends with assertions on its figures."""

from pathlib import Path

import nbformat
import pytest

FOLDER = Path(__file__).resolve().parents[1] / "notebooks"
NAMES = ["computed_torque", "identification", "learning", "mpc"]


@pytest.mark.parametrize("name", NAMES)
def test_the_figures_of_a_notebook_hold(name):
    path = FOLDER / f"{name}.ipynb"
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert "assert " in cells[-1].source
    names = {"__name__": "__main__"}
    for number, cell in enumerate(cells, 1):
        exec(compile(cell.source, f"{path.name}, code cell {number}", "exec"), names)


def test_every_notebook_is_run_and_has_no_outputs():
    paths = sorted(FOLDER.glob("*.ipynb"))
    assert [path.stem for path in paths] == NAMES
    for path in paths:
        for cell in nbformat.read(path, as_version=4).cells:
            assert not cell.get("outputs") and cell.get("execution_count") is None, path.name
