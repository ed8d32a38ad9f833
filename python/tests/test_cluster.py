"""Studies on many machines: here processes of this one."""

import json
import os
import signal
import subprocess

import pytest

import fivebar

distributed = pytest.importorskip(
    "dask.distributed", reason="studies on a cluster need Dask: pip install 'fivebar[cluster]'")
parquet = pytest.importorskip("pyarrow.parquet", reason="candidates as parquet need pyarrow")

SPECIFICATION = """
symmetric = true
base = [0.0, 0.0]
link_sum = 0.3
[area]
kind = "annulus"
[require]
dexterity = 0.4
[objective]
maximise = "size"
front = 3
starts = 2
"""


@pytest.fixture(scope="module")
def local():
    return fivebar.design(SPECIFICATION, seed=5)


# The cluster's own notes on lost workers and closed connections are not the package's warnings.
pytestmark = pytest.mark.filterwarnings("ignore")


def cluster(workers):
    return distributed.LocalCluster(n_workers=workers, threads_per_worker=1, processes=True,
                                    dashboard_address=None, silence_logs=50)


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_any_number_of_workers_gives_the_bits_of_this_process(local, workers):
    with cluster(workers) as machines, distributed.Client(machines) as client:
        seen = []
        found = fivebar.design(SPECIFICATION, seed=5, client=client,
                               progress=lambda done, of: seen.append((done, of)))
    assert found == local
    assert seen == [(done, 6) for done in range(1, 7)]


def test_a_worker_that_is_killed_changes_no_bit(local, tmp_path):
    with cluster(2) as machines, distributed.Client(machines) as client:
        pids = list(client.run(os.getpid).values())
        assert len(set(pids) | {os.getpid()}) == 3

        def kill(done, of):
            # In the middle of the next searches, one of them its own.
            if done == 2:
                os.kill(pids[0], signal.SIGKILL)

        found = fivebar.design(SPECIFICATION, seed=5, client=client, candidates=tmp_path,
                               progress=kill)
        assert pids[0] not in client.run(os.getpid).values()
    assert found == local
    # The candidates are those of the same searches here.
    here = tmp_path / "here"
    fivebar.design(SPECIFICATION, seed=5, candidates=here)
    for index in range(6):
        name = f"search-{index:06}.parquet"
        there = parquet.read_table(tmp_path / name)
        assert there.equals(parquet.read_table(here / name))
    assert sorted(path.name for path in here.iterdir()) == sorted(
        path.name for path in tmp_path.glob("*.parquet"))
    best = found.figures["best"]["size"]
    first = parquet.read_table(here / "search-000000.parquet").to_pydict()
    assert best == pytest.approx(max(first["score"]), rel=1e-4)
    assert min(first["required_dexterity"]) == 0.4


def test_samples_of_tolerances_have_the_bits_of_this_process(arm):
    options = {"force": (1.0, -2.0), "samples": 300_001, "seed": 4}
    seen = []
    with cluster(2) as machines, distributed.Client(machines) as client:
        found = arm.accuracy((0.04, 0.2), client=client, **options,
                             progress=lambda done, of: seen.append((done, of)))
        with pytest.warns(UserWarning, match="tolerance"):
            bare = fivebar.Arm.load("duet").accuracy((0.1, 0.15), client=client, samples=5000)
    assert found == arm.accuracy((0.04, 0.2), **options)
    with pytest.warns(UserWarning, match="tolerance"):
        assert bare == fivebar.Arm.load("duet").accuracy((0.1, 0.15), samples=5000)
    assert seen == [(done, 5) for done in range(1, 6)]


def test_a_study_goes_on_where_it_was_stopped(local, program, tmp_path):
    class Stopped(Exception):
        pass

    def stop(done, of):
        if done == 2:
            raise Stopped

    with pytest.raises(Stopped):
        fivebar.design(SPECIFICATION, seed=5, out=tmp_path, progress=stop)
    kept = json.loads((tmp_path / "searches.json").read_text())
    assert sum(found is not None for found in kept["found"]) == 2
    seen = []
    found = fivebar.design(SPECIFICATION, seed=5, out=tmp_path,
                           progress=lambda done, of: seen.append(done))
    assert found == local and seen == [3, 4, 5, 6]
    assert (tmp_path / "best.toml").read_text(encoding="utf-8") == found.robot_toml
    # What is kept is used, by the program, too: the second design in place of the first.
    kept = json.loads((tmp_path / "searches.json").read_text())
    kept["found"][:2] = kept["found"][2:4]
    (tmp_path / "searches.json").write_text(json.dumps(kept))
    used = fivebar.design(SPECIFICATION, seed=5, out=tmp_path)
    assert used.figures["best"] == local.figures["front"][1]
    file = tmp_path / "study.toml"
    file.write_text(SPECIFICATION)
    done = subprocess.run([program, "design", file, "--seed=5", "--json", "--out", tmp_path],
                          capture_output=True, text=True, check=True)
    assert json.loads(done.stdout)["front"] == used.figures["front"]
    # Another seed is another study.
    assert fivebar.design(SPECIFICATION, seed=6, out=tmp_path).figures["front"] != used.figures["front"]
