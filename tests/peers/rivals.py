"""The same work by other programs from PyPI, timed side by side.

    pip install ./python pin toppra roboticstoolbox-python ruckig
    python tests/peers/rivals.py [--write docs/verify/rivals.md]

The arm is `benchtop`. Times are the processor's for one call from Python, the best of 30, on one thread. Both answers are
compared.
"""

import argparse
import os
import sys
import tempfile
import time
from importlib.metadata import version
from pathlib import Path

for threads in ("RAYON_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[threads] = "1"

import numpy as np
import pinocchio
import roboticstoolbox
import ruckig
import toppra
import toppra.algorithm
import toppra.constraint

import fivebar

ARM = fivebar.Arm.load("benchtop")
POINTS = [[0.0, 0.18], [0.04, 0.2], [0.08, 0.18]]
#: Of both joints [rad/s], [rad/s²], [rad/s³].
SPEED, ACCELERATION, JERK = 6.0, 90.0, 2000.0


def seconds(call):
    """Of the processor for one call."""
    best = np.inf
    count = max(1, int(0.01 / max(1e-7, min(once(call, 1) for _ in range(5)))))
    for _ in range(30):
        best = min(best, once(call, count) / count)
    return best


def once(call, count):
    begin = time.process_time()
    for _ in range(count):
        call()
    return time.process_time() - begin


class ClosedChain:
    """The arm in motion, without friction, for Pinocchio, which joins both halves of the loop by a constraint."""

    def __init__(self):
        smooth = "\n".join(line for line in ARM.toml.splitlines() if "friction" not in line)
        self.arm = fivebar.Arm.from_toml(smooth)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "arm.urdf"
            path.write_text(self.arm.export("urdf"), encoding="utf-8")
            self.model = pinocchio.buildModelFromUrdf(str(path))
        # The built-in arm lies flat.
        self.model.gravity.linear = np.zeros(3)
        self.theta, self.omega = np.array([2.2, 0.9]), np.array([1.0, 2.0])
        self.torque = np.array([0.02, -0.01])
        model, pose = self.model, self.arm.forward(self.theta)
        angles = {"A": self.theta[0], "B": pose.theta2 - self.theta[0],
                  "E": self.theta[1], "D": pose.theta3 - self.theta[1]}
        self.q, self.tau = pinocchio.neutral(model), np.zeros(model.nv)
        for name, angle in angles.items():
            joint = model.joints[model.getJointId(name)]
            wide = [np.cos(angle), np.sin(angle)] if joint.nq == 2 else [angle]
            self.q[joint.idx_q:joint.idx_q + joint.nq] = wide
        self.v = self.rates(self.theta, self.omega)
        self.driven = [model.joints[model.getJointId(name)].idx_v for name in ("A", "E")]
        self.tau[self.driven] = self.torque
        one, other = (model.frames[model.getFrameId(name)] for name in ("c_of_link2", "c_of_link3"))
        loop = pinocchio.RigidConstraintModel(
            pinocchio.ContactType.CONTACT_3D, model, one.parentJoint, one.placement, other.parentJoint,
            other.placement, pinocchio.LOCAL)
        self.loops = pinocchio.StdVec_RigidConstraintModel([loop])
        self.data = model.createData()
        self.loops_data = pinocchio.StdVec_RigidConstraintData([loop.createData()])
        pinocchio.initConstraintDynamics(model, self.data, self.loops, self.loops_data)
        self.settings = pinocchio.ProximalSettings(1e-12, 1e-10, 20)

    def rates(self, theta, omega):
        """Of all joints."""
        motion, rates = self.arm.motion(theta, omega), np.zeros(self.model.nv)
        for name, rate in {"A": omega[0], "B": motion.omega2 - omega[0],
                           "E": omega[1], "D": motion.omega3 - omega[1]}.items():
            rates[self.model.joints[self.model.getJointId(name)].idx_v] = rate
        return rates

    def accelerations(self):
        return pinocchio.constraintDynamics(
            self.model, self.data, self.q, self.v, self.tau, self.loops, self.loops_data, self.settings)

    def derivatives(self):
        """Of all joints' accelerations by their angles, velocities and torques."""
        self.accelerations()
        return pinocchio.computeConstraintDynamicsDerivatives(
            self.model, self.data, self.loops, self.loops_data, self.settings)[:3]


def accelerations():
    """α1, α4 under torques, without friction."""
    chain = ClosedChain()

    def ours():
        return chain.arm.forward_dynamics(chain.theta, chain.omega, chain.torque).alpha

    difference = np.abs(chain.accelerations()[chain.driven] - ours()).max() / np.abs(ours()).max()
    return ("accelerations of the closed chain", "pin", chain.accelerations, ours, difference, 1e-6)


def derivatives():
    """Of α1, α4 by θ, ω and τ. Ours are those of τ, and of more, by θ, ω and α, solved for α. Those by ω and τ are compared:
    Pinocchio's by θ1 is not that of its accelerations."""
    chain = ClosedChain()
    alpha = chain.arm.forward_dynamics(chain.theta, chain.omega, chain.torque).alpha

    def ours():
        return chain.arm.derivatives(chain.theta, chain.omega, alpha, order=1)

    torques = ours().first[6:8]
    expected = np.linalg.solve(torques[:, 4:6], np.hstack([-torques[:, 2:4], np.eye(2)]))
    _, by_v, by_tau = (part[chain.driven] for part in chain.derivatives())
    turn = np.array([chain.rates(chain.theta, one) for one in np.eye(2)]).T
    found = np.hstack([by_v @ turn, by_tau[:, chain.driven]])
    difference = np.abs(found - expected).max() / np.abs(expected).max()
    return ("first derivatives of the chain's dynamics", "pin", chain.derivatives, ours, difference, 1e-6)


def inverse():
    """θ1 for a place of C. roboticstoolbox has no closed chains: it solves one leg, we both."""
    l1, l2 = ARM.lengths[:2]
    of = roboticstoolbox.ET
    leg = of.Rz() * of.tx(l1) * of.Rz() * of.tx(l2)
    place = np.eye(4)
    place[:2, 3] = [0.04, 0.2]
    mine = ARM.inverse(place[:2, 3])
    start = np.array([mine.theta[0] + 0.3, mine.theta2 - mine.theta[0] + 0.3])

    def theirs():
        return leg.ik_LM(place, q0=start, mask=[1, 1, 0, 0, 0, 0], tol=1e-16)

    def ours():
        return ARM.inverse([0.04, 0.2])

    difference = abs(theirs()[0][0] - mine.theta[0])
    return ("angles of one leg, ours of both, for a place", "roboticstoolbox-python", theirs, ours, difference, 1e-6)


def fastest():
    """The shortest time along a spline with limits of both joints' speed and acceleration, toppra's in joint angles."""
    limits = {"speed": [SPEED] * 2, "acceleration": [ACCELERATION] * 2}

    def ours():
        return ARM.plan(POINTS, limits=limits, spline=True)

    plan = ours()
    times = np.linspace(0.0, plan.time, 200)
    angles = plan.sample(times).theta
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(angles, axis=0), axis=1))])
    path = toppra.SplineInterpolator(along, angles)
    wide = [toppra.constraint.JointVelocityConstraint([[-SPEED, SPEED]] * 2),
            toppra.constraint.JointAccelerationConstraint([[-ACCELERATION, ACCELERATION]] * 2)]
    toppra.setup_logging("ERROR")

    def theirs():
        found = toppra.algorithm.TOPPRA(
            wide, path, gridpoints=np.linspace(0.0, along[-1], 201), parametrizer="ParametrizeConstAccel")
        return found.compute_trajectory(0, 0)

    difference = abs(theirs().duration - plan.time) / plan.time
    return ("the fastest motion along a spline", "toppra", theirs, ours, difference, 1e-2)


