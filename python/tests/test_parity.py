"""Every command of the program has its answer in Python, the same to the last bit, for every built-in robot."""

import json
import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

import fivebar

FILES = Path(__file__).resolve().parents[2] / "host/files"
JOB = "G1 X10 F3000\nG1 Y5\n"
MEASURED = {"points": "benchtop_holes", "bars": "benchtop_bars", "holes": "benchtop_unknown_holes"}
CLASSES = """
[[input]]
name = "fine"
sd = 1e-5
cost = 3.0
[[length]]
name = "fine"
sd = 1e-6
cost = 2.0
[[length]]
name = "coarse"
sd = 1e-5
cost = 1.0
"""
#: Keys that only the program has, or that say how long it took.
OWN = {"out_dir", "wall_s", "planning_s"}
#: Commands without figures, and what Python has in their place.
ELSEWHERE = {
    "board-test": "of a board",
    "bridge": "of a controller",
    "clear": "of a controller",
    "commission": "of a controller",
    "completions": "of the shell",
    "doctor": "of this computer",
    "drive": "of a controller",
    "flash": "of a board",
    "help": "help()",
    "hil": "of a board",
    "man": "help()",
    "monitor": "of a controller",
    "new": "asks questions on the terminal",
    "pen": "of a controller whose motors are off",
    "replay": "of a controller",
    "teach": "of a controller",
    "text": "of the shell: its file is a job",
    "pil": "of the emulated board; its figures are those of sim, with instructions",
    "ros": "a program of ROS has rclpy",
    "serve": "of a browser",
    "settings": "of a controller",
}
CASES = []
# Some robots have no tolerances, which the program tells of, too.
pytestmark = pytest.mark.filterwarnings(r"ignore:.*the file has no \[tolerance\]")


def case(command, robots=None):
    """One row of the table: arguments of the program beside a call of the package, for these robots."""
    def add(ask):
        CASES.extend(pytest.param(command, ask, name, id=f"{ask.__name__}-{name}")
                     for name in robots or fivebar.built_in())
        return ask
    return add


def table(name):
    return np.genfromtxt(FILES / f"measurements/{name}.csv", delimiter=",", skip_header=1)


def written(folder, name, text):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@case("accuracy")
def accuracy_at(name, folder):
    # Where the arm of these lengths is at home, or else before its base.
    arm = fivebar.Arm.load(name)
    x, y = arm.forward(arm.home).c.tolist() if arm.has_masses else (0.5 * arm.lengths[4], 0.15)
    return ([name, f"--at={x!r},{y!r}", "--force=1,2", "--samples=500", "--seed=3"],
            lambda: arm.accuracy((x, y), force=(1, 2), samples=500, seed=3))


@case("accuracy")
def accuracy_map(name, folder):
    classes = written(folder, "classes.toml", CLASSES)
    wanted = ["--wanted=1mm", "--classes", classes]
    return ([name, "--map", *wanted],
            lambda: fivebar.Arm.load(name).accuracy_map(wanted=1e-3, classes=classes))


@case("accuracy")
def accuracy_along(name, folder):
    job = written(folder, "job.gcode", JOB)
    return [name, "--path", job], lambda: fivebar.Arm.load(name).accuracy_along(job)


@case("accuracy", ["loose_four_bar", "four_bar"])
def accuracy_of_linkages(name, folder):
    return ([name, "--samples=300", "--time=0.1"],
            lambda: fivebar.linkage_accuracy(name, time=0.1, samples=300))


@case("accuracy", ["slider"])
def accuracy_of_sliders(name, folder):
    path = FILES / f"robots/{name}.toml"
    return ([path, "--at=0.02,0.1", "--samples=300"],
            lambda: fivebar.slider_accuracy(path, (0.02, 0.1), samples=300))


