#!/usr/bin/env python3
"""A circle from Python at 500 points a second on the simulated board, with the image for each kind of motor.

    verify/chip/circle.py BOARD IMAGE

BOARD is `board` of this folder, IMAGE the image `stm32f405`, beside which the others are. It needs the package `fivebar`.
"""

import math
import pathlib
import sys

import fivebar

sys.path.append(str(pathlib.Path(__file__).parent))
from bring_up import Board

# Of each image: a built-in robot.
ROBOTS = {"stm32f405": "benchtop", "stm32f405_stepper": "benchtop_stepper", "stm32f405_can": "leg"}
RATE, POINTS, RADIUS = 500, 1500, 0.01


def circle(board, image, robot):
    """Draws, and sees that the controller followed each point that came in time."""
    with Board(board, image, robot) as board, fivebar.connect(board.port, robot=robot, upload=True) as arm:
        arm.home()
        arm.motors_on()
        x, y = arm.state.tool
        with arm.stream(rate=RATE) as stream:
            for k in range(POINTS + 1):
                share = k / POINTS
                angle = math.tau * share * share * (3 - 2 * share)
                stream.tip(x + RADIUS * math.sin(angle), y - RADIUS * (1 - math.cos(angle)))
        seen, state = stream.state, arm.state
    assert state.fault is None and state.state == "Armed", state
    off = math.dist(state.tool, (x, y))
    assert off < 1e-4, f"{off} m from where the circle ends"
    # A machine with other work may let the program come late: such points are counted, and the arm goes on without them.
    assert seen.refused == seen.limited == 0 and seen.late + seen.lost < POINTS / 10, seen
    print(f"circle from Python with {robot}: {seen.late} points late, {seen.lost} lost of {seen.points}; the longest time from "
          f"one to the next was {1e3 * seen.longest_interval:.0f} ms; it ends {1e6 * off:.0f} µm off", flush=True)


def main():
    board, image = sys.argv[1:]
    for name, robot in ROBOTS.items():
        circle(board, str(pathlib.Path(image).with_name(name)), robot)


main()
