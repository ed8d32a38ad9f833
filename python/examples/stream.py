"""A circle by streamed set-points. See docs/use/streaming.md."""

from math import cos, sin, tau

import fivebar

with fivebar.connect("simulated", robot="benchtop", real_time=False) as arm:
    arm.home()
    arm.motors_on()
    assert arm.state.tool is not None
    x, y = arm.state.tool
    with arm.stream(rate=500) as s:
        for k in range(1001):  # 2 s, smoothly from rest to rest
            u = k / 1000
            a = tau * u * u * (3 - 2 * u)
            s.tip(x + 0.01 * sin(a), y + 0.01 * (1 - cos(a)))
    print(arm.state.state, arm.state.tool)
