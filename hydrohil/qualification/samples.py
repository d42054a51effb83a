"""The timing of a trial from its samples. Pure."""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from hydrohil.shared.contract.deadline_window import WINDOW
from hydrohil.shared.contract.messages import NO_TRIAL, Sample
from hydrohil.shared.contract.timeliness import answered_in_time

_NS_PER_US = 1000


class Timing(NamedTuple):
    """Of every tick of a trial, by the sample that follows it."""

    in_time: tuple[bool, ...]  # its command was in force at the latch; False for a tick without a sample
    accepted_us: tuple[float, ...]  # sample -> accepted command, of those that were accepted
    missing: int  # ticks without a sample


def timing(samples: Iterable[Sample], ticks: int) -> Timing:
    """Of the ticks 0 to `ticks` - 1."""
    by_number = {sample.number: sample for sample in samples}
    number_of = {sample.tick: sample.number for sample in by_number.values() if sample.tick != NO_TRIAL}
    followers = [by_number.get(number_of[tick] + 1) if tick in number_of else None for tick in range(ticks)]
    accepted = (s.command_age_ns / _NS_PER_US for s in followers if s is not None and s.command_number == s.number - 1)
    return Timing(
        tuple(s is not None and bool(answered_in_time(s)) for s in followers),
        tuple(accepted),
        sum(tick not in number_of for tick in range(ticks)),
    )


def worst_window(in_time: Sequence[bool]) -> float:
    """Share in time of the worst WINDOW ticks in a row; NaN where there are fewer."""
    if len(in_time) < WINDOW:
        return math.nan
    kept = sum(in_time[:WINDOW])
    fewest = kept
    for leaving, entering in zip(in_time, in_time[WINDOW:], strict=False):
        kept += entering - leaving
        fewest = min(fewest, kept)
    return fewest / WINDOW
