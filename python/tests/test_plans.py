"""Plans along points, and their motion at any time."""

import pickle

import numpy as np
import pytest

import fivebar

POINTS = np.array([[0.0, 0.17], [0.02, 0.19], [0.05, 0.18], [0.08, 0.16]])
MOTION = {"speed": [8.0, 8.0], "acceleration": [120.0, 120.0]}


@pytest.mark.parametrize("options", [
    {"limits": {"torque": [0.3, 0.3]}, "spline": True},
    {"limits": {"torque": [0.3, 0.3]}},
    {"limits": MOTION, "spline": True, "jerk": 2e4},
    {"limits": {**MOTION, "tip_speed": 0.5}, "corners": "stop"},
])
def test_samples_are_a_motion_of_the_arm_and_keep_the_limits(arm, options):
    plan = arm.plan(POINTS, **options)
    t = np.linspace(0.0, plan.time, 4001)
    at = plan.sample(t)
    # By the package's own kinematics and dynamics.
    there = arm.inverse_motion(at.tool, at.tool_velocity, at.tool_acceleration, strict=True)
    assert np.allclose(there.theta, at.theta, atol=1e-12)
    assert np.allclose(there.omega, at.omega, atol=1e-9) and np.allclose(there.alpha, at.alpha, atol=1e-7)
    rigid = arm.inverse_dynamics(at.theta, at.omega, at.alpha).torque
    # Torques have friction on top, which points against the motion.
    moving = np.abs(at.omega) > 1e-3
    assert ((at.torque - rigid) * at.omega >= -1e-12)[moving].all()
    # Angles are the integral of velocities.
    step = np.diff(at.theta, axis=0) - 0.5 * (at.omega[1:] + at.omega[:-1]) * np.diff(t)[:, None]
    assert np.abs(step).max() < 1e-4
    limits = options["limits"]
    for name, used in (("torque", at.torque), ("speed", at.omega), ("acceleration", at.alpha)):
        if name in limits:
            assert np.abs(used).max() < 1.03 * limits[name][0]
    assert np.abs(at.tool[[0, -1]] - POINTS[[0, -1]]).max() < 1e-9
    nearest = np.linalg.norm(at.tool[None] - POINTS[:, None], axis=2).min(axis=1)
    assert nearest.max() < 2e-4
    assert np.abs(at.omega[[0, -1]]).max() < 1e-6
    assert pickle.loads(pickle.dumps(plan)).sample(t).theta.tolist() == at.theta.tolist()


def test_a_plan_is_the_answer_of_the_program_too(arm):
    plan = arm.plan(POINTS, limits=MOTION)
    assert plan["time_s"] == plan.time == plan.to_dict()["time_s"]
    assert len(plan["runs"][0]["s"]) == 201
    rest = plan.sample([-1.0, plan.time + 1.0])
    assert np.abs(rest.omega).max() == 0.0


def test_an_arm_without_masses_is_planned_by_limits_of_motion():
    arm = fivebar.Arm(l1=0.1, l2=0.16, base=0.08)
    plan = arm.plan(POINTS, limits=MOTION, spline=True)
    benchtop = fivebar.Arm.load("benchtop").plan(POINTS, limits=MOTION, spline=True)
    assert plan.time == pytest.approx(benchtop.time, rel=1e-9)
    assert np.isnan(plan.sample(0.01).torque).all() and plan["runs"][0]["torque1_nm"] is None
    with pytest.raises(fivebar.StudyError, match="lengths only"):
        arm.plan(POINTS, limits={"torque": [1.0, 1.0]})


@pytest.mark.parametrize(("path", "options", "reason"), [
    (POINTS, {}, "need limits"),
    (POINTS, {"limits": {"speed": [1.0, 1.0]}}, "in no time"),
    (POINTS[:1], {"limits": MOTION}, "N of 2 or more"),
    (np.full((3, 2), np.nan), {"limits": MOTION}, "finite"),
    ("{}", {"limits": MOTION}, "for points"),
    (POINTS[[0, 0, 1]], {"limits": MOTION, "spline": True}, "the same as the one before"),
])
def test_what_is_no_path_is_refused_with_the_reason(arm, path, options, reason):
    with pytest.raises(fivebar.FivebarError, match=reason):
        arm.plan(path, **options)
