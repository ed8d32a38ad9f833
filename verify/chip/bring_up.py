#!/usr/bin/env python3
"""Goes through docs/use/bring-up.md on the simulated board: the production image, the simulated arm on its
pins, and a hand that does what `fivebar commission` asks for.

    verify/chip/bring_up.py BOARD IMAGE PROGRAM [--until STEP]

BOARD is `board` of this folder, IMAGE the image `stm32f405`, PROGRAM `fivebar`.
"""

import argparse
import pathlib
import re
import subprocess
import tempfile
import threading
import time

JOB = "G21 G90 F3000\nG1 X20 Y0\nG1 X20 Y20\nG1 X0 Y20\nG1 X0 Y0\n"
# Everything must end within this time [s].
LONGEST = 480
ENTER = ", then press Enter."


class Board:
    """A board on a pseudo terminal with a hand at its arm, for a `with` statement."""

    def __init__(self, program, image, robot):
        self.process = subprocess.Popen([program, image, robot], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)
        # Whoever waits for a board that hangs sees its output end then.
        self.watchdog = threading.Timer(LONGEST, self.process.kill)
        self.watchdog.daemon = True
        self.watchdog.start()
        self.port = self.process.stdout.readline().strip()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.watchdog.cancel()
        self.process.kill()
        self.process.wait()

    def hand(self, order):
        """The hand does this."""
        self.process.stdin.write(order + "\n")
        self.process.stdin.flush()
        assert self.process.stdout.readline() == "done\n", f"the board ended at {order}"


def orders(task):
    """What a hand does for a task."""
    patterns = [
        (r"Press the emergency stop", lambda _: ["stop 1"]),
        (r"Release the emergency stop", lambda _: ["stop 0"]),
        (r"Press the home switch of joint (\d)", lambda m: [f"switch {m[1]} 1"]),
        (r"Release the home switch", lambda _: ["switch 1 0", "switch 4 0"]),
        (r"Turn joint (\d) by hand (counter-clockwise|clockwise) by (\d+)°",
         lambda m: [f"turn {m[1]} {(-1 if m[2] == 'clockwise' else 1) * int(m[3]) * 0.0174532925}"]),
        (r"Put the tip into hole \d+ at \((-?[\d.]+), (-?[\d.]+)\) mm",
         lambda m: [f"tip {float(m[1]) / 1000} {float(m[2]) / 1000}"]),
        (r"Turn the arm by hand until the crank of joint 1 points to about (-?\d+)° "
         r"and that of joint 4 to about (-?\d+)°",
         lambda m: [f"place {int(m[1]) * 0.0174532925} {int(m[2]) * 0.0174532925}"]),
        (r"Let go of the arm", lambda _: ["free"]),
    ]
    for pattern, done in patterns:
        if found := re.match(pattern, task):
            return done(found)
    raise AssertionError(f"no hand knows how to do this: {task}")


def commission(board, program, robot, out, until):
    """Goes through the steps and returns what was said."""
    command = [program, "commission", "--port", board.port, "--robot", robot, "--out", str(out)]
    command += ["--until", until] if until else []
    said = []
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True) as process:
        for line in process.stdout:
            said.append(line.rstrip())
            if line.strip().startswith("→ "):
                for order in orders(line.strip()[2:].removesuffix(ENTER)):
                    board.hand(order)
                process.stdin.write("\n")
                process.stdin.flush()
            elif "hole" not in line:
                print(f"bring-up: {line.rstrip()}", flush=True)
    assert process.returncode == 0, "\n".join(said)
    return said


def run(*command, status=0):
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == status, f"{command}: {done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def emergency_stop_in_motion(board, program, robot, folder):
    """Section 4: the switch ends a drawing with fault 10, which `clear` clears."""
    job = folder / "my.gcode"
    job.write_text("M3\n" + 60 * JOB)
    drive = [program, "drive", str(job), "--robot", robot, "--port", board.port]
    with subprocess.Popen(drive, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        # Homing takes 1 s, the drawing more than a minute.
        time.sleep(5)
        assert process.poll() is None, process.stdout.read()
        board.hand("stop 1")
        said = process.stdout.read()
    assert process.returncode == 1 and "fault 10" in said, said
    board.hand("stop 0")
    run(program, "clear", "--port", board.port)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("board")
    parser.add_argument("image")
    parser.add_argument("program")
    parser.add_argument("--until")
    arguments = parser.parse_args()
    program, robot = arguments.program, "benchtop"
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as folder, Board(arguments.board, arguments.image, robot) as board:
        folder = pathlib.Path(folder)
        monitor = [program, "monitor", "--port", board.port, "--samples", "5"]
        assert "an STM32F405" in run(*monitor)
        assert "counts" in run(*monitor, "--raw")
        out = folder / "commissioning"
        commission(board, program, robot, out, arguments.until)
        measured = str(out / "robot.toml") if (out / "robot.toml").exists() else robot
        print(f"bring-up: {time.monotonic() - started:.0f} s for the commissioning", flush=True)
        run(program, "settings", "upload", "--port", board.port, "--robot", measured)
        assert "max_speed" in run(program, "settings", "show", "--port", board.port)
        emergency_stop_in_motion(board, program, measured, folder)
    print(f"bring-up: passed in {time.monotonic() - started:.0f} s", flush=True)


if __name__ == "__main__":
    main()
