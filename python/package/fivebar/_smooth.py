"""Functions with their exact derivatives over NumPy arrays, for :mod:`fivebar.jax` and :mod:`fivebar.torch`."""

from __future__ import annotations

from importlib import import_module
from typing import Any, Callable, Optional, Tuple

import numpy as np

from ._arm import Arm
from ._shapes import Floats, SideLike

#: y(x), ∂y/∂x and ∂²y/∂x∂x: shapes S + (2,), S + (2, n) and S + (2, n, n), from x of shape S + (n,).
Smooth = Tuple[Callable[[Floats], Floats], ...]


def optional(name: str) -> Any:
    """A library that the package does without."""
    try:
        return import_module(name)
    except ImportError as missing:
        raise ImportError(f"fivebar.{name} needs {name}: pip install {name}") from missing


def forward(arm: Arm, assembly: Optional[SideLike], point: Optional[str]) -> Smooth:
    """The position of C, or of the tool, from θ."""
    of = "tool" if arm._of_tool(point) else "c"

    def position(theta: Floats) -> Floats:
        found: Floats = getattr(arm.forward(theta, assembly), of)
        return found

    return (
        position,
        lambda theta: arm.jacobian(theta, assembly, point=of),
        lambda theta: _curvature(arm, theta, assembly, of),
    )


def inverse(
    arm: Arm, elbow1: Optional[SideLike], elbow4: Optional[SideLike], point: Optional[str]
) -> Smooth:
    """θ from the position of C, or of the tool. With K = J⁻¹, ∂K_ij/∂p_k = −K_ia H_abc K_bj K_ck."""
    of = "tool" if arm._of_tool(point) else "c"

    def first(points: Floats) -> Floats:
        there = arm.inverse(points, elbow1, elbow4, point=of)
        return _inverted(arm.jacobian(there.theta, there.assembly, point=of))

    def second(points: Floats) -> Floats:
        there = arm.inverse(points, elbow1, elbow4, point=of)
        k = _inverted(arm.jacobian(there.theta, there.assembly, point=of))
        h = _curvature(arm, there.theta, there.assembly, of)
        found: Floats = -np.einsum("...ia,...abc,...bj,...ck->...ijk", k, h, k, k)
        return found

    return lambda points: arm.inverse(points, elbow1, elbow4, point=of).theta, first, second


def inverse_dynamics(arm: Arm, assembly: Optional[SideLike]) -> Smooth:
    """The torques from θ, ω, α, the six in one row."""

    def second(x: Floats) -> Floats:
        found = arm.derivatives(*_motion(x), assembly).second
        assert found is not None
        return found[..., 6:8, :6, :6]

    return (
        lambda x: arm.inverse_dynamics(*_motion(x), assembly).torque,
        lambda x: arm.derivatives(*_motion(x), assembly, order=1).first[..., 6:8, :6],
        second,
    )


def _motion(x: Floats) -> Tuple[Floats, Floats, Floats]:
    return x[..., 0:2], x[..., 2:4], x[..., 4:6]


def _curvature(arm: Arm, theta: Floats, assembly: Optional[SideLike], of: str) -> Floats:
    """H_abc = ∂²p_a/∂θ_b∂θ_c. Without α the acceleration is H ω ω: three velocities give H."""

    def acceleration(*omega: float) -> Floats:
        found: Floats = getattr(arm.motion(theta, omega, assembly=assembly), f"{of}_acceleration")
        return found

    by_1, by_4 = acceleration(1.0, 0.0), acceleration(0.0, 1.0)
    mixed = 0.5 * (acceleration(1.0, 1.0) - by_1 - by_4)
    return np.stack((np.stack((by_1, mixed), axis=-1), np.stack((mixed, by_4), axis=-1)), axis=-1)


def _inverted(j: Floats) -> Floats:
    """The inverse of 2 × 2 matrices; where there is none, NaN or infinite."""
    (a, b), (c, d) = (j[..., 0, 0], j[..., 0, 1]), (j[..., 1, 0], j[..., 1, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        rows: Floats = np.stack((d, -b, -c, a), axis=-1) / (a * d - b * c)[..., None]
    return rows.reshape(j.shape)
