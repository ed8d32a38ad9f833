"""The guided page of a commissioning: clicks do its steps, name a mistake, and stop the arm."""

import contextlib
import pathlib
import socket
import tempfile
import threading
import time

import reach
from live import PAUSE, Server

ESCAPE = "\ue00c"

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


def steppers_have_steps_of_their_own_and_a_mistake_is_named(browser):
    begin(browser, "emergency-stop")
    browser.wait("a task", lambda: "Press the emergency stop" in browser.text("#ask"))
    browser.click("#all")
    begin(browser, "switches")
    browser.wait("a task", lambda: "Press the home switch" in browser.text("#ask"))
    browser.click("#all")
    begin(browser, "encoders")
    begin(browser, "current")
    browser.wait("a task", lambda: "Set both drivers to this current" in browser.text("#ask"))
    assert "TMC2209" in browser.text("#lines"), browser.text("#lines")
    browser.click("#all")
    begin(browser, "enable")
    browser.wait("a question", lambda: "Try gently to turn the crank of joint 1" in browser.text("#ask"))
    browser.click("#all")
    begin(browser, "motors")
    browser.wait("a task", lambda: "Turn the arm by hand" in browser.text("#ask"))
    browser.click("#all")
    said = browser.wait("the mistake", lambda: browser.text("#trouble"))
    assert "the driver of joint 1 turns joint 4" in said, said
    assert browser.text("#begin") == "Start motors", "the step is not done"


def wait_for_the_stop(browser):
    browser.wait("the stop", lambda: browser.text("#safe"))
    assert "the bridges are off" in browser.text("#trouble")
    browser.wait("the confirmation", lambda: "Emergency stop confirmed" in browser.text("#alarm"))
    assert not browser.text("#begin"), "no step begins before a person has said that the arm is safe"


def escape_stops_while_a_task_waits(browser):
    browser.script("document.querySelectorAll('#steps button')[1].click();")
    begin(browser, "emergency-stop")
    browser.wait("a task", lambda: browser.text("#ask"))
    browser.press(ESCAPE)
    wait_for_the_stop(browser)
    browser.click("#safe")
    time.sleep(PAUSE)
    begin(browser, "emergency-stop")
    browser.wait("a task", lambda: browser.text("#ask"))
    browser.click("#emergency")
    wait_for_the_stop(browser)


def three_clicks_in_one_place_do_not_begin_a_step_after_a_stop(browser):
    spot = browser.middle("#safe")
    browser.click_at(spot, times=4)
    time.sleep(0.5)
    assert not browser.text("#task"), "nothing has begun"
    browser.press(ESCAPE)
    wait_for_the_stop(browser)


def an_emergency_stop_reaches_a_server_that_a_thousand_connections_a_second_keep_busy(server, browser):
    """They show no token. The page has a connection already."""
    ends = threading.Event()
    host = ("127.0.0.1", server.port)
    request = f"GET / HTTP/1.1\r\nHost: {server.host}\r\n\r\n".encode()

    def connect_and_leave():
        start, count = time.monotonic(), 0
        while not ends.is_set():
            count += 1
            time.sleep(max(0, start + count / 250 - time.monotonic()))
            with contextlib.suppress(OSError), socket.create_connection(host, 1) as stream:
                stream.sendall(request)

    floods = [threading.Thread(target=connect_and_leave) for _ in range(4)]
    for flood in floods:
        flood.start()
    try:
        for _ in range(5):
            browser.script("document.getElementById('alarm').textContent = '';")
            browser.press(ESCAPE)
            browser.wait("the confirmation", lambda: "confirmed" in browser.text("#alarm"), timeout=5)
    finally:
        ends.set()
        for flood in floods:
            flood.join()


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
            three_clicks_in_one_place_do_not_begin_a_step_after_a_stop(browser)
            an_emergency_stop_reaches_a_server_that_a_thousand_connections_a_second_keep_busy(server, browser)
        # The same record with the motors' plugs exchanged: the page goes on where it stopped. Steps that
        # were to be repeated and were not are still done.
        with Server(program, options=options[:2]) as server:
            browser.open(server.url)
            begin(browser, "motors")
            over(browser, "motors")
            assert browser.text("#begin") == "Start electrics", browser.text("#begin")
        (folder / "stepper.toml").write_text('robot = "benchtop_stepper"\n' + SWAPPED)
        options = ["--commission", str(folder / "stepper"), "--robot", "benchtop_stepper",
                   "--scenario", str(folder / "stepper.toml")]
        with Server(program, options=options) as server:
            browser.open(server.url)
            steppers_have_steps_of_their_own_and_a_mistake_is_named(browser)
