"""The compiled half: flat arrays in, flat arrays out. Not for users."""

from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, final

import numpy as np
from numpy.typing import NDArray

_Numbers = NDArray[np.float64]
# One pair or sign, or an array of many; anything else raises TypeError.
_Pairs = Any
_Signs = Any
_Rows = Sequence[Sequence[float]]
_Placed = Tuple[str, str, Optional[Sequence[float]], float, float]
_Answer = Tuple[List[NDArray[Any]], NDArray[np.uint8]]
_Start = Tuple[Optional[Sequence[float]], Sequence[float], int]

__version__: str

__all__ = [
    "Connection",
    "Plan",
    "Plant",
    "Plants",
    "Robot",
    "Scenario",
    "Study",
    "__version__",
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
    "jacobian",
    "linkage",
    "linkage_accuracy",
    "margins",
    "mobility",
    "mode_change",
    "motion",
    "photo",
    "photo_marks",
    "simulated_log",
    "slider_accuracy",
    "statuses",
    "taught_path_as",
    "taught_rests",
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
    @property
    def without_tolerance(self) -> Optional[str]: ...

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
    def begin_stream(
        self, joints: bool, rate: float, delay: Optional[float], goes_on: bool
    ) -> None: ...
    def stream_state(self) -> Optional[str]: ...
    def change_impedance(self, stiffness: Sequence[float], damping: Sequence[float]) -> None: ...
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
def taught_rests(taught: str, least: float) -> List[List[float]]: ...

@final
class Plant:
    def __new__(
        cls,
        robot: Robot,
        start: _Start,
        mismatch: Dict[str, Any],
        tolerance: Optional[float],
    ) -> Plant: ...
    def copy(self) -> Plant: ...
    def step(self, torque: _Pairs, time: float, force: _Pairs) -> None: ...
    @property
    def theta(self) -> _Numbers: ...
    @property
    def omega(self) -> _Numbers: ...
    @property
    def tool(self) -> _Numbers: ...
    @property
    def time(self) -> float: ...
    @property
    def numbers(self) -> _Numbers: ...
    def set_numbers(self, numbers: _Numbers) -> None: ...

@final
class Plants:
    def __new__(
        cls,
        robot: Robot,
        starts: Sequence[Tuple[_Start, Dict[str, Any]]],
        tolerance: Optional[float],
    ) -> Plants: ...
    def step(self, torque: _Numbers, time: float, force: _Numbers) -> Optional[int]: ...
    @property
    def theta(self) -> _Numbers: ...
    @property
    def omega(self) -> _Numbers: ...
    @property
    def tool(self) -> _Numbers: ...
    @property
    def numbers(self) -> _Numbers: ...
    def set_motions(
        self, robot: Robot, indices: Sequence[int], motions: _Numbers, assembly: int
    ) -> None: ...
    def set_numbers(self, indices: Sequence[int], numbers: _Numbers) -> None: ...

@final
class Plan:
    def __new__(
        cls, robot: Robot, file: str, text: str, torque_share: float, jerk: Optional[float]
    ) -> Plan: ...
    def answer(self) -> str: ...
    def sample(self, times: _Numbers) -> _Numbers: ...

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
    robot: Robot, points: _Pairs, elbow1: _Signs, elbow4: _Signs, of_tool: bool
) -> _Answer: ...
def forward(robot: Robot, theta: _Pairs, assembly: _Signs) -> _Answer: ...
def motion(
    robot: Robot, theta: _Pairs, omega: _Pairs, alpha: _Pairs, assembly: _Signs
) -> _Answer: ...
def jacobian(
    robot: Robot, theta: _Pairs, assembly: _Signs, of_tool: bool
) -> _Answer: ...
def inverse_motion(
    robot: Robot,
    points: _Pairs,
    velocity: _Pairs,
    acceleration: _Pairs,
    elbow1: _Signs,
    elbow4: _Signs,
    of_tool: bool,
) -> _Answer: ...
def inverse_dynamics(
    robot: Robot,
    theta: _Pairs,
    omega: _Pairs,
    alpha: _Pairs,
    external_force: _Pairs,
    assembly: _Signs,
) -> _Answer: ...
def derivatives(
    robot: Robot, theta: _Pairs, omega: _Pairs, alpha: _Pairs, assembly: _Signs, second: bool
) -> _Answer: ...
def forward_dynamics(
    robot: Robot,
    theta: _Pairs,
    omega: _Pairs,
    torque: _Pairs,
    external_force: _Pairs,
    assembly: _Signs,
) -> _Answer: ...
def workspace(robot: Robot, resolution: Optional[float]) -> str: ...
def margins(robot: Robot) -> str: ...
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
