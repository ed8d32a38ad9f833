"""Which connections the server accepts."""

import time

from live import UPGRADE, Page, Server


def foreign_origins_are_refused(server):
    own = {"Origin": f"http://{server.host}", **server.cookie}
    foreign = {"Origin": "http://example.org", **server.cookie}
    rebound = {"Host": "example.org", "Origin": "http://example.org", **server.cookie}
    assert server.status("/live", **UPGRADE, **own) == 101
    assert server.status("/live", **UPGRADE, **foreign) == 403
    assert server.status("/live", **UPGRADE, **rebound) == 403
    assert server.status("/", Host="example.org", **server.cookie) == 403
    # By then the server has noticed that the accepted connection is closed.
    time.sleep(0.6)


def a_page_of_another_origin_gets_nothing(server, browser):
    # For a browser the same server under another name is another origin.
    browser.open(f"http://localhost:{server.port}/?token={server.token}")
    seen = browser.script(f"""
        const socket = new WebSocket('ws://{server.host}/live');
        return await new Promise((done) => {{
            socket.onopen = () => done('open');
            socket.onerror = () => done('refused');
        }});""")
    assert seen == "refused", seen


def a_token_is_asked_for_once(program, browser, listen):
    with Server(program, listen=listen) as server:
        token = server.token
        assert len(token) == 32
        other = ("0" if token[0] != "0" else "1") + token[1:]
        for path in ("/", f"/?token={other}", f"/?token={token[:-1]}", "/arm.json", "/app.js"):
            assert server.status(path) == 401, path
        assert server.status("/live", **UPGRADE) == 401
        assert server.status(f"/live?token={token}", **UPGRADE) == 401, "tokens open / alone"
        status, headers = server.answer(f"/?token={token}")
        headers = {name.lower(): value for name, value in headers.items()}
        assert (status, headers["location"]) == (303, "/"), headers
        assert "HttpOnly" in headers["set-cookie"], headers
        cookie = {"Cookie": headers["set-cookie"].split(";")[0]}
        assert server.status("/arm.json", **cookie) == 200
        assert server.status("/live", **UPGRADE, **cookie) == 101
        foreign = {"Origin": "http://example.org", **cookie}
        assert server.status("/live", **UPGRADE, **foreign) == 403, "even with the cookie"
        time.sleep(0.6)
        page = Page(browser, server.url)
        assert token not in browser.script("return location.href + document.cookie;")
        page.home_and_arm()
        assert server.said().count(token) == 1, "it is printed once"


def check(program, server, browser):
    foreign_origins_are_refused(server)
    a_page_of_another_origin_gets_nothing(server, browser)
    # Other users of this computer reach the loopback address, too.
    for listen in ("127.0.0.1:0", "0.0.0.0:0"):
        a_token_is_asked_for_once(program, browser, listen)
