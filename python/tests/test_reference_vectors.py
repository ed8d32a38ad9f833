"""The package against numbers from another method, described in tests/data/README.md."""

import numpy as np


def close(actual, expected):
    """Asserts that each row agrees within 1e-9 of its size."""
    actual, expected = np.asarray(actual), np.asarray(expected)
    assert actual.shape == expected.shape
    flat = np.abs(expected).reshape(len(expected), -1)
    scale = np.maximum(flat.max(axis=1), 1e-3)
    error = np.abs(actual - expected).reshape(len(expected), -1).max(axis=1)
    assert np.all(error <= 1e-9 * scale), (error / scale).max()


def pair(case, letter):
    return np.stack((case[f"{letter}1"], case[f"{letter}4"]), axis=-1)


def sign(names):
    return np.where(names == "left", 1, -1)


def state(case):
    return pair(case, "theta"), pair(case, "omega"), pair(case, "alpha"), case["assembly"]


def test_positions_agree_on_all_branches(vectors):
    for arm, case in vectors:
        there = arm.forward(pair(case, "theta"), case["assembly"], strict=True)
        close(there.c, case["c"])
        close(there.theta2, case["theta2"])
        close(there.theta3, case["theta3"])
        assert np.array_equal(there.elbow1, sign(case["elbow1"]))
        assert np.array_equal(there.elbow4, sign(case["elbow4"]))
        back = arm.inverse(case["c"], case["elbow1"], case["elbow4"], strict=True)
        close(back.theta, pair(case, "theta"))
        close(back.theta2, case["theta2"])
        close(back.theta3, case["theta3"])
        assert np.array_equal(back.assembly, sign(case["assembly"]))


def test_motion_agrees_both_ways(vectors):
    for arm, case in vectors:
        motion = arm.motion(*state(case), strict=True)
        for key in ("c", "c_velocity", "c_acceleration", "omega2", "omega3", "alpha2", "alpha3"):
            close(getattr(motion, key), case[key])
        back = arm.inverse_motion(case["c"], case["c_velocity"], case["c_acceleration"],
                                  case["elbow1"], case["elbow4"], strict=True)
        for letter in ("theta", "omega", "alpha"):
            close(getattr(back, letter), pair(case, letter))
            for link in (2, 3):
                close(getattr(back, f"{letter}{link}"), case[f"{letter}{link}"])


def test_dynamics_agree_both_ways(vectors):
    for arm, case in vectors:
        force = case["external_force"]
        dynamics = arm.inverse_dynamics(*state(case), force, strict=True)
        close(dynamics.torque, case["torque"])
        close(dynamics.mass_matrix, case["mass_matrix"])
        close(dynamics.bias_torque, case["bias_torque"])
        for joint in "abcde":
            close(getattr(dynamics.reaction, joint), case["reaction"][joint])
        theta, omega, alpha, assembly = state(case)
        back = arm.forward_dynamics(theta, omega, case["torque"], assembly, force, strict=True)
        close(back.alpha, alpha)
