"""Looks at a run: its layers, its strokes by error and speed, and its replay."""

import re
import time

import moving
import reach
from live import PAUSE
from looks import COLOURED

TWO_PENS = "G21 G90 F3000\nM0 (red pen)\nM3\nG1 X20 Y0\nG1 X20 Y20\nM5\nG0 X0 Y0\nM0 (blue pen)\nM3\nG1 X-20 Y0\n"
SHEET = "G21 G90 F3000\nM3\nG1 X210\nG1 Y297\nG1 X0\nG1 Y0\nM5\n"
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


def a_sheet_is_fitted_by_one_click(page):
    browser = page.browser
    page.load_job(SHEET, "is refused")
    browser.click("#fit")
    browser.wait("the fitted sheet", lambda: "within the arm's limits" in browser.text("#job"))
    assert max(size(browser)) > 100, browser.text("#size")


def size(browser):
    return [float(part) for part in re.findall(r"[\d.]+", browser.text("#size"))[:2]]


def field(browser, name):
    return float(browser.script(f"return document.getElementById('place-{name}').value;"))


def write(browser, name, value):
    browser.script(f"const field = document.getElementById('place-{name}'); field.value = '{value}';"
                   "field.dispatchEvent(new Event('change'));")


def fields_and_corners_place_the_drawing(page):
    browser = page.browser
    page.load_job(ONE_STROKE, "within the arm's limits")
    browser.wait("its size", lambda: size(browser) == [20.0, 20.0])
    left, low = field(browser, "left"), field(browser, "low")
    write(browser, "width", 30)
    browser.wait("the wider drawing", lambda: size(browser) == [30.0, 30.0])
    assert (field(browser, "left"), field(browser, "low")) == (left, low), "its lower left corner stays"
    write(browser, "left", left + 4)
    browser.wait("the moved drawing", lambda: abs(field(browser, "left") - left - 4) < 0.11)
    write(browser, "turn", 45)
    browser.wait("the turned drawing", lambda: abs(size(browser)[0] - 30 * 2 ** 0.5) < 0.2 and field(browser, "turn") == 45)
    write(browser, "turn", 0)
    browser.wait("the drawing", lambda: abs(size(browser)[0] - 30) < 0.2)
    browser.click("#grab")
    corner = page.pixel("corner")
    pivot = [field(browser, "left"), field(browser, "low")]
    scale = 1.2
    span = 30 * abs(moving.pixel_of(page, [1, 0]) - moving.pixel_of(page, [0, 0]))
    browser.drag("#arm", corner, [corner[0] + (scale - 1) * span, corner[1] - (scale - 1) * span])
    browser.wait("the larger drawing", lambda: abs(size(browser)[0] - scale * 30) < 0.5)
    assert abs(field(browser, "left") - pivot[0]) < 0.11 and abs(field(browser, "low") - pivot[1]) < 0.11, "the opposite corner stays"
    browser.click("#grab")


def a_speed_is_chosen_and_left_to_the_file_again(page):
    browser = page.browser
    def seconds():
        found = re.search(r"([\d.]+) s$", browser.text("#size"))
        return float(found[1]) if found else 0
    before = browser.wait("its time", seconds)
    choose = "const field = document.getElementById('read-speed'); field.value = '{}'; field.dispatchEvent(new Event('change'));"
    browser.script(choose.format(5))
    browser.wait("the slow drawing", lambda: seconds() > 3 * before)
    browser.script(choose.format(""))
    browser.wait("the file's speed", lambda: 0 < seconds() < 1.1 * before)


def the_tool_goes_around_the_drawing(page):
    """It begins and ends at the lower left corner; a test of the server looks at the whole way."""
    browser = page.browser
    corner = [field(browser, "left"), field(browser, "low")]
    middle = [low + span / 2 for low, span in zip(corner, size(browser))]
    def off():
        return max(abs(at - wanted) for at, wanted in zip(page.tool(), corner))
    page.wait_for_rest()
    moving.drag_the_tool(page, moving.pixel_of(page, middle))
    assert off() > 5, f"the tool is at {page.tool()}, near the corner, before it goes around"
    page.ask("#frame")
    page.wait_for_notice("goes around the drawing")
    browser.wait("the way around", lambda: off() < 0.2 and page.at_rest())


# What the page says under each pixel of a grid over the drawing, once for each text.
UNDER = """
    const arm = document.getElementById('arm'), under = document.getElementById('under');
    const { left, top, width, height } = arm.getBoundingClientRect();
    const said = new Set();
    for (let x = 0; x < width; x += 5) for (let y = 0; y < height; y += 5) {
        arm.dispatchEvent(new PointerEvent('pointermove', { clientX: left + x, clientY: top + y, pointerType: 'mouse' }));
        said.add(under.hidden ? '' : under.textContent);
    }
    return [...said];"""


def the_pointer_shows_error_speed_line_and_time(browser):
    said = browser.script(UNDER)
    assert "" in said, "nothing far from the strokes"
    said.remove("")
    seen = [re.fullmatch(r"(\d+) µm off · (\d+) mm/s · line (\d+) · after ([\d.]+) s", text) for text in said]
    assert len(seen) > 10 and all(seen), said
    lines = {int(one[3]) for one in seen}
    assert {3, 4, 5, 6} <= lines <= {2, 3, 4, 5, 6, 7}, lines
    assert all(int(one[1]) < 50 and int(one[2]) < 60 for one in seen), said


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
    the_pointer_shows_error_speed_line_and_time(browser)
    browser.click('[data-colouring="speed"]')
    fast = drawn(browser, "--step4") + drawn(browser, "--step5")
    assert fast > 100 and drawn(browser, "--step7") == 0, f"{fast} pixels of 20 to 100 mm/s"
    assert "mm/s" in browser.text("#scale")
    for dark in (True, False):
        browser.dark(dark)
        reach.has_no_serious_violation(browser, f"strokes by speed, dark: {dark}")
    browser.click('[data-colouring="pen"]')
    assert not browser.script("return document.getElementById('scale').checkVisibility();")
    assert browser.script(UNDER) == [""], "nothing under the pointer with one colour"


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
    a_sheet_is_fitted_by_one_click(page)
    fields_and_corners_place_the_drawing(page)
    a_speed_is_chosen_and_left_to_the_file_again(page)
    the_tool_goes_around_the_drawing(page)
    strokes_have_the_colour_of_their_error_or_speed(page)
    the_last_run_is_shown_again_until_the_arm_moves(page)
