"""Springs, walls and guides at the tip of the simulated arm. The arm's time passes only during the calls."""

import re

import numpy as np
import pytest

import fivebar
from fivebar import Fixture

#: How far from a spring's end the tip may rest at 60 N/m [m]. The controller leaves 0.3 of the dry friction of 9 mN·m, and the
#: error of the current sensors' zero makes 1.5 mN·m; the lever is 48 mm.
FRICTION = 1.5e-3


@pytest.fixture(scope="module")
def live():
    with fivebar.connect("simulated", robot="benchtop", real_time=False) as live:
        live.home()
        live.motors_on()
        yield live


def rest(live, end, stiffness, damping=0.02, fixtures=(), force=(0.0, 0.0), rate=200.0):
    """Where the tip is when the spring's end has been there for 2 s [m]."""
    with live.impedance(stiffness, damping, fixtures, rate=rate) as spring:
        for _ in range(int(2 * rate)):
            spring.tip(*end, force=force)
        tool = live.state.tool
    return np.array(tool)


def refusal(live, *impedance, **options):
    """The words with which a stream with an impedance is refused."""
    with pytest.raises(fivebar.ControllerError) as refused:
        rest(live, live.state.tool, *impedance, **options)
    assert live.state.state == "Armed" and live.state.fault is None
    return str(refused.value)


@pytest.mark.parametrize("step", [(0.008, 0.0), (0.0, 0.008), (-0.006, -0.006)])
def test_a_spring_pulls_the_tip_as_far_as_its_end_moves(live, step):
    start = np.array(live.state.tool)
    there = rest(live, start + step, 60.0) - start
    assert there == pytest.approx(step, abs=FRICTION)
    back = rest(live, start, 60.0)
    assert back == pytest.approx(start, abs=FRICTION)


def test_a_spring_changes_while_it_is_felt(live):
    start = np.array(live.state.tool)
    end = start + (0.008, 0.0)
    with live.impedance(60.0, 0.02) as spring:
        spring.tip(*end)
        spring.change((0.0, 0.0, 60.0), 0.02)
        for _ in range(40):
            spring.tip(*start)
        spring.change(60.0, (0.02, 0.0, 0.02))
        for _ in range(400):
            spring.tip(*end)
        assert np.array(live.state.tool) == pytest.approx(end, abs=FRICTION)
        with pytest.raises(fivebar.ControllerError, match="springs together must have at most"):
            spring.change(1e6)
            spring.tip(*end)
    rest(live, start, 60.0)


@pytest.mark.parametrize("rate", [60.0, 200.0, 500.0])
def test_each_point_is_a_period_after_the_one_before(live, rate):
    with live.impedance(60.0, 0.02, rate=rate) as spring:
        spring.tip(*live.state.tool)
        begun = live.state.time
        for _ in range(800):
            spring.tip(*live.state.tool)
        # The program sees the time in steps of 10 ms, and a period at most after the call.
        assert live.state.time - begun == pytest.approx(800 / rate, abs=1 / rate + 0.02)


@pytest.mark.parametrize("stiffness", [40.0, 80.0])
def test_a_force_moves_the_tip_by_the_force_over_the_stiffness(live, stiffness):
    start = np.array(live.state.tool)
    # A constant error of the torque cancels.
    there, back = (rest(live, start, stiffness, force=(0.0, force)) for force in (0.4, -0.4))
    assert (there - back) / 2 == pytest.approx((0.0, 0.4 / stiffness), abs=3e-4)
    rest(live, start, 60.0)


def test_a_matrix_is_stiff_along_one_direction_alone(live):
    start = np.array(live.state.tool)
    # 80 N/m along (1, 1), none across it.
    moved = rest(live, start + (0.008, 0.0), (40.0, 40.0, 40.0)) - start
    assert moved @ (1, 1) / np.sqrt(2) == pytest.approx(0.008 / np.sqrt(2), abs=FRICTION)
    assert moved @ (1, -1) / np.sqrt(2) == pytest.approx(0.0, abs=FRICTION)
    rest(live, start, 60.0)


def test_a_wall_stops_a_spring_where_both_are_as_strong(live):
    start = np.array(live.state.tool)
    wall = Fixture.half_plane(start + (0.004, 0.0), (-1.0, 0.0), 60.0)
    moved = rest(live, start + (0.010, 0.0), 60.0, fixtures=[wall]) - start
    assert moved == pytest.approx((0.007, 0.0), abs=FRICTION)
    # It never pulls.
    back = rest(live, start, 60.0, fixtures=[wall])
    assert back == pytest.approx(start, abs=FRICTION)


@pytest.mark.parametrize(
    "shape",
    [
        lambda x, y: Fixture.inside((x, y), 0.004, 60.0),
        lambda x, y: Fixture.outside((x + 0.024, y), 0.02, 60.0),
        lambda x, y: Fixture.box((x, y), (0.02, 0.004), 60.0, axis=(0.0, 2.0)),
        lambda x, y: Fixture.line((x + 0.004, y), (5.0, 0.0), 60.0),
        lambda x, y: Fixture.circle((x + 0.024, y), 0.02, 60.0),
    ],
)
def test_other_walls_and_guides_stop_it_there_too(live, shape):
    start = np.array(live.state.tool)
    moved = rest(live, start + (0.010, 0.0), 60.0, fixtures=[shape(*start)]) - start
    assert moved == pytest.approx((0.007, 0.0), abs=FRICTION)
    rest(live, start, 60.0)


