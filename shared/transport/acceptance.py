"""Which frames of a publisher are taken: newer than the last of the same epoch; an abandoned epoch never returns."""

from collections import Counter

from hydrohil.shared.contract.codec import Header, Received, Rejected

MOST_EPOCHS = 4096  # abandoned epochs kept; after so many restarts no new epoch is accepted: a forgotten one could return


class Acceptance:
    """Sequence and epoch of one topic's publisher, and counters of what was discarded, by cause."""

    def __init__(self) -> None:
        """No frame has come."""
        self.bound: Header | None = None  # of the newest frame taken: cell, sender and epoch are the bound identity
        self.lost = 0
        self.discarded: Counter[str] = Counter()
        self.accepted = 0
        self.other_run = 0  # accepted, but of another run than the receiver's: not used
        self.link_faults = 0  # CRC and sequence faults under the bound identity
        self.epoch_conflicts = 0  # valid frames of this sender that changed its epoch, or were of an abandoned one
        self._abandoned: set[int] = set()

    def take(self, message: Received | Rejected) -> Received | None:
        """`message` if it is valid and newer than all before it; otherwise it is counted by cause."""
        if isinstance(message, Rejected):
            self.discarded[message.cause] += 1
            self.link_faults += message.cause == "crc" and self._is_bound(message.header)
            return None
        header = message.header
        restarted = self.bound is not None and header.epoch != self.bound.epoch
        if header.epoch in self._abandoned or (restarted and len(self._abandoned) >= MOST_EPOCHS):
            self.discarded["epoch"] += 1
            self.epoch_conflicts += 1
            return None
        last = header.seq - 1  # of a new stream: what was sent before the first frame is not lost
        if restarted and self.bound is not None:
            self._abandoned.add(self.bound.epoch)
            self.epoch_conflicts += 1
        elif self.bound is not None:
            last = self.bound.seq
        if header.seq <= last:
            self.discarded["sequence"] += 1
            self.link_faults += 1
            return None
        self.lost += header.seq - last - 1
        self.bound = header
        self.accepted += 1
        return message

    def _is_bound(self, header: Header | None) -> bool:
        """Whether the readable part of a header names the bound stream."""
        if header is None or self.bound is None:
            return False
        return (header.cell, header.sender, header.epoch) == (self.bound.cell, self.bound.sender, self.bound.epoch)
