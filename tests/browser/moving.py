"""The page moves the arm by mouse, by keyboard and by a job, and stops it."""

import cmath
import math

from live import SHORT_JOB, TOO_LARGE

TAB, ENTER, ESCAPE, SPACE = "\ue004", "\ue007", "\ue00c", " "
LEFT, UP, RIGHT, SHIFT = "\ue012", "\ue013", "\ue014", "\ue008"


# The benchtop arm: cranks of 100 mm, their axes 80 mm apart.
CRANK, BASE = 100, 80


def pixel_of(page, place):
    """The pixel of a position [mm] on the canvas, from the elbows' pixels: x + iy, y downwards."""
    conjugates = [cmath.exp(-1j * math.radians(angle)) * CRANK for angle in page.angles()]
    elbow1, elbow4 = (complex(*page.pixel(name)) for name in ("theta1", "theta4"))
    scale = abs(elbow4 - elbow1) / abs(BASE + conjugates[1] - conjugates[0])
    return elbow1 + scale * (complex(*place).conjugate() - conjugates[0])


def drag_the_tool(page, end):
    """Drags the tool to a pixel as from `pixel_of`, and waits until it rests there."""
    page.browser.drag("#arm", page.pixel("tool"), [end.real, end.imag])
    def missed():
        return abs(complex(*page.pixel("tool")) - end)
    page.browser.wait("the tool under the hand", lambda: missed() < 2 and page.at_rest())


def the_arm_follows_the_hand(page):
    before, tool = page.angles(), page.tool()
    drag_the_tool(page, complex(*page.pixel("tool")) + 40 + 25j)
    after, moved = page.angles(), page.tool()
    turned = [abs(a - b) for a, b in zip(after, before)]
    assert min(turned) > 1.0, f"the joints turned by {turned} degrees only"
    assert moved[0] > tool[0] and moved[1] < tool[1], f"from {tool} to {moved} mm"


def an_elbow_follows_the_hand_and_the_other_stays(page):
    axis, before = pixel_of(page, [0, 0]), page.angles()
    crank = complex(*page.pixel("theta1")) - axis
    # 15 degrees clockwise, and a little off the elbow's circle.
    hand = axis + 1.1 * crank * cmath.exp(1j * math.radians(15))
    page.browser.drag("#arm", page.pixel("theta1"), [hand.real, hand.imag])
    page.browser.wait("joint 1 under the hand", lambda: page.at_rest() and
                      abs(page.angles()[0] - before[0] + 15) < 1)
    other = page.angles()[1]
    assert abs(other - before[1]) < 0.02, f"joint 4 went from {before[1]} to {other} degrees"


def keys_alone_home_arm_jog_and_stop(page):
    browser = page.browser

    def go_to(selector):
        """From the top: behind its last control a browser may go on with its own."""
        browser.script("document.getElementById('emergency').focus();")
        for _ in range(60):
            browser.press(TAB)
            if browser.script(f"return document.activeElement.matches('{selector}');"):
                return
        raise AssertionError(f"the Tab key never comes to {selector}")

    def open_tab(name):
        """By the arrow keys, from whichever tab is open."""
        go_to('[role="tab"]')
        for _ in range(4):
            if browser.script("return document.activeElement.getAttribute('aria-selected');") == "true" \
                    and browser.script("return document.activeElement.textContent;") == name:
                return
            browser.press(RIGHT)
        raise AssertionError(f"the arrow keys never come to {name}")

    open_tab("Arm")
    go_to('[data-request="home"]')
    browser.press(ENTER)
    browser.wait("home", lambda: page.state() == "Stopped" and len(page.angles()) == 2)
    go_to('[data-request="arm"]')
    browser.press(ENTER)
    page.wait_for("Armed")
    tool = page.tool()
    browser.press(UP)  # by 1 mm
    browser.wait("the jog", lambda: abs(page.tool()[1] - tool[1] - 1.0) < 0.05)
    page.wait_for_rest()
    before = page.angles()
    browser.press(SHIFT, LEFT)  # joint 1 by +1 degree
    browser.wait("the turn", lambda: abs(page.angles()[0] - before[0] - 1.0) < 0.05)
    assert abs(page.angles()[1] - before[1]) < 0.02
    page.load_job(SHORT_JOB, "within the arm's limits")
    open_tab("Job")
    go_to("#run")
    browser.press(ENTER)
    page.wait_for("Running")
    browser.script("document.activeElement.blur();")
    browser.press(SPACE)
    page.wait_for("Armed")
    browser.wait("its place", lambda: "stopped at line" in browser.text("#left"))
    browser.click('[data-zoom="arm"]')


