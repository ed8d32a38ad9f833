"""The tip follows the mouse, as far and as fast as the arm can. See docs/use/streaming.md."""

import sys
import tkinter

import fivebar

try:
    window = tkinter.Tk()
except tkinter.TclError:
    print("there is no screen, so nobody moves a mouse")
    sys.exit()
with fivebar.connect("simulated", robot="benchtop") as arm:
    arm.home()
    arm.motors_on()
    assert arm.state.tool is not None
    x, y = arm.state.tool
    left, top = window.winfo_pointerxy()
    with arm.stream(rate=100, policy="limit") as s:
        for _ in range(1000):  # 10 s
            window.update()
            right, down = window.winfo_pointerxy()
            s.tip(x + 1e-4 * (right - left), y - 1e-4 * (down - top))  # 0.1 mm for a pixel
