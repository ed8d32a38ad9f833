"""Studies in Python and by the program give the same answers."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

import fivebar

FILES = Path(__file__).resolve().parents[2] / "host/files"


def answer(program, *arguments):
    """What the program prints with `--json`."""
    command = [program, *map(str, arguments), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return json.loads(done.stdout.splitlines()[-1])


def without(figures, *names):
    return {name: value for name, value in figures.items() if name not in names}


@pytest.mark.parametrize("name", ["benchtop", "usp_2dof", "leg"])
def test_workspaces_are_those_of_the_program(program, tmp_path, name):
    expected = answer(program, "workspace", name, "--resolution", "4", "--out", tmp_path)
    found = fivebar.Arm.load(name).workspace(resolution=0.004)
    assert found == without(expected, "out_dir") and len(found["branches"]) == 8


@pytest.mark.parametrize("name", ["benchtop", "benchtop_belt"])
def test_margins_are_those_of_the_program(program, name):
    assert fivebar.Arm.load(name).margins() == answer(program, "margins", name)


def test_margins_without_masses_are_refused():
    with pytest.raises(fivebar.RobotError, match="motors|mass"):
        fivebar.Arm(l1=0.1, l2=0.16, base=0.08).margins()


@pytest.mark.parametrize("name", ["square", "eight"])
def test_plans_are_those_of_the_program(program, name):
    path = FILES / f"paths/{name}.json"
    expected = answer(program, "plan", "--path", path, "--torque-share", "0.8")
    robot = json.loads(path.read_text(encoding="utf-8")).get("robot", "benchtop")
    arm = fivebar.Arm.load(robot)
    for given in (path, path.read_text(encoding="utf-8"), json.loads(path.read_text())):
        found = arm.plan(given, torque_share=0.8)
        assert without(found, "planning_s") == without(expected, "planning_s")
    slower = arm.plan(path, torque_share=0.4)
    assert slower["time_s"] > found["time_s"]


def test_plans_that_cannot_be_made_are_refused(arm):
    with pytest.raises(fivebar.FivebarError, match=r"torque_share must be in \(0, 1\]"):
        arm.plan({}, torque_share=1.2)
    with pytest.raises(fivebar.StudyError, match="study: missing field `path`"):
        arm.plan({})


def test_designs_are_those_of_the_program(program, tmp_path):
    specification = FILES / "designs/leg.toml"
    expected = answer(program, "design", specification, "--seed", "3", "--out", tmp_path)
    found = fivebar.design(specification, seed=3)
    assert found.figures == without(expected, "out_dir")
    assert found.robot_toml == (tmp_path / "best.toml").read_text(encoding="utf-8")
    lengths = fivebar.Arm.from_toml(found.robot_toml).lengths
    assert np.allclose(lengths, found.figures["whole_millimetres"]["link_lengths"], atol=1e-12)
    with pytest.raises(fivebar.StudyError, match="study, line 1: missing field"):
        fivebar.design("symmetric = true")


def test_the_jacobian_is_the_derivative_of_the_position(arm, poses):
    there = arm.inverse(poses[:2000])
    found = arm.jacobian(there.theta, there.assembly)
    step = 1e-6
    for joint, unit in enumerate(np.eye(2)):
        ahead = arm.forward(there.theta + step * unit, there.assembly).c
        behind = arm.forward(there.theta - step * unit, there.assembly).c
        differences = (ahead - behind) / (2.0 * step)
        scale = np.abs(found[..., joint]).max(axis=1, keepdims=True)
        assert np.all(np.abs(found[..., joint] - differences) < 1e-6 * (1.0 + scale**3))
    # A force on C is held by −JᵀF.
    force = np.array([1.5, -2.0])
    held = arm.inverse_dynamics(there.theta, assembly=there.assembly, external_force=force)
    assert np.allclose(held.torque, -np.swapaxes(found, -1, -2) @ force, rtol=1e-9, atol=1e-12)


def test_an_arm_is_made_from_its_lengths():
    arm = fivebar.Arm(l1=0.12, l2=0.16, base=0.1)
    assert arm.lengths == (0.12, 0.16, 0.16, 0.12, 0.1) and not arm.has_masses
    other = fivebar.Arm(l1=0.1, l2=0.2, l3=0.21, l4=0.11, base=0)
    assert other.lengths == (0.1, 0.2, 0.21, 0.11, 0.0)
    with pytest.raises(fivebar.RobotError):
        fivebar.Arm(l1=-0.1, l2=0.2, base=0.1)
    with pytest.raises(TypeError):
        fivebar.Arm([0.1, 0.2, 0.2, 0.1, 0.1])
