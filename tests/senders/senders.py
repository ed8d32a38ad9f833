"""Runs a job through `fivebar bridge` with the senders of Printrun and grbl-streamer.

    senders.py FIVEBAR [OPTION...]

Without an option it takes an arm of each kind of drive. Each sender homes the simulated arm, runs the job to its end,
pauses and resumes in between, and sees the error of a move out of reach. The path that the arm was told to follow, from the bridge's
log, is compared with the strokes of the job: the tool is down on the strokes only, and every part
of every stroke is drawn.
"""

import csv
import math
import os
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from pathlib import Path

FEED = 900  # mm/min
ON_STROKE = 0.06  # mm: the corner tolerance and the arm's own error
DRAWN = 0.3  # mm: the log has a line every 10 ms, in which the tool goes 0.15 mm
STEP = 0.2  # mm
#: An arm of each kind of drive. Those that `fivebar new` makes have the answers to its questions: default answers, with
#: drives on a CAN bus that speak the protocol of MIT-type drives, and with another base and steppers of own data.
ARMS = {
    "benchtop": None,
    "benchtop_stepper": None,
    "leg": None,
    "classroom_servo": None,
    "mit": [*9 * [""], "can", "mit", *12 * [""]],
    "new": ["", "", "0.1", *6 * [""], "stepper", "-5", "400", "8", "0.3", *12 * [""]],
}
SETTLES = 0.25  # mm
# An emulated board is slower than the time that it counts.
SETTLING = 10 if "--emulated" in sys.argv else 1  # s
LONGEST = 1200 if "--emulated" in sys.argv else 120  # s


def job():
    """The lines of the job, and its strokes as points [mm]."""
    lines = ["G21", "G90", "G92 X0 Y0", "M5", f"F{FEED}"]
    strokes = []
    for row in range(6):
        y = -2 * row
        lines += [f"G0 X2 Y{y}", "M3 S1000", f"G1 X9 Y{y}", f"G1 X10 Y{y - 1}", "M5"]
        strokes.append([(2, y), (9, y), (10, y - 1)])
    lines += ["G0 X20 Y-5", "M3 S1000", "G2 X20 Y-5 I-4 J0", "M5", "G0 X0 Y0"]
    turn = [2 * math.pi * step / 180 for step in range(181)]
    strokes.append([(16 + 4 * math.cos(a), -5 - 4 * math.sin(a)) for a in turn])
    return lines, strokes


class Bridge:
    """`fivebar bridge`, with a log of the arm's path."""

    def __init__(self, program, options):
        self.log = Path(tempfile.mkdtemp()) / "path.csv"
        command = [program, "bridge", "--listen", "127.0.0.1:0", "--log", str(self.log), *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.address, self.terminal = self.process.stdout.readline().split()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGINT)
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()

    def path(self):
        """Position [mm] from the job's zero, where it ends at rest, and the tool's level."""
        with self.log.open() as log:
            rows = [[float(row[key]) for key in ("x_m", "y_m", "tool")] for row in csv.DictReader(log)]
        x0, y0, _ = rows[-1]
        return [(1e3 * (x - x0), 1e3 * (y - y0), tool) for x, y, tool in rows]


def wait(what, condition):
    deadline = time.monotonic() + LONGEST
    while not condition():
        if time.monotonic() > deadline:
            sys.exit(f"senders: {what}: not within {LONGEST} s")
        time.sleep(0.02)


def distance(point, start, end):
    """The distance of a point from a straight line between two points."""
    (x, y), (x0, y0), (x1, y1) = point, start, end
    dx, dy = x1 - x0, y1 - y0
    share = max(0, min(1, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy)))
    return math.hypot(x - x0 - share * dx, y - y0 - share * dy)


def compare(name, path, strokes):
    """Compares the path with the strokes, both ways."""
    sides = [side for stroke in strokes for side in zip(stroke, stroke[1:])]
    drawn = [(x, y) for x, y, tool in path if tool > 0.5]
    off = max((min(distance(point, *side) for side in sides), point) for point in drawn)
    missing = 0
    for (x0, y0), (x1, y1) in sides:
        count = math.ceil(math.hypot(x1 - x0, y1 - y0) / STEP)
        for step in range(count + 1):
            x, y = x0 + (x1 - x0) * step / count, y0 + (y1 - y0) * step / count
            missing = max(missing, min(math.hypot(x - a, y - b) for a, b in drawn))
    print(f"senders: {name}: {len(drawn)} places, {off[0]:.3f} mm off the strokes at most, "
          f"every place of a stroke within {missing:.3f} mm of one")
    if off[0] > ON_STROKE or missing > DRAWN:
        sys.exit(f"senders: {name}: the path is not the job's: {off}")


