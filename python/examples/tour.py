# %% [markdown]
# # A five-bar arm in a notebook
#
# Cells in percent format: Jupyter (with jupytext), VS Code and Spyder open this file as a
# notebook, and `python tour.py` runs it from top to bottom. Lengths are in metres, angles
# in radians, forces in newtons.

# %% The arm: a built-in one; `fivebar.Arm.from_file("my-arm.toml")` takes yours.
import numpy as np

import fivebar

arm = fivebar.Arm.load("benchtop")
print(arm)

# %% [markdown]
# ## Reach
# Which points of a grid can it reach, and why not the others?

# %%
x, y = np.meshgrid(np.linspace(-0.25, 0.33, 581), np.linspace(-0.3, 0.3, 601))
grid = np.stack((x, y), axis=-1)
reach = arm.inverse(grid)
cell = (x[0, 1] - x[0, 0]) * (y[1, 0] - y[0, 0])
print(f"of {reach.status.size:,} points {reach.ok.mean():.1%} are in reach: "
      f"{reach.ok.sum() * cell:.4f} m²")
for code, count in zip(*np.unique(reach.status, return_counts=True)):
    status = fivebar.Status(int(code))
    if status:
        print(f"  {count:8,} not, for {status.reason}")

# Of those, the ones within the joints' limits; angles come in (−π, π], limits may go beyond.
low, high = np.transpose(arm.joint_limits)
turned = low + np.mod(reach.theta - low, 2 * np.pi)
allowed = reach.ok & np.all(turned <= high, axis=-1)
print(f"within the joints' limits: {allowed.sum() * cell:.4f} m²")

# %% [markdown]
# ## A path
# A circle of 30 mm at 0.2 m/s: angles, speeds and accelerations of the joints.

# %%
centre, radius, speed = np.array([0.04, 0.18]), 0.03, 0.2
rate = speed / radius
time = np.linspace(0, 2 * np.pi / rate, 1_000)
out = np.stack((np.cos(rate * time), np.sin(rate * time)), axis=-1)
along = np.stack((-np.sin(rate * time), np.cos(rate * time)), axis=-1)
path = arm.inverse_motion(
    centre + radius * out, speed * along, -(speed**2 / radius) * out, strict=True
)
print(f"one turn takes {time[-1]:.2f} s; joint 1 goes from {path.theta1.min():.3f} to "
      f"{path.theta1.max():.3f} rad, at {np.abs(path.omega1).max():.2f} rad/s at most")

# %% [markdown]
# ## Torques
# The torques of the path, and those of an upright arm with a load.

# %%
needed = arm.inverse_dynamics(path.theta, path.omega, path.alpha, path.assembly)
print(f"torques up to {1e3 * np.abs(needed.torque).max():.2f} mN·m, "
      f"{1e3 * np.abs(needed.bias_torque).max():.2f} mN·m of them not by acceleration; "
      f"joint C bears {np.linalg.norm(needed.reaction.c, axis=-1).max():.3f} N")
pulled = arm.inverse_dynamics(
    path.theta, path.omega, path.alpha, path.assembly, external_force=(0.0, -2.0)
)
print(f"with 2 N on the tool along -y: up to {1e3 * np.abs(pulled.torque).max():.0f} mN·m")

# %% [markdown]
# ## A job
# The same circle as G-code, done by the simulated arm under the firmware's control loop,
# with links, friction and payload that differ from the controller's model.

# %%
job = """
G21 G90 (mm, absolute)
G0 X30 Y0
G2 X30 Y0 I-30 J0 F12000
"""
run = arm.simulate(job, origin=tuple(centre))
pid = arm.simulate(job, origin=tuple(centre), computed_torque=False)
ours, plain = run.summary["tip_error"], pid.summary["tip_error"]
print(f"simulated {run.summary['simulated_s']:.2f} s, homing included; "
      f"faults: {[name for _, name in run.faults]}")
print(f"tip error {1e6 * ours['rms_m']:.1f} µm RMS, {1e6 * ours['max_m']:.1f} µm at most; "
      f"by PID at each joint {1e6 * plain['rms_m']:.1f} µm RMS")
print(f"currents up to {np.abs(run.trace.current).max():.2f} A, torques up to "
      f"{1e3 * np.abs(run.trace.torque).max():.1f} mN·m")

# %% [markdown]
# ## A picture, where matplotlib is installed

# %%
try:
    import matplotlib.pyplot as plt
except ImportError:
    print("no picture: matplotlib is not installed")
else:
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    left.pcolormesh(x, y, np.where(allowed, 2, reach.ok), cmap="Blues", rasterized=True)
    left.plot(*run.trace.tool.T, color="tab:red")
    left.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title="reach, limits and the job")
    right.plot(run.trace.time, 1e6 * run.trace.tip_error, label="computed torque")
    right.plot(pid.trace.time, 1e6 * pid.trace.tip_error, label="PID at each joint")
    right.set(xlabel="time [s]", ylabel="tip error [µm]", title="tip error")
    right.legend()
    figure.savefig("tour.png", dpi=100)
    print("the picture is tour.png")
