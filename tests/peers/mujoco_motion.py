"""Moves exported models in MuJoCo by the torques of runs, and compares the motions.

    mujoco_motion.py URDF FOLDER WINDING_TIME [FOLDER WINDING_TIME]…

Each folder holds `arm.xml` and the `trace.csv` of a run of the same arm without mismatch.
MuJoCo integrates by its own Runge-Kutta method of fourth order, from the tick in which the brake
is released. Within a tick a motor's torque goes from one row to the next as its winding's time
constant L/R [s] says. Coulomb friction acts by the plant's smooth law, c x/√(1 + x²) with
x = ω/ω0, because MuJoCo's own friction loss holds at rest. There is no feedback to pull the two
motions together: over SPAN seconds the driven angles must stay within BOUND of the run's.
"""

import csv
import math
import sys

import mujoco

SPAN = 0.3  # s
BOUND = 1e-4  # rad
TICK = 1e-4  # s
STEPS = 20  # of MuJoCo in a tick; its soft loop has a time constant of two steps
CREEP = 1.5e-9  # rad in a tick: a held joint, modelled by a large inertia, turns by less
SIGN_WIDTH = 0.02  # ω0 of the plant's Coulomb friction, rad/s
DRIVEN = (("A", "B", "link2", "theta1"), ("E", "D", "link3", "theta4"))


def pose(model, data, row):
    """Closes the loop at a row's driven angles and tool."""
    tool = (row["tool_x_m"], row["tool_y_m"])
    for joint, elbow, link, angle in DRIVEN:
        theta = row[f"{angle}_rad"]
        pivot = model.body(model.body(link).parentid[0]).pos
        length = model.body(link).pos[0]
        x = pivot[0] + length * math.cos(theta)
        y = pivot[1] + length * math.sin(theta)
        data.joint(joint).qpos[0] = theta
        data.joint(elbow).qpos[0] = math.atan2(tool[1] - y, tool[0] - x) - theta
    mujoco.mj_forward(model, data)


def moving_rows(path):
    """The rows of a trace from the last one at which the brake still holds the arm."""
    with open(path, newline="") as file:
        rows = [{k: float(v) for k, v in row.items() if v} for row in csv.DictReader(file)]
    angles = [[row[f"{angle}_rad"] for *_, angle in DRIVEN] for row in rows]
    steps = [max(abs(a - b) for a, b in zip(*pair)) for pair in zip(angles, angles[1:])]
    held = next(i for i, step in enumerate(steps) if step > CREEP)
    return rows[held:]


def compare(folder, winding_time):
    model = mujoco.MjModel.from_xml_path(f"{folder}/arm.xml")
    assert model.actuator_ctrllimited.all(), "the motors must know their greatest torque"
    assert model.actuator_forcelimited.all(), "the motors must keep their greatest torque"
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    model.opt.timestep = TICK / STEPS
    model.eq_solref[:] = [2 * model.opt.timestep, 1]
    dofs = [model.joint(joint).dofadr[0] for joint, *_ in DRIVEN]
    coulomb = [model.dof_frictionloss[dof] for dof in dofs]
    model.dof_frictionloss[:] = 0
    data = mujoco.MjData(model)
    rows = moving_rows(f"{folder}/trace.csv")
    start = rows[0]
    pose(model, data, start)
    middles = [(step + 0.5) / STEPS * TICK for step in range(STEPS)]
    risen = [math.expm1(-t / winding_time) / math.expm1(-TICK / winding_time) for t in middles]
    worst, moved, opened = 0.0, 0.0, 0.0
    for row, following in zip(rows, rows[1:]):
        if row["time_s"] - start["time_s"] > SPAN:
            break
        for share in risen:
            for n, name in enumerate(("torque1_nm", "torque4_nm")):
                data.ctrl[n] = row[name] + share * (following[name] - row[name])
            for dof, torque in zip(dofs, coulomb):
                x = data.qvel[dof] / SIGN_WIDTH
                data.qfrc_applied[dof] = -torque * x / math.sqrt(1 + x * x)
            mujoco.mj_step(model, data)
        for *_, angle in DRIVEN:
            ours = following[f"{angle}_rad"]
            worst = max(worst, abs(data.sensor(angle).data[0] - ours))
            moved = max(moved, abs(ours - start[f"{angle}_rad"]))
        opened = max(opened, max(abs(x) for x in data.efc_pos[:3]))
    print(f"{folder}: over {data.time:.3f} s the joints moved {moved:.4f} rad; MuJoCo strays "
          f"{worst:.2e} rad from the run, and opens the loop by {opened:.1e} m")
    if moved < 0.05:
        sys.exit("the run hardly moves: nothing is compared")
    if worst > BOUND:
        sys.exit(f"more than the bound of {BOUND} rad")


def main(urdf_path, *runs):
    tree = mujoco.MjModel.from_xml_path(urdf_path)
    assert tree.njnt == 4, "the URDF must have four joints"
    for folder, winding_time in zip(runs[::2], runs[1::2], strict=True):
        compare(folder, float(winding_time))


main(*sys.argv[1:])
