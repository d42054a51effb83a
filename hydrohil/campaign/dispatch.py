"""Trials to workers in chunks, and their rows to the store as they arrive."""

from collections.abc import Callable
from itertools import islice

from distributed import CancelledError, Client, KilledWorker, as_completed
from distributed.comm import CommClosedError

from hydrohil.campaign.cluster import ClusterError, hosts, slots
from hydrohil.campaign.store import Store
from hydrohil.campaign.trials import count
from hydrohil.campaign.work import Chunk, OtherSourcesError, Row, chunks, warm, work
from hydrohil.experiment.experiment import Experiment

TIMES_REAL_TIME = 900.0  # of one core, roughly: for the size of a chunk and the time that it takes
OVERHEAD_S = 0.002  # of a trial, beside its kernel
CHUNK_S = 2.0  # of work in a task: far more than the few ms that a scheduler takes; a kill loses no more than that of each worker
MOST_PARTS = 10_000  # files of a campaign: of one that takes many hours a task is longer
AHEAD = 2  # chunks a worker has waiting
LOST = "what is finished is kept, and the same command goes on"
Kept = Callable[[list[Row]], None]


def trial_s(experiment: Experiment) -> float:
    """About how long a trial takes one core."""
    return OVERHEAD_S + (experiment.duration_s + experiment.plant.bias_s) / TIMES_REAL_TIME


def pending(store: Store) -> list[int]:
    """Trials that no part has."""
    kept = set(store.kept().column("trial").to_pylist())
    return [number for number in range(count(store.plan.campaign)) if number not in kept]


def chunk_size(one_trial_s: float, trials: int, workers: int) -> int:
    """Trials in a task: about two seconds of work, not too many files, and several tasks for every worker."""
    return max(1, min(max(int(CHUNK_S / one_trial_s), trials // MOST_PARTS), trials // (4 * workers)))


def run_trials(client: Client, store: Store, numbers: list[int], one_trial_s: float, kept: Kept) -> None:
    """Run the trials of these numbers; `kept` gets the rows of each chunk that the store has kept. Raises ClusterError."""
    try:
        for host in hosts(client):  # one worker compiles for all of its host
            client.submit(warm, store.plan, workers=[host], pure=False).result()
        size = chunk_size(one_trial_s, len(numbers), max(1, slots(client)))
        _run_chunks(client, store, chunks(numbers, size), kept)
    except OtherSourcesError as reason:
        raise ClusterError(f"a worker runs another version ({reason}): install this one there, and start it again") from None
    except ModuleNotFoundError as reason:
        raise ClusterError(f"a worker lacks this project or a package of it ({reason}): install it there") from None
    except KilledWorker:
        raise ClusterError(f"workers die of the same chunk: is there memory enough? try --workers 1; {LOST}") from None
    except (CancelledError, CommClosedError, OSError) as reason:
        raise ClusterError(f"the cluster was lost ({str(reason) or type(reason).__name__}): {LOST}") from None


def _run_chunks(client: Client, store: Store, todo: list[tuple[int, ...]], kept: Kept) -> None:
    waiting = (client.submit(work, Chunk(store.plan, store.sources, numbers), pure=False) for numbers in todo)
    submitted = as_completed(list(islice(waiting, (1 + AHEAD) * max(1, slots(client)))), loop=client.loop)
    for future in submitted:
        rows = future.result()
        submitted.update(islice(waiting, 1))
        store.keep(rows)
        kept(rows)
