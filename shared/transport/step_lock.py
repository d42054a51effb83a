"""One step at a time, in whichever thread has cause for it: nobody is woken to do it, and who brings cause does not wait."""

import threading
from collections.abc import Callable


class StepLock:
    """A step that several threads may take; the one that also serves requests goes before all others, whatever floods them."""

    def __init__(self, step: Callable[[], None]) -> None:
        """Nobody has it."""
        self._step, self._lock = step, threading.Lock()
        self._cause: bool  # something has come since the last step began
        self._wanted = False  # by who serves

    def take(self) -> None:
        """Step here; or leave word with who has the turn, who then steps once more."""
        self._cause = True
        while self._cause and not self._wanted and self._lock.acquire(blocking=False):
            try:
                self._cause = False
                self._step()
            finally:
                self._lock.release()

    def between(self, work: Callable[[], None]) -> bool:
        """Do other `work` while nobody steps, then step; whether something has come meanwhile, for which to come again."""
        self._wanted = True
        with self._lock:
            self._wanted = False
            work()
            self._cause = False
            self._step()
        return self._cause
