"""What many programs write, drawn by Fivebar beside what an independent reader finds in the same file.

    python many.py OUR_EXAMPLE FOLDER TABLE

Each file is drawn within 0.05 mm of its reader, or refused with a sentence, or what is left out is noted; the table has a row
for each. Texts of an SVG, for which the readers have no strokes, are taken out before. A program that is not installed
is named and has no row. Fails at a difference that nothing says.
"""

import argparse
import csv
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy
from makers import FILES, SOURCES
from makers_in_python import written
from readers import READERS
from shapes import corners, hausdorff

NEAR = 0.05  # mm


def made(folder):
    """Each program with its file."""
    for name, text in SOURCES.items():
        (folder / name).write_text(text)
    for program, name, order in FILES:
        done = subprocess.run(["timeout", "100", "sh", "-c", order], cwd=folder, capture_output=True, stdin=subprocess.DEVNULL)
        if (folder / name).is_file():
            yield program, folder / name
        else:
            print(f"not made: {name} by {program}: {done.stderr.decode(errors='replace').strip()[-200:]}", flush=True)
    for package, names in written(folder):
        try:
            yield from ((package, folder / name) for name in names)
        except ImportError as error:
            print(f"not made: {package}: {error}", flush=True)


def drawn(example, file):
    """Our strokes and notes, or the refusal."""
    answer = subprocess.run([example, str(file)], capture_output=True, text=True, timeout=60)
    if answer.returncode:
        return None, answer.stderr.strip()
    return [numpy.array(stroke) for stroke in json.loads(answer.stdout)], answer.stderr.strip()


def readable(file):
    """An SVG without its texts, for which the readers have no strokes, and without paths that have no data, which svgelements
    does not read."""
    text = file.read_text()
    bare = re.sub(r"<text\b.*?</text>|<path(?![^>]*\sd=)[^>]*/>", "", text, flags=re.DOTALL)
    if bare == text:
        return file
    copy = file.with_name(f"bare_{file.name}")
    copy.write_text(bare)
    return copy


def row(example, program, file):
    """Program, file, verdict, the strokes of both, their greatest distance [mm], and what we say."""
    if file.suffix == ".svg":
        file = readable(file)
    ours, said = drawn(example, file)
    said = said.replace("\n", "; ")
    if ours is None:
        return [program, file.name, "refused", "", "", "", said]
    theirs = READERS[file.suffix](file)
    # Fivebar centres a drawing.
    off = hausdorff(*([stroke - corners(one)[0] for stroke in one] for one in (ours, theirs)))
    verdict = "drawn" if off <= NEAR else "noted" if "left out" in said else "DIFFERENT"
    return [program, file.name, verdict, len(ours), len(theirs), f"{off:.3f}", said]


HEAD = ["program", "file", "verdict", "strokes", "strokes of the reader", "greatest distance [mm]", "refusal or notes"]


def main():
    arguments = argparse.ArgumentParser()
    for name in ("example", "folder", "table"):
        arguments.add_argument(name, type=Path)
    given = arguments.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for program, file in made(given.folder):
        rows.append(row(given.example, program, file))
        print(*rows[-1], sep=" | ", flush=True)
    with given.table.open("w", newline="") as table:
        csv.writer(table, lineterminator="\n").writerows([HEAD, *rows])
    silent = [name for _, name, verdict, *_ in rows if verdict == "DIFFERENT"]
    if silent or not rows:
        sys.exit(f"many.py: more than {NEAR} mm off, and nothing says so: {', '.join(silent)}")


if __name__ == "__main__":
    main()
