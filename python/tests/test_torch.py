"""The functions for PyTorch: values and derivatives."""

import doctest

import numpy as np
import pytest

pytest.importorskip("torch", reason="PyTorch is not installed: 0.5 GB, and 3 GB of libraries for graphics cards")

import fivebar
import fivebar.torch

torch = fivebar.torch.torch


def functions(arm, poses, count):
    """Each function with an argument of so many rows."""
    points = torch.tensor(poses[:count], requires_grad=True)
    theta = torch.tensor(arm.inverse(poses[:count]).theta, requires_grad=True)
    omega, alpha = np.random.default_rng(2).uniform(-3.0, 3.0, (2, count, 2))
    motion = [torch.tensor(value, requires_grad=True) for value in (omega, alpha)]
    return {
        "forward": (lambda q: fivebar.torch.forward(arm, q), (theta,)),
        "inverse": (lambda p: fivebar.torch.inverse(arm, p), (points,)),
        "inverse_dynamics": (lambda *x: fivebar.torch.inverse_dynamics(arm, *x), (theta, *motion)),
    }


ALL = ["forward", "inverse", "inverse_dynamics"]


@pytest.mark.parametrize("name", ALL)
def test_first_and_second_derivatives_are_those_of_differences(arm, poses, name):
    function, x = functions(arm, poses, 3)[name]
    options = {"eps": 1e-6, "atol": 1e-6, "rtol": 1e-6}
    assert torch.autograd.gradcheck(function, x, **options)
    assert torch.autograd.gradgradcheck(function, x, **options)


def test_the_values_are_those_of_the_arm_in_any_shape(arm, poses):
    found = functions(arm, poses, 6)
    (theta,), (points,) = found["forward"][1], found["inverse"][1]
    q = theta.detach().numpy()
    tensor = fivebar.torch.forward(arm, theta.reshape(2, 3, 2))
    assert np.array_equal(tensor.detach().numpy(), arm.forward(q.reshape(2, 3, 2)).c)
    assert np.array_equal(found["inverse"][0](points).detach().numpy(), q)
    torque = fivebar.torch.inverse_dynamics(arm, theta, omega=(1.0, 2.0))
    assert np.array_equal(torque.detach().numpy(), arm.inverse_dynamics(q, (1.0, 2.0)).torque)
    # Without a batch, and of all rows as of each.
    (by_all,) = torch.autograd.grad(tensor.sum(), theta)
    one = theta[4].detach().requires_grad_()
    (by_one,) = torch.autograd.grad(fivebar.torch.forward(arm, one).sum(), one)
    assert torch.equal(by_one, by_all[4])
    assert np.allclose(by_one.numpy(), arm.jacobian(q[4]).sum(axis=0), rtol=1e-14)


def test_rows_out_of_reach_are_nan_and_leave_the_others(arm):
    points = torch.tensor([[0.04, 0.2], [0.5, 0.0]], dtype=torch.float64, requires_grad=True)
    fivebar.torch.inverse(arm, points).sum().backward()
    assert torch.isfinite(points.grad[0]).all() and torch.isnan(points.grad[1]).all()


def test_the_type_of_the_argument_is_kept(arm):
    theta = torch.tensor([2.2, 0.9], requires_grad=True)
    torque = fivebar.torch.inverse_dynamics(arm, theta, alpha=(3.0, 4.0))
    torque.sum().backward()
    assert torque.dtype == theta.grad.dtype == torch.float32
    assert fivebar.torch.forward(arm, [2, 1]).dtype == torch.float32


def test_a_third_derivative_is_refused(arm):
    theta = torch.tensor([2.2, 0.9], dtype=torch.float64, requires_grad=True)
    found = fivebar.torch.forward(arm, theta)
    with pytest.raises(fivebar.FivebarError, match="first and second"):
        for _ in range(3):
            (found,) = torch.autograd.grad(found.sum(), theta, create_graph=True)


def test_the_docstrings_are_right():
    assert doctest.testmod(fivebar.torch).failed == 0
