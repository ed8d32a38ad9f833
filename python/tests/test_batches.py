"""Batches of any shape, type and size, against the same rows one by one."""

import multiprocessing
import pickle
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import fivebar
from fivebar import _native

ROOT = Path(__file__).resolve().parents[2]


def test_a_batch_has_the_bits_of_single_answers(arm, poses):
    batch = arm.inverse_motion(poses, (0.3, -0.2), (4.0, 5.0))
    torques = arm.inverse_dynamics(batch.theta, batch.omega, batch.alpha, batch.assembly)
    for row in range(0, len(poses), 501):
        one = arm.inverse_motion(poses[row], (0.3, -0.2), (4.0, 5.0))
        assert one.theta1.shape == ()
        for name in ("theta", "omega", "alpha", "theta2", "omega3", "alpha2", "assembly"):
            assert np.array_equal(getattr(one, name), getattr(batch, name)[row]), name
        torque = arm.inverse_dynamics(one.theta, one.omega, one.alpha, one.assembly)
        assert np.array_equal(torque.torque, torques.torque[row])
        assert np.array_equal(torque.reaction.d, torques.reaction.d[row])


@pytest.mark.parametrize("rows", [8_191, 8_192, 8_193, 300_001])
def test_every_row_of_a_divided_batch_is_its_own(arm, poses, rows):
    points = np.resize(poses, (rows, 2))
    expected = np.resize(arm.inverse(poses).theta, (rows, 2))
    answer = arm.inverse(points)
    assert answer.ok.all()
    assert np.array_equal(answer.theta, expected)


def test_forward_and_inverse_undo_each_other_on_every_branch(arm, poses):
    for elbow1 in ("left", "right"):
        for elbow4 in ("left", "right"):
            there = arm.inverse(poses, elbow1, elbow4)
            assert there.ok.sum() > len(poses) // 2
            back = arm.forward(there.theta, there.assembly)
            assert np.array_equal(back.ok, there.ok)
            assert np.allclose(back.c[there.ok], poses[there.ok], rtol=0, atol=1e-10)
            assert np.all(back.elbow1[there.ok] == fivebar.Side[elbow1.upper()])
            assert np.all(back.elbow4[there.ok] == fivebar.Side[elbow4.upper()])


def test_motion_is_the_derivative_of_position(arm, poses):
    step = 1e-6
    theta = arm.inverse(poses).theta
    ahead = arm.forward(theta + (step, -2 * step)).c
    behind = arm.forward(theta - (step, -2 * step)).c
    slope = (ahead - behind) / (2 * step)
    motion = arm.motion(theta, (1.0, -2.0))
    assert np.abs(slope).max() > 0.1
    assert np.allclose(motion.c_velocity, slope, rtol=0, atol=1e-6)


def test_dynamics_undo_each_other_and_balance_the_power(arm, poses):
    rng = np.random.default_rng(3)
    theta = arm.inverse(poses).theta
    omega, alpha, force = (rng.normal(size=theta.shape) * size for size in (3.0, 50.0, 2.0))
    dynamics = arm.inverse_dynamics(theta, omega, alpha, external_force=force)
    back = arm.forward_dynamics(theta, omega, dynamics.torque, external_force=force)
    assert np.allclose(back.alpha, alpha, rtol=1e-9, atol=1e-8)
    whole = np.einsum("nij,nj->ni", dynamics.mass_matrix, alpha) + dynamics.bias_torque
    assert np.allclose(whole, dynamics.torque, rtol=1e-9, atol=1e-9)
    # The change of the torques by a force on C has the power of that force.
    free = arm.inverse_dynamics(theta, omega, alpha)
    velocity = arm.motion(theta, omega).c_velocity
    lost = np.sum((free.torque - dynamics.torque) * omega, axis=-1)
    assert np.allclose(lost, np.sum(force * velocity, axis=-1), rtol=1e-8, atol=1e-9)


