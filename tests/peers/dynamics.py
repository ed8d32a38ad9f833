"""Loads exported arms into other engines and compares the accelerations that torques give.

    dynamics.py FIVEBAR FOLDER

FIVEBAR is the program. Arms are random; every second one has motors, with rotors and friction. Pinocchio reads the URDF,
MuJoCo the MJCF; each gives its mass matrix, bias forces, and the Jacobians of the loop's two ends. The loop is closed
exactly, by Lagrange multipliers:

    M q̈ + h = τ + Jᵀλ,  J q̈ + J̇q̇ = 0.

`fivebar query` gives ours, under the torques less the friction that the file states: damping b ω + Coulomb c sign ω. In
STATES states of each arm the driven accelerations must agree within BOUND of their size. Graphviz's text is read by pydot.
"""

import json
import math
import random
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pydot

ARMS = 40
STATES = 20
BOUND = 1e-9  # of the greater acceleration
LEAST_SINE = 0.3  # of the angle between links 2 and 3: far from the singularity of type 2
JOINTS = ("A", "B", "E", "D")
ENDS = ("c_of_link2", "c_of_link3")
SITES = ("C", "C_of_link3")


def robot_file(random_, number):
    """A random arm; every second one has motors, every third a tool beside C."""
    between = random_.uniform
    near, far = between(0.08, 0.15), between(0.16, 0.25)
    lines = [f'name = "arm {number}"', f"gravity = [{between(-10, 10)}, {between(-10, 10)}]",
             f"base = {between(0.05, 0.12)}", f"payload = {between(0.0, 0.2)}"]
    motors, tool = [], []
    if number % 3 == 0:
        tool = ["[tool]", f"offset = [{between(-0.03, 0.03)}, {between(-0.03, 0.03)}]"]
    for length in (near, far, far * between(0.9, 1.1), near * between(0.9, 1.1)):
        mass = between(0.03, 0.2)
        lines += ["[[link]]", f"length = {length}", f"mass = {mass}",
                  f"com = [{between(0.2, 0.7) * length}, {between(-0.01, 0.01)}]",
                  f"inertia = {mass * length ** 2 * between(0.05, 0.2)}"]
    if number % 2:
        for sign in (1, -1):
            motors += ["[[actuator]]", f"gear_ratio = {sign * between(4, 12)}",
                       f"rotor_inertia = {between(1e-6, 1e-5)}", "torque_constant = 0.0234",
                       "resistance = 2.3", "inductance = 0.24e-3",
                       f"viscous_friction = {between(1e-4, 5e-3)}",
                       f"coulomb_friction = {between(1e-3, 2e-2)}", "encoder_counts = 4096",
                       "peak_current = 4.0", "continuous_current = 1.3",
                       "thermal_time_constant = 30.0"]
    return "\n".join(lines + motors + tool) + "\n"


def states(program, path, random_):
    """Driven angles, rates and torques, with the angles of links 2 and 3, away from singularities."""
    found = []
    tries = [{"op": "forward", "theta1": random_.uniform(1.4, 2.8), "theta4": random_.uniform(0.3, 1.7),
              "assembly": random_.choice(("left", "right"))} for _ in range(40 * STATES)]
    for asked, answer in zip(tries, ask(program, path, tries)):
        sine = math.sin(answer["theta3"] - answer["theta2"]) if "theta2" in answer else 0.0
        if abs(sine) > LEAST_SINE and len(found) < STATES:
            rates = {"omega1": random_.uniform(-10, 10), "omega4": random_.uniform(-10, 10)}
            moving = {**asked, **rates, "op": "motion", "alpha1": 0.0, "alpha4": 0.0}
            found.append((moving, answer, [random_.uniform(-0.5, 0.5) for _ in range(2)]))
    assert len(found) == STATES, f"{path}: {len(found)} states"
    motions = ask(program, path, [moving for moving, _, _ in found])
    return [(moving, {**answer, **motion}, torque)
            for (moving, answer, torque), motion in zip(found, motions)]


