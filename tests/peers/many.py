"""What many programs write, drawn by Fivebar beside what an independent reader finds in the same file.

    python many.py OUR_EXAMPLE FOLDER TABLE

Each file is drawn within 0.05 mm of its reader, or refused with a sentence; the table has a row for each.
A program that is not installed is named and has no row.
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
    """Each file with its program."""
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
            for name in names:
                yield package, folder / name
        except Exception as error:
            print(f"not made: {package}: {error}", flush=True)


def drawn(example, file):
    """Our strokes and notes, or the refusal."""
    answer = subprocess.run([example, str(file)], capture_output=True, text=True, timeout=60)
    if answer.returncode:
        return None, answer.stderr.strip()
    return [numpy.array(stroke) for stroke in json.loads(answer.stdout)], answer.stderr.strip()


def without_texts(file):
    """An SVG without its texts, for which the readers have no strokes."""
    bare, count = re.subn(r"<text\b.*?</text>", "", file.read_text(), flags=re.DOTALL)
    if not count:
        return file
    copy = file.with_name(f"bare_{file.name}")
    copy.write_text(bare)
    return copy


def row(example, program, file):
    if file.suffix == ".svg":
        file = without_texts(file)
    ours, said = drawn(example, file)
    if ours is None:
        return [program, file.name, "", "", "refused", said]
    theirs = READERS[file.suffix](file)
    # Fivebar centres a drawing.
    to_corner = [[stroke - corners(one)[0] for stroke in one] for one in (ours, theirs)]
    return [program, file.name, len(ours), len(theirs), f"{hausdorff(*to_corner):.3f}", said.replace("\n", "; ")]


def main():
    arguments = argparse.ArgumentParser()
    for name in ("example", "folder", "table"):
        arguments.add_argument(name, type=Path)
    given = arguments.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for program, file in made(given.folder):
        try:
            rows.append(row(given.example, program, file))
        except Exception as error:
            rows.append([program, file.name, "", "", "unread", f"{type(error).__name__}: {error}"])
        print(*rows[-1], sep=" | ", flush=True)
    with given.table.open("w", newline="") as table:
        csv.writer(table, lineterminator="\n").writerows([["program", "file", "strokes", "strokes of the reader", "greatest distance [mm]", "notes"], *rows])


if __name__ == "__main__":
    main()
