"""States of the arm, many arms at once, and the laboratory."""

import copy
import doctest
import pickle

import numpy as np
import pytest

import fivebar
from fivebar import sim

DIFFERS = {"payload": 0.05, "stiction": [0.02, 0.01], "torque_ripple": [0.02, 0.0]}


def moved(plant, steps=40, torque=(0.05, -0.03)):
    for _ in range(steps):
        plant.step(torque, 1e-3)
    return plant


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda p: pickle.loads(pickle.dumps(p))])
def test_a_plant_that_is_copied_or_pickled_moves_on_with_the_same_bits(arm, again):
    plant = moved(fivebar.Plant(arm, (2.2, 0.9), mismatch=DIFFERS))
    twin = again(plant)
    assert twin.state == plant.state and twin.time == plant.time
    moved(plant, torque=(-0.02, 0.04))
    assert twin.state != plant.state
    assert moved(twin, torque=(-0.02, 0.04)).state == plant.state


def test_a_state_is_read_set_copied_and_pickled(arm):
    plant = moved(fivebar.Plant(arm, (2.2, 0.9)))
    state = plant.state
    assert np.array_equal(state.theta, plant.theta) and np.array_equal(state.omega, plant.omega)
    assert state.time == plant.time == pytest.approx(0.04)
    assert pickle.loads(pickle.dumps(state)) == state == copy.copy(state)
    assert len({state, plant.state}) == 1
    with pytest.raises(ValueError):
        state.numbers[0] = 0.0
    end = moved(plant).state
    plant.state = state
    assert moved(plant).state == end
    for wrong in (state.numbers[:30], np.full(31, np.nan)):
        with pytest.raises(fivebar.FivebarError, match="31 finite"):
            fivebar.PlantState(wrong)


def test_it_begins_with_a_velocity(arm):
    plant = fivebar.Plant(arm, (2.2, 0.9), omega=(3.0, -2.0))
    assert np.allclose(plant.omega, (3.0, -2.0), atol=1e-12)
    assert np.allclose(plant.theta, (2.2, 0.9), atol=1e-12)
    moving = arm.motion((2.2, 0.9), (3.0, -2.0))
    before = plant.tool
    plant.step((0.0, 0.0), 1e-6)
    assert np.allclose((plant.tool - before) / 1e-6, moving.tool_velocity, atol=1e-4)


def test_a_tolerance_makes_the_motion_more_exact(arm):
    # Without friction, whose own rate would make the steps short.
    smooth = fivebar.Arm.from_toml("\n".join(x for x in arm.toml.splitlines() if "friction" not in x))

    def end(dt, **options):
        plant = fivebar.Plant(smooth, (2.2, 0.9), omega=(12.0, 12.0), **options)
        for _ in range(round(0.05 / dt)):
            plant.step((0.1, 0.1), dt)
        return plant.theta

    exact = end(2e-5)
    plain, fine = (np.abs(end(1e-3, **o) - exact).max() for o in ({}, {"tolerance": 1e-12}))
    assert fine < 0.1 * plain and fine < 1e-9
    with pytest.raises(fivebar.FivebarError, match="1e-14 to 1e-3"):
        fivebar.Plant(arm, tolerance=0.0)


def test_many_arms_move_as_each_by_itself_bit_for_bit(arm):
    count = 130
    random = np.random.default_rng(3)
    differs = sim.drawn(count, {"payload": (0.0, 0.1), "stiction": (0.0, 0.02)}, seed=5)
    theta = np.array([2.2, 0.9]) + random.uniform(-0.1, 0.1, (count, 2))
    omega = random.uniform(-1.0, 1.0, (count, 2))
    plants = fivebar.Plants(arm, count, theta, omega=omega, mismatch=differs)
    singles = [fivebar.Plant(arm, t, omega=w, mismatch=d) for t, w, d in zip(theta, omega, differs)]
    for _ in range(20):
        torque, force = random.uniform(-0.05, 0.05, (2, count, 2))
        plants.step(torque, 1e-3, force=force)
        for plant, own, pushed in zip(singles, torque, force):
            plant.step(own, 1e-3, force=pushed)
    assert np.array_equal(plants.numbers, [plant.state.numbers for plant in singles])
    assert np.array_equal(plants.tool, [plant.tool for plant in singles])
    assert len(plants) == count and np.ptp(plants.theta[:, 0]) > 0.05


def test_a_snapshot_of_many_arms_is_replayed_bit_for_bit(arm):
    plants = fivebar.Plants(arm, 50, (2.2, 0.9), mismatch=sim.drawn(50, {"friction": (-0.5, 0.5)}, seed=1))
    plants.step((0.05, 0.0), 1e-2)
    before = plants.numbers
    plants.step((0.0, 0.05), 1e-2)
    after = plants.numbers
    plants.numbers = before
    plants.step((0.0, 0.05), 1e-2)
    assert np.array_equal(plants.numbers, after) and not np.array_equal(before, after)


def test_an_arm_that_cannot_go_on_leaves_all_as_they_were(arm):
    plants = fivebar.Plants(arm, 100, (2.2, 0.9))
    before = plants.numbers
    torque = np.zeros((100, 2))
    torque[[37, 70], 0] = 1e9
    with pytest.raises(fivebar.RunError, match="arm 37") as refused:
        plants.step(torque, 1e-3)
    assert refused.value.index == 37
    assert np.array_equal(plants.numbers, before)
    for wrong in (np.zeros((99, 2)), np.full((100, 2), np.nan)):
        with pytest.raises(fivebar.FivebarError, match="torque must"):
            plants.step(wrong, 1e-3)