def printrun(program, options):
    from printrun import gcoder
    from printrun.printcore import printcore

    lines, strokes = job()
    said = []
    with Bridge(program, options) as bridge:
        sender = printcore()
        sender.recvcb = said.append
        sender.connect(bridge.address, 115200)
        wait("printcore is online", lambda: sender.online)
        sender.startprint(gcoder.LightGCode(["G28", *lines, "M400"]))
        wait("a part of the job", lambda: sender.queueindex >= len(lines) // 2)
        sender.pause()
        time.sleep(3)
        index = sender.queueindex
        assert sender.paused and index < len(lines), index
        sender.resume()
        wait("the end of the job", lambda: not sender.printing and sender.clear)
        sender.send_now("G1 X900 Y0")
        wait("an error", lambda: any("Error:" in line and "would" in line for line in said))
        said.clear()
        sender.send_now("M114")
        wait("a report", lambda: any(line.startswith("X:") for line in said))
        time.sleep(0.2)
        sender.disconnect()
    assert not any("Resend" in line for line in said), said
    compare("printcore", bridge.path(), strokes)


def grbl(program, options):
    from grbl_streamer import GrblStreamer

    lines, strokes = job()
    errors, rests = [], []

    def callback(event, *data):
        if event == "on_error":
            errors.append(data)
        # The place is taken with the mode of the same report: the sender's own fields are written
        # one after another, while this thread reads them.
        if event == "on_stateupdate" and data[0] == "Hold:0":
            rests.append(data[1])

    with Bridge(program, options) as bridge:
        sender = GrblStreamer(callback)
        sender.setup_logging()
        sender.cnect(bridge.terminal)
        wait("Grbl's greeting", lambda: sender.connected)
        sender.poll_start()
        wait("a report", lambda: sender.cmode == "Alarm")
        sender.homing()
        wait("the arm at home", lambda: sender.cmode == "Idle")
        sender.write("\n".join(lines))
        sender.job_run()
        wait("a part of the job", lambda: sender.cmpos[1] < -5 and sender.cmpos[0] > 4)
        sender.hold()
        wait("the arm at rest", lambda: rests)
        held = rests[0]
        # The reference rests. Against friction, the loops of a drive on a bus take out what remains
        # of the error in about 0.6 s.
        time.sleep(SETTLING)
        settled = sender.cmpos
        assert math.dist(held, settled) < SETTLES, (held, settled)
        time.sleep(1)
        assert math.dist(settled, sender.cmpos) < 0.02, (settled, sender.cmpos)
        sender.resume()
        wait("the end of the job", lambda: sender.job_finished and sender.cmode == "Idle")
        assert not errors, errors
        sender.job_new()
        sender.write("G1 X900 Y0")
        sender.job_run()
        wait("an error", lambda: errors)
        assert errors[0][0] == "error:15", errors
        sender.disconnect()
    compare("grbl-streamer", bridge.path(), strokes)


def robot(program, name, answers):
    """The option for an arm: its name, or the file that `fivebar new` writes."""
    if answers is None:
        return name
    file = Path(tempfile.mkdtemp()) / f"{name}.toml"
    lines = "".join(f"{line}\n" for line in answers)
    subprocess.run([program, "new", str(file)], input=lines, text=True, check=True, capture_output=True)
    return str(file)


def check(program, options):
    for options in [options] if options else [["--robot", robot(program, *arm)] for arm in ARMS.items()]:
        print("senders:", *options, flush=True)
        printrun(program, options)
        grbl(program, options)


if __name__ == "__main__":
    status = 1
    try:
        check(sys.argv[1], sys.argv[2:])
        status = 0
    except SystemExit as failed:
        print(failed)
    except BaseException:
        traceback.print_exc()
    # A sender's threads would keep the process.
    sys.stdout.flush()
    os._exit(status)
