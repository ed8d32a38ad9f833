"""The page as its user finds it: the next step in view in every state, and ten tasks in two clicks at most."""

import pathlib
import tempfile
import time

from live import LONG_JOB, PAUSE, Page, Server
from pens import slide
from sheets import choose, png

ESCAPE = "\ue00c"
FILLED = ('<svg xmlns="http://www.w3.org/2000/svg" width="20mm" height="10mm" viewBox="0 0 20 10">'
          '<path d="M0 0h20v10h-20z" fill="black"/></svg>')
WINDOWS = ((1440, 900, False), (390, 844, True))


def next_step_is_in_view(page, words):
    """And so are its advice, the emergency stop and the tabs, at the page's top in both windows."""
    browser = page.browser
    browser.wait(words, lambda: browser.text("#next") == words)
    for width, height, mobile in WINDOWS:
        browser.resize(width, height, mobile)
        browser.script("scrollTo(0, 0);")
        hidden = browser.script("""
            return ['next', 'advice', 'emergency', 'tabs', 'state'].filter((id) => {
                const box = document.getElementById(id).getBoundingClientRect();
                const [x, y] = [(box.left + box.right) / 2, (box.top + box.bottom) / 2];
                const isIn = box.height > 0 && box.left >= 0 && box.right <= innerWidth && box.top >= 0 && box.bottom <= innerHeight;
                return !isIn || !document.elementFromPoint(x, y).closest(`#${id}`);
            });""")
        assert not hidden, f"{words}, {width} px: {hidden}"
        cut = browser.script("""
            const { scrollHeight, clientHeight } = document.getElementById('advice');
            return scrollHeight > clientHeight + 1 ? document.getElementById('advice').textContent : '';""")
        assert not cut, f"{words}, {width} px: the advice is cut: {cut}"
    browser.resize(1440, 900)


def press_next(page, words):
    next_step_is_in_view(page, words)
    time.sleep(PAUSE)
    page.ask("#next")


def every_state_has_its_next_step_in_view(page):
    press_next(page, "Home")
    next_step_is_in_view(page, "Stop")
    press_next(page, "Motors on")
    press_next(page, "Load demonstration")
    press_next(page, "Run job")
    page.wait_for("Running")
    next_step_is_in_view(page, "Stop")
    page.request("stop")
    next_step_is_in_view(page, "Show it")
    page.browser.press(ESCAPE)
    page.wait_for("Fault")
    next_step_is_in_view(page, "Show it")
    page.recover()


def level(page):
    """The level of the tool, as the server sends it to another page."""
    return page.browser.script("""
        const socket = new WebSocket(`ws://${location.host}/live`);
        return await new Promise((done) => {
            socket.onmessage = ({ data }) => {
                const { state } = JSON.parse(data);
                if (!state) return;
                socket.close();
                done(state.tool_level);
            };
        });""")


def ten_tasks_take_two_clicks_at_most(page):
    """From the tab that the page opens with, Job; a drag of a slider and the choice of a file count as one."""
    browser = page.browser
    tool = page.tool

    def clicks(*selectors):
        """Clicks what is in the open tab, and no more than two."""
        assert len(selectors) <= 2
        for selector in selectors:
            shown = browser.script(f"return document.querySelector('{selector}').checkVisibility();")
            assert shown, f"{selector} is in a tab that is not open"
            browser.click(selector)

    def at_start():
        page.wait_for_rest()
        browser.click("#tab-job")
        time.sleep(PAUSE)

    at_start()
    with tempfile.TemporaryDirectory() as folder:  # load
        path = pathlib.Path(folder, "test.gcode")
        path.write_text(LONG_JOB)
        browser.type("#file", str(path))
        browser.wait("the job", lambda: "test.gcode" in browser.text("#job"))
    size = browser.text("#size")
    assert size.startswith("20.0 × 20.0 mm · 1 stroke · 960 mm drawn"), size
    size = browser.wait("its time", lambda: next((text for text in [browser.text("#size")] if text.endswith(" s")), None))
    planned = float(size.split(" · ")[3].removesuffix(" s"))
    assert 19.2 < planned < 25, f"{size}: 960 mm at 50 mm/s, and 48 corners"
    clicks('[data-place="0,0,1.1,0"]')  # place
    browser.wait("the larger drawing", lambda: browser.text("#size").startswith("22.0 × 22.0 mm"))
    time.sleep(PAUSE)
    clicks("#next")  # run
    page.wait_for("Running")
    browser.script("const feed = document.getElementById('feed'); feed.value = 50; feed.dispatchEvent(new Event('change'));")
    browser.wait("the speed", lambda: browser.text("#feed-value") == "50 %")  # change speed
    clicks("#next")  # pause
    page.wait_for("Armed")
    at_start()
    clicks("#next", "#resume")  # resume
    page.wait_for("Running")
    clicks('[data-request="stop"]')  # stop
    at_start()
    before = tool()
    clicks("#tab-move", '[data-jog="0,10"]')  # jog 10 mm
    browser.wait("the jog", lambda: page.at_rest() and abs(tool()[1] - before[1] - 10) < 0.05)
    at_start()
    clicks("#tab-move", '[data-pen="down"]')  # pen test
    browser.wait("the pen down", lambda: level(page) > 0)
    time.sleep(PAUSE)
    clicks('[data-pen="up"]')
    browser.wait("the pen up", lambda: level(page) == 0)
    at_start()
    clicks("#tab-plots")  # the error, by its time
    assert browser.script("return document.querySelector('#error canvas').checkVisibility();")


