"""Everyone can use the page: by keyboard, by touch, with a screen reader."""

import os
import pathlib

BUILT = pathlib.Path(os.environ.get("CARGO_TARGET_DIR") or pathlib.Path(__file__).parents[2] / "target")
AXE = BUILT / "axe/node_modules/axe-core/axe.min.js"
TAB, HOME, END, LEFT, RIGHT = "\ue004", "\ue011", "\ue010", "\ue012", "\ue014"
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


TABS = ("Job", "Move", "Arm", "Plots")


def every_control_is_reached_by_tab(browser):
    """In each of the four tabs, which have one stop of the Tab key between them."""
    wanted = 0
    for name in TABS:
        browser.click(f"#tab-{name.lower()}")
        wanted += every_control_of_the_open_tab_is_reached(browser)
    assert wanted > 70, wanted


def every_control_of_the_open_tab_is_reached(browser):
    wanted = browser.script("""
        const all = [...document.querySelectorAll('button, select, input, canvas[tabindex]')]
            .filter((control) => control.getClientRects().length > 0 && control.ariaSelected !== 'false');
        window.seen = new Set();
        document.addEventListener('focusin', ({ target }) => window.seen.add(target));
        window.wanted = all;
        document.getElementById('emergency').focus();
        return all.length;""")
    for _ in range(wanted + 10):
        browser.press(TAB)
    missed = browser.script("""
        return window.wanted.filter((control) => !window.seen.has(control)).map((control) => control.outerHTML);""")
    assert wanted > 5 and not missed, f"{len(missed)} of {wanted} are not reached: {missed}"
    return wanted


def arrows_go_from_tab_to_tab(browser):
    """As the pattern of tabs has it: one tab is chosen and has the focus, and its panel alone is shown."""
    browser.focus("[role=tab]")
    browser.press(HOME)
    seen = []
    for key in (RIGHT, RIGHT, RIGHT, RIGHT, LEFT, HOME, END):
        browser.press(key)
        name, selected, labelled, shown = browser.script("""
            const tab = document.activeElement;
            const shown = [...document.querySelectorAll('[role=tabpanel]')].filter((panel) => panel.checkVisibility());
            return [tab.textContent, document.querySelectorAll('[role=tab][aria-selected=true]').length,
                    shown[0].getAttribute('aria-labelledby') === tab.id && tab.getAttribute('aria-selected'), shown.length];""")
        assert (selected, labelled, shown) == (1, "true", 1), (name, selected, labelled, shown)
        seen.append(name)
    assert seen == ["Move", "Arm", "Plots", "Job", "Plots", "Job", "Plots"], seen


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
    browser.touch("touchStart", after)
    for step in range(1, 11):
        browser.touch("touchMove", [after[0], after[1] - 15 * step])
    browser.touch("touchEnd")
    browser.wait("the scrolled page", lambda: browser.script("return scrollY;") > before + 50, timeout=5)
    browser.script("scrollTo(0, 0);")


def is_accessible(page, widths=((1280, False),)):
    """At each width, in the light and in the dark."""
    browser = page.browser
    for width, mobile in widths:
        browser.resize(width, 844, mobile=mobile)
        for name in TABS:
            browser.click(f"#tab-{name.lower()}")
            every_control_is_large_enough_for_a_thumb(browser)
            for dark in (False, True):
                browser.dark(dark)
                has_no_serious_violation(browser, f"{name}, {width} px, dark: {dark}")
    browser.dark(False)


def check(page):
    browser = page.browser
    every_control_is_reached_by_tab(browser)
    arrows_go_from_tab_to_tab(browser)
    is_accessible(page, ((1280, False), (390, True)))
    a_finger_scrolls_the_page_from_the_drawing(browser)
    browser.resize(1280, 900)
