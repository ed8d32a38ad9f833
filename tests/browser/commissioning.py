"""The guided page of a commissioning: clicks do its steps, name a mistake, and stop the arm."""

import pathlib
import tempfile

import reach
from live import Server

SWAPPED = 'job = "dot.gcode"\n[wiring]\nmotors_swapped = true\n'


def begin(browser, step):
    browser.wait(step, lambda: browser.text("#begin") == f"Start {step}")
    browser.click("#begin")


def over(browser, step):
    """Waits until the page waits for a click after this step."""
    browser.wait(f"the end of {step}",
                 lambda: browser.text("#state") == "waiting" and browser.text("#begin"))


def tasks_are_asked_for_and_a_mistake_is_named(browser):
    begin(browser, "supply")
    begin(browser, "emergency-stop")
    browser.wait("a task", lambda: "Press the emergency stop" in browser.text("#ask"))
    browser.click("#done")
    browser.wait("a task", lambda: "Release the emergency stop" in browser.text("#ask"))
    browser.click("#done")
    for step in ["switches", "encoders"]:
        begin(browser, step)
        browser.wait("a task", lambda: browser.text("#all"))
        browser.click("#all")
    begin(browser, "motors")
    said = browser.wait("the mistake", lambda: browser.text("#trouble"))
    assert "the motors are swapped" in said and "To do: exchange the motors' plugs" in said, said
    assert browser.text("#begin") == "Start motors", "the step is not done"


def escape_stops_while_a_task_waits(browser):
    browser.script("document.querySelectorAll('#steps button')[1].click();")
    begin(browser, "emergency-stop")
    browser.wait("a task", lambda: browser.text("#ask"))
    browser.press("\ue00c")
    browser.wait("the stop", lambda: "the bridges are off" in browser.text("#trouble"))
    begin(browser, "emergency-stop")
    browser.wait("a task", lambda: browser.text("#ask"))
    browser.click("#emergency")
    browser.wait("the stop", lambda: "the bridges are off" in browser.text("#trouble"))


def check(program, browser):
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "dot.gcode").write_text("G1 X1 F600\n")
        (folder / "wired.toml").write_text(SWAPPED)
        options = ["--commission", str(folder / "out"), "--scenario", str(folder / "wired.toml")]
        with Server(program, options=options) as server:
            browser.open(server.url)
            tasks_are_asked_for_and_a_mistake_is_named(browser)
            reach.has_no_serious_violation(browser, "the guided page")
            escape_stops_while_a_task_waits(browser)
        # The same record with the motors' plugs exchanged: the page goes on where it stopped. Steps that
        # were to be repeated and were not are still done.
        with Server(program, options=options[:2]) as server:
            browser.open(server.url)
            begin(browser, "motors")
            over(browser, "motors")
            assert browser.text("#begin") == "Start electrics", browser.text("#begin")
