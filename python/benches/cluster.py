"""The time of a study on a cluster of processes beside the same study in this process.

    python python/benches/cluster.py [--write docs/verify/cluster.md]

Runs take turns, so that other work of the machine slows both alike; each figure is the best of them.
"""

import argparse
import os
import platform
import time
from pathlib import Path

import fivebar
from dask.distributed import Client, LocalCluster

RUNS = 2
WORKERS = 2
SPECIFICATION = """
symmetric = true
base = [0.0, 0.1]
link_sum = 0.3
[area]
kind = "square"
[require]
dexterity = 0.4
[objective]
maximise = "size"
front = 6
starts = 2
"""
#: Candidates of one search: 48 in the first generation and in each of 120, and in 1 + 40 beside the best.
CANDIDATES = 48 * (121 + 41)
#: Candidates of the study that is planned.
PLANNED = 10_000_000


def timed(client=None):
    """The time of a study and of the processors [s], and its answer."""
    def busy():
        others = client.run(time.process_time).values() if client else ()
        return time.process_time() + sum(others)

    started, before = time.perf_counter(), busy()
    found = fivebar.design(SPECIFICATION, client=client)
    return (time.perf_counter() - started, busy() - before), found


def measured():
    local, remote, answers = [], [], []
    with LocalCluster(n_workers=WORKERS, threads_per_worker=1, dashboard_address=None) as machines:
        with Client(machines) as client:
            client.run(__import__, "fivebar")
            for _ in range(RUNS):
                for times, where in ((local, None), (remote, client)):
                    spent, found = timed(where)
                    times.append(spent)
                    answers.append(found)
    assert all(found == answers[0] for found in answers), "the bits differ"
    return [tuple(map(min, zip(*times))) for times in (local, remote)]


def page(local, remote):
    searches = 12
    evaluations = searches * CANDIDATES
    per_candidate = remote[1] / evaluations
    hours = PLANNED * per_candidate / 3600
    overhead = [100 * (there / here - 1) for here, there in zip(local, remote)]
    return f"""# Studies on many machines

`python python/benches/cluster.py --write docs/verify/cluster.md` makes this page. It does one study of {searches} searches,
{evaluations:,} candidates, in one process with {WORKERS} threads and by Dask on {WORKERS} processes of the same machine
({os.cpu_count()} cores, {platform.machine()}, Python {platform.python_version()}), {RUNS} times in turn, and compares the bits.

| | time | time of the processors |
|---|---|---|
| in one process | {local[0]:.1f} s | {local[1]:.1f} s |
| on {WORKERS} workers, with the client and the scheduler | {remote[0]:.1f} s | {remote[1]:.1f} s |
| overhead | {overhead[0]:.1f} % | {overhead[1]:.1f} % |

The load of the machine while it ran was {os.getloadavg()[0]:.0f}: where this is more than the number of its cores, only the
time of the processors says something.

## A study of 10⁷ candidates

A search examines up to {CANDIDATES:,} candidates of an arm with equal legs, so the study has {-(-PLANNED // CANDIDATES):,} searches: for
example `front = 20` and `starts = {-(-PLANNED // CANDIDATES // 20)}`. The candidates of this page cost {1e3 * per_candidate:.2f} ms of a core each, whence

| | |
|---|---|
| work | {hours:.1f} core hours |
| on this machine | {hours / WORKERS:.1f} h |
| on 64 cores | {60 * hours / 64:.0f} min |
| results of the searches, which the client keeps | {-(-PLANNED // CANDIDATES) * 0.3 / 1000:.1f} MB |
| candidates as parquet, where wanted | {PLANNED * 80 / 1e9:.1f} GB at most |

Unlike legs have six numbers in place of three: a search then has twice the candidates. A task is one search, seconds long;
the client sends three for each thread ahead, and takes the results as they come. A worker may come or go at any time.
"""


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--write", type=Path, metavar="FILE.md")
    write = parser.parse_args().write
    text = page(*measured())
    if write:
        write.write_text(text, encoding="utf-8")
    print(text)
