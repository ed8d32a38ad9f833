"""The time of a million inverse solutions: by this package, by NumPy, one by one.

    python python/benches/inverse.py

Each figure is the best of several runs.
"""

import math
import os
import platform
import time

import numpy as np

import fivebar

ROWS = 1_000_000
RUNS = 7


def best(call, runs=RUNS):
    """The time of the shortest of several runs [s], and the last result."""
    shortest, given = math.inf, None
    for _ in range(runs):
        started = time.perf_counter()
        given = call()
        shortest = min(shortest, time.perf_counter() - started)
    return shortest, given


def by_numpy(lengths, points, elbow1, elbow4):
    """The same in plain NumPy: angles of all links and the assembly mode."""
    l1, l2, l3, l4, base = lengths

    def elbow(x, y, near, far, side):
        square = x * x + y * y
        along = 0.5 * (1 + (near + far) * (near - far) / square)
        product = ((near + far) ** 2 - square) * (square - (near - far) ** 2)
        across = -side * np.sqrt(product) / (2 * square)
        return along * x - across * y, along * y + across * x

    x, y = points[:, 0], points[:, 1]
    with np.errstate(invalid="ignore"):
        bx, by = elbow(x, y, l1, l2, elbow1)
        ex, dy = elbow(x - base, y, l4, l3, elbow4)
    dx = base + ex
    theta1 = np.arctan2(by, bx)
    theta4 = np.arctan2(dy, ex)
    theta2 = np.arctan2(y - by, x - bx)
    theta3 = np.arctan2(y - dy, x - dx)
    assembly = np.sign((dx - bx) * (y - by) - (dy - by) * (x - bx))
    return theta1, theta4, theta2, theta3, assembly


def main():
    arm = fivebar.Arm.load("benchtop")
    rng = np.random.default_rng(1)
    points = rng.uniform((-0.05, 0.1), (0.13, 0.2), (ROWS, 2))
    elbow1, elbow4 = int(arm.elbow1), int(arm.elbow4)

    ours, answer = best(lambda: arm.inverse(points))
    assert answer.ok.all()
    plain, numbers = best(lambda: by_numpy(arm.lengths, points, elbow1, elbow4))
    strays = max(np.abs(getattr(answer, name) - column).max() for name, column in zip(
        ("theta1", "theta4", "theta2", "theta3", "assembly"), numbers))
    assert strays < 1e-9, strays
    few = points[:20_000]
    single, _ = best(lambda: [arm.inverse(point) for point in few], runs=1)
    single *= ROWS / len(few)

    print(f"{ROWS:,} inverse solutions on {os.cpu_count()} cores, Python "
          f"{platform.python_version()}, NumPy {np.__version__}")
    print(f"  fivebar, one batch   {ours:8.3f} s   {1e9 * ours / ROWS:8.0f} ns each")
    print(f"  NumPy, vectorised    {plain:8.3f} s   {plain / ours:8.1f} times as long")
    print(f"  fivebar, one by one  {single:8.1f} s   {single / ours:8.0f} times as long "
          f"(from {len(few):,})")
    print(f"  fivebar and NumPy agree within {strays:.1e} rad")


if __name__ == "__main__":
    main()
