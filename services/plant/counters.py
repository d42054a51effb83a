"""What the plant counts: samples, answers, and how late its grid is."""

from collections import deque
from typing import Any

_KEPT = 20_000  # latest wake-ups


class Counters:
    """Counts since the trial's first sample (or since the start, outside a trial)."""

    def __init__(self) -> None:
        """Nothing counted."""
        self.reset()

    def reset(self) -> None:
        """A trial begins."""
        self.samples = self.late_commands = self.unanswered = self.late_permits = self.shifts = 0
        self.worst_lateness_ns = 0  # of all wake-ups, because the latest ones need not include it
        self.first_unanswered_tick: int | None = None
        self.lateness_ns: deque[int] = deque(maxlen=_KEPT)
        self.command_age_ns: deque[int] = deque(maxlen=_KEPT)

    def woke(self, late_ns: int, *, shifts: bool) -> None:
        """One wake-up, and whether it was so late that it shifts the grid."""
        self.lateness_ns.append(late_ns)
        self.shifts += shifts
        self.worst_lateness_ns = max(self.worst_lateness_ns, late_ns)

    def latch(self, tick: int, *, answered: bool, judged: bool) -> None:
        """One sample of the trial, and whether command and permit had come by its latch."""
        self.samples += 1
        self.late_permits += not judged
        self.unanswered += not answered
        if not answered and tick >= 0 and self.first_unanswered_tick is None:  # before tick 0 the valves are shut
            self.first_unanswered_tick = tick

    def summary(self) -> dict[str, Any]:
        """Counts and percentiles, in us."""
        return {
            "samples": self.samples,
            "late_commands": self.late_commands,
            "unanswered": self.unanswered,
            "first_unanswered_tick": self.first_unanswered_tick,
            "late_permits": self.late_permits,
            "grid_shifts": self.shifts,
            "lateness_us": percentiles(self.lateness_ns),
            "worst_lateness_us": self.worst_lateness_ns / 1000,
            "sample_to_accepted_us": percentiles(self.command_age_ns),
        }


def percentiles(values_ns: deque[int]) -> dict[str, float]:
    """p50, p99 and max in us; empty without values."""
    if not values_ns:
        return {}
    ordered = sorted(values_ns)

    def at(share: float) -> float:
        return ordered[min(len(ordered) - 1, int(share * len(ordered)))] / 1000

    return {"p50": at(0.5), "p99": at(0.99), "max": ordered[-1] / 1000}
