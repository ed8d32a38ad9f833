"""What is studied of an arm: the answers of the program's commands."""

from __future__ import annotations

import json
import os
import warnings
from functools import partial
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _measured, _native, _plan, _studies
from ._errors import FivebarError
from ._many import completed
from ._measured import Found, Photo
from ._plan import Path, Plan
from ._shapes import Floats, pair, rows
from ._simulation import scenario_of

#: Blocks of 4096 samples that a worker of a cluster draws at a time: about a second of work.
BLOCKS = 16
#: The columns of tables of measurements.
POINTS = ("counts1", "counts4", "x", "y")
BARS = ("from1", "from4", "to1", "to4", "length")
HOLES = ("hole", "counts1", "counts4")
PHOTO = ("counts1", "counts4", "u", "v")
DISTANCES = ("from", "to", "length")
LOG = ("time_s", "theta1_rad", "theta4_rad", "current1_a or torque1_nm", "current4_a or torque4_nm")


class ArmStudies:
    """The studies of :class:`fivebar.Arm`."""

    _robot: _native.Robot

    def workspace(self, resolution: Optional[float] = None) -> Dict[str, Any]:
        """Areas and the largest clear rectangle of every branch: ``fivebar workspace --json``.

        resolution: side of a cell [m]; by default it suits the arm's size. The units are in the
        keys. Raises :class:`fivebar.RobotError`.

        >>> len(Arm.load("benchtop").workspace()["branches"])
        8
        """
        return _studies.workspace(self._robot, resolution)

    def margins(self) -> Dict[str, Any]:
        """The margins of the position loop over the workspace: ``fivebar margins --json``.

        Raises :class:`fivebar.RobotError` if the robot has no masses, no loop of the controller or
        no pose. Where the loop is unstable the margins are None.

        >>> Arm.load("benchtop").margins()["modulus_margin"] > 0.5
        True
        """
        return _studies.margins(self._robot)

    def plan(
        self,
        path: Path,
        *,
        limits: Optional[Mapping[str, Any]] = None,
        corners: Optional[str] = None,
        spline: bool = False,
        torque_share: float = 1.0,
        jerk: Optional[float] = None,
    ) -> Plan:
        """A time-optimal plan along a path: ``fivebar plan --path --json``.

        path: the JSON of a path file, as text, as a dictionary, or as the ``pathlib.Path`` of a
        file; docs/design/time-optimal.md describes it. Or points [m], shape (N, 2), with straight lines between them or, with
        spline=True, a smooth curve through them. Points need limits, by the names of a path file: ``torque``, ``speed``,
        ``acceleration`` of both joints, ``voltage``, ``tip_speed``, ``tip_acceleration``; an arm without masses has no limits of
        torque and voltage. corners: ``"smooth"`` (the default) or ``"stop"``. torque_share: share of the torque limits, in
        (0, 1]. jerk: the greatest joint jerk [rad/s³]. The path's own robot is not looked at.
        Raises :class:`fivebar.StudyError`.

        :meth:`fivebar.Plan.sample` gives the motion at any time.
        """
        if not 0.0 < torque_share <= 1.0:
            raise FivebarError(f"torque_share must be in (0, 1], not {torque_share!r}")
        if jerk is not None and not (jerk > 0.0 and np.isfinite(jerk)):
            raise FivebarError(f"jerk must be a positive finite number, not {jerk!r}")
        return _plan.plan(self._robot, path, limits, corners, spline, torque_share, jerk)

    def crossing(
        self, start: ArrayLike, end: ArrayLike, time: float, *, simulate: bool = False
    ) -> Dict[str, Any]:
        """A crossing of a singularity of type 2: ``fivebar plan --crossing --json``.

        start, end: of its line [m]; time: its duration [s]; simulate: follow it on the simulated arm,
        too. The robot file must allow crossings. Raises :class:`fivebar.StudyError`.
        """
        ends = [pair("start", start), pair("end", end)]
        return dict(json.loads(_native.crossing(self._robot, ends, time, simulate)))

    def clearance(
        self,
        radii: Sequence[ArrayLike],
        job: Union[None, str, "os.PathLike[str]"] = None,
        *,
        origin: Optional[ArrayLike] = None,
        scale: Optional[float] = None,
    ) -> Dict[str, Any]:
        """A job with worn joints beside the new arm: ``fivebar clearance --json``.

        radii: for each run the radial clearances of the joints A to E [m], or one for all five. job,
        origin, scale: as in :meth:`fivebar.Arm.simulate`; by default a petal of two arcs. Raises
        :class:`fivebar.JobError`, :class:`fivebar.StudyError`.
        """
        worn = [np.broadcast_to(np.asarray(radius, dtype=float), 5).tolist() for radius in radii]
        if not np.all(np.isfinite(worn)) or np.min(worn, initial=0.0) < 0.0:
            raise FivebarError("radii must be finite lengths [m], 0 or more")
        place = None if origin is None else pair("origin", origin)
        scenario = (
            _native.Scenario.petal(self._robot) if job is None else scenario_of(self._robot, job)
        )
        return dict(json.loads(_native.clearance(scenario, worn, place, scale)))

    def photo_marks(
        self,
        job: _studies.Source,
        *,
        origin: Optional[ArrayLike] = None,
        scale: float = 1.0,
        turn: float = 0.0,
    ) -> Tuple[str, Dict[str, Any]]:
        """A job that draws four marks beside a drawing, and their places: ``fivebar photo --draw-marks --json``.

        Run it with the origin (0, 0). Arguments as for :meth:`photo`.
        """
        text, places = _native.photo_marks(self._robot, _placed(job, origin, scale, turn))
        return text, json.loads(places)

    def photo(
        self,
        job: _studies.Source,
        picture: "os.PathLike[str]",
        marks: _studies.Source,
        *,
        origin: Optional[ArrayLike] = None,
        scale: float = 1.0,
        turn: float = 0.0,
        distances: Optional[ArrayLike] = None,
        lens: Optional[float] = None,
        window: float = 1.5e-3,
    ) -> Photo:
        """A photograph or a scan of a finished drawing beside its job: ``fivebar photo --json``.

        job, marks: G-code, or the ``pathlib.Path`` of a file; marks as :meth:`photo_marks` gives it.
        picture: PNG or JPEG, not cropped. origin [m], scale, turn [rad]: where the job was drawn.
        distances: measured between the marks' centres, rows of two marks (1 to 4) and a length [m].
        lens: its distortion, 0 for a scanner; by default found from the strokes. window: how far
        beside its place ink is searched [m]. Raises :class:`fivebar.StudyError`.
        """
        measured = None if distances is None else rows("distances", distances, DISTANCES)
        _, text = _studies.text_of(marks)
        placed = _placed(job, origin, scale, turn)
        figures, points = _native.photo(
            self._robot, placed, os.fspath(picture), text, measured, lens, window
        )
        return Photo(json.loads(figures), points)

    def accuracy(
        self,
        at: ArrayLike,
        *,
        velocity: ArrayLike = (0.0, 0.0),
        acceleration: ArrayLike = (0.0, 0.0),
        force: ArrayLike = (0.0, 0.0),
        samples: int = 100_000,
        seed: int = 1,
        client: Optional[Any] = None,
        progress: Optional[Callable[[int, int], None]] = None,
    ) -> Dict[str, Any]:
        """The effect of the robot's tolerances at one position: ``fivebar accuracy --at --json``.

        at, velocity, acceleration: of C [m, m/s, m/s²]; force on C [N]; samples: of the Monte Carlo
        check of each figure, 2 or more. client: a ``dask.distributed.Client``, whose workers then draw
        the samples: the answer has the same bits; progress then receives the number of parts that are
        done, and of all. Raises :class:`fivebar.StudyError`.

        >>> found = Arm.load("benchtop").accuracy([0.04, 0.2], samples=1000)
        >>> 1e-6 < found["position_sd_m"][0] < 1e-3
        True
        """
        if samples < 2:
            raise FivebarError(f"samples must be 2 or more, not {samples!r}")
        pairs = {"at": at, "velocity": velocity, "acceleration": acceleration, "force": force}
        state = [pair(name, value) for name, value in pairs.items()]
        _warn(self._robot)
        parts = None
        if client is not None:
            parts = _parts(self._robot, state, samples, seed, client, progress)
        return dict(json.loads(_native.accuracy(self._robot, state, samples, seed, parts)))

    def accuracy_map(
        self,
        *,
        region: Optional[Sequence[float]] = None,
        force: ArrayLike = (0.0, 0.0),
        wanted: Optional[float] = None,
        classes: Optional["os.PathLike[str]"] = None,
    ) -> Dict[str, Any]:
        """The same over the workspace: ``fivebar accuracy --map --json``.

        region: x0, y0, x1, y1 of a rectangle [m]; by default the whole workspace. force on C [N].
        With wanted, the cheapest of the tolerances in the file ``classes`` that keep the radial
        standard deviation within wanted [m] everywhere.
        """
        if (wanted is None) != (classes is None):
            raise FivebarError("give wanted and classes together")
        corners = None if region is None else [float(number) for number in region]
        limit = None if wanted is None or classes is None else (wanted, os.fspath(classes))
        if limit is None:
            _warn(self._robot)
        found = _native.accuracy_map_of(self._robot, corners, pair("force", force), limit)
        return dict(json.loads(found))

    def accuracy_along(
        self,
        job: _studies.Source,
        *,
        origin: Optional[ArrayLike] = None,
        scale: float = 1.0,
        force: ArrayLike = (0.0, 0.0),
    ) -> Dict[str, Any]:
        """The same along the path of a job: ``fivebar accuracy --path --json``.

        job: G-code, or the ``pathlib.Path`` of a file; origin and scale as in
        :meth:`fivebar.Arm.simulate`. force on C [N]. Raises :class:`fivebar.JobError`,
        :class:`fivebar.StudyError`.
        """
        name, text = _studies.text_of(job)
        place = None if origin is None else pair("origin", origin)
        strength = pair("force", force)
        _warn(self._robot)
        found = _native.accuracy_along(self._robot, name, text, place, scale, strength)
        return dict(json.loads(found))

    def export(self, format: str) -> str:
        """The arm for another program, as ``fivebar export``: ``"mjcf"`` (MuJoCo), ``"urdf"`` or ``"dot"`` (Graphviz).

        >>> Arm.load("benchtop").export("dot").startswith("graph")
        True
        """
        text = _native.export(self._robot, format)
        if text is None:
            raise FivebarError(f"format must be 'mjcf', 'urdf' or 'dot', not {format!r}")
        return text

    def calibrate(
        self,
        points: Optional[ArrayLike] = None,
        *,
        bars: Optional[ArrayLike] = None,
        holes: Optional[ArrayLike] = None,
        photos: Sequence[ArrayLike] = (),
        sigma: float = 20e-6,
        bar_sigma: float = 20e-6,
        hole_sigma: float = 10e-6,
        photo_sigma: float = 50e-6,
        plain: bool = False,
    ) -> Found:
        """Lengths and joint offsets from what was measured: ``fivebar calibrate --json``.

        Tables with a row for each measurement. points: counts1, counts4, x, y of holes on a plate
        [counts, m]; bars: from1, from4, to1, to4, length [counts, m]; holes: number, counts1,
        counts4 of holes at unknown places; photos: for each photograph counts1, counts4, u, v
        [counts, pixels]. Standard deviations [m]: sigma of a hole on the plate, bar_sigma,
        hole_sigma, photo_sigma. plain: least squares in place of Huber's loss.
        Raises :class:`fivebar.StudyError`.
        """
        sigmas = [sigma, bar_sigma, hole_sigma, photo_sigma]
        if not all(np.isfinite(number) and number > 0.0 for number in sigmas):
            raise FivebarError("standard deviations must be positive finite lengths [m]")
        answer = _native.calibrate(
            self._robot,
            rows("points", points, POINTS),
            rows("bars", bars, BARS),
            rows("holes", holes, HOLES),
            [rows("photos", photo, PHOTO) for photo in photos],
            sigmas,
            plain,
        )
        return _measured.found(answer)

    def calibration_poses(self, count: int, *, sigma: float = 20e-6) -> Dict[str, Any]:
        """Holes that determine the arm best: ``fivebar calibrate --propose --json``.

        count: 5 to 400; sigma: the standard deviation of a hole [m].

        >>> len(Arm.load("benchtop").calibration_poses(6)["poses"])
        6
        """
        if not 5 <= count <= 400:
            raise FivebarError(f"count must be 5 to 400, not {count!r}")
        return dict(json.loads(_native.calibration_poses(self._robot, count, sigma)))

    def identify(self, log: ArrayLike, *, validate: Optional[ArrayLike] = None) -> Found:
        """Base parameters and friction from a log of motion: ``fivebar identify --log --json``.

        log: a row for every tick with time [s], θ1, θ4 [rad], current 1 and 4 [A]; of drives on a
        CAN bus the torques that they are told in the place of the currents [N·m]. validate: a
        second log, of another trajectory, whose torques are predicted. Raises
        :class:`fivebar.StudyError`, or :class:`fivebar.RobotError` for an arm without motors.
        """
        second = None if validate is None else rows("validate", validate, LOG)
        return _measured.found(_native.identify(self._robot, rows("log", log, LOG), second))

    def identify_payload(self, log: ArrayLike) -> Found:
        """The payload alone, with the masses of the robot: ``fivebar identify --log --payload --json``.

        log: as in :meth:`identify`; any quick motion will do.
        """
        return _measured.found(_native.identify_payload(self._robot, rows("log", log, LOG)))

    def excitations(self) -> Dict[str, Any]:
        """Two trajectories that excite the arm within its limits: ``fivebar identify --propose --json``."""
        return dict(json.loads(_native.excitations(self._robot)))

    def simulated_log(self, *, second: bool = False) -> Floats:
        """A log for :meth:`identify` of the simulated arm: ``fivebar identify --simulate``.

        Ten periods of the first or the second of the :meth:`excitations`, a row for every tick.
        """
        return np.array(_native.simulated_log(self._robot, second))


