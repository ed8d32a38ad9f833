"""What results become, and what the package says of itself."""

import copy
import pickle
import re
import sys
from pathlib import Path

import numpy as np
import pytest

import fivebar

ROOT = Path(__file__).resolve().parents[2]


def test_the_version_is_that_of_the_package():
    cargo = (ROOT / "python/Cargo.toml").read_text()
    assert fivebar.__version__ == re.search(r'^version = "(.+)"', cargo, re.MULTILINE).group(1)


def test_an_arm_that_is_copied_or_pickled_equals_itself(arm):
    for again in (copy.copy(arm), copy.deepcopy(arm), pickle.loads(pickle.dumps(arm)),
                  fivebar.Arm.load("benchtop")):
        assert again == arm and hash(again) == hash(arm) and again is not arm
    other = fivebar.Arm.load("usp_2dof")
    assert other != arm and len({arm, other, copy.copy(arm)}) == 2 and arm != "benchtop"


@pytest.mark.parametrize("ask", [
    lambda arm: arm.inverse([0.1, 0.2, 0.3]),
    lambda arm: arm.inverse((0.04, 0.2), "up"),
    lambda arm: arm.forward(np.zeros((2, 2)), np.ones(3)),
    lambda arm: arm.derivatives((2.2, 0.9), order=3),
    lambda arm: fivebar.Plant(arm, mismatch={"mass": 1.0}),
    lambda arm: fivebar.Plant(arm, mismatch={"payload": -1e9}),
    lambda arm: arm.simulate("G1 X1", mismatch={"mass": 1.0}),
    lambda arm: arm.plan("{}"),
])
def test_what_is_refused_is_an_error_of_the_package_and_a_value_error(arm, ask):
    with pytest.raises(fivebar.FivebarError) as refused:
        ask(arm)
    assert isinstance(refused.value, ValueError)


def test_a_single_answer_is_that_of_a_batch_bit_for_bit(arm):
    random = np.random.default_rng(2)
    theta = np.array([2.2, 0.9]) + random.uniform(-0.3, 0.3, (50, 2))
    omega, alpha = random.uniform(-2.0, 2.0, (2, 50, 2))
    there = arm.forward(theta)
    batches = {
        "forward": (arm.forward, (theta,)),
        "motion": (arm.motion, (theta, omega, alpha)),
        "inverse_motion": (arm.inverse_motion, (there.c, omega, alpha)),
        "inverse": (arm.inverse, (there.c,)),
        "inverse_dynamics": (arm.inverse_dynamics, (theta, omega, alpha)),
        "forward_dynamics": (arm.forward_dynamics, (theta, omega, alpha)),
        "derivatives": (arm.derivatives, (theta, omega, alpha)),
    }
    for name, (ask, given) in batches.items():
        many = ask(*given)
        for row in range(50):
            for kind in (tuple, list, np.array, lambda pair: np.asarray([pair, pair]).T[:, 0]):
                one = ask(*(kind(argument[row].tolist()) for argument in given))
                assert type(one) is type(many)
                for field, array in many.to_dict().items():
                    own = getattr(one, field)
                    assert isinstance(own, np.ndarray) and own.dtype == array.dtype, (name, field)
                    assert own.shape == array.shape[1:] and np.array_equal(own, array[row]), (name, field)


def test_first_derivatives_alone_are_those_of_both_orders(arm):
    both, first = (arm.derivatives((2.2, 0.9), (1.0, 2.0), (3.0, 4.0), order=n) for n in (2, 1))
    assert np.array_equal(first.value, both.value) and first.second is None
    assert np.allclose(first.first, both.first, rtol=0.0, atol=1e-12 * np.abs(both.first).max())


def test_results_become_tables(arm):
    pandas = pytest.importorskip("pandas")
    found = arm.inverse_dynamics([[[2.2, 0.9], [2.1, 1.0], [2.0, 1.1]]] * 2)
    table = found.to_pandas()
    assert isinstance(table, pandas.DataFrame) and len(table) == 6
    assert table["torque_4"].tolist() == found.torque[..., 1].ravel().tolist()
    assert table["mass_matrix_1_4"].tolist() == found.mass_matrix[..., 0, 1].ravel().tolist()
    assert table["reaction_b_y"].tolist() == found.reaction.b[..., 1].ravel().tolist()
    slopes = arm.derivatives((2.2, 0.9), (1.0, 2.0), order=1)
    assert slopes.to_pandas()["first_vx_theta4"].tolist() == [slopes.first[2, 1]]
    one = arm.inverse((0.04, 0.2))
    assert one.to_pandas()["theta1"].tolist() == [one.theta1]
    assert set(found.to_dict()) == set(type(found).FIELDS)


def test_results_become_datasets(arm):
    pytest.importorskip("xarray")
    found = arm.derivatives([[2.2, 0.9], [2.1, 1.0]])
    data = found.to_xarray()
    assert data["first"].dims == ("row_0", "quantity", "variable")
    picked = data["first"].sel(quantity="torque1", variable="alpha1").values
    assert picked.tolist() == found.first[:, 6, 4].tolist()
    trace = arm.simulate("G1 X5 F3000", origin=(0.03, 0.2)).trace
    data = trace.to_xarray()
    assert data["angle"].dims == ("time", "joint") and data["time"].values.tolist() == trace.time.tolist()
    assert len(trace.to_pandas()) == len(trace.time)


def test_results_are_plotted(arm):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    figure = arm.forward(np.linspace([2.2, 0.9], [2.0, 1.1], 20)).plot()
    assert [chart.get_ylabel() for chart in figure.axes][:2] == ["c", "theta2"]
    assert len(figure.axes[0].lines) == 2 and len(figure.axes[0].lines[0].get_xdata()) == 20
    matplotlib.pyplot.close(figure)


@pytest.mark.parametrize(("module", "ask"), [
    ("pandas", "to_pandas"), ("xarray", "to_xarray"), ("matplotlib.pyplot", "plot"),
])
def test_a_library_that_is_missing_is_named(arm, monkeypatch, module, ask):
    monkeypatch.setitem(sys.modules, module, None)
    library = module.partition(".")[0]
    with pytest.raises(fivebar.FivebarError, match=f"pip install {library}"):
        getattr(arm.forward((2.2, 0.9)), ask)()


def test_an_arm_without_tolerances_is_told_of():
    arm = fivebar.Arm(l1=0.1, l2=0.16, base=0.08)
    with pytest.warns(UserWarning, match=r"arm: the file has no \[tolerance\], so all deviations are 0"):
        found = arm.accuracy([0.04, 0.2], samples=100)
    assert found["position_sd_m"] == [0.0, 0.0]
    with pytest.warns(UserWarning, match="tolerance"):
        arm.accuracy_map(region=[0.0, 0.15, 0.05, 0.2])


def test_a_cluster_without_workers_is_told_of():
    pytest.importorskip("dask.distributed")
    from fivebar import _many

    class NoWorkers:
        """A client that nobody helps."""

        def wait_for_workers(self, count, timeout):
            raise TimeoutError(count, timeout)

        def nthreads(self):
            raise InterruptedError

    with pytest.warns(UserWarning, match="no worker for 5 s"), pytest.raises((InterruptedError, ValueError)):
        list(_many.completed(lambda index: index, [0], NoWorkers()))