@case("calibrate")
def calibration(name, folder):
    files = {kind: FILES / f"measurements/{stem}.csv" for kind, stem in MEASURED.items()}
    given = [part for kind, path in files.items() for part in (f"--{kind}", path)]
    given += ["--photo", FILES / "measurements/benchtop_photo.csv"]
    tables = {kind: table(stem) for kind, stem in MEASURED.items()}
    photos = [table("benchtop_photo")]
    return (["--robot", name, *given],
            lambda: fivebar.Arm.load(name).calibrate(**tables, photos=photos).figures)


@case("calibrate")
def calibration_on_a_plate(name, folder):
    holes = FILES / "measurements/benchtop_holes.csv"
    return (["--robot", name, "--points", holes, "--plain"],
            lambda: fivebar.Arm.load(name).calibrate(table(holes.stem), plain=True).figures)


@case("calibrate")
def calibration_poses(name, folder):
    return (["--robot", name, "--propose", "7"],
            lambda: fivebar.Arm.load(name).calibration_poses(7))


@case("clearance")
def clearance(name, folder):
    return ([name, "--radius=20um", "--scale=0.3", "--out", folder / "clearance"],
            lambda: fivebar.Arm.load(name).clearance([20e-6], scale=0.3))


@case("design", ["leg", "plotter"])
def design(name, folder):
    path = FILES / f"designs/{name}.toml"
    return [path, "--seed=3"], lambda: fivebar.design(path, seed=3).figures


@case("identify")
def excitations(name, folder):
    return ["--robot", name, "--propose"], lambda: fivebar.Arm.load(name).excitations()


@case("identify", [name for name in fivebar.built_in() if fivebar.Arm.load(name).has_masses])
def identification(name, folder):
    try:
        logs = [fivebar.Arm.load(name).simulated_log(second=second) for second in (False, True)]
    except fivebar.FivebarError:
        logs = [np.zeros((3, 5))] * 2  # an arm without motors with currents
    files = [folder / "first.csv", folder / "second.csv"]
    drives = "torque1_nm,torque4_nm" if name == "leg" else "current1_a,current4_a"
    for log, path in zip(logs, files):
        np.savetxt(path, log, delimiter=",", comments="", fmt="%.17g",
                   header=f"time_s,theta1_rad,theta4_rad,{drives}")
    return (["--robot", name, "--log", files[0], "--validate", files[1]],
            lambda: fivebar.Arm.load(name).identify(logs[0], validate=logs[1]).figures)


@case("identify")
def identification_of_a_payload(name, folder):
    arm = fivebar.Arm.load("benchtop")
    log = arm.simulated_log()
    path = folder / "log.csv"
    np.savetxt(path, log, delimiter=",", comments="", fmt="%.17g",
               header="time_s,theta1_rad,theta4_rad,current1_a,current4_a")
    return (["--robot", name, "--log", path, "--payload"],
            lambda: fivebar.Arm.load(name).identify_payload(log).figures)


@case("linkage", sorted(path.stem for path in (FILES / "linkages").glob("*.toml")))
def linkage(name, folder):
    return [name, "--out", folder], lambda: fivebar.linkage(name)


@case("margins")
def margins(name, folder):
    return [name], lambda: fivebar.Arm.load(name).margins()


@case("mobility", sorted(path.stem for path in (FILES / "mobility").glob("*.toml")))
def mobility(name, folder):
    path = FILES / f"mobility/{name}.toml"
    return [path], lambda: fivebar.mobility(path)[-1]


@case("photo")
def photo_marks(name, folder):
    job = FILES / "jobs/fivebar.gcode"
    options = {"scale": 0.4, "turn": np.radians(10.0)}
    marks = folder / "marks.gcode"

    def ask():
        text, places = fivebar.Arm.load(name).photo_marks(job, **options)
        assert text == marks.read_text(encoding="utf-8")
        return places
    return [job, "--robot", name, "--scale=0.4", "--rotate=10", "--draw-marks", marks], ask