def smooth():
    """From rest to rest on a straight line of the joints. Ruckig knows no other paths; ours has the line by 41 of its points."""
    ends = ARM.inverse([POINTS[0], POINTS[2]]).theta
    points = ARM.forward(np.linspace(*ends, 41)).c
    limits = {"speed": [SPEED] * 2, "acceleration": [ACCELERATION] * 2}

    def ours():
        return ARM.plan(points, limits=limits, spline=True, jerk=JERK)

    wanted = ruckig.InputParameter(2)
    wanted.current_position, wanted.target_position = ends.tolist()
    wanted.max_velocity, wanted.max_acceleration, wanted.max_jerk = [SPEED] * 2, [ACCELERATION] * 2, [JERK] * 2
    wanted.synchronization = ruckig.Synchronization.Phase
    planner, found = ruckig.Ruckig(2), ruckig.Trajectory(2)

    def theirs():
        planner.calculate(wanted, found)
        return found.duration

    difference = abs(theirs() - ours().time) / theirs()
    return ("a line of the joints with limited jerk", "ruckig", theirs, ours, difference, 0.2)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--write", type=Path, metavar="FILE.md")
    given = parser.parse_args()
    rows, failed = [], []
    for task in (accelerations, derivatives, inverse, fastest, smooth):
        name, other, theirs, ours, difference, bound = task()
        spent, own = 1e6 * seconds(theirs), 1e6 * seconds(ours)
        rows.append(f"| {name} | {other} {version(other)} | {spent:.1f} | {own:.1f} | {spent / own:.2g} | {difference:.0e} |")
        print(rows[-1], flush=True)
        if not difference < bound:
            failed.append(name)
    if given.write and not failed:
        given.write.write_text(
            "# Beside other programs\n\n`python tests/peers/rivals.py --write docs/verify/rivals.md` makes this page.\n"
            f"{__doc__.split(chr(10) * 2)[2].strip()}\n\n"
            "| task | program | its time, µs | ours, µs | ratio | difference |\n|---|---|---|---|---|---|\n"
            + "\n".join(rows) + "\n", encoding="utf-8")
    sys.exit(f"rivals: other answers: {', '.join(failed)}" if failed else 0)


if __name__ == "__main__":
    main()
