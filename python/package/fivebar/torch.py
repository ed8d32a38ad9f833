"""The arm's functions for PyTorch, with their exact derivatives: ``pip install torch``.

>>> import fivebar, fivebar.torch
>>> import torch
>>> arm = fivebar.Arm.load("benchtop")
>>> theta = torch.tensor([2.2, 0.9], dtype=torch.float64, requires_grad=True)
>>> fivebar.torch.inverse_dynamics(arm, theta, omega=(1.0, 2.0)).sum().backward()
>>> theta.grad.shape
torch.Size([2])

There are first and second derivatives. The arguments have any shape before their last axis and broadcast. The processor computes in
64 bits; the results have the type and the device of the first argument. A row without a solution is NaN.
"""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

from . import _smooth
from ._arm import Arm
from ._errors import FivebarError
from ._shapes import SideLike

torch = _smooth.optional("torch")

__all__ = ["forward", "inverse", "inverse_dynamics"]


def forward(
    arm: Arm, theta: Any, assembly: Optional[SideLike] = None, *, point: Optional[str] = None
) -> Any:
    """The position of C, or of the tool [m], from θ1, θ4 [rad]; assembly and point as for :class:`fivebar.Arm`."""
    return _Applied.apply(_floats(theta), _smooth.forward(arm, assembly, point))


def inverse(
    arm: Arm,
    points: Any,
    elbow1: Optional[SideLike] = None,
    elbow4: Optional[SideLike] = None,
    *,
    point: Optional[str] = None,
) -> Any:
    """θ1, θ4 [rad] from the position of C, or of the tool [m]; elbows and point as for :meth:`fivebar.Arm.inverse`."""
    return _Applied.apply(_floats(points), _smooth.inverse(arm, elbow1, elbow4, point))


def inverse_dynamics(
    arm: Arm,
    theta: Any,
    omega: Any = (0.0, 0.0),
    alpha: Any = (0.0, 0.0),
    assembly: Optional[SideLike] = None,
) -> Any:
    """τ1, τ4 [N·m] from θ [rad], ω [rad/s], α [rad/s²] of joints 1 and 4."""
    first = _floats(theta)
    others = (torch.as_tensor(v, dtype=first.dtype, device=first.device) for v in (omega, alpha))
    rows = torch.broadcast_tensors(first, *others)
    return _Applied.apply(torch.cat(rows, dim=-1), _smooth.inverse_dynamics(arm, assembly))


def _floats(value: Any) -> Any:
    tensor = torch.as_tensor(value)
    return tensor if tensor.is_floating_point() else tensor.to(torch.get_default_dtype())


class _Applied(torch.autograd.Function):  # type: ignore[misc, name-defined]
    """The first of these derivatives at x; the next one gives its gradient."""

    @staticmethod
    def forward(context: Any, x: Any, derivatives: _smooth.Smooth) -> Any:
        context.save_for_backward(x)
        context.next = derivatives[1:]
        found = derivatives[0](x.detach().cpu().numpy().astype(np.float64))
        return torch.as_tensor(found, dtype=x.dtype, device=x.device)

    @staticmethod
    def backward(context: Any, gradient: Any) -> Any:
        if not context.next:
            raise FivebarError("there are first and second derivatives only")
        (x,) = context.saved_tensors
        by_x = _Applied.apply(x, context.next)
        # Sums over the axes of y, which are between those of the batch and the last.
        return (gradient.unsqueeze(-1) * by_x).sum(dim=tuple(range(x.ndim - 1, gradient.ndim))), None
