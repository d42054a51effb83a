"""Where a message belongs on the recording's timelines: at the sample that it is, answers or judges."""

from collections import OrderedDict
from typing import NamedTuple

from hydrohil.shared.contract.codec import Received
from hydrohil.shared.contract.messages import NO_TRIAL, Sample

KEPT_SAMPLES = 8192  # as deep as the recorder's inbox: 8 s at 1 kHz


class Place(NamedTuple):
    """A sample as seen from the recorder."""

    number: int
    trial_time_ns: int | None  # None outside a trial
    arrival_ns: int  # recorder's monotonic clock


class SampleIndex:
    """The last samples by number; bounded."""

    def __init__(self, kept: int = KEPT_SAMPLES) -> None:
        """Nothing known yet; remember `kept` samples."""
        self._kept = kept
        self._places: OrderedDict[int, Place] = OrderedDict()
        self.newest = Place(-1, None, 0)

    def add(self, sample: Sample, arrival_ns: int) -> Place:
        """Remember a sample."""
        in_trial = sample.tick != NO_TRIAL
        self.newest = Place(sample.number, sample.trial_time_ns if in_trial else None, arrival_ns)
        self._places[sample.number] = self.newest
        if len(self._places) > self._kept:
            self._places.popitem(last=False)
        return self.newest

    def knows(self, number: int) -> bool:
        """Whether that sample has come."""
        return number in self._places

    def at(self, number: int) -> Place:
        """Place of a sample; one that never came or is forgotten has a number and no time."""
        known = self._places.get(number)
        return Place(number, None, 0) if known is None else known

    def clear(self) -> None:
        """Forget everything: another plant counts its samples from its own start."""
        self._places.clear()
        self.newest = Place(-1, None, 0)


def sample_numbers(messages: list[Received]) -> list[int]:
    """The samples that a topic's messages belong to: their own number where they have one, else the one the frame echoes."""
    if messages and hasattr(messages[0].body, "number"):
        return [message.body.number for message in messages]
    return [message.header.echo_number for message in messages]
