#!/usr/bin/env python3
"""The live page as its users meet it, in a headless Chromium against the simulated arm.

    tests/browser/live_page.py PROGRAM [--screenshots FOLDER]

PROGRAM is `fivebar`. With --screenshots, pictures of the page, of a run's report and of a
workspace map are left in FOLDER.
"""

import argparse
import http.client
import pathlib
import subprocess
import tempfile
import time

from webdriver import Browser

ROOT = pathlib.Path(__file__).resolve().parents[2]
JOB = ROOT / "sim-harness/jobs/fivebar.gcode"
UPGRADE = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13",
           "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ=="}


class Server:
    """`fivebar serve` at a free port. To be used in a `with`."""

    def __init__(self, program):
        command = [program, "serve", "--listen", "127.0.0.1:0"]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.url = self.process.stdout.readline().split()[-1]
        self.host = self.url.split("/")[2]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()

    def status(self, path, **headers):
        connection = http.client.HTTPConnection(self.host, timeout=10)
        connection.request("GET", path, headers=headers)
        status = connection.getresponse().status
        connection.close()
        return status


class Page:
    """The page in a browser."""

    def __init__(self, browser, url):
        self.browser = browser
        browser.open(url)
        browser.wait("the connection", lambda: self.state() not in ("", "offline"))

    def state(self):
        return self.browser.script("return document.body.dataset.state ?? '';")

    def numbers(self, selector):
        """The numbers of a text such as `-12.3, 45.6 mm`; none where it shows none."""
        words = self.browser.text(selector).replace("−", "-").replace(",", " ").split()
        digits = [word.rstrip("°") for word in words]
        return [float(word) for word in digits if word.lstrip("-")[:1].isdigit()]

    def angles(self):
        return self.numbers("#theta1") + self.numbers("#theta4")

    def tool(self):
        return self.numbers("#tool")

    def pixel(self):
        pixel = self.browser.script("return document.getElementById('arm').dataset.tool ?? '';")
        return [float(part) for part in pixel.split(",")]

    def at_rest(self):
        before = self.tool()
        time.sleep(0.3)
        return self.state() == "Armed" and self.tool() == before

    def request(self, name):
        self.browser.click(f'[data-request="{name}"]')

    def wait_for(self, state, timeout=30):
        self.browser.wait(state, lambda: self.state() == state, timeout)

    def home_and_arm(self):
        self.request("home")
        self.browser.wait("home", lambda: self.state() == "Stopped" and len(self.angles()) == 2)
        self.request("arm")
        self.wait_for("Armed")

    def load_job(self):
        self.browser.type("#file", str(JOB))
        self.browser.wait("the job", lambda: "within the arm's limits" in self.browser.text("#job"))

    def run_job(self):
        self.browser.click("#run")
        self.wait_for("Running")


def foreign_origins_are_refused(server):
    own = {"Host": server.host, "Origin": f"http://{server.host}"}
    foreign = {"Host": server.host, "Origin": "http://example.org"}
    rebound = {"Host": "example.org", "Origin": "http://example.org"}
    assert server.status("/live", **UPGRADE, **own) == 101
    assert server.status("/live", **UPGRADE, **foreign) == 403
    assert server.status("/live", **UPGRADE, **rebound) == 403
    assert server.status("/", Host="example.org") == 403
    # The page that was let in has gone with its connection.
    time.sleep(0.5)


def the_arm_follows_the_hand(page):
    before, tool = page.angles(), page.tool()
    start = page.pixel()
    page.browser.drag("#arm", start, [start[0] + 40, start[1] + 25])
    def missed():
        return max(abs(e - s - d) for e, s, d in zip(page.pixel(), start, [40, 25]))
    page.browser.wait("the tool under the hand", lambda: page.at_rest() and missed() < 2.5)
    after, moved = page.angles(), page.tool()
    turned = [abs(a - b) for a, b in zip(after, before)]
    assert min(turned) > 1.0, f"the joints turned by {turned} degrees only"
    assert moved[0] > tool[0] and moved[1] < tool[1], f"from {tool} to {moved} mm"


def arrow_keys_jog(page):
    before = page.tool()
    page.browser.type("#arm", "\ue013")  # arrow up, by 1 mm
    page.browser.wait("the jog", lambda: abs(page.tool()[1] - before[1] - 1.0) < 0.05)


def what_is_out_of_reach_is_refused_with_the_reason(page):
    start = page.pixel()
    page.browser.drag("#arm", start, [5, 5], steps=2)
    page.browser.wait("a refusal", lambda: "refused" in page.browser.text("#notice"))
    # What of the drag can be done is done first.
    page.browser.wait("rest", lambda: page.at_rest())


def a_job_runs_to_its_end(page, screenshots):
    page.load_job()
    page.run_job()
    if screenshots:
        time.sleep(1.5)
        page.browser.screenshot(screenshots / "live-page.png")
    page.browser.wait("its end", lambda: page.browser.text("#notice") == "The job is done.")
    assert page.state() == "Armed"


def the_emergency_stop_shows_the_fault(page):
    page.run_job()
    page.browser.type("#arm", "\ue00c")  # Escape
    page.wait_for("Fault", timeout=5)
    page.browser.wait("the fault", lambda: "emergency stop" in page.browser.text("#fault"))
    assert "Running" in page.browser.text("#snapshot"), "the snapshot tells what it was doing"
    page.request("clear_fault")
    page.wait_for("Stopped")
    page.request("arm")
    page.wait_for("Armed")


def a_lost_page_brings_the_arm_to_rest(program):
    with Server(program) as server:
        with Browser() as browser:
            page = Page(browser, server.url)
            page.home_and_arm()
            page.load_job()
            page.run_job()
        # The browser has been killed in mid-motion.
        with Browser() as browser:
            page = Page(browser, server.url)
            page.wait_for("Fault")
            browser.wait("the fault", lambda: "command timeout" in browser.text("#fault"))
            assert "Running" in browser.text("#snapshot")
            seen = page.angles()
            time.sleep(0.5)
            moved = max(abs(a - b) for a, b in zip(page.angles(), seen))
            assert moved <= 0.02, f"still moving: {moved} degrees in half a second"


def other_pictures(program, screenshots):
    with tempfile.TemporaryDirectory() as folder, Browser(height=1100) as browser:
        folder = pathlib.Path(folder)
        subprocess.run([program, "sim", JOB, "--out", folder / "run"], check=True,
                       stdout=subprocess.DEVNULL)
        browser.open(f"file://{folder}/run/report.html")
        time.sleep(1)
        browser.screenshot(screenshots / "report.png")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--screenshots", type=pathlib.Path)
    arguments = parser.parse_args()
    with Server(arguments.program) as server:
        foreign_origins_are_refused(server)
        with Browser() as browser:
            page = Page(browser, server.url)
            page.home_and_arm()
            the_arm_follows_the_hand(page)
            arrow_keys_jog(page)
            what_is_out_of_reach_is_refused_with_the_reason(page)
            a_job_runs_to_its_end(page, arguments.screenshots)
            the_emergency_stop_shows_the_fault(page)
    a_lost_page_brings_the_arm_to_rest(arguments.program)
    if arguments.screenshots:
        other_pictures(arguments.program, arguments.screenshots)
    print("the live page holds: origins, drag, jog, refusal, job, emergency stop, lost page")


if __name__ == "__main__":
    main()
