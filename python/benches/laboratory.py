"""How long single calls, a step of many plants and a controller in Python take, in the processor's time."""

import time
import timeit

import numpy as np

import fivebar

COUNT = 1000


def calls(arm):
    theta, omega, point = (2.2, 0.9), (1.0, 2.0), (0.04, 0.2)
    for name, call in {
        "forward": lambda: arm.forward(theta),
        "inverse": lambda: arm.inverse(point),
        "motion": lambda: arm.motion(theta, omega),
        "inverse_motion": lambda: arm.inverse_motion(point, omega),
        "inverse_dynamics": lambda: arm.inverse_dynamics(theta, omega),
        "forward_dynamics": lambda: arm.forward_dynamics(theta, omega, omega),
        "jacobian": lambda: arm.jacobian(theta),
        "derivatives, order 1": lambda: arm.derivatives(theta, order=1),
        "derivatives": lambda: arm.derivatives(theta),
    }.items():
        best = min(timeit.repeat(call, timer=time.process_time, number=1000, repeat=5))
        print(f"{name:22} {1e3 * best:7.1f} µs")


def plants(arm):
    ranges = {"payload": (0.0, 0.1)}
    many = fivebar.Plants(arm, COUNT, (2.2, 0.9), mismatch=fivebar.sim.drawn(COUNT, ranges, seed=1))
    best = [np.inf, np.inf]
    for _ in range(20):
        begin = time.perf_counter(), time.process_time()
        many.step((0.0, 0.0), 1e-3)
        end = time.perf_counter(), time.process_time()
        best = [min(b, t - s) for b, s, t in zip(best, begin, end)]
    wall, processor = (1e6 * seconds / COUNT for seconds in best)
    print(f"1 ms of {COUNT} plants: {wall:.2f} µs each, {processor:.2f} µs of processor time")


def controller(arm):
    plant, steps = fivebar.Plant(arm, (2.2, 0.9)), 5000
    begin = time.process_time()
    for _ in range(steps):
        plant.step(-0.5 * (plant.theta - (2.1, 1.0)) - 0.02 * plant.omega, 1e-3)
    print(f"a controller in Python: {1e-3 * steps / (time.process_time() - begin):.0f} × real time")


if __name__ == "__main__":
    benchtop = fivebar.Arm.load("benchtop")
    calls(benchtop)
    plants(benchtop)
    controller(benchtop)
