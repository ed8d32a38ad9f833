#!/usr/bin/env python3
"""Runs a job through OctoPrint and `fivebar bridge`: scripts/octoprint.sh.

    tests/senders/octoprint.py OCTOPRINT PROGRAM

OCTOPRINT is the program of that name, PROGRAM is `fivebar`. OctoPrint opens the bridge's
pseudo-terminal, homes, prints a file, pauses and resumes it, and is asked how it ended.
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
JOB = "G21\nG90\nG92 X0 Y0\nM3\n" + "G1 X20 Y0 F1200\nG1 X20 Y20\nG1 X0 Y20\nG1 X0 Y0\n" * 3 + "M5\n"
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
        return self.call("job")["state"]


def wait(what, condition, timeout=120):
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


def main(octoprint, program):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        log = folder / "path.csv"
        bridge = subprocess.Popen([program, "bridge", "--listen", "127.0.0.1:0", "--log", log],
                                  stdout=subprocess.PIPE, text=True)
        _, terminal = bridge.stdout.readline().split()
        host = OctoPrint(octoprint, folder, terminal)
        try:
            wait("OctoPrint", lambda: host.call("version"))
            host.call("connection", {"command": "connect", "port": terminal, "baudrate": 115200})
            wait("the connection", lambda: host.state() == "Operational")
            host.call("printer/command", {"commands": ["G28", "M400"]})
            host.upload("square.gcode", JOB)
            time.sleep(5)  # homing
            host.call("files/local/square.gcode", {"command": "select", "print": True})
            wait("the print", lambda: host.state() == "Printing")
            time.sleep(3)
            host.call("job", {"command": "pause", "action": "pause"})
            wait("the pause", lambda: host.state() == "Paused")
            host.call("job", {"command": "pause", "action": "resume"})
            wait("the end", lambda: host.state() == "Operational")
            assert host.call("job")["progress"]["completion"] == 100
            rows = [line.split(",") for line in log.read_text().splitlines()[1:]]
            down = [(float(x), float(y)) for _, x, y, level in rows if float(level) > 0.5]
            size = [max(axis) - min(axis) for axis in zip(*down)]
            print(f"OctoPrint: the square is {1e3 * size[0]:.2f} x {1e3 * size[1]:.2f} mm, done")
            assert all(abs(side - 0.02) < 2e-4 for side in size), size
        finally:
            host.process.send_signal(signal.SIGINT)
            host.process.wait(timeout=30)
            bridge.send_signal(signal.SIGINT)
            bridge.wait(timeout=30)


main(*sys.argv[1:])
