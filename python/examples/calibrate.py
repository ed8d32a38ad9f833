# %% [markdown]
# # Which arm was built
#
# Cells in percent format, as in tour.py. Measurements of a built arm give its lengths and where its joints' zeros are;
# the files are those of host/files/measurements, of an arm up to 0.73 mm and 23 mrad off its drawing.

# %% The measurements: holes of a plate at known places, and distances of two places of the tip.
import json
from pathlib import Path

import numpy as np

import fivebar

ROOT = Path(__file__).resolve().parents[2]
FILES = ROOT / "host/files/measurements"
holes, bars = (
    np.genfromtxt(FILES / f"benchtop_{name}.csv", delimiter=",", skip_header=1)
    for name in ("holes", "bars")
)
arm = fivebar.Arm.load("benchtop")
print(f"{len(holes)} holes, {len(bars)} distances; as drawn: l1…l4, base "
      f"{', '.join(f'{1e3 * length:.2f}' for length in arm.lengths)} mm")

# %% [markdown]
# ## By holes, by distances, by both
# The tip's error is that over the workspace, predicted from the standard deviations of the lengths and zeros. Distances
# alone do not tell how the base is turned.

# %%
for name, points, distances in (("holes", holes, None), ("distances", None, bars), ("both", holes, bars)):
    found = arm.calibrate(points, bars=distances).figures
    lengths = ", ".join(f"{1e3 * length:.3f}" for length in found["link_lengths"])
    deviation = 1e6 * max(found["link_lengths_sd"])
    print(f"{name:9}: {lengths} mm, within {deviation:.0f} µm; the tip errs by "
          f"{1e6 * found['tip_error_rms_m']:.0f} µm RMS, {1e6 * found['tip_error_before_rms_m']:.0f} µm before")

# %% [markdown]
# ## Wrong measurements
# Three holes are off by half a millimetre. Huber's loss gives them little weight, least squares believes them.

# %%
robust = arm.calibrate(holes)
plain = arm.calibrate(holes, plain=True)
print("by Huber's loss rows", ", ".join(map(str, robust.figures["rejected"])), "are wrong")
change = np.subtract(plain.figures["link_lengths"], robust.figures["link_lengths"])
print(f"least squares moves the lengths by up to {1e6 * np.abs(change).max():.0f} µm")
assert len(robust.figures["rejected"]) == 3

# %% [markdown]
# ## Where to measure
# Holes that determine the arm best, and what more of them bring: twice as many divide the error by about √2.

# %%
for count in (6, 12, 24):
    proposed = arm.calibration_poses(count)
    print(f"{count:2} holes: the tip errs by {1e6 * proposed['tip_error_rms_m']:.0f} µm RMS")

# %% [markdown]
# ## What it brings
# A job on the arm that was built, by the controller that knows the drawing, and by one that knows the calibrated arm. Here
# the true lengths are known, because the measurements were simulated.

# %%
TRUE = json.loads((ROOT / "tests/data/calibration_public.json").read_text())["sets"][1]["true"]
JOB = "G21 G90\nG0 X30 Y0\nG2 X30 Y0 I-30 J0 F6000\n"
built = fivebar.Arm.from_toml(robust.robot_toml)
for name, known in (("as drawn", arm), ("calibrated", built)):
    off = np.subtract(TRUE[:5], known.lengths)
    mismatch = {"link_length": off[:4].tolist(), "base_length": float(off[4])}
    run = known.simulate(JOB, origin=(0.04, 0.18), mismatch=mismatch)
    print(f"{name}: lengths off by up to {1e6 * np.abs(off).max():.0f} µm, "
          f"tip error {1e6 * run.summary['tip_error']['rms_m']:.0f} µm RMS")
