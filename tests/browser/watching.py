"""Several pages, and pages that are lost."""

import time

from live import LONG_JOB, Page, Wire

ESCAPE = "\ue00c"


def watch(browser, url):
    """Opens another page beside the one that is driven."""
    browser.new_tab()
    return Page(browser, url)


def take_control(browser):
    def watches():
        return "watches" in browser.text("#state")
    if watches():
        browser.click("#control")
        browser.wait("control", lambda: not watches())


def has_stood_still(page):
    seen = page.angles()
    time.sleep(0.4)
    return max(abs(a - b) for a, b in zip(page.angles(), seen)) <= 0.02


def wait_for_lost_page(watcher):
    watcher.wait_for("Fault")
    words = watcher.browser.text
    watcher.browser.wait("the fault", lambda: "command timeout (12)" in words("#fault"))
    assert "disconnected or suspended" in words("#cause") and "Running" in words("#snapshot")
    # The fault is shown as the arm begins to slow down; its job would last half a minute.
    watcher.browser.wait("rest", lambda: has_stood_still(watcher), timeout=3)


def a_hidden_page_keeps_control_and_a_second_one_watches(pilot, url):
    browser = pilot.browser
    pilot.load_job(LONG_JOB, "within the arm's limits")
    pilot.run_job()
    watcher = watch(browser, url)
    assert "this page watches" in browser.text("#state")
    for act in (lambda: browser.click('[data-jog="1,0"]'), lambda: browser.click("#run"),
                lambda: pilot.request("disarm")):
        act()
        watcher.wait_for_notice("take control first")
    browser.click("#control")
    watcher.wait_for_notice("stop the arm, then take control")
    time.sleep(2)
    assert watcher.state() == "Running", "the job goes on though its page is hidden"
    browser.press(ESCAPE)
    watcher.wait_for("Fault", timeout=5)
    # At rest anyone may take over.
    take_control(browser)
    watcher.recover()
    pilot.show()
    assert "Another page has taken control" in browser.text("#notice")
    take_control(browser)
    return watcher


def a_closed_page_brings_the_arm_to_rest(pilot, watcher):
    pilot.load_job(LONG_JOB, "within the arm's limits")
    pilot.run_job()
    pilot.browser.close_tab()
    watcher.show()
    wait_for_lost_page(watcher)


def a_page_put_to_sleep_brings_the_arm_to_rest(pilot, url):
    browser = pilot.browser
    take_control(browser)
    pilot.recover()
    pilot.load_job(LONG_JOB, "within the arm's limits")
    pilot.run_job()
    browser.chromium("Page.setWebLifecycleState", state="frozen")
    time.sleep(1)  # another tab would wake it
    watcher = watch(browser, url)
    wait_for_lost_page(watcher)
    return watcher


def a_page_cut_off_keeps_its_emergency_stop(watcher, server):
    """The line falls silent without being closed, as when a radio link is lost."""
    browser = watcher.browser
    take_control(browser)
    watcher.recover()
    wire = Wire(server.port)
    pilot = watch(browser, wire.url)
    take_control(browser)
    pilot.load_job(LONG_JOB, "within the arm's limits")
    pilot.run_job()
    wire.whole.clear()
    pilot.wait_for("offline")
    browser.press(ESCAPE)
    pilot.wait_for_notice("sent as soon as there is a connection")
    watcher.show()
    wait_for_lost_page(watcher)
    wire.whole.set()
    browser.wait("the emergency stop", lambda: "emergency stop (10)" in browser.text("#fault"))


def check(pilot, server):
    watcher = a_hidden_page_keeps_control_and_a_second_one_watches(pilot, server.url)
    a_closed_page_brings_the_arm_to_rest(pilot, watcher)
    watcher = a_page_put_to_sleep_brings_the_arm_to_rest(watcher, server.url)
    a_page_cut_off_keeps_its_emergency_stop(watcher, server)
