"""The exceptions and their messages."""

import subprocess
import sys

import numpy as np
import pytest

import fivebar
from fivebar import Status, _native


def test_a_row_without_an_answer_says_why_and_leaves_the_others_alone(arm):
    answer = arm.inverse([(0.04, 0.2), (0.5, 0.0), (0.0, 0.01), (0.3, 0.1), (0.08, 0.02),
                          (np.nan, 0.2), (0.04, np.inf), (0.04, 0.2)])
    assert [Status(code).name for code in answer.status] == [
        "OK", "LEG1_TOO_FAR", "LEG1_TOO_NEAR", "LEG1_TOO_FAR", "LEG4_TOO_NEAR",
        "NOT_FINITE", "NOT_FINITE", "OK"]
    for name in ("theta1", "theta4", "theta2", "theta3"):
        assert np.array_equal(np.isfinite(getattr(answer, name)), answer.ok)
    assert np.array_equal(answer.assembly != 0, answer.ok)
    assert answer.theta[0].tolist() == answer.theta[-1].tolist()


def test_what_has_no_answer_goes_on_having_none(arm):
    there = arm.inverse([(0.04, 0.2), (0.5, 0.0)])
    back = arm.forward(there.theta, there.assembly)
    assert [Status(code).name for code in back.status] == ["OK", "NO_SIDE"]
    assert np.isnan(back.c[1]).all()


@pytest.mark.parametrize(("robot", "ask", "error", "index", "status"), [
    ("benchtop", lambda arm: arm.inverse([(0.04, 0.2), (0.5, 0.0), (0.0, 0.0)], strict=True),
     fivebar.UnreachableError, (1,), Status.LEG1_TOO_FAR),
    ("benchtop", lambda arm: arm.inverse([[(0.04, 0.2)], [(0.32, 0.0)]], strict=True),
     fivebar.UnreachableError, (1, 0), Status.LEG1_TOO_FAR),
    ("benchtop", lambda arm: arm.inverse((0.0, 0.0), strict=True),
     fivebar.UnreachableError, (), Status.LEG1_TOO_NEAR),
    ("benchtop", lambda arm: arm.inverse((-0.25, 0.0), strict=True),
     fivebar.UnreachableError, (), Status.LEG4_TOO_FAR),
    ("usp_2dof", lambda arm: arm.forward((np.pi, 0.0), strict=True),
     fivebar.UnreachableError, (), Status.ELBOWS_TOO_FAR),
    ("benchtop", lambda arm: arm.inverse((np.nan, 0.2), strict=True),
     fivebar.InvalidError, (), Status.NOT_FINITE),
    ("benchtop", lambda arm: arm.forward((2.0, 1.0), 0, strict=True),
     fivebar.InvalidError, (), Status.NO_SIDE),
    ("benchtop", lambda arm: arm.motion((2.0, 1.0), (1e200, 0.0), strict=True),
     fivebar.InvalidError, (), Status.TOO_LARGE),
    ("benchtop", lambda arm: arm.inverse_motion((0.26, 0.0), (0.1, 0.0), strict=True),
     fivebar.SingularError, (), Status.LEG1_SINGULAR),
    ("benchtop", lambda arm: arm.inverse_motion((-0.18, 0.0), (0.1, 0.0), strict=True),
     fivebar.SingularError, (), Status.LEG4_SINGULAR),
    ("duet", lambda arm: arm.forward(np.arccos((1 / 6, -1 / 6)), strict=True),
     fivebar.SingularError, (), Status.PARALLEL_SINGULAR),
])
def test_strict_questions_raise_the_first_problem(robot, ask, error, index, status):
    with pytest.raises(error) as raised:
        ask(fivebar.Arm.load(robot))
    assert type(raised.value) is error
    assert raised.value.index == index
    assert raised.value.kind == status.kind
    assert status.reason in str(raised.value)


def test_statuses_are_those_of_the_compiled_half():
    problems = _native.statuses()
    assert [code for code, _, _ in problems] == [status.value for status in Status if status]
    assert {kind for _, kind, _ in problems} == {"unreachable", "singular", "invalid"}
    assert Status.OK.kind == "ok" and Status.OK.reason == ""
    assert len({reason for _, _, reason in problems}) == len(problems)


@pytest.mark.parametrize("value", ["up", 2, [1, -2], ["left", "rihgt"], None, 0.5, "Left"])
def test_a_side_is_left_or_right(arm, value):
    with pytest.raises(ValueError, match="elbow1 must be 'left' or 'right'"):
        arm.inverse((0.04, 0.2), value if value is not None else [None])


@pytest.mark.parametrize(("points", "error"), [
    (0.5, ValueError),
    ([0.1, 0.2, 0.3], ValueError),
    (np.zeros((2, 3)), ValueError),
    ([["a", "b"]], TypeError),
    ([[1j, 0]], TypeError),
    ([[None, 0.1]], TypeError),
])
def test_points_are_pairs_of_real_numbers(arm, points, error):
    with pytest.raises(error, match="points must h"):
        arm.inverse(points)


def test_robot_files_are_refused_with_file_line_and_reason(tmp_path):
    with pytest.raises(fivebar.RobotError, match="no such robot.*benchtop"):
        fivebar.Arm.load("benchtopp")
    path = tmp_path / "mine.toml"
    with pytest.raises(FileNotFoundError):
        fivebar.Arm.from_file(path)
    path.write_text('name = "mine"\ngravity = [0.0, 0.0]\nbase = -1.0\nlink = []\n')
    with pytest.raises(fivebar.RobotError, match=r"mine\.toml, line [34]: ") as refused:
        fivebar.Arm.from_file(path)
    assert refused.value.file == str(path)
    assert refused.value.line in (3, 4)
    assert isinstance(refused.value, ValueError)


def test_a_robot_known_by_its_lengths_has_no_dynamics():
    haply = fivebar.Arm.load("haply")
    assert not haply.has_masses
    for ask in (lambda: haply.inverse_dynamics((2.0, 1.0)),
                lambda: haply.forward_dynamics((2.0, 1.0), (0, 0), (0, 0)),
                lambda: haply.simulate("G1 X1 F100")):
        with pytest.raises(fivebar.RobotError, match="has lengths only"):
            ask()


def test_every_built_in_robot_loads_and_closes():
    for name in fivebar.built_in():
        arm = fivebar.Arm.load(name)
        assert arm.name == name and name in repr(arm)
        pose = arm.forward(arm.home, strict=True)
        assert (int(pose.elbow1), int(pose.elbow4)) == (arm.elbow1, arm.elbow4)


@pytest.mark.parametrize("name", ["jax", "torch"])
def test_a_library_is_imported_only_when_asked_for_and_named_if_missing(name):
    program = f"""
import sys, fivebar
assert {name!r} not in sys.modules
sys.modules[{name!r}] = None # as if it were not installed
import fivebar.{name}
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert f"ImportError: fivebar.{name} needs {name}: pip install {name}" in done.stderr
