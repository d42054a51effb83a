"""Which frames of a publisher are taken: newer than the last of the same epoch; an epoch once left never returns."""

from collections import Counter

from hydrohil.shared.contract.codec import Header, Received, Rejected

MOST_EPOCHS = 4096  # that are left; no sender starts anew so often, and then none may: to forget one would let it return


class Acceptance:
    """Sequence and epoch of one topic's publisher, and counters of what was discarded, by cause."""

    def __init__(self) -> None:
        """Nothing seen yet."""
        self.bound: Header | None = None  # of the newest frame taken: cell, sender and epoch are the bound identity
        self.lost = 0
        self.discarded: Counter[str] = Counter()
        self.accepted = 0
        self.other_run = 0  # accepted, and not used by who knows which run it is in
        self.link_faults = 0  # CRC and sequence faults under the bound identity
        self.epoch_conflicts = 0  # valid frames of this sender that changed its epoch, or came of one that was left
        self._left: set[int] = set()

    def take(self, message: Received | Rejected) -> Received | None:
        """`message` if it is valid and newer than all before it; otherwise it is counted by cause."""
        if isinstance(message, Rejected):
            self.discarded[message.cause] += 1
            self.link_faults += message.cause == "crc" and self._is_bound(message.header)
            return None
        header = message.header
        anew = self.bound is not None and header.epoch != self.bound.epoch
        if header.epoch in self._left or (anew and len(self._left) >= MOST_EPOCHS):
            self.discarded["epoch"] += 1
            self.epoch_conflicts += 1
            return None
        last = header.seq - 1  # of a stream that is new: nothing is lost before one joins
        if anew and self.bound is not None:
            self._left.add(self.bound.epoch)
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
        """Whether what could be read of a header names the stream that is taken."""
        if header is None or self.bound is None:
            return False
        return (header.cell, header.sender, header.epoch) == (self.bound.cell, self.bound.sender, self.bound.epoch)
