"""The tip is a spring whose end moves on a circle, within a wall. See docs/use/streaming.md."""

from math import cos, sin, tau

import fivebar

with fivebar.connect("simulated", robot="benchtop", real_time=False) as arm:
    arm.home()
    arm.motors_on()
    x, y = arm.state.tool
    wall = fivebar.Fixture.half_plane((x + 0.008, y), (-1.0, 0.0), stiffness=60.0)
    with arm.impedance(60.0, 0.02, [wall]) as spring:
        for k in range(800):  # 4 s
            spring.tip(x + 0.01 * sin(tau * k / 400), y + 0.01 * (1 - cos(tau * k / 400)))
    print(f"the tip is {1e3 * (arm.state.tool[0] - x):.1f} mm from where it began")
