"""An arm whose tool is beside C: which point is meant is said, and both agree."""

import numpy as np
import pytest

import fivebar


def with_tool(arm, offset):
    return fivebar.Arm.from_toml(f"{arm.toml}\n[tool]\noffset = {list(offset)}\n")


@pytest.fixture(scope="module", params=[(0.03, 0.01), (0.0, 0.025), (-0.02, -0.015)])
def pen(arm, request):
    return with_tool(arm, request.param)


POINTS = [(0.05, 0.19), (0.03, 0.2), (0.06, 0.17)]


@pytest.mark.parametrize("ask", [
    lambda arm: arm.inverse(POINTS),
    lambda arm: arm.inverse_motion(POINTS, (0.1, 0.0)),
    lambda arm: arm.jacobian(arm.home),
    lambda arm: arm.inverse(POINTS, point="pen"),
])
def test_a_point_that_may_be_either_is_refused(pen, ask):
    with pytest.raises(fivebar.FivebarError, match="'tool'"):
        ask(pen)


def test_the_tool_is_where_it_was_asked(pen):
    found = pen.inverse(POINTS, point="tool", strict=True)
    back = pen.forward(found.theta, found.assembly, strict=True)
    assert np.abs(back.tool - POINTS).max() < 1e-14
    offset = np.hypot(*pen.tool_offset)
    assert np.allclose(np.hypot(*(back.c - back.tool).T), offset, atol=1e-15)
    # The simulated arm, which has its own equations, has its tool there.
    for point, theta, side in zip(POINTS, found.theta, found.assembly):
        assert np.abs(fivebar.Plant(pen, theta, assembly=int(side)).tool - point).max() < 1e-12
    at_c = pen.inverse(POINTS, point="c")
    assert np.abs(at_c.theta - found.theta).max() > 0.05
    assert np.abs(pen.forward(at_c.theta, at_c.assembly).c - POINTS).max() < 1e-14


def test_the_motion_of_the_tool_goes_there_and_back(pen):
    velocity, acceleration = (0.3, -0.2), (2.0, 5.0)
    found = pen.inverse_motion(POINTS, velocity, acceleration, point="tool", strict=True)
    back = pen.motion(found.theta, found.omega, found.alpha, found.assembly, strict=True)
    assert np.abs(back.tool - POINTS).max() < 1e-13
    assert np.abs(back.tool_velocity - velocity).max() < 1e-12
    assert np.abs(back.tool_acceleration - acceleration).max() < 1e-10
    jacobian = pen.jacobian(found.theta, found.assembly, point="tool")
    moved = np.einsum("nij,nj->ni", jacobian, found.omega)
    assert np.abs(moved - velocity).max() < 1e-12
    # Against differences of positions.
    step = 1e-6
    ahead = pen.forward(found.theta + step * found.omega, found.assembly).tool
    behind = pen.forward(found.theta - step * found.omega, found.assembly).tool
    assert np.abs((ahead - behind) / (2 * step) - velocity).max() < 1e-7


def test_without_an_offset_both_points_are_the_same(arm):
    plain = arm.inverse(POINTS)
    for point in ("c", "tool"):
        found = arm.inverse(POINTS, point=point)
        assert np.allclose(found.theta, plain.theta, atol=1e-14)
    there = arm.forward(plain.theta, plain.assembly)
    assert np.array_equal(there.tool, there.c)


def test_the_accuracy_along_a_path_of_the_tool_is_refused(pen):
    with pytest.raises(fivebar.StudyError, match="beside C"):
        pen.accuracy_along("G1 X10 F3000")
