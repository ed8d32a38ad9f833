"""The layout and colours of the page, and pictures of it."""

import pathlib
import subprocess
import tempfile
import time

import reach
from live import Page


def a_phone_has_all_of_it_and_the_emergency_stop_in_view(page):
    browser = page.browser
    for width in (360, 390):
        browser.resize(width, 844, mobile=True)
        # The plots follow the window a frame later, on a busy machine some frames.
        until = time.monotonic() + 2
        wide = None
        while wide != [width, width] and time.monotonic() < until:
            wide = browser.script("return [innerWidth, document.documentElement.scrollWidth];")
        assert wide == [width, width], f"the page is {wide[1]} px wide on {width} px"
    for end in ("0", "document.body.scrollHeight"):
        browser.script(f"scrollTo(0, {end});")
        box = browser.script("""
            const box = document.getElementById('emergency').getBoundingClientRect();
            const hit = document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2);
            return [box.left, box.top, box.right, box.bottom, hit.closest('#emergency') !== null];""")
        left, top, right, bottom, reachable = box
        assert reachable and left >= 0 and top >= 0 and right <= 390 and bottom <= 844, box
        assert bottom - top >= 44, "large enough for a thumb"
    browser.script("scrollTo(0, 0);")


def a_phone_shows_the_arm_and_all_arrows_of_the_tool_at_once(page):
    browser = page.browser
    for width, height in ((360, 800), (390, 844)):
        browser.resize(width, height, mobile=True)
        browser.click("#tab-move")
        browser.script("scrollTo(0, 0);")
        hidden = browser.script("""
            return ['#arm', '#emergency', '#next', ...[...document.querySelectorAll('[data-jog]')].map(
                ({ dataset }) => `[data-jog="${dataset.jog}"]`)].filter((selector) => {
                const box = document.querySelector(selector).getBoundingClientRect();
                const isThumb = selector === '#arm' || (box.width >= 44 && box.height >= 44);
                return !(isThumb && box.left >= 0 && box.right <= innerWidth && box.top >= 0 && box.bottom <= innerHeight);
            });""")
        assert not hidden, f"{width} × {height} px: {hidden}"
    browser.click("#tab-job")
    browser.script("scrollTo(0, 0);")


def dark_is_dark_and_light_is_light(page):
    browser = page.browser

    def brightness(selector, property):
        colour = browser.script(f"return getComputedStyle(document.querySelector('{selector}')).{property};")
        red, green, blue = (int(part) for part in colour.removeprefix("rgb(").rstrip(")").split(","))
        return (0.299 * red + 0.587 * green + 0.114 * blue) / 255

    for dark in (True, False):
        browser.dark(dark)
        paper, ink = brightness("body", "backgroundColor"), brightness("body", "color")
        assert (paper < 0.2) == dark and abs(ink - paper) > 0.6, (dark, paper, ink)


def colours(page):
    """The colours on the canvas: how often each occurs, and the colour at the corner."""
    return page.browser.script("""
        const canvas = document.getElementById('arm');
        const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
        const pixels = new Uint32Array(data.buffer), counts = new Map();
        for (const pixel of pixels) counts.set(pixel, (counts.get(pixel) ?? 0) + 1);
        const many = [...counts].filter(([, count]) => count > 200).map(([pixel]) => pixel);
        return [many.sort(), pixels[0]];""")


def contrast(page, pixel, name):
    """The contrast of a pixel on the canvas with a colour of the style sheet, as WCAG defines it."""
    other = page.browser.script(
        f"return getComputedStyle(document.documentElement).getPropertyValue('{name}').trim();")

    def luminance(channels):
        parts = [part / 255 for part in channels]
        linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance([pixel & 255, pixel >> 8 & 255, pixel >> 16 & 255]),
                        luminance(bytes.fromhex(other[1:]))))
    return (high + 0.05) / (low + 0.05)


