"""Pictures on the page, and several files at once: each sheet is loaded by its button, and nothing runs by itself."""

import pathlib
import re
import struct
import tempfile
import time
import zlib

from live import PAUSE

ESCAPE = "\ue00c"
SQUARE = ('<svg xmlns="http://www.w3.org/2000/svg" width="20mm" height="10mm" viewBox="0 0 20 10">'
          '<path d="M1 1h18v8h-18z" fill="none" stroke="black"/></svg>')


def png(side):
    """A black square of half the side on white."""
    def part(name, data):
        body = name + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))
    dark = range(side // 4, 3 * side // 4)
    rows = b"".join(b"\0" + bytes(0 if x in dark and y in dark else 255 for x in range(side)) for y in range(side))
    head = struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + part(b"IHDR", head) + part(b"IDAT", zlib.compress(rows)) + part(b"IEND", b"")


def choose(browser, field, value):
    browser.script(f"const field = document.getElementById('{field}'); field.value = '{value}';"
                   "field.dispatchEvent(new Event('change'));")


def check(page):
    browser = page.browser
    page.home_and_arm_if_needed()
    with tempfile.TemporaryDirectory() as folder:
        for name, content in [("first.svg", SQUARE.encode()), ("second.png", png(40))]:
            pathlib.Path(folder, name).write_bytes(content)
        browser.reveal("#file")
        browser.type("#file", "\n".join(str(pathlib.Path(folder, name)) for name in ["first.svg", "second.png"]))
        browser.wait("the first sheet", lambda: "first.svg" in browser.text("#job"))
        assert browser.text("#next-sheet") == "Next sheet: second.png (1 left)", browser.text("#next-sheet")
        choose(browser, "read-speed", "2")  # 52 mm take 26 s
        # The way to it is added, from where the tool is.
        browser.wait("the speed", lambda: re.search(r" · 2[5-9]\.\d s$", browser.text("#size")))
        time.sleep(PAUSE)
        page.run_job()
        browser.click("#next-sheet")
        page.wait_for_notice("the arm moves")
        assert page.state() == "Running" and "first.svg" in browser.text("#job")
        browser.press(ESCAPE)
        browser.wait("the stop", lambda: page.state() not in ("Running", "Armed"))
        shown = browser.text("#next-sheet")
        assert shown == "Next sheet: second.png (1 left)", f"{shown}: an emergency stop empties nothing"
        page.recover()
        choose(browser, "read-speed", "")
        browser.reveal("#next-sheet")
        browser.click("#next-sheet")
        browser.wait("the second sheet", lambda: "second.png" in browser.text("#job"))
        assert browser.script("return document.getElementById('next-sheet').hidden;")
        time.sleep(PAUSE)
        assert page.state() == "Armed", "loading runs nothing"
        browser.wait("the outline", lambda: "1 stroke ·" in browser.text("#size"))
        choose(browser, "read-trace", "2")
        browser.wait("the tones", lambda: " strokes ·" in browser.text("#size"))
        choose(browser, "read-trace", "0")
        browser.wait("the outline", lambda: "1 stroke ·" in browser.text("#size"))
        choose(browser, "read-columns", "2")
        browser.wait("two copies", lambda: "2 strokes ·" in browser.text("#size"))
        choose(browser, "read-columns", "")
        browser.wait("one", lambda: "1 stroke ·" in browser.text("#size"))
