"""A process that `os.fork` made, as `multiprocessing` does on Linux, computes as its parent does."""

import os
import signal

import pytest

import fivebar

pytestmark = [
    pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork"),
    # Python warns of forks where there are threads: that is what is tested.
    pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning"),
]

#: Longest that a child may take [s]: it waits for ever, or takes less than a second.
TIMEOUT_READS = 120
SPECIFICATION = """
symmetric = true
base = [0.0, 0.0]
link_sum = 0.3
[area]
kind = "annulus"
[require]
dexterity = 0.5
[objective]
maximise = "size"
"""
#: Every kind of work that is done on all cores.
WORK = {
    "workspace": lambda arm: arm.workspace(4e-3),
    "margins": lambda arm: arm.margins(),
    "accuracy": lambda arm: arm.accuracy([0.04, 0.2], samples=50_000),
    "accuracy_map": lambda arm: arm.accuracy_map(region=(0.02, 0.18, 0.06, 0.22)),
    "clearance": lambda arm: arm.clearance([10e-6, 20e-6], "G1 X1 F3000", origin=(0.03, 0.2)),
    "by_cause": lambda arm: arm.simulate("G1 X1 F3000", origin=(0.03, 0.2), by_cause=True),
    "linkage": lambda arm: fivebar.linkage_accuracy("loose_four_bar", samples=50_000),
    "design": lambda arm: fivebar.design(SPECIFICATION),
    "batch": lambda arm: arm.inverse([(0.04, 0.2)] * 100_000),
}


def in_child(call):
    """The exit status of a child that makes a call: 0 if it returns, negative if it was ended."""
    child = os.fork()
    if child == 0:
        status = 1
        try:
            signal.alarm(TIMEOUT_READS)
            call()
            status = 0
        finally:
            os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


@pytest.mark.parametrize("name", WORK)
def test_a_child_of_a_process_that_has_computed_computes_too(arm, name):
    call = WORK[name]
    call(arm)

    def call_and_fork():
        call(arm)
        assert in_child(lambda: call(arm)) == 0

    assert in_child(call_and_fork) == 0
    # The parent's threads are as they were.
    call(arm)