def _warn(robot: _native.Robot) -> None:
    """Warns where all deviations are 0 because the robot has no tolerances."""
    if robot.without_tolerance is not None:
        warnings.warn(robot.without_tolerance, stacklevel=3)


def _parts(
    robot: _native.Robot,
    state: List[List[float]],
    samples: int,
    seed: int,
    client: Any,
    progress: Optional[Callable[[int, int], None]],
) -> List[Floats]:
    """The sums of all blocks of the samples, drawn by a cluster."""
    count = -(-_native.accuracy_blocks(samples) // BLOCKS)
    parts: Dict[int, Floats] = {}
    draw = partial(_part, robot.file, robot.text, state, samples, seed)
    for index, part in completed(draw, range(count), client):
        # What comes over the network may be misaligned.
        parts[index] = np.require(part, None, ("C", "A"))
        if progress is not None:
            progress(len(parts), count)
    return [parts[index] for index in range(count)]


def _part(
    file: str, text: str, state: List[List[float]], samples: int, seed: int, index: int
) -> Floats:
    robot = _native.Robot.parse(file, text)
    blocks = [index * BLOCKS, (index + 1) * BLOCKS]
    return _native.accuracy_part(robot, state, samples, seed, blocks)


def _placed(
    job: _studies.Source, origin: Optional[ArrayLike], scale: float, turn: float
) -> Tuple[str, str, Optional[List[float]], float, float]:
    name, text = _studies.text_of(job)
    place = None if origin is None else pair("origin", origin)
    return name, text, place, scale, turn
