"""Moves the exported model in MuJoCo by the torques of a run, and compares the motion.

    mujoco_motion.py MODEL.xml MODEL.urdf TRACE.csv

The run must be of the same arm without mismatch, its drives ideal torque sources, so that
each torque holds for a tick. There is no feedback to pull the two motions together: over
SPAN seconds the driven angles must stay within BOUND of the run's by themselves.
"""

import csv
import math
import sys

import mujoco

SPAN = 0.8  # s
BOUND = 1e-4  # rad


def pose(model, data, row):
    """Closes the loop at a row's driven angles and tool."""
    tool = (row["tool_x_m"], row["tool_y_m"])
    for joint, elbow, link, angle in (("A", "B", "link2", "theta1"), ("E", "D", "link3", "theta4")):
        theta = row[f"{angle}_rad"]
        pivot = model.body(model.body(link).parentid[0]).pos
        length = model.body(link).pos[0]
        x = pivot[0] + length * math.cos(theta)
        y = pivot[1] + length * math.sin(theta)
        data.joint(joint).qpos[0] = theta
        data.joint(elbow).qpos[0] = math.atan2(tool[1] - y, tool[0] - x) - theta
    mujoco.mj_forward(model, data)


def main(model_path, urdf_path, trace_path):
    tree = mujoco.MjModel.from_xml_path(urdf_path)
    assert tree.njnt == 4, "the URDF must have four joints"
    model = mujoco.MjModel.from_xml_path(model_path)
    assert model.actuator_ctrllimited.all(), "the motors must know their greatest torque"
    assert model.actuator_forcelimited.all(), "the motors must keep their greatest torque"
    data = mujoco.MjData(model)
    with open(trace_path, newline="") as file:
        rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    start = rows[0]
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    pose(model, data, start)
    worst, moved, opened = 0.0, 0.0, 0.0
    for row, following in zip(rows, rows[1:]):
        if row["time_s"] - start["time_s"] > SPAN:
            break
        data.ctrl[:] = [following[k] for k in ("torque1_nm", "torque4_nm")]
        while data.time < following["time_s"] - start["time_s"] - 1e-9:
            mujoco.mj_step(model, data)
        for angle in ("theta1", "theta4"):
            ours = following[f"{angle}_rad"]
            worst = max(worst, abs(data.sensor(angle).data[0] - ours))
            moved = max(moved, abs(ours - start[f"{angle}_rad"]))
        opened = max(opened, max(abs(x) for x in data.efc_pos[:3]))
    print(f"over {data.time:.3f} s the joints moved {moved:.4f} rad; MuJoCo strays "
          f"{worst:.2e} rad from the run, and opens the loop by {opened:.1e} m")
    if moved < 0.05:
        sys.exit("the run hardly moves: nothing is compared")
    if worst > BOUND:
        sys.exit(f"more than the bound of {BOUND} rad")


main(*sys.argv[1:])
