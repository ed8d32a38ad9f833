"""The host owns the job: it survives a reload and a closed tab, and keeps its place."""

import time

from live import LONG_JOB, PAUSE, Page
from watching import watch

ESCAPE = "\ue00c"


def start_to_run_on(page):
    page.load_job(LONG_JOB, "within the arm's limits")
    page.browser.click("#run-on")
    page.browser.wait("the choice", lambda: page.browser.script(
        "return document.getElementById('run-on').checked;"))
    page.run_job()
    time.sleep(2)  # the tool is down by then


def line(page):
    return page.numbers("#line")


def a_job_told_to_run_on_survives_a_reload(page, url):
    start_to_run_on(page)
    before = page.browser.wait("a line", lambda: line(page))
    page.browser.open(url)
    page.wait_for("Running")
    page.browser.wait("control", lambda: "watches" not in page.browser.text("#state"))
    time.sleep(1.5)
    assert page.state() == "Running", page.browser.text("#state")
    assert line(page) >= before, (before, line(page))
    assert "left" in page.browser.text("#left")


def a_job_told_to_run_on_survives_a_closed_tab_and_any_page_stops_it_at_once(page, url):
    browser = page.browser
    watcher = watch(browser, url)
    assert "this page watches" in browser.text("#state")
    page.show()
    browser.close_tab()
    watcher.show()
    time.sleep(1.5)
    assert watcher.state() == "Running" and "the job runs on" in browser.text("#state")
    # A page that does not have control.
    browser.press(ESCAPE)
    watcher.wait_for("Fault", timeout=5)
    browser.wait("the fault", lambda: "emergency stop (10)" in browser.text("#fault"))
    assert "waits at line" in browser.text("#advice"), browser.text("#advice")
    return watcher


def the_bar_leads_on_to_the_end_of_the_stop(page):
    """The bar has a button for the next step, or names one that is marked in its own place."""
    browser = page.browser
    for words, marked, state in (("Take control", None, "Fault"), ("Show it", "Clear fault", "Stopped"),
                                 ("Motors on", None, "Armed"), ("Show it", "Resume", "Running")):
        browser.wait(words, lambda: browser.text("#next") == words)
        time.sleep(PAUSE)
        browser.script("scrollTo(0, 0);")
        if marked:
            browser.click("#next")
            # "Show it" has opened its tab and shows it.
            shown = browser.script("""
                const control = document.querySelector('.marked'), box = control.getBoundingClientRect();
                return [control.textContent, box.height >= 44 && box.top >= 0 && box.bottom < innerHeight + 1,
                        document.activeElement === control, box.top, box.bottom, innerHeight];""")
            assert shown[:3] == [marked, True, True], shown
        browser.click(".marked" if marked else "#next")
        page.wait_for(state)
    assert line(page)[0] > 3, "it does not begin anew"
    # A stop needs no pause.
    browser.wait("the stop", lambda: browser.text("#next") == "Stop")
    browser.script("scrollTo(0, 0);")
    browser.click("#next")
    page.wait_for("Armed")
    browser.wait("its place", lambda: "stopped at line" in browser.text("#left"))


def check(page, url):
    """Returns the page that is left."""
    a_job_told_to_run_on_survives_a_reload(page, url)
    watcher = a_job_told_to_run_on_survives_a_closed_tab_and_any_page_stops_it_at_once(page, url)
    the_bar_leads_on_to_the_end_of_the_stop(watcher)
    return watcher
