"""Fixtures that the tests share."""

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import fivebar

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def arm():
    return fivebar.Arm.load("benchtop")


@pytest.fixture(scope="session")
def poses(arm):
    """20,000 random points that the benchtop arm reaches, away from singularities."""
    rng = np.random.default_rng(7)
    points = rng.uniform((-0.1, 0.02), (0.2, 0.26), (40_000, 2))
    points = points[arm.inverse(points).ok]
    motion = arm.inverse_motion(points, (1.0, 1.0))
    calm = motion.ok & (np.abs(np.stack((motion.omega2, motion.omega3))).max(axis=0) < 60.0)
    assert calm.sum() > 20_000
    return points[calm][:20_000]


@pytest.fixture(scope="session")
def vectors():
    """The reference states, stacked key by key, for each robot."""
    text = (ROOT / "tests/data/five_bar_vectors.json").read_text(encoding="utf-8")
    data = json.loads(text)
    assert len(data["cases"]) == 180
    sets = []
    for index, robot in enumerate(data["robots"]):
        cases = [case for case in data["cases"] if case["robot"] == index]
        stacked = {key: np.array([case[key] for case in cases])
                   for key in cases[0] if key not in ("robot", "reaction")}
        stacked["reaction"] = {joint: np.array([case["reaction"][joint] for case in cases])
                               for joint in "abcde"}
        sets.append((fivebar.Arm.from_toml(robot_file(robot)), stacked))
    return sets


def robot_file(robot):
    *lengths, base = robot["link_lengths"]
    lines = [f'name = "{robot["name"]}"', f"gravity = {[float(g) for g in robot['gravity']]}",
             f"base = {base}", f"payload = {robot['payload']}"]
    for length, mass, com, inertia in zip(lengths, robot["mass"], robot["com"],
                                          robot["inertia_about_com"]):
        lines += ["[[link]]", f"length = {length}", f"mass = {mass}",
                  f"com = {[float(x) for x in com]}", f"inertia = {inertia}"]
    return "\n".join(lines)


#: Answers to the questions of `fivebar new`: drives on a CAN bus that speak the protocol of MIT-type drives; another base and
#: steppers of own data. The rest are defaults.
ANSWERS = {
    "mit": [*9 * [""], "can", "mit", *12 * [""]],
    "new": ["", "", "0.1", *6 * [""], "stepper", "-5", "400", "8", "0.3", *12 * [""]],
}


@pytest.fixture(scope="session")
def robot_of(program, tmp_path_factory):
    """The built-in robot of a name, or the file that `fivebar new` writes for it."""
    folder = tmp_path_factory.mktemp("arms")

    def written(name):
        if name not in ANSWERS:
            return name
        file = folder / f"{name}.toml"
        if not file.exists():
            lines = "".join(f"{line}\n" for line in ANSWERS[name])
            subprocess.run([program, "new", file], input=lines, text=True, check=True, capture_output=True)
        return str(file)

    return written


@pytest.fixture(scope="session")
def program():
    """The program `fivebar`, built before the tests: see scripts/python.sh."""
    path = Path(os.environ.get("CARGO_TARGET_DIR") or ROOT / "target") / "debug/fivebar"
    assert path.exists(), f"no {path}: build it with `cargo build`"
    return path
