"""Several pages, and pages that are lost."""

import time

from live import LONG_JOB, Page, Wire

ESCAPE, SPACE = "\ue00c", " "


def watch(browser, url):
    """Opens another page in a new tab."""
    browser.new_tab()
    return Page(browser, url)


def is_in_view(browser, selector):
    return browser.script(f"""
        const box = document.querySelector('{selector}').getBoundingClientRect();
        return box.width > 200 && box.height > 20 && box.top >= 0 && box.bottom <= innerHeight;""")


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


def a_hidden_page_keeps_control_and_a_second_one_watches(holder, url):
    browser = holder.browser
    holder.load_job(LONG_JOB, "within the arm's limits")
    holder.run_job()
    watcher = watch(browser, url)
    assert "this page watches" in browser.text("#state")
    for act in (lambda: browser.click('[data-jog="1,0"]'), lambda: browser.click("#run"),
                lambda: holder.request("disarm")):
        act()
        watcher.wait_for_notice("take control first")
    browser.click("#control")
    watcher.wait_for_notice("stop the arm, then take control")
    time.sleep(2)
    assert watcher.state() == "Running", "the job goes on though its page is hidden"
    browser.press(ESCAPE)
    watcher.wait_for("Fault", timeout=5)
    # While the arm rests, any page may take control.
    take_control(browser)
    watcher.recover()
    holder.show()
    assert "Another page has taken control" in browser.text("#notice")
    take_control(browser)
    return watcher


def a_closed_page_brings_the_arm_to_rest(holder, watcher):
    holder.load_job(LONG_JOB, "within the arm's limits")
    holder.run_job()
    holder.browser.close_tab()
    watcher.show()
    wait_for_lost_page(watcher)


def a_page_put_to_sleep_brings_the_arm_to_rest(holder, url):
    browser = holder.browser
    take_control(browser)
    holder.recover()
    holder.load_job(LONG_JOB, "within the arm's limits")
    holder.run_job()
    browser.chromium("Page.setWebLifecycleState", state="frozen")
    time.sleep(1)  # another tab would wake it
    watcher = watch(browser, url)
    wait_for_lost_page(watcher)
    return watcher


def a_page_cut_off_keeps_its_emergency_stop(watcher, server):
    """The connection becomes silent without being closed, as when a radio link is lost."""
    browser = watcher.browser
    take_control(browser)
    watcher.recover()
    wire = Wire(server)
    holder = watch(browser, wire.url)
    take_control(browser)
    holder.load_job(LONG_JOB, "within the arm's limits")
    holder.run_job()
    wire.whole.clear()
    holder.wait_for("offline")
    browser.press(ESCAPE)
    browser.wait("the alarm", lambda: "NOT SENT: there is no connection" in holder.alarm())
    assert "Use the switch at the arm" in holder.alarm(), holder.alarm()
    assert is_in_view(browser, "#alarm")
    browser.press(SPACE)
    browser.wait("the alarm", lambda: "NOT SENT" in holder.alarm())
    watcher.show()
    wait_for_lost_page(watcher)
    wire.whole.set()
    browser.wait("the emergency stop", lambda: "emergency stop (10)" in browser.text("#fault"))
    holder.show()
    browser.wait("the confirmation", lambda: "NOT SENT" not in holder.alarm())
    watcher.show()


def a_page_that_stood_still_keeps_its_connection(page):
    """A busy page handles the ticks of its clock before the messages that came meanwhile."""
    browser = page.browser
    browser.script("""
        const Socket = WebSocket;
        window.opened = 0;
        window.WebSocket = class extends Socket { constructor(url) { super(url); opened += 1; } };""")
    for _ in range(3):
        browser.script("""
            window.awake = false;
            setTimeout(() => {
                const end = performance.now() + 4000;
                while (performance.now() < end);
                window.awake = true;
            }, 0);""")
        browser.wait("the page awake", lambda: browser.script("return window.awake;"))
        time.sleep(1.5)  # longer than until a lost connection is opened again
    assert browser.script("return opened;") == 0, "the page took its server for lost"


def check(holder, server):
    a_page_that_stood_still_keeps_its_connection(holder)
    watcher = a_hidden_page_keeps_control_and_a_second_one_watches(holder, server.url)
    a_closed_page_brings_the_arm_to_rest(holder, watcher)
    watcher = a_page_put_to_sleep_brings_the_arm_to_rest(watcher, server.url)
    a_page_cut_off_keeps_its_emergency_stop(watcher, server)
