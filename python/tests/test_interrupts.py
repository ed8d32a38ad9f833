"""Long calls check for signals while they run, so that Ctrl-C stops them.

Without such checks, any number of signals during a call leads to one call of the handler, after
the return. So a handler that was called several times was called during the call.
"""

import signal

import numpy as np
import pytest

from fivebar import _native

pytestmark = pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs POSIX timers")
ENOUGH = 3


@pytest.fixture
def alarms():
    """Signals every few milliseconds; the third raises `KeyboardInterrupt`, as Ctrl-C does."""
    seen = []

    def handle(number, frame):
        seen.append(number)
        if len(seen) == ENOUGH:
            raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, handle)
    yield lambda: signal.setitimer(signal.ITIMER_REAL, 0.005, 0.005)
    signal.setitimer(signal.ITIMER_REAL, 0)
    signal.signal(signal.SIGALRM, before)


def test_a_long_batch_is_broken_off(arm, alarms):
    rows = 3_000_000
    points = np.ascontiguousarray(np.broadcast_to((0.04, 0.2), (rows, 2)))
    right, left = -np.ones(rows, np.int8), np.ones(rows, np.int8)
    alarms()
    with pytest.raises(KeyboardInterrupt):
        _native.inverse(arm._robot, points, right, left, False)


def test_a_long_run_is_broken_off(arm, alarms):
    scenario = _native.Scenario.of_text(arm._robot, "G1 X10 F1200\nG4 S100")
    alarms()
    with pytest.raises(KeyboardInterrupt):
        scenario.run(origin=[0.03, 0.2], scale=None, seed=None, computed_torque=None, tolerance=None,
                     mismatch={}, compare_pid=False, by_cause=False)
