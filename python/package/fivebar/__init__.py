"""Kinematics, dynamics and simulation of a planar five-bar arm over NumPy arrays.

>>> import fivebar
>>> arm = fivebar.Arm.load("benchtop")
>>> arm
<fivebar.Arm 'benchtop', l1…l4 and base 0.1, 0.16, 0.16, 0.1, 0.08 m>

Two driven base joints A and E, a closed loop A–B–C–D–E, the tool at C. Link 1 is A→B and
driven, link 2 B→C, link 3 D→C, link 4 E→D and driven. SI units; angles [rad] absolute,
counter-clockwise from +x; points [m] in the frame of the base, A at the origin, E on +x.
Keys, names and errors are those of ``fivebar query``.
"""

from . import sim
from ._arm import Arm
from ._connection import ArmState, LiveArm, connect
from ._errors import (
    ControllerError,
    FaultError,
    FivebarError,
    InvalidError,
    JobError,
    PoseError,
    RobotError,
    RunError,
    SingularError,
    StoppedError,
    StudyError,
    UnreachableError,
)
from ._measured import Found, Photo
from ._mechanisms import linkage, linkage_accuracy, mobility, slider_accuracy
from ._native import __version__
from ._plan import Plan, PlanSamples
from ._plant import Plant, Plants, PlantState
from ._results import (
    Derivatives,
    Forward,
    ForwardDynamics,
    Inverse,
    InverseDynamics,
    InverseMotion,
    Motion,
    Reaction,
)
from ._robots import built_in
from ._simulation import NO_MISMATCH, Run, Trace, simulate
from ._status import Side, Status
from ._stream import AsyncStream, Stream, StreamState
from ._synthesis import Design, design, dexterities
from ._teaching import TaughtPath
from ._touch import Fixture, Impedance

__all__ = [
    "Arm",
    "ArmState",
    "AsyncStream",
    "ControllerError",
    "Derivatives",
    "Design",
    "FaultError",
    "FivebarError",
    "Fixture",
    "Forward",
    "ForwardDynamics",
    "Found",
    "Impedance",
    "InvalidError",
    "Inverse",
    "InverseDynamics",
    "InverseMotion",
    "JobError",
    "LiveArm",
    "Motion",
    "NO_MISMATCH",
    "Photo",
    "Plan",
    "PlanSamples",
    "Plant",
    "PlantState",
    "Plants",
    "PoseError",
    "Reaction",
    "RobotError",
    "Run",
    "RunError",
    "Side",
    "SingularError",
    "Status",
    "StoppedError",
    "Stream",
    "StreamState",
    "StudyError",
    "TaughtPath",
    "Trace",
    "UnreachableError",
    "__version__",
    "built_in",
    "connect",
    "design",
    "dexterities",
    "linkage",
    "linkage_accuracy",
    "mobility",
    "sim",
    "simulate",
    "slider_accuracy",
]

# Tracebacks and help show the package's name instead of the private module's.
for _name in __all__:
    if hasattr(globals()[_name], "__module__"):
        globals()[_name].__module__ = __name__
