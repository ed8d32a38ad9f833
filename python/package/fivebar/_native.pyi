"""The compiled half: flat arrays in, flat arrays out. Not for users."""

from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, final

import numpy as np
from numpy.typing import NDArray

_Numbers = NDArray[np.float64]
_Signs = NDArray[np.int8]
_Rows = Sequence[Sequence[float]]
_Placed = Tuple[str, str, Optional[Sequence[float]], float, float]
_Answer = Tuple[List[_Numbers], NDArray[np.uint8]]

__all__ = [
    "Connection",
    "Plant",
    "Robot",
    "Scenario",
    "Study",
    "accuracy",
    "accuracy_along",
    "accuracy_blocks",
    "accuracy_map_of",
    "accuracy_part",
    "built_in",
    "calibrate",
    "calibration_poses",
    "clearance",
    "crossing",
    "derivatives",
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
    "linkage_accuracy",
    "margins",
    "mobility",
    "mode_change",
    "motion",
    "photo",
    "photo_marks",
    "plan",
    "simulated_log",
    "slider_accuracy",
    "statuses",
    "taught_path_as",
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
    def file(self) -> str: ...
    @property
    def text(self) -> str: ...
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
    @staticmethod
    def petal(robot: Robot) -> Scenario: ...
    def run(
        self,
        *,
        origin: Optional[Sequence[float]],
        scale: Optional[float],
        seed: Optional[int],
        computed_torque: Optional[bool],
        mismatch: Dict[str, Any],
        tolerance: Optional[float],
        compare_pid: bool,
        by_cause: bool,
    ) -> Tuple[
        str,
        Dict[str, NDArray[Any]],
        int,
        List[Tuple[float, str]],
        Optional[float],
        List[str],
    ]: ...

@final
class Connection:
    def __new__(
        cls, robot: Robot, to: str, image: Optional[str], upload: bool, real_time: bool
    ) -> Connection: ...
    @property
    def place(self) -> str: ...
    def state(self) -> str: ...
    def home(self, at: Optional[Sequence[float]], again: bool) -> None: ...
    def motors_on(self) -> None: ...
    def motors_off(self) -> None: ...
    def clear_fault(self) -> None: ...
    def move_to(self, to: Sequence[float], speed: float) -> None: ...
    def move_joints(self, to: Sequence[float], speed: float) -> None: ...
    def set_tool(self, level: float) -> None: ...
    def draw(
        self,
        scenario: Scenario,
        origin: Optional[Sequence[float]],
        scale: Optional[float],
        progress: Optional[Callable[[int, int, Optional[int]], None]],
        on_pause: Optional[Callable[[str], None]],
    ) -> List[str]: ...
    def begin_stream(self, joints: bool, rate: float, delay: Optional[float]) -> None: ...
    def begin_impedance(
        self,
        stiffness: Sequence[float],
        damping: Sequence[float],
        fixtures: Sequence[Tuple[str, Sequence[float], float, float]],
        rate: float,
    ) -> None: ...
    def stream_point(
        self,
        position: Sequence[float],
        velocity: Optional[Sequence[float]],
        force: Sequence[float],
    ) -> None: ...
    def end_stream(self) -> None: ...
    def be_led(self, seconds: float) -> str: ...
    def replay(self, taught: str, speed: float) -> None: ...
    def stop(self) -> None: ...
    def emergency_stop(self) -> None: ...
    def close(self) -> None: ...

def taught_path_as(taught: str, form: str) -> str: ...

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

@final
class Study:
    def __new__(
        cls, file: str, text: str, folder: str, seed: int, drawing: Optional[str]
    ) -> Study: ...
    def __getnewargs__(self) -> Tuple[str, str, str, int, Optional[str]]: ...
    @property
    def searches(self) -> int: ...
    def required_dexterity(self, index: int) -> float: ...
    def search(
        self, index: int, threads: int, record: bool
    ) -> Tuple[str, Optional[_Numbers]]: ...
    def dexterities(self, rows: _Numbers) -> _Numbers: ...
    def finish(self, found: Sequence[str]) -> Tuple[str, List[Tuple[str, str]]]: ...
    def kept(self, found: Sequence[Optional[str]]) -> str: ...
    def known(self, text: str) -> Optional[List[Optional[str]]]: ...

def built_in() -> List[str]: ...
def mode_change(
    robot: Robot, theta: Sequence[float], elbow1: int, elbow4: int
) -> List[List[float]]: ...
def statuses() -> List[Tuple[int, str, str]]: ...
def inverse(
    robot: Robot, points: _Numbers, elbow1: _Signs, elbow4: _Signs, of_tool: bool
) -> _Answer: ...
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
    of_tool: bool,
) -> _Answer: ...
def inverse_dynamics(
    robot: Robot,
    theta: _Numbers,
    omega: _Numbers,
    alpha: _Numbers,
    assembly: _Signs,
    external_force: _Numbers,
) -> _Answer: ...
def derivatives(
    robot: Robot, theta: _Numbers, omega: _Numbers, alpha: _Numbers, assembly: _Signs
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
def accuracy(
    robot: Robot,
    state: Sequence[Sequence[float]],
    samples: int,
    seed: int,
    parts: Optional[Sequence[_Numbers]],
) -> str: ...
def accuracy_blocks(samples: int) -> int: ...
def accuracy_part(
    robot: Robot,
    state: Sequence[Sequence[float]],
    samples: int,
    seed: int,
    blocks: Sequence[int],
) -> _Numbers: ...
def accuracy_map_of(
    robot: Robot,
    region: Optional[Sequence[float]],
    force: Sequence[float],
    wanted: Optional[Tuple[float, str]],
) -> str: ...
def linkage_accuracy(file: str, time: float, samples: int, seed: int) -> str: ...
def slider_accuracy(
    file: str, at: Sequence[float], force: Sequence[float], samples: int, seed: int
) -> str: ...
def crossing(
    robot: Robot, ends: Sequence[Sequence[float]], time: float, simulate: bool
) -> str: ...
def clearance(
    scenario: Scenario,
    clearances: _Rows,
    origin: Optional[Sequence[float]],
    scale: Optional[float],
) -> str: ...
def photo_marks(robot: Robot, job: _Placed) -> Tuple[str, str]: ...
def photo(
    robot: Robot,
    job: _Placed,
    picture: str,
    marks: str,
    distances: Optional[_Rows],
    lens: Optional[float],
    window: float,
) -> Tuple[str, List[List[float]]]: ...
def simulated_log(robot: Robot, second: bool) -> List[List[float]]: ...
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
