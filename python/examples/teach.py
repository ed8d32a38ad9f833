"""A motion that a hand teaches, done again at half its speed. See docs/use/streaming.md."""

import sys

import fivebar

with fivebar.connect(*sys.argv[1:2] or ["simulated"], robot="benchtop") as arm:
    arm.home()
    arm.motors_on()
    print("lead the tip by hand for 5 s")
    path = arm.free(5.0)
    path.save("taught.json")
    arm.replay(path, speed=0.5)
    print(path)
