"""The results of the methods of :class:`fivebar.Arm`.

Shapes: S is the shape of the batch, that of the arguments without their last axis; () for
a single pair. In a row without a solution, numbers are NaN, sides are 0, and ``status``
gives the reason. SI units; angles [rad] absolute, counter-clockwise from +x; points in
the frame of the base, A at the origin, E on +x.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, List, Mapping, Optional, Tuple, Type, TypeVar

import numpy as np
from numpy.typing import NDArray

from ._shapes import Floats, Signs, Statuses
from ._status import Status
from ._tables import JOINTS, LABELS, NUMBER, POINT, Table

Asked = TypeVar("Asked", bound="Answer")


@dataclass(frozen=True, eq=False)
class Answer(Table):
    """The part that all results have."""

    FIELDS: ClassVar[Mapping[str, Tuple[str, ...]]] = {"status": NUMBER}

    #: Codes of :class:`Status`, shape S.
    status: Statuses

    @classmethod
    def tails(cls) -> List[Tuple[int, ...]]:
        """The last axes of each field that the compiled half answers."""
        return [tuple(len(LABELS[axis]) for axis in axes) for axes in [*cls.FIELDS.values()][1:]]

    @classmethod
    def of(cls: Type[Asked], status: Statuses, fields: List[Floats]) -> Asked:
        """The answer of these fields, in the order of ``FIELDS``; without its ``__init__``, which takes longer than a question."""
        answer = cls.__new__(cls)
        answer.__dict__.update(zip(cls.FIELDS, (status, *fields)))
        return answer

    @property
    def ok(self) -> NDArray[np.bool_]:
        """Whether each row has a solution, shape S."""
        ok: NDArray[np.bool_] = self.status == Status.OK
        return ok


@dataclass(frozen=True, eq=False)
class Forward(Answer):
    """The positions of C and of the tool, with the angles of links 2 and 3."""

    FIELDS = {
        **Answer.FIELDS,
        "c": POINT,
        "theta2": NUMBER,
        "theta3": NUMBER,
        "elbow1": NUMBER,
        "elbow4": NUMBER,
        "tool": POINT,
    }

    #: C [m], shape S + (2,).
    c: Floats
    #: Angle of link 2, B to C [rad].
    theta2: Floats
    #: Angle of link 3, D to C [rad].
    theta3: Floats
    #: Which way elbow 1 turns: +1 left, −1 right.
    elbow1: Signs
    #: Which way elbow 4 turns.
    elbow4: Signs
    #: The tool [m], shape S + (2,): C, unless the robot's tool is beside it.
    tool: Floats


@dataclass(frozen=True, eq=False)
class Inverse(Answer):
    """The angles of all links [rad], each of shape S and in (−π, π]."""

    FIELDS = {
        **Answer.FIELDS,
        "theta1": NUMBER,
        "theta4": NUMBER,
        "theta2": NUMBER,
        "theta3": NUMBER,
        "assembly": NUMBER,
    }

    #: Driven link 1, A to B.
    theta1: Floats
    #: Driven link 4, E to D.
    theta4: Floats
    #: Link 2, B to C.
    theta2: Floats
    #: Link 3, D to C.
    theta3: Floats
    #: The assembly mode: +1 where C lies left of the ray B→D, −1 right.
    assembly: Signs

    @property
    def theta(self) -> Floats:
        """θ1, θ4 as an argument of other methods, shape S + (2,)."""
        return np.stack((self.theta1, self.theta4), axis=-1)


@dataclass(frozen=True, eq=False)
class Motion(Answer):
    """The motion of C, of the tool and of links 2 and 3."""

    FIELDS = {
        **Answer.FIELDS,
        "c": POINT,
        "c_velocity": POINT,
        "c_acceleration": POINT,
        "omega2": NUMBER,
        "omega3": NUMBER,
        "alpha2": NUMBER,
        "alpha3": NUMBER,
        "tool": POINT,
        "tool_velocity": POINT,
        "tool_acceleration": POINT,
    }

    #: C [m], shape S + (2,).
    c: Floats
    #: Its velocity [m/s], shape S + (2,).
    c_velocity: Floats
    #: Its acceleration [m/s²], shape S + (2,).
    c_acceleration: Floats
    #: Angular velocity of link 2 [rad/s].
    omega2: Floats
    #: Angular velocity of link 3 [rad/s].
    omega3: Floats
    #: Angular acceleration of link 2 [rad/s²].
    alpha2: Floats
    #: Angular acceleration of link 3 [rad/s²].
    alpha3: Floats
    #: The tool [m], shape S + (2,): C, unless the robot's tool is beside it.
    tool: Floats
    #: Its velocity [m/s], shape S + (2,).
    tool_velocity: Floats
    #: Its acceleration [m/s²], shape S + (2,).
    tool_acceleration: Floats


@dataclass(frozen=True, eq=False)
class Jacobian(Answer):
    """The answer of the compiled half to :meth:`fivebar.Arm.jacobian`."""

    FIELDS = {**Answer.FIELDS, "jacobian": ("axis", "joint")}

    #: ∂(x, y)/∂(θ1, θ4) [m/rad], shape S + (2, 2).
    jacobian: Floats


@dataclass(frozen=True, eq=False)
class InverseMotion(Inverse):
    """The motion of all links: rates [rad/s], accelerations [rad/s²], each of shape S."""

    FIELDS = {
        **Inverse.FIELDS,
        **{f"{letter}{link}": NUMBER for letter in ("omega", "alpha") for link in (1, 4, 2, 3)},
    }

    omega1: Floats
    omega4: Floats
    omega2: Floats
    omega3: Floats
    alpha1: Floats
    alpha4: Floats
    alpha2: Floats
    alpha3: Floats

    @property
    def omega(self) -> Floats:
        """ω1, ω4 as an argument of other methods [rad/s], shape S + (2,)."""
        return np.stack((self.omega1, self.omega4), axis=-1)

    @property
    def alpha(self) -> Floats:
        """α1, α4 as an argument of other methods [rad/s²], shape S + (2,)."""
        return np.stack((self.alpha1, self.alpha4), axis=-1)


@dataclass(frozen=True, eq=False)
class Reaction:
    """Forces in the joints [N], each of shape S + (2,)."""

    #: In A, of the ground on link 1.
    a: Floats
    #: In B, of link 1 on link 2.
    b: Floats
    #: In C, of link 2 on link 3.
    c: Floats
    #: In D, of link 4 on link 3.
    d: Floats
    #: In E, of the ground on link 4.
    e: Floats


@dataclass(frozen=True, eq=False)
class InverseDynamics(Answer):
    """The torques of a motion: torque = mass_matrix · (α1, α4) + bias_torque."""

    FIELDS = {
        **Answer.FIELDS,
        "torque": JOINTS,
        "mass_matrix": ("joint", "of_joint"),
        "bias_torque": JOINTS,
        **{f"reaction_{joint}": POINT for joint in "abcde"},
    }

    #: τ1, τ4 on links 1 and 4 [N·m], shape S + (2,).
    torque: Floats
    #: M(q) [kg·m²], shape S + (2, 2).
    mass_matrix: Floats
    #: The nonlinear effects h(q, q̇), of velocities, gravity and external force [N·m],
    #: shape S + (2,).
    bias_torque: Floats
    #: The forces in the joints.
    reaction: Reaction

    @classmethod
    def of(
        cls: Type[InverseDynamics], status: Statuses, fields: List[Floats]
    ) -> InverseDynamics:
        """The answer of these fields, in the order of ``FIELDS``."""
        answer = super().of(status, fields)
        answer.__dict__["reaction"] = Reaction(*fields[3:])
        return answer


@dataclass(frozen=True, eq=False)
class ForwardDynamics(Answer):
    """The accelerations that torques give [rad/s²], each of shape S."""

    FIELDS = {
        **Answer.FIELDS,
        "alpha1": NUMBER,
        "alpha4": NUMBER,
    }

    #: Of link 1.
    alpha1: Floats
    #: Of link 4.
    alpha4: Floats

    @property
    def alpha(self) -> Floats:
        """α1, α4 as an argument of other methods, shape S + (2,)."""
        return np.stack((self.alpha1, self.alpha4), axis=-1)


@dataclass(frozen=True, eq=False)
class Derivatives(Answer):
    """The motion of C and the torques, with their derivatives, exact to rounding.

    The quantities y: C [m], its velocity [m/s] and acceleration [m/s²], the torques on links 1 and 4 [N·m]. The
    variables x: θ [rad], ω [rad/s], α [rad/s²] of joints 1 and 4, l1…l4 and the base [m], the masses of links 1 to
    4 [kg]. A changed length or mass leaves the centres of mass and the moments of inertia about them as they are.
    """

    #: The names of the quantities, in their order.
    QUANTITIES = LABELS["quantity"]
    #: The names of the variables, in their order.
    VARIABLES = LABELS["variable"]
    FIELDS = {
        **Answer.FIELDS,
        "value": ("quantity",),
        "first": ("quantity", "variable"),
        "second": ("quantity", "variable", "of_variable"),
    }

    #: y, shape S + (8,).
    value: Floats
    #: ∂y/∂x, shape S + (8, 15).
    first: Floats
    #: ∂²y/∂x∂x, shape S + (8, 15, 15); None with ``order=1``.
    second: Optional[Floats] = None
