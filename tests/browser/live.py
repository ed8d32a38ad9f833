"""`fivebar serve` and its page, for tests."""

import contextlib
import http.client
import pathlib
import signal
import socket
import subprocess
import tempfile
import threading
import time

import child

UPGRADE = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13",
           "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ=="}
SIDES = "G1 X20 Y0\nG1 X20 Y20\nG1 X0 Y20\nG1 X0 Y0\n"
SHORT_JOB = "G21 G90 F3000\nM3\n" + SIDES
LONG_JOB = "G21 G90 F3000\nM3\n" + 12 * SIDES  # half a minute
TOO_LARGE = "G21 G90 F3000\nG1 X20 Y0\nG1 X500 Y0\n"


# For so long after a fault is cleared, and after the button of the next step has changed, it does
# nothing [s].
PAUSE = 1.1


class Server:
    """`fivebar serve` at a free port, for a `with` statement."""

    def __init__(self, program, listen="127.0.0.1:0", options=()):
        self.log = tempfile.NamedTemporaryFile("r")
        with open(self.log.name, "w") as output:
            self.process = child.start([program, "serve", "--listen", listen, *options],
                                       stdout=output, stderr=subprocess.STDOUT)
        while not self.said().endswith("\n"):
            assert self.process.poll() is None, self.said()
            time.sleep(0.02)
        self.url = next(word for word in self.said().split() if "?token=" in word)
        self.host = self.url.split("/")[2]
        self.port = int(self.host.split(":")[1])
        self.token = self.url.split("?token=")[1]
        self.cookie = {"Cookie": f"fivebar{self.port}={self.token}"}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGINT)
        try:
            assert self.process.wait(timeout=20) == 0, "Ctrl-C ends it in order"
        finally:
            self.process.kill()

    def said(self):
        """All its output."""
        self.log.seek(0)
        return self.log.read()

    def answer(self, path, **headers):
        """Status and headers of the response to a request."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=10)
        with contextlib.closing(connection):
            connection.request("GET", path, headers={"Host": self.host, **headers})
            answer = connection.getresponse()
            return answer.status, dict(answer.getheaders())

    def status(self, path, **headers):
        return self.answer(path, **headers)[0]


class Wire:
    """Forwards connections to a server. While it is cut they stay open and silent. A request that begins
    with `holds` waits until `released` is set."""

    def __init__(self, server, holds=None):
        self.holds = holds
        self.released = threading.Event()
        self.port = server.port
        self.whole = threading.Event()
        self.whole.set()
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"http://127.0.0.1:{self.listener.getsockname()[1]}/?token={server.token}"
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        with contextlib.suppress(OSError):
            while True:
                near, _ = self.listener.accept()
                far = socket.create_connection(("127.0.0.1", self.port))
                for ends in ((near, far), (far, near)):
                    threading.Thread(target=self.carry, args=ends, daemon=True).start()

    def carry(self, source, sink):
        with contextlib.suppress(OSError):
            while data := source.recv(65536):
                if self.holds and data.startswith(self.holds):
                    self.released.wait()
                self.whole.wait()
                sink.sendall(data)
            sink.shutdown(socket.SHUT_WR)


class Page:
    """The page in the tab that the browser drives now."""

    def __init__(self, browser, url):
        self.browser = browser
        browser.open(url)
        self.tab = browser.tab()
        self.next_click = 0.0
        browser.wait("the connection", lambda: self.state() not in ("", "offline"))

    def show(self):
        """Makes this page the driven one again."""
        self.browser.switch(self.tab)

    def state(self):
        return self.browser.script("return document.body.dataset.state ?? '';")

    def numbers(self, selector):
        """The numbers of a text such as `-12.3, 45.6 mm`; empty if it shows none."""
        words = self.browser.text(selector).replace("−", "-").replace(",", " ").split()
        digits = [word.rstrip("°") for word in words]
        return [float(word) for word in digits if word.lstrip("-")[:1].isdigit()]

    def angles(self):
        return self.numbers("#theta1") + self.numbers("#theta4")

    def tool(self):
        return self.numbers("#tool")

    def pixel(self, what):
        """The position of the tool or an elbow (theta1, theta4) on the canvas."""
        pixel = self.browser.script(f"return document.getElementById('arm').dataset.{what};")
        return [float(part) for part in pixel.split(",")]

    def at_rest(self):
        before = self.tool()
        time.sleep(0.2)
        return self.state() == "Armed" and self.tool() == before

    def wait_for_rest(self):
        self.browser.wait("rest", self.at_rest)

    def ask(self, selector):
        """Clicks, and again if the page shows that its connection was lost just then.

        It comes a pause after the click before: sooner, and in the same place, the page takes it for a double click.
        """
        time.sleep(max(0.0, self.next_click - time.monotonic()))
        self.browser.click(selector)
        self.next_click = time.monotonic() + PAUSE
        while "Not sent" in self.browser.text("#notice"):
            self.browser.wait("the connection", lambda: self.state() != "offline")
            self.browser.click(selector)

    def request(self, name):
        self.ask(f'[data-request="{name}"]')

    def wait_for(self, state, timeout=30):
        self.browser.wait(state, lambda: self.state() == state, timeout)

    def wait_for_notice(self, words):
        self.browser.wait(words, lambda: words in self.browser.text("#notice"))

    def home_and_arm(self):
        self.request("home")
        self.browser.wait("home", lambda: self.state() == "Stopped" and len(self.angles()) == 2)
        self.request("arm")
        self.wait_for("Armed")

    def home_and_arm_if_needed(self):
        if self.state() != "Armed":
            self.home_and_arm()

    def choose_branch(self, elbows):
        self.browser.click(f'[data-mode="{elbows}"]')

    def alarm(self):
        """The sentence that lies over the page."""
        return self.browser.text("#alarm")

    def load_job(self, text, words):
        """Loads a job and waits for these words about it."""
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "test.gcode")
            path.write_text(text)
            self.browser.reveal("#file")
            self.browser.type("#file", str(path))
            self.browser.wait(words, lambda: words in self.browser.text("#job"))

    def run_job(self):
        self.ask("#run")
        self.wait_for("Running")

    def recover(self):
        self.request("clear_fault")
        self.wait_for("Stopped")
        time.sleep(PAUSE)  # from when the page shows it
        self.request("arm")
        self.wait_for("Armed")
