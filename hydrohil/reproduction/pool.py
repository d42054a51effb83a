"""Jobs on several processes. The loop is compiled once, by one of them, before the others load it."""

import multiprocessing
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import ParamSpec, TypeVar

from hydrohil.reproduction.jobs import Done, Job, imported, warm, work
from hydrohil.shared.errors import HydrohilError
from hydrohil.shared.exit_status import EXIT_TRANSPORT

Arguments = ParamSpec("Arguments")
Answer = TypeVar("Answer")


class LostWorkerError(HydrohilError):
    """A process of the pool has ended by itself: out of memory, or killed."""

    exit_status = EXIT_TRANSPORT


@contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Spawn processes that ignore Ctrl-C. The terminal sends it to all of them; this process decides what then happens.

    They inherit the blocked signal. In this process another thread may still receive it, so a handler remembers it and
    KeyboardInterrupt is raised when the processes have been spawned.
    """
    interrupts: list[int] = []
    handler = signal.signal(signal.SIGINT, lambda number, _: interrupts.append(number))
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        signal.signal(signal.SIGINT, handler)
    if interrupts:
        raise KeyboardInterrupt


class Pool:
    """Processes that are spawned when there is work for them."""

    def __init__(self, workers: int) -> None:
        """No process is started yet."""
        self._executor = ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))
        self._before = set(multiprocessing.active_children())

    def submit(
        self, function: Callable[Arguments, Answer], *arguments: Arguments.args, **named: Arguments.kwargs
    ) -> Future[Answer]:
        """Call `function` in a process, which is spawned if there are not enough yet."""
        with _interrupts_blocked():
            return self._executor.submit(function, *arguments, **named)

    def run(self, jobs: Sequence[Job]) -> Iterator[Done]:
        """What each job found, in the order in which they end. Raises BrokenProcessPool."""
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
    """`workers` processes: one compiles while the others import. An exception ends them all. Raises LostWorkerError."""
    pool = Pool(workers)
    try:
        ready = pool.submit(warm)
        for _ in range(workers - 1):
            pool.submit(imported)
        ready.result()
        yield pool
    except BrokenProcessPool:
        raise LostWorkerError("a worker process has died: is there memory enough? try --workers 1") from None
    except BaseException:
        pool.kill()
        raise
    finally:
        pool.close()
