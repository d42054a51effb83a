"""Jobs on several processes. What is compiled is compiled once, before the others need it."""

import multiprocessing
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import ParamSpec, TypeVar

from hydrohil.reproduction.jobs import Done, Job, imported, warm, work
from hydrohil.shared.errors import HydrohilError

Arguments = ParamSpec("Arguments")
Answer = TypeVar("Answer")


class LostWorkerError(HydrohilError):
    """A process of the pool has ended by itself: out of memory, or killed."""


@contextmanager
def _deaf() -> Iterator[None]:
    """Spawn processes that Ctrl-C does not reach: the terminal sends it to all, the one that started them decides.

    They inherit the blocked signal. Here it may arrive in another thread all the same, so it is remembered, and raised after.
    """
    heard: list[int] = []
    handler = signal.signal(signal.SIGINT, lambda number, _: heard.append(number))
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        signal.signal(signal.SIGINT, handler)
    if heard:
        raise KeyboardInterrupt


class Pool:
    """Processes that are spawned when there is work for them."""

    def __init__(self, workers: int) -> None:
        """None is started yet."""
        self._executor = ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))
        self._before = set(multiprocessing.active_children())

    def submit(
        self, function: Callable[Arguments, Answer], *arguments: Arguments.args, **named: Arguments.kwargs
    ) -> Future[Answer]:
        """Let a process do it, which may have to be spawned first."""
        with _deaf():
            return self._executor.submit(function, *arguments, **named)

    def run(self, jobs: Sequence[Job]) -> Iterator[Done]:
        """What each job found, as it comes. Raises BrokenProcessPool."""
        for future in as_completed([self.submit(work, job) for job in jobs]):
            yield future.result()

    def kill(self) -> None:
        """End every process at once."""
        for process in set(multiprocessing.active_children()) - self._before:
            process.terminate()

    def close(self) -> None:
        """Wait for the processes to end."""
        self._executor.shutdown(wait=True, cancel_futures=True)


@contextmanager
def pool(workers: int) -> Iterator[Pool]:
    """`workers` processes; one compiles while the others import. Killed on an exception. Raises LostWorkerError."""
    made = Pool(workers)
    try:
        ready = made.submit(warm)
        for _ in range(workers - 1):
            made.submit(imported)
        ready.result()
        yield made
    except BrokenProcessPool:
        raise LostWorkerError("a worker process has died: is there memory enough? try --workers 1") from None
    except BaseException:
        made.kill()
        raise
    finally:
        made.close()
