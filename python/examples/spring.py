"""The tip is a spring whose end moves on circles, partly behind a wall. See docs/use/streaming.md."""

from math import cos, sin, tau

import fivebar

with fivebar.connect("simulated", robot="benchtop", real_time=False) as arm:
    arm.home()
    arm.motors_on()
    assert arm.state.tool is not None
    x, y = arm.state.tool
    farthest = x
    wall = fivebar.Fixture.half_plane((x + 0.004, y), (-1.0, 0.0), stiffness=60.0)
    with arm.impedance(60.0, 0.02, [wall]) as spring:
        for k in range(800):  # 4 s
            spring.tip(x + 0.01 * sin(tau * k / 400), y + 0.01 * (1 - cos(tau * k / 400)))
            farthest = max(farthest, arm.state.tool[0])
    print(f"of 10 mm, the wall let the tip go {1e3 * (farthest - x):.1f} mm")
