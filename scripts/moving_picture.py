#!/usr/bin/env python3
"""Writes a run as an animated SVG: the arm and what it draws, in real time, again and again.

    cargo run -- --out out/sim
    scripts/moving_picture.py host/files/robots/benchtop.toml out/sim/trace.csv >docs/use/moving-arm.svg
"""
import csv
import math
import pathlib
import sys
import tomllib

# Frames a second, and how long the finished drawing stays [s].
RATE, REST = 15, 1.5
SCALE = 2000  # [1/m]
# A point of the drawing is left out if the line through its neighbours passes so near [px].
NEAR = 0.25
HEAD = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="{view}" role="img" aria-label="The arm draws">
<style>.paper{{fill:#fcfcfa}}.ink{{stroke:#1763b6;stroke-width:1.6}}.arm{{stroke:#1d2430;stroke-width:6}}
.joint{{fill:#fcfcfa;stroke:#1d2430;stroke-width:2}}polyline{{fill:none;stroke-linecap:round;stroke-linejoin:round}}
@media(prefers-color-scheme:dark){{.paper,.joint{{fill:#14181d}}.ink{{stroke:#6db3ff}}.arm,.joint{{stroke:#e4e8ee}}}}</style>
<rect class="paper" x="{x}" y="{y}" width="100%" height="100%"/>"""


def pixel(point):
    return f"{SCALE * point[0]:.1f},{-SCALE * point[1]:.1f}"


def thinned(points):
    """The points without those that lie on a line with their neighbours."""
    kept = points[:1]
    for point, after in zip(points[1:], points[2:]):
        (x, y), (x1, y1), (x2, y2) = point, kept[-1], after
        length = math.dist((x1, y1), (x2, y2))
        off = abs((x2 - x1) * (y - y1) - (y2 - y1) * (x - x1)) / length if length else 0.0
        # The second keeps slow curves, whose points are near each other.
        if SCALE * off > NEAR or SCALE * math.dist(point, kept[-1]) > 4:
            kept.append(point)
    return kept + points[-1:]


def animate(attribute, values, key_times, seconds):
    return (f'<animate attributeName="{attribute}" dur="{seconds:.2f}s" repeatCount="indefinite" '
            f'keyTimes="{";".join(key_times)}" values="{";".join(values)}"/>')


def main(robot_file, trace_file):
    robot = tomllib.loads(pathlib.Path(robot_file).read_text())
    crank1, crank4 = robot["link"][0]["length"], robot["link"][3]["length"]
    with open(trace_file, newline="") as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    start, end = rows[0]["time_s"], rows[-1]["time_s"]
    seconds = end - start + REST
    share = lambda time: f"{(time - start) / seconds:.4f}"
    every = max(1, round(len(rows) / (RATE * (end - start))))
    frames = rows[::every] + rows[-1:]

    a, e = (0.0, 0.0), (robot["base"], 0.0)
    chains = []
    for row in frames:
        b = (crank1 * math.cos(row["theta1_rad"]), crank1 * math.sin(row["theta1_rad"]))
        d = (e[0] + crank4 * math.cos(row["theta4_rad"]), crank4 * math.sin(row["theta4_rad"]))
        chains.append([a, b, (row["tool_x_m"], row["tool_y_m"]), d, e])
    key_times = [share(row["time_s"]) for row in frames] + ["1"]

    strokes, down = [], False
    for row in rows:
        if row["tool_level"] > 0.5:
            if not down:
                strokes.append([])
            strokes[-1].append(row)
        down = row["tool_level"] > 0.5

    points = [point for chain in chains for point in chain]
    margin = 14
    left, right = (f(SCALE * x for x, _ in points) for f in (min, max))
    top, bottom = (f(-SCALE * y for _, y in points) for f in (min, max))
    left, top = round(left - margin), round(top - margin)
    view = f"{left} {top} {round(right + margin) - left} {round(bottom + margin) - top}"
    print(HEAD.format(view=view, x=left, y=top))
    for stroke in strokes:
        line = [(row["tool_x_m"], row["tool_y_m"]) for row in stroke]
        length = [0.0]
        for before, after in zip(line, line[1:]):
            length.append(length[-1] + math.dist(before, after))
        if length[-1] == 0.0:
            continue
        shown = list(range(0, len(stroke), every)) + [len(stroke) - 1]
        times = ["0"] + [share(stroke[i]["time_s"]) for i in shown] + ["1"]
        left_out = ["1"] + [f"{1 - length[i] / length[-1]:.3f}" for i in shown] + ["0"]
        print(f'<polyline class="ink" pathLength="1" stroke-dasharray="1 2" points="'
              f'{" ".join(map(pixel, thinned(line)))}">'
              + animate("stroke-dashoffset", left_out, times, seconds) + "</polyline>")
    shapes = [" ".join(map(pixel, chain)) for chain in chains]
    print(f'<polyline class="arm" points="{shapes[-1]}">'
          + animate("points", shapes + shapes[-1:], key_times, seconds) + "</polyline>")
    for joint in range(5):
        x = [f"{SCALE * chain[joint][0]:.1f}" for chain in chains]
        y = [f"{-SCALE * chain[joint][1]:.1f}" for chain in chains]
        moves = "" if joint in (0, 4) else "".join(
            animate(name, values + values[-1:], key_times, seconds) for name, values in (("cx", x), ("cy", y)))
        print(f'<circle class="joint" r="6" cx="{x[-1]}" cy="{y[-1]}">{moves}</circle>')
    print("</svg>")


if len(sys.argv) != 3:
    sys.exit(__doc__)
main(*sys.argv[1:])
