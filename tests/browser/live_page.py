#!/usr/bin/env python3
"""Tests the live page with the simulated arm, and a report, in a headless Chromium; what needs none of Chromium's own
commands also in Firefox.

    tests/browser/live_page.py PROGRAM [--screenshots FOLDER]

PROGRAM is `fivebar`. With --screenshots, it writes pictures of the page, of a run's report and
of a workspace map to FOLDER.
"""

import argparse
import pathlib
import time

import access
import commissioning
import consoles
import holding
import kinds
import layout
import looks
import moving
import owning
import pens
import reach
import runs
import senders
import sheets
import stopping
import watching
from firefox import Firefox
from live import Page, Server
from webdriver import Browser


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--screenshots", type=pathlib.Path)
    arguments = parser.parse_args()
    started = time.monotonic()

    def passed(what):
        print(f"live page: {what} ({time.monotonic() - started:.0f} s)", flush=True)

    with Server(arguments.program) as server, Browser() as browser:
        access.check(arguments.program, server, browser)
        passed("origins and token")
        page = Page(browser, server.url)
        browser.resize(1280, 900)
        moving.check(page)
        passed("keys, drags, refusals, branches, jobs, emergency stop")
        holding.check(page, server)
        passed("motion while a button, a finger or a key is held")
        consoles.check(page)
        passed("console")
        runs.check(page)
        passed("layers, strokes by error and speed, replay")
        sheets.check(page)
        passed("pictures, copies, the next sheet")
        stopping.check(page, server)
        passed("stops from every control, double clicks, held keys, while the page loads")
        looks.check(page)
        passed("phone, light and dark")
        reach.check(page)
        passed("keyboard, touch, axe-core")
        page = owning.check(page, server.url)
        passed("reload, closed tab, resumed jobs")
        if arguments.screenshots:
            looks.take(arguments.program, server.url, browser, arguments.screenshots)
            passed(f"pictures in {arguments.screenshots}")
            page = Page(browser, server.url)
        watching.check(page, server)
        passed("watchers, hidden, closed, sleeping and cut-off pages")
        looks.a_report_fits_a_phone(arguments.program, browser)
        passed("a report on a phone")
        looks.the_reports_of_studies_are_accessible(arguments.program, browser)
        passed("reports of studies: axe-core")
        layout.check(arguments.program, browser)
        passed("the next step in view in every state, ten tasks in two clicks each, a dropped file")
        kinds.check(arguments.program, browser)
        passed("steppers, drives on a bus, hobby servos: their values, their tip error, replay")
        pens.check(arguments.program, browser)
        passed("the pen's heights, macros, a job from a clicked place")
        senders.check(arguments.program, browser)
        passed("a page of another site at the senders' ports")
        commissioning.check(arguments.program, browser)
        passed("a guided commissioning: tasks, a mistake, stops, a run that goes on")
    with Server(arguments.program) as server, Firefox() as browser:
        page = Page(browser, server.url)
        browser.resize(1280, 900)
        for part in (moving.check, consoles.check, runs.check):
            part(page)
        holding.check(page, server)
        watching.a_page_that_stood_still_keeps_its_connection(page)
        reach.is_accessible(page)
        passed("Firefox: keys, drags, jobs, held motion, console, replay, a busy page, axe-core")


if __name__ == "__main__":
    main()
