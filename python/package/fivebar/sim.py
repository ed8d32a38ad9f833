"""A laboratory: many simulated arms at once, for controllers of one's own, for learning and for analysis.

>>> import fivebar, fivebar.sim
>>> arm = fivebar.Arm.load("benchtop")
>>> differs = fivebar.sim.drawn(3, {"payload": (0.0, 0.1), "torque_constant": (-0.05, 0.05)}, seed=1)
>>> sorted(differs[0]), len(differs[0]["torque_constant"])
(['payload', 'torque_constant'], 2)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arm import Arm
from ._errors import FivebarError, RunError
from ._plant import Plants
from ._shapes import Floats, SideLike, pair
from ._simulation import NO_MISMATCH
from ._status import Status
from ._tables import optional

__all__ = ["Env", "Linear", "drawn", "gymnasium_env", "linearised"]

#: Ranges of a mismatch: the least and the greatest value, of each joint or link by itself.
Ranges = Mapping[str, Tuple[float, float]]


def drawn(count: int, ranges: Ranges, *, seed: int) -> List[Dict[str, Any]]:
    """Mismatches drawn evenly from ranges: so many arms that differ from their robot file, and from each other.

    ranges: by the keys of :data:`fivebar.NO_MISMATCH`, the least and the greatest value. Of a key with a list, each number is
    drawn by itself. The same seed gives the same arms, and more of them begin with these.
    """
    for name, (low, high) in ranges.items():
        if name not in NO_MISMATCH or name == "encoder_error":
            known = ", ".join(n for n in NO_MISMATCH if n != "encoder_error")
            raise FivebarError(f"no range can be drawn of `{name}`; there are {known}")
        if not (np.isfinite([low, high]).all() and low <= high):
            raise FivebarError(f"the range of `{name}` must be (least, greatest), not {(low, high)!r}")
    arms = []
    for stream in np.random.SeedSequence(seed).spawn(count):
        random = np.random.default_rng(stream)
        sizes = {name: np.shape(NO_MISMATCH[name]) or None for name in sorted(ranges)}
        arms.append({n: np.asarray(random.uniform(*ranges[n], s)).tolist() for n, s in sizes.items()})
    return arms


@dataclass(frozen=True, eq=False)
class Linear:
    """The motion about a state: d(δx)/dt = A δx + B δτ, with x = (θ1, θ4, ω1, ω4)."""

    #: A, shape S + (4, 4) [1/s].
    a: Floats
    #: B, shape S + (4, 2) [1/(kg·m²)].
    b: Floats
    #: The torques at which ẋ was taken [N·m], shape S + (2,).
    torque: Floats
    #: The accelerations there [rad/s²], shape S + (2,).
    alpha: Floats


def linearised(
    arm: Arm,
    theta: ArrayLike,
    omega: ArrayLike = (0.0, 0.0),
    torque: Optional[ArrayLike] = None,
    *,
    assembly: Optional[SideLike] = None,
) -> Linear:
    """The linear motion about states, such as those of a trajectory, without friction.

    From τ = M(θ) α + h(θ, ω), α(x, τ) has ∂α/∂τ = M⁻¹ and ∂α/∂x = −M⁻¹ ∂τ/∂x at that α, with the exact derivatives of
    :meth:`fivebar.Arm.derivatives`. theta [rad], omega [rad/s], torque [N·m]: S + (2,); by default the torque that keeps ω.
    Raises :class:`fivebar.PoseError` where the arm cannot be, or is singular.

    >>> arm = Arm.load("benchtop")
    >>> motion = linearised(arm, [2.2, 0.9])
    >>> motion.a.shape, motion.b.shape, bool(motion.b[2, 0] > 0.0)
    ((4, 4), (4, 2), True)
    """
    if torque is None:
        torque = arm.inverse_dynamics(theta, omega, assembly=assembly, strict=True).torque
    found = arm.forward_dynamics(theta, omega, torque, assembly, strict=True)
    by = arm.derivatives(theta, omega, found.alpha, assembly, order=1, strict=True).first
    mass, by_state = by[..., 6:8, 4:6], by[..., 6:8, 0:4]
    shape = by.shape[:-2]
    a, b = np.zeros((*shape, 4, 4)), np.zeros((*shape, 4, 2))
    a[..., 0, 2] = a[..., 1, 3] = 1.0
    a[..., 2:, :] = -np.linalg.solve(mass, by_state)
    b[..., 2:, :] = np.linalg.inv(mass)
    return Linear(a, b, np.broadcast_to(np.asarray(torque, dtype=np.float64), (*shape, 2)), found.alpha)


class Env:
    """Many arms that reach for points: an environment for learning, in rows.

    An observation has sin θ1, sin θ4, cos θ1, cos θ4, ω1, ω4 (in 10 rad/s), and the way from the tool to its target x, y, by
    the length of a leg. An action is τ1, τ4 as shares of ``torque``, −1 to 1. The reward of a step is the negative distance
    to the target by that length, less a hundredth of the actions' squares. An episode is truncated after ``duration``; an arm
    that cannot go on, by its speed or the limits of its joints, is terminated with a reward of −10.

    >>> env = Env(Arm.load("benchtop"), 8, seed=1)
    >>> observation = env.reset()
    >>> observation, reward, terminated, truncated = env.step(np.zeros((8, 2)))
    >>> observation.shape, reward.shape
    ((8, 8), (8,))

    arm: with masses. count: how many. torque: the greatest [N·m]; by default such that a joint with its link at rest is
    accelerated by 100 rad/s². dt: the time of a step [s]. ranges: of the arms' mismatch, drawn once by :func:`drawn`.
    seed: of starts, targets and mismatch. :meth:`snapshot` and :meth:`restore` go back to the bit.
    """

    #: The numbers of an observation.
    OBSERVED = 8

    def __init__(
        self,
        arm: Arm,
        count: int,
        *,
        torque: Optional[ArrayLike] = None,
        dt: float = 0.01,
        duration: float = 2.0,
        ranges: Optional[Ranges] = None,
        seed: int = 0,
    ) -> None:
        differs = None if ranges is None else drawn(count, ranges, seed=seed)
        self.plants = Plants(arm, count, mismatch=differs)
        self._random = np.random.default_rng([seed, 1])
        mass = arm.inverse_dynamics(arm.home, strict=True).mass_matrix
        self.torque = np.asarray(
            100.0 * np.diagonal(mass) if torque is None else pair("torque", torque)
        )
        self.dt, self.duration = dt, duration
        self._size = arm.lengths[0] + arm.lengths[1]
        self._limits = np.asarray(arm.joint_limits, dtype=np.float64)
        self._begun = np.zeros(count)
        self.target = np.zeros((count, 2))

    @property
    def count(self) -> int:
        """How many arms there are."""
        return len(self.plants)

    def reset(self, rows: Optional[Sequence[int]] = None) -> Floats:
        """Puts these arms, or all, at rest at new points, with new targets. Returns the observations of all."""
        indices = np.arange(self.count) if rows is None else np.asarray(rows, dtype=np.int64)
        if len(indices) > 0:
            theta, _ = self._points(len(indices))
            _, self.target[indices] = self._points(len(indices))
            self.plants.place(indices, theta)
            self._begun[indices] = self.plants.time[indices]
        return self.observation()

    def step(
        self, action: ArrayLike
    ) -> Tuple[Floats, Floats, NDArray[np.bool_], NDArray[np.bool_]]:
        """Observations, rewards, terminated and truncated of all arms after one step. Reset those that ended."""
        share = np.clip(np.asarray(action, dtype=np.float64), -1.0, 1.0)
        if share.shape != (self.count, 2) or not np.all(np.isfinite(share)):
            raise FivebarError(f"an action must be finite, shape ({self.count}, 2), not {share.shape}")
        before = self.plants.numbers
        failed = np.zeros(self.count, dtype=bool)
        torque = share * self.torque
        while True:
            try:
                self.plants.step(torque, self.dt)
                break
            except RunError as refusal:
                # It rests where it is, and the others go on.
                stopped = refusal.index
                if stopped is None or failed[stopped]:
                    raise
                failed[stopped] = True
                before[stopped, 12:24] = 0.0
                torque[stopped] = 0.0
                self.plants.numbers = before
        low, high = self._limits[:, 0], self._limits[:, 1]
        theta = self.plants.theta
        failed |= ((theta < low) | (theta > high)).any(axis=1)
        away = np.linalg.norm(self.plants.tool - self.target, axis=1) / self._size
        reward = np.where(failed, -10.0, -away - 0.01 * (share**2).sum(axis=1))
        truncated = self.plants.time - self._begun >= self.duration - 0.5 * self.dt
        return self.observation(), reward, failed, truncated & ~failed

    def observation(self) -> Floats:
        """What is observed of each arm now, shape (count, 8)."""
        theta = self.plants.theta
        away = (self.target - self.plants.tool) / self._size
        return np.concatenate([np.sin(theta), np.cos(theta), 0.1 * self.plants.omega, away], axis=1)

    def snapshot(self) -> Dict[str, Any]:
        """All that changes, for :meth:`restore`; it can be pickled."""
        return {
            "numbers": self.plants.numbers,
            "target": self.target.copy(),
            "begun": self._begun.copy(),
            "random": self._random.bit_generator.state,
        }

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Goes back to a snapshot, after which everything is as then, bit for bit."""
        self.plants.numbers = snapshot["numbers"]
        self.target = snapshot["target"].copy()
        self._begun = snapshot["begun"].copy()
        self._random.bit_generator.state = snapshot["random"]

    def _points(self, count: int) -> Tuple[Floats, Floats]:
        """Angles, and the tool's points there, that the arm reaches within its joint limits."""
        arm = self.plants.arm
        margin = 0.1 * (self._limits[:, 1] - self._limits[:, 0])
        low, high = self._limits[:, 0] + margin, self._limits[:, 1] - margin
        angles, points = [np.empty((0, 2))], [np.empty((0, 2))]
        for _ in range(1000):
            theta = self._random.uniform(low, high, (2 * count, 2))
            there = arm.forward(theta)
            good = (there.elbow1 == arm.elbow1) & (there.elbow4 == arm.elbow4)
            good &= there.status == Status.OK
            # Not at a singularity: links 2 and 3 meet at an angle.
            good &= np.abs(np.sin(there.theta3 - there.theta2)) > 0.3
            angles.append(theta[good])
            points.append(there.tool[good])
            if sum(map(len, angles)) >= count:
                return np.concatenate(angles)[:count], np.concatenate(points)[:count]
        raise FivebarError("hardly any angles within the joint limits are poses of the arm")


