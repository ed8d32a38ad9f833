"""Looks at a run: its layers, its strokes by error and speed, and its replay."""

import time

import reach
from live import PAUSE
from looks import COLOURED

TWO_PENS = "G21 G90 F3000\nM0 (red pen)\nM3\nG1 X20 Y0\nG1 X20 Y20\nM5\nG0 X0 Y0\nM0 (blue pen)\nM3\nG1 X-20 Y0\n"
ONE_STROKE = "G21 G90 F3000\nM3\nG1 X20 Y0\nG1 X20 Y20\nG1 X0 Y20\nG1 X0 Y0\n"


def the_layers_are_listed(page):
    page.load_job(TWO_PENS, "M0 stops")
    shown = page.browser.wait("the layers", lambda: page.browser.script(
        "return [...document.querySelectorAll('#layers li')].map((item) => item.textContent);"))
    assert shown == ["M0: red pen · 1 stroke · 40 mm", "M0: blue pen · 1 stroke · 20 mm"], shown
    reach.has_no_serious_violation(page.browser, "a job with layers")


def drawn(browser, name):
    """How many pixels have a colour of the style sheet on the drawing, once it is drawn."""
    browser.script("await new Promise((done) => setTimeout(done, 300));")
    return browser.script(COLOURED + f"return coloured(document.getElementById('arm'), '{name}');")


def strokes_have_the_colour_of_their_error_or_speed(page):
    """A simulated arm draws these lines at 50 mm/s with errors of some micrometres."""
    browser = page.browser
    page.load_job(ONE_STROKE, "within the arm's limits")
    browser.wait("a job without layers", lambda: browser.script("return document.getElementById('layers').hidden;"))
    browser.click('[data-zoom="job"]')
    page.wait_for_rest()
    time.sleep(PAUSE)
    page.run_job()
    page.wait_for("Armed")
    assert drawn(browser, "--drawn") > 200, "one colour"
    browser.click('[data-colouring="error"]')
    assert drawn(browser, "--step0") + drawn(browser, "--step1") > 200 and drawn(browser, "--step7") == 0, "small errors"
    assert "µm" in browser.text("#scale")
    browser.click('[data-colouring="speed"]')
    fast = drawn(browser, "--step4") + drawn(browser, "--step5")
    assert fast > 100 and drawn(browser, "--step7") == 0, f"{fast} pixels of 20 to 100 mm/s"
    assert "mm/s" in browser.text("#scale")
    for dark in (True, False):
        browser.dark(dark)
        reach.has_no_serious_violation(browser, f"strokes by speed, dark: {dark}")
    browser.click('[data-colouring="pen"]')
    assert not browser.script("return document.getElementById('scale').checkVisibility();")


def the_last_run_is_shown_again_until_the_arm_moves(page):
    browser = page.browser
    length = float(browser.text("#replay-value").removesuffix(" s"))
    assert 1.2 < length < 3, f"{length} s for 80 mm at 50 mm/s"
    whole = drawn(browser, "--drawn")
    browser.click("#play")
    browser.wait("its end", lambda: browser.text("#play") == "Replay")
    assert browser.script("return document.getElementById('replaying').checkVisibility();")
    browser.script("""
        const slider = document.getElementById('replay');
        slider.value = Math.round(slider.max / 2);
        slider.dispatchEvent(new Event('input'));""")
    half = drawn(browser, "--drawn")
    assert 0.3 * whole < half < 0.8 * whole, f"{half} of {whole} pixels"
    browser.click('[data-jog="1,0"]')
    browser.wait("the arm", lambda: not browser.script("return document.getElementById('replaying').checkVisibility();"))
    page.wait_for_rest()


def check(page):
    page.home_and_arm_if_needed()
    the_layers_are_listed(page)
    strokes_have_the_colour_of_their_error_or_speed(page)
    the_last_run_is_shown_again_until_the_arm_moves(page)
