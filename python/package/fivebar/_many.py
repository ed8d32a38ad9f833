"""Independent tasks on all cores, or on the workers of a cluster."""

from __future__ import annotations

import os
import uuid
import warnings
from asyncio import TimeoutError as AsyncTimeoutError
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from typing import Any, Callable, Dict, Iterator, Optional, Sequence, Tuple, TypeVar

Result = TypeVar("Result")
#: How often a task is tried again after an error. A lost worker's tasks go to others anyway.
RETRIES = 3
#: Tasks that wait for each thread of the cluster, so that it never waits for the next one.
AHEAD = 3
#: Seconds after which a cluster without workers is told of.
PATIENCE = 5


def cores() -> int:
    """The cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def completed(
    call: Callable[[int], Result], indices: Sequence[int], client: Optional[Any]
) -> Iterator[Tuple[int, Result]]:
    """The result of the call for each index, in the order in which they are done.

    client: a ``dask.distributed.Client``; without one, threads of this process.
    """
    if client is None:
        yield from _on_threads(call, indices)
    else:
        yield from _on_cluster(call, indices, client)


def _on_threads(
    call: Callable[[int], Result], indices: Sequence[int]
) -> Iterator[Tuple[int, Result]]:
    with ThreadPoolExecutor(min(cores(), max(len(indices), 1))) as pool:
        waiting: Dict[Future[Result], int] = {pool.submit(call, i): i for i in indices}
        try:
            while waiting:
                done, _ = wait(waiting, return_when=FIRST_COMPLETED)
                for future in done:
                    yield waiting.pop(future), future.result()
        finally:
            for future in waiting:
                future.cancel()


def _on_cluster(
    call: Callable[[int], Result], indices: Sequence[int], client: Any
) -> Iterator[Tuple[int, Result]]:
    from dask.distributed import as_completed

    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except (TimeoutError, AsyncTimeoutError):
        warnings.warn(
            f"the cluster has had no worker for {PATIENCE} s: the work begins when there is one (dask worker ADDRESS)",
            stacklevel=2,
        )
    name = f"fivebar-{uuid.uuid4().hex}"
    rest = iter(indices)
    waiting: Dict[str, int] = {}
    futures = as_completed([])

    def submit() -> None:
        """Submits tasks as long as there are fewer than the cluster's threads need."""
        threads = max(sum(client.nthreads().values()), 1)
        while len(waiting) < AHEAD * threads:
            index = next(rest, None)
            if index is None:
                return
            key = f"{name}-{index}"
            waiting[key] = index
            # `pure`: the same call may be made again where a worker was lost.
            futures.add(client.submit(call, index, key=key, retries=RETRIES, pure=True))

    try:
        submit()
        for future in futures:
            # A result leaves the cluster's memory with its future.
            yield waiting.pop(future.key), future.result()
            submit()
    finally:
        futures.clear()
