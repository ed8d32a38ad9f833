#!/usr/bin/env python3
"""Runs `fivebar board-test` on the simulated bare board: the production image, and a hand that connects the
wires that the program asks for. Every row must be filled and passed.

    verify/chip/board_test.py BOARD IMAGE PROGRAM

BOARD is `board` of this folder, IMAGE the image `stm32f405`, PROGRAM `fivebar`.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import time

sys.path.append(str(pathlib.Path(__file__).parent))
from bring_up import ENTER, Board


def test(program, board, folder):
    """The printed report, and how many tasks the hand has done."""
    command = [program, "board-test", "--port", board.port, "--out", str(folder), "--seconds", "1", "--json"]
    done = 0
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True) as process:
        for line in process.stderr:
            print(f"board-test: {line.rstrip()}", flush=True)
            if line.startswith("→ "):
                board.hand(line.strip()[2:].removesuffix(ENTER))
                process.stdin.write("\n")
                process.stdin.flush()
                done += 1
        report = json.loads(process.stdout.read())
    assert process.returncode == 0, f"exit status {process.returncode}"
    return report, done


def main():
    board, image, program = sys.argv[1:]
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as folder, Board(board, image, "bare") as board:
        report, done = test(program, board, pathlib.Path(folder))
        stored = json.loads((pathlib.Path(folder) / "board.json").read_text())
        assert stored == report
        page = (pathlib.Path(folder) / "report.html").read_text()
        assert "instructions, not cycles" in page
    assert done == 13, done
    rows = report["rows"]
    assert len(rows) == 29 and all(row["verdict"] == "passed" and row["measured"] for row in rows), rows
    print(f"board-test: passed in {time.monotonic() - started:.0f} s", flush=True)


main()
