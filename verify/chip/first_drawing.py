#!/usr/bin/env python3
"""The first drawing of an arm with other motors than brushed ones, on the simulated board: the file that `fivebar new`
makes, the image for these motors, and `fivebar drive`, which homes the arm by its switches and draws.

    verify/chip/first_drawing.py BOARD IMAGE PROGRAM

BOARD is `board` of this folder, IMAGE the image `stm32f405`, beside which the others are, PROGRAM `fivebar`.
"""

import pathlib
import subprocess
import sys
import tempfile
import time

sys.path.append(str(pathlib.Path(__file__).parent))
from bring_up import JOB, Board, run

# Of each image: what `monitor` calls it, and the answers to `new`: nine about the arm, and those about its motors.
KINDS = {
    "stm32f405_stepper": ("steppers", 9 * [""] + ["stepper"] + 9 * [""]),
    "stm32f405_can": ("CAN", 9 * [""] + ["can", "odrive"] + 6 * [""]),
}


def draw(board, image, program, name, answers, folder):
    """Homes and draws, and sees that the robot of another image is refused."""
    robot, job = folder / "arm.toml", folder / "my.gcode"
    subprocess.run([program, "new", str(robot)], input="\n".join(answers) + "\n", text=True, check=True,
                   capture_output=True)
    job.write_text(JOB)
    with Board(board, image, str(robot)) as board:
        said = run(program, "monitor", "--port", board.port, "--samples", "1")
        assert name in said, said
        drive = [program, "drive", str(job), "--robot", str(robot), "--port", board.port]
        said = run(*drive, status=1)
        assert "--upload" in said, said
        for more in (["--upload"], []):
            said = run(*drive, *more)
            assert "moves done" in said, said
        said = run(program, "drive", str(job), "--robot", "benchtop", "--port", board.port, status=1)
        assert "write the image `stm32f405` to the board" in said, said


def main():
    board, image, program = sys.argv[1:]
    for kind, (name, answers) in KINDS.items():
        started = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            beside = str(pathlib.Path(image).with_name(kind))
            draw(board, beside, program, name, answers, pathlib.Path(folder))
        print(f"first drawing with {kind}: passed in {time.monotonic() - started:.0f} s", flush=True)


main()
