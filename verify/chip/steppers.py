#!/usr/bin/env python3
"""The first drawing of an arm with steppers on the simulated board: the file that `fivebar new` makes, the image for
steppers, and `fivebar drive`, which homes the arm by its switches and draws.

    verify/chip/steppers.py BOARD IMAGE PROGRAM

BOARD is `board` of this folder, IMAGE the image `stm32f405_stepper`, PROGRAM `fivebar`.
"""

import pathlib
import subprocess
import sys
import tempfile
import time

sys.path.append(str(pathlib.Path(__file__).parent))
from bring_up import JOB, Board, run

# Nine questions about the arm, its motors, and eight questions about these.
ANSWERS = 9 * "\n" + "stepper\n" + 8 * "\n"


def main():
    board, image, program = sys.argv[1:]
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        robot, job = folder / "arm.toml", folder / "my.gcode"
        subprocess.run([program, "new", str(robot)], input=ANSWERS, text=True, check=True, capture_output=True)
        job.write_text(JOB)
        with Board(board, image, str(robot)) as board:
            assert "steppers" in run(program, "monitor", "--port", board.port, "--samples", "1")
            drive = [program, "drive", str(job), "--robot", str(robot), "--port", board.port]
            said = run(*drive, status=1)
            assert "--upload" in said, said
            said = run(*drive, "--upload")
            assert "moves done" in said, said
            # The other image's robots are refused.
            said = run(program, "drive", str(job), "--robot", "benchtop", "--port", board.port, status=1)
            assert "for steppers" in said, said
    print(f"steppers: passed in {time.monotonic() - started:.0f} s", flush=True)


main()
