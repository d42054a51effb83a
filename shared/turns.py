"""One step at a time, in whichever thread has cause for it: nobody is woken to do it, and nobody waits to do it."""

import threading
from collections.abc import Callable


class Turns:
    """A step that several threads may take."""

    def __init__(self, step: Callable[[], None]) -> None:
        """Nobody has it."""
        self._step, self._lock = step, threading.Lock()
        self._cause: bool  # something has come since the last step began

    def take(self) -> None:
        """Step here; or leave word with who has the turn, who then steps once more."""
        self._cause = True
        while self._cause and self._lock.acquire(blocking=False):
            try:
                self._cause = False
                self._step()
            finally:
                self._lock.release()

    def between(self, work: Callable[[], None]) -> None:
        """Do other `work` while nobody steps, and then what has come meanwhile."""
        with self._lock:
            work()
        self.take()
