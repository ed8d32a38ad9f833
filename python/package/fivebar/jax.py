"""The arm's functions for JAX, with their exact derivatives: ``pip install jax``.

>>> import fivebar, fivebar.jax
>>> import jax, jax.numpy as jnp
>>> arm = fivebar.Arm.load("benchtop")
>>> jax.jit(jax.jacobian(lambda theta: fivebar.jax.forward(arm, theta)))(jnp.array([2.2, 0.9])).shape
(2, 2)

``jit``, ``vmap``, ``grad`` and ``jvp`` work on them, for first and second derivatives. The arguments have any shape before
their last axis and broadcast. A batch is computed on the processor (``jax.pure_callback``) in 64 bits;
the results have the arguments' type, by default 32 bits (``jax_enable_x64``). A row without a solution is NaN.
"""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

from . import _smooth
from ._arm import Arm
from ._errors import FivebarError
from ._shapes import SideLike

jax = _smooth.optional("jax")
jnp = jax.numpy
#: Of one call from JAX [bytes]. JAX copies more than 100 KiB in its pool of threads; where all of them wait in calls, as the
#: only one on one core, that never ends.
LARGEST = 65536

__all__ = ["forward", "inverse", "inverse_dynamics"]


def forward(
    arm: Arm, theta: Any, assembly: Optional[SideLike] = None, *, point: Optional[str] = None
) -> Any:
    """The position of C, or of the tool [m], from θ1, θ4 [rad]; assembly and point as for :class:`fivebar.Arm`."""
    return _applied(_smooth.forward(arm, assembly, point), _floats(theta))


def inverse(
    arm: Arm,
    points: Any,
    elbow1: Optional[SideLike] = None,
    elbow4: Optional[SideLike] = None,
    *,
    point: Optional[str] = None,
) -> Any:
    """θ1, θ4 [rad] from the position of C, or of the tool [m]; elbows and point as for :meth:`fivebar.Arm.inverse`."""
    return _applied(_smooth.inverse(arm, elbow1, elbow4, point), _floats(points))


def inverse_dynamics(
    arm: Arm,
    theta: Any,
    omega: Any = (0.0, 0.0),
    alpha: Any = (0.0, 0.0),
    assembly: Optional[SideLike] = None,
) -> Any:
    """τ1, τ4 [N·m] from θ [rad], ω [rad/s], α [rad/s²] of joints 1 and 4."""
    given = jnp.broadcast_arrays(*(_floats(value) for value in (theta, omega, alpha)))
    return _applied(_smooth.inverse_dynamics(arm, assembly), jnp.concatenate(given, axis=-1))


def _floats(value: Any) -> Any:
    array = jnp.asarray(value)
    return array if jnp.issubdtype(array.dtype, jnp.floating) else array.astype(float)


def _applied(derivatives: _smooth.Smooth, x: Any, order: int = 0) -> Any:
    """The derivative of this order at x. Its own derivative, of the next order, gives the differential dy = ∂y/∂x dx."""

    def asked(x: Any) -> Any:
        shape = (*x.shape[:-1], 2, *order * x.shape[-1:])
        return jax.pure_callback(
            lambda x: derivatives[order](np.asarray(x, dtype=np.float64)).astype(x.dtype),
            jax.ShapeDtypeStruct(shape, x.dtype),
            x,
        )

    def called(x: Any) -> Any:
        rows, block = x.size // x.shape[-1], LARGEST // (x.dtype.itemsize * x.shape[-1])
        if rows <= block:
            return asked(x)
        padded = jnp.pad(x.reshape(rows, -1), ((0, -rows % block), (0, 0)), mode="edge")
        found = jax.lax.map(asked, padded.reshape(-1, block, x.shape[-1]))
        tail = found.shape[2:]
        return found.reshape(-1, *tail)[:rows].reshape(*x.shape[:-1], *tail)

    # A batch of batches is one batch.
    batched = jax.custom_batching.custom_vmap(called)
    batched.def_vmap(lambda size, is_batched, x: (batched(x), True))

    def differential(primals: Any, tangents: Any) -> Any:
        if order + 1 == len(derivatives):
            raise FivebarError(f"there are derivatives up to the order {order}")
        (x,), (dx,) = primals, tangents
        by_x = _applied(derivatives, x, order + 1)
        across = dx.reshape(*x.shape[:-1], *(order + 1) * (1,), x.shape[-1])
        return _applied(derivatives, x, order), (by_x * across).sum(axis=-1)

    function = jax.custom_jvp(batched)
    function.defjvp(differential)
    return function(x)