AT_THE_FIRST_LOOK = ("next", "emergency", "size", "run", "resume", "file", "fit", "frame")


def more_tasks_take_two_clicks_at_most(page, window):
    """In a window: the arm is homed, a drawing is fitted, gone around with the pen up, hatched, a picture traced, the pen's height
    tried; and three clicks, in three places, lead from an emergency stop back to the job."""
    browser = page.browser
    clicked = []

    def click(selector):
        shown = browser.script(f"return document.querySelector('{selector}').checkVisibility();")
        assert shown, f"{selector} is in a tab that is not open"
        time.sleep(PAUSE)
        browser.click(selector)
        clicked.append(selector)

    def task(done, *selectors, clicks=2):
        """Clicks these, until what `done` looks for is seen."""
        before = len(clicked)
        for selector in selectors:
            click(selector)
        browser.wait(f"{selectors} in {window}", done)
        assert len(clicked) - before <= clicks

    browser.resize(*window)
    size = lambda: browser.text("#size")
    task(lambda: page.state() == "Stopped" and len(page.angles()) == 2, "#next")  # home
    task(lambda: page.state() == "Armed", "#next")  # motors on
    with tempfile.TemporaryDirectory() as folder:
        for name, content in (("square.svg", FILLED.encode()), ("square.png", png(40))):
            pathlib.Path(folder, name).write_bytes(content)
        browser.click("#tab-job")
        browser.type("#file", str(pathlib.Path(folder, "square.png")))
        browser.wait("the picture", lambda: "square.png" in browser.text("#job") and "1 stroke" in size())
        choose(browser, "read-trace", "2")  # the slider of the picture
        browser.wait("its tones", lambda: " strokes ·" in size())
        choose(browser, "read-trace", "0")
        browser.wait("its outline", lambda: "1 stroke ·" in size())
        browser.type("#file", str(pathlib.Path(folder, "square.svg")))
        browser.wait("the drawing", lambda: size().startswith("20.0 × 10.0 mm · 1 stroke"))
    choose(browser, "read-hatch", "1")
    browser.wait("the hatch", lambda: " strokes ·" in size())
    choose(browser, "read-hatch", "")
    browser.wait("no hatch", lambda: size().startswith("20.0 × 10.0 mm · 1 stroke"))
    choose(browser, "read-speed", "5")  # a minute for the stop
    task(lambda: not size().startswith("20.0 ×") and size() != "", "#fit")
    hidden = browser.script(f"""
        return {list(AT_THE_FIRST_LOOK)}.filter((id) => {{
            const element = document.getElementById(id), box = (element.labels?.[0] ?? element).getBoundingClientRect();
            return box.height === 0 || box.top < 0 || box.bottom > innerHeight;
        }});""")
    assert window[2] or not hidden, f"{window}: to be scrolled to: {hidden}"
    time.sleep(PAUSE)
    task(lambda: page.state() == "Running", "#frame")  # around the drawing
    assert level(page) == 0, "the pen is up"
    page.wait_for_rest()
    task(lambda: page.state() == "Running" and level(page) > 0, "#next")  # begin
    browser.press(ESCAPE)
    page.wait_for("Fault")
    browser.wait("the way out", lambda: browser.text("#next") == "Show it")
    # Their tabs open by themselves.
    click('[data-request="clear_fault"]')
    page.wait_for("Stopped")
    browser.wait("motors", lambda: browser.text("#next") == "Motors on")
    click("#next")
    page.wait_for("Armed")
    browser.wait("resume", lambda: browser.text("#next") == "Show it")
    click("#resume")
    page.wait_for("Running")
    page.request("stop")
    page.wait_for("Armed")
    page.request("disarm")
    page.wait_for("Stopped")
    click("#tab-move")
    slide(browser, "up", 1.2)
    browser.wait("the height", lambda: browser.text("#pen-up-value") == "1.20 ms")


def a_dropped_file_is_loaded(page):
    """And the map goes, which is there again without a job only."""
    drop = """
        const files = new DataTransfer();
        files.items.add(new File(['G21 G90 F3000\\nM3\\nG1 X7 Y0\\nG1 X7 Y5\\n'], 'dropped.gcode'));
        const event = new DragEvent('drop', { dataTransfer: files, bubbles: true, cancelable: true });
        document.getElementById('arm').dispatchEvent(event);
        return event.defaultPrevented;"""
    browser = page.browser
    assert browser.script(drop), "else the browser leaves the page"
    browser.wait("the file", lambda: "dropped.gcode" in browser.text("#job"))
    assert browser.text("#size").startswith("7.0 × 5.0 mm"), browser.text("#size")


def check(program, browser):
    with Server(program, options=["--robot", "benchtop_pen"]) as server:
        page = Page(browser, server.url)
        assert browser.script("return document.getElementById('map').checked;"), "no job is loaded"
        every_state_has_its_next_step_in_view(page)
        assert not browser.script("return document.getElementById('map').checked;"), "a job is loaded"
        ten_tasks_take_two_clicks_at_most(page)
        a_dropped_file_is_loaded(page)
    for window in ((1280, 800, False), (390, 844, True)):
        with Server(program, options=["--robot", "benchtop_pen"]) as server:
            more_tasks_take_two_clicks_at_most(Page(browser, server.url), window)
    browser.resize(1280, 900)
