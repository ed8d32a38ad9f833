"""Set-points that a program streams. The arm's time passes only during the calls."""

import asyncio
from math import cos, sin, tau

import numpy as np
import pytest

import fivebar


def armed(robot="benchtop"):
    live = fivebar.connect("simulated", robot=robot, real_time=False)
    live.home()
    live.motors_on()
    return live


def circle(first, second, radius, points=400):
    """From (first, second) round and back, smoothly from rest to rest."""
    for k in range(points + 1):
        u = k / points
        a = tau * u * u * (3 - 2 * u)
        yield first + radius * sin(a), second + radius * (1 - cos(a))


@pytest.mark.parametrize("robot", ["benchtop", "benchtop_stepper", "leg", "classroom_servo"])
def test_every_kind_follows_a_circle_of_the_tip_and_of_the_joints(robot):
    with armed(robot) as live:
        x, y = live.state.tool
        with live.stream(rate=200) as stream:
            for point in circle(x, y, 2e-3):
                stream.tip(*point)
        assert live.state.state == "Armed"
        assert live.state.tool == pytest.approx((x, y), abs=2e-3)
        theta = live.state.theta
        with live.stream(rate=200, delay=0.03) as stream:
            for point in circle(*theta, 0.02):
                stream.joint(*point)
        assert live.state.theta == pytest.approx(theta, abs=2e-2)


def test_a_point_beyond_a_limit_ends_the_stream_with_the_reason_and_the_arm_rests():
    with armed() as live:
        x, y = live.state.tool
        with pytest.raises(fivebar.ControllerError, match="a limit keeps the arm from a point"):
            with live.stream() as stream:
                for k in range(2000):
                    stream.tip(x + 1e-7 * k * k, y)
        assert live.state.state == "Armed" and live.state.fault is None
        with pytest.raises(fivebar.ControllerError, match="move there first"):
            with live.stream() as stream:
                for _ in range(100):
                    stream.tip(0.0, 0.3)


def test_a_stream_that_limits_do_not_end_stays_within_them_and_comes_back():
    with armed() as live:
        x, y = live.state.tool
        with pytest.raises(fivebar.FivebarError, match='policy must be "stop" or "limit"'):
            live.stream(policy="go on")
        with live.stream(rate=200, policy="limit") as stream:
            assert stream.state is None
            for first, second in circle(x, y, 0.3, points=600):
                stream.tip(first, second)
            for _ in range(200):
                stream.tip(x, y)
        state = stream.state
        assert state.limited > 100 and state.late == 0 and state.phase == "Ended"
        assert state.points == 801 and 0.0 <= state.interval <= state.longest_interval
        assert live.state.tool == pytest.approx((x, y), abs=1e-3)
        assert state.theta == pytest.approx(live.state.theta, abs=1e-2)


def test_motors_that_give_a_torque_press_and_others_refuse():
    def press(live, force):
        """How far the arm gives way [rad], and the last state."""
        (x, y), before = live.state.tool, live.state.theta
        moved = 0.0
        with live.stream(rate=200) as stream:
            for k in range(200):
                stream.tip(x, y, force=(0.0, min(k / 10, 1.0) * force))
                if stream.state:
                    moved = max(moved, *(abs(a - b) for a, b in zip(stream.state.theta, before)))
        return moved, stream.state

    with armed() as live:
        # Nothing presses back, so the arm gives way until its loops hold against the force.
        assert press(live, 0.0)[0] < 1.2e-4
        assert 2e-4 < press(live, 4.0)[0] < 2e-3
        with pytest.raises(fivebar.FivebarError, match="force must be"):
            press(live, float("nan"))
    with armed("benchtop_stepper") as live:
        with pytest.raises(fivebar.ControllerError, match="these motors give none"):
            press(live, 4.0)


def test_arrays_are_followed():
    with armed() as live:
        x, y = live.state.tool
        time = np.linspace(0.0, 1.0, 201)
        turned = tau * time**2 * (3 - 2 * time)
        rate = tau * 6 * time * (1 - time)
        points = np.stack([x + 2e-3 * np.sin(turned), y + 2e-3 * (1 - np.cos(turned))], axis=1)
        rates = 2e-3 * np.stack([np.cos(turned) * rate, np.sin(turned) * rate], axis=1)
        for velocities in (None, rates):
            with live.stream(rate=200) as stream:
                stream.follow(points, velocities)
            assert live.state.tool == pytest.approx((x, y), abs=1e-3)
        theta = np.array(live.state.theta)
        with live.stream(rate=200) as stream:
            stream.follow(theta + 0.01 * np.sin(turned)[:, None] * (1 - time)[:, None], joints=True)
        assert live.state.theta == pytest.approx(theta, abs=1e-2)


def test_other_tasks_go_on_while_a_stream_waits():
    async def draw(live):
        x, y = live.state.tool
        async with live.stream(rate=200) as stream:
            for point in circle(x, y, 2e-3):
                await stream.tip(*point)
            seen = stream.state
        return seen, live.state.tool, (x, y)

    async def count():
        turns = 0
        while True:
            turns += 1
            await asyncio.sleep(0)

    async def both(live):
        other = asyncio.ensure_future(count())
        drawn = await draw(live)
        assert not other.done()
        other.cancel()
        return drawn

    with armed() as live:
        seen, there, start = asyncio.run(both(live))
        assert there == pytest.approx(start, abs=1e-3)
        assert seen.points == 401 and seen.phase == "Follows"


def test_what_is_no_point_is_refused_and_the_stream_ends_at_rest():
    with armed() as live:
        x, y = live.state.tool
        for wrong, why in [
            (lambda stream: stream.tip(x, float("nan")), "finite"),
            (lambda stream: stream.tip(x, y, 0.1), "two components"),
            (lambda stream: stream.joint(2.2, 0.9), "not both"),
        ]:
            with pytest.raises(fivebar.FivebarError, match=why):
                with live.stream() as stream:
                    stream.tip(x, y)
                    stream.tip(x, y)
                    wrong(stream)
            assert live.state.state == "Armed"
        with live.stream():
            pass
        with pytest.raises(fivebar.FivebarError, match="rate"):
            live.stream(rate=0.0)