@case("photo")
def photo(name, folder):
    job, picture = FILES / "jobs/fivebar.gcode", FILES / "photos/fivebar.png"
    text, places = fivebar.Arm.load("benchtop").photo_marks(job)
    marks = written(folder, "marks.gcode", text)
    corners = np.array(places["marks_m"])
    distances = [(1 + a, 1 + b, float(np.hypot(*(corners[a] - corners[b]))))
                 for a, b in ((0, 1), (1, 2), (2, 3), (0, 3), (0, 2))]
    lengths = folder / "distances.csv"
    np.savetxt(lengths, distances, delimiter=",", comments="", fmt="%.17g",
               header="from,to,length")
    return ([job, picture, "--robot", name, "--marks", marks, "--distances", lengths,
             "--window=2mm", "--out", folder / "photo"],
            lambda: fivebar.Arm.load(name).photo(job, picture, marks, distances=distances,
                                                 window=2e-3).figures)


@case("plan", sorted(path.stem for path in (FILES / "paths").glob("*.json")))
def plan(name, folder):
    path = FILES / f"paths/{name}.json"
    robot = json.loads(path.read_text(encoding="utf-8")).get("robot", "benchtop")
    return (["--path", path, "--torque-share=0.8", "--jerk=20000"],
            lambda: fivebar.Arm.load(robot).plan(path, torque_share=0.8, jerk=20000.0).to_dict())


@case("plan", [*fivebar.built_in(), str(FILES / "robots/short_couplers.toml")])
def crossing(name, folder):
    ends = ["--from=0.06,0.115", "--to=0.03,0.012", "--time=0.3", "--simulate"]
    return (["--robot", name, "--crossing", *ends],
            lambda: fivebar.Arm.load(name).crossing((0.06, 0.115), (0.03, 0.012), 0.3,
                                                    simulate=True))


@case("sim")
def sim(name, folder):
    job = written(folder, "job.gcode", JOB)
    arm = fivebar.Arm.load(name)
    return ([job, "--robot", name, "--scale=0.5", "--by-cause", "--out", folder / "sim"],
            lambda: arm.simulate(job, scale=0.5, compare_pid=True, by_cause=True).summary)


@case("sim", ["no_mismatch", "encoder_dies"])
def sim_of_a_scenario(name, folder):
    path = FILES / f"scenarios/{name}.toml"
    return ([path, "--out", folder / "sim"],
            lambda: fivebar.simulate(path, compare_pid=True).summary)


@case("workspace")
def workspace(name, folder):
    return ([name, "--resolution=5", "--out", folder],
            lambda: fivebar.Arm.load(name).workspace(resolution=0.005))


@pytest.mark.parametrize(("command", "ask", "name"), CASES)
def test_the_answer_is_that_of_the_command(program, tmp_path, command, ask, name):
    arguments, call = ask(name, tmp_path)
    given = [program, command, *map(str, arguments), "--json"]
    done = subprocess.run(given, capture_output=True, text=True, check=False)
    lines = done.stdout.splitlines()
    if not lines:
        # What the program refuses the package refuses.
        assert done.returncode == 1, done.stderr
        with pytest.raises((fivebar.FivebarError, OSError)):
            call()
        return
    expected, found = comparable(json.loads(lines[-1])), comparable(call())
    assert expected.keys() == found.keys()
    # As text, so that −0.0 differs from 0.0.
    for key in expected:
        assert json.dumps(found[key]) == json.dumps(expected[key]), key


def comparable(answer):
    """An answer in the order of its keys, without those that only the program has."""
    if isinstance(answer, dict):
        return {key: comparable(answer[key]) for key in sorted(answer.keys() - OWN)}
    return [comparable(part) for part in answer] if isinstance(answer, list) else answer


@pytest.mark.parametrize("name", fivebar.built_in())
def test_robot_files_and_exports_are_those_of_the_program(program, name):
    arm = fivebar.Arm.load(name)
    ask = {"robots": lambda _: arm.toml, "export": arm.export}
    for command, form in [("robots", None), *(("export", form) for form in ("mjcf", "urdf", "dot"))]:
        given = [program, command, *([form] if form else []), name]
        done = subprocess.run(given, capture_output=True, check=False)
        if done.returncode == 0:
            assert ask[command](form) == done.stdout.decode()
        else:
            with pytest.raises(fivebar.RobotError):
                ask[command](form)


