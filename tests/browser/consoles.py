"""The console: lines of G-code, their answers, and the lines before."""

ENTER, UP, DOWN = "\ue007", "\ue013", "\ue015"


def check(page):
    browser = page.browser
    page.home_and_arm_if_needed()
    log = lambda: browser.text("#console-log")

    def say(line):
        browser.focus("#console")
        browser.type("#console", line)
        browser.press(ENTER)

    say("G91 G1 X1 F600")
    browser.wait("the answer", lambda: "> G91 G1 X1 F600" in log() and log().endswith("ok"))
    assert "Grbl 1.1h" in log(), log()
    page.wait_for_rest()
    say("G1 X900")
    browser.wait("the refusal", lambda: log().endswith("error:15"))
    # The lines before, and what was typed meanwhile.
    browser.type("#console", "?")
    value = lambda: browser.script("return document.getElementById('console').value;")
    seen = []
    for key in (UP, UP, UP, DOWN, DOWN):
        browser.press(key)
        seen.append(value())
    assert seen == ["G1 X900", "G91 G1 X1 F600", "G91 G1 X1 F600", "G1 X900", "?"], seen
    browser.click("#send")
    browser.wait("the report", lambda: "<Idle|MPos:" in log())
    assert value() == "" and page.state() == "Armed"
    # Other controls work beside it.
    before = page.tool()[0]
    browser.click('[data-jog="1,0"]')
    browser.wait("the step", lambda: page.at_rest() and abs(page.tool()[0] - before - 1) < 0.05)
    assert "The console has ended: G91" in log(), log()
