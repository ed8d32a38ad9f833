"""Studies in Python and by the program give the same answers."""

import json
import subprocess
from contextlib import nullcontext
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


def test_margins_without_masses_are_refused():
    with pytest.raises(fivebar.RobotError, match="motors|mass"):
        fivebar.Arm(l1=0.1, l2=0.16, base=0.08).margins()


def test_a_plan_is_that_of_its_path_in_any_form(arm):
    path = FILES / "paths/square.json"
    first, *others = [without(arm.plan(given, torque_share=0.8), "planning_s")
                      for given in (path, path.read_text(), json.loads(path.read_text()))]
    assert all(other == first for other in others)
    assert arm.plan(path, torque_share=0.4)["time_s"] > first["time_s"]


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


def test_the_area_of_a_ring_is_examined_as_the_closed_form_has_it():
    specification = FILES / "designs/leg.toml"
    # b cos ψ0 and b, and the ring of 1/κ = tan ψ0.
    angle = np.arctan(0.4)
    crank, coupler = 0.14 * np.cos(angle), 0.14
    half = coupler * np.sqrt(np.cos(2.0 * angle))
    arm = [crank, coupler, coupler, crank, 0.0]
    ring = [2.0 * half, 0.0, crank - half]
    wider = [2.0 * half + 1e-4, 0.0, crank - half]
    found = fivebar.dexterities(specification, [[arm + ring, arm + wider]])
    assert found.shape == (1, 2)
    assert found[0, 0] == pytest.approx(0.4, abs=1e-9) and found[0, 1] < 0.3995
    with pytest.raises(fivebar.FivebarError, match="last axis of length 8"):
        fivebar.dexterities(specification, arm)
    best = fivebar.design(specification).figures["best"]
    row = best["link_lengths"] + [best["size"]] + best["place"]
    assert fivebar.dexterities(specification, row) == best["dexterity"]


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


def test_the_derivatives_are_those_of_the_dynamics_and_of_differences(arm, poses):
    there = arm.inverse(poses[:50])
    rng = np.random.default_rng(3)
    omega, alpha = rng.uniform(-3, 3, (2, 50, 2))
    found = arm.derivatives(there.theta, omega, alpha, there.assembly)
    assert found.ok.all() and found.second.shape == (50, 8, 15, 15)
    needed = arm.inverse_dynamics(there.theta, omega, alpha, there.assembly)
    assert np.allclose(found.value[:, 6:], needed.torque, rtol=1e-11, atol=1e-13)
    # ∂τ/∂α is the mass matrix, and the velocity of C is its Jacobian by the rates.
    assert np.allclose(found.first[:, 6:, 4:6], needed.mass_matrix, rtol=1e-10, atol=1e-13)
    assert np.allclose(found.first[:, 2:4, 2:4], found.first[:, :2, :2], rtol=1e-10)
    # The second derivatives by the angles are differences of the first ones.
    names = fivebar.Derivatives.VARIABLES
    step = 1e-5
    for joint, unit in enumerate(np.eye(2)):
        ahead, behind = (
            arm.derivatives(there.theta + sign * step * unit, omega, alpha, there.assembly).first
            for sign in (1, -1)
        )
        expected = (ahead - behind) / (2 * step)
        second = found.second[:, :, :, names.index(("theta1", "theta4")[joint])]
        scale = np.abs(found.second).max(axis=(2, 3))[:, :, None]
        assert np.abs((second - expected) / scale).max() < 1e-5
    assert found.status[0] == 0 and not arm.derivatives([0.0, np.nan]).ok


def test_an_arm_is_made_from_its_lengths():
    arm = fivebar.Arm(l1=0.12, l2=0.16, base=0.1)
    assert arm.lengths == (0.12, 0.16, 0.16, 0.12, 0.1) and not arm.has_masses
    other = fivebar.Arm(l1=0.1, l2=0.2, l3=0.21, l4=0.11, base=0)
    assert other.lengths == (0.1, 0.2, 0.21, 0.11, 0.0)
    with pytest.raises(fivebar.RobotError):
        fivebar.Arm(l1=-0.1, l2=0.2, base=0.1)
    with pytest.raises(TypeError):
        fivebar.Arm([0.1, 0.2, 0.2, 0.1, 0.1])


@pytest.mark.parametrize("name", ["benchtop", "usp_2dof"])
def test_accuracies_are_those_of_the_program(program, tmp_path, name):
    arm = fivebar.Arm.load(name)
    place = arm.forward(arm.home).c
    at = f"--at={place[0]},{place[1]}"
    expected = answer(program, "accuracy", name, at, "--force", "1,2", "--samples", "500")
    # usp_2dof has no tolerances, which the package says.
    says = pytest.warns(UserWarning, match="tolerance") if name == "usp_2dof" else nullcontext()
    with says:
        assert arm.accuracy(place, force=(1, 2), samples=500) == expected


def test_accuracies_over_a_region_and_along_a_job_are_those_of_the_program(program, arm, tmp_path):
    region = (0.02, 0.15, 0.06, 0.2)
    expected = answer(program, "accuracy", "benchtop", "--map", "--region=0.02,0.15,0.06,0.2")
    assert arm.accuracy_map(region=region) == expected
    job = tmp_path / "job.gcode"
    job.write_text("G1 X10 F3000\nG1 Y5\n")
    for more, given in (([], {}), (["--origin=30mm,200mm"], {"origin": (0.03, 0.2)})):
        expected = answer(program, "accuracy", "benchtop", "--path", job, *more)
        assert arm.accuracy_along(job, **given) == expected
    with pytest.raises(fivebar.FivebarError, match="samples must be 2 or more"):
        arm.accuracy((0.04, 0.2), samples=1)
    with pytest.raises(fivebar.FivebarError, match="at must be two finite numbers"):
        arm.accuracy((0.04, np.nan))


