"""One step at a time, in the thread that has cause for it: no other thread is woken to step, and no receiving thread waits."""

import threading
from collections.abc import Callable


class StepLock:
    """A lock around a step that several threads may take. The thread that serves requests has priority over all others."""

    def __init__(self, step: Callable[[], None]) -> None:
        """No thread steps."""
        self._step, self._lock = step, threading.Lock()
        self._cause: bool  # something has come since the last step began
        self._service_waits = False  # the serving thread waits for the lock

    def step(self) -> None:
        """Step in this thread; if another thread is stepping, that one steps once more."""
        self._cause = True
        while self._cause and not self._service_waits and self._lock.acquire(blocking=False):
            try:
                self._cause = False
                self._step()
            finally:
                self._lock.release()

    def run_between_steps(self, work: Callable[[], None]) -> bool:
        """Do other `work` while no thread steps, then step. True if something came meanwhile: then call again."""
        self._service_waits = True
        with self._lock:
            self._service_waits = False
            work()
            self._cause = False
            self._step()
        return self._cause
