#!/usr/bin/env python3
"""Draws random jobs with simulated stepper arms whose torque and masses are not those of their file, as fast as they
can: with the torque_share that `fivebar commission` measured on each arm, and with that of the robot file.

    scripts/torque_reserve.py --arms 40 --jobs 5 --seed 1 --out docs/verify/data/torque_reserve.csv

Each arm has its own torque of both motors, and its own masses with inertias. Each case of CASES has the same arms; a
job that an arm does not reach is replaced by another one. FIVEBAR names the program, target/debug/fivebar by default.
A row of the file is a job.
"""
import argparse
import concurrent.futures
import csv
import json
import math
import os
import pathlib
import random
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = os.environ.get("FIVEBAR") or ROOT / "target/debug/fivebar"
ROBOT_FILE = ROOT / "host/files/robots/benchtop_stepper.toml"
# What is changed in the robot file, what else is unknown: a payload [kg], and friction as a share; and by what the
# measured shares are multiplied: in an overload the jobs show that they can lose steps.
LONGER = {
    "gear_ratio = 4.0": "gear_ratio = 3.0",
    "base = 0.08": "base = 0.10",
    "length = 0.10": "length = 0.12",
    "length = 0.16": "length = 0.19",
}
CASES = {
    "benchtop": ({}, 0.0, 0.0, 1.0),
    "longer": (LONGER, 0.0, 0.0, 1.0),
    "more unknown": ({}, 0.02, 0.3, 1.0),
    "overload": (LONGER, 0.0, 0.0, 1.6),
}
# How far torque and masses are off at most, as shares.
TORQUE, MASS = 0.10, 0.15
# Where the middles of the jobs are [m], and half the size of the least and the greatest job [m].
MIDDLES, HALF = ((0.0, 0.08), (0.13, 0.19)), (0.008, 0.022)
COLUMNS = (
    "case,arm,torque_1,torque_4,mass,share_1,share_4,job,shape,seconds_measured,lost_measured,drawn_measured,"
    "seconds_default,lost_default,drawn_default"
).split(",")


def fivebar(*arguments):
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, stdin=subprocess.DEVNULL)


def polygon(draw, half):
    count, turn, way = draw.randint(3, 8), draw.uniform(0, math.tau), draw.choice([1, -1])
    angles = [turn + way * math.tau * it / count for it in range(count + 1)]
    return "polygon", [f"G1 X{half * math.cos(it):.3f} Y{half * math.sin(it):.3f}" for it in angles]


def zigzag(draw, half):
    count, turn = draw.randint(4, 10), draw.uniform(0, math.tau)
    points = [(half * (2 * it / count - 1), half * draw.uniform(0.2, 0.6) * (-1) ** it) for it in range(count + 1)]
    cos, sin = math.cos(turn), math.sin(turn)
    return "zigzag", [f"G1 X{x * cos - y * sin:.3f} Y{x * sin + y * cos:.3f}" for x, y in points]


def arcs(draw, half):
    """Half circles there and back whose ends are on one circle, left or right about."""
    angle, code, lines = draw.uniform(0, math.tau), draw.choice(["G2", "G3"]), []
    x, y = half * math.cos(angle), half * math.sin(angle)
    lines.append(f"G1 X{x:.3f} Y{y:.3f}")
    for _ in range(draw.randint(2, 5)):
        angle += draw.uniform(1.0, math.pi)
        to_x, to_y = half * math.cos(angle), half * math.sin(angle)
        lines.append(f"{code} X{to_x:.3f} Y{to_y:.3f} I{(to_x - x) / 2:.3f} J{(to_y - y) / 2:.3f}")
        x, y = to_x, to_y
    return "arcs", lines


def job(draw):
    """The shape of a job, its G-code in millimetres, and where its middle is [m]."""
    shape, (start, *strokes) = draw.choice([polygon, zigzag, arcs])(draw, 1e3 * draw.uniform(*HALF))
    lines = ["G21 G90 F18000", start.replace("G1", "G0"), "M3", *strokes, "M5", "M2", ""]
    return shape, "\n".join(lines), [draw.uniform(*ends) for ends in MIDDLES]


def in_motion(trace):
    """The time from the first to the last motion of the set-points [s]."""
    with trace.open(newline="") as text:
        speeds = ["reference_omega1_rad_s", "reference_omega4_rad_s"]
        times = [row["time_s"] for row in csv.DictReader(text) if any(float(row[it]) for it in speeds)]
    return float(times[-1]) - float(times[0])