@pytest.mark.parametrize("name", ["four_bar", "scotch_yoke", "shaper"])
def test_linkages_are_those_of_the_program(program, tmp_path, name):
    path = FILES / f"linkages/{name}.toml"
    expected = answer(program, "linkage", name, "--out", tmp_path)
    for source in (name, path, path.read_text(encoding="utf-8")):
        assert fivebar.linkage(source) == expected
    with pytest.raises(fivebar.StudyError, match="neither a built-in example"):
        fivebar.linkage("five_bat")


@pytest.mark.parametrize("name", ["delta", "stewart", "five-bar"])
def test_mobilities_are_those_of_the_program(program, name):
    path = FILES / f"mobility/{name}.toml"
    for source in (name, path, path.read_text(encoding="utf-8")):
        assert fivebar.mobility(source) == [answer(program, "mobility", name)]
    with pytest.raises(fivebar.StudyError):
        fivebar.mobility("delts")


def table(name):
    return np.genfromtxt(FILES / f"measurements/{name}.csv", delimiter=",", skip_header=1)


def test_calibrations_are_those_of_the_program(program, arm, tmp_path):
    files = {name: FILES / f"measurements/benchtop_{name}.csv"
             for name in ("holes", "bars", "unknown_holes", "photo")}
    options = {"points": files["holes"], "bars": files["bars"], "holes": files["unknown_holes"],
               "photo": files["photo"]}
    tables = {name: table(path.stem) for name, path in options.items()}
    photo = tables.pop("photo")
    for names in (["points"], ["points", "bars"], ["points", "bars", "holes", "photo"]):
        given = [part for name in names for part in (f"--{name}", options[name])]
        out = tmp_path / f"{len(names)}.toml"
        expected = answer(program, "calibrate", *given, "--out", out)
        photos = [photo] if "photo" in names else []
        chosen = {name: value for name, value in tables.items() if name in names}
        found = arm.calibrate(**chosen, photos=photos)
        assert found.figures == expected
        assert found.robot_toml == out.read_text(encoding="utf-8")
    lengths = fivebar.Arm.from_toml(found.robot_toml).lengths
    assert np.allclose(lengths, found.figures["link_lengths"], atol=1e-9)
    with pytest.raises(fivebar.StudyError):
        arm.calibrate(tables["points"][:2])
    with pytest.raises(fivebar.FivebarError, match="rows with the columns counts1"):
        arm.calibrate(tables["bars"])
    expected = answer(program, "calibrate", "--propose", "8")
    assert arm.calibration_poses(8) == expected


def test_identifications_are_those_of_the_program(program, arm, tmp_path):
    logs = [tmp_path / "first.csv", tmp_path / "second.csv"]
    excitations = answer(program, "identify", "--simulate", logs[0])
    assert arm.excitations() == excitations
    answer(program, "identify", "--simulate", logs[1], "--second")
    first, second = (np.genfromtxt(log, delimiter=",", skip_header=1)[:, :5] for log in logs)
    out = tmp_path / "out.toml"
    expected = answer(program, "identify", "--log", logs[0], "--validate", logs[1], "--out", out)
    found = arm.identify(first, validate=second)
    assert found.figures == expected
    assert found.robot_toml == out.read_text(encoding="utf-8")
    expected = answer(program, "identify", "--log", logs[0], "--payload")
    assert arm.identify_payload(first).figures == expected
    with pytest.raises(fivebar.RobotError):
        fivebar.Arm.load("benchtop_stepper").excitations()


@pytest.mark.parametrize(("change", "key"), [
    ({"cornres": "stop"}, "cornres"),
    ({"Payload": 0.1}, "Payload"),
    ({"limits": {"torque": [0.7, 0.7], "sped": [1.0, 1.0]}}, "sped"),
    ({"path": [{"kind": "line", "from": [0.01, 0.13], "to": [0.07, 0.13], "fed": 1.0}]}, "fed"),
])
def test_an_unknown_key_of_a_path_is_refused(arm, change, key):
    path = {"working_mode": ["right", "left"], "limits": {"torque": [0.7, 0.7]},
            "path": [{"kind": "line", "from": [0.01, 0.13], "to": [0.07, 0.13]}]}
    # Results of reference cases are not used.
    assert arm.plan({**path, "optimal_time_s": 1.0, "cross_checks_s": {}, "runs": []})
    with pytest.raises(fivebar.StudyError, match=key):
        arm.plan({**path, **change})


@pytest.mark.parametrize("place", ["case", "limb", "list"])
def test_an_unknown_key_of_a_mechanism_is_refused(place, tmp_path):
    path = tmp_path / "cases.json"

    def ask(cases):
        path.write_text(json.dumps(cases), encoding="utf-8")
        return fivebar.mobility(path)

    twists = [[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]]
    case = {"name": "one", "bodies": 2, "platform_body": 1, "joints": [{"a": 0, "b": 1, "twists": twists}]}
    assert ask({"graph": [case]})
    listed = {"graph": [case]}
    {"case": case, "limb": case["joints"][0], "list": listed}[place]["platfrom"] = 1
    with pytest.raises(fivebar.StudyError, match="platfrom"):
        ask(listed)
