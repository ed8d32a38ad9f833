"""A page of another site sends G-code to the senders' ports: nothing may move."""

import contextlib
import http.server
import re
import socket
import subprocess
import threading
import time

import child
from live import Server

# Homed before; each of these lines would move the arm by 5 mm.
LINES = "\r\n$X\r\nG21\r\nG91\r\nG1 X5 F1200\r\nG1 Y5 F1200\r\n~\r\n"
LONG = "a" * 1100
PADDING = 3_000_000
POSTS = """
    const [port, path, lines] = [PORT, PATH, LINES];
    // The browser looks at the answer when all is sent: it stays for as long as it has bytes, which Grbl ignores.
    const body = new Blob([lines, '\u00ff'.repeat(PADDING)], {type: 'text/plain'});
    const send = (options) => fetch(`http://127.0.0.1:${port}/${path}`, options).catch(() => {});
    await Promise.all([
        send({method: 'POST', mode: 'no-cors', body}),
        send({method: 'POST', mode: 'no-cors', body: lines}),
        send({method: 'PUT', body}),
        fetch(`https://127.0.0.1:${port}/${path}`, {method: 'POST', mode: 'no-cors', body: lines}).catch(() => {}),
    ]);
    navigator.sendBeacon(`http://127.0.0.1:${port}/${path}`, lines);
    await new Promise((done) => {
        const socket = new WebSocket(`ws://127.0.0.1:${port}/${path}`, []);
        socket.onopen = socket.onerror = done;
    });
    return true;
"""
FORM = """
    const form = document.createElement('form');
    form.action = `http://127.0.0.1:${PORT}/${PATH}`;
    form.method = 'post';
    form.enctype = 'text/plain';
    const text = document.createElement('textarea');
    text.name = 'a';
    text.hidden = true;
    text.value = LINES + '\u00ff'.repeat(PADDING);
    form.append(text);
    document.body.append(form);
    form.submit();
    return true;
"""


class Sender:
    """A sender of G-code."""

    def __init__(self, port):
        self.stream = socket.create_connection(("127.0.0.1", port), timeout=30)
        self.text = ""
        self.wait(r"Grbl 1\.1.*\n")

    def wait(self, pattern):
        while not (found := re.search(pattern, self.text)):
            received = self.stream.recv(4096).decode()
            assert received, f"closed before {pattern}: {self.text}"
            self.text += received
        self.text = self.text[found.end():]
        return found

    def place(self):
        self.stream.sendall(b"?")
        x, y = self.wait(r"<[^>]*MPos:([-.\d]+),([-.\d]+)[^>]*>").groups()
        return float(x), float(y)

    def close(self):
        self.stream.close()
        time.sleep(0.3)


def connected(port):
    """A sender, as soon as no other connection is in control."""
    deadline = time.monotonic() + 15
    while True:
        try:
            return Sender(port)
        except (AssertionError, OSError):
            assert time.monotonic() < deadline, "no sender connects"
            time.sleep(0.1)


@contextlib.contextmanager
def another_site():
    """A page of a site that has nothing to do with the arm."""
    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(b"<!doctype html><title>another site</title><p>another site</p>")

        def log_message(self, *_):
            pass

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler) as site:
        threading.Thread(target=site.serve_forever, daemon=True).start()
        try:
            yield f"http://localhost:{site.server_port}/"
        finally:
            site.shutdown()


@contextlib.contextmanager
def bridge(program):
    """`fivebar bridge` with TCP; its port."""
    process = child.start([program, "bridge", "--listen", "127.0.0.1:0"],
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        yield int(process.stdout.readline().split()[0].rsplit(":", 1)[1])
    finally:
        process.terminate()
        assert process.wait(timeout=20) == 0, "a signal ends it in order"


@contextlib.contextmanager
def serve(program):
    """`fivebar serve` with senders over TCP; their port."""
    with Server(program, options=["--senders", "127.0.0.1:0"]) as server:
        while "senders: " not in server.said():
            time.sleep(0.02)
        yield int(re.search(r"senders: [\d.]+:(\d+)", server.said())[1])


def nothing_moves(browser, site, port):
    sender = connected(port)
    sender.stream.sendall(b"$H\n")
    sender.wait(r"ok\n")
    time.sleep(0.5)
    home = sender.place()
    sender.close()
    for path in (LONG, "~!"):
        for script in (POSTS, FORM):
            for name, value in (("PORT", port), ("PATH", path), ("LINES", LINES), ("PADDING", PADDING)):
                script = re.sub(rf"\b{name}\b", lambda _: repr(value), script)
            browser.open(site)
            with contextlib.suppress(RuntimeError):  # The form leads away from the page.
                browser.script(script)
            time.sleep(1)
            sender = connected(port)
            place = sender.place()
            sender.close()
            moved = max(abs(a - b) for a, b in zip(place, home))
            assert moved < 0.1, f"a page of another site has moved the arm by {moved} mm"


def check(program, browser):
    with another_site() as site:
        for start in (bridge, serve):
            with start(program) as port:
                nothing_moves(browser, site, port)


if __name__ == "__main__":
    import sys

    from webdriver import Browser

    with Browser() as browser:
        check(sys.argv[1], browser)