def what_is_out_of_reach_is_refused_with_the_reason(page):
    start = page.pixel("tool")
    page.browser.drag("#arm", start, [5, 5], steps=2)
    page.wait_for_notice("refused")
    # First the arm does the part of the drag that it can do.
    page.wait_for_rest()


def the_branch_changes_and_the_tool_returns(page):
    browser = page.browser
    # Here both joints stay within their limits on either side of elbow 1.
    drag_the_tool(page, pixel_of(page, [-40, 200]))
    tool, elbows = page.tool(), browser.text("#elbows")
    assert elbows == "1 right, 4 left", elbows
    for chosen, shown in (("left,left", "1 left, 4 left"), ("right,left", "1 right, 4 left")):
        page.choose_branch(chosen)
        page.ask("#change")
        browser.wait(shown, lambda: page.at_rest() and browser.text("#elbows") == shown)
        assert max(abs(a - b) for a, b in zip(page.tool(), tool)) < 0.1, page.tool()
    # With elbow 4 on the other side, joint 4 would leave its limits.
    page.choose_branch("right,right")
    page.ask("#change")
    page.wait_for_notice("the tool cannot be at")
    page.wait_for_rest()
    assert browser.text("#elbows") == "1 right, 4 left", browser.text("#elbows")


def a_job_is_looked_through_before_anything_moves(page):
    tool = page.tool()
    page.load_job(TOO_LARGE, "is refused")
    assert "On the way to line 2: " in page.browser.text("#job"), page.browser.text("#job")
    page.ask("#run")
    page.wait_for_notice("The job cannot be done")
    page.wait_for_rest()
    assert max(abs(a - b) for a, b in zip(page.tool(), tool)) < 0.02, page.tool()


def a_job_runs_to_its_end(page):
    page.load_job(SHORT_JOB, "4 moves, all within the arm's limits")
    page.run_job()
    page.wait_for_notice("The job is done.")
    # The notice comes on its own, state and progress with the next telemetry.
    page.wait_for("Armed", timeout=5)
    page.browser.wait("the progress of no job or of a whole one", lambda: page.browser.script(
        "return document.getElementById('progress').value;") in (0, 1), timeout=5)


def the_emergency_stop_shows_the_fault(page):
    page.run_job()
    page.browser.press(ESCAPE)
    page.wait_for("Fault", timeout=5)
    page.browser.wait("the fault", lambda: "emergency stop (10)" in page.browser.text("#fault"))
    assert "Running" in page.browser.text("#snapshot"), "the snapshot tells what it was doing"
    page.recover()
    # The button does the same.
    page.run_job()
    page.browser.click("#emergency")
    page.wait_for("Fault", timeout=5)
    page.recover()


def check(page):
    keys_alone_home_arm_jog_and_stop(page)
    the_arm_follows_the_hand(page)
    an_elbow_follows_the_hand_and_the_other_stays(page)
    what_is_out_of_reach_is_refused_with_the_reason(page)
    the_branch_changes_and_the_tool_returns(page)
    a_job_is_looked_through_before_anything_moves(page)
    a_job_runs_to_its_end(page)
    the_emergency_stop_shows_the_fault(page)
