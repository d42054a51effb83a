"""The samples a plant has issued: an echo must equal one of them exactly, and its age is the plant's own."""

from typing import NamedTuple

_REMEMBERED = 512  # more than any lease holds at 1 kHz

IMPOSSIBLE = -1


class Entry(NamedTuple):
    """One issued sample."""

    time_ns: int  # as sent
    stamp: int  # the clock by which ages are judged


class Ledger:
    """Number, time and stamp of the last samples."""

    def __init__(self) -> None:
        """Nothing issued yet."""
        self._entries: dict[int, Entry] = {}

    def issue(self, number: int, time_ns: int, stamp: int) -> None:
        """Remember a sample."""
        self._entries[number] = Entry(time_ns, stamp)
        self._entries.pop(number - _REMEMBERED, None)

    def age(self, number: int, time_ns: int, now: int) -> int:
        """Age of the echoed sample, or IMPOSSIBLE if this plant never issued it (or has issued many since)."""
        entry = self._entries.get(number)
        if entry is None or entry.time_ns != time_ns or now < entry.stamp:
            return IMPOSSIBLE
        return now - entry.stamp
