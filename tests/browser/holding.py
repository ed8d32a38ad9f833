"""Motion for as long as a control is held: by mouse, finger and key."""

import time

from live import PAUSE, Wire

RIGHT = ("ArrowRight", "ArrowRight", 39)
ENTER = ("Enter", "Enter", 13)


MOST = 40  # mm, far less than the arm can go
STEPS = 3  # mm: more than the step that a key makes at once


def moved_by(page, what, begin, end):
    """How far the tool moves while something is held until it has made three steps [mm]; it rests after the end."""
    page.wait_for_rest()
    time.sleep(PAUSE)
    before = page.tool()
    begin()
    page.browser.wait(f"three steps: {what}", lambda: page.tool()[0] > before[0] + STEPS)
    assert page.state() == "Running", f"{what}: it moves while it is held"
    end()
    page.wait_for("Armed")
    page.wait_for_rest()
    after = page.tool()
    assert abs(after[1] - before[1]) < 0.1, f"{what}: {before} to {after} mm"
    return after[0] - before[0]


def check(page, server):
    browser = page.browser
    page.home_and_arm_if_needed()
    browser.script("const step = document.getElementById('step-size'); step.value = 1; step.dispatchEvent(new Event('input'));")
    assert browser.text("#step-size-value") == "1 mm, held: 10 mm/s", browser.text("#step-size-value")
    place = browser.middle('[data-jog="1,0"]')
    left = browser.middle('[data-jog="-1,0"]')

    def mouse(kind):
        browser.mouse(kind, place, button="left", clickCount=1)

    def key(kind, which):
        name, code, number = which
        browser.key(kind, name, code, number)

    def back(to):
        browser.mouse("mousePressed", left, button="left", clickCount=1)
        browser.wait("the way back", lambda: page.tool()[0] < to + 1)
        browser.mouse("mouseReleased", left, button="left", clickCount=1)

    def focus_and_press():
        browser.focus('[data-jog="1,0"]')
        key("keyDown", ENTER)

    ends = {
        "the mouse": (lambda: mouse("mousePressed"), lambda: mouse("mouseReleased")),
        "a finger": (lambda: browser.touch("touchStart", place), lambda: browser.touch("touchEnd")),
        "the mouse leaves": (lambda: mouse("mousePressed"), lambda: browser.mouse("mouseMoved", [place[0], place[1] + 200], button="left")),
        "the window loses the focus": (lambda: mouse("mousePressed"), lambda: browser.script("dispatchEvent(new Event('blur'));")),
        "an arrow key": (lambda: (browser.focus("#arm"), key("keyDown", RIGHT)), lambda: key("keyUp", RIGHT)),
        "Enter": (focus_and_press, lambda: key("keyUp", ENTER)),
    }
    start = page.tool()[0]
    for what, (begin, end) in ends.items():
        moved = moved_by(page, what, begin, end)
        assert moved < MOST, f"{what}: {moved} mm"
        mouse("mouseReleased")
        back(start)
    # A short press is one step.
    page.wait_for_rest()
    time.sleep(PAUSE)
    before = page.tool()[0]
    browser.click('[data-jog="1,0"]')
    browser.wait("the step", lambda: page.at_rest() and abs(page.tool()[0] - before - 1) < 0.05)
    the_arm_rests_when_the_connection_is_cut(page, server)


def the_arm_rests_when_the_connection_is_cut(watcher, server):
    """The controller's side ends the motion."""
    browser = watcher.browser
    wire = Wire(server)
    browser.new_tab()
    holder = type(watcher)(browser, wire.url)
    browser.click("#control")
    browser.wait("control", lambda: "watches" not in browser.text("#state"))
    place = browser.middle('[data-jog="-1,0"]')
    time.sleep(PAUSE)
    browser.mouse("mousePressed", place, button="left", clickCount=1)
    holder.wait_for("Running")
    wire.whole.clear()
    holder.wait_for("offline")
    browser.mouse("mouseReleased", place, button="left", clickCount=1)
    watcher.show()
    watcher.wait_for("Fault")
    assert "command timeout (12)" in browser.text("#fault"), browser.text("#fault")
    wire.whole.set()
    holder.show()
    browser.close_tab()
    watcher.show()
    browser.click("#control")
    watcher.recover()
