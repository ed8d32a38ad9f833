"""The pen's heights by sliders, macros by buttons, and a job that begins where the drawing was clicked."""

import pathlib
import subprocess
import tempfile
import time

import reach
from live import PAUSE, Page, Server

MACROS = '\n[macros]\nmark = """G21 G90 F3000\nG0 X10 Y0\nM3\nG1 X20\nM5\nG0 X0 Y0"""\n"far away" = "G0 X900"\n'
# Its end is 1 mm below its second stroke, at line 7.
TWO_STROKES = "G21 G90 F3000\nM3\nG1 X20 Y0\nM5\nG0 X20 Y10\nM3\nG1 X0 Y10\nM5\nG0 X10 Y9\n"


def slide(browser, pen, width):
    browser.script(f"const slider = document.getElementById('pen-{pen}'); slider.value = {width};"
                   "slider.dispatchEvent(new Event('input'));")


def heights_follow_the_sliders_and_are_kept(page, file):
    browser = page.browser
    browser.click("#tab-move")
    shown = lambda pen: browser.text(f"#pen-{pen}-value")
    browser.wait("the file's heights", lambda: [shown("up"), shown("down")] == ["1.00 ms", "1.50 ms"])
    slide(browser, "down", 1.7)
    slide(browser, "up", 0.95)
    time.sleep(1.0)
    slide(browser, "down", 1.72)
    time.sleep(1.0)
    assert [shown("up"), shown("down")] == ["0.95 ms", "1.72 ms"], [shown("up"), shown("down")]
    before = file.read_text()
    page.ask("#keep-pen")
    page.wait_for_notice("The robot file has the heights")
    text = file.read_text()
    assert "up_width = 9.50e-4" in text and "down_width = 1.72e-3" in text, text
    assert file.with_name("arm.toml.old").read_text() == before, "the old file is kept"
    page.home_and_arm()
    slide(browser, "up", 1.2)
    page.wait_for_notice("with the motors off")
    browser.wait("the kept height", lambda: shown("up") == "0.95 ms")


def macros_are_checked_then_done(page):
    browser = page.browser
    browser.click("#tab-move")
    names = browser.script("return [...document.querySelectorAll('[data-macro]')].map((button) => button.textContent);")
    assert names == ["far away", "mark"], names
    before = page.tool()
    page.ask('[data-macro="far away"]')
    page.wait_for_notice("far away: Line 1")
    assert page.tool() == before
    page.ask('[data-macro="mark"]')
    page.wait_for("Running")
    page.wait_for_rest()


def a_job_begins_where_the_drawing_was_clicked(page):
    browser = page.browser
    page.load_job(TWO_STROKES, "within the arm's limits")
    time.sleep(PAUSE)
    page.run_job()
    page.wait_for("Armed", 60)
    page.wait_for_rest()
    browser.click("#tab-job")
    browser.reveal("#pick")
    page.ask("#pick")
    corner = browser.script("const { left, top } = document.getElementById('arm').getBoundingClientRect(); return [left, top];")
    browser.click_at([at + offset for at, offset in zip(page.pixel("tool"), corner)])
    page.wait_for_notice("The job can begin at line 7")
    assert browser.script("return document.getElementById('from').value;") == "7"
    assert browser.script("return document.getElementById('pick').getAttribute('aria-pressed');") == "false"
    browser.reveal("#run-from")
    page.ask("#run-from")
    page.wait_for("Running")
    page.wait_for("Armed", 60)


def check(program, browser):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "arm.toml")
        text = subprocess.run([program, "robots", "benchtop_pen"], check=True, capture_output=True, text=True).stdout
        file.write_text(text + MACROS)
        with Server(program, options=["--robot", str(file)]) as server:
            browser.resize(1280, 900)
            page = Page(browser, server.url)
            page.next_click = time.monotonic()
            heights_follow_the_sliders_and_are_kept(page, file)
            macros_are_checked_then_done(page)
            a_job_begins_where_the_drawing_was_clicked(page)
            reach.is_accessible(page, ((1280, False), (390, True)))
            browser.resize(1280, 900)