@pytest.mark.parametrize(
    "name, wall",
    [
        ("point", lambda: Fixture.half_plane((np.nan, 0.1), (0.0, 1.0), 50.0)),
        ("normal", lambda: Fixture.line((0.0, 0.1), (0.0, np.inf), 50.0)),
        ("normal", lambda: Fixture.half_plane((0.0, 0.1), (0.0, 1.0, 0.0), 50.0)),
        ("half", lambda: Fixture.box((0.0, 0.1), (0.1, np.nan), 50.0)),
        ("axis", lambda: Fixture.box((0.0, 0.1), (0.1, 0.1), 50.0, axis=(np.inf, 0.0))),
        ("centre", lambda: Fixture.circle((0.0, np.inf), 0.1, 50.0)),
    ],
)
def test_points_and_directions_that_are_none_are_refused_by_their_name(name, wall):
    with pytest.raises(fivebar.FivebarError, match=f"^{name} must"):
        wall()


@pytest.mark.parametrize(
    "wall",
    [
        Fixture.inside((0.0, 0.1), np.nan, 50.0),
        Fixture.outside((0.0, 0.1), 0.0, 50.0),
        Fixture.half_plane((0.0, 0.1), (0.0, 0.0), 50.0),
        Fixture.box((0.0, 0.1), (0.1, -0.1), 50.0),
        Fixture.line((0.0, 0.1), (0.0, 1.0), -50.0),
        Fixture.circle((0.0, 0.1), 0.1, 50.0, np.nan),
    ],
)
def test_a_controller_refuses_a_wall_without_meaning_by_its_number(live, wall):
    sound = Fixture.inside((0.0, 0.1), 0.2, 50.0)
    assert "wall or guide 1 has" in refusal(live, 50.0, 0.02, [sound, wall])


def test_a_refused_wall_does_not_stay(live):
    start = np.array(live.state.tool)
    wall = Fixture.half_plane(start + (0.002, 0.0), (-1.0, 0.0), 60.0)
    refusal(live, 50.0, 0.02, [wall, Fixture.outside(start, 0.0, 50.0)])
    moved = rest(live, start + (0.008, 0.0), 60.0) - start
    assert moved == pytest.approx((0.008, 0.0), abs=FRICTION)
    rest(live, start, 60.0)


def test_more_stiffness_and_damping_than_the_arm_renders_is_refused_with_the_greatest(live):
    said = refusal(live, 5000.0)
    greatest = float(re.search(r"at most ([0-9.]+) N/m", said).group(1))
    assert 60.0 < greatest < 5000.0
    refusal(live, 1.01 * greatest)
    rest(live, live.state.tool, 0.99 * greatest, damping=0.0)
    # Walls count as well.
    wall = Fixture.half_plane(live.state.tool, (1.0, 0.0), 0.5 * greatest)
    refusal(live, 0.6 * greatest, 0.0, [wall])
    most = float(re.search(r"less than ([0-9.]+) N·s/m", refusal(live, 0.0, 1e3)).group(1))
    refusal(live, 0.0, 1.01 * most)
    rest(live, live.state.tool, 0.0, damping=0.99 * most)


@pytest.mark.parametrize(
    "stiffness, damping",
    [(np.nan, 0.0), (-1.0, 0.0), ((10.0, 20.0, 10.0), 0.0), (10.0, -1.0), (10.0, np.inf)],
)
def test_a_matrix_that_would_push_is_refused(live, stiffness, damping):
    assert "the stiffness or the damping is" in refusal(live, stiffness, damping)


@pytest.mark.parametrize(
    "robot, why",
    [
        ("benchtop_stepper", "steppers and hobby servos"),
        ("classroom_servo", "steppers and hobby servos"),
        ("leg", "over a CAN bus"),
    ],
)
def test_other_drives_refuse_by_their_name(robot, why):
    with fivebar.connect("simulated", robot=robot, real_time=False) as other:
        other.home()
        other.motors_on()
        before = other.state.tool
        assert why in refusal(other, 50.0)
        assert other.state.tool == pytest.approx(before, abs=1e-3)


def test_what_is_given_wrongly_is_refused_by_its_name_and_the_arm_stays_held(live):
    start = live.state.tool
    wall = Fixture.inside((0.0, 0.1), 0.2, 50.0)
    for begin, why in [
        (lambda: live.impedance((50.0, 0.0)), "stiffness must be one number, or three"),
        (lambda: live.impedance(50.0, (1.0, 2.0)), "damping must be one number, or three"),
        (lambda: live.impedance(50.0, rate=50.0), "rate must be more than 50"),
        (lambda: live.impedance(50.0, 0.0, wall), "fixtures must be a sequence"),
        (lambda: live.impedance(50.0, 0.0, 4 * [wall]), "at most 3 walls and guides, not 4"),
    ]:
        with pytest.raises(fivebar.FivebarError, match=why):
            begin()
    for point, why in [
        (lambda spring: spring.tip(np.nan, 0.1), "position must be"),
        (lambda spring: spring.tip(*start, 0.0, np.inf), "velocity must be"),
        (lambda spring: spring.tip(*start, force=(1.0,)), "force must"),
    ]:
        with pytest.raises(fivebar.FivebarError, match=why):
            with live.impedance(50.0, 0.02) as spring:
                spring.tip(*start)
                point(spring)
        assert live.state.state == "Armed"


def test_motors_that_are_off_render_nothing():
    with fivebar.connect("simulated", robot="benchtop", real_time=False) as off:
        off.home()
        with pytest.raises(fivebar.ControllerError, match="motors"):
            off.impedance(50.0)
