"""Debian's Firefox, headless, by its own protocol Marionette: the same as `Browser` for the tests that run in both."""

import base64
import json
import pathlib
import re
import shutil
import socket
import subprocess
import tempfile
import time

import child
from webdriver import Browser

# WebDriver's commands by their methods and paths, as Marionette names them.
COMMANDS = {
    ("POST", "/url"): "Navigate",
    ("POST", "/execute/sync"): "ExecuteScript",
    ("POST", "/element"): "FindElement",
    ("POST", "/actions"): "PerformActions",
    ("GET", "/window"): "GetWindowHandle",
    ("POST", "/window"): "SwitchToWindow",
    ("POST", "/window/new"): "NewWindow",
    ("DELETE", "/window"): "CloseWindow",
    ("GET", "/screenshot"): "TakeScreenshot",
}
OF_ELEMENTS = {"text": "GetElementText", "click": "ElementClick", "value": "ElementSendKeys"}
PREFERENCES = {
    "ui.prefersReducedMotion": 0,
    "layout.css.prefers-color-scheme.content-override": 1,
    "browser.shell.checkDefaultBrowser": False,
    "datareporting.policy.dataSubmissionEnabled": False,
    "focusmanager.testmode": True,  # the window counts as focused, as a user's does
    "dom.w3c_touch_events.enabled": 1,
}
# One event of a key with the names that the caller gives it; WebDriver's keys have names and places of their own. One
# processor for all, because it knows which modifiers are down.
KEY = """
    const [kind, key, code, keyCode] = arguments;
    const window = Services.wm.getMostRecentWindow("navigator:browser");
    const keys = window.keysOfTheTests ??= Cc["@mozilla.org/text-input-processor;1"].createInstance(Ci.nsITextInputProcessor);
    keys.beginInputTransactionForTests(window);
    const event = new window.KeyboardEvent("", { key, code, keyCode });
    keys[kind.toLowerCase()](event, key.length > 1 ? keys.KEY_NON_PRINTABLE_KEY : keys.KEY_FORCE_PRINTABLE_KEY);
"""


class Firefox(Browser):
    def __init__(self):
        self.clicked = ("", 0, (0, 0))
        self.profile = tempfile.TemporaryDirectory()
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        rows = [f"user_pref({json.dumps(name)}, {json.dumps(value)});\n"
                for name, value in {**PREFERENCES, "marionette.port": port}.items()]
        pathlib.Path(self.profile.name, "user.js").write_text("".join(rows))
        program = shutil.which("firefox-esr") or "firefox-esr"
        self.driver = child.start(
            [program, "--headless", "--marionette", "--no-remote", "-remote-allow-system-access", "--profile", self.profile.name],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 60
        while True:
            try:
                self.socket = socket.create_connection(("127.0.0.1", port), timeout=60)
                break
            except OSError:
                if time.monotonic() > deadline:
                    raise
                time.sleep(0.1)
        self.received = b""
        self.number = 0
        self.read()  # the greeting
        self.command("WebDriver:NewSession", {})

    def __exit__(self, *_):
        try:
            self.command("Marionette:Quit", {"flags": ["eForceQuit"]})
        finally:
            self.socket.close()
            self.driver.wait(timeout=30)
            self.profile.cleanup()

    def read(self):
        """A message: its length, a colon, JSON."""
        while not (head := re.match(rb"(\d+):", self.received)) or len(self.received) < head.end() + int(head[1]):
            more = self.socket.recv(1 << 16)
            if not more:
                raise RuntimeError("Firefox has closed the connection")
            self.received += more
        end = head.end() + int(head[1])
        message, self.received = self.received[head.end():end], self.received[end:]
        return json.loads(message)

    def command(self, name, parameters):
        self.number += 1
        text = json.dumps([0, self.number, name, parameters]).encode()
        self.socket.sendall(str(len(text)).encode() + b":" + text)
        _, _, error, result = self.read()
        if error:
            raise RuntimeError(error["message"])
        if isinstance(result, dict) and set(result) == {"value"}:
            return result["value"]
        return result

    def call(self, method, path, body=None):
        body = dict(body or {})
        if element := re.fullmatch(r"/element/([^/]+)/(\w+)", path):
            return self.command(f"WebDriver:{OF_ELEMENTS[element[2]]}", {"id": element[1], **body})
        return self.command(f"WebDriver:{COMMANDS[method, path]}", body)

    def chromium(self, command, **_):
        raise NotImplementedError(f"{command} is Chromium's own")

    def resize(self, width, height, mobile=False):
        """The page's size; a window is never as narrow as a phone."""
        across, up = self.script("return [outerWidth - innerWidth, outerHeight - innerHeight];")
        self.command("WebDriver:SetWindowRect", {"width": width + across, "height": height + up})

    def in_the_browser(self, script, *arguments):
        """Runs a script with the rights of the browser itself, outside the page."""
        self.command("Marionette:SetContext", {"value": "chrome"})
        try:
            self.command("WebDriver:ExecuteScript", {"args": arguments, "script": script})
        finally:
            self.command("Marionette:SetContext", {"value": "content"})

    def dark(self, on):
        self.in_the_browser(
            "Services.prefs.setIntPref('layout.css.prefers-color-scheme.content-override', arguments[0]);", 0 if on else 1)
        self.wait("the colours", lambda: self.script(
            "return matchMedia('(prefers-color-scheme: dark)').matches;") == on)

    def pointer(self, kind, actions):
        self.call("POST", "/actions", {"actions": [
            {"type": "pointer", "id": kind, "parameters": {"pointerType": kind}, "actions": actions}]})

    def mouse(self, kind, place, **_):
        move = {"type": "pointerMove", "duration": 0, "x": round(place[0]), "y": round(place[1])}
        then = {"mousePressed": [{"type": "pointerDown", "button": 0}], "mouseMoved": [],
                "mouseReleased": [{"type": "pointerUp", "button": 0}]}
        self.pointer("mouse", [move, *then[kind]])

    def touch(self, kind, place=None):
        move = [] if place is None else [{"type": "pointerMove", "duration": 0, "x": round(place[0]), "y": round(place[1])}]
        then = {"touchStart": [{"type": "pointerDown", "button": 0}], "touchMove": [],
                "touchEnd": [{"type": "pointerUp", "button": 0}]}
        self.pointer("touch", [*move, *then[kind]])

    def key(self, kind, key, code, number, **_):
        self.in_the_browser(KEY, kind, key, code, number)

    def screenshot(self, path):
        path.write_bytes(base64.b64decode(self.command("WebDriver:TakeScreenshot", {"full": False})))
