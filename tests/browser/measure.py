#!/usr/bin/env python3
"""Measures the live page and its server with long jobs, in a headless Chromium: tests/browser/measure.py [PROGRAM]

PROGRAM is `fivebar`, by default the release build. It writes the table "The page with long jobs" of
docs/verify/live-page-load.md. Nothing is asserted: the figures depend on the machine.
"""

import gzip
import http.client
import math
import os
import pathlib
import re
import sys
import tempfile
import time

from live import Page, Server
from webdriver import Browser

ROOT = pathlib.Path(__file__).parents[2]
DOCUMENT = ROOT / "docs/verify/live-page-load.md"
BEGIN, END = "<!-- measured by tests/browser/measure.py -->\n", "<!-- end -->\n"
JOBS = (1_000, 90_000, 200_000, 500_000)
SECONDS = 4  # of frames in each measurement


def job(lines, decimals=4):
    """A flower of so many lines, about a quarter of an hour at 50 mm/s."""
    rows = ["G21 G90 F3000", "M3"]
    for i in range(lines):
        turn = 800 * math.pi * i / lines
        radius = 20 + 8 * math.sin(0.2285 * turn)
        rows.append(f"G1 X{radius * math.cos(turn):.{decimals}f} Y{radius * math.sin(turn):.{decimals}f}")
    return "\n".join(rows) + "\n"


def frames(browser, begin="() => {}"):
    """Median, 99 % and longest time between frames while `begin(frame)` is called in each [ms]."""
    times = browser.script(f"""
        const each = {begin}, times = [];
        return await new Promise((done) => {{
            let last = null;
            const frame = (now) => {{
                if (last !== null) times.push(now - last);
                last = now;
                each(times.length);
                if (times.length < {60 * SECONDS}) requestAnimationFrame(frame);
                else done(times);
            }};
            requestAnimationFrame(frame);
        }});""")
    times.sort()
    return [times[len(times) // 2], times[int(0.99 * len(times))], times[-1]]


PAN = """(count) => {
    const canvas = document.getElementById('arm'), x = 40 + 3 * (count % 60);
    const event = (kind, at) => canvas.dispatchEvent(new PointerEvent(kind, { pointerId: 1, clientX: at, clientY: 60, bubbles: true }));
    canvas.setPointerCapture = () => {};
    if (count % 60 === 0) event('pointerdown', 40);
    event('pointermove', x);
    if (count % 60 === 59) event('pointerup', x);
}"""
ZOOM = """(count) => {
    const canvas = document.getElementById('arm');
    canvas.dispatchEvent(new WheelEvent('wheel', { ctrlKey: true, deltaY: count % 60 < 30 ? -40 : 40, clientX: 500, clientY: 400, cancelable: true }));
}"""


class Usage:
    """What a process uses."""

    def __init__(self, process):
        self.folder = pathlib.Path(f"/proc/{process.pid}")
        self.begin()

    def begin(self):
        self.since = (time.monotonic(), self.cpu())

    def cpu(self):
        fields = (self.folder / "stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def share(self):
        """Of a core since the beginning [%]."""
        then, used = self.since
        return 100 * (self.cpu() - used) / (time.monotonic() - then)

    def memory(self, key):
        status = (self.folder / "status").read_text()
        return int(re.search(rf"{key}:\s*(\d+) kB", status).group(1)) / 1000


def scripts(server):
    """The size of the page's scripts, and compressed [kB]."""
    def get(path):
        connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=10)
        connection.request("GET", path, headers={"Host": server.host, **server.cookie})
        return connection.getresponse().read()

    names = {"app.js", "emergency.js", "uPlot.js", "clock.js"}
    seen = set()
    sizes = [0, 0]
    while names - seen:
        name = (names - seen).pop()
        seen.add(name)
        text = get(f"/{name}")
        names |= set(re.findall(r'from "\./([a-z-]+\.js)"', text.decode()))
        sizes = [sizes[0] + len(text), sizes[1] + len(gzip.compress(text))]
    return [size / 1000 for size in sizes]


def measure(program, text):
    """One row: the job is loaded, shown, looked at and run."""
    with Server(program) as server, Browser() as browser, tempfile.TemporaryDirectory() as folder:
        usage = Usage(server.process)
        browser.resize(1440, 900)
        page = Page(browser, server.url)
        paint = browser.script("return performance.getEntriesByName('first-contentful-paint')[0].startTime;")
        page.home_and_arm()
        path = pathlib.Path(folder, "long.gcode")
        path.write_text(text)
        browser.reveal("#file")
        begun = time.monotonic()
        browser.type("#file", str(path))
        browser.wait("the job", lambda: "within the arm's limits" in browser.text("#job"), 300)
        shown = time.monotonic() - begun
        browser.wait("its time", lambda: re.search(r"drawn · .", browser.text("#size")), 300)
        timed = time.monotonic() - begun
        time.sleep(2)
        page.run_job()
        running = frames(browser)
        usage.begin()
        panning, zooming = frames(browser, PAN), frames(browser, ZOOM)
        time.sleep(4)
        share = usage.share()
        page.request("stop")
        return paint, shown, timed, (running, panning, zooming), share, usage.memory("VmRSS"), usage.memory("VmHWM"), scripts(server)


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "target/release/fivebar")
    rows = ["| lines (file) | shown after | its time after | longest frame: running, panning, zooming | 99 % of frames | `serve` while drawing | memory, at most while loading |\n",
            "|---|---|---|---|---|---|---|\n"]
    texts = [job(lines) for lines in JOBS] + [job(2_000_000, decimals=6)]
    for text in texts:
        paint, shown, timed, kinds, share, memory, peak, sizes = measure(program, text)
        longest = ", ".join(f"{longest:.0f}" for _, _, longest in kinds)
        most = ", ".join(f"{most:.0f}" for _, most, _ in kinds)
        lines = text.count("\n") - 2
        rows.append(f"| {lines:,} ({len(text) / 1e6:.1f} MB) | {shown:.1f} s | {timed:.1f} s | {longest} ms | {most} ms | "
                    f"{share:.0f} % of a core | {memory:.0f} MB, {peak:.0f} MB |\n")
        print(rows[-1], end="", flush=True)
    whole, compressed = sizes
    note = f"\nFirst paint after {paint:.0f} ms; {whole:.0f} kB of scripts, compressed {compressed:.0f} kB.\n"
    print(note)
    before, rest = DOCUMENT.read_text().split(BEGIN)
    DOCUMENT.write_text(before + BEGIN + "".join(rows) + note + END + rest.split(END)[1])


if __name__ == "__main__":
    main()
