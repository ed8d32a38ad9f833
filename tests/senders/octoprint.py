#!/usr/bin/env python3
"""Runs a job through OctoPrint and `fivebar bridge`: scripts/octoprint.sh.

    tests/senders/octoprint.py OCTOPRINT PROGRAM [OPTION…]

OCTOPRINT is the program of that name, PROGRAM is `fivebar`, and the options are those of its bridge.
OctoPrint opens the bridge's pseudo-terminal, prints a file that homes and draws, pauses and resumes it, and
is asked how it ended. Then it prints a file with a move out of reach, and has to show the error.
"""

import http.client
import json
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
import uuid

KEY = "0123456789ABCDEF0123456789ABCDEF"
START = "G21\nG90\nG28\nG92 X0 Y0\nM3\n"
JOB = START + "G1 X6 Y0 F900\nG1 X6 Y6\nG1 X0 Y6\nG1 X0 Y0\n" * 2 + "M5\nM400\n"
CONFIG = """
api: {{key: {key}, keyEnforced: true}}
server: {{firstRun: false, onlineCheck: {{enabled: false}}, pluginBlacklist: {{enabled: false}}}}
serial: {{additionalPorts: ["{terminal}"], autoconnect: false}}
plugins:
  tracking: {{enabled: false}}
  _disabled: [softwareupdate, announcements, discovery, errortracking, pluginmanager]
"""


class OctoPrint:
    def __init__(self, program, folder, terminal):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.url = f"http://127.0.0.1:{port}/api/"
        (folder / "config.yaml").write_text(CONFIG.format(key=KEY, terminal=terminal))
        self.log = open(folder / "log.txt", "w")
        self.process = subprocess.Popen(
            [program, "serve", "--iknowwhatimdoing", "--basedir", folder, "--host", "127.0.0.1",
             "--port", str(port)], stdout=self.log, stderr=subprocess.STDOUT)

    def call(self, path, body=None, kind="application/json"):
        data = json.dumps(body).encode() if isinstance(body, dict) else body
        request = urllib.request.Request(self.url + path, data, {"X-Api-Key": KEY, "Content-Type": kind})
        with urllib.request.urlopen(request, timeout=20) as answer:
            text = answer.read()
        return json.loads(text) if text else None

    def upload(self, name, text):
        line = uuid.uuid4().hex
        body = (f'--{line}\r\nContent-Disposition: form-data; name="file"; filename="{name}"\r\n'
                f"Content-Type: application/octet-stream\r\n\r\n{text}\r\n--{line}--\r\n")
        self.call("files/local", body.encode(), f"multipart/form-data; boundary={line}")

    def state(self):
        return self.call("connection")["current"]["state"]

    def sent(self):
        """How much of the file has been sent [bytes]."""
        return self.call("job")["progress"]["filepos"] or 0


def wait(what, condition, timeout=240):
    deadline = time.monotonic() + timeout
    seen = None
    while time.monotonic() < deadline:
        try:
            seen = condition()
        except (OSError, http.client.HTTPException):
            seen = None
        if seen:
            return seen
        time.sleep(0.2)
    raise AssertionError(f"waited {timeout} s in vain for {what}")


def main(octoprint, program, *options):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        log = folder / "path.csv"
        bridge = subprocess.Popen([program, "bridge", *options, "--log", log],
                                  stdout=subprocess.PIPE, text=True)
        _, terminal = bridge.stdout.readline().split()
        host = OctoPrint(octoprint, folder, terminal)
        try:
            wait("OctoPrint", lambda: host.call("version"))
            host.call("connection", {"command": "connect", "port": terminal, "baudrate": 115200})
            wait("the connection", lambda: host.state() == "Operational")
            host.upload("square.gcode", JOB)
            host.call("files/local/square.gcode", {"command": "select", "print": True})
            wait("the first stroke", lambda: host.sent() > len(START) + 20)
            host.call("job", {"command": "pause", "action": "pause"})
            wait("the pause", lambda: host.state() == "Paused")
            host.call("job", {"command": "pause", "action": "resume"})
            wait("going on", lambda: host.state() == "Printing")
            wait("the end", lambda: host.state() == "Operational")
            assert host.call("job")["progress"]["completion"] == 100
            host.upload("far.gcode", "M3\nG1 X5000 F1200\n" + "G1 X20\nG1 X0\n" * 10)
            host.call("files/local/far.gcode", {"command": "select", "print": True})
            why = wait("the error", lambda: host.call("printer/error").get("error"))
            # By default OctoPrint then sends the emergency stop and disconnects.
            wait("the end of the connection", lambda: host.state() == "Closed")
            rows = [line.split(",") for line in log.read_text().splitlines()[1:]]
            down = [(float(x), float(y)) for _, x, y, level in rows if float(level) > 0.5]
            size = [max(axis) - min(axis) for axis in zip(*down)]
            print(f"OctoPrint: the square is {1e3 * size[0]:.2f} x {1e3 * size[1]:.2f} mm, done; then the error: {why}")
            assert all(abs(side - 0.006) < 2e-4 for side in size), size
        finally:
            host.process.send_signal(signal.SIGINT)
            host.process.wait(timeout=30)
            bridge.send_signal(signal.SIGINT)
            bridge.wait(timeout=30)


main(*sys.argv[1:])
