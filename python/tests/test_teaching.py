"""Motions that a hand teaches. Nobody leads a simulated arm, so it stays."""

import json

import numpy as np
import pytest

import fivebar


def taught(points):
    return fivebar.TaughtPath(
        json.dumps(
            {"taught_path": 1, "robot": "benchtop", "knot_s": 0.01, "tip_m": np.asarray(points).tolist()}
        )
    )


def armed(robot="benchtop"):
    live = fivebar.connect("simulated", robot=robot, real_time=False)
    live.home()
    live.motors_on()
    return live


def test_an_arm_that_nobody_leads_stays_and_is_held():
    with armed() as live:
        before = live.state.tool
        with pytest.raises(fivebar.FivebarError, match="not moved"):
            live.free(0.5)
        assert live.state.state == "Armed" and live.state.fault is None
        assert np.hypot(*np.subtract(live.state.tool, before)) < 5e-4


def test_the_places_where_the_tip_rested_are_told(tmp_path):
    corners = [(0.0, 0.15), (0.03, 0.15), (0.03, 0.18)]
    way = np.linspace(*corners[:2], 20), [corners[1]] * 60, np.linspace(*corners[1:], 20)
    path = taught(np.concatenate(way))
    assert path.rests() == pytest.approx(np.array(corners), abs=3e-4)
    assert len(path.rests(0.8)) == 2
    path.save(tmp_path / "places.csv")
    assert (tmp_path / "places.csv").read_text().splitlines()[0] == "x_m,y_m"


@pytest.mark.parametrize(
    "robot, why",
    [
        ("benchtop_stepper", "steppers and hobby servos"),
        ("classroom_servo", "steppers and hobby servos"),
        ("leg", "over a CAN bus"),
    ],
)
def test_other_drives_refuse_by_their_name(robot, why):
    with armed(robot) as live:
        with pytest.raises(fivebar.ControllerError, match=why):
            live.free(0.5)


@pytest.mark.parametrize("robot", ["benchtop", "benchtop_stepper", "leg", "classroom_servo"])
def test_every_kind_replays_a_path_at_any_speed_it_can_follow(robot, tmp_path):
    with armed(robot) as live:
        x, y = live.state.tool
        u = np.linspace(0.0, 1.0, 201)
        a = 2 * np.pi * u * u * (3 - 2 * u)
        path = taught(np.column_stack([x + 0.005 * np.sin(a), y + 0.005 * (np.cos(a) - 1)]))
        for speed in (1.0, 0.5):
            live.replay(path, speed=speed)
            assert np.hypot(live.state.tool[0] - x, live.state.tool[1] - y) < 1e-3
        with pytest.raises(fivebar.FivebarError, match="the speed must be"):
            live.replay(path, speed=6.0)
        for form in ("json", "gcode", "svg"):
            path.save(tmp_path / f"path.{form}")
        again = fivebar.TaughtPath.load(tmp_path / "path.json")
        assert np.abs(again.tip - path.tip).max() < 1e-7
        assert np.allclose(again.time, path.time)
        with pytest.raises(fivebar.FivebarError, match="json"):
            path.save(tmp_path / "path.txt")
