"""Lengths for a wanted work area."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._errors import FivebarError
from ._many import completed, cores
from ._shapes import Floats
from ._studies import Source, text_of

#: The columns of a candidate [m], and what is sought.
COLUMNS = ("l1", "l2", "l3", "l4", "base", "size", "x", "y", "score")


@dataclass(frozen=True)
class Design:
    """An arm for a wanted work area."""

    #: The figures of ``fivebar design --json``: best {link_lengths [5], size, link_sum,
    #: dexterity, place [x, y], torque_per_force, speed_per_rate, stiffness_per_drive, error},
    #: whole_millimetres (or lengths in stock, the same keys), front, sensitivity_per_m,
    #: evaluations, proved, unproved_at, whole_proved. Lengths in metres.
    figures: Dict[str, Any]
    #: The robot file with lengths in stock, for :meth:`fivebar.Arm.from_toml`.
    robot_toml: str


def design(
    specification: Source,
    *,
    seed: int = 1,
    client: Optional[Any] = None,
    out: Optional["os.PathLike[str]"] = None,
    candidates: Optional["os.PathLike[str]"] = None,
    progress: Optional[Callable[[int, int], None]] = None,
) -> Design:
    """Searches the lengths of an arm for a wanted work area, as ``fivebar design`` does.

    The specification is TOML, or a ``pathlib.Path`` of such a file, beside which its drawing is
    looked for; docs/design/synthesis.md describes its keys. The same seed gives the same answer.
    Raises :class:`fivebar.StudyError`. It takes seconds to minutes, on all cores.

    client: a ``dask.distributed.Client``, whose workers then do the searches: the answer has the
    same bits for any number of workers. out: a folder; each search that is done is kept in its
    ``searches.json``, as by ``fivebar design --out``, and a study that was stopped goes on from
    there; ``report.html``, ``best.toml`` and the front's robot files are as the command writes them. candidates: a folder for the candidates that meet the
    requirements, a parquet file for each search (needs ``pyarrow``); only searches that are done now
    write theirs. progress: receives the number of searches that are done, and of all.

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
    study = _native.Study(name, text, str(Path(name).parent), seed, None)
    found = _known(study, out)
    open_searches = [index for index, result in enumerate(found) if result is None]
    # Few searches share the cores; on a cluster each has one.
    threads = 1 if client is not None else max(cores() // max(len(open_searches), 1), 1)
    search = partial(_search, study, threads, candidates is not None)
    for index, (result, rows) in completed(search, open_searches, client):
        found[index] = result
        if rows is not None and candidates is not None:
            _write_candidates(study, index, rows, Path(candidates))
        if out is not None:
            _write_whole(Path(out) / "searches.json", study.kept(found))
        if progress is not None:
            progress(sum(result is not None for result in found), len(found))
    figures, files = study.finish([result for result in found if result is not None])
    if out is not None:
        # The page last: it stands beside files of its own study only.
        for name, text in reversed(files):
            _write_whole(Path(out) / name, text)
    return Design(json.loads(figures), dict(files)["best.toml"])


def dexterities(specification: Source, arms: ArrayLike) -> Floats:
    """The least 1/κ that arms have in the area of a specification: what :func:`design` examines, for one's own search.

    arms: rows of l1, l2, l3, l4, base, the area's size, and its place x, y [m], shape S + (8,). The
    answer, of shape S, is negative where an arm does not reach all of the area or changes its assembly
    mode. The specification's least dexterity and objective are not looked at.
    """
    name, text = text_of(specification)
    rows = np.require(np.asarray(arms, dtype=np.float64), None, ("C", "A"))
    if rows.ndim == 0 or rows.shape[-1] != 8:
        raise FivebarError(f"arms must have a last axis of length 8, not shape {rows.shape}")
    study = _native.Study(name, text, str(Path(name).parent), 1, None)
    return study.dexterities(rows).reshape(rows.shape[:-1])


def _search(
    study: _native.Study, threads: int, record: bool, index: int
) -> Tuple[str, Optional[Floats]]:
    return study.search(index, threads, record)


def _known(study: _native.Study, out: Optional["os.PathLike[str]"]) -> List[Optional[str]]:
    """The results that the folder has of this study."""
    file = None if out is None else Path(out) / "searches.json"
    known = None
    if file is not None and file.exists():
        known = study.known(file.read_text(encoding="utf-8"))
    return [None] * study.searches if known is None else known


def _write_whole(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f"{path.name}.new")
    with open(draft, "w", encoding="utf-8", newline="\n") as file:
        file.write(text)
    os.replace(draft, path)


def _write_candidates(study: _native.Study, index: int, rows: Floats, folder: Path) -> None:
    import pyarrow
    import pyarrow.parquet

    columns = dict(zip(COLUMNS, rows.reshape(-1, len(COLUMNS)).T))
    count = len(columns["score"])
    columns["search"] = np.full(count, index)
    columns["required_dexterity"] = np.full(count, study.required_dexterity(index))
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"search-{index:06}.parquet"
    draft = path.with_name(f"{path.name}.new")
    pyarrow.parquet.write_table(pyarrow.table(columns), draft)
    os.replace(draft, path)