def test_ranges_are_drawn_evenly_and_by_their_seed(arm):
    ranges = {"payload": (0.0, 0.1), "link_length": (-1e-3, 1e-3)}
    arms = sim.drawn(400, ranges, seed=2)
    payload = np.array([differs["payload"] for differs in arms])
    lengths = np.array([differs["link_length"] for differs in arms])
    assert lengths.shape == (400, 4) and np.abs(lengths).max() < 1e-3
    assert abs(payload.mean() - 0.05) < 0.005 and payload.min() >= 0.0 and payload.max() <= 0.1
    assert arms[:10] == sim.drawn(10, ranges, seed=2) != sim.drawn(10, ranges, seed=3)
    for wrong in ({"mass": (0.0, 1.0)}, {"payload": (1.0, 0.0)}):
        with pytest.raises(fivebar.FivebarError, match="range"):
            sim.drawn(1, wrong, seed=1)


def test_the_linear_motion_is_that_of_differences(arm):
    random = np.random.default_rng(4)
    theta = np.array([2.2, 0.9]) + random.uniform(-0.2, 0.2, (20, 2))
    omega, torque = random.uniform(-2.0, 2.0, (20, 2)), random.uniform(-0.1, 0.1, (20, 2))
    found = sim.linearised(arm, theta, omega, torque)

    def rate(x, tau):
        return np.concatenate([x[:, 2:], arm.forward_dynamics(x[:, :2], x[:, 2:], tau).alpha], axis=1)

    x = np.concatenate([theta, omega], axis=1)
    for column in range(4):
        h = np.zeros(4)
        h[column] = 1e-5
        expected = (rate(x + h, torque) - rate(x - h, torque)) / 2e-5
        scale = 1.0 + np.abs(found.a).max()
        assert np.abs(found.a[..., column] - expected).max() < 1e-7 * scale
    for column in range(2):
        h = np.zeros(2)
        h[column] = 1e-3
        expected = (rate(x, torque + h) - rate(x, torque - h)) / 2e-3
        assert np.abs(found.b[..., column] - expected).max() < 1e-8 * np.abs(found.b).max()
    assert np.allclose(found.alpha, rate(x, torque)[:, 2:])
    held = sim.linearised(arm, theta)
    assert np.abs(held.alpha).max() < 1e-9


def test_the_environment_is_replayed_and_ends_its_episodes(arm):
    env = sim.Env(arm, 16, seed=7, duration=0.1, ranges={"payload": (0.0, 0.05)})
    first = env.reset()
    assert first.shape == (16, 8) and np.isfinite(first).all()
    random = np.random.default_rng(1)
    actions = random.uniform(-1.0, 1.0, (10, 16, 2))
    snapshot = pickle.loads(pickle.dumps(env.snapshot()))

    def episode():
        return [env.step(action) for action in actions], env.reset()

    one = episode()
    env.restore(snapshot)
    other = episode()
    assert all(np.array_equal(a, b) for x, y in zip(one[0], other[0]) for a, b in zip(x, y))
    assert np.array_equal(one[1], other[1])
    observation, reward, terminated, truncated = one[0][-1]
    assert (truncated | terminated).all() and not one[0][-2][3].any()
    assert np.isfinite(observation).all() and (reward <= 0.0).all()
    again = sim.Env(arm, 16, seed=7, duration=0.1, ranges={"payload": (0.0, 0.05)})
    assert np.array_equal(again.reset(), first)


def test_an_arm_beyond_its_limits_is_terminated_and_the_others_go_on(arm):
    env = sim.Env(arm, 4, seed=1, torque=(1e6, 1e6))
    env.reset()
    action = np.zeros((4, 2))
    action[2] = 1.0
    observation, reward, terminated, _ = env.step(action)
    assert terminated.tolist() == [False, False, True, False]
    assert reward[2] == -10.0 and np.isfinite(observation).all()
    assert np.allclose(env.plants.time[[0, 1, 3]], env.dt)


def test_gymnasium_accepts_the_environment(arm):
    pytest.importorskip("gymnasium")
    env = sim.gymnasium_env(arm, seed=3)
    first, _ = env.reset(seed=4)
    second, _ = env.reset(seed=4)
    assert env.observation_space.contains(first) and np.array_equal(first, second)
    found, reward, terminated, truncated, _ = env.step(env.action_space.sample())
    assert env.observation_space.contains(found) and isinstance(reward, float)
    assert not terminated and not truncated


def test_the_laboratorys_docstrings_are_right():
    names = {**vars(fivebar), **vars(sim)}
    assert doctest.testmod(sim, extraglobs=names).failed == 0


def test_a_controller_in_python_moves_the_arm_to_a_pose(arm):
    plant = fivebar.Plant(arm, (2.2, 0.9))
    for _ in range(2000):
        theta, omega = plant.theta, plant.omega
        plant.step(-0.5 * (theta - (2.1, 1.0)) - 0.02 * omega, 1e-3)
    assert np.allclose(plant.theta, (2.1, 1.0), atol=0.02) and np.abs(plant.omega).max() < 0.01
