"""Esc and Space stop the arm whatever has the focus, and a stop is not undone by a click too many."""

import time

from live import LONG_JOB, PAUSE, Wire

ENTER, ESCAPE, SPACE, SHIFT, CONTROL = "\ue007", "\ue00c", " ", "\ue008", "\ue009"

# A control of each kind.
CONTROLS = ["#run", "#next", "#feed", "#from", "#file", "#run-on", "#arm", '[data-mode="left,left"]',
            "#tab-job", "#tab-plots", '[data-pen="up"]', "#emergency"]
# Those of them that a click opens or changes, without a request to the arm.
CLICKED = ["#feed", "#from", "#file", "#arm", '[data-mode="left,left"]', "#tab-job", "#tab-plots"]


def run(page):
    page.browser.script("scrollTo(0, 0);")
    page.ask("#run")
    page.wait_for("Running")


def stopped_at_once(page):
    page.wait_for("Fault", timeout=5)
    page.browser.wait("the confirmation", lambda: "Emergency stop confirmed" in page.alarm(), timeout=5)


def stays_at_rest(page, seconds=1.5):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        assert page.state() not in ("Running", "Homing"), page.state()
    page.wait_for_rest()


def no_control_of_the_browser_keeps_keys_to_itself(page):
    """A list that is open closes at Esc, and the page does not get the key."""
    kept = page.browser.script(
        "return document.querySelectorAll('select, dialog, details, datalist, iframe, [popover]').length;")
    assert kept == 0, kept


def escape_stops_though_a_list_of_the_browser_takes_the_key(page):
    """The browser closes the list at once; the page gets only the release of the key."""
    browser = page.browser
    browser.script("""
        const list = document.createElement('select');
        list.append(new Option('a list'));
        list.id = 'list';
        document.getElementById('numbers').before(list);""")
    run(page)
    browser.click_at(browser.middle("#list"))
    browser.wait("the list", lambda: browser.script("return document.querySelector('#list:open') !== null;"))
    browser.press(ESCAPE)
    stopped_at_once(page)
    browser.script("document.getElementById('list').remove();")
    page.recover()


def escape_stops_from_every_control(page):
    browser = page.browser
    for selector in CONTROLS:
        run(page)
        if selector in CLICKED:
            browser.click_at(browser.middle(selector))
        else:
            browser.focus(selector)
        browser.press(ESCAPE)
        stopped_at_once(page)
        if selector in CLICKED:
            time.sleep(PAUSE)  # the page does nothing yet where the control was clicked
        page.recover()


def space_stops_from_every_control(page):
    browser = page.browser
    for selector in CONTROLS:
        run(page)
        browser.focus(selector)
        browser.press(SPACE)
        page.wait_for("Armed", timeout=5)
        stays_at_rest(page, 0.3)


def space_stops_a_job_that_has_just_been_started(page):
    page.ask("#run")
    page.browser.press(SPACE)
    time.sleep(0.3)
    stays_at_rest(page)


def keys_with_others_and_of_input_methods_stop(page):
    browser = page.browser
    for press in (lambda: browser.press(SHIFT, ESCAPE),
                  lambda: browser.press(CONTROL, ESCAPE),
                  # While an input method composes a text.
                  lambda: [browser.key(kind, "Process", "Escape", 229) for kind in ("keyDown", "keyUp")],
                  # The browser's own list or menu has taken the key, and its release comes to the page.
                  lambda: browser.key("keyUp", "Escape", "Escape", 27)):
        browser.click("#from")
        run(page)
        browser.focus("#from")
        press()
        stopped_at_once(page)
        page.recover()
    browser.key("keyUp", "Escape", "Escape", 27)
    time.sleep(0.3)
    assert page.state() == "Armed", "at rest the release alone means nothing"
    for keys in ((SHIFT, SPACE), (CONTROL, SPACE)):
        run(page)
        browser.press(*keys)
        page.wait_for("Armed", timeout=5)


def a_menu_of_the_browser_does_not_open(page):
    browser = page.browser
    browser.script("""
        window.opened = [];
        for (const kind of ['contextmenu', 'dragstart']) {
            addEventListener(kind, (event) => window.opened.push(!event.defaultPrevented));
        }""")
    for kind in ("mousePressed", "mouseReleased"):
        browser.mouse(kind, browser.middle("#job"), button="right", clickCount=1)
    browser.script("document.getElementById('job').dispatchEvent(new Event('dragstart', "
                   "{ bubbles: true, cancelable: true }));")
    assert browser.script("return window.opened;") == [False, False]


def the_window_to_choose_a_file_does_not_open_while_the_arm_moves(page):
    run(page)
    page.browser.script("document.getElementById('file').click();")
    page.wait_for_notice("would take the keys")
    page.browser.press(SPACE)
    page.wait_for("Armed")


def a_held_space_stops_and_does_not_press_the_button_when_the_arm_rests(page):
    browser = page.browser
    run(page)
    browser.focus("#run")
    browser.key("keyDown", " ", "Space", 32, text=" ")
    for _ in range(20):
        browser.key("keyDown", " ", "Space", 32, text=" ", autoRepeat=True)
        time.sleep(0.04)
    browser.key("keyUp", " ", "Space", 32)
    stays_at_rest(page)
    # At rest, too, Space starts nothing.
    browser.press(SPACE)
    stays_at_rest(page, 0.7)


