#!/usr/bin/env python3
"""Tests the page "your arm, now" in a headless Chromium, against the desktop.

    tests/browser/own_arm.py SITE ANSWER [--screenshots FOLDER]

SITE is the folder that scripts/browser_arm.sh writes, ANSWER the built example `answer` of fivebar-browser.
"""

import argparse
import functools
import http.server
import json
import pathlib
import subprocess
import threading
import time

import reach
from webdriver import Browser

SQUARE = "G21 G90 F3000\nM3\nG1 X20 Y0\nG1 X20 Y20\nG1 X0 Y20\nG1 X0 Y0\n"


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("site", type=pathlib.Path)
    parser.add_argument("answer")
    parser.add_argument("--screenshots", type=pathlib.Path)
    arguments = parser.parse_args()
    handler = functools.partial(Quiet, directory=arguments.site)
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    size = (arguments.site / "fivebar.wasm").stat().st_size
    assert size < 3_000_000, f"the program has {size} bytes"

    def desktop(**request):
        output = subprocess.run([arguments.answer, json.dumps(request)], check=True, capture_output=True)
        return json.loads(output.stdout)

    with Browser() as browser:
        def text(selector):
            return browser.script(f"return document.querySelector('{selector}').textContent;")

        def drawn(what):
            browser.wait(f"the digest of {what}", lambda: text("#digest") != "–", 120)
            pace = float(text("#pace").split()[0])
            print(f"your arm: {what} at {pace} times the arm's speed", flush=True)
            assert pace > 1, f"{what}: {pace} times the arm's speed"
            return text("#digest"), text("#error")

        def check(what, **request):
            expected = desktop(op="draw", **request)
            digest, error = drawn(what)
            assert digest == expected["digest"], f"{what}: {digest}, on the desktop {expected}"
            assert error.startswith(f"{1e6 * expected['tip_error']['rms_m']:.1f} µm RMS"), error

        def set_lengths(**lengths):
            for name, value in lengths.items():
                browser.script(f"""
                    const slider = document.querySelector('#{name}');
                    slider.value = {value};
                    slider.dispatchEvent(new Event('input', {{ bubbles: true }}));""")

        browser.resize(1280, 900)
        browser.open(f"http://127.0.0.1:{server.server_port}/")
        browser.wait("the arm", lambda: text("#state").startswith("Ready"))
        browser.click("#draw")
        check("the demonstration")
        browser.wait("its end", lambda: text("#state") == "Drawn", 60)
        if arguments.screenshots:
            browser.screenshot(arguments.screenshots / "own-arm.png")

        set_lengths(crank=90, coupler=150, base=40)
        browser.wait("the other arm", lambda: text("#state").startswith("Ready"))
        assert text("#digest") == "–", "figures of another arm"
        browser.click("#draw")
        check("other lengths", link_lengths=[0.09, 0.15, 0.15, 0.09, 0.04])

        name = arguments.site.resolve() / "square.gcode"
        name.write_text(SQUARE)
        browser.type("#job", str(name))
        browser.wait("the job", lambda: text("#digest") == "–")
        check("a job of G-code", link_lengths=[0.09, 0.15, 0.15, 0.09, 0.04], job=SQUARE)

        # Refusals are sentences, and the page goes on.
        name.write_text("G1 X1000000000 Y\n")
        browser.type("#job", str(name))
        browser.wait("the refusal", lambda: "line 1" in text("#state"))
        set_lengths(crank=40, coupler=40, base=200)
        browser.wait("links that do not meet", lambda: "lengths" in text("#state"))
        set_lengths(crank=100, coupler=160, base=0)
        browser.wait("coaxial cranks", lambda: text("#state").startswith("Ready"))
        reach.has_no_serious_violation(browser, "your arm")
        browser.resize(390, 844, mobile=True)
        assert browser.script("return document.documentElement.scrollWidth <= innerWidth;"), "wider than a phone"
    server.shutdown()


if __name__ == "__main__":
    started = time.monotonic()
    main()
    print(f"your arm: passed in {time.monotonic() - started:.0f} s")
