"""Travel between strokes: ours beside that of vpype's linesort, on ten drawings that this makes.

    python travel.py OUR_EXAMPLE VPYPE FOLDER [--write PAGE.md]

Fails if ours is more than 1.05 times that of `linesort` in any drawing.
"""

import argparse
import math
import random
import re
import subprocess
from pathlib import Path

SIDE = 150.0  # of each drawing [mm]


def lines(count, length, seed):
    """Short lines at random places."""
    dice = random.Random(seed)
    for _ in range(count):
        x, y, turn = dice.uniform(0, SIDE), dice.uniform(0, SIDE), dice.uniform(0, math.tau)
        yield [(x, y), (x + length * math.cos(turn), y + length * math.sin(turn))]


def hatches(seed):
    """Rows of a hatch, each broken where a random disc is."""
    dice = random.Random(seed)
    discs = [(dice.uniform(0, SIDE), dice.uniform(0, SIDE), dice.uniform(5, 20)) for _ in range(12)]
    for row in range(100):
        y = row * SIDE / 100
        cuts = sorted((x - math.sqrt(r * r - (y - cy) ** 2), x + math.sqrt(r * r - (y - cy) ** 2))
                      for x, cy, r in discs if abs(y - cy) < r)
        start = 0.0
        for low, high in cuts:
            if low > start:
                yield [(start, y), (low, y)]
            start = max(start, high)
        if start < SIDE:
            yield [(start, y), (SIDE, y)]


def circles(seed):
    """Circles of random radii."""
    dice = random.Random(seed)
    for _ in range(200):
        x, y, r = dice.uniform(0, SIDE), dice.uniform(0, SIDE), dice.uniform(1, 6)
        yield [(x + r * math.cos(i * math.tau / 24), y + r * math.sin(i * math.tau / 24)) for i in range(25)]


def maze(seed):
    """Walls of a grid, each there or not."""
    dice = random.Random(seed)
    for i in range(30):
        for j in range(30):
            x, y, step = i * SIDE / 30, j * SIDE / 30, SIDE / 30
            yield [(x, y), (x + step, y)] if dice.random() < 0.5 else [(x, y), (x, y + step)]


def text(seed):
    """Lines of words of letters of two strokes."""
    dice = random.Random(seed)
    for row in range(12):
        for column in range(40):
            if dice.random() < 0.15:
                continue
            x, y = column * SIDE / 40, row * SIDE / 12
            for _ in range(2):
                yield [(x + dice.uniform(0, 2.5), y + dice.uniform(0, 5)) for _ in range(3)]


def contours(seed):
    """Closed curves around three hills."""
    dice = random.Random(seed)
    hills = [(dice.uniform(30, 120), dice.uniform(30, 120)) for _ in range(3)]
    for x, y in hills:
        for level in range(1, 16):
            wave, turn = dice.uniform(0.05, 0.2), dice.uniform(0, math.tau)
            ring = [2 * level * (1 + wave * math.sin(3 * i * math.tau / 60 + turn)) for i in range(60)]
            points = [(x + r * math.cos(i * math.tau / 60), y + r * math.sin(i * math.tau / 60))
                      for i, r in enumerate(ring)]
            yield points + points[:1]


def stipple(seed):
    """Points denser towards a corner, as strokes of 0.2 mm."""
    dice = random.Random(seed)
    for _ in range(1500):
        x, y = SIDE * dice.random() ** 2, SIDE * dice.random() ** 2
        yield [(x, y), (x + 0.2, y)]


def rays(seed):
    """Rays from a circle outwards."""
    for i in range(180):
        c, s = math.cos(i * math.tau / 180), math.sin(i * math.tau / 180)
        yield [(75 + 10 * c, 75 + 10 * s), (75 + 70 * c, 75 + 70 * s)]


DRAWINGS = {
    "300 long lines": lambda: lines(300, 30.0, 1),
    "2000 short lines": lambda: lines(2000, 3.0, 2),
    "a hatch with holes": lambda: hatches(3),
    "200 circles": lambda: circles(4),
    "a maze": lambda: maze(5),
    "12 lines of text": lambda: text(6),
    "contours": lambda: contours(7),
    "stipple": lambda: stipple(8),
    "rays": lambda: rays(9),
    "two hatches": lambda: list(hatches(10)) + [[(y, x) for x, y in line] for line in hatches(11)],
}


def written(folder, name, strokes):
    file = folder / (name.replace(" ", "-") + ".svg")
    paths = "\n".join("M" + "L".join(f"{x:.4f} {y:.4f}" for x, y in stroke) for stroke in strokes)
    file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {SIDE} {SIDE}" width="{SIDE}mm" '
                    f'height="{SIDE}mm"><path d="{paths}" fill="none" stroke="black"/></svg>')
    return file


def ours(example, file):
    answer = subprocess.run([example, str(file)], check=True, capture_output=True, text=True).stdout
    strokes, travel = re.search(r"(\d+) strokes, ([\d.]+) mm", answer).groups()
    return int(strokes), float(travel)


def theirs(vpype, file, *options):
    command = [vpype, "read", "--quantization", "0.01mm", str(file), "linesort", *options, "stat"]
    answer = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return float(re.findall(r"Pen-up length: ([\d.]+)", answer)[-1]) * 25.4 / 96.0


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("example")
    arguments.add_argument("vpype")
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("--write", type=Path)
    given = arguments.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    table = ["| drawing | strokes | `fivebar` [m] | vpype `linesort` [m] | ratio | `linesort --two-opt` [m] | ratio |",
             "|---|---|---|---|---|---|---|"]
    worst = 0.0
    for name, drawing in DRAWINGS.items():
        file = written(given.folder, name, list(drawing()))
        strokes, travel = ours(given.example, file)
        plain, two_opt = theirs(given.vpype, file), theirs(given.vpype, file, "--two-opt")
        worst = max(worst, travel / plain)
        table.append(f"| {name} | {strokes} | {travel / 1e3:.3f} | {plain / 1e3:.3f} | {travel / plain:.2f} "
                     f"| {two_opt / 1e3:.3f} | {travel / two_opt:.2f} |")
        print(table[-1], flush=True)
    if given.write is not None:
        given.write.write_text("\n".join([
            "# Travel between strokes", "",
            "`tests/peers/travel.py` makes this page. It draws ten pictures of 150 mm from seeds and compares the travel from "
            "the end", "of each stroke to the beginning of the next one, pen up, with that of vpype 1.15.", "", *table, ""]),
            encoding="utf-8")
    if worst > 1.05:
        raise SystemExit(f"travel.py: ours is {worst:.2f} times that of linesort in one drawing; 1.05 at most")


if __name__ == "__main__":
    main()