def ask(program, path, queries):
    text = "\n".join(map(json.dumps, queries))
    done = subprocess.run([program, "query", "--robot", path], input=text, capture_output=True,
                          text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


def export(program, kind, path, to):
    subprocess.run([program, "export", kind, path, "--out", to], check=True, capture_output=True)
    return str(to)


def joints(state):
    """Angles and rates of A, B, E, D: of each link relative to the one before it."""
    asked, answer, _ = state
    angles = (asked["theta1"], answer["theta2"] - asked["theta1"],
              asked["theta4"], answer["theta3"] - asked["theta4"])
    rates = (asked["omega1"], answer["omega2"] - asked["omega1"],
             asked["omega4"], answer["omega3"] - asked["omega4"])
    return dict(zip(JOINTS, angles)), dict(zip(JOINTS, rates))


def closed(mass, bias, torque, jacobian, drift):
    """q̈ of the tree with its loop closed in the plane."""
    size = len(bias)
    system = np.block([[mass, jacobian.T], [jacobian, np.zeros((2, 2))]])
    return np.linalg.solve(system, np.concatenate([torque - bias, -drift]))[:size]


class Pinocchio:
    def __init__(self, path, gravity):
        self.model = pinocchio.buildModelFromUrdf(path)
        self.model.gravity.linear = np.array([*gravity, 0.0])
        self.data = self.model.createData()
        assert self.model.armature.max(initial=0.0) == 0.0, "the file says so"
        assert self.model.existFrame("tool"), "the tool is a frame"
        of = [self.model.joints[self.model.getJointId(name)] for name in ("A", "E")]
        model = self.model
        self.damping = [self.first(model, ("damping", "lowerDampingLimit"), j.idx_v) for j in of]
        self.coulomb = [self.first(model, ("friction", "upperDryFrictionLimit"), j.idx_v) for j in of]

    @staticmethod
    def first(model, names, index):
        """The attribute under one of the names that versions of the library have had."""
        return float(next(getattr(model, name) for name in names if hasattr(model, name))[index])

    def acceleration(self, state, torque):
        model, data = self.model, self.data
        angles, rates = joints(state)
        q, v, tau = pinocchio.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
        for name, angle in angles.items():
            joint = model.joints[model.getJointId(name)]
            # A joint without limits is a direction.
            wide = [math.cos(angle), math.sin(angle)] if joint.nq == 2 else [angle]
            q[joint.idx_q:joint.idx_q + joint.nq] = wide
            v[joint.idx_v] = rates[name]
        driven = [model.joints[model.getJointId(name)].idx_v for name in ("A", "E")]
        tau[driven] = torque
        mass = pinocchio.crba(model, data, q).copy()
        mass = np.triu(mass) + np.triu(mass, 1).T
        bias = pinocchio.nle(model, data, q, v).copy()
        pinocchio.computeJointJacobians(model, data, q)
        pinocchio.forwardKinematics(model, data, q, v, np.zeros(model.nv))
        pinocchio.updateFramePlacements(model, data)
        frame = pinocchio.LOCAL_WORLD_ALIGNED
        ends = [model.getFrameId(name) for name in ENDS]
        gap = data.oMf[ends[0]].translation - data.oMf[ends[1]].translation
        assert np.abs(gap).max() < 1e-12, f"the loop is open by {gap} m"
        one, other = (pinocchio.getFrameJacobian(model, data, end, frame)[:2] for end in ends)
        drift = [pinocchio.getFrameClassicalAcceleration(model, data, end, frame).linear[:2]
                 for end in ends]
        return closed(mass, bias, tau, one - other, drift[0] - drift[1])[driven]


class Mujoco:
    def __init__(self, path):
        self.model = mujoco.MjModel.from_xml_path(path)
        self.data = mujoco.MjData(self.model)
        driven = [self.model.joint(name).dofadr[0] for name in ("A", "E")]
        self.damping = [float(np.ravel(self.model.dof_damping[dof])[0]) for dof in driven]
        self.coulomb = [float(self.model.dof_frictionloss[dof]) for dof in driven]

    def acceleration(self, state, torque):
        model, data = self.model, self.data
        angles, rates = joints(state)
        for name in JOINTS:
            data.joint(name).qpos[0], data.joint(name).qvel[0] = angles[name], rates[name]
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        for column in range(model.nv):
            unit = np.zeros(model.nv)
            unit[column] = 1.0
            mujoco.mj_mulM(model, data, mass[column], unit)
        tau = np.zeros(model.nv)
        driven = [model.joint(name).dofadr[0] for name in ("A", "E")]
        tau[driven] = torque
        jacobians, drifts = [], []
        for name in SITES:
            site = data.site(name)
            body = model.site_bodyid[site.id]
            jacobian, rate = np.zeros((3, model.nv)), np.zeros((3, model.nv))
            mujoco.mj_jac(model, data, jacobian, None, site.xpos, body)
            mujoco.mj_jacDot(model, data, rate, None, site.xpos, body)
            jacobians.append(jacobian[:2])
            drifts.append((rate @ data.qvel)[:2])
        # Its passive forces, the damping, are applied by the caller.
        accelerations = closed(mass, data.qfrc_bias, tau, jacobians[0] - jacobians[1],
                               drifts[0] - drifts[1])
        return accelerations[driven]


def check_graph(path, lengths):
    """The graph has the ground and four links in a ring, each with its length."""
    (graph,) = pydot.graph_from_dot_file(path)
    edges = {frozenset((e.get_source(), e.get_destination())): e.get_label().strip('"')
             for e in graph.get_edges()}
    ring = ["ground", "link1", "link2", "link3", "link4", "ground"]
    assert edges == {frozenset(pair): name for pair, name in zip(zip(ring, ring[1:]), "ABCDE")}
    labels = {n.get_name(): n.get_label() for n in graph.get_nodes() if n.get_label()}
    for name, length in zip(ring, lengths):
        assert f"{length} m" in labels[name], (labels[name], length)


def main(program, folder):
    random_ = random.Random(7)
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    worst, with_friction = {"Pinocchio": 0.0, "MuJoCo": 0.0}, 0
    for number in range(ARMS):
        path = str(folder / "arm.toml")
        text = robot_file(random_, number)
        Path(path).write_text(text, encoding="utf-8")
        numbers = {key: [json.loads(line.split(" = ")[1]) for line in text.splitlines()
                         if line.startswith(f"{key} = ")]
                   for key in ("gravity", "length", "base", "viscous_friction", "coulomb_friction")}
        engines = {
            "Pinocchio": Pinocchio(export(program, "urdf", path, folder / "arm.urdf"),
                                   numbers["gravity"][0]),
            "MuJoCo": Mujoco(export(program, "mjcf", path, folder / "arm.xml")),
        }
        check_graph(export(program, "dot", path, folder / "arm.dot"),
                    numbers["base"] + numbers["length"])
        for name, engine in engines.items():
            for key, read in (("viscous_friction", engine.damping), ("coulomb_friction", engine.coulomb)):
                stated = numbers[key] or [0.0, 0.0]
                assert np.allclose(read, stated, rtol=1e-12), f"{name}: {key} {read}, not {stated}"
        with_friction += bool(numbers["viscous_friction"])
        of_arm = states(program, path, random_)
        queries = []
        for asked, _, torque in of_arm:
            rates = (asked["omega1"], asked["omega4"])
            friction = [b * w + math.copysign(c, w) for b, c, w in
                        zip(numbers["viscous_friction"] or (0.0, 0.0),
                            numbers["coulomb_friction"] or (0.0, 0.0), rates)]
            queries.append({"op": "forward_dynamics", "torque": [t - f for t, f in zip(torque, friction)],
                            "external_force": [0.0, 0.0],
                            **{key: asked[key] for key in ("theta1", "theta4", "omega1", "omega4", "assembly")}})
        for state, ours in zip(of_arm, ask(program, path, queries)):
            ours = np.array([ours["alpha1"], ours["alpha4"]])
            asked, _, torque = state
            rates = (asked["omega1"], asked["omega4"])
            for name, engine in engines.items():
                applied = [t - b * w - math.copysign(c, w) for t, b, c, w in
                           zip(torque, engine.damping, engine.coulomb, rates)]
                theirs = engine.acceleration(state, applied)
                off = np.abs(theirs - ours).max() / np.abs(ours).max()
                worst[name] = max(worst[name], off)
    for name, off in worst.items():
        print(f"{ARMS} random arms, {with_friction} of them with rotors and friction, in {STATES} states each: the "
              f"accelerations of {name} differ by {off:.1e} of their size at most")
        if not off < BOUND:
            sys.exit(f"more than the bound of {BOUND}")


main(*sys.argv[1:])