@pytest.mark.parametrize("name", fivebar.built_in())
def test_queries_are_answered_as_by_the_methods(program, name):
    arm = fivebar.Arm.load(name)
    # Multiples of 2⁻¹², which JSON represents exactly.
    reach = int(4096 * (arm.lengths[0] + arm.lengths[1]))
    points = np.random.default_rng(5).integers(-reach, reach, (200, 2)) / 4096
    there = arm.inverse(points)
    moving = {"omega1": 1.5, "omega4": -0.5, "alpha1": 3.0, "alpha4": 8.0}
    force = [1.0, -2.0]
    questions = []
    for c, status, (theta1, theta4), side in zip(points, there.status, there.theta, there.assembly):
        elbows = {"elbow1": arm.elbow1.name.lower(), "elbow4": arm.elbow4.name.lower()}
        questions.append({"op": "inverse", "c": c.tolist(), **elbows})
        if status == 0:
            state = {"theta1": theta1, "theta4": theta4,
                     "assembly": fivebar.Side(side).name.lower(), **moving}
            questions += [{"op": "forward", **state}, {"op": "motion", **state},
                          {"op": "inverse_dynamics", **state, "external_force": force},
                          {"op": "forward_dynamics", **state, "external_force": force,
                           "torque": [0.1, 0.2]}]
    lines = "\n".join(map(json.dumps, questions))
    done = subprocess.run([program, "query", "--robot", name], input=lines,
                          capture_output=True, text=True, check=True)
    replies = list(map(json.loads, done.stdout.splitlines()))
    assert len(replies) == len(questions) and there.ok.sum() > 20
    for question, reply in zip(questions, replies):
        op = question["op"]
        if op == "inverse":
            found = arm.inverse(question["c"])
        else:
            theta = [question["theta1"], question["theta4"]]
            omega, alpha = ([moving[f"{letter}1"], moving[f"{letter}4"]]
                            for letter in ("omega", "alpha"))
            rest = {"forward": (), "motion": (omega, alpha), "inverse_dynamics": (omega, alpha),
                    "forward_dynamics": (omega, [0.1, 0.2])}[op]
            options = {"assembly": question["assembly"]}
            if op.endswith("dynamics"):
                options["external_force"] = force
            try:
                found = getattr(arm, op)(theta, *rest, **options)
            except fivebar.RobotError:
                assert "error" in reply
                continue
        assert reply.get("error", "ok") == fivebar.Status(int(found.status)).kind
        if "error" not in reply:
            for key, value in reply.items():
                of = getattr(found, key)
                if key == "reaction":
                    assert {joint: getattr(of, joint).tolist() for joint in "abcde"} == value
                elif isinstance(value, str):
                    assert fivebar.Side(int(of)).name.lower() == value
                else:
                    assert of.tolist() == value, (op, key)


def test_every_command_is_in_the_table(program):
    text = subprocess.run([program, "--help"], capture_output=True, text=True, check=True).stdout
    listed = re.findall(r"^  ([a-z-]+) ", text.split("Commands:")[1].split("Options:")[0], re.M)
    assert len(listed) > 25
    tested = {values.values[0] for values in CASES} | {"export", "query", "robots"}
    missing = set(listed) - tested - ELSEWHERE.keys()
    assert not missing, f"no answer in Python: {missing}"
    assert set(listed) == tested | ELSEWHERE.keys()
    # A command of a controller has no figures, but those of boards and computers.
    for command in ELSEWHERE:
        done = subprocess.run([program, command, "--help"], capture_output=True, text=True,
                              check=False, env={**os.environ, "NO_COLOR": "1"})
        has_figures = "--json" in done.stdout
        assert has_figures == (command in ("board-test", "doctor", "hil", "pil")), command
