"""The compiled half: flat arrays in, flat arrays out. Not for users."""

from typing import Any, Dict, List, Optional, Sequence, Tuple, final

import numpy as np
from numpy.typing import NDArray

_Numbers = NDArray[np.float64]
_Signs = NDArray[np.int8]
_Answer = Tuple[List[_Numbers], NDArray[np.uint8]]

__all__ = [
    "Robot",
    "Scenario",
    "built_in",
    "design",
    "forward",
    "forward_dynamics",
    "inverse",
    "inverse_dynamics",
    "inverse_motion",
    "margins",
    "mode_change",
    "motion",
    "plan",
    "statuses",
    "workspace",
]

@final
class Robot:
    @staticmethod
    def load(name_or_path: str) -> Robot: ...
    @staticmethod
    def parse(file: str, text: str) -> Robot: ...
    @property
    def name(self) -> str: ...
    @property
    def lengths(self) -> List[float]: ...
    @property
    def elbows(self) -> List[int]: ...
    @property
    def assembly(self) -> Optional[int]: ...
    @property
    def home(self) -> List[float]: ...
    @property
    def joint_limits(self) -> List[List[float]]: ...
    @property
    def tool_offset(self) -> List[float]: ...
    @property
    def has_masses(self) -> bool: ...

@final
class Scenario:
    @staticmethod
    def of_file(path: str, robot: Optional[Robot]) -> Scenario: ...
    @staticmethod
    def of_text(robot: Robot, text: str) -> Scenario: ...
    def run(
        self,
        *,
        origin: Optional[Sequence[float]],
        scale: Optional[float],
        seed: Optional[int],
        computed_torque: Optional[bool],
        mismatch: Dict[str, Any],
    ) -> Tuple[
        str,
        Dict[str, NDArray[Any]],
        int,
        List[Tuple[float, str]],
        Optional[float],
        List[str],
    ]: ...

def built_in() -> List[str]: ...
def mode_change(
    robot: Robot, theta: Sequence[float], elbow1: int, elbow4: int
) -> List[List[float]]: ...
def statuses() -> List[Tuple[int, str, str]]: ...
def inverse(robot: Robot, points: _Numbers, elbow1: _Signs, elbow4: _Signs) -> _Answer: ...
def forward(robot: Robot, theta: _Numbers, assembly: _Signs) -> _Answer: ...
def motion(
    robot: Robot, theta: _Numbers, omega: _Numbers, alpha: _Numbers, assembly: _Signs
) -> _Answer: ...
def inverse_motion(
    robot: Robot,
    points: _Numbers,
    velocity: _Numbers,
    acceleration: _Numbers,
    elbow1: _Signs,
    elbow4: _Signs,
) -> _Answer: ...
def inverse_dynamics(
    robot: Robot,
    theta: _Numbers,
    omega: _Numbers,
    alpha: _Numbers,
    assembly: _Signs,
    external_force: _Numbers,
) -> _Answer: ...
def forward_dynamics(
    robot: Robot,
    theta: _Numbers,
    omega: _Numbers,
    torque: _Numbers,
    assembly: _Signs,
    external_force: _Numbers,
) -> _Answer: ...
def workspace(robot: Robot, resolution: Optional[float]) -> str: ...
def margins(robot: Robot) -> str: ...
def plan(
    robot: Robot, file: str, text: str, torque_share: float, jerk: Optional[float]
) -> str: ...
def design(file: str, text: str, folder: str, seed: int) -> Tuple[str, str]: ...
