"""Which faults of the machine act at a sample: a trial's by its ticks, those injected by hand by the plant's own samples."""

from hydrohil.services.plant.device import Faults
from hydrohil.services.plant.faults import END, FIRST, Row, fault_row
from hydrohil.shared.contract.faults import Fault
from hydrohil.shared.contract.messages import NO_COMMAND, NO_TRIAL


class Injection:
    """Faults that wait or act. What was injected lasts over trials until its time is over or it is cleared."""

    def __init__(self) -> None:
        """Nothing is broken."""
        self._trial: list[tuple[Fault, Row]] = []
        self._by_hand: list[tuple[Fault, Row]] = []
        self._acting: list[tuple[Fault, Row]] = []
        self._seed = self._period_ns = 0
        self._number = NO_COMMAND  # of the sample last asked for

    def schedule(self, faults: Faults, seed: int, period_ns: int) -> None:
        """Those of the trial that was loaded."""
        self._seed, self._period_ns = seed, period_ns
        self._trial = [(fault, fault_row(fault, seed, period_ns)) for fault in faults]

    def inject(self, fault: Fault, number: int) -> None:
        """One by hand: `at_s` counts from the sample after `number`."""
        self._by_hand.append((fault, _moved(fault_row(fault, self._seed, self._period_ns), number + 1)))

    def clear(self) -> None:
        """End what was injected by hand."""
        self._by_hand = []

    def at(self, number: int, tick: int) -> tuple[Row, ...]:
        """Rows that act at this sample, by its tick in a trial and by its number outside; empty = nothing is broken."""
        self._number = number
        if not self._trial and not self._by_hand:
            self._acting = []
            return ()
        self._by_hand = [(fault, row) for fault, row in self._by_hand if number < row[END]]
        now = clock(number, tick)
        found = [(fault, row) for fault, row in self._trial if tick != NO_TRIAL and row[FIRST] <= tick < row[END]]
        found += [(fault, _moved(row, now - number)) for fault, row in self._by_hand if row[FIRST] <= number]
        self._acting = found
        return tuple(row for _, row in found)

    @property
    def acting(self) -> Faults:
        """At the sample last asked for."""
        return tuple(fault for fault, _ in self._acting)

    @property
    def waiting(self) -> Faults:
        """Injected by hand and not begun."""
        return tuple(fault for fault, row in self._by_hand if row[FIRST] > self._number)


def clock(number: int, tick: int) -> int:
    """What rows are read by: the tick of a trial, the sample's number outside."""
    return tick if tick != NO_TRIAL else number


def _moved(row: Row, by: int) -> Row:
    action, channel, first, end, value, salt = row
    return action, channel, first + by, end + by, value, salt
