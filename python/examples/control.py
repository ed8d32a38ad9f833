# %% [markdown]
# # One's own controller
#
# Cells in percent format, as in tour.py. Computed torque in Python against PD with gravity, on the simulated arm, along
# a circle of 60 mm at 0.5 m/s, sampled at 1 kHz.

# %% The path: one turn, and the angles, rates and accelerations that draw it.
import numpy as np

import fivebar

arm = fivebar.Arm.load("benchtop")
dt, radius, speed = 1e-3, 0.03, 0.5
centre = np.array([0.04, 0.18])
turn = 2 * np.pi * radius / speed
time = np.arange(0.0, 2 * turn, dt)
# Speeds up over the first turn, goes on at full speed in the second one.
phase = np.where(time < turn, 0.5 * time**2 / turn, time - 0.5 * turn) * speed / radius
rate = np.minimum(time / turn, 1.0) * speed / radius
slope = np.where(time < turn, speed / radius / turn, 0.0)
out = np.stack((np.cos(phase), np.sin(phase)), axis=-1)
along = np.stack((-np.sin(phase), np.cos(phase)), axis=-1)
path = arm.inverse_motion(
    centre + radius * out,
    radius * rate[:, None] * along,
    radius * (slope[:, None] * along - (rate**2)[:, None] * out),
    strict=True,
)
needed = arm.inverse_dynamics(path.theta, path.omega, path.alpha, path.assembly)
print(f"torques up to {1e3 * np.abs(needed.torque).max():.0f} mN·m")

# %% [markdown]
# ## Two laws
# Both have the same stiffness and damping at the joints. The first knows the arm's mass matrix and the torques of its
# velocities; the second knows neither. The arm has 10 % more mass than both know, and friction.

# %%
BANDWIDTH = 60.0  # [rad/s]
STIFFNESS, DAMPING = BANDWIDTH**2, 2 * BANDWIDTH


def errors(computed_torque: bool) -> "np.ndarray[tuple[int, ...], np.dtype[np.float64]]":
    """The tool's distance from the path at each sample [m]."""
    plant = fivebar.Plant(arm, theta=path.theta[0], mismatch={"link_mass": 0.1})
    inertia = np.diag(needed.mass_matrix[0])
    found = np.empty(len(time))
    for k in range(len(time)):
        found[k] = np.hypot(*(plant.tool - (centre + radius * out[k])))
        pull = STIFFNESS * (path.theta[k] - plant.theta) + DAMPING * (path.omega[k] - plant.omega)
        if computed_torque:
            known = arm.inverse_dynamics(plant.theta, plant.omega, path.alpha[k] + pull)
            torque = known.torque
        else:
            torque = inertia * pull
        plant.step(torque, dt)
    return found


ours, plain = errors(True), errors(False)
whole = time > turn
for name, error in (("computed torque", ours), ("PD", plain)):
    print(f"{name}: {1e6 * np.sqrt(np.mean(error[whole] ** 2)):.0f} µm RMS at full speed, "
          f"{1e6 * error.max():.0f} µm at most")
assert ours[whole].max() < plain[whole].max()

# %% [markdown]
# ## How exact the model must be
# The derivatives of the torques by the lengths tell which millimetre changes them most.

# %%
fastest = int(np.argmax(np.abs(needed.torque).max(axis=-1)))
found = arm.derivatives(path.theta[fastest], path.omega[fastest], path.alpha[fastest])
names = fivebar.Derivatives.VARIABLES
for name in ("l1", "l2", "l3", "l4", "base"):
    by = found.first[6:, names.index(name)]
    print(f"  {name:4} {by[0]:+.2f}, {by[1]:+.2f} mN·m per mm at joints 1 and 4")
