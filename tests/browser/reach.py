"""Everyone can use the page: by keyboard, by touch, with a screen reader."""

import os
import pathlib

BUILT = pathlib.Path(os.environ.get("CARGO_TARGET_DIR") or pathlib.Path(__file__).parents[2] / "target")
AXE = BUILT / "axe/node_modules/axe-core/axe.min.js"
TAB = "\ue004"
SERIOUS = ("serious", "critical")


def has_no_serious_violation(browser, what):
    browser.script(AXE.read_text())
    found = browser.script("""
        const { violations, passes } = await axe.run(document, { resultTypes: ['violations'] });
        return [passes.length, violations.map(({ id, impact, nodes }) =>
            [id, impact, nodes.map(({ target, failureSummary }) => `${target}: ${failureSummary}`)])];""")
    passes, violations = found
    assert passes > 10, f"axe-core checked {passes} rules only"
    serious = [violation for violation in violations if violation[1] in SERIOUS]
    assert not serious, f"{what}: {serious}"


def every_control_is_reached_by_tab(browser):
    wanted = browser.script("""
        const all = [...document.querySelectorAll('button, select, input, canvas[tabindex]')]
            .filter((control) => control.getClientRects().length > 0);
        window.seen = new Set();
        document.addEventListener('focusin', ({ target }) => window.seen.add(target));
        window.wanted = all;
        document.getElementById('emergency').focus();
        return all.length;""")
    for _ in range(wanted + 10):
        browser.press(TAB)
    missed = browser.script("""
        return window.wanted.filter((control) => !window.seen.has(control)).map((control) => control.outerHTML);""")
    assert wanted > 35 and not missed, f"{len(missed)} of {wanted} are not reached: {missed}"


def every_control_is_large_enough_for_a_thumb(browser):
    small = browser.script("""
        const area = (control) => (control.closest('label') ?? control).getBoundingClientRect();
        return [...document.querySelectorAll('button, select, input')]
            .map((control) => [control.id || control.outerHTML, area(control)])
            .filter(([, { width, height }]) => width > 0 && (width < 44 || height < 44))
            .map(([name, { width, height }]) => `${name}: ${width} x ${height}`);""")
    assert not small, small


def a_finger_scrolls_the_page_from_the_drawing(browser):
    before, after = browser.script("""
        const { left, top, width, height } = document.getElementById('arm').getBoundingClientRect();
        return [scrollY, [left + 12, top + height / 2]];""")
    touch = lambda kind, y: browser.chromium(
        "Input.dispatchTouchEvent", type=kind,
        touchPoints=[] if kind == "touchEnd" else [{"x": after[0], "y": y}])
    touch("touchStart", after[1])
    for step in range(1, 11):
        touch("touchMove", after[1] - 15 * step)
    touch("touchEnd", after[1])
    browser.wait("the scrolled page", lambda: browser.script("return scrollY;") > before + 50, timeout=5)
    browser.script("scrollTo(0, 0);")


def check(page):
    browser = page.browser
    every_control_is_reached_by_tab(browser)
    for width, mobile in ((1280, False), (390, True)):
        browser.resize(width, 844, mobile=mobile)
        every_control_is_large_enough_for_a_thumb(browser)
        for dark in (False, True):
            browser.dark(dark)
            has_no_serious_violation(browser, f"{width} px, dark: {dark}")
    a_finger_scrolls_the_page_from_the_drawing(browser)
    browser.dark(False)
    browser.resize(1280, 900)
