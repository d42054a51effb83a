"""How many of the last 100 samples were not answered in time: one bit a sample, in a window that slides."""

from typing import NamedTuple

from hydrohil.shared.compiled.kernel import kernel

RANDOM_MISSES = 16  # of 100: a link that loses 1 % each way has more in 7e-9 of all windows, one that loses 20 % in nearly all
WINDOW = 100  # samples; two whole numbers of 50 bits each, so that neither ever reaches the sign
_HALF = 50
_FULL = 1 << _HALF


class DeadlineWindow(NamedTuple):
    """The window, newest bit lowest; 1 = not answered in time."""

    newer: int = 0
    older: int = 0
    missed: int = 0  # bits set
    in_a_row: int = 0  # the newest of them without one in time between


@kernel
def deadline_window_step(answers: DeadlineWindow, lost: int, in_time: bool) -> DeadlineWindow:
    """One sample more, and the `lost` ones before it, which count as not answered in time."""
    for _ in range(min(lost, WINDOW)):
        answers = _shift(answers, 1)
    return _shift(answers, 0 if in_time else 1)


@kernel
def _shift(answers: DeadlineWindow, missed: int) -> DeadlineWindow:
    leaving = (answers.older >> (_HALF - 1)) & 1
    carried = (answers.newer >> (_HALF - 1)) & 1
    return DeadlineWindow(
        newer=(answers.newer << 1) % _FULL + missed,
        older=(answers.older << 1) % _FULL + carried,
        missed=answers.missed + missed - leaving,
        in_a_row=(answers.in_a_row + 1) * missed,
    )


@kernel
def quality(missed: int) -> float:
    """Share of the window that was answered in time."""
    return (WINDOW - missed) / WINDOW


def missed_limit(lease_samples: int) -> int:
    """Samples of the last 100 that may be not in time: one outage as long as the lease bears, and the misses of a lossy link."""
    return lease_samples + 1 + RANDOM_MISSES
