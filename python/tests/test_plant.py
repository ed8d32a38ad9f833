"""The arm step by step."""

from pathlib import Path

import numpy as np
import pytest

import fivebar

ROBOT = Path(__file__).resolve().parents[2] / "host/files/robots/benchtop.toml"


def test_it_moves_as_forward_dynamics_say(arm):
    """By RK4 over the package's own dynamics, which have no friction."""
    text = "\n".join(line for line in ROBOT.read_text().splitlines() if "friction" not in line)
    smooth = fivebar.Arm.from_toml(text)
    torque = np.array([0.08, -0.05])
    plant = fivebar.Plant(smooth, (2.2, 0.9))
    state = np.array([2.2, 0.9, 0.0, 0.0])

    def rate(x):
        found = smooth.forward_dynamics(x[:2], x[2:], torque)
        return np.concatenate([x[2:], found.alpha])

    h = 2e-4
    for _ in range(500):
        k1 = rate(state)
        k2 = rate(state + 0.5 * h * k1)
        k3 = rate(state + 0.5 * h * k2)
        k4 = rate(state + h * k3)
        state = state + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
        plant.step(torque, h)
    assert np.allclose(plant.theta, state[:2], atol=1e-7) and abs(state[2]) > 0.5
    assert np.allclose(plant.omega, state[2:], atol=1e-6)
    assert np.allclose(plant.tool, smooth.forward(state[:2]).c, atol=1e-7)
    assert plant.time == pytest.approx(0.1)
    rough = fivebar.Plant(arm, (2.2, 0.9))
    for _ in range(100):
        rough.step(torque, 1e-3)
    assert abs(rough.omega[0]) < abs(state[2])


def test_a_mismatch_and_a_force_change_the_motion(arm):
    def after(force=(0.0, 0.0), **options):
        plant = fivebar.Plant(arm, **options)
        for _ in range(50):
            plant.step((-0.05, 0.02), 1e-3, force=force)
        return plant.theta

    plain = after()
    assert not np.allclose(plain, after(mismatch={"payload": 0.5}), atol=1e-5)
    assert not np.allclose(plain, after(force=(1.0, 0.0)), atol=1e-5)
    assert np.array_equal(plain, after(theta=None, assembly=arm.assembly))


def test_what_cannot_be_stepped_is_refused(arm):
    plant = fivebar.Plant(arm)
    for torque, dt in [((0.0, np.nan), 1e-3), ((0.0, 0.0), 0.0), ((0.0, 0.0), 2.0), (0.0, 1e-3)]:
        with pytest.raises((fivebar.FivebarError, ValueError)):
            plant.step(torque, dt)
    with pytest.raises(fivebar.UnreachableError):
        fivebar.Plant(fivebar.Arm.load("usp_2dof"), (np.pi, 0.0))
    with pytest.raises(fivebar.RobotError):
        fivebar.Plant(fivebar.Arm(l1=0.1, l2=0.16, base=0.08))
    with pytest.raises(ValueError, match="no such figure"):
        fivebar.Plant(arm, mismatch={"mass": 1.0})


@pytest.mark.parametrize("dt", [0.2, 0.05, 2.5e-3])
def test_a_long_step_is_integrated_in_steps_of_a_millisecond(arm, dt):
    torque = (-0.05, 0.01)
    once, often, finely = (fivebar.Plant(arm) for _ in range(3))
    parts = int(np.ceil(dt / 1e-3))
    once.step(torque, dt)
    for _ in range(parts):
        often.step(torque, dt / parts)
    assert np.array_equal(once.theta, often.theta) and np.array_equal(once.omega, often.omega)
    for _ in range(10 * parts):
        finely.step(torque, 0.1 * dt / parts)
    assert np.abs(once.theta - finely.theta).max() < 1e-6
    assert once.time == pytest.approx(dt, rel=1e-12)


@pytest.mark.parametrize(("torque", "force", "dt"), [
    ((1e308, 0.0), (0.0, 0.0), 1e-3),
    ((0.0, -1e308), (0.0, 0.0), 1.0),
    ((0.0, 0.0), (1e308, 1e308), 1e-6),
    ((1e4, 0.0), (0.0, 0.0), 1e-3),
    ((1e9, 0.0), (0.0, 0.0), 1e-3),
])
def test_a_motion_that_is_not_finite_or_too_fast_is_refused_and_leaves_the_arm_as_it_was(
        arm, torque, force, dt):
    plant = fivebar.Plant(arm)
    for _ in range(20):
        plant.step((-0.05, 0.0), 1e-3)
    twin = fivebar.Plant(arm)
    for _ in range(20):
        twin.step((-0.05, 0.0), 1e-3)
    before = (plant.theta, plant.omega, plant.tool, plant.time)
    with pytest.raises(fivebar.RunError, match="rad"):
        plant.step(torque, dt, force=force)
    after = (plant.theta, plant.omega, plant.tool, plant.time)
    assert all(np.array_equal(a, b) for a, b in zip(before, after))
    # It goes on as if nothing had been asked.
    plant.step((-0.05, 0.0), 1e-3)
    twin.step((-0.05, 0.0), 1e-3)
    assert np.array_equal(plant.theta, twin.theta) and np.isfinite(plant.omega).all()
