"""The part of the WebDriver protocol that these tests need, for Debian's Chromium."""

import base64
import json
import shutil
import subprocess
import time
import urllib.error
import urllib.request

import child

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"


# Switches that the driver sets by default; without them hidden tabs are as slow as for users.
COMFORTS = ["disable-background-timer-throttling", "disable-backgrounding-occluded-windows",
            "disable-renderer-backgrounding"]


class Browser:
    """A headless browser, for a `with` statement."""

    def __init__(self):
        self.clicked = ("", 0, (0, 0))  # the selector, the time [s] and the place [px] of the last click
        driver = shutil.which("chromedriver") or "chromedriver"
        self.driver = child.start([driver, "--port=0"], "TERM", stdout=subprocess.PIPE, text=True)
        for line in self.driver.stdout:
            if "started successfully on port" in line:
                self.url = "http://127.0.0.1:" + line.rstrip(".\n").split()[-1]
                break
        else:
            raise RuntimeError("chromedriver does not start")
        arguments = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                     "--force-device-scale-factor=1"]
        options = {"args": arguments, "binary": shutil.which("chromium"),
                   "excludeSwitches": COMFORTS}
        wanted = {"capabilities": {"alwaysMatch": {"goog:chromeOptions": options}}}
        session = self.call("POST", "/session", wanted)
        self.url += "/session/" + session["sessionId"]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.call("DELETE", "")
        finally:
            self.driver.terminate()
            self.driver.wait()

    def call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.url + path, data, method=method)
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"]) from None

    def chromium(self, command, **parameters):
        """A command of Chromium's own protocol."""
        self.call("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def resize(self, width, height, mobile=False):
        self.chromium("Emulation.setDeviceMetricsOverride", width=width, height=height,
                      deviceScaleFactor=1, mobile=mobile)

    def dark(self, on):
        scheme = {"name": "prefers-color-scheme", "value": "dark" if on else "light"}
        self.chromium("Emulation.setEmulatedMedia", features=[scheme])

    def tab(self):
        """The tab that is driven now."""
        return self.call("GET", "/window")

    def new_tab(self):
        """Opens a tab and drives it; the one before is hidden."""
        self.switch(self.call("POST", "/window/new", {"type": "tab"})["handle"])

    def switch(self, tab):
        self.call("POST", "/window", {"handle": tab})

    def close_tab(self):
        self.call("DELETE", "/window")

    def open(self, url):
        self.call("POST", "/url", {"url": url})

    def script(self, text):
        """The value of a script's `return`; it may wait with `await`."""
        body = f"return (async () => {{ {text} }})();"
        return self.call("POST", "/execute/sync", {"script": body, "args": []})

    def find(self, selector):
        found = self.call("POST", "/element", {"using": "css selector", "value": selector})
        return found[ELEMENT]

    def text(self, selector):
        self.reveal(selector)
        return self.call("GET", f"/element/{self.find(selector)}/text")

    def reveal(self, selector):
        """Clicks the tab whose panel has this element, if the panel is hidden."""
        tab = self.script(f"""
            const panel = document.querySelector('{selector}')?.closest('[role=tabpanel][hidden]');
            return panel?.getAttribute('aria-labelledby') ?? null;""")
        if tab:
            self.click(f"#{tab}")

    def focus(self, selector):
        self.reveal(selector)
        assert self.script(f"""
            const element = document.querySelector('{selector}');
            element.focus();
            return document.activeElement === element;"""), f"{selector} does not take the focus"

    def click(self, selector):
        """Clicks an element in the middle of the window: the driver counts as in view what the header covers."""
        x, y = self.middle(selector)
        # The page does not act on a click where another control was clicked less than a second ago;
        # what is scrolled to the middle comes to one place. Double clicks are tested by `click_at`.
        before, then, place = self.clicked
        if selector != before and abs(x - place[0]) < 60 and abs(y - place[1]) < 60:
            time.sleep(max(0, then + 1.1 - time.monotonic()))
        self.clicked = (selector, time.monotonic(), (x, y))
        self.call("POST", f"/element/{self.find(selector)}/click", {})

    def press(self, *keys):
        """Presses keys together, wherever the focus is."""
        actions = [{"type": "keyDown", "value": key} for key in keys]
        actions += [{"type": "keyUp", "value": key} for key in reversed(keys)]
        self.call("POST", "/actions", {"actions": [
            {"type": "key", "id": "keyboard", "actions": actions}]})

    def key(self, kind, key, code, number, **more):
        """One event of a key as the system sends it: `keyDown` or `keyUp`."""
        self.chromium("Input.dispatchKeyEvent", type=kind, key=key, code=code,
                      windowsVirtualKeyCode=number, **more)

    def middle(self, selector):
        """The middle of an element in the window, scrolled into view [px]."""
        self.reveal(selector)
        return self.script(f"""
            const control = document.querySelector('{selector}');
            control.scrollIntoView({{ block: 'center' }});
            const {{ left, right, top, bottom }} = control.getBoundingClientRect();
            return [Math.round((left + right) / 2), Math.round((top + bottom) / 2)];""")

    def mouse(self, kind, place, **more):
        """One event of the mouse: `mousePressed`, `mouseMoved` or `mouseReleased`."""
        self.chromium("Input.dispatchMouseEvent", type=kind, x=place[0], y=place[1], **more)

    def touch(self, kind, place=None):
        """One event of a finger: `touchStart`, `touchMove` or `touchEnd`."""
        points = [] if place is None else [{"x": place[0], "y": place[1]}]
        self.chromium("Input.dispatchTouchEvent", type=kind, touchPoints=points)

    def click_at(self, place, times=1, every=0.15):
        """Clicks in one place of the window, some times in a row [s between them]."""
        for count in range(1, times + 1):
            for kind in ("mousePressed", "mouseReleased"):
                self.mouse(kind, place, button="left", clickCount=count)
            time.sleep(every)

    def type(self, selector, text):
        self.call("POST", f"/element/{self.find(selector)}/value", {"text": text})

    def drag(self, selector, start, end, steps=12):
        """Drags from one place of an element to another [px from its corner]."""
        box = self.script(f"const b = document.querySelector('{selector}').getBoundingClientRect();"
                          "return [b.left, b.top];")
        def move(part):
            x, y = (s + part * (e - s) + b for s, e, b in zip(start, end, box))
            return {"type": "pointerMove", "duration": 40, "x": round(x), "y": round(y)}
        pointer = [move(0), {"type": "pointerDown", "button": 0}]
        pointer += [move((i + 1) / steps) for i in range(steps)]
        pointer.append({"type": "pointerUp", "button": 0})
        self.call("POST", "/actions", {"actions": [
            {"type": "pointer", "id": "hand", "parameters": {"pointerType": "mouse"},
             "actions": pointer}]})

    def screenshot(self, path):
        path.write_bytes(base64.b64decode(self.call("GET", "/screenshot")))

    def wait(self, what, condition, timeout=30):
        """Waits until a condition holds and returns its value."""
        deadline = time.monotonic() + timeout
        while time.monotonic() < deadline:
            value = condition()
            if value:
                return value
            time.sleep(0.05)
        seen = self.script("return document.body.innerText;")
        raise AssertionError(f"waited {timeout} s in vain for {what}; the page says:\n{seen}")