def gymnasium_env(arm: Arm, **options: Any) -> Any:
    """One arm of :class:`Env` as a ``gymnasium.Env``: ``pip install gymnasium``.

    options: as of :class:`Env`; ``reset(seed=…)`` begins with another seed.
    """
    gymnasium = optional("gymnasium", "gymnasium_env")

    class Reach(gymnasium.Env):  # type: ignore[misc, name-defined]
        """An arm that reaches for points."""

        def __init__(self) -> None:
            self.env = Env(arm, 1, **options)
            wide = np.full(Env.OBSERVED, np.inf, dtype=np.float64)
            self.observation_space = gymnasium.spaces.Box(-wide, wide, dtype=np.float64)
            self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (2,), dtype=np.float64)

        def reset(
            self, *, seed: Optional[int] = None, options: Optional[Dict[str, Any]] = None
        ) -> Tuple[Floats, Dict[str, Any]]:
            super().reset(seed=seed)
            if seed is not None:
                self.env._random = np.random.default_rng([seed, 1])
            return self.env.reset()[0], {}

        def step(self, action: ArrayLike) -> Tuple[Floats, float, bool, bool, Dict[str, Any]]:
            found, reward, terminated, truncated = self.env.step(np.reshape(action, (1, 2)))
            return found[0], float(reward[0]), bool(terminated[0]), bool(truncated[0]), {}

    return Reach()
