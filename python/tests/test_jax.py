"""The functions for JAX: values, derivatives and transformations.

The tests that fork have names that come before this one: once JAX has computed, it warns of every fork.
"""

import doctest
import os
import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip("jax", reason="JAX is not installed")

import fivebar
import fivebar.jax

jax, jnp = fivebar.jax.jax, fivebar.jax.jnp
#: Points [m] that the elbows left and right reach in the assembly right.
CROSSED = np.array([[0.04, 0.2], [0.02, 0.18], [0.06, 0.17]])


@pytest.fixture(autouse=True)
def in_64_bits():
    jax.config.update("jax_enable_x64", True)
    yield
    jax.config.update("jax_enable_x64", False)


@pytest.fixture(scope="module")
def functions(arm, poses):
    """Each function with an argument of 6 rows at which it is smooth."""
    points = poses[:6]
    theta = arm.inverse(points).theta
    motion = np.random.default_rng(2).uniform(-3.0, 3.0, (2, 6, 2))
    # Its tool is beside C: 30 mm along link 2 and 10 mm to its left.
    beside = fivebar.Arm.from_toml(f"{arm.toml}\n[tool]\noffset = [0.03, 0.01]\n")
    tool = beside.forward(theta).tool
    return {
        "forward": (lambda q: fivebar.jax.forward(arm, q), theta),
        "inverse": (lambda p: fivebar.jax.inverse(arm, p), points),
        "inverse elsewhere": (lambda p: fivebar.jax.inverse(arm, p, "left", "right"), CROSSED),
        "inverse_dynamics": (
            lambda x: fivebar.jax.inverse_dynamics(arm, *jnp.split(x, 3, axis=-1)),
            np.concatenate((theta, *motion), axis=-1),
        ),
        "tool": (lambda q: fivebar.jax.forward(beside, q, point="tool"), theta),
        "inverse of tool": (lambda p: fivebar.jax.inverse(beside, p, point="tool"), tool),
    }


ALL = ["forward", "inverse", "inverse elsewhere", "inverse_dynamics", "tool", "inverse of tool"]


def test_the_values_are_those_of_the_arm(arm, functions):
    theta, points, x = (functions[name][1] for name in ("forward", "inverse", "inverse_dynamics"))
    assert np.array_equal(functions["forward"][0](theta), arm.forward(theta).c)
    assert np.array_equal(functions["inverse"][0](points), theta)
    torque = arm.inverse_dynamics(x[:, :2], x[:, 2:4], x[:, 4:]).torque
    assert np.array_equal(functions["inverse_dynamics"][0](x), torque)
    assert (arm.inverse(CROSSED, "left", "right").assembly == -arm.assembly).all()
    other = fivebar.jax.forward(arm, theta, "right")
    assert np.array_equal(other, arm.forward(theta, "right").c)


@pytest.mark.parametrize("name", ALL)
def test_first_and_second_derivatives_are_those_of_differences(functions, name):
    from jax.test_util import check_grads

    function, x = functions[name]
    check_grads(function, (jnp.asarray(x),), order=2, eps=1e-5, atol=1e-6, rtol=1e-6)


@pytest.mark.parametrize("name", ALL)
def test_jacobians_agree_with_central_differences_and_in_both_directions(functions, name):
    function, x = functions[name]
    by_x = jax.jit(jax.vmap(jax.jacrev(function)))(x)
    for column in range(x.shape[1]):
        h = np.zeros(x.shape[1])
        h[column] = 1e-6
        expected = (function(x + h) - function(x - h)) / 2e-6
        assert np.abs(by_x[..., column] - expected).max() < 1e-8 * max(1.0, np.abs(by_x).max())
    assert np.allclose(jax.vmap(jax.jacfwd(function))(x), by_x, rtol=1e-13, atol=1e-15)
    twice = jax.vmap(jax.hessian(function))(x)
    assert np.allclose(twice, np.swapaxes(twice, -1, -2), rtol=1e-9, atol=1e-12)


def test_batches_have_any_shape_and_broadcast(arm, functions):
    function, x = functions["inverse_dynamics"]
    one_by_one = np.array([function(row) for row in x])
    for same in (function(x.reshape(2, 3, 6)).reshape(6, 2), jax.vmap(function)(x), jax.jit(function)(x)):
        assert np.array_equal(same, one_by_one)
    torque = fivebar.jax.inverse_dynamics(arm, x[:, :2], omega=(1.0, 2.0))
    assert np.array_equal(torque, arm.inverse_dynamics(x[:, :2], (1.0, 2.0)).torque)


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="this system does not restrict a process to a core")
def test_a_large_batch_is_computed_on_one_core():
    program = """
import os
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
import fivebar.jax, jax, numpy as np
arm = fivebar.Arm.load("benchtop")
theta = np.random.default_rng(1).normal((2.2, 0.9), 0.1, (100_003, 2)).astype(np.float32)
function = lambda theta: fivebar.jax.forward(arm, theta)
value, by_theta = jax.jit(jax.value_and_grad(lambda theta: function(theta).sum()))(theta)
assert np.allclose(by_theta, arm.jacobian(theta).sum(axis=-2), rtol=1e-5, atol=1e-6)
assert np.allclose(jax.vmap(function)(theta), arm.forward(theta).c, rtol=1e-5)
"""
    # A wait of JAX for itself has no end: the limit only ends it [s].
    subprocess.run([sys.executable, "-c", program], check=True, timeout=120)


def test_rows_out_of_reach_are_nan_and_leave_the_others(arm):
    points = jnp.array([[0.04, 0.2], [0.5, 0.0]])
    by_point = jax.vmap(jax.jacobian(lambda p: fivebar.jax.inverse(arm, p)))(points)
    assert np.isfinite(by_point[0]).all() and np.isnan(by_point[1]).all()


def test_the_type_of_the_argument_is_kept(arm):
    theta = jnp.array([2.2, 0.9], dtype=jnp.float32)
    function = jax.jacobian(lambda q: fivebar.jax.forward(arm, q))
    assert function(theta).dtype == fivebar.jax.forward(arm, theta).dtype == jnp.float32
    assert fivebar.jax.forward(arm, [2, 1]).dtype == jnp.float64


def test_a_third_derivative_is_refused(arm):
    third = jax.jacfwd(jax.jacfwd(jax.jacfwd(lambda q: fivebar.jax.forward(arm, q))))
    with pytest.raises(fivebar.FivebarError, match="up to the order 2"):
        third(jnp.array([2.2, 0.9]))


def test_the_docstrings_are_right():
    assert doctest.testmod(fivebar.jax).failed == 0