def drawn(folder, robot, unknown, code, origin):
    """The seconds in motion of a job with this robot file, the steps that it lost, and whether it was drawn; none if
    the arm does not reach it."""
    (folder / "job.gcode").write_text(code)
    scenario = folder / "scenario.toml"
    place = ", ".join(f"{it:.4f}" for it in origin)
    scenario.write_text(f'robot = "{robot}"\njob = "job.gcode"\norigin = [{place}]\nscale = 1.0\n{unknown}')
    out = folder / "sim"
    shutil.rmtree(out, ignore_errors=True)
    done = fivebar("sim", scenario, "--time-optimal", "--json", "--out", out)
    if not done.stdout.startswith("{"):
        if "would leave its limits" in done.stderr or "too nearly straight" in done.stderr:
            return None
        sys.exit(f"{done.stderr}\n{scenario.read_text()}\n{code}")
    figures = json.loads(done.stdout)
    lost = sum(abs(it) for it in figures["lost_steps"])
    return f"{in_motion(out / 'trace.csv'):.4f}", lost, int(figures["drawn"])


def shares(text):
    return re.findall(r"^torque_share = (\S+)", text, re.MULTILINE)


def overloaded(text, overload):
    """A robot file with its shares multiplied."""
    pattern = re.compile(r"^torque_share = (\S+)", re.MULTILINE)
    return pattern.sub(lambda it: f"torque_share = {float(it[1]) * overload:.2f}", text)


def commission(out, robot, until, *scenario):
    return fivebar("commission", "--port", "simulated", "--out", out, "--robot", robot, "--until", until, *scenario)


def commissioned(folder, drawing, before, unknown):
    """The robot file that the step `reserve` wrote for this arm, and its shares; none if the step refused the arm."""
    out = folder / "out"
    out.mkdir()
    shutil.copy(before, out / "record.json")
    (folder / "job.gcode").write_text("G1 X1 F600\n")
    scenario = folder / "scenario.toml"
    scenario.write_text(f'robot = "{drawing}"\njob = "job.gcode"\n{unknown}')
    done = commission(out, drawing, "geometry", "--scenario", scenario)
    if done.returncode:
        print(done.stderr, file=sys.stderr)
        return None
    return out / "robot.toml", shares((out / "robot.toml").read_text())


def rows(case, number, drawing, before, options):
    """The rows of an arm: its draws depend on the seed and its number only."""
    draw = random.Random(1000 * options.seed + number)
    torques, mass = [round(draw.uniform(-TORQUE, TORQUE), 4) for _ in range(2)], round(draw.uniform(-MASS, MASS), 4)
    _, payload, friction, overload = CASES[case]
    unknown = f"link_mass = {mass}\ntorque_constant = {torques}\npayload = {payload}\nfriction = {friction}\n"
    unknown = f"[mismatch]\n{unknown}"
    found = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        measured = commissioned(folder, drawing, before, unknown)
        if measured is None:
            return found
        robot, both = measured
        if overload != 1.0:
            text = overloaded(robot.read_text(), overload)
            robot.write_text(text)
            both = shares(text)
        for index in range(1, options.jobs + 1):
            results = [None]
            while None in results:
                shape, code, origin = job(draw)
                results = [drawn(folder, it, unknown, code, origin) for it in (robot, drawing)]
            found.append([case, number, *torques, mass, *both, index, shape, *results[0], *results[1]])
    return found


def ratio(rows):
    """The mean of the jobs' times with the measured share over those with the default one."""
    return statistics.mean(float(row["seconds_measured"]) / float(row["seconds_default"]) for row in rows)


def summary(case, rows, refused):
    print(f"{case}: {len(rows)} jobs; arms that the step refused: {refused}")
    for share in ["measured", "default"]:
        lost = sum(row[f"lost_{share}"] > 0 for row in rows)
        whole = sum(row[f"drawn_{share}"] for row in rows)
        print(f"  {share} share: {lost} jobs with lost steps, {whole} drawn")
    both = [row for row in rows if row["drawn_measured"] and row["drawn_default"]]
    if both:
        print(f"  time with the measured share over that with the default: {ratio(rows):.3f} in the mean")
        print(f"  of the {len(both)} jobs that both draw: {ratio(both):.3f}")


def run(case, options, pool):
    """All rows of a case."""
    with tempfile.TemporaryDirectory() as name:
        drawing, before = pathlib.Path(name) / "arm.toml", pathlib.Path(name) / "out"
        text = ROBOT_FILE.read_text()
        for old, new in CASES[case][0].items():
            if old not in text:
                sys.exit(f"{ROBOT_FILE} has no {old}")
            text = text.replace(old, new)
        drawing.write_text(text)
        done = commission(before, drawing, "reserve")
        if done.returncode:
            sys.exit(done.stderr)
        record, numbers = before / "record.json", range(1, options.arms + 1)
        arms = list(pool.map(lambda it: rows(case, it, drawing, record, options), numbers))
    found = [dict(zip(COLUMNS, row)) for arm in arms for row in arm]
    summary(case, found, sum(not arm for arm in arms))
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, default in [("arms", 40), ("jobs", 5), ("seed", 1)]:
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--case", choices=CASES, action="append", help="this case only; may be repeated")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    options = parser.parse_args()
    with concurrent.futures.ThreadPoolExecutor(2) as pool, options.out.open("w", newline="") as text:
        writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for case in options.case or CASES:
            writer.writerows(run(case, options, pool))


if __name__ == "__main__":
    main()