def the_map_is_of_the_chosen_branch(page):
    browser = page.browser

    def drawn(what):
        browser.script(what)
        # Two frames later it is on the canvas.
        browser.script("await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));")
        return colours(page)

    choose = "document.querySelector('[data-mode=\"{}\"]').click();"
    toggle = "document.getElementById('map').click();"
    bare, corner = drawn("")
    assert browser.script("return !document.getElementById('map').checked && Boolean(document.getElementById('size').textContent);"), \
        "a job is loaded, and the map is off"
    assert len(bare) < 10, f"{len(bare)} colours without the map"
    drawn(toggle)
    own, corner = drawn(choose.format("right,left"))
    assert len(own) >= 15, f"{len(own)} colours: ten steps, whole and pale"
    assert corner == 0, "nothing beyond the reach"
    other, _ = drawn(choose.format("left,right"))
    assert other != own, "another branch, another map"
    areas = {pixel: contrast(page, pixel, "--stage") for pixel in set(own) - set(bare)
             if contrast(page, pixel, "--drawn") > 1.02}  # the curves of type 2
    assert len(areas) >= 15 and max(areas.values()) < 2.2, f"the map is pale: {areas}"
    browser.dark(True)
    # On a busy machine the colours change some frames later.
    browser.wait("ten steps of its own in the dark, whole and pale",
                 lambda: len(set(drawn(choose.format("right,left"))[0]) - set(own)) >= 15)
    browser.dark(False)
    browser.wait("the colours of before", lambda: drawn("")[0] == own)
    drawn(toggle)


# How many pixels of a chart have a colour of the style sheet.
COLOURED = """
    const coloured = (canvas, name) => {
        const { width, height } = canvas;
        const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
        const wanted = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
        let count = 0;
        for (let i = 0; i < data.length; i += 4) {
            const [r, g, b] = data.subarray(i, i + 3);
            const colour = '#' + [r, g, b].map((part) => part.toString(16).padStart(2, '0')).join('');
            if (colour === wanted && data[i + 3] === 255) count += 1;
        }
        return count;
    };
"""


def the_plots_are_drawn_within_the_policy(page):
    browser = page.browser
    browser.click("#tab-plots")
    browser.wait("curves", lambda: browser.script(COLOURED + """
        const plots = [...document.querySelectorAll('#panel-plots canvas')];
        return plots.length === 4 && plots.every((plot) => plot.width > 0 && coloured(plot, '--one') > 20);"""))
    assert "failed" not in browser.text("#notice"), browser.text("#notice")
    # A style attribute that a script adds is against the policy: the observer must see it alone.
    refused = browser.script("""
        document.body.setAttribute('style', 'top: 0');
        await new Promise((done) => setTimeout(done, 100));
        const observer = new ReportingObserver(() => {}, { types: ['csp-violation'], buffered: true });
        observer.observe();
        const seen = observer.takeRecords().map(({ body }) => body.effectiveDirective);
        document.body.removeAttribute('style');
        return seen;""")
    assert refused == ["style-src-attr"], refused


def check(page):
    the_plots_are_drawn_within_the_policy(page)
    page.browser.click('[data-zoom="arm"]')
    the_map_is_of_the_chosen_branch(page)
    a_phone_has_all_of_it_and_the_emergency_stop_in_view(page)
    a_phone_shows_the_arm_and_all_arrows_of_the_tool_at_once(page)
    dark_is_dark_and_light_is_light(page)
    page.browser.resize(1280, 900)


def a_report_fits_a_phone(program, browser):
    job = pathlib.Path(__file__).parents[2] / "host/files/jobs/petal.gcode"
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([program, "sim", job, "--out", out], check=True, stdout=subprocess.DEVNULL)
        browser.open(f"file://{out}/report.html")
        for width in (360, 390, 1200):
            browser.resize(width, 844, mobile=width < 1200)
            time.sleep(0.3)
            wide, charts, beyond, drawn = browser.script(COLOURED + """
                const charts = [...document.querySelectorAll('.chart')];
                return [document.documentElement.scrollWidth, charts.length,
                        charts.filter((chart) => chart.scrollWidth > chart.clientWidth).length,
                        charts.filter((chart) => coloured(chart.querySelector('canvas'), '--s1') > 20).length];""")
            assert wide <= width and beyond == 0, f"{wide} px wide on {width} px, {beyond} beyond"
            reach.has_no_serious_violation(browser, f"the report at {width} px")
            assert charts > 5 and drawn == charts, (charts, drawn)
        a_drag_zooms_and_a_path_has_the_same_scale_along_both_axes(browser)


