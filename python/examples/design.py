# %% [markdown]
# # An arm for a task
#
# Cells in percent format, as in tour.py. The task: a plotter for 150 × 100 mm whose pen errs least, of parts
# with lengths within 50 µm and joint angles within 0.2 mrad (standard deviations).

# %% What is wanted, and two arms: the shortest, and the one of least error.
import numpy as np

import fivebar

TASK = """
symmetric = true
base = [0.04, 0.2]
link_sum = 0.4
[area]
kind = "rectangle"
width = 0.15
height = 0.1
[require]
dexterity = 0.3
[tolerance]
length = 5e-5
angle = 2e-4
[objective]
minimise = "{}"
"""
shortest = fivebar.design(TASK.format("link_sum"))
precise = fivebar.design(TASK.format("error"))
for name, answer in (("shortest", shortest), ("precise", precise)):
    best = answer.figures["whole_millimetres"]
    lengths = ", ".join(f"{1e3 * length:.0f}" for length in best["link_lengths"])
    print(f"{name}: l1…l4 and base {lengths} mm; RMS error {1e6 * best['error']:.0f} µm at the worst "
          f"place; proved free of singularities: {answer.figures['whole_proved']}")

# %% [markdown]
# ## Where it errs
# The error over the area by the derivatives of C by lengths and angles, for parts of those tolerances. The search measures
# it from the middle of the base, which half of the base's error moves.

# %%
arm = fivebar.Arm.from_toml(precise.robot_toml)
best = precise.figures["whole_millimetres"]
width, height = 0.15, 0.1
corner = np.array([best["link_lengths"][4] / 2 - width / 2, 0.0]) + best["place"]
x, y = np.meshgrid(corner[0] + np.linspace(0, width, 31), corner[1] + np.linspace(0, height, 21))
there = arm.inverse(np.stack((x, y), axis=-1), strict=True)
found = arm.derivatives(there.theta, assembly=there.assembly, strict=True)
names = fivebar.Derivatives.VARIABLES
by_length = found.first[..., :2, names.index("l1"):names.index("base") + 1].copy()
by_length[..., 0, -1] -= 0.5
by_angle = found.first[..., :2, :2]
error = np.sqrt(np.sum((5e-5 * by_length) ** 2, axis=(-2, -1))
                + np.sum((2e-4 * by_angle) ** 2, axis=(-2, -1)))
worst = np.unravel_index(np.argmax(error), error.shape)
print(f"RMS error {1e6 * error.min():.0f} to {1e6 * error.max():.0f} µm, the greatest at "
      f"({1e3 * x[worst]:.0f}, {1e3 * y[worst]:.0f}) mm; by the search {1e6 * best['error']:.0f} µm")
assert abs(error.max() - best["error"]) < 0.01 * best["error"]

# %% [markdown]
# ## Which parts matter there, and what finer encoders bring

# %%
shares = np.concatenate((2e-4 * by_angle[worst], 5e-5 * by_length[worst]), axis=-1)
shares = np.sum(shares**2, axis=0) / error[worst] ** 2
for name, share in zip(("theta1", "theta4", "l1", "l2", "l3", "l4", "base"), shares):
    print(f"  {name:6} {share:4.0%} of the variance")
finer = np.sqrt(np.sum((5e-5 * by_length) ** 2, axis=(-2, -1))
                + np.sum((5e-5 * by_angle) ** 2, axis=(-2, -1)))
print(f"with joint angles within 0.05 mrad: {1e6 * finer.max():.0f} µm at the worst place")