def a_held_enter_presses_a_button_once(page):
    browser = page.browser
    run(page)
    browser.press(ESCAPE)
    stopped_at_once(page)
    browser.focus("[data-request=clear_fault]")
    browser.press(ENTER)
    page.wait_for("Stopped")
    time.sleep(PAUSE)
    browser.focus("#next")
    browser.script("""
        window.states = [];
        new MutationObserver(() => window.states.push(document.body.dataset.state))
            .observe(document.body, { attributeFilter: ['data-state'] });""")
    browser.key("keyDown", "Enter", "Enter", 13, text="\r")
    for _ in range(40):
        browser.key("keyDown", "Enter", "Enter", 13, text="\r", autoRepeat=True)
        time.sleep(0.05)
    browser.key("keyUp", "Enter", "Enter", 13)
    page.wait_for("Armed")
    stays_at_rest(page)
    seen = browser.script("return window.states;")
    assert "Armed" in seen and "Running" not in seen, seen


def clicks_in_one_place_do_not_lead_from_an_emergency_stop_to_a_motion(page):
    browser = page.browser
    for place in ("#next", '[data-request="clear_fault"]', "#run"):
        for every in (0.15, 1.3):
            run(page)
            browser.press(ESCAPE)
            stopped_at_once(page)
            browser.click_at(browser.middle(place), times=3, every=every)
            stays_at_rest_or_off(page, 0.7)
            if page.state() == "Fault":
                page.recover()
            elif page.state() == "Stopped":
                time.sleep(PAUSE)
                page.request("arm")
                page.wait_for("Armed")


def stays_at_rest_or_off(page, seconds):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        assert page.state() in ("Fault", "Stopped"), page.state()


def a_second_click_on_stop_does_not_run_the_job_again(page):
    browser = page.browser
    for times in (2, 3):
        run(page)
        browser.wait("the stop", lambda: browser.text("#next") == "Stop")
        browser.click_at(browser.middle("#next"), times=times, every=0.3)
        page.wait_for("Armed")
        stays_at_rest(page)


def a_stop_takes_the_arm_out_of_the_hand_that_drags_it(page):
    browser = page.browser
    left, top = browser.script("""
        const box = document.getElementById('arm').getBoundingClientRect();
        return [box.left, box.top];""")
    x, y = page.pixel("tool")
    hand = [left + x, top + y]
    browser.mouse("mousePressed", hand, button="left", buttons=1, clickCount=1)
    for step in range(30):
        browser.mouse("mouseMoved", [hand[0] + step, hand[1] + step], button="left", buttons=1)
        time.sleep(0.02)
    browser.press(SPACE)
    time.sleep(0.6)
    before = page.tool()
    for step in range(30):
        browser.mouse("mouseMoved", [hand[0] + 30 - step, hand[1] + 30 - step], button="left", buttons=1)
        time.sleep(0.02)
    assert max(abs(a - b) for a, b in zip(page.tool(), before)) < 0.1, (before, page.tool())
    browser.mouse("mouseReleased", hand, button="left", clickCount=1)
    stays_at_rest(page, 0.3)


def escape_stops_while_the_page_is_loading(page, server):
    """The server does not send a file that the page needs; another page runs a job."""
    browser = page.browser
    page.load_job(LONG_JOB, "within the arm's limits")
    run(page)
    wire = Wire(server, holds=b"GET /maps.json")
    browser.new_tab()
    browser.open(wire.url)
    tab = browser.tab()
    assert browser.script("return document.body.dataset.state ?? '';") == "", "it is not loaded"
    browser.press(ESCAPE)
    browser.wait("the confirmation", lambda: "Emergency stop confirmed" in browser.text("#alarm"), timeout=5)
    page.show()
    page.wait_for("Fault", timeout=5)
    browser.switch(tab)
    wire.released.set()
    browser.wait("the rest", lambda: browser.script("return document.body.dataset.state ?? '';") == "Fault")
    browser.close_tab()
    page.show()
    page.recover()


def the_page_says_that_keys_do_not_reach_it(page):
    browser = page.browser
    run(page)
    assert not browser.text("#keys")
    browser.script("document.hasFocus = () => false; dispatchEvent(new Event('blur'));")
    assert "click on this page" in browser.text("#keys")
    browser.script("delete document.hasFocus; dispatchEvent(new Event('focus'));")
    assert not browser.text("#keys")
    browser.press(SPACE)
    page.wait_for("Armed")


def check(page, server):
    page.load_job(LONG_JOB, "within the arm's limits")
    no_control_of_the_browser_keeps_keys_to_itself(page)
    space_stops_a_job_that_has_just_been_started(page)
    a_held_space_stops_and_does_not_press_the_button_when_the_arm_rests(page)
    the_window_to_choose_a_file_does_not_open_while_the_arm_moves(page)
    a_second_click_on_stop_does_not_run_the_job_again(page)
    a_stop_takes_the_arm_out_of_the_hand_that_drags_it(page)
    space_stops_from_every_control(page)
    escape_stops_from_every_control(page)
    escape_stops_though_a_list_of_the_browser_takes_the_key(page)
    the_page_says_that_keys_do_not_reach_it(page)
    keys_with_others_and_of_input_methods_stop(page)
    a_menu_of_the_browser_does_not_open(page)
    clicks_in_one_place_do_not_lead_from_an_emergency_stop_to_a_motion(page)
    a_held_enter_presses_a_button_once(page)
    escape_stops_while_the_page_is_loading(page, server)