def a_drag_zooms_and_a_path_has_the_same_scale_along_both_axes(browser):
    """Of the chart of the path, which is the first, and of one over time, which is the second."""
    def scales():
        return browser.script("""
            return [...document.querySelectorAll('.chart')].slice(0, 2).map(({ plot: { scales, bbox } }) =>
                [scales.x.max - scales.x.min, scales.y.max - scales.y.min, bbox.width, bbox.height]);""")

    before = scales()
    across, up, width, height = before[0]
    assert abs(across / width / (up / height) - 1) < 1e-3, before[0]
    for number, narrower in ((0, 2), (1, 1)):
        over = f"#over{number}"
        browser.script(f"""
            const over = document.querySelectorAll('.chart .u-over')[{number}];
            over.id = "over{number}";
            over.scrollIntoView({{ block: 'center' }});""")
        browser.drag(over, (100, 40), (300, 120))
        zoomed = scales()[number]
        assert all(now < 0.7 * old for now, old in zip(zoomed[:narrower], before[number])), (zoomed, before)
        browser.click_at(browser.middle(over), times=2, every=0.02)
        browser.wait("the whole chart", lambda: scales()[number] == before[number])


def the_reports_of_studies_are_accessible(program, browser):
    """A page of each kind; those of runs are looked at on a phone."""
    square = pathlib.Path(__file__).parents[2] / "host/files/paths/square.json"
    studies = (["accuracy", "benchtop", "--map"], ["clearance", "benchtop", "-", "--radius", "20e-6"],
               ["linkage", "shaper"], ["margins"], ["mobility"], ["plan", "--path", square])
    for study in studies:
        with tempfile.TemporaryDirectory() as out:
            subprocess.run([program, *study, "--out", out], input="G21 G90\nG1 X2 F3000\nG1 X0\n", text=True,
                           check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            browser.open(f"file://{out}/report.html")
            browser.resize(1200, 844)
            for dark in (False, True):
                browser.dark(dark)
                reach.has_no_serious_violation(browser, f"the report of {study[0]}, dark: {dark}")
    browser.dark(False)


def take(program, url, browser, folder):
    """Pictures of the page at work, of a run's report and of a workspace map."""
    folder.mkdir(parents=True, exist_ok=True)
    browser.chromium("Emulation.setScrollbarsHidden", hidden=True)

    def picture(name, width, height, mobile=False):
        browser.resize(width, height, mobile)
        browser.script("scrollTo(0, 0);")
        time.sleep(0.3)
        browser.screenshot(folder / f"{name}.png")

    page = Page(browser, url)
    browser.click("#demonstration")
    browser.wait("the job", lambda: "60 moves" in browser.text("#job"))
    page.run_job()
    time.sleep(6.5)
    picture("live-page", 1440, 900)
    picture("live-page-phone", 390, 844, mobile=True)
    browser.dark(True)
    picture("live-page-phone-dark", 390, 844, mobile=True)
    browser.resize(1440, 900)
    browser.click('[data-colouring="speed"]')
    picture("live-page-dark", 1440, 900)
    browser.dark(False)
    browser.click('[data-colouring="pen"]')
    page.wait_for("Armed")
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([program, "--out", out], check=True, stdout=subprocess.DEVNULL)
        subprocess.run([program, "workspace", "--out", out], check=True, stdout=subprocess.DEVNULL)
        browser.open(f"file://{out}/report.html")
        time.sleep(5)
        picture("report", 1200, 1000)
        browser.open(f"file://{out}/workspace.svg")
        picture("workspace", 1000, 850)
    browser.chromium("Emulation.setScrollbarsHidden", hidden=False)
