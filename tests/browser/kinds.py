"""The page of arms with other drives than brushed motors: what each drive does, what the tip error is of, and the replay."""

import time

import reach
from live import PAUSE, Page, Server
from runs import drawn

JOB = "G21 G90 F1500\nM3\nG1 X15 Y0\nG1 X15 Y10\nG1 X0 Y10\nG1 X0 Y0\n"
MEASURED = "Tip error from the drives' encoders"
# The values of the drives with their units, the words for the tip error, and whether all have a value without power.
KINDS = {
    "benchtop_stepper": ({"torque by the arm's model, at the joint": "N·m", "micro-steps told": "1/s",
                          "load angle by the arm's model": "° electrical"}, "Tip error of the micro-steps made", False),
    "leg": ({"torque told by the drive, at the joint": "N·m", "current": "A"}, MEASURED, True),
    "classroom_servo": ({"torque by the arm's model, at the joint": "N·m", "width of the pulse": "µs"},
                        "Tip error of the pulses made", False),
}


def numbers(browser):
    """The values of the drives by their names, as text."""
    browser.click("#tab-arm")
    return dict(browser.script("""
        return [...document.querySelectorAll('#drive-numbers > div')].map(
            (row) => [row.querySelector('dt').textContent, row.querySelector('dd').textContent]);"""))


def captions(browser):
    """The captions of the plots that are seen."""
    browser.click("#tab-plots")
    return browser.script("""
        return [...document.querySelectorAll('#panel-plots figcaption')]
            .filter((caption) => caption.checkVisibility()).map((caption) => caption.textContent);""")


def home_and_arm(page):
    """Open-loop steppers keep their power after homing, because without it they lose their place."""
    page.request("home")
    page.browser.wait("home", lambda: page.state() in ("Stopped", "Armed") and len(page.angles()) == 2)
    if page.state() == "Stopped":
        page.request("arm")
        page.wait_for("Armed")


def each_drive_shows_its_own_values(page, units, is_told_without_power):
    browser = page.browser
    before = numbers(browser)
    assert list(before) == list(units), before
    assert is_told_without_power or set(before.values()) == {"–"}, before
    home_and_arm(page)
    page.load_job(JOB, "within the arm's limits")
    time.sleep(PAUSE)
    page.run_job()
    for name, unit in units.items():
        shown = browser.wait(name, lambda name=name: numbers(browser)[name].removeprefix("–"))
        pair = shown.removesuffix(f" {unit}").replace("−", "-").split(", ")
        assert shown.endswith(f" {unit}") and len([float(value) for value in pair]) == 2, shown
    page.wait_for("Armed", 60)


def the_tip_error_is_called_what_it_is(page, units, words):
    seen = captions(page.browser)
    assert seen[0].startswith(words), seen
    assert [caption.lower() for caption in seen[-len(units):]] == [name.lower() for name in units], seen
    # What the controller does not tell has no plot.
    assert ("Torques demanded" in seen) == (words == MEASURED), seen
    reach.has_no_serious_violation(page.browser, f"the plots of {words}")


def the_run_is_shown_again(page):
    browser = page.browser
    length = float(browser.text("#replay-value").removesuffix(" s"))
    assert 1.5 < length < 30, f"{length} s for 50 mm at 25 mm/s at most"
    browser.click('[data-zoom="job"]')
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
    browser.click("#live")
    assert not browser.script("return document.getElementById('replaying').checkVisibility();")


def check(program, browser):
    for robot, (units, words, is_told_without_power) in KINDS.items():
        with Server(program, options=("--robot", robot)) as server:
            page = Page(browser, server.url)
            browser.resize(1280, 900)
            each_drive_shows_its_own_values(page, units, is_told_without_power)
            the_tip_error_is_called_what_it_is(page, units, words)
            the_run_is_shown_again(page)