def test_shapes_broadcast(arm):
    grid = np.stack(np.meshgrid(np.linspace(0, 0.08, 5), np.linspace(0.15, 0.22, 4)), axis=-1)
    answer = arm.inverse(grid)
    assert answer.theta1.shape == answer.status.shape == (4, 5)
    assert answer.theta.shape == (4, 5, 2)
    dynamics = arm.inverse_dynamics(answer.theta, external_force=(1.0, 0.0))
    assert dynamics.mass_matrix.shape == (4, 5, 2, 2)
    assert dynamics.reaction.a.shape == (4, 5, 2)
    four = arm.inverse((0.04, 0.2), [["left"], ["right"]], ["left", "right"])
    assert four.theta1.shape == (2, 2)
    assert len(np.unique(four.theta.reshape(-1, 2), axis=0)) == 4
    one = arm.inverse((0.04, 0.2))
    for name in ("theta1", "theta4", "theta2", "theta3", "assembly", "status"):
        assert isinstance(getattr(one, name), np.ndarray)
        assert getattr(one, name).shape == ()
    with pytest.raises(ValueError, match=r"do not go together: theta \(3,\), omega \(4,\)"):
        arm.motion(np.zeros((3, 2)), np.zeros((4, 2)))


@pytest.mark.parametrize("convert", [
    lambda p: p.tolist(),
    lambda p: np.asfortranarray(p),
    lambda p: np.repeat(p, 2, axis=0)[::2],
    lambda p: p[::-1][::-1],
    lambda p: p.astype(">f8"),
    lambda p: p.astype(object).astype(float),
    lambda p: np.frombuffer(b"\0" + p.tobytes(), np.uint8)[1:].view(np.float64).reshape(-1, 2),
    lambda p: np.lib.stride_tricks.as_strided(p, writeable=False),
])
def test_any_layout_of_the_same_numbers_gives_the_same_bits(arm, poses, convert):
    points = np.ascontiguousarray(poses[:100])
    assert np.array_equal(arm.inverse(convert(points)).theta, arm.inverse(points).theta)


def test_other_kinds_of_numbers_are_taken_at_their_value(arm):
    half = np.array([[0.0625, 0.1875]], dtype=np.float16)
    assert arm.inverse(half).ok.all()
    assert np.array_equal(arm.inverse(half).theta, arm.inverse([[0.0625, 0.1875]]).theta)
    whole = arm.forward(np.array([2, 1]), strict=True)
    assert whole.c.tolist() == arm.forward([2.0, 1.0]).c.tolist()


def test_empty_batches_are_answered_empty(arm):
    assert arm.inverse([], strict=True).theta.shape == (0, 2)
    for shape in ((0, 2), (3, 0, 2)):
        assert arm.inverse(np.empty(shape), strict=True).theta.shape == shape
    assert arm.inverse_dynamics([]).mass_matrix.shape == (0, 2, 2)


def test_arguments_are_left_as_they_are(arm, poses):
    points = poses.copy()
    points.flags.writeable = False
    arm.inverse(points)
    assert np.array_equal(points, poses)


def test_threads_ask_at_once(arm, poses):
    expected = arm.inverse(poses).theta
    answers = [None] * 4

    def ask(index):
        answers[index] = arm.inverse(poses).theta

    threads = [threading.Thread(target=ask, args=(index,)) for index in range(len(answers))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(answer, expected) for answer in answers)


def test_other_threads_run_during_a_large_batch(arm):
    points = np.ascontiguousarray(np.broadcast_to((0.04, 0.2), (3_000_000, 2)))
    right, left = -np.ones(len(points), np.int8), np.ones(len(points), np.int8)
    turns, done = [0], threading.Event()

    def count():
        while not done.wait(1e-4):
            turns[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    before = turns[0]
    _native.inverse(arm._robot, points, right, left, False)
    during = turns[0] - before
    done.set()
    thread.join()
    # If the lock were held, the other thread would run at the beginning and the end only.
    assert during > 2


def test_arms_can_be_sent_to_other_processes(arm, poses):
    file = (ROOT / "host/files/robots/usp_2dof.toml").read_text(encoding="utf-8")
    for original in (arm, fivebar.Arm.from_toml(file)):
        copy = pickle.loads(pickle.dumps(original))
        assert copy.name == original.name
        assert np.array_equal(copy.inverse(poses).theta, original.inverse(poses).theta)


def large_batch_in_child(points, answers):
    answers.put(float(fivebar.Arm.load("benchtop").inverse(points).theta.sum()))


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no fork")
@pytest.mark.filterwarnings("ignore:This process.*multi-threaded:DeprecationWarning")
def test_a_forked_process_answers_large_batches_too(arm, poses):
    expected = float(arm.inverse(poses).theta.sum())
    context = multiprocessing.get_context("fork")
    answers = context.Queue()
    child = context.Process(target=large_batch_in_child, args=(poses, answers))
    child.start()
    assert answers.get(timeout=30) == expected
    child.join(timeout=30)
    assert child.exitcode == 0
