"""Which frames of a publisher are taken: newer than the last of the same epoch; an epoch once left never returns."""

from collections import Counter

from shared.codec import Received, Rejected


class Acceptance:
    """Sequence and epoch of one topic's publisher, and counters of what was discarded, by cause."""

    def __init__(self) -> None:
        """Nothing seen yet."""
        self.epoch: int | None = None
        self.seq = -1
        self.lost = 0
        self.discarded: Counter[str] = Counter()
        self.accepted = 0
        self._left: set[int] = set()

    def take(self, message: Received | Rejected) -> Received | None:
        """`message` if it is valid and newer than all before it; otherwise it is counted by cause."""
        if isinstance(message, Rejected):
            self.discarded[message.cause] += 1
            return None
        header = message.header
        if header.epoch in self._left:
            self.discarded["epoch"] += 1
            return None
        if header.epoch != self.epoch:
            if self.epoch is not None:
                self._left.add(self.epoch)
            self.epoch, self.seq = header.epoch, header.seq - 1
        if header.seq <= self.seq:
            self.discarded["sequence"] += 1
            return None
        self.lost += header.seq - self.seq - 1
        self.seq = header.seq
        self.accepted += 1
        return message
