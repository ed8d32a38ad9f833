"""The compiled half: flat arrays in, flat arrays out. Not for users."""

from typing import Any, Dict, List, Optional, Sequence, Tuple, final

import numpy as np
from numpy.typing import NDArray

_Numbers = NDArray[np.float64]
_Signs = NDArray[np.int8]
_Rows = Sequence[Sequence[float]]
_Answer = Tuple[List[_Numbers], NDArray[np.uint8]]

__all__ = [
    "Plant",
    "Robot",
    "Scenario",
    "accuracy",
    "accuracy_along",
    "accuracy_map_of",
    "built_in",
    "calibrate",
    "calibration_poses",
    "design",
    "excitations",
    "export",
    "forward",
    "forward_dynamics",
    "identify",
    "identify_payload",
    "inverse",
    "inverse_dynamics",
    "inverse_motion",
    "linkage",
    "margins",
    "mobility",
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

@final
class Plant:
    def __new__(
        cls,
        robot: Robot,
        theta: Optional[Sequence[float]],
        assembly: int,
        mismatch: Dict[str, Any],
    ) -> Plant: ...
    def step(self, torque: Sequence[float], time: float, force: Sequence[float]) -> None: ...
    @property
    def theta(self) -> List[float]: ...
    @property
    def omega(self) -> List[float]: ...
    @property
    def tool(self) -> List[float]: ...
    @property
    def time(self) -> float: ...

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
def accuracy(
    robot: Robot, state: Sequence[Sequence[float]], samples: int, seed: int
) -> str: ...
def accuracy_map_of(
    robot: Robot, region: Optional[Sequence[float]], force: Sequence[float]
) -> str: ...
def accuracy_along(
    robot: Robot,
    file: str,
    text: str,
    origin: Optional[Sequence[float]],
    scale: float,
    force: Sequence[float],
) -> str: ...
def calibrate(
    robot: Robot,
    points: _Rows,
    bars: _Rows,
    holes: _Rows,
    photos: Sequence[_Rows],
    sigmas: Sequence[float],
    plain: bool,
) -> Tuple[str, str, List[str]]: ...
def calibration_poses(robot: Robot, count: int, sigma: float) -> str: ...
def identify(
    robot: Robot, log: _Rows, second: Optional[_Rows]
) -> Tuple[str, str, List[str]]: ...
def identify_payload(robot: Robot, log: _Rows) -> Tuple[str, str, List[str]]: ...
def excitations(robot: Robot) -> str: ...
def linkage(file: str, text: Optional[str]) -> str: ...
def mobility(file: str, text: str) -> List[str]: ...
def export(robot: Robot, format: str) -> Optional[str]: ...
