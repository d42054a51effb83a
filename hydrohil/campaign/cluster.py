"""The Dask cluster that computes: one process a core on this machine, or the cluster at an address."""

import logging
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import dask
from distributed import Client, LocalCluster

from hydrohil.shared.errors import HydrohilError
from hydrohil.shared.exit_status import EXIT_TRANSPORT

_CONNECT_S, _WORKERS_S = 10.0, 30.0
_QUIET = {  # switched off: what a scheduler and workers do beside the work (sampled stacks, ticks, a page)
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.tick.limit": "1h",
    "distributed.worker.memory.target": False,
    "distributed.worker.memory.spill": False,
    "distributed.worker.memory.pause": False,
    "distributed.worker.memory.terminate": False,
}


class ClusterError(HydrohilError):
    """There are no workers, or they were lost; one line that says what to do."""

    exit_status = EXIT_TRANSPORT


@contextmanager
def cluster(workers: int, address: str | None) -> Iterator[Client]:
    """A client of the cluster at `address`, or of `workers` processes that end with it. Raises ClusterError."""
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    with _local(workers) if address is None else _connected(address) as client:
        yield client


@contextmanager
def _local(workers: int) -> Iterator[Client]:
    with dask.config.set(_QUIET):
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # Ctrl-C ends their parent, and so them
        try:
            local = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                dashboard_address=None,
                scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},  # any: None is 8787, and a warning if it is taken
                memory_limit=0,
                silence_logs=logging.CRITICAL,
            )
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        with local, Client(local, set_as_default=False) as client:
            yield client


@contextmanager
def _connected(address: str) -> Iterator[Client]:
    try:
        client = Client(address, timeout=_CONNECT_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as reason:
        raise ClusterError(
            f"no Dask scheduler at {address} ({reason}): start one with `dask scheduler` and workers with "
            "`dask worker ADDRESS --nworkers auto --nthreads 1`"
        ) from None
    with client:
        try:
            client.wait_for_workers(1, timeout=_WORKERS_S)
        except TimeoutError:
            raise ClusterError(f"the scheduler at {address} has no workers: start some with `dask worker {address}`") from None
        yield client


def hosts(client: Client) -> list[str]:
    """The address of one worker on each host."""
    known: dict[str, Any] = client.scheduler_info(n_workers=-1)["workers"]
    return list({worker["host"]: address for address, worker in known.items()}.values())


def slots(client: Client) -> int:
    """Tasks that the cluster can do at once."""
    return sum(client.nthreads().values())
