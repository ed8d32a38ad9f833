"""A motion that a hand teaches, done again at half its speed. See docs/use/streaming.md."""

import sys

import fivebar

if len(sys.argv) < 2:
    print("nobody leads a simulated arm by hand: python teach.py PORT")
    sys.exit()
with fivebar.connect(sys.argv[1], robot="benchtop") as arm:
    arm.home()
    arm.motors_on()
    print("lead the tip by hand for 5 s")
    path = arm.free(5.0)
    path.save("taught.json")
    arm.replay(path, speed=0.5)
