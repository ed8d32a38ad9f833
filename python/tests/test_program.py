"""The package and the program `fivebar` give the same results."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

import fivebar

ROOT = Path(__file__).resolve().parents[2]
FILES = ROOT / "host/files"
#: Keys that only the program's runs have, or that differ: the time that a run took.
OWN = ("out_dir", "wall_s", "pid_tip_error")


def figures(program, tmp_path, *arguments):
    """The last line of `fivebar sim --json`."""
    command = [program, "sim", *map(str, arguments), "--json", "--out", tmp_path / "out"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return json.loads(done.stdout.splitlines()[-1]), done.returncode


def without(summary, *names):
    return {name: value for name, value in summary.items() if name not in names}


def test_a_job_comes_to_the_same_figures_to_the_last_bit(arm, program, tmp_path):
    job = tmp_path / "short.gcode"
    job.write_text("G1 X10 F3000\nG2 X0 Y0 I-5 J0\nG1 Y8\nM117 hello\n")
    expected, status = figures(program, tmp_path, job, "--origin", "0.03,0.2", "--scale", "1.5")
    assert status == 0
    run = arm.simulate(job, origin=(0.03, 0.2), scale=1.5)
    assert without(run.summary, *OWN) == without(expected, *OWN)
    assert set(expected) - set(run.summary) == {"out_dir", "pid_tip_error"}
    pid = arm.simulate(job, origin=(0.03, 0.2), scale=1.5, computed_torque=False)
    assert pid.summary["tip_error"] == expected["pid_tip_error"]
    text = arm.simulate(job.read_text(), origin=[0.03, 0.2], scale=1.5)
    assert without(text.summary, *OWN, "scenario") == without(expected, *OWN, "scenario")
    assert run.warnings[0].startswith("no code moves or switches the tool")
    assert run.warnings[1:] == ["line 4: M117 is not supported and is skipped"]


def test_the_trace_is_that_of_the_report(arm, program, tmp_path):
    job = tmp_path / "short.gcode"
    job.write_text("G1 X10 F3000\nG1 Y8\n")
    figures(program, tmp_path, job)
    rows = np.genfromtxt(tmp_path / "out/trace.csv", delimiter=",", names=True)
    trace = arm.simulate(job).trace
    assert np.allclose(trace.time, rows["time_s"], rtol=0, atol=1e-7)
    assert np.array_equal(trace.line, rows["line"])
    assert np.array_equal(trace.saturated, rows["saturated"] == 1)
    assert np.allclose(trace.tool_level, rows["tool_level"], rtol=0, atol=1e-5)
    for ours, theirs in {
        "reference": "reference_{}_m", "tool": "tool_{}_m", "angle": "theta{}_rad",
        "reference_angle": "reference_theta{}_rad",
        "reference_velocity": "reference_omega{}_rad_s",
        "reference_acceleration": "reference_alpha{}_rad_s2", "torque": "torque{}_nm",
        "current_set_point": "current_set_point{}_a", "current": "current{}_a",
        "duty": "duty{}",
    }.items():
        column = getattr(trace, ours)
        for index, of in enumerate("xy" if theirs.endswith("{}_m") else "14"):
            assert np.allclose(column[:, index], rows[theirs.format(of)], rtol=0, atol=1e-9)
    assert trace.tip_error.max() == pytest.approx(
        np.hypot(rows["tool_x_m"] - rows["reference_x_m"],
                 rows["tool_y_m"] - rows["reference_y_m"]).max(), abs=2e-9)


@pytest.mark.parametrize("name", ["no_mismatch", "encoder_dies"])
def test_a_scenario_comes_to_the_same_figures(program, tmp_path, name):
    scenario = FILES / f"scenarios/{name}.toml"
    expected, status = figures(program, tmp_path, scenario)
    run = fivebar.simulate(scenario)
    assert without(run.summary, *OWN) == without(expected, *OWN)
    assert [fault for _, fault in run.faults] == expected["faults"]
    assert bool(run.faults) == (status == 1) == (name == "encoder_dies")


def test_another_arm_stands_in_for_a_scenarios_own():
    arm = fivebar.Arm.load("usp_2dof")
    run = arm.simulate(FILES / "scenarios/no_mismatch.toml")
    assert run.summary["robot"] == "usp_2dof"


def test_an_arm_without_mismatch_is_followed_more_closely(arm):
    job = {"job": "G1 X20 F3000\nG1 Y10", "origin": (0.03, 0.2)}
    declared = arm.simulate(**job).summary["tip_error"]["rms_m"]
    believed = arm.simulate(**job, mismatch=fivebar.NO_MISMATCH).summary["tip_error"]["rms_m"]
    heavy = arm.simulate(**job, mismatch={"payload": 0.1}).summary["tip_error"]["rms_m"]
    assert believed < declared < heavy
    eccentric = [[{"harmonic": 1, "amplitude": 4e-3}], []]
    off = {"encoder_error": eccentric, "home_error": [2e-4, 0], "stiffness": [5000, 5000]}
    assert arm.simulate(**job, mismatch=off).summary["tip_error"]["rms_m"] > 2 * declared
    again = arm.simulate(**job, seed=1).trace
    other = arm.simulate(**job, seed=2).trace
    assert np.array_equal(again.tool, arm.simulate(**job).trace.tool)
    assert not np.array_equal(again.tool, other.tool)


@pytest.mark.parametrize(("job", "options", "error", "message"), [
    ("G1 X10 F0", {}, fivebar.JobError, "job, line 1: .*feed rate must be above zero"),
    ("", {}, fivebar.JobError, "an empty file"),
    ("G1 X5 F600\nG1 X900", {"origin": (0.0, 0.2)}, fivebar.JobError, "job, line 2: "),
    ("petal.gcode", {}, fivebar.FivebarError, r"give pathlib\.Path\('petal\.gcode'\)"),
    ("G1 X1 F600", {"scale": 0.0}, fivebar.FivebarError, "scale must be a positive"),
    ("G1 X1 F600", {"origin": (0.0, np.nan)}, fivebar.FivebarError, "origin must be two"),
    ("G1 X1 F600", {"mismatch": {"mass": 1.0}}, ValueError, "no such figure.*`mass`"),
    ("G1 X1 F600", {"mismatch": {"payload": -1.0}}, ValueError, "`payload`.* at least 0"),
    ("G1 X1 F600", {"mismatch": {"cogging": [1e-3]}}, ValueError, "`cogging` .*length 1"),
    ("G1 X1 F600", {"mismatch": {"stiffness": [0.0, 900.0]}}, ValueError, "`stiffness`.*positive"),
    (Path("nowhere.gcode"), {}, FileNotFoundError, r"cannot read nowhere\.gcode"),
])
def test_what_cannot_be_run_is_refused_with_the_reason(arm, job, options, error, message):
    with pytest.raises(error, match=message) as refused:
        arm.simulate(job, **options)
    if "line 2" in message:
        assert refused.value.line == 2
        assert np.hypot(*refused.value.point) == pytest.approx(0.26, abs=0.02)


def test_questions_are_answered_as_the_program_answers_them(arm, program):
    rng = np.random.default_rng(11)
    # Multiples of 2⁻¹², which JSON represents exactly.
    points = rng.integers((-1200, -1200), (1600, 1200), (400, 2)) / 4096
    questions = [{"op": "inverse", "c": c, "elbow1": "right", "elbow4": "left"}
                 for c in points.tolist()]
    lines = "\n".join(map(json.dumps, questions))
    done = subprocess.run([program, "query", "--robot", "benchtop"], input=lines,
                          capture_output=True, text=True, check=True)
    answer = arm.inverse(points)
    replies = list(map(json.loads, done.stdout.splitlines()))
    assert len(replies) == len(points) and 0 < answer.ok.sum() < len(points)
    for row, reply in enumerate(replies):
        status = fivebar.Status(int(answer.status[row]))
        assert reply.get("error", "ok") == status.kind
        if status:
            assert reply["message"].startswith(status.reason)
        else:
            assert [reply["theta1"], reply["theta4"]] == answer.theta[row].tolist()
            assert fivebar.Side[reply["assembly"].upper()] == answer.assembly[row]
