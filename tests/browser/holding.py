"""Motion for as long as a control is held: by mouse, finger and key."""

import time

from live import PAUSE, Wire

RIGHT = ("ArrowRight", "ArrowRight", 39)
ENTER = ("Enter", "Enter", 13)


MOST = 40  # mm, far less than the arm can go
STEPS = 3  # mm: more than the step that a key makes at once


def hold_until(page, what, begin, end, reached):
    """Holds something until this holds while the arm moves. If a busy machine keeps the page from renewing the motion, the
    arm stops: then it is held again."""
    begin()
    begun = time.monotonic()
    def is_reached():
        nonlocal begun
        state = page.state()
        if state == "Armed" and time.monotonic() > begun + PAUSE:
            end()
            time.sleep(PAUSE)
            begin()
            begun = time.monotonic()
        return state == "Running" and reached()
    page.browser.wait(what, is_reached)


def moved_by(page, what, begin, end):
    """How far the tool moves while something is held until it has made three steps [mm]; it rests after the end."""
    page.wait_for_rest()
    time.sleep(PAUSE)
    before = page.tool()
    hold_until(page, f"three steps: {what}", begin, end, lambda: page.tool()[0] > before[0] + STEPS)
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
        begin, end = (lambda kind=kind: browser.mouse(kind, left, button="left", clickCount=1)
                      for kind in ("mousePressed", "mouseReleased"))
        hold_until(page, "the way back", begin, end, lambda: page.tool()[0] < to + 1)
        end()

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
    a_key_whose_release_has_another_name_or_none_moves_the_arm_no_longer(page)
    the_arm_rests_when_the_connection_is_cut(page, server)


def a_key_whose_release_has_another_name_or_none_moves_the_arm_no_longer(page):
    """Keys as systems send them, each with its name, its place, its number and the modifiers that are down (8: Shift)."""
    browser = page.browser
    shift, meta, lock = ("Shift", "ShiftLeft", 16), ("Meta", "MetaLeft", 91), ("NumLock", "NumLock", 144)
    cases = {
        # With NumLock, Shift makes an arrow of the 4; the 4 is released after Shift.
        "Shift is released first": (
            [("keyDown", *shift, 8), ("keyDown", "ArrowLeft", "Numpad4", 37, 8)],
            [("keyUp", *shift, 0), ("keyUp", "4", "Numpad4", 100, 0)]),
        "NumLock changes its name": (
            [("keyDown", "ArrowDown", "Numpad2", 40, 0)],
            [("keyDown", *lock, 0), ("keyUp", *lock, 0), ("keyUp", "2", "Numpad2", 98, 0)]),
        "NumLock alone": (
            [("keyDown", "ArrowDown", "Numpad2", 40, 0)],
            [("keyDown", *lock, 0)]),
        "its release has another name": (
            [("keyDown", "ArrowRight", "Numpad6", 39, 0)],
            [("keyUp", "6", "Numpad6", 102, 0)]),
        "the system keeps the release to itself": (
            [("keyDown", "ArrowLeft", "ArrowLeft", 37, 0)],
            [("keyDown", *meta, 4)]),
        "the focus moves": (
            [("keyDown", "ArrowRight", "ArrowRight", 39, 0)],
            [None]),
    }

    def send(events):
        for event in events:
            if event is None:
                browser.focus("#emergency")
                continue
            kind, key, code, number, modifiers = event
            browser.key(kind, key, code, number, modifiers=modifiers)

    for what, (begin, end) in cases.items():
        page.wait_for_rest()
        browser.focus("#arm")
        before = page.tool()
        def gone():
            return max(abs(now - then) for now, then in zip(page.tool(), before))
        hold_until(page, f"the motion: {what}", lambda: send(begin), lambda: send(end), lambda: gone() > STEPS)
        send(end)
        browser.wait(f"rest: {what}", lambda: page.state() == "Armed" and page.at_rest())
        assert gone() < MOST, f"{what}: {gone()} mm"
        send([("keyUp", *shift, 0), ("keyUp", *meta, 0)])


def the_arm_rests_when_the_connection_is_cut(watcher, server):
    """The server ends the motion: no renewal comes."""
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
    watcher.wait_for("Armed")
    watcher.wait_for_rest()
    wire.whole.set()
    holder.show()
    browser.close_tab()
    watcher.show()
    browser.click("#control")
    browser.wait("control", lambda: "watches" not in browser.text("#state"))
